// Cubemaps and images to BC6H and back.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/image.h"

namespace welkin::image {
namespace {

// ---- The light of a level: the ends of its brightest blocks are changed until each channel's mean is within 0.2 %, as
// far as possible

/// A lane's block with two lines.
Bc6hFields fields_of(const TwoLineBlocks& pair, std::size_t lane) noexcept {
  Bc6hFields fields;
  fields.mode = pair.modes[lane];
  fields.partition = pair.partitions[lane];
  const bool differences = bc6h_mode(fields.mode).differences;
  for (std::size_t end = 0; end < 4; ++end) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t first = differences && end > 0 ? pair.ends[c][lane] : 0;
      fields.ends[end][c] = static_cast<std::uint32_t>(pair.ends[3 * end + c][lane] - first);
    }
  }
  for (std::size_t k = 0; k < fields.indices.size(); ++k) {
    fields.indices[k] = static_cast<std::uint8_t>(pair.indices[k][lane]);
  }
  return fields;
}

/// Passes over the blocks with a large share: a change of one block changes what is best for the next.
constexpr int kSweeps = 3;

/// Beyond the tolerance, an error of 0.2 % of a mean costs as much as this share of the level's squared error.
constexpr double kWorth = 0.0005;

/// Steps that an end is moved either way.
constexpr int kReach = 3;
constexpr int kChoices = 2 * kReach + 1;

std::int32_t number_of(std::uint16_t half) noexcept { return (half & 0x8000) != 0 ? -(half & 0x7FFF) : half; }

/// Errors of one channel of a block.
struct ChannelError {
  double squares = 0.0;
  double light = 0.0;  ///< too much
};

/// A way to store a block.
struct Candidate {
  Bc6hFields fields;
  std::array<ChannelError, 3> errors;
  double cost = 0.0;
};

class Balancer {
 public:
  Balancer(const std::vector<LatLongView>& images, const BlockFormat& format, EncodedLevels::Level& level)
      : images_(images),
        format_(format),
        total_(total_light(level.lights)),
        brightest_(brightest_blocks(level.lights, total_)),
        range_(format.is_signed ? Bc6hRange::signed_values : Bc6hRange::positive),
        worth_(kWorth * level.squares / (kMeanTolerance * kMeanTolerance)),
        blocks_(level.blocks.data()) {}

