// KTX2 textures in blocks of ASTC and of UASTC HDR.
#include "files/textures.h"
#include "image/bc6h_kernels.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "image/uastc_hdr.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

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

std::size_t level_offset(const std::vector<char>& bytes, int level) {
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
      CHECK(level_offset(bytes, level) % 16 == 0);
      CHECK(number_at(bytes, 88 + 24 * static_cast<std::size_t>(level)) == 6 * across * across * 16);
      CHECK(level_offset(bytes, level) + 6 * across * across * 16 == end);  // the largest level last, no gap
      end = level_offset(bytes, level);
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
                  bytes.begin() + static_cast<std::ptrdiff_t>(level_offset(bytes, level) + 16 * k));
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
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(level_offset(bytes, 0)), 16, '\0');
  write_bytes(path, bytes);
  const CubemapTexture read = read_texture(path);
  CHECK(std::isnan(read.cubemap.face(0, 0)[0]));
  CHECK(read.cubemap.face(0, 0)[12] > 0.0F);
  CHECK(measure_environment(path).nans == 3 * 16);
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

// Promises: blocks are HDR ASTC, and of those only what Basis Universal's transcoders turn into BC6H; the bytes do not
// depend on the instruction set nor on the number of threads; errors and means of real images' chains and of made-up
// ones stay within their bounds. tests/textures asks three.js and its transcoder, whether they read them.

namespace {

constexpr std::array kEfforts{Bc6hEffort::fast, Bc6hEffort::normal, Bc6hEffort::slow};

std::vector<std::byte> written(const Cubemap& chain, Bc6hEffort effort = Bc6hEffort::normal) {
  TextureOptions options{.format = TexelFormat::uastc_hdr_4x4, .bc6h_effort = effort};
  std::vector<std::byte> bytes;
  write_texture({bytes, "sky.ktx2"}, chain.views(), options);
  return bytes;
}

Cubemap read_back(const std::vector<std::byte>& bytes) { return read_texture({bytes, "sky.ktx2"}).cubemap; }

double rms_error(const Cubemap& found, const Cubemap& chain) {
  double sum = 0.0;
  double count = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    const std::span<const float> wanted = level_values(chain, level);
    const std::span<const float> here = level_values(found, level);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const auto value = static_cast<double>(std::clamp(wanted[k], 0.0F, 65504.0F));
      const double off = (static_cast<double>(here[k]) - value) / std::max(value, 0x1p-14);
      sum += off * off;
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

/// A block's first bits, counted from the lowest.
std::uint32_t bits(const std::uint8_t* block, int first, int count) {
  std::uint32_t value = 0;
  for (int k = 0; k < count; ++k) value |= (block[(first + k) / 8] >> ((first + k) % 8) & 1U) << k;
  return value;
}

}  // namespace

TEST_CASE("one colour is exact in UASTC HDR at every size", "[codec][textures][astc][uastc]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    Cubemap chain(size, full_chain_levels(size));
    for (const float value : {0.0F, 0x1p-24F, 0.3F, 1.0F, 65504.0F}) {
      CAPTURE(size, value);
      chain = changed(chain, [&](float) { return value; });
      const float half = image::float_from_half(image::half_from_float(value));
      CHECK(all_values(read_back(written(chain)), chain, [&](float a, float) { return a == half; }));
    }
  }
}

// astcenc reads the same blocks where the descriptor does not say that they are UASTC HDR.
TEST_CASE("blocks of every kind of UASTC HDR are read as astcenc reads them", "[codec][textures][astc][uastc]") {
  constexpr int size = 64;
  Cubemap chain(size);
  std::fill(chain.pixels().begin(), chain.pixels().end(), 1.0F);
  std::vector<std::byte> bytes = written(chain);
  const std::size_t first = bytes.size() - std::size_t{6} * size * size;
  std::mt19937 engine(11);
  const auto random = [&] { return static_cast<std::uint32_t>(engine()); };
  for (std::size_t block = first; block < bytes.size(); block += 16) {
    std::array<std::uint32_t, 4> words{};
    for (std::uint32_t& word : words) word = random();
    // 4 x 4 steps of one of the twelve precisions, one or two parts, endpoint format 7 or 11: or anything at all.
    const std::uint32_t step = 2 + random() % 6;
    const std::uint32_t parts = random() % 2;
    const std::uint32_t format = random() % 2 == 0 ? 7 : 11;
    if (random() % 16 != 0) {
      words[0] &= ~0x1FFFU;
      words[0] |= (step & 1U) << 4U | step >> 1U | 2U << 5U | (random() % 2) << 9U | parts << 11U;
      const unsigned index = parts == 0 ? 13 : 23;
      words[0] &= ~((parts == 0 ? 0xFU : 0x3FU) << index);
      words[0] |= format << (parts == 0 ? 13U : 25U);
    }
    std::memcpy(&bytes[block], words.data(), sizeof words);
  }
  const Cubemap ours = read_back(bytes);
  constexpr std::size_t place_of_descriptor = 48;
  std::uint32_t descriptor = 0;
  std::memcpy(&descriptor, &bytes[place_of_descriptor], sizeof descriptor);
  REQUIRE(bytes[descriptor + 12] == std::byte{167});
  bytes[descriptor + 12] = std::byte{162};
  const Cubemap theirs = read_back(bytes);
  int known = 0;
  for (std::size_t k = 0; k < ours.pixels().size(); ++k) {
    if (std::isnan(ours.pixels()[k])) continue;  // what ASTC has and UASTC HDR has not
    ++known;
    if (ours.pixels()[k] != theirs.pixels()[k]) FAIL("value " << k);
  }
  CHECK(known > 3 * size * size * 6 / 2);
}

