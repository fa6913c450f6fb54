// BC6H blocks: their bits, and the halves that they stand for.
#include "image/bc6h.h"

#include "image/bc6h_kernels.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "support/bc6h_files.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promises: every block of every mode decodes to the halves that another decoder gives; each bit of a block belongs to
// one number, and the numbers packed again are the same block.

namespace {

using image::Bc6hFields, image::Bc6hRange, image::kBlockBytes, image::kBlockTexels;
using Block = std::array<std::uint8_t, kBlockBytes>;

Block with_mode(Block block, int mode) {
  const image::Bc6hMode& found = image::bc6h_mode(mode);
  const auto mask = static_cast<std::uint8_t>((1 << found.prefix_bits) - 1);
  block[0] = static_cast<std::uint8_t>((block[0] & ~mask) | found.prefix);
  return block;
}

/// How many bits of their numbers two blocks differ in.
int different_bits(const Bc6hFields& a, const Bc6hFields& b) {
  int count = std::popcount(static_cast<unsigned>(a.partition ^ b.partition));
  for (std::size_t end = 0; end < 4; ++end) {
    for (std::size_t c = 0; c < 3; ++c) count += std::popcount(a.ends[end][c] ^ b.ends[end][c]);
  }
  for (std::size_t k = 0; k < kBlockTexels; ++k) {
    count += std::popcount(static_cast<unsigned>(a.indices[k] ^ b.indices[k]));
  }
  return count;
}

}  // namespace

TEST_CASE("BC6H blocks of all modes decode as OpenImageIO decodes them", "[image][bc6h]") {
  std::set<std::pair<int, bool>> modes;
  for (const RecordedBlock& block : recorded_blocks()) {
    std::array<std::uint16_t, 3 * kBlockTexels> halves{};
    image::decode_bc6h(block.bytes.data(), block.range, halves.data());
    const int mode = image::unpack_bc6h(block.bytes.data()).mode;
    CAPTURE(mode);
    CHECK(halves == block.halves);
    modes.emplace(mode, block.range == Bc6hRange::positive);
  }
  CHECK(modes.size() == 2 * (image::kBc6hModes + 1));  // with the reserved ones, which are black
}