  /// Returns by how much the level's sum of squared errors grows.
  double run() {
    for (const auto& [share, block] : brightest_) {
      read(block);
      const std::array<ChannelError, 3> errors = errors_of(block);
      for (std::size_t c = 0; c < 3; ++c) off_[c] += errors[c].light;
    }
    double growth = 0.0;
    if (is_balanced()) return growth;
    const auto large =
        std::find_if(brightest_.begin(), brightest_.end(), [](const BlockShare& s) { return s.share < kLargeShare; });
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (auto each = brightest_.begin(); each != large; ++each) growth += improve(each->block, sweep == 0);
    }
    for (auto each = large; each != brightest_.end() && !is_balanced(); ++each) growth += improve(each->block, false);
    return growth;
  }

 private:
  [[nodiscard]] bool is_balanced(std::size_t c) const { return excess_of_mean(off_[c], total_[c]) <= 0.0; }
  [[nodiscard]] bool is_balanced() const { return is_balanced(0) && is_balanced(1) && is_balanced(2); }

  [[nodiscard]] std::uint8_t* bytes_of(std::size_t block) const { return blocks_ + kBlockBytes * block; }

  void read(std::size_t block) {
    wanted_ = block_texels(images_, block, format_.least());
    for (std::size_t k = 0; k < halves_.size(); ++k) halves_[k] = number_of(half_from_float(wanted_.values[k]));
  }

  /// The channels of the block that was read last.
  [[nodiscard]] std::array<ChannelError, 3> errors_of(std::size_t block) const {
    std::array<std::uint16_t, 3 * kBlockTexels> halves{};
    decode_bc6h(bytes_of(block), range_, halves.data());
    std::array<ChannelError, 3> errors;
    for (std::size_t k = 0; k < halves.size(); ++k) {
      if (!wanted_.inside[k / 3]) continue;
      const double off = number_of(halves[k]) - halves_[k];
      errors[k % 3].squares += off * off;
      errors[k % 3].light += static_cast<double>(float_from_half(halves[k])) - static_cast<double>(wanted_.values[k]);
    }
    return errors;
  }

  /// `rest`: what all other blocks have too much of.
  [[nodiscard]] double cost_of(const ChannelError& error, double rest, std::size_t c) const {
    const double excess = excess_of_mean(rest + error.light, total_[c]);
    // worth_ kMeanTolerance^2 = kWorth times the level's squared error: see kWorth.
    return error.squares + worth_ * excess * excess;
  }

  /// Makes a line's texels those of the trials, and returns the light that they should have.
  double set_texels(const Bc6hFields& fields, std::size_t line, std::size_t c) {
    const unsigned second = bc6h_mode(fields.mode).two_lines ? bc6h_second_line(fields.partition) : 0U;
    double light = 0.0;
    trials_.texels = 0;
    for (std::size_t k = 0; k < kBlockTexels; ++k) {
      if ((second >> k & 1U) != line || !wanted_.inside[k]) continue;
      const auto at = static_cast<std::size_t>(trials_.texels++);
      trials_.along[at] = static_cast<float>(bc6h_weight(fields.indices[k], fields.mode)) / 64.0F;
      trials_.wanted[at] = static_cast<float>(halves_[3 * k + c]);
      light += static_cast<double>(wanted_.values[3 * k + c]);
    }
    return light;
  }

  [[nodiscard]] float end_of(std::int32_t number, int mode) const {
    return static_cast<float>(bc6h_end(number, mode, range_));
  }

  void try_ends() { bc6h_kernels().try_ends(trials_, format_.is_signed); }

  [[nodiscard]] ChannelError tried(int lane, double wanted_light) const {
    return {static_cast<double>(trials_.squares[lane]), static_cast<double>(trials_.light[lane]) - wanted_light};
  }

  [[nodiscard]] ChannelError line_error(const Bc6hFields& fields, std::size_t line, std::size_t c) {
    const double wanted_light = set_texels(fields, line, c);
    const Bc6hNumbers numbers = bc6h_numbers(fields, range_);
    std::fill_n(trials_.low, simd::kLanes, end_of(numbers[2 * line][c], fields.mode));
    std::fill_n(trials_.high, simd::kLanes, end_of(numbers[2 * line + 1][c], fields.mode));
    try_ends();
    return tried(0, wanted_light);
  }

  /// Moves a line's ends of one channel to where the cost is least. `rest`: what all else has too much of.
  /// Indices stay, so that the decoded values of a channel depend on that channel's two ends of the line alone:
  /// (2 kReach + 1)^2 = 49 pairs of numbers are all there is to try, 16 at a time.
  void move_ends(std::size_t line, std::size_t c, double rest, Bc6hFields& fields, ChannelError& error) {
    const double wanted_light = set_texels(fields, line, c);
    const Bc6hNumbers first = bc6h_numbers(fields, range_);
    std::array<float, kChoices> lows{};
    std::array<float, kChoices> highs{};
    for (int k = 0; k < kChoices; ++k) {
      lows[static_cast<std::size_t>(k)] = end_of(first[2 * line][c] + k - kReach, fields.mode);
      highs[static_cast<std::size_t>(k)] = end_of(first[2 * line + 1][c] + k - kReach, fields.mode);
    }
    double lowest = cost_of(error, rest, c);
    for (int choice = 0; choice < kChoices * kChoices; ++choice) {
      const int lane = choice % simd::kLanes;
      if (lane == 0) {
        for (int k = 0; k < simd::kLanes; ++k) {
          const int other = std::min(choice + k, kChoices * kChoices - 1);
          trials_.low[k] = lows[static_cast<std::size_t>(other % kChoices)];
          trials_.high[k] = highs[static_cast<std::size_t>(other / kChoices)];
        }
        try_ends();
      }
      const ChannelError other = tried(lane, wanted_light);
      const double cost = cost_of(other, rest, c);
      if (cost >= lowest) continue;
      Bc6hNumbers numbers = first;
      numbers[2 * line][c] += choice % kChoices - kReach;
      numbers[2 * line + 1][c] += choice / kChoices - kReach;
      if (!store_bc6h_numbers(numbers, c, range_, fields)) continue;
      lowest = cost;
      error = other;
    }
  }

  [[nodiscard]] Candidate improved(const Bc6hFields& fields, const ChannelSums& rest) {
    Candidate candidate{fields, {}, 0.0};
    const std::size_t lines = bc6h_mode(fields.mode).two_lines ? 2 : 1;
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<ChannelError, 2> errors{};
      for (std::size_t line = 0; line < lines; ++line) errors[line] = line_error(fields, line, c);
      for (std::size_t line = 0; line < lines; ++line) {
        // Nothing is changed as soon as the mean is within the tolerance: each step away from the fitted ends costs
        // squared error.
        if (excess_of_mean(rest[c] + errors[0].light + errors[1].light, total_[c]) <= 0.0) break;
        move_ends(line, c, rest[c] + errors[1 - line].light, candidate.fields, errors[line]);
      }
      candidate.errors[c] = {errors[0].squares + errors[1].squares, errors[0].light + errors[1].light};
      candidate.cost += cost_of(candidate.errors[c], rest[c], c);
    }
    return candidate;
  }

  /// The block as the kernels encode it, with one line and with two.
  [[nodiscard]] std::array<Bc6hFields, 2> encoded() {
    const Bc6hKernels& kernels = bc6h_kernels();
    fill_group(wanted_, group_);
    std::array<std::int32_t, simd::kLanes> clamped{};
    alignas(64) float light[3][simd::kLanes];
    kernels.prepare(group_, format_.is_signed, clamped.data(), light);
    kernels.single_lines(group_, format_.is_signed, true, single_);
    kernels.two_lines(group_, format_.is_signed, 1, pair_);
    return {unpack_bc6h(block_of(single_, 0).data()), fields_of(pair_, 0)};
  }

  /// `reencode`: the block may also be encoded again in another way.
  double improve(std::size_t block, bool reencode) {
    read(block);
    double growth = 0.0;
    const std::array<ChannelError, 3> errors = errors_of(block);
    for (std::size_t c = 0; c < 3; ++c) {
      off_[c] -= errors[c].light;
      growth -= errors[c].squares;
    }
    // Descent along one block at a time: with all others as they are, the level's cost depends on this block's squared
    // error and on `rest` plus its light.
    const ChannelSums rest = off_;
    Candidate best = improved(unpack_bc6h(bytes_of(block)), rest);
    if (reencode) {
      for (const Bc6hFields& fields : encoded()) {
        const Candidate other = improved(fields, rest);
        if (other.cost < best.cost) best = other;
      }
    }
    pack_bc6h(best.fields, bytes_of(block));
    for (std::size_t c = 0; c < 3; ++c) {
      off_[c] += best.errors[c].light;
      growth += best.errors[c].squares;
    }
    return growth;
  }

  const std::vector<LatLongView>& images_;
  const BlockFormat& format_;
  ChannelSums total_;
  std::vector<BlockShare> brightest_;
  Bc6hRange range_;
  double worth_;
  std::uint8_t* blocks_;
  ChannelSums off_{};                                    ///< what the level has too much of
  BlockTexels wanted_{};                                 ///< that the block should hold which was read last
  std::array<std::int32_t, 3 * kBlockTexels> halves_{};  ///< of those, as numbers, negative ones negative
  BlockGroup group_{};
  EncodedBlocks single_{};
  TwoLineBlocks pair_{};
  EndTrials trials_{};
};