TEST_CASE("ends of lines in UASTC HDR are stored near to what was wanted", "[image][uastc]") {
  std::mt19937 random(5);
  const auto number = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  double largest = 0.0;
  double sum = 0.0;
  constexpr int trials = 20000;
  for (int trial = 0; trial < trials; ++trial) {
    // A line of at most four octaves, and colours within one: what most blocks have.
    std::array<std::array<float, 3>, 2> ends{};
    const float middle = number(600.0, 3300.0);
    const float reach = number(0.0, 250.0);
    for (std::size_t c = 0; c < 3; ++c) {
      const float colour = number(-60.0, 60.0);
      ends[0][c] = middle + colour - reach;
      ends[1][c] = middle + colour + reach + number(-20.0, 20.0);
    }
    const image::UastcLine line = image::store_uastc_line(ends, image::UastcLines::single);
    // Low and high may be exchanged.
    double off = 0.0;
    double other = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {
      const auto stored = static_cast<double>(line.ends[k / 3][k % 3]);
      off = std::max(off, std::abs(stored - static_cast<double>(ends[k / 3][k % 3])));
      other = std::max(other, std::abs(stored - static_cast<double>(ends[1 - k / 3][k % 3])));
    }
    largest = std::max(largest, std::min(off, other));
    sum += std::min(off, other);
  }
  CAPTURE(largest, sum / trials);
  CHECK(sum / trials < 2.5);  // of 128 in an octave
  CHECK(largest < 48.0);      // where only the ends' upper bits are stored, blue in steps of 32
}

TEST_CASE("UASTC HDR has the kinds of blocks that transcoders know, with ASTC's 27 of BC6H's partitions",
          "[codec][textures][uastc]") {
  CHECK(std::popcount(image::kUastcPartitions) == 27);
  const Cubemap noise = noisy_chain(32, 1, 3);
  // A half of it smooth, in rows: one line is enough there.
  Cubemap chain = noise;
  for (int face = 0; face < 3; ++face) {
    for (int k = 0; k < 32 * 32; ++k) {
      for (int c = 0; c < 3; ++c) chain.face(0, face)[3 * k + c] = 1.0F + 0.01F * static_cast<float>(k / 32);
    }
  }
  std::vector<std::vector<LatLongView>> levels;
  for (const CubemapView& view : chain.views()) levels.push_back(image::images_of(view));
  const image::EncodedLevels encoded = image::encode_uastc_hdr_images(levels, Bc6hEffort::slow, {});
  std::set<std::uint32_t> seeds;
  int singles = 0;
  for (const image::EncodedLevels::Level& level : encoded.levels) {
    for (std::size_t at = 0; at < level.blocks.size(); at += image::kBlockBytes) {
      const std::uint8_t* const block = level.blocks.data() + at;
      if (bits(block, 0, 12) == 0xFFC) continue;  // one colour
      const bool pair = bits(block, 11, 2) == 1;
      REQUIRE(bits(block, 0, 11) == (pair ? 0x42U : 0x242U));
      REQUIRE((pair ? bits(block, 23, 6) : bits(block, 13, 4)) == (pair ? 44U : 11U));
      if (pair) seeds.insert(bits(block, 13, 10));
      singles += pair ? 0 : 1;
    }
  }
  CHECK(singles > 0);
  CHECK(seeds.size() > 20);
}