TEST_CASE("each bit of a BC6H block is one bit of one of its numbers", "[image][bc6h]") {
  std::mt19937 random(3);
  for (int mode = 1; mode <= image::kBc6hModes; ++mode) {
    CAPTURE(mode);
    for (int trial = 0; trial < 64; ++trial) {
      Block block{};
      for (std::uint8_t& byte : block) byte = static_cast<std::uint8_t>(random());
      block = with_mode(block, mode);
      const Bc6hFields fields = image::unpack_bc6h(block.data());
      REQUIRE(fields.mode == mode);
      Block packed{};
      image::pack_bc6h(fields, packed.data());
      REQUIRE(packed == block);
      const image::Bc6hMode& found = image::bc6h_mode(mode);
      // A bit of the partition may move an anchor, and with it all later indices: it is not flipped here.
      for (int bit = found.prefix_bits; bit < 128; ++bit) {
        if (found.two_lines && bit >= 77 && bit < 82) continue;
        Block turned = block;
        turned[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        REQUIRE(different_bits(fields, image::unpack_bc6h(turned.data())) == 1);
      }
    }
  }
}

TEST_CASE("a partition's anchor lies in its second line", "[image][bc6h]") {
  for (int partition = 0; partition < 32; ++partition) {
    CHECK((image::bc6h_second_line(partition) >> image::bc6h_anchor(partition) & 1) == 1);
    CHECK((image::bc6h_second_line(partition) & 1) == 0);
  }
}

TEST_CASE("rows of BC6H blocks are cut where they are asked for", "[image][bc6h]") {
  const std::vector<RecordedBlock> recorded = recorded_blocks();
  for (const int width : {1, 2, 3, 4, 7, 16}) {
    const int across = image::blocks_across(width);
    std::vector<std::uint8_t> blocks;
    for (int k = 0; k < across * across; ++k) {
      const auto& bytes = recorded[static_cast<std::size_t>(k)].bytes;
      blocks.insert(blocks.end(), bytes.begin(), bytes.end());
    }
    const auto row_values = 3 * static_cast<std::size_t>(width);
    std::vector<float> whole(row_values * static_cast<std::size_t>(width));
    image::decode_bc6h_rows(blocks.data(), Bc6hRange::positive, width, 0, width, whole.data());
    for (int row = 0; row < width; ++row) {
      for (int rows = 1; row + rows <= width; ++rows) {
        std::vector<float> some(row_values * static_cast<std::size_t>(rows));
        const auto skipped = kBlockBytes * static_cast<std::size_t>(row / 4 * across);
        image::decode_bc6h_rows(blocks.data() + skipped, Bc6hRange::positive, width, row, rows, some.data());
        const float* const wanted = whole.data() + row_values * static_cast<std::size_t>(row);
        CHECK(same_bytes<float>(some, {wanted, some.size()}));
      }
    }
    std::array<std::uint16_t, 3 * kBlockTexels> last{};
    image::decode_bc6h(blocks.data() + blocks.size() - kBlockBytes, Bc6hRange::positive, last.data());
    const int slot = (width - 1) % 4;
    CHECK(whole.back() == image::float_from_half(last[static_cast<std::size_t>(3 * (4 * slot + slot) + 2)]));
  }
}

// Cubemaps to BC6H: the same bytes everywhere, errors that are what is said, and bounds on them.

// Promises: the bytes do not depend on the instruction set nor on the number of threads; the kernels' errors are
// exactly those of the blocks; what is beyond an image's edge costs nothing; what cannot be held is counted; errors of
// real images' chains and of a made-up one stay within their bounds, at every effort.

namespace {

constexpr std::array kEfforts{Bc6hEffort::fast, Bc6hEffort::normal, Bc6hEffort::slow};

Cubemap sky(int size, Content content = Content::high_range) {
  return build_mips(make_cubemap(content, size, 3, 5).view());
}

/// 16 blocks of an image, as `load` puts them.
std::unique_ptr<image::BlockGroup> group_of(const Cubemap& chain, int first, const image::Bc6hKernels& kernels,
                                            bool is_signed) {
  auto group = std::make_unique<image::BlockGroup>();
  const int size = chain.level_size(0);
  std::vector<const float*> rows;
  for (int block = first; block < first + 16; ++block) {
    const int column = 4 * block % size;
    const int row = 4 * block / size * 4;
    for (int k = 0; k < 4; ++k) rows.push_back(chain.face(0, 2) + 3 * (size * (row + k) + column));
  }
  kernels.load(rows.data(), *group);
  for (auto& weights : group->weights) std::fill(std::begin(weights), std::end(weights), 1.0F);
  std::array<std::int32_t, 16> clamped{};
  alignas(64) float light[3][16];
  kernels.prepare(*group, is_signed, clamped.data(), light);
  return group;
}

/// In double: the squares of what a block's halves differ from the group's, in units of their last bits.
double squares(const image::BlockGroup& group, std::size_t lane, const std::uint8_t* block, bool is_signed) {
  std::array<std::uint16_t, 48> halves{};
  image::decode_bc6h(block, is_signed ? image::Bc6hRange::signed_values : image::Bc6hRange::positive, halves.data());
  double sum = 0.0;
  for (std::size_t k = 0; k < halves.size(); ++k) {
    const int size = halves[k] & 0x7FFF;
    const double off =
        static_cast<double>((halves[k] & 0x8000) != 0 ? -size : size) - static_cast<double>(group.values[k][lane]);
    sum += off * off;
  }
  return sum;
}

std::array<std::uint8_t, 16> packed(const image::TwoLineBlocks& pair, std::size_t lane) {
  image::Bc6hFields fields{pair.modes[lane], pair.partitions[lane]};
  for (std::size_t k = 0; k < 12; ++k) {
    const bool difference = k >= 3 && image::bc6h_mode(fields.mode).differences;
    fields.ends[k / 3][k % 3] =
        static_cast<std::uint32_t>(pair.ends[k][lane] - (difference ? pair.ends[k % 3][lane] : 0));
  }
  for (std::size_t k = 0; k < 16; ++k) fields.indices[k] = static_cast<std::uint8_t>(pair.indices[k][lane]);
  std::array<std::uint8_t, 16> block{};
  image::pack_bc6h(fields, block.data());
  return block;
}

/// All ends from 0 or the lowest to the highest, and all 16 indices.
image::EndTrials some_trials(bool is_signed) {
  image::EndTrials trials{};
  const float lowest = is_signed ? -32767.0F : 0.0F;
  for (int k = 0; k < 16; ++k) {
    trials.low[k] = lowest + static_cast<float>(k * 1234);
    trials.high[k] = static_cast<float>(k == 0 ? 3 : 32767 - k * k * 97);
    trials.along[k] = static_cast<float>((17 * k + 2) >> 2) / 64.0F;
    trials.wanted[k] = static_cast<float>(k * 1500 - (is_signed ? 9000 : 0));
  }
  trials.texels = 16;
  return trials;
}

double chain_error(const Bc6hCubemap& blocks, const Cubemap& chain) {
  const std::vector<double> errors = bc6h_errors(blocks, chain.views());
  double sum = 0.0;
  double texels = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    const double here = static_cast<double>(face_values(chain, level));
    sum += here * errors[static_cast<std::size_t>(level)] * errors[static_cast<std::size_t>(level)];
    texels += here;
  }
  return std::sqrt(sum / texels);
}

}  // namespace

