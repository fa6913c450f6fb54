// KTX2 textures in blocks of ASTC.
#include "files/textures.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: KTX2 cubemaps and images are written in ASTC as KTX 2.0 and the data format specification have it, the
// same on any number of threads; they are read with every level, face and size, and are environments like others. What
// the encoder itself loses is measured in docs/notes/textures.md; here it is only bounded.

namespace {

constexpr std::pair<TexelFormat, int> kFormats[] = {{TexelFormat::astc_4x4_hdr, 4}, {TexelFormat::astc_6x6_hdr, 6}};

TextureOptions in_astc(TexelFormat format, AstcEffort effort = AstcEffort::fastest) {
  return {.format = format, .astc_effort = effort};
}

/// Smooth, and other at each level and face.
Cubemap smooth_chain(int size, int levels) {
  Cubemap chain(size, levels);
  for (int level = 0; level < levels; ++level) {
    const int edge = chain.level_size(level);
    for (int face = 0; face < 6; ++face) {
      float* to = chain.face(level, face);
      for (int row = 0; row < edge; ++row) {
        for (int column = 0; column < edge; ++column) {
          const double x = (column + 0.5) / edge;
          const double y = (row + 0.5) / edge;
          const double value = (1.0 + face + 0.3 * level) * (1.0 + 0.5 * std::sin(3.0 * x + face) * std::cos(2.0 * y));
          for (const double share : {1.0, 0.7 + 0.2 * x, 0.5}) *to++ = static_cast<float>(value * share);
        }
      }
    }
  }
  return chain;
}

std::size_t place(const std::vector<char>& bytes, int level) {
  return number_at(bytes, 80 + 24 * static_cast<std::size_t>(level));
}

/// A block of one colour, as the specification has it: "void extent" with halves and without coordinates.
std::array<char, 16> block_of(const std::array<std::uint16_t, 4>& halves) {
  std::array<char, 16> block{};
  block.fill(static_cast<char>(0xFF));
  block[0] = static_cast<char>(0xFC);
  std::memcpy(block.data() + 8, halves.data(), sizeof halves);
  return block;
}

/// For each block of a level a colour of its own.
std::array<std::uint16_t, 4> colour_of(int level, std::size_t block) {
  const auto number = static_cast<std::uint16_t>(977 * static_cast<std::size_t>(level) + 31 * block);
  return {static_cast<std::uint16_t>(0x3000 + number), static_cast<std::uint16_t>(0x7BFF - number), number, 0x3C00};
}

}  // namespace

TEST_CASE("headers of ASTC textures are as their specifications have them", "[codec][textures][astc]") {
  const TemporaryDirectory directory;
  const Cubemap chain = smooth_chain(16, 5);
  for (const auto& [format, edge] : kFormats) {
    CAPTURE(edge);
    write_texture(directory.file("sky.ktx2"), chain.views(), in_astc(format));
    const std::vector<char> bytes = read_bytes(directory.file("sky.ktx2"));
    CHECK(number_at(bytes, 12) == (edge == 4 ? 1000066000U : 1000066004U));
    CHECK(number_at(bytes, 16) == 1);  // type size
    CHECK(number_at(bytes, 36) == 6);  // faces
    const std::size_t descriptor = number_at(bytes, 48);
    CHECK(number_at(bytes, descriptor) == 44);
    CHECK(number_at(bytes, descriptor + 12) == (162U | 1U << 8U | 1U << 16U));  // ASTC, Rec. 709, linear
    CHECK(number_at(bytes, descriptor + 16) == (edge == 4 ? 0x0303U : 0x0505U));
    CHECK(number_at(bytes, descriptor + 20) == 16);
    CHECK(number_at(bytes, descriptor + 28) == (127U << 16U | 0xC0U << 24U));  // 128 bits, signed floats
    CHECK(number_at(bytes, descriptor + 36) == 0xBF800000);                    // -1
    CHECK(number_at(bytes, descriptor + 40) == 0x3F800000);
    std::size_t end = bytes.size();
    for (int level = 0; level < 5; ++level) {
      const auto across = static_cast<std::size_t>((chain.level_size(level) + edge - 1) / edge);
      CHECK(place(bytes, level) % 16 == 0);
      CHECK(number_at(bytes, 88 + 24 * static_cast<std::size_t>(level)) == 6 * across * across * 16);
      CHECK(place(bytes, level) + 6 * across * across * 16 == end);  // the largest level last, no gap
      end = place(bytes, level);
    }
  }
}

