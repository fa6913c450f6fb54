// KTX2 textures in blocks of UASTC HDR.
#include "image/uastc_hdr.h"

#include "image/bc6h_kernels.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {

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
  const auto number = [&](double least, double most) {
    return static_cast<float>(std::uniform_real_distribution<double>(least, most)(random));
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

TEST_CASE("UASTC HDR keeps the mean of each channel where a sun has most of the light",
          "[codec][textures][astc][uastc]") {
  const Cubemap chain = sun_chain(128);
  for (const Bc6hEffort effort : kEfforts) {
    const Cubemap decoded = read_back(written(chain, effort));
    for (int level = 0; level < 4; ++level) {  // down to 16 texels
      CAPTURE(static_cast<int>(effort), level);
      CHECK(largest_bias(decoded, chain, level) <
            0.05);  // one texel of 50000 over 1: ends far apart have steps of 9 % and more
    }
  }
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