TEST_CASE("BC6H kernels give the same blocks on every instruction set, and their exact errors", "[image][bc6h]") {
  const Cubemap chain = sky(64);
  const Cubemap noise = noisy_chain(64, 1, 4);
  for (const bool is_signed : {false, true}) {
    for (const Cubemap* const image : {&chain, &noise}) {
      image::EncodedBlocks first_single{};
      image::TwoLineBlocks first_pair{};
      image::EndTrials first_trials{};
      for (const InstructionSet set : available_instruction_sets()) {
        CAPTURE(is_signed, name(set));
        const image::Bc6hKernels& kernels = image::bc6h_kernels(set);
        const auto group = group_of(*image, 32, kernels, is_signed);
        image::EncodedBlocks single{};
        image::TwoLineBlocks pair{};
        kernels.single_lines(*group, is_signed, true, single);
        kernels.two_lines(*group, is_signed, 4, pair);
        for (std::size_t lane = 0; lane < 16; ++lane) {
          const auto block = image::block_of(single, lane);
          const double wanted = squares(*group, lane, block.data(), is_signed);
          CHECK(std::abs(static_cast<double>(single.errors[lane]) - wanted) <= 1e-6 * wanted);
          const double of_pair = squares(*group, lane, packed(pair, lane).data(), is_signed);
          CHECK(std::abs(static_cast<double>(pair.errors[lane]) - of_pair) <= 1e-6 * of_pair);
        }
        image::EndTrials trials = some_trials(is_signed);
        kernels.try_ends(trials, is_signed);
        if (set == available_instruction_sets().front()) {
          first_single = single;
          first_pair = pair;
          first_trials = trials;
        }
        CHECK(std::memcmp(&trials, &first_trials, sizeof trials) == 0);
        CHECK(std::memcmp(&single, &first_single, sizeof single) == 0);
        CHECK(std::memcmp(&pair, &first_pair, sizeof pair) == 0);
      }
    }
  }
}