TEST_CASE("cubemaps come back from ASTC, every level and face of every size", "[codec][textures][astc][slow]") {
  const TemporaryDirectory directory;
  for (const auto& [format, edge] : kFormats) {
    for (const int size : {1, 2, 5, 6, 7, 61}) {
      CAPTURE(edge, size);
      const Cubemap chain = smooth_chain(size, full_chain_levels(size));
      const auto path = directory.file("sky.ktx2");
      CHECK(write_texture(path, chain.views(), in_astc(format)).values_clamped == 0);
      const CubemapTexture read = read_texture(path);
      CHECK(read.format == (edge == 4 ? "KTX2 astc 4x4 hdr" : "KTX2 astc 6x6 hdr"));
      // A small level in one block is off by so much; where blocks lie, the next test has exactly.
      const float bound = edge == 4 ? 0.12F : 0.35F;
      CHECK(all_values(read.cubemap, chain, [&](float a, float b) { return std::abs(a / b - 1.0F) < bound; }));
      double squares = 0.0;
      const std::span<const float> given = level_values(chain, 0);
      const std::span<const float> found = level_values(read.cubemap, 0);
      for (std::size_t k = 0; k < given.size(); ++k) squares += std::pow(found[k] / given[k] - 1.0F, 2);
      if (size >= 61) CHECK(std::sqrt(squares / static_cast<double>(given.size())) < (edge == 4 ? 0.008 : 0.012));

      if (size == 61) continue;  // packing takes blocks as they are
      TextureOptions packed = in_astc(format);
      packed.supercompression = Supercompression::zstd;
      write_texture(directory.file("packed.ktx2"), chain.views(), packed);
      CHECK(same_bits(read_texture(directory.file("packed.ktx2")).cubemap, read.cubemap));
    }
  }
}

TEST_CASE("blocks of ASTC lie where KTX2 has them and hold halves exactly", "[codec][textures][astc]") {
  const TemporaryFile path("sky.ktx2");
  for (const auto& [format, edge] : kFormats) {
    const int size = 27;
    const int levels = full_chain_levels(size);
    write_texture(path, smooth_chain(size, levels).views(), in_astc(format));
    std::vector<char> bytes = read_bytes(path);
    for (int level = 0; level < levels; ++level) {
      const std::size_t blocks = number_at(bytes, 88 + 24 * static_cast<std::size_t>(level)) / 16;
      for (std::size_t k = 0; k < blocks; ++k) {
        const auto block = block_of(colour_of(level, k));
        std::copy(block.begin(), block.end(),
                  bytes.begin() + static_cast<std::ptrdiff_t>(place(bytes, level) + 16 * k));
      }
    }
    write_bytes(path, bytes);
    const CubemapTexture read = read_texture(path);
    bool exact = true;
    for (int level = 0; level < levels; ++level) {
      const int here = read.cubemap.level_size(level);
      const int across = (here + edge - 1) / edge;
      for (int texel = 0; texel < 6 * here * here; ++texel) {
        const int row = texel / here % here;
        const int block = (texel / (here * here) * across + row / edge) * across + texel % here / edge;
        const auto halves = colour_of(level, static_cast<std::size_t>(block));
        for (std::size_t c = 0; c < 3; ++c) {
          const float value = read.cubemap.face(level, 0)[3 * static_cast<std::size_t>(texel) + c];
          exact = exact && value == image::float_from_half(halves[c]);
        }
      }
    }
    CHECK(exact);
    ReadOptions options;  // row by row, as environments are read
    for (options.level = 0; options.level < 2; ++options.level) {
      const Environment environment = read_environment(path, options);
      CHECK(same_bytes(values_of(environment), level_values(read.cubemap, options.level)));
    }
  }
}

