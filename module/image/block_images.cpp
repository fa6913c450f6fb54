#include "image/block_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "image/bc6h.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/standard_library.h"

namespace welkin::image {

ChannelSums total_light(std::span<const BlockLight> lights) noexcept {
  ChannelSums total{};
  for (const BlockLight& light : lights) {
    for (std::size_t c = 0; c < 3; ++c) total[c] += static_cast<double>(light[c]);
  }
  return total;
}

std::vector<BlockShare> brightest_blocks(std::span<const BlockLight> lights, const ChannelSums& total) {
  constexpr double kMinShare = 0.01;
  ChannelSums scale{};
  for (std::size_t c = 0; c < 3; ++c) scale[c] = total[c] > 0.0 ? 1.0 / total[c] : 0.0;
  std::vector<BlockShare> shares;
  for (std::size_t block = 0; block < lights.size(); ++block) {
    double share = 0.0;
    for (std::size_t c = 0; c < 3; ++c) share = std::max(share, static_cast<double>(lights[block][c]) * scale[c]);
    if (share >= kMinShare) shares.push_back({share, block});
  }
  std::sort(shares.begin(), shares.end(), [](const BlockShare& a, const BlockShare& b) {
    return a.share != b.share ? a.share > b.share : a.block < b.block;
  });
  return shares;
}

double excess_of_mean(double off, double total) noexcept {
  return total > 0.0 ? std::max(0.0, std::abs(off) / total - kMeanTolerance) : 0.0;
}

double excess_of_means(const ChannelSums& off, const ChannelSums& total) noexcept {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += excess_of_mean(off[c], total[c]);
  return sum;
}

namespace {

using simd::kLanes;

/// Blocks in a tile: enough that the lanes of blocks with two lines are mostly full, and few enough for a second-level
/// cache.
constexpr int kTileBlocks = 512;
constexpr int kTileGroups = kTileBlocks / kLanes;

/// Sums of squares above which a block with one line is tried with two, too: about 0.7 % rms.
/// A block has 48 values: sqrt(4600 / 48) = 9.8 units rms, each 2^-10 / m of a value with a mean 1 / m^2 of 0.51
/// (bc6h_encoder.cpp), is 0.0068.
constexpr float kEnoughSquares = 4600.0F;

constexpr double kShareOfEncoding = 0.98;  ///< the rest is for keeping means

/// Blocks of one level that are encoded together.
struct Tile {
  std::size_t level;
  int first_block;  ///< counted over all images
  int blocks;
};

struct BlockPosition {
  int image, row, column;  ///< the first texel's
};

/// `block`: counted over images of one size.
BlockPosition position_of(const LatLongView& image, int block) noexcept {
  const int across = blocks_across(image.width);
  const int down = blocks_across(image.height);
  return {block / (across * down), block / across % down * kBlockEdge, block % across * kBlockEdge};
}

/// Four texels of an image's row from `column` on; those beyond its edge repeat the last one.
void read_block_row(const LatLongView& view, int row, int column, float* rgb) noexcept {
  const int columns = std::min(kBlockEdge, view.width - column);
  const auto texel = static_cast<std::ptrdiff_t>(bytes_per_texel(view.format));
  decode_texels(view.format, static_cast<const std::byte*>(row_of(view, row)) + column * texel, columns, rgb);
  for (int k = columns; k < kBlockEdge; ++k) {
    std::copy_n(rgb + std::ptrdiff_t{3} * (columns - 1), 3, rgb + std::ptrdiff_t{3} * k);
  }
}

/// The buffers of one worker.
struct Scratch {
  std::array<BlockGroup, kTileGroups> groups;
  BlockGroup hard;  ///< blocks that one line is not enough for
  EncodedBlocks encoded;
  std::array<float, kTileBlocks> errors;
  std::array<int, kTileBlocks> list;
  std::array<std::array<float, 48>, kLanes> texels;
  std::array<const float*, std::size_t{4} * kLanes> rows;
};

struct TileResult {
  double squares = 0.0;  ///< in units of the halves' last bits
  std::uint64_t clamped = 0;
};

/// One tile's work.
class TileEncoder {
 public:
  /// `blocks`, `lights`: of the level.
  TileEncoder(const std::vector<LatLongView>& images, const Tile& tile, const BlockFormat& format, Scratch& scratch,
              std::uint8_t* blocks, BlockLight* lights)
      : images_(images),
        tile_(tile),
        format_(format),
        scratch_(scratch),
        kernels_(bc6h_kernels()),
        width_(images.front().width),
        height_(images.front().height),
        blocks_(blocks),
        lights_(lights) {}

  TileResult encode() {
    for (int first = 0; first < tile_.blocks; first += kLanes) encode_single_lines(first);
    if (format_.effort != Bc6hEffort::fast) encode_two_lines();
    for (int block = 0; block < tile_.blocks; ++block) {
      result_.squares += static_cast<double>(scratch_.errors[static_cast<std::size_t>(block)]);
    }
    return result_;
  }