TEST_CASE("BC6H kernels try ends as the decoder reads them", "[image][bc6h]") {
  for (const bool is_signed : {false, true}) {
    const image::Bc6hRange range = is_signed ? image::Bc6hRange::signed_values : image::Bc6hRange::positive;
    image::EndTrials trials = some_trials(is_signed);
    image::bc6h_kernels().try_ends(trials, is_signed);
    for (int lane = 0; lane < 16; ++lane) {
      image::Bc6hFields fields{14, 0, {}, {}};  // of 16 bits, which are stored as they are
      image::Bc6hNumbers numbers{};
      numbers[0][1] = static_cast<std::int32_t>(trials.low[lane]);
      numbers[1][1] = static_cast<std::int32_t>(trials.high[lane]);
      for (std::size_t k = 0; k < 16; ++k) fields.indices[k] = static_cast<std::uint8_t>(k);
      std::array<std::uint16_t, 16> halves{};
      image::decode_bc6h_channel(fields, numbers, 1, range, halves.data());
      double squares = 0.0;
      double light = 0.0;
      for (std::size_t k = 0; k < 16; ++k) {
        const int size = halves[k] & 0x7FFF;
        const double off = ((halves[k] & 0x8000) != 0 ? -size : size) - static_cast<double>(trials.wanted[k]);
        squares += off * off;
        light += static_cast<double>(image::float_from_half(halves[k]));
      }
      CAPTURE(is_signed, lane, squares, light);
      CHECK(std::abs(static_cast<double>(trials.squares[lane]) - squares) <= 1e-6 * squares);
      CHECK(std::abs(static_cast<double>(trials.light[lane]) - light) <= 1e-5 * std::abs(light) + 1e-2);
    }
  }
}

TEST_CASE("one colour is exact in BC6H at every size, and negatives where there is a sign", "[image][bc6h]") {
  for (const int size : {1, 2, 3, 4, 7, 64, 257}) {
    Cubemap chain(size, full_chain_levels(size));
    for (const float value : {0.0F, 0x1p-24F, 0.3F, 1.0F, 65504.0F}) {
      for (const bool is_signed : {false, true}) {
        CAPTURE(size, value, is_signed);
        const float signed_value = is_signed ? -value : value;
        chain = changed(chain, [&](float) { return signed_value; });
        const Cubemap decoded = decode_bc6h(encode_bc6h(chain.views(), {Bc6hEffort::normal, is_signed}));
        const float half = image::float_from_half(image::half_from_float(signed_value));
        CHECK(all_values(decoded, chain, [&](float a, float) {
          // A step of the signed format is two halves where a block stores 16 bits.
          return std::abs(a - half) <= (is_signed ? std::abs(half) / 512.0F + 0x1p-23F : 0.0F);
        }));
      }
    }
  }
}

TEST_CASE("what lies beyond a small face does not touch BC6H's texels", "[image][bc6h]") {
  for (const int size : {1, 2}) {
    const Cubemap chain = noisy_chain(size, 1, 2);
    const Bc6hCubemap blocks = encode_bc6h(chain.views());
    CHECK(bc6h_errors(blocks, chain.views()).front() < (size == 1 ? 0.0006 : 0.25));
  }
}

TEST_CASE("BC6H clamps what halves cannot hold, and counts texels once", "[image][bc6h]") {
  for (const int size : {1, 2, 3, 5, 16}) {
    Cubemap chain = changed(Cubemap(size, 1), [](float) { return 1.0F; });
    chain.face(0, 0)[0] = -1.0F;
    chain.face(0, 1)[1] = std::numeric_limits<float>::quiet_NaN();
    chain.face(0, 2)[3 * (size * size - 1) + 2] = std::numeric_limits<float>::infinity();
    chain.face(0, 3)[0] = 65505.0F;
    CHECK(encode_bc6h(chain.views()).values_clamped == 4);
    CHECK(encode_bc6h(chain.views(), {Bc6hEffort::fast, true}).values_clamped == 3);
    const Cubemap decoded = decode_bc6h(encode_bc6h(chain.views()));
    CHECK(all_values(decoded, chain, [](float a, float) { return a >= 0.0F && a <= 65504.0F; }));
  }
}