// ---- Blocks

void encode_single_lines(BlockGroup& group, const BlockFormat& format, EncodedBlocks& to) {
  bc6h_kernels().single_lines(group, format.is_signed, format.effort != Bc6hEffort::fast, to);
}

void encode_two_lines(const BlockGroup& group, const BlockFormat& format, EncodedBlocks& to) {
  TwoLineBlocks pair;
  bc6h_kernels().two_lines(group, format.is_signed, format.partitions_tried(), pair);
  for (std::size_t lane = 0; lane < simd::kLanes; ++lane) {
    std::array<std::uint8_t, kBlockBytes> block;
    pack_bc6h(fields_of(pair, lane), block.data());
    set_block(to, lane, block.data(), pair.errors[lane]);
  }
}

}  // namespace

EncodedLevels encode_bc6h_images(std::span<const std::vector<LatLongView>> levels, const Bc6hOptions& options,
                                 const Control& control) {
  const BlockFormat format{options.effort, options.is_signed, encode_single_lines, encode_two_lines,
                           [](const std::vector<LatLongView>& images, const BlockFormat& self,
                              EncodedLevels::Level& level) { level.squares += Balancer(images, self, level).run(); }};
  return encode_images(levels, format, control);
}

}  // namespace welkin::image

namespace welkin {
namespace {

/// A unit in a half's last place is 2^-10 / m of a value, with m from 1 to 2. This is the mean of 1 / m^2 over the
/// texels of seven images' chains, by what the errors came to. (Of evenly spread logarithms it would be 0.54.)
constexpr double kMeanSquareOfUnits = 0.51;

/// Bytes of the blocks of six faces.
std::size_t block_bytes(int size) { return 6 * image::block_bytes(size, size); }

std::int64_t texels_of(int size) { return std::int64_t{6} * size * size; }

/// Sizes and bytes of what may come from elsewhere.
void check(const Bc6hCubemap& cubemap) {
  const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, message); };
  if (cubemap.levels.empty()) refuse("a BC6H cubemap needs a level at least; it has none");
  const int size = cubemap.levels.front().size;
  image::require_range("the size of level 0 of the BC6H cubemap", size, 1, image::kLargestFace);
  if (cubemap.levels.size() > static_cast<std::size_t>(full_chain_levels(size))) {
    refuse("the BC6H cubemap has " + std::to_string(cubemap.levels.size()) + " levels; from " + std::to_string(size) +
           " texels down there are " + std::to_string(full_chain_levels(size)));
  }
  for (std::size_t level = 0; level < cubemap.levels.size(); ++level) {
    const Bc6hLevel& here = cubemap.levels[level];
    const int wanted = std::max(1, size >> static_cast<int>(level));
    if (here.size != wanted || here.blocks.size() != block_bytes(wanted)) {
      refuse("level " + std::to_string(level) + " of the BC6H cubemap has " + std::to_string(here.size) +
             " texels along an edge and " + std::to_string(here.blocks.size()) + " bytes; it must have " +
             std::to_string(wanted) + " and " + std::to_string(block_bytes(wanted)));
    }
  }
}

