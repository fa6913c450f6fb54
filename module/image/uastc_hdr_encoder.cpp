// UASTC HDR of images, the faces of cubemaps among them.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "image/uastc_hdr.h"

namespace welkin::image {
namespace {

using simd::kLanes;

/// Halves' bits of a block, texel by texel, as it will be decoded.
using BlockHalves = std::array<std::uint16_t, 3 * kBlockTexels>;

/// 16 blocks: their lines as they are fitted and stored, and the texels' indices.
class Lines {
 public:
  /// One line for each block, or two by these partitions.
  explicit Lines(const float* partitions = nullptr) noexcept : partitions_(partitions) {}

  /// Fits the lines, the first time along the texels' spread and then to the indices found before.
  void turn(const BlockGroup& group) {
    const UastcHdrKernels& kernels = uastc_hdr_kernels();
    kernels.fit_lines(group, partitions_, turns_++ == 0 ? nullptr : &meant_, fitted_);
    store();
    kernels.index_lines(group, partitions_, meant_, found_);
  }

  [[nodiscard]] float error(std::size_t lane) const noexcept { return found_.errors[lane]; }

  void pack(std::size_t lane, std::uint8_t* block) const noexcept {
    pack_uastc_lines(std::span(stored_[lane]).first(lines()), partition(lane), indices(lane), block);
  }

  /// As ASTC's decoder has them, with 16 bits between the ends.
  [[nodiscard]] BlockHalves halves(std::size_t lane) const noexcept {
    constexpr std::array<std::int32_t, 16> single{0, 4, 8, 12, 17, 21, 25, 29, 35, 39, 43, 47, 52, 56, 60, 64};
    constexpr std::array<std::int32_t, 4> pair{0, 21, 43, 64};
    BlockHalves result{};
    for (std::size_t k = 0; k < kBlockTexels; ++k) {
      const auto index = static_cast<std::size_t>(found_.indices[k][lane]);
      const std::int32_t weight = partitions_ == nullptr ? single[index] : pair[index];
      const bool second = partitions_ != nullptr && (bc6h_second_line(partition(lane)) >> k & 1) != 0;
      const auto& [low, high] = stored_[lane][second ? 1 : 0].ends;
      for (std::size_t c = 0; c < 3; ++c) {
        result[3 * k + c] = half_of_logarithm((low[c] * 16 * (64 - weight) + high[c] * 16 * weight + 32) >> 6);
      }
    }
    return result;
  }

 private:
  [[nodiscard]] std::size_t lines() const noexcept { return partitions_ == nullptr ? 1 : 2; }
  [[nodiscard]] int partition(std::size_t lane) const noexcept {
    return partitions_ == nullptr ? 0 : static_cast<int>(partitions_[lane]);
  }

  [[nodiscard]] std::array<std::uint8_t, kBlockTexels> indices(std::size_t lane) const noexcept {
    std::array<std::uint8_t, kBlockTexels> result{};
    for (std::size_t k = 0; k < kBlockTexels; ++k) result[k] = static_cast<std::uint8_t>(found_.indices[k][lane]);
    return result;
  }

  /// Stores the fitted ends, and what they mean as logarithms.
  void store() noexcept {
    const UastcLines kind = partitions_ == nullptr ? UastcLines::single : UastcLines::pair;
    for (std::size_t line = 0; line < lines(); ++line) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        std::array<std::array<float, 3>, 2> ends{};
        for (std::size_t k = 0; k < 6; ++k) ends[k / 3][k % 3] = fitted_.ends[line][k / 3][k % 3][lane] / 16.0F;
        const UastcLine& here = stored_[lane][line] = store_uastc_line(ends, kind);
        for (std::size_t k = 0; k < 6; ++k) {
          meant_.ends[line][k / 3][k % 3][lane] = static_cast<float>(here.ends[k / 3][k % 3] * 16);
        }
      }
    }
  }

  const float* partitions_;
  int turns_ = 0;
  BlockLines fitted_;
  BlockLines meant_;
  std::array<std::array<UastcLine, 2>, kLanes> stored_;
  BlockIndices found_;
};

/// Returns the halves of a block of equal texels, from their logarithms.
BlockHalves flat_halves(const BlockGroup& group, std::size_t lane) {
  BlockHalves halves{};
  for (std::size_t k = 0; k < halves.size(); ++k) {
    halves[k] = half_of_logarithm(static_cast<std::int32_t>(group.values[k % 3][lane]));
  }
  return halves;
}

