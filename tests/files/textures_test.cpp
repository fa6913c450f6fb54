// Textures: texel for texel back, rounded to the nearest, and calls that stop inside a level.
#include "files/textures.h"

#include <Imath/half.h>
#include <zlib.h>
#include <zstd.h>

#include "files/crc32.h"
#include "files/env.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promises: what is written as KTX2, DDS or mip-mapped OpenEXR comes back texel for texel, rounded as the format says;
// the bytes are where the formats' specifications want them, and the same on any number of threads.

namespace {

constexpr std::array kFormats{TexelFormat::rgba16f, TexelFormat::rgba32f, TexelFormat::b10g11r11,
                              TexelFormat::e5b9g9r9};
constexpr std::array kPackings{Supercompression::none, Supercompression::zlib, Supercompression::zstd};

/// A step of the format at a value: that of a half, ...
double step(TexelFormat format, double value, double largest_of_texel) {
  switch (format) {
    case TexelFormat::rgba16f: return std::ldexp(std::abs(value), -10);
    case TexelFormat::rgba32f: return 0.0;
    case TexelFormat::b10g11r11: return std::ldexp(std::abs(value), -5);
    case TexelFormat::e5b9g9r9: return std::ldexp(largest_of_texel, -8) * 1.001;  // 511.5 steps are rounded to 512
    case TexelFormat::bc6h_ufloat:
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr:
    case TexelFormat::uastc_hdr_4x4: break;  // not texel by texel
  }
  return 0.0;
}

/// Whether each value of `read` is half a step from what was written, at most.
bool is_rounded(const Cubemap& written, const Cubemap& read, TexelFormat format) {
  if (written.size() != read.size() || written.levels() != read.levels()) return false;
  for (int level = 0; level < written.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      for (std::size_t texel = 0; texel < face_values(written, level); texel += 3) {
        const float* from = written.face(level, face) + texel;
        const float* to = read.face(level, face) + texel;
        const double largest = std::max({std::abs(from[0]), std::abs(from[1]), std::abs(from[2])});
        for (int c = 0; c < 3; ++c) {
          const double off = std::abs(static_cast<double>(from[c]) - static_cast<double>(to[c]));
          if (!(off <= 0.5 * step(format, static_cast<double>(from[c]), largest))) return false;
        }
      }
    }
  }
  return true;
}

Cubemap half_chain(int size, int levels) {
  return changed(noisy_chain(size, levels), [](float value) { return static_cast<float>(Imath::half(value)); });
}

}  // namespace

TEST_CASE("textures come back rounded as their format says, at every size", "[codec][textures][slow]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    for (const int levels : {1, full_chain_levels(size)}) {
      if (size == 257 && levels == 1) continue;  // takes its time, and says nothing new
      const Cubemap chain = noisy_chain(size, levels);
      for (const TexelFormat format : kFormats) {
        for (const Supercompression packing : kPackings) {
          CAPTURE(size, levels, static_cast<int>(format), static_cast<int>(packing));
          const auto path = directory.file("sky.ktx2");
          const WriteReport report = write_texture(path, chain.views(), {format, packing, {{"key", "value"}}});
          CHECK(report.values_clamped == 0);
          CHECK(report.files == std::vector<std::filesystem::path>{path});
          const CubemapTexture texture = read_texture(path);
          CHECK(is_rounded(chain, texture.cubemap, format));
          CHECK(texture.metadata.at("key") == "value");
          CHECK(texture.metadata.at("KTXorientation") == "rd");
        }
        const auto path = directory.file("sky.dds");
        write_texture(path, chain.views(), {format});
        CHECK(is_rounded(chain, read_texture(path).cubemap, format));
      }
    }
  }
}