TEST_CASE("a block that ASTC does not define is NaN, and is reported as such", "[codec][textures][astc]") {
  const TemporaryFile path("sky.ktx2");
  write_texture(path, smooth_chain(8, 1).views(), in_astc(TexelFormat::astc_4x4_hdr));
  std::vector<char> bytes = read_bytes(path);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(place(bytes, 0)), 16, '\0');
  write_bytes(path, bytes);
  const CubemapTexture read = read_texture(path);
  CHECK(std::isnan(read.cubemap.face(0, 0)[0]));
  CHECK(read.cubemap.face(0, 0)[12] > 0.0F);
  CHECK(measure_environment(path).nans == 3 * 16);
}

TEST_CASE("ASTC keeps the mean of each channel where a sun has most of the light", "[codec][textures][astc]") {
  const Cubemap chain = sun_chain(128);
  std::vector<std::byte> bytes;
  write_texture({bytes, "sky.ktx2"}, chain.views(), in_astc(TexelFormat::astc_4x4_hdr));
  const Cubemap decoded = read_texture({bytes, "sky.ktx2"}).cubemap;
  for (int level = 0; level < 4; ++level) {  // down to 16 texels
    CAPTURE(level);
    CHECK(largest_bias(decoded, chain, level) < 0.025);
  }
}

TEST_CASE("what ASTC cannot hold is clamped and counted", "[codec][textures][astc]") {
  Cubemap chain = changed(smooth_chain(4, 1), [](float) { return 1.0F; });
  chain.face(0, 2)[0] = -1.0F;
  chain.face(0, 2)[1] = std::numeric_limits<float>::quiet_NaN();
  chain.face(0, 2)[2] = std::numeric_limits<float>::infinity();
  for (const auto& [format, edge] : kFormats) {
    std::vector<std::byte> bytes;
    CHECK(write_texture({bytes, "sky.ktx2"}, chain.views(), in_astc(format)).values_clamped == 3);
    const CubemapTexture read = read_texture({std::as_const(bytes), "sky.ktx2"});
    CHECK(all_values(read.cubemap, read.cubemap, [](float a, float) { return a >= 0.0F && a <= 65504.0F; }));
    const std::span<const float> untouched = level_values(read.cubemap, 0).subspan(0, 2 * 48);
    CHECK(std::all_of(untouched.begin(), untouched.end(), [](float value) { return value == 1.0F; }));
  }
  const Cubemap bright = changed(chain, [](float) { return 1e6F; });
  std::vector<std::byte> bytes;
  CHECK(write_texture({bytes, "sky.ktx2"}, bright.views(), in_astc(TexelFormat::astc_4x4_hdr)).values_clamped == 288);
  CHECK(read_texture({std::as_const(bytes), "sky.ktx2"}).cubemap.face(0, 0)[0] == 65504.0F);
}

TEST_CASE("a cut ASTC file is refused, and a stopped write leaves none", "[codec][textures][astc]") {
  const TemporaryFile path("sky.ktx2");
  write_texture(path, smooth_chain(8, 4).views(), in_astc(TexelFormat::astc_6x6_hdr));
  std::vector<char> bytes = read_bytes(path);
  bytes.pop_back();
  write_bytes(path, bytes);
  CHECK(thrown_by([&] { (void)read_texture(path); }).code == ErrorCode::corrupt_file);
  std::filesystem::remove(path);
  stop_source source;
  double last = 0.0;
  const Control control{source.get_token(), [&](double done) {
                          last = done;
                          if (done > 0.2) source.request_stop();
                        }};
  const Cubemap chain = smooth_chain(64, 1);
  const auto write = [&] { write_texture(path, chain.views(), in_astc(TexelFormat::astc_4x4_hdr), control); };
  CHECK(thrown_by(write).code == ErrorCode::cancelled);
  CHECK(last < 0.9);
  CHECK(std::filesystem::is_empty(path.parent_path()));
}

}  // namespace welkin::test
