// Hashes follow what pixels and options say, and nothing else.
#include "welkin/content_hash.h"

#include <cstring>
#include <set>
#include <vector>

#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"

namespace {

using namespace welkin;
using test::Content;

/// The same texels with rows further apart and turned upside down in memory, and junk between them.
struct Strided {
  std::vector<std::byte> memory;
  CubemapView view;
};

Strided strided(const CubemapView& packed, std::ptrdiff_t padding, bool upside_down) {
  const auto rows = static_cast<std::ptrdiff_t>(packed.size);
  const auto row = static_cast<std::ptrdiff_t>(bytes_per_texel(packed.format)) * rows;
  const std::ptrdiff_t stride = row + padding;
  Strided result{std::vector<std::byte>(static_cast<std::size_t>(6 * rows * stride), std::byte{0x5a}), packed};
  for (std::ptrdiff_t face = 0; face < 6; ++face) {
    std::byte* const first = result.memory.data() + face * rows * stride;
    for (std::ptrdiff_t r = 0; r < rows; ++r) {
      const auto* const from = static_cast<const std::byte*>(packed.faces[static_cast<std::size_t>(face)]) + r * row;
      std::memcpy(first + (upside_down ? rows - 1 - r : r) * stride, from, static_cast<std::size_t>(row));
    }
    result.view.faces[static_cast<std::size_t>(face)] = upside_down ? first + (rows - 1) * stride : first;
  }
  result.view.row_stride_bytes = upside_down ? -stride : stride;
  return result;
}

TEST_CASE("hash: where rows lie in memory does not matter") {
  for (const int size : {1, 2, 37, 128}) {
    const test::TestCubemap cubemap = test::make_cubemap(Content::smooth, size, 4, 7);
    const ContentHash hash = hash_pixels(cubemap.view());
    CHECK(hash_pixels(strided(cubemap.view(), 0, false).view) == hash);
    CHECK(hash_pixels(strided(cubemap.view(), 48, false).view) == hash);
    CHECK(hash_pixels(strided(cubemap.view(), 16, true).view) == hash);
  }
}

TEST_CASE("hash: threads do not matter") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::random, 300, 3, 3);
  const test::TestLatLong lat_long = test::make_lat_long(Content::random, 700, 350, 3);
  std::set<ContentHash> hashes;
  for (const int threads : {1, 2, 3, 8}) {
    run_with_threads(threads, [&] {
      const std::array parts = {hash_pixels(cubemap.view()), hash_pixels(lat_long.view())};
      hashes.insert(combine(parts));
    });
  }
  CHECK(hashes.size() == 1);
}

TEST_CASE("hash: every texel, every channel and every face counts") {
  const test::TestCubemap original = test::make_cubemap(Content::random, 150, 3, 1);
  const std::array<ContentHash, 6> faces = hash_faces(original.view());
  std::set<ContentHash> seen{hash_pixels(original.view())};
  const std::size_t face_values = original.pixels.size() / 6;
  // First and last values of faces, and of the blocks of rows that are hashed apart.
  const std::vector<std::size_t> places = {0, 1, 2, 449, 450, face_values - 1, 65535, 65536, face_values / 2};
  for (std::size_t face = 0; face < 6; ++face) {
    for (const std::size_t place : places) {
      test::TestCubemap changed = original;
      changed.pixels[face * face_values + place] += 1.0F;
      INFO(face << ' ' << place);
      CHECK(seen.insert(hash_pixels(changed.view())).second);
      const std::array<ContentHash, 6> now = hash_faces(changed.view());
      for (std::size_t other = 0; other < 6; ++other) CHECK((now[other] == faces[other]) == (other != face));
    }
  }
}

TEST_CASE("hash: the same bytes in another shape or format are something else") {
  const std::vector<float> values(6 * 4 * 4 * 3, 0.25F);
  std::set<ContentHash> seen;
  for (const auto& [width, height] : {std::pair{24, 4}, std::pair{4, 24}, std::pair{12, 8}}) {
    CHECK(seen.insert(hash_pixels(LatLongView{values.data(), width, height, 0, PixelFormat::rgb_f32})).second);
  }
  CHECK(seen.insert(hash_pixels(LatLongView{values.data(), 48, 4, 0, PixelFormat::rgb_f16})).second);
  CHECK(seen.insert(hash_pixels(LatLongView{values.data(), 96, 4, 0, PixelFormat::rgb_u8})).second);
  CHECK(seen.insert(hash_pixels(LatLongView{values.data(), 96, 4, 0, PixelFormat::rgb_srgb8})).second);
  const CubemapImage cubemap{4, values};
  CHECK(seen.insert(hash_pixels(cubemap.view())).second);
}

TEST_CASE("hash: faces in another order are another cubemap") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::random, 8, 3, 1);
  CubemapView swapped = cubemap.view();
  std::swap(swapped.faces[0], swapped.faces[1]);
  CHECK(hash_pixels(swapped) != hash_pixels(cubemap.view()));
  CHECK(hash_faces(swapped)[0] == hash_faces(cubemap.view())[1]);
}

TEST_CASE("hash: what no call accepts is refused, and cancelling works") {
  CHECK(test::thrown_by([] { static_cast<void>(hash_pixels(CubemapView{})); }).code == ErrorCode::invalid_argument);
  CHECK(test::thrown_by([] { static_cast<void>(hash_file("/nowhere/at/all")); }).code == ErrorCode::file_access);
  std::stop_source stop;
  stop.request_stop();
  const test::TestCubemap cubemap = test::make_cubemap(Content::random, 8, 3, 1);
  CHECK(test::thrown_by([&] {
          static_cast<void>(hash_pixels(cubemap.view(), {stop.get_token(), {}}));
        }).code == ErrorCode::cancelled);
}

TEST_CASE("hash: files by their bytes") {
  const test::TemporaryDirectory directory;
  std::vector<char> bytes(3'000'000, 'x');
  test::write_bytes(directory.file("a"), bytes);
  test::write_bytes(directory.file("b"), bytes);
  CHECK(hash_file(directory.file("a")) == hash_file(directory.file("b")));
  CHECK(hash_file(directory.file("a")) == hash_bytes(bytes.data(), bytes.size()));
  bytes.back() = 'y';
  test::write_bytes(directory.file("b"), bytes);
  CHECK(hash_file(directory.file("a")) != hash_file(directory.file("b")));
}

TEST_CASE("hash: in text it has 32 digits") {
  CHECK(ContentHash{0x0123456789abcdefU, 0xfU}.text() == "0123456789abcdef000000000000000f");
  // XXH3-128 of nothing, seed 0, as its specification has it: entries outlive programs.
  CHECK(hash_bytes(nullptr, 0).text() == "99aa06d3014798d86001c324468d497f");
}

}  // namespace