TEST_CASE("a KTX2 file has its parts where the specification wants them", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = half_chain(6, 3);
  for (const TexelFormat format : kFormats) {
    for (const Supercompression packing : kPackings) {
      CAPTURE(static_cast<int>(format), static_cast<int>(packing));
      write_texture(directory.file("sky.ktx2"), chain.views(), {format, packing, {{"zeta", "1"}, {"Alpha", "22"}}});
      const std::vector<char> bytes = read_bytes(directory.file("sky.ktx2"));
      const std::size_t texel = format == TexelFormat::rgba16f ? 8 : format == TexelFormat::rgba32f ? 16 : 4;
      CHECK(std::string(bytes.data() + 1, 6) == "KTX 20");
      constexpr std::array<std::uint64_t, 4> formats{97, 109, 122, 123};
      CHECK(number_at(bytes, 12) == formats[static_cast<std::size_t>(format)]);
      CHECK(number_at(bytes, 20) == 6);  // width and height
      CHECK(number_at(bytes, 24) == 6);
      CHECK(number_at(bytes, 36) == 6);  // faces
      CHECK(number_at(bytes, 40) == 3);  // levels
      CHECK(number_at(bytes, 44) == (packing == Supercompression::none   ? 0U
                                     : packing == Supercompression::zstd ? 2U
                                                                         : 3U));
      const std::size_t descriptor = number_at(bytes, 48);
      CHECK(descriptor == 80 + 3 * 24);
      CHECK(number_at(bytes, descriptor) == number_at(bytes, 52));
      const std::size_t samples = format == TexelFormat::e5b9g9r9 ? 6 : format == TexelFormat::b10g11r11 ? 3 : 4;
      CHECK(number_at(bytes, 52) == 4 + 24 + 16 * samples);
      CHECK(number_at<std::uint8_t>(bytes, descriptor + 20) == texel);  // packed or not
      const std::size_t metadata = number_at(bytes, 56);
      CHECK(metadata == descriptor + number_at(bytes, 52));
      const std::string text(bytes.data() + metadata, number_at(bytes, 60));
      CHECK(text.find("Alpha") < text.find("KTXorientation"));
      CHECK(text.find("KTXorientation") < text.find("KTXwriter"));
      CHECK(text.find("KTXwriter") < text.find("zeta"));
      std::uint64_t end = metadata + number_at(bytes, 60);
      for (const std::size_t level : {2U, 1U, 0U}) {  // the smallest comes first
        const std::size_t entry = 80 + 24 * level;
        const std::uint64_t offset = number_at<std::uint64_t>(bytes, entry);
        const std::uint64_t edge = 6U >> level;
        CHECK(offset >= end);
        CHECK(offset < end + texel);
        if (packing == Supercompression::none) CHECK(offset % texel == 0);
        CHECK(number_at<std::uint64_t>(bytes, entry + 16) == 6 * edge * edge * texel);
        end = offset + number_at<std::uint64_t>(bytes, entry + 8);
      }
      CHECK(end == bytes.size());
    }
  }
}

TEST_CASE("a DDS file has face after face, with its levels from the largest to the smallest", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = half_chain(4, 3);
  write_texture(directory.file("sky.dds"), chain.views(), {});
  const std::vector<char> bytes = read_bytes(directory.file("sky.dds"));
  REQUIRE(bytes.size() == 148 + 6 * (16 + 4 + 1) * 8);
  CHECK(std::string(bytes.data(), 4) == "DDS ");
  CHECK(std::string(bytes.data() + 84, 4) == "DX10");
  CHECK(number_at(bytes, 28) == 3);
  CHECK(number_at(bytes, 112) == 0xFE00);
  CHECK(number_at(bytes, 128) == 10);
  CHECK(number_at(bytes, 136) == 4);
  std::size_t index = 148;
  bool right = true;
  for (int face = 0; face < 6; ++face) {
    for (int level = 0; level < 3; ++level) {
      for (std::size_t i = 0; i < face_values(chain, level); i += 3, index += 8) {
        for (std::size_t c = 0; c < 3; ++c) {
          Imath::half half;
          half.setBits(number_at<std::uint16_t>(bytes, index + 2 * c));
          right = right && static_cast<float>(half) == chain.face(level, face)[i + c];
        }
        right = right && number_at<std::uint16_t>(bytes, index + 6) == 0x3C00;
      }
    }
  }
  CHECK(right);
}