/// The halves that the blocks of an `EncodedBlocks` are decoded to.
using AllHalves = std::array<BlockHalves, kLanes>;

constexpr float kNoBlock = 1.0e30F;  ///< an error that every block is better than

/// Replaces blocks in `to` by blocks of lines that are fitted `turns` times, where these are better.
void improve_by(Lines& lines, int turns, const BlockGroup& group, EncodedBlocks& to, AllHalves* halves) {
  std::array<std::uint8_t, kBlockBytes> block;
  for (int turn = 0; turn < turns; ++turn) {
    lines.turn(group);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (!(lines.error(lane) < to.errors[lane])) continue;
      lines.pack(lane, block.data());
      set_block(to, lane, block.data(), lines.error(lane));
      if (halves != nullptr) (*halves)[lane] = lines.halves(lane);
    }
  }
}

void encode_single_lines(BlockGroup& group, Bc6hEffort effort, EncodedBlocks& to, AllHalves* halves) {
  std::array<std::int32_t, kLanes> flat;
  uastc_hdr_kernels().take_logarithms(group, flat.data());
  std::fill_n(to.errors, kLanes, kNoBlock);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (flat[lane] == 0) continue;
    const BlockHalves all = flat_halves(group, lane);
    std::array<std::uint8_t, kBlockBytes> block;
    pack_uastc_flat({all[0], all[1], all[2]}, block.data());
    set_block(to, lane, block.data(), 0.0F);  // which no line is better than
    if (halves != nullptr) (*halves)[lane] = all;
  }
  Lines lines;
  improve_by(lines, effort == Bc6hEffort::fast ? 1 : 2, group, to, halves);
}

/// Replaces blocks in `to` by blocks of two lines, where these are better.
void improve_by_two_lines(const BlockGroup& group, int tried, EncodedBlocks& to, AllHalves* halves) {
  alignas(64) float partitions[kMaxPartitionsTried][kLanes];
  uastc_hdr_kernels().rank_partitions(group, kUastcPartitions, tried, partitions);
  for (int rank = 0; rank < tried; ++rank) {
    Lines lines(partitions[rank]);
    improve_by(lines, 2, group, to, halves);
  }
}

/// Encodes a level's brightest blocks again to keep each channel's mean as far as possible: 16 times at once, with
/// their texels scaled by a little. Of those that leave the means better it takes the one of the least cost, the means'
/// excess and the squared error.
class Balancer {
 public:
  Balancer(const std::vector<LatLongView>& images, const BlockFormat& format, EncodedLevels::Level& level)
      : images_(images), format_(format), level_(level), total_(total_light(level.lights)) {
    for (const auto& [share, block] : brightest_blocks(level.lights, total_)) {
      brightest_.push_back({share, block, tried(block, {1.0, 1.0, 1.0}, 0.0)[0]});
      off_ = sum(off_, brightest_.back().now.light);
      keep(brightest_.back());  // two lines are tried here whatever one leaves out
    }
  }