TEST_CASE("UASTC HDR's kernels give the same lines and indices on every instruction set", "[image][uastc]") {
  const Cubemap chain = build_mips(make_cubemap(Content::high_range, 16, 3, 5).view());
  image::BlockLines first_fitted{};
  image::BlockIndices first_found{};
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const image::Bc6hKernels& blocks = image::bc6h_kernels(set);
    const image::UastcHdrKernels& kernels = image::uastc_hdr_kernels(set);
    const auto group = std::make_unique<image::BlockGroup>();
    std::vector<const float*> rows;
    for (int block = 0; block < 16; ++block) {
      for (int k = 0; k < 4; ++k) rows.push_back(chain.face(0, 1) + 3 * (16 * (block / 4 * 4 + k) + block % 4 * 4));
    }
    blocks.load(rows.data(), *group);
    for (auto& weights : group->weights) std::fill(std::begin(weights), std::end(weights), 1.0F);
    std::array<std::int32_t, 16> numbers{};
    alignas(64) float light[3][16];
    blocks.prepare(*group, false, numbers.data(), light);
    kernels.take_logarithms(*group, numbers.data());
    alignas(64) float partitions[4][16];
    kernels.rank_partitions(*group, image::kUastcPartitions, 4, partitions);
    image::BlockLines fitted{};
    image::BlockIndices found{};
    kernels.fit_lines(*group, partitions[0], nullptr, fitted);
    kernels.index_lines(*group, partitions[0], fitted, found);
    if (set == available_instruction_sets().front()) {
      first_fitted = fitted;
      first_found = found;
    }
    CHECK(std::memcmp(&fitted, &first_fitted, sizeof fitted) == 0);
    CHECK(std::memcmp(&found, &first_found, sizeof found) == 0);
  }
}

TEST_CASE("UASTC HDR clamps what halves cannot hold, and counts it", "[codec][textures][uastc]") {
  Cubemap chain = changed(Cubemap(5, 1), [](float) { return 1.0F; });
  chain.face(0, 0)[0] = -1.0F;
  chain.face(0, 1)[1] = std::numeric_limits<float>::quiet_NaN();
  chain.face(0, 2)[3 * 24 + 2] = std::numeric_limits<float>::infinity();
  TextureOptions options{.format = TexelFormat::uastc_hdr_4x4};
  std::vector<std::byte> bytes;
  CHECK(write_texture({bytes, "sky.ktx2"}, chain.views(), options).values_clamped == 3);
}

TEST_CASE("UASTC HDR comes back within its errors, more effort with less", "[codec][textures][astc][uastc]") {
  const Cubemap sky = build_mips(make_cubemap(Content::high_range, 256, 3, 5).view());
  const Cubemap chain = prefilter_specular(sky.view(0), {.size = 128, .mips = 8}).cubemap;
  double last = 0.16;  // the image is noise
  for (const Bc6hEffort effort : kEfforts) {
    const double error = rms_error(read_back(written(chain, effort)), chain);
    CAPTURE(static_cast<int>(effort), error);
    CHECK(error < last);
    last = error;
  }
  CHECK(written(chain) == written(chain));
}

TEST_CASE("ASTC and UASTC HDR keep the mean of each channel where a sun has most of the light",
          "[codec][textures][astc][uastc]") {
  const Cubemap chain = sun_chain(128);
  const auto check = [&chain](const std::vector<std::byte>& bytes, double bound) {
    const Cubemap decoded = read_back(bytes);
    for (int level = 0; level < 4; ++level) {  // down to 16 texels
      CAPTURE(bound, level);
      CHECK(largest_bias(decoded, chain, level) < bound);
    }
  };
  std::vector<std::byte> astc;
  write_texture({astc, "sky.ktx2"}, chain.views(), in_astc(TexelFormat::astc_4x4_hdr));
  check(astc, 0.025);
  // One texel of 50000 over 1: ends far apart have steps of 9 % and more.
  for (const Bc6hEffort effort : kEfforts) check(written(chain, effort), 0.05);
}

TEST_CASE("UASTC HDR errors and biases of real images' chains stay within their bounds",
          "[codec][textures][astc][uastc][images][slow]") {
  if (!shared_images_are_here()) return;
  for (const char* const file : {"lebombo_1k.hdr", "studio_small_03_1k.hdr", "venice_sunset_1k.hdr"}) {
    CAPTURE(file);
    PrefilterOptions options{.size = 128, .mips = 8};
    const Environment image = read_environment(kImages / "env" / file);
    const Cubemap chain = prefilter_specular(image.lat_long(), options).cubemap;
    const Cubemap decoded = read_back(written(chain));
    CHECK(rms_error(decoded, chain) < 0.04);
    for (int level = 0; level < 4; ++level) CHECK(largest_bias(decoded, chain, level) < 0.004);
  }
}

}  // namespace welkin::test
