// Promises: whoever asks a long call on textures to stop waits for a block, not for a level or a face; the work of the
// libraries that pack is cut for that, and what comes out is what they make in one go.
#include <zlib.h>
#include <zstd.h>

#include <atomic>
#include <random>
#include <thread>

#include "codec/env_pictures.h"
#include "codec/supercompression.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/babylon_environment.h"
#include "welkin/texture_file.h"

namespace welkin::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes noise(std::size_t count) {
  Bytes bytes(count);
  std::minstd_rand random(7);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() >> 8U);
  return bytes;
}

/// Runs `work` and asks it to stop once it has begun, from another thread.
template <typename Work>
ThrownError stopped_while(const Work& work) {
  std::stop_source source;
  std::atomic<bool> begun{false};
  std::thread other([&] {
    while (!begun) std::this_thread::yield();
    source.request_stop();
  });
  ThrownError error;
  try {
    begun = true;
    work(source.get_token());
  } catch (const Error& thrown) {
    error = {thrown.code(), thrown.what()};
  }
  other.join();
  return error;
}

}  // namespace

TEST_CASE("packing in blocks gives what packing in one go gives", "[codec][textures]") {
  // Around the block's megabyte, and over it.
  for (const std::size_t count : {std::size_t{24}, (std::size_t{1} << 20U) - 1, std::size_t{1} << 20U,
                                  (std::size_t{1} << 20U) + 1, (std::size_t{5} << 19U) + 3}) {
    CAPTURE(count);
    Bytes bytes = noise(count);
    std::fill_n(bytes.begin(), count / 2, std::uint8_t{42});  // half of it can be packed
    for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
      Bytes whole(packing == Supercompression::zlib ? compressBound(count) : ZSTD_compressBound(count));
      if (packing == Supercompression::zlib) {
        uLongf size = whole.size();
        REQUIRE(compress2(whole.data(), &size, bytes.data(), count, Z_DEFAULT_COMPRESSION) == Z_OK);
        whole.resize(size);
      } else {
        whole.resize(ZSTD_compress(whole.data(), whole.size(), bytes.data(), count, ZSTD_CLEVEL_DEFAULT));
      }
      const Bytes packed = codec::pack(packing, bytes);
      if (packing == Supercompression::zlib) CHECK(packed == whole);
      for (const Bytes& each : {packed, whole}) {
        Bytes unpacked(count);
        codec::unpack(packing, each, "sky.ktx2", unpacked);
        CHECK(unpacked == bytes);
      }
      for (const std::ptrdiff_t wrong : {-1, 1}) {
        Bytes other(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(count) + wrong));
        const ThrownError error = thrown_by([&] { codec::unpack(packing, packed, "sky.ktx2", other); });
        CHECK(error.code == ErrorCode::corrupt_file);
      }
      for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, packed.size() / 2, packed.size() - 1}) {
        Bytes other(count);
        const Bytes begin(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(cut));
        const ThrownError error = thrown_by([&] { codec::unpack(packing, begin, "sky.ktx2", other); });
        CHECK(error.code == ErrorCode::corrupt_file);
      }
    }
  }
}

TEST_CASE("packing and unpacking stop in the middle of a level", "[codec][textures]") {
  const Bytes bytes = noise(std::size_t{16} << 20U);  // half a second of zlib
  for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
    const ThrownError error =
        stopped_while([&](const std::stop_token& stop) { (void)codec::pack(packing, bytes, stop); });
    CHECK(error.says("cancelled"));
  }
  const Bytes packed = codec::pack(Supercompression::zlib, Bytes(std::size_t{128} << 20U));
  Bytes unpacked(std::size_t{128} << 20U);
  const ThrownError error = stopped_while(
      [&](const std::stop_token& stop) { codec::unpack(Supercompression::zlib, packed, "sky.ktx2", unpacked, stop); });
  CHECK(error.says("cancelled"));
}

TEST_CASE("pictures of an .env stop in the middle of a face", "[codec][env]") {
  constexpr int size = 2048;
  const Bytes rgba = noise(std::size_t{4} * size * size);
  const ThrownError written =
      stopped_while([&](const std::stop_token& stop) { (void)codec::encode_png_rgba(rgba, size, stop); });
  CHECK(written.says("cancelled"));
  const Bytes png = codec::encode_png_rgba(rgba, size);
  Bytes back(rgba.size());
  codec::decode_rgba(png, size, "sky.env", "its face", back.data());
  CHECK(back == rgba);
  const ThrownError read = stopped_while(
      [&](const std::stop_token& stop) { codec::decode_rgba(png, size, "sky.env", "its face", back.data(), stop); });
  CHECK(read.says("cancelled"));
}

TEST_CASE("a two-dimensional texture that is stopped before it is packed leaves no file", "[codec][textures]") {
  const TemporaryDirectory directory;
  const std::vector<float> rgb(std::size_t{3} * 64 * 64, 0.5F);
  for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
    std::stop_source source;
    double last = 0.0;
    const Control control{source.get_token(), [&](double done) {
                            last = done;
                            source.request_stop();
                          }};
    const ThrownError error = thrown_by([&] {
      write_texture_2d(directory.file("brdf.ktx2"), 64, 64, rgb.data(), {TexelFormat::rgba16f, packing, {}}, control);
    });
    CHECK(error.code == ErrorCode::cancelled);
    CHECK(last < 1.0);
    CHECK(std::filesystem::is_empty(directory.file("").parent_path()));
  }
}

}  // namespace welkin::test