  void run() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Bright& bright : brightest_) {
        if (excess(off_) <= 0.0) return;
        if (sweep == 0 || bright.share >= kLargeShare) improve(bright, sweep);
      }
    }
  }

 private:
  static constexpr int kSweeps = 12;
  /// A mean squared relative error of this size costs as much as means that are off by all of their light.
  static constexpr double kWorth = 0.01;
  static constexpr std::size_t kValues = 3 * kBlockTexels;

  struct Trial {
    std::array<std::uint8_t, kBlockBytes> block;
    double squares;     ///< of relative errors
    ChannelSums light;  ///< too much
  };
  using Trials = std::array<Trial, std::size_t{2} * kLanes>;

  struct Bright {
    double share;
    std::size_t block;
    Trial now;
  };

  [[nodiscard]] double excess(const ChannelSums& off) const { return excess_of_means(off, total_); }

  /// The block as it is, and 15 times with its channels scaled by `scale`, give or take `spread`; then the same with
  /// one line, whose ends have finer steps.
  [[nodiscard]] Trials tried(std::size_t block, const ChannelSums& scale, double spread) {
    const BlockTexels texels = block_texels(images_, block, format_.least());
    BlockGroup group;
    fill_group(texels, group);
    for (std::size_t lane = 1; lane < kLanes; ++lane) {
      std::array<float, 3> factors{};
      for (std::size_t c = 0; c < 3; ++c) {
        // A linear congruential generator modulo 2^32; the lower bits repeat soon, so the upper 16 are taken.
        state_ = 1664525U * state_ + 1013904223U;
        const double part = 2.0 * static_cast<double>(state_ >> 16U) / 65535.0 - 1.0;
        factors[c] = static_cast<float>(scale[c] * (1.0 + spread * part));
      }
      for (std::size_t k = 0; k < kValues; ++k) {
        group.values[k][lane] = std::min(texels.values[k] * factors[k % 3], kLargestHalf);
      }
    }
    std::array<std::int32_t, kLanes> clamped;
    alignas(64) float light[3][kLanes];
    bc6h_kernels().prepare(group, false, clamped.data(), light);
    EncodedBlocks encoded;
    AllHalves halves;
    Trials trials;
    const auto measure = [&](std::size_t first) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        trials[first + lane] = measured(texels, halves[lane]);
        trials[first + lane].block = block_of(encoded, lane);
      }
    };
    encode_single_lines(group, format_.effort, encoded, &halves);
    measure(kLanes);
    if (format_.effort != Bc6hEffort::fast) {
      improve_by_two_lines(group, format_.partitions_tried(), encoded, &halves);
    }
    measure(0);
    return trials;
  }

  static Trial measured(const BlockTexels& texels, const BlockHalves& halves) {
    Trial trial{{}, 0.0, {}};
    for (std::size_t k = 0; k < kValues; ++k) {
      if (!texels.inside[k / 3]) continue;
      const auto value = static_cast<double>(texels.values[k]);
      const double off = static_cast<double>(float_from_half(halves[k])) - value;
      trial.light[k % 3] += off;
      // Below 2^-14, the least normal half, errors are not relative.
      trial.squares += off * off / std::max(value * value, 0x1p-28);
    }
    return trial;
  }

  void improve(Bright& bright, int sweep) {
    const ChannelSums rest = sum(off_, bright.now.light, -1.0);
    ChannelSums scale{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto whole = static_cast<double>(level_.lights[bright.block][c]);
      // With its light times 1 - off / light the block would take away all that the level has too much, if ends had no
      // steps.
      scale[c] = whole > 0.0 ? std::clamp(1.0 - off_[c] / whole, 0.7, 1.4) : 1.0;
    }
    const double values = 3.0 * static_cast<double>(texels_of(images_));
    const auto cost = [&](const Trial& trial) {
      return excess(sum(rest, trial.light)) + trial.squares / (kWorth * values);
    };
    const Trial* best = &bright.now;
    constexpr std::array spreads{0.02, 0.08, 0.3};  // ends far apart have steps of 9 % and more
    const Trials trials = tried(bright.block, scale, spreads[static_cast<std::size_t>(sweep) % spreads.size()]);
    for (const Trial& trial : trials) {
      // A trial must take the means nearer to the tolerance, else a cheaper block could be taken that makes them worse.
      if (cost(trial) < cost(*best) && excess(sum(rest, trial.light)) < excess(off_)) best = &trial;
    }
    bright.now = *best;
    off_ = sum(rest, bright.now.light);
    keep(bright);
  }

  void keep(const Bright& bright) {
    std::copy_n(bright.now.block.data(), kBlockBytes, level_.blocks.data() + kBlockBytes * bright.block);
  }

  const std::vector<LatLongView>& images_;
  const BlockFormat& format_;
  EncodedLevels::Level& level_;
  ChannelSums total_;
  std::uint32_t state_ = 1;  ///< of the numbers that trials are scaled by
  std::vector<Bright> brightest_;
  ChannelSums off_{};  ///< what the level has too much of
};

}  // namespace

EncodedLevels encode_uastc_hdr_images(std::span<const std::vector<LatLongView>> levels, Bc6hEffort effort,
                                      const Control& control) {
  const BlockFormat format{effort, false,
                           [](BlockGroup& group, const BlockFormat& self, EncodedBlocks& to) {
                             encode_single_lines(group, self.effort, to, nullptr);
                           },
                           [](const BlockGroup& group, const BlockFormat& self, EncodedBlocks& to) {
                             std::fill_n(to.errors, kLanes, kNoBlock);
                             improve_by_two_lines(group, self.partitions_tried(), to, nullptr);
                           },
                           [](const std::vector<LatLongView>& images, const BlockFormat& self,
                              EncodedLevels::Level& level) { Balancer(images, self, level).run(); }};
  return encode_images(levels, format, control);
}

}  // namespace welkin::image