TEST_CASE("each level of a mip-mapped OpenEXR cube is read back, in our frames", "[codec][textures][slow]") {
  const TemporaryFile path("sky.exr");
  for (const TexelFormat format : {TexelFormat::rgba16f, TexelFormat::rgba32f}) {
    for (const auto& [size, levels] : {std::pair{1, 1}, {2, 2}, {64, 7}, {64, 3}, {256, 1}}) {
      const Cubemap chain = half_chain(size, levels);
      write_texture(path, chain.views(), {format, Supercompression::none, {{"roughness", "0 0.5 1"}}});
      for (int level = 0; level < levels; ++level) {
        CAPTURE(size, levels, level);
        const Environment read = read_environment(path, {.level = level});
        REQUIRE(read.face_size() == chain.level_size(level));
        CHECK(same_bytes(values_of(read), level_values(chain, level)));
      }
    }
  }
  const EnvironmentInfo info = inspect_environment(path);
  CHECK(info.storage.find("mip-mapped tiles") != std::string::npos);
  CHECK(info.layout_reason.find("envmap") != std::string::npos);
}

TEST_CASE("levels of an OpenEXR cube that were not given are means of the last one", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = half_chain(16, 2);
  write_texture(directory.file("sky.exr"), chain.views(), {TexelFormat::rgba32f});
  const Environment read = read_environment(directory.file("sky.exr"), {.level = 3});
  REQUIRE(read.face_size() == 2);
  for (int face = 0; face < 6; ++face) {
    double sum = 0.0;  // of the top left quarter of 8 x 8
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) sum += static_cast<double>(chain.face(1, face)[3 * (8 * j + i)]);
    }
    CHECK(std::abs(static_cast<double>(read.pixels[static_cast<std::size_t>(face) * 12]) - sum / 16.0) < 1e-6 * sum);
  }
}

TEST_CASE("odd sizes of an OpenEXR cube are written whole", "[codec][textures]") {
  const TemporaryDirectory directory;
  for (const int size : {3, 7, 257}) {
    const Cubemap chain = half_chain(size, full_chain_levels(size));
    write_texture(directory.file("sky.exr"), chain.views(), {});
    const Environment read = read_environment(directory.file("sky.exr"));
    CHECK(read.face_size() == size);
    CHECK(same_bytes(values_of(read), level_values(chain, 0)));
  }
}

TEST_CASE("views of any format and stride are written as they are seen", "[codec][textures]") {
  const TemporaryDirectory directory;
  std::vector<std::uint16_t> halves;
  for (int texel = 0; texel < 6 * 3 * 5; ++texel) {  // rows of 5 texels, of which 3 are the image
    for (int channel = 0; channel < 4; ++channel) {
      halves.push_back(Imath::half(static_cast<float>(texel * 4 + channel) * 0.25F).bits());
    }
  }
  CubemapView view{{}, 3, -5 * 8, PixelFormat::rgba16f};  // bottom row first
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = halves.data() + (face * 15 + 10) * 4;
  write_texture(directory.file("sky.ktx2"), {&view, 1}, {});
  const CubemapTexture read = read_texture(directory.file("sky.ktx2"));
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < 3; ++row) {
      const float wanted = static_cast<float>((face * 15 + (2 - row) * 5 + 1) * 4 + 2) * 0.25F;
      CHECK(read.cubemap.face(0, face)[3 * (row * 3 + 1) + 2] == wanted);
    }
  }
}