 private:
  [[nodiscard]] BlockPosition block_position(int block) const {
    return position_of(images_.front(), tile_.first_block + block);
  }

  [[nodiscard]] bool reaches_beyond(const BlockPosition& position) const {
    return position.row + kBlockEdge > height_ || position.column + kBlockEdge > width_;
  }

  [[nodiscard]] std::uint8_t* bytes_of(int block) const {
    return blocks_ + kBlockBytes * static_cast<std::size_t>(tile_.first_block + block);
  }

  /// Rows of a lane's block: in the image where it has floats, else copied.
  void set_rows(const BlockPosition& position, std::size_t lane) {
    const LatLongView& view = images_[static_cast<std::size_t>(position.image)];
    const bool in_place = !reaches_beyond(position) && view.format == PixelFormat::rgb32f;
    for (int row = 0; row < kBlockEdge; ++row) {
      const int line = std::min(position.row + row, height_ - 1);
      const float*& to = scratch_.rows[4 * lane + static_cast<std::size_t>(row)];
      if (in_place) {
        to = static_cast<const float*>(row_of(view, line)) + std::ptrdiff_t{3} * position.column;
        continue;
      }
      float* const copy = scratch_.texels[lane].data() + std::ptrdiff_t{12} * row;
      read_block_row(view, line, position.column, copy);
      to = copy;
    }
  }

  /// Texels of a block that lie in the image.
  template <class Visit>
  void for_each_inner(const BlockPosition& position, const Visit& visit) const {
    for (int row = 0; row < std::min(kBlockEdge, height_ - position.row); ++row) {
      for (int column = 0; column < std::min(kBlockEdge, width_ - position.column); ++column) {
        visit(static_cast<std::size_t>(kBlockEdge * row + column));
      }
    }
  }

  void set_weights(const BlockPosition& position, std::size_t lane, BlockGroup& group) const {
    const bool beyond = reaches_beyond(position);
    for (auto& weights : group.weights) weights[lane] = beyond ? kPaddingWeight : 1.0F;
    if (beyond) for_each_inner(position, [&](std::size_t texel) { group.weights[texel][lane] = 1.0F; });
  }

  /// Counts clamped values. Texels beyond the edge repeat others and are not counted.
  void count_clamped(const BlockPosition& position, std::size_t lane, std::int32_t of_block) {
    if (!reaches_beyond(position)) {
      result_.clamped += static_cast<std::uint64_t>(of_block);
      return;
    }
    for_each_inner(position, [&](std::size_t texel) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = scratch_.texels[lane][3 * texel + c];
        if (!(value >= format_.least() && value <= kLargestHalf)) ++result_.clamped;
      }
    });
  }

  void encode_single_lines(int first) {
    BlockGroup& group = scratch_.groups[static_cast<std::size_t>(first / kLanes)];
    const int count = std::min(kLanes, tile_.blocks - first);
    for (int lane = 0; lane < kLanes; ++lane) {  // lanes without a block repeat the last one
      const BlockPosition position = block_position(first + std::min(lane, count - 1));
      set_rows(position, static_cast<std::size_t>(lane));
      set_weights(position, static_cast<std::size_t>(lane), group);
    }
    kernels_.load(scratch_.rows.data(), group);
    std::array<std::int32_t, kLanes> clamped{};
    alignas(64) float light[3][kLanes];
    kernels_.prepare(group, format_.is_signed, clamped.data(), light);
    format_.encode_single_lines(group, format_, scratch_.encoded);
    for (int lane = 0; lane < count; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      count_clamped(block_position(first + lane), at, clamped[at]);
      lights_[tile_.first_block + first + lane] = {light[0][at], light[1][at], light[2][at]};
      keep(first + lane, at);
    }
  }

  void keep(int block, std::size_t lane) {
    scratch_.errors[static_cast<std::size_t>(block)] = scratch_.encoded.errors[lane];
    const auto bytes = block_of(scratch_.encoded, lane);
    std::copy(bytes.begin(), bytes.end(), bytes_of(block));
  }

  void encode_two_lines() {
    std::size_t count = 0;
    for (int block = 0; block < tile_.blocks; ++block) {
      if (scratch_.errors[static_cast<std::size_t>(block)] > kEnoughSquares) scratch_.list[count++] = block;
    }
    for (std::size_t first = 0; first < count; first += kLanes) {
      const std::size_t here = std::min<std::size_t>(kLanes, count - first);
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        copy_block(scratch_.list[first + std::min(lane, here - 1)], lane);
      format_.encode_two_lines(scratch_.hard, format_, scratch_.encoded);
      for (std::size_t lane = 0; lane < here; ++lane) {
        const int block = scratch_.list[first + lane];
        if (scratch_.encoded.errors[lane] < scratch_.errors[static_cast<std::size_t>(block)]) keep(block, lane);
      }
    }
  }