TEST_CASE("BC6H's estimate is near its error, and more effort has less", "[image][bc6h][slow]") {
  const Cubemap chain = prefilter_specular(sky(256).view(0), {.size = 128, .mips = 8}).cubemap;
  double last = 0.15;  // the image is noise, of which 14 % is lost with one line
  for (const Bc6hEffort effort : kEfforts) {
    const Bc6hCubemap blocks = encode_bc6h(chain.views(), {effort});
    const std::vector<double> errors = bc6h_errors(blocks, chain.views());
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level, errors[level], blocks.levels[level].estimated_error);
      CHECK(std::abs(blocks.levels[level].estimated_error - errors[level]) <= 0.15 * errors[level] + 0.0002);
    }
    const double error = chain_error(blocks, chain);
    CAPTURE(error);
    CHECK(error <= last);
    last = error;
  }
}

TEST_CASE("BC6H keeps the mean of each channel where a sun has most of the light", "[image][bc6h]") {
  const Cubemap chain = sun_chain(128);
  for (const Bc6hEffort effort : kEfforts) {
    for (const bool is_signed : {false, true}) {
      const Bc6hCubemap blocks = encode_bc6h(chain.views(), {effort, is_signed});
      const Cubemap decoded = decode_bc6h(blocks);
      for (int level = 0; level < 4; ++level) {  // down to 16 texels
        CAPTURE(static_cast<int>(effort), is_signed, level);
        CHECK(largest_bias(decoded, chain, level) < (is_signed ? 0.008 : 0.005));  // up to 0.05 where nothing is done
      }
    }
  }
}

TEST_CASE("BC6H errors and biases of real images' chains stay within their bounds", "[image][bc6h][images][slow]") {
  if (!shared_images_are_here()) return;
  std::array<double, 3> sums{};
  const std::array names{"dikhololo_night_1k.hdr", "lebombo_1k.hdr",        "pmndrs_city.exr",
                         "potsdamer_platz_1k.hdr", "spruit_sunrise_1k.hdr", "studio_small_03_1k.hdr",
                         "venice_sunset_1k.hdr"};
  for (const char* const file : names) {
    CAPTURE(file);
    const Environment image = read_environment(kImages / "env" / file);
    PrefilterOptions options{.size = 256, .mips = 9};
    const Cubemap chain = prefilter_specular(image.lat_long(), options).cubemap;
    for (std::size_t effort = 0; effort < kEfforts.size(); ++effort) {
      const Bc6hCubemap blocks = encode_bc6h(chain.views(), {kEfforts[effort]});
      const double error = chain_error(blocks, chain);
      sums[effort] += error * error / static_cast<double>(names.size());
      const Cubemap decoded = decode_bc6h(blocks);
      for (int level = 0; level < 5; ++level) {  // down to 16 texels
        CAPTURE(effort, level);
        CHECK(largest_bias(decoded, chain, level) < 0.003);
      }
    }
  }
  CAPTURE(std::sqrt(sums[0]), std::sqrt(sums[1]), std::sqrt(sums[2]));
  CHECK(std::sqrt(sums[0]) < 0.035);
  CHECK(std::sqrt(sums[1]) < 0.025);
  CHECK(std::sqrt(sums[2]) < 0.0245);
}

TEST_CASE("BC6H of chains that do not fit is refused", "[image][bc6h]") {
  const Cubemap chain = noisy_chain(8, 4);
  std::vector<CubemapView> uneven = {chain.view(0), chain.view(2)};
  CHECK(thrown_by([&] { (void)encode_bc6h(uneven); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)encode_bc6h({}); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)encode_bc6h(chain.views(), {static_cast<Bc6hEffort>(3)}); }).says("effort"));
  Bc6hCubemap blocks = encode_bc6h(chain.views());
  CHECK(thrown_by([&] { (void)bc6h_errors(blocks, noisy_chain(4, 3).views()); }).says("differ in size"));
  blocks.levels[1].blocks.pop_back();
  CHECK(thrown_by([&] { (void)decode_bc6h(blocks); }).says("level 1 of the BC6H cubemap has 4 texels"));
  blocks.levels.clear();
  CHECK(thrown_by([&] { (void)decode_bc6h(blocks); }).says("needs a level"));
}

}  // namespace welkin::test