TEST_CASE("what is clamped on the way into a texture is counted", "[codec][textures]") {
  const TemporaryDirectory directory;
  Cubemap chain = noisy_chain(4, 3);
  chain.face(0, 2)[7] = 1e6F;
  chain.face(2, 5)[0] = -1e6F;
  for (const char* file : {"sky.ktx2", "sky.dds", "sky.exr"}) {
    CHECK(write_texture(directory.file(file), chain.views(), {}).values_clamped == 2);
    CHECK(write_texture(directory.file(file), chain.views(), {TexelFormat::rgba32f}).values_clamped == 0);
  }
  const TextureOptions packed{TexelFormat::e5b9g9r9, Supercompression::zstd, {}};
  CHECK(write_texture(directory.file("sky.ktx2"), chain.views(), packed).values_clamped == 2);
}

TEST_CASE("an image is written as a two-dimensional texture, row after row", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = half_chain(4, 1);
  const float* rgb = chain.face(0, 0);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {2, 16}}) {
    const auto texels = static_cast<std::size_t>(width * height);
    const auto holds_halves = [&](const std::vector<char>& bytes, std::size_t index) {
      bool right = bytes.size() == index + 8 * texels;
      for (std::size_t i = 0; right && i < 3 * texels; ++i) {
        Imath::half half;
        half.setBits(number_at<std::uint16_t>(bytes, index + i / 3 * 8 + i % 3 * 2));
        right = static_cast<float>(half) == rgb[i];
      }
      return right;
    };
    write_texture_2d(directory.file("table.ktx2"), width, height, rgb);
    std::vector<char> bytes = read_bytes(directory.file("table.ktx2"));
    CHECK(number_at(bytes, 20) == static_cast<std::uint64_t>(width));
    CHECK(number_at(bytes, 24) == static_cast<std::uint64_t>(height));
    CHECK(number_at(bytes, 36) == 1);
    CHECK(holds_halves(bytes, number_at<std::uint64_t>(bytes, 80)));
    write_texture_2d(directory.file("table.dds"), width, height, rgb);
    bytes = read_bytes(directory.file("table.dds"));
    CHECK(number_at(bytes, 112) == 0);
    CHECK(number_at(bytes, 12) == static_cast<std::uint64_t>(height));
    CHECK(number_at(bytes, 16) == static_cast<std::uint64_t>(width));
    CHECK(holds_halves(bytes, 148));
  }
  const auto refusal = [&](const char* file, int width, const float* pixels) {
    return thrown_by([&] { write_texture_2d(directory.file(file), width, 4, pixels); });
  };
  CHECK(refusal("table.exr", 4, rgb).code == ErrorCode::unsupported_file);
  CHECK(refusal("table.dds", 0, rgb).code == ErrorCode::invalid_argument);
  CHECK(refusal("table.dds", 4, nullptr).says("no pixels"));
  CHECK(thrown_by([&] { (void)read_texture(directory.file("table.ktx2")); }).says("is not a cubemap"));
}

