#include "image/bc6h_balance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/block_pictures.h"
#include "image/pixels.h"

namespace welkin::image {
namespace {

/// Passes over the blocks with a large share: a change of one block changes what is best for the next.
constexpr int kSweeps = 3;

/// Beyond the tolerance, an error of 0.2 % of a mean costs as much as this share of the level's squared error.
constexpr double kWorth = 0.0005;

/// Steps that an end is moved either way.
constexpr int kReach = 3;
constexpr int kChoices = 2 * kReach + 1;

/// The texels that a block should hold.
struct Wanted {
  std::array<float, 48> values;         ///< clamped to what halves hold
  std::array<std::int32_t, 48> halves;  ///< as numbers, negative ones negative
  std::array<bool, kBlockTexels> inside;
};

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
  Balancer(const std::vector<LatLongView>& pictures, bool is_signed, const std::vector<BlockLight>& lights,
           double squares, std::uint8_t* blocks)
      : pictures_(pictures),
        total_(total_light(lights)),
        brightest_(brightest_blocks(lights, total_)),
        range_(is_signed ? Bc6hRange::signed_values : Bc6hRange::positive),
        worth_(kWorth * squares / (kMeanTolerance * kMeanTolerance)),
        blocks_(blocks),
        across_(blocks_across(pictures.front().width)),
        down_(blocks_across(pictures.front().height)) {}

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
    const auto number = static_cast<int>(block);
    const LatLongView& view = pictures_[static_cast<std::size_t>(number / (across_ * down_))];
    const int top = number / across_ % down_ * kBlockEdge;
    const int left = number % across_ * kBlockEdge;
    for (int row = 0; row < kBlockEdge; ++row) {
      read_block_row(view, std::min(top + row, view.height - 1), left,
                     wanted_.values.data() + std::ptrdiff_t{12} * row);
    }
    for (std::size_t k = 0; k < kBlockTexels; ++k) {
      const auto place = static_cast<int>(k);
      wanted_.inside[k] = top + place / kBlockEdge < view.height && left + place % kBlockEdge < view.width;
    }
    const float least = range_ == Bc6hRange::signed_values ? -kLargestHalf : 0.0F;
    for (std::size_t k = 0; k < wanted_.values.size(); ++k) {
      float& value = wanted_.values[k];
      value = value >= least ? std::min(value, kLargestHalf) : value < least ? least : 0.0F;
      wanted_.halves[k] = number_of(half_from_float(value));
    }
  }

  /// The channels of the block that was read last.
  [[nodiscard]] std::array<ChannelError, 3> errors_of(std::size_t block) const {
    std::array<std::uint16_t, 3 * kBlockTexels> halves{};
    decode_bc6h(bytes_of(block), range_, halves.data());
    std::array<ChannelError, 3> errors;
    for (std::size_t k = 0; k < halves.size(); ++k) {
      if (!wanted_.inside[k / 3]) continue;
      const double off = number_of(halves[k]) - wanted_.halves[k];
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
      trials_.wanted[at] = static_cast<float>(wanted_.halves[3 * k + c]);
      light += static_cast<double>(wanted_.values[3 * k + c]);
    }
    return light;
  }

  [[nodiscard]] float end_of(std::int32_t number, int mode) const {
    return static_cast<float>(bc6h_end(number, mode, range_));
  }

  void try_ends() { bc6h_kernels().try_ends(trials_, range_ == Bc6hRange::signed_values); }

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
    double least = cost_of(error, rest, c);
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
      if (cost >= least) continue;
      Bc6hNumbers numbers = first;
      numbers[2 * line][c] += choice % kChoices - kReach;
      numbers[2 * line + 1][c] += choice / kChoices - kReach;
      if (!store_bc6h_numbers(numbers, c, range_, fields)) continue;
      least = cost;
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
    std::array<const float*, std::size_t{4} * simd::kLanes> rows{};
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = wanted_.values.data() + 12 * (k % 4);
    const Bc6hKernels& kernels = bc6h_kernels();
    const bool is_signed = range_ == Bc6hRange::signed_values;
    kernels.load(rows.data(), group_);
    for (std::size_t k = 0; k < kBlockTexels; ++k)
      std::fill_n(group_.weights[k], simd::kLanes, wanted_.inside[k] ? 1.0F : kPaddingWeight);
    std::array<std::int32_t, simd::kLanes> clamped{};
    alignas(64) float light[3][simd::kLanes];
    kernels.prepare(group_, is_signed, clamped.data(), light);
    kernels.single_lines(group_, is_signed, true, single_);
    kernels.two_lines(group_, is_signed, 1, pair_);
    return {unpack_bc6h(block_of(single_, 0).data()), fields_of(pair_, 0)};
  }

  /// `anew`: the block may also be encoded again in another way.
  double improve(std::size_t block, bool anew) {
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
    if (anew) {
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

  const std::vector<LatLongView>& pictures_;
  ChannelSums total_;
  std::vector<BlockShare> brightest_;
  Bc6hRange range_;
  double worth_;
  std::uint8_t* blocks_;
  int across_;
  int down_;
  ChannelSums off_{};  ///< what the level has too much of
  Wanted wanted_{};
  BlockGroup group_{};
  EncodedBlocks single_{};
  TwoLineBlocks pair_{};
  EndTrials trials_{};
};

}  // namespace

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

void read_block_row(const LatLongView& view, int row, int column, float* rgb) noexcept {
  const int columns = std::min(kBlockEdge, view.width - column);
  const auto texel = static_cast<std::ptrdiff_t>(bytes_per_texel(view.format));
  decode_texels(view.format, static_cast<const std::byte*>(row_of(view, row)) + column * texel, columns, rgb);
  for (int k = columns; k < kBlockEdge; ++k) {
    std::copy_n(rgb + std::ptrdiff_t{3} * (columns - 1), 3, rgb + std::ptrdiff_t{3} * k);
  }
}

double balance_bc6h(const std::vector<LatLongView>& pictures, bool is_signed, const std::vector<BlockLight>& lights,
                    double squares, std::uint8_t* blocks) {
  return Balancer(pictures, is_signed, lights, squares, blocks).run();
}

}  // namespace welkin::image