/// The sum of the squares of a face's relative errors.
double face_squares(const CubemapView& given, const float* decoded, int face, bool is_signed) {
  // 2^-14, the least normal half: below it halves have a fixed step, and a relative error says nothing.
  constexpr double floor = 1.0 / 16384.0;
  const auto values = 3 * static_cast<std::size_t>(given.size);
  std::vector<float> row(values);
  const float minimum = is_signed ? -image::kLargestHalf : 0.0F;
  double sum = 0.0;
  for (int line = 0; line < given.size; ++line, decoded += values) {
    image::decode_texels(given.format, image::row_of(given, face, line), given.size, row.data());
    for (std::size_t k = 0; k < values; ++k) {
      // As the encoder clamps it, so that what a half cannot hold is no error of the blocks.
      const float held = row[k] >= minimum ? std::min(row[k], image::kLargestHalf) : row[k] < minimum ? minimum : 0.0F;
      const auto value = static_cast<double>(held);
      const double error = (static_cast<double>(decoded[k]) - value) / std::max(std::abs(value), floor);
      sum += error * error;
    }
  }
  return sum;
}

}  // namespace

Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  std::vector<std::vector<LatLongView>> levels;
  levels.reserve(mips.size());
  for (const CubemapView& view : mips) levels.push_back(image::images_of(view));
  image::EncodedLevels encoded = image::encode_bc6h_images(levels, options, control);
  Bc6hCubemap cubemap;
  cubemap.is_signed = options.is_signed;
  cubemap.values_clamped = encoded.values_clamped;
  cubemap.levels.reserve(mips.size());
  for (std::size_t level = 0; level < mips.size(); ++level) {
    image::EncodedLevels::Level& here = encoded.levels[level];
    const double values = 3.0 * static_cast<double>(texels_of(mips[level].size));
    // An error of n units is n 2^-10 / m of a value: mean square n^2 times mean 1 / m^2, taken as independent.
    const double error = std::sqrt(here.squares * kMeanSquareOfUnits / values) / 1024.0;
    cubemap.levels.push_back({mips[level].size, std::move(here.blocks), error});
  }
  return cubemap;
}