TEST_CASE("Octahedral maps go to KTX2 with all levels, and to OpenEXR a level a file", "[textures][octahedral]") {
  const TemporaryDirectory directory;
  const Cubemap chain = build_mips(make_cubemap(Content::smooth, 16, 3, 3).view());
  const OctahedralMap map = to_octahedral(chain, {.size = 24, .levels = 3});
  for (const Supercompression packing : {Supercompression::none, Supercompression::zstd}) {
    std::vector<std::byte> bytes;
    const WriteReport report =
        write_octahedral({bytes, "map.ktx2"}, map, {TexelFormat::rgba32f, packing, {{"note", "x"}}});
    CHECK(report.values_clamped == 0);
    CHECK(number_at(bytes, 12) == 109);  // VK_FORMAT_R32G32B32A32_SFLOAT
    CHECK(number_at(bytes, 20) == 24);
    CHECK(number_at(bytes, 24) == 24);
    CHECK(number_at(bytes, 36) == 1);  // face
    CHECK(number_at(bytes, 40) == 3);  // levels
    const std::string whole(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    CHECK(whole.find(std::string("welkin.octahedral_border\0004\000", 27)) != std::string::npos);
    if (packing != Supercompression::none) continue;
    for (std::size_t level = 0; level < 3; ++level) {
      const std::uint32_t offset = number_at(bytes, 80 + 24 * level);
      const auto texels = static_cast<std::uint32_t>(map.levels[level].size() / 3);
      CHECK(number_at(bytes, 80 + 24 * level + 8) == 16 * texels);
      for (std::uint32_t texel = 0; texel < texels; ++texel) {
        REQUIRE(number_at<float>(bytes, offset + 16 * texel) == map.levels[level][3 * texel]);
      }
    }
  }
  const WriteReport images = write_octahedral(directory.file("map.exr"), map, {TexelFormat::rgba32f});
  REQUIRE(images.files.size() == 3);
  CHECK(images.files[2].filename() == "map_m2.exr");
  const Environment read = read_environment(images.files[1], {.layout = Layout::lat_long});
  REQUIRE(read.info.width == 12);
  REQUIRE(read.info.height == 12);
  CHECK(std::equal(map.levels[1].begin(), map.levels[1].end(), read.pixels.get()));
  const auto refusal = [&](const char* name, const TextureOptions& options) {
    return thrown_by([&] { write_octahedral(directory.file(name), map, options); }).code;
  };
  CHECK(refusal("map.dds", {}) == ErrorCode::invalid_argument);
  CHECK(refusal("map.ktx", {}) == ErrorCode::invalid_argument);
  CHECK_NOTHROW(write_octahedral(directory.file("map.Exr"), map));
  CHECK(refusal("map.exr", {TexelFormat::bc6h_ufloat}) == ErrorCode::invalid_argument);
  CHECK(refusal("map.png", {}) == ErrorCode::unsupported_file);
  CHECK(thrown_by([&] { write_octahedral(directory.file("map.ktx2"), OctahedralMap()); }).code ==
        ErrorCode::invalid_argument);
}

TEST_CASE("what a texel cannot hold is clamped and counted", "[codec][texels]") {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> rgb{70000.0F, -70000.0F, NAN, infinity, -infinity, -1.0F, -0.0F, 65504.0F, 1.0F};
  const auto through = [&rgb](TexelFormat format, std::uint64_t& clamped) {
    std::vector<std::uint8_t> texels(3 * files::texel_bytes(files::kind_of(format)));
    clamped = image::encode_texels(format, rgb.data(), 3, texels.data());
    std::vector<float> back(9);
    files::decode_texels(files::kind_of(format), texels.data(), 3, back.data());
    return back;
  };
  std::uint64_t clamped = 0;
  CHECK(through(TexelFormat::rgba16f, clamped) == std::vector<float>{65504, -65504, 0, 65504, -65504, -1, 0, 65504, 1});
  CHECK(clamped == 5);
  CHECK(through(TexelFormat::b10g11r11, clamped) == std::vector<float>{65024, 0, 0, 65024, 0, 0, 0, 65024, 1});
  CHECK(clamped == 7);
  CHECK(through(TexelFormat::e5b9g9r9, clamped) == std::vector<float>{65408, 0, 0, 65408, 0, 0, 0, 65408, 0});
  CHECK(clamped == 7);
  const std::vector<float> floats = through(TexelFormat::rgba32f, clamped);
  CHECK(clamped == 0);
  CHECK(std::isnan(floats[2]));
  CHECK(floats[3] == infinity);
  CHECK(floats[0] == 70000.0F);
}

// Promises: a long call on textures stops after a block, not after a level or a face; the work of the packing libraries
// is split for that, and the result equals that of a single call.

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
  // On a busy machine the other thread may get a processor only after the work has ended: then both begin again.
  constexpr int most_attempts = 50;
  ThrownError error;
  for (int attempt = 0; attempt < most_attempts && !error.says("cancelled"); ++attempt) {
    stop_source source;
    std::atomic<bool> begun{false};
    std::thread other([&] {
      while (!begun) std::this_thread::yield();
      source.request_stop();
    });
    try {
      begun = true;
      work(source.get_token());
    } catch (const Error& thrown) {
      error = {thrown.code(), thrown.what()};
    }
    other.join();
  }
  return error;
}

}  // namespace