  void copy_block(int block, std::size_t lane) {
    const BlockGroup& group = scratch_.groups[static_cast<std::size_t>(block / kLanes)];
    const auto from = static_cast<std::size_t>(block % kLanes);
    for (std::size_t k = 0; k < std::size(group.values); ++k) scratch_.hard.values[k][lane] = group.values[k][from];
    for (std::size_t k = 0; k < std::size(group.weights); ++k) scratch_.hard.weights[k][lane] = group.weights[k][from];
  }

  const std::vector<LatLongView>& images_;
  const Tile& tile_;
  const BlockFormat& format_;
  Scratch& scratch_;
  const Bc6hKernels& kernels_;
  int width_;
  int height_;
  std::uint8_t* blocks_;
  BlockLight* lights_;
  TileResult result_;
};

std::size_t blocks_of(const std::vector<LatLongView>& images) {
  return images.size() * block_bytes(images.front().width, images.front().height) / kBlockBytes;
}

std::vector<Tile> tiles_of(std::span<const std::vector<LatLongView>> levels) {
  std::vector<Tile> tiles;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const auto blocks = static_cast<int>(blocks_of(levels[level]));
    for (int first = 0; first < blocks; first += kTileBlocks) {
      tiles.push_back({level, first, std::min(kTileBlocks, blocks - first)});
    }
  }
  return tiles;
}

}  // namespace

EncodedLevels encode_images(std::span<const std::vector<LatLongView>> levels, const BlockFormat& format,
                            const Control& control) {
  if (format.effort < Bc6hEffort::fast || format.effort > Bc6hEffort::slow) {
    throw Error(ErrorCode::invalid_argument, "the effort for blocks is not one of the enumerators; pass one of them");
  }
  EncodedLevels encoded;
  for (const std::vector<LatLongView>& images : levels) {
    const std::size_t blocks = blocks_of(images);
    encoded.levels.push_back({std::vector<std::uint8_t>(blocks * kBlockBytes), std::vector<BlockLight>(blocks), 0.0});
  }
  const std::vector<Tile> tiles = tiles_of(levels);
  std::vector<TileResult> results(tiles.size());
  const jobs::Placement placement = jobs::placement_for(texels_of(levels.front()));
  const std::size_t workers = jobs::worker_count(placement);
  const auto scratch = platform::make_unique_for_overwrite<Scratch[]>(workers);
  const auto encode_tile = [&](std::size_t tile, std::size_t worker) {
    const std::size_t level = tiles[tile].level;
    EncodedLevels::Level& to = encoded.levels[level];
    results[tile] =
        TileEncoder(levels[level], tiles[tile], format, scratch[worker], to.blocks.data(), to.lights.data()).encode();
  };
  jobs::run_tiles(tiles.size(), placement, workers, jobs::part_of(control, 0.0, kShareOfEncoding), encode_tile);
  for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
    encoded.levels[tiles[tile].level].squares += results[tile].squares;
    encoded.values_clamped += results[tile].clamped;
  }
  jobs::run_tiles(
      levels.size(), placement, workers, jobs::part_of(control, kShareOfEncoding, 1.0),
      [&](std::size_t level, std::size_t /*worker*/) { format.balance(levels[level], format, encoded.levels[level]); });
  return encoded;
}

BlockTexels block_texels(const std::vector<LatLongView>& images, std::size_t block, float least) noexcept {
  const auto [image, top, left] = position_of(images.front(), static_cast<int>(block));
  const LatLongView& view = images[static_cast<std::size_t>(image)];
  BlockTexels texels;
  for (int row = 0; row < kBlockEdge; ++row) {
    read_block_row(view, std::min(top + row, view.height - 1), left, texels.values.data() + std::ptrdiff_t{12} * row);
    for (int column = 0; column < kBlockEdge; ++column) {
      texels.inside[static_cast<std::size_t>(kBlockEdge * row + column)] =
          top + row < view.height && left + column < view.width;
    }
  }
  for (float& value : texels.values) {  // NaN is 0
    value = value >= least ? std::min(value, kLargestHalf) : value < least ? least : 0.0F;
  }
  return texels;
}

void fill_group(const BlockTexels& texels, BlockGroup& group) noexcept {
  for (std::size_t k = 0; k < texels.values.size(); ++k) std::fill_n(group.values[k], kLanes, texels.values[k]);
  for (std::size_t k = 0; k < kBlockTexels; ++k) {
    std::fill_n(group.weights[k], kLanes, texels.inside[k] ? 1.0F : kPaddingWeight);
  }
}

std::vector<LatLongView> images_of(const CubemapView& view) {
  std::vector<LatLongView> images;
  images.reserve(view.faces.size());
  for (const void* const face : view.faces) {
    images.push_back({face, view.size, view.size, view.row_stride_bytes, view.format});
  }
  return images;
}

std::size_t block_bytes(int width, int height) noexcept {
  return kBlockBytes * static_cast<std::size_t>(blocks_across(width)) * static_cast<std::size_t>(blocks_across(height));
}

std::int64_t texels_of(const std::vector<LatLongView>& images) noexcept {
  return static_cast<std::int64_t>(images.size()) * images.front().width * images.front().height;
}

}  // namespace welkin::image