Cubemap decode_bc6h(const Bc6hCubemap& cubemap, const Control& control) {
  const platform::FloatingPointScope floating_point;
  check(cubemap);
  const auto levels = static_cast<int>(cubemap.levels.size());
  const int size = cubemap.levels.front().size;
  Cubemap chain(size, levels, control.memory);
  const auto range = cubemap.is_signed ? image::Bc6hRange::signed_values : image::Bc6hRange::positive;
  const jobs::Placement placement = jobs::placement_for(texels_of(size));
  jobs::run_tiles(static_cast<std::size_t>(6 * levels), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const auto face = static_cast<int>(tile % 6);
                    const auto level = static_cast<int>(tile / 6);
                    const std::vector<std::uint8_t>& blocks = cubemap.levels[tile / 6].blocks;
                    const int edge = chain.level_size(level);
                    image::decode_bc6h_rows(blocks.data() + blocks.size() / 6 * (tile % 6), range, edge, 0, edge,
                                            chain.face(level, face));
                  });
  return chain;
}

std::vector<double> bc6h_errors(const Bc6hCubemap& cubemap, std::span<const CubemapView> mips, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  check(cubemap);
  if (mips.size() != cubemap.levels.size() || mips.front().size != cubemap.levels.front().size) {
    throw Error(ErrorCode::invalid_argument,
                "the chain and the BC6H cubemap differ in size or levels; pass the chain that was encoded");
  }
  const Cubemap decoded = decode_bc6h(cubemap, {control.stop, {}});
  std::vector<double> squares(6 * mips.size());
  const jobs::Placement placement = jobs::placement_for(texels_of(mips.front().size));
  jobs::run_tiles(squares.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const auto face = static_cast<int>(tile % 6);
                    const float* const texels = decoded.face(static_cast<int>(tile / 6), face);
                    squares[tile] = face_squares(mips[tile / 6], texels, face, cubemap.is_signed);
                  });
  std::vector<double> errors;
  for (std::size_t level = 0; level < mips.size(); ++level) {
    double sum = 0.0;
    for (std::size_t face = 0; face < 6; ++face) sum += squares[6 * level + face];
    errors.push_back(std::sqrt(sum / (3.0 * static_cast<double>(texels_of(mips[level].size)))));
  }
  return errors;
}

}  // namespace welkin