TEST_CASE("packing in blocks gives what packing in one go gives", "[codec][textures][slow]") {
  // Around the block's megabyte, and over it.
  for (const std::size_t count : {std::size_t{24}, (std::size_t{1} << 20U) - 1, std::size_t{1} << 20U,
                                  (std::size_t{1} << 20U) + 1, (std::size_t{5} << 19U) + 3}) {
    CAPTURE(count);
    Bytes bytes = noise(count);
    std::fill_n(bytes.begin(), count / 2, std::uint8_t{42});  // half of it can be packed
    for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
      Bytes whole(packing == Supercompression::zlib ? compressBound(static_cast<uLong>(count))
                                                    : ZSTD_compressBound(count));
      if (packing == Supercompression::zlib) {
        auto size = static_cast<uLongf>(whole.size());
        const auto unpacked = static_cast<uLong>(count);
        REQUIRE(compress2(whole.data(), &size, bytes.data(), unpacked, Z_DEFAULT_COMPRESSION) == Z_OK);
        whole.resize(size);
      } else {
        whole.resize(ZSTD_compress(whole.data(), whole.size(), bytes.data(), count, ZSTD_CLEVEL_DEFAULT));
      }
      const Bytes packed = files::pack(packing, bytes);
      if (packing == Supercompression::zlib) CHECK(packed == whole);
      for (const Bytes& each : {packed, whole}) {
        Bytes unpacked(count);
        files::unpack(packing, each, "sky.ktx2", unpacked);
        CHECK(unpacked == bytes);
      }
      for (const std::ptrdiff_t wrong : {-1, 1}) {
        Bytes other(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(count) + wrong));
        const ThrownError error = thrown_by([&] { files::unpack(packing, packed, "sky.ktx2", other); });
        CHECK(error.code == ErrorCode::corrupt_file);
      }
      for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, packed.size() / 2, packed.size() - 1}) {
        Bytes other(count);
        const Bytes begin(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(cut));
        const ThrownError error = thrown_by([&] { files::unpack(packing, begin, "sky.ktx2", other); });
        CHECK(error.code == ErrorCode::corrupt_file);
      }
    }
  }
}

TEST_CASE("packing and unpacking stop in the middle of a level", "[codec][textures][slow]") {
  const Bytes bytes = noise(std::size_t{16} << 20U);  // half a second of zlib
  for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
    const ThrownError error = stopped_while([&](const stop_token& stop) { (void)files::pack(packing, bytes, stop); });
    CHECK(error.says("cancelled"));
  }
  const Bytes packed = files::pack(Supercompression::zlib, Bytes(std::size_t{128} << 20U));
  Bytes unpacked(std::size_t{128} << 20U);
  const ThrownError error = stopped_while(
      [&](const stop_token& stop) { files::unpack(Supercompression::zlib, packed, "sky.ktx2", unpacked, stop); });
  CHECK(error.says("cancelled"));
}

TEST_CASE("the checksum of sky tables is zlib's, in pieces too", "[codec]") {
  CHECK(files::crc32(0, "123456789", 9) == 0xCBF43926U);
  const Bytes bytes = noise(100);
  for (std::size_t first = 0; first < 20; ++first) {
    for (std::size_t count = 0; first + count <= bytes.size(); ++count) {
      const auto wanted = static_cast<std::uint32_t>(crc32_z(7, bytes.data() + first, count));
      if (count > 0) REQUIRE(files::crc32(7, bytes.data() + first, count) == wanted);
      const std::uint32_t before = files::crc32(0, bytes.data(), first);
      REQUIRE(files::crc32(before, bytes.data() + first, count) == files::crc32(0, bytes.data(), first + count));
    }
  }
}

}  // namespace welkin::test
