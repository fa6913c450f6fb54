// Cubemaps and pictures to BC6H and back: which blocks are encoded together, and where they go.
#include "image/bc6h_encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "image/bc6h.h"
#include "image/bc6h_balance.h"
#include "image/bc6h_kernels.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "welkin/image.h"

namespace welkin {
namespace {

using image::kBlockBytes, image::kBlockEdge, simd::kLanes;

/// Of a tile: enough that the lanes of blocks with two lines are mostly full, and few enough for a second-level cache.
constexpr int kTileBlocks = 512;
constexpr int kTileGroups = kTileBlocks / kLanes;

/// Sums of squares above which a block with one line is tried with two, too: about 0.7 % rms.
constexpr float kEnoughSquares = 4600.0F;

/// A unit in a half's last place is 2^-10 / m of a value, with m from 1 to 2. This is the mean of 1 / m^2 over the
/// texels of seven pictures' chains, by what the errors came to. (Of evenly spread logarithms it would be 0.54.)
constexpr double kMeanSquareOfUnits = 0.51;

/// Blocks of one level that are encoded together.
struct Tile {
  std::size_t level;
  int first_block;  ///< counted over all pictures
  int blocks;
};

struct Place {
  int picture, row, column;  ///< the first texel's
};

/// What one worker needs.
struct Scratch {
  std::array<image::BlockGroup, kTileGroups> groups;
  image::BlockGroup hard;  ///< blocks that one line is not enough for
  image::SingleLineBlocks single;
  image::TwoLineBlocks pair;
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
  TileEncoder(const std::vector<LatLongView>& pictures, const Tile& tile, const Bc6hOptions& options, Scratch& scratch,
              std::uint8_t* blocks, image::BlockLight* lights)
      : pictures_(pictures),
        tile_(tile),
        options_(options),
        scratch_(scratch),
        kernels_(image::bc6h_kernels()),
        width_(pictures.front().width),
        height_(pictures.front().height),
        blocks_(blocks),
        lights_(lights) {}

  TileResult encode() {
    for (int first = 0; first < tile_.blocks; first += kLanes) encode_single_lines(first);
    if (options_.effort != Bc6hEffort::fast) encode_two_lines();
    for (int block = 0; block < tile_.blocks; ++block) {
      result_.squares += static_cast<double>(scratch_.errors[static_cast<std::size_t>(block)]);
    }
    return result_;
  }

 private:
  [[nodiscard]] Place place_of(int block) const {
    const int number = tile_.first_block + block;
    const int across = image::blocks_across(width_);
    const int down = image::blocks_across(height_);
    return {number / (across * down), number / across % down * kBlockEdge, number % across * kBlockEdge};
  }

  [[nodiscard]] bool reaches_beyond(const Place& place) const {
    return place.row + kBlockEdge > height_ || place.column + kBlockEdge > width_;
  }

  [[nodiscard]] std::uint8_t* bytes_of(int block) const {
    return blocks_ + kBlockBytes * static_cast<std::size_t>(tile_.first_block + block);
  }

  /// Rows of a lane's block: in the picture where it has floats, else copied.
  void set_rows(const Place& place, std::size_t lane) {
    const LatLongView& view = pictures_[static_cast<std::size_t>(place.picture)];
    const bool in_place = !reaches_beyond(place) && view.format == PixelFormat::rgb32f;
    for (int row = 0; row < kBlockEdge; ++row) {
      const int line = std::min(place.row + row, height_ - 1);
      const float*& to = scratch_.rows[4 * lane + static_cast<std::size_t>(row)];
      if (in_place) {
        to = static_cast<const float*>(image::row_of(view, line)) + std::ptrdiff_t{3} * place.column;
        continue;
      }
      float* const copy = scratch_.texels[lane].data() + std::ptrdiff_t{12} * row;
      image::read_block_row(view, line, place.column, copy);
      to = copy;
    }
  }

  /// Texels of a block that lie in the picture.
  template <class Visit>
  void for_each_inner(const Place& place, const Visit& visit) const {
    for (int row = 0; row < std::min(kBlockEdge, height_ - place.row); ++row) {
      for (int column = 0; column < std::min(kBlockEdge, width_ - place.column); ++column) {
        visit(static_cast<std::size_t>(kBlockEdge * row + column));
      }
    }
  }

  void set_weights(const Place& place, std::size_t lane, image::BlockGroup& group) const {
    const bool beyond = reaches_beyond(place);
    for (auto& weights : group.weights) weights[lane] = beyond ? image::kPaddingWeight : 1.0F;
    if (beyond) for_each_inner(place, [&](std::size_t texel) { group.weights[texel][lane] = 1.0F; });
  }

  /// What is repeated beyond the edge is not counted again.
  void count_clamped(const Place& place, std::size_t lane, std::int32_t of_block) {
    if (!reaches_beyond(place)) {
      result_.clamped += static_cast<std::uint64_t>(of_block);
      return;
    }
    const float least = options_.is_signed ? -image::kLargestHalf : 0.0F;
    for_each_inner(place, [&](std::size_t texel) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = scratch_.texels[lane][3 * texel + c];
        if (!(value >= least && value <= image::kLargestHalf)) ++result_.clamped;
      }
    });
  }

  void encode_single_lines(int first) {
    image::BlockGroup& group = scratch_.groups[static_cast<std::size_t>(first / kLanes)];
    const int count = std::min(kLanes, tile_.blocks - first);
    for (int lane = 0; lane < kLanes; ++lane) {  // lanes without a block repeat the last one
      const Place place = place_of(first + std::min(lane, count - 1));
      set_rows(place, static_cast<std::size_t>(lane));
      set_weights(place, static_cast<std::size_t>(lane), group);
    }
    kernels_.load(scratch_.rows.data(), group);
    std::array<std::int32_t, kLanes> clamped{};
    alignas(64) float light[3][kLanes];
    kernels_.prepare(group, options_.is_signed, clamped.data(), light);
    kernels_.single_lines(group, options_.is_signed, options_.effort != Bc6hEffort::fast, scratch_.single);
    for (int lane = 0; lane < count; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      count_clamped(place_of(first + lane), at, clamped[at]);
      lights_[tile_.first_block + first + lane] = {light[0][at], light[1][at], light[2][at]};
      scratch_.errors[static_cast<std::size_t>(first + lane)] = scratch_.single.errors[at];
      std::uint8_t* to = bytes_of(first + lane);
      for (const auto& word : scratch_.single.words) {
        const auto bits = static_cast<std::uint32_t>(word[at]);
        for (unsigned k = 0; k < 4; ++k) *to++ = static_cast<std::uint8_t>(bits >> (8 * k));
      }
    }
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
      const int tried = options_.effort == Bc6hEffort::slow ? image::kMostPartitionsTried : 1;
      kernels_.two_lines(scratch_.hard, options_.is_signed, tried, scratch_.pair);
      for (std::size_t lane = 0; lane < here; ++lane) keep_better(scratch_.list[first + lane], lane);
    }
  }

  void copy_block(int block, std::size_t lane) {
    const image::BlockGroup& group = scratch_.groups[static_cast<std::size_t>(block / kLanes)];
    const auto from = static_cast<std::size_t>(block % kLanes);
    for (std::size_t k = 0; k < std::size(group.values); ++k) scratch_.hard.values[k][lane] = group.values[k][from];
    for (std::size_t k = 0; k < std::size(group.weights); ++k) scratch_.hard.weights[k][lane] = group.weights[k][from];
  }

  void keep_better(int block, std::size_t lane) {
    const image::TwoLineBlocks& pair = scratch_.pair;
    float& error = scratch_.errors[static_cast<std::size_t>(block)];
    if (!(pair.errors[lane] < error)) return;
    error = pair.errors[lane];
    image::pack_bc6h(image::fields_of(pair, lane), bytes_of(block));
  }

  const std::vector<LatLongView>& pictures_;
  const Tile& tile_;
  const Bc6hOptions& options_;
  Scratch& scratch_;
  const image::Bc6hKernels& kernels_;
  int width_;
  int height_;
  std::uint8_t* blocks_;
  image::BlockLight* lights_;
  TileResult result_;
};

/// Of one picture.
std::size_t block_bytes(int width, int height) {
  return kBlockBytes * static_cast<std::size_t>(image::blocks_across(width)) *
         static_cast<std::size_t>(image::blocks_across(height));
}

/// Of six faces.
std::size_t block_bytes(int size) { return 6 * block_bytes(size, size); }

std::size_t block_bytes(const std::vector<LatLongView>& pictures) {
  return pictures.size() * block_bytes(pictures.front().width, pictures.front().height);
}

std::vector<Tile> tiles_of(std::span<const std::vector<LatLongView>> levels) {
  std::vector<Tile> tiles;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const auto blocks = static_cast<int>(block_bytes(levels[level]) / kBlockBytes);
    for (int first = 0; first < blocks; first += kTileBlocks) {
      tiles.push_back({level, first, std::min(kTileBlocks, blocks - first)});
    }
  }
  return tiles;
}

std::int64_t texels_of(int size) { return std::int64_t{6} * size * size; }

std::int64_t texels_of(const std::vector<LatLongView>& pictures) {
  return static_cast<std::int64_t>(pictures.size()) * pictures.front().width * pictures.front().height;
}

/// Sizes and bytes of what may come from elsewhere.
void check(const Bc6hCubemap& cubemap) {
  const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, message); };
  if (cubemap.levels.empty()) refuse("a BC6H cubemap needs a level at least; it has none");
  const int size = cubemap.levels.front().size;
  if (size < 1 || size > image::kLargestFace) {
    refuse("level 0 of the BC6H cubemap has " + std::to_string(size) + " texels along an edge; from 1 to " +
           std::to_string(image::kLargestFace) + " there can be");
  }
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
  constexpr double floor = 1.0 / 16384.0;
  const auto values = 3 * static_cast<std::size_t>(given.size);
  std::vector<float> row(values);
  const float least = is_signed ? -image::kLargestHalf : 0.0F;
  double sum = 0.0;
  for (int line = 0; line < given.size; ++line, decoded += values) {
    image::decode_texels(given.format, image::row_of(given, face, line), given.size, row.data());
    for (std::size_t k = 0; k < values; ++k) {
      const float held = row[k] >= least ? std::min(row[k], image::kLargestHalf) : row[k] < least ? least : 0.0F;
      const auto value = static_cast<double>(held);
      const double error = (static_cast<double>(decoded[k]) - value) / std::max(std::abs(value), floor);
      sum += error * error;
    }
  }
  return sum;
}

}  // namespace

namespace image {

std::vector<LatLongView> pictures_of(const CubemapView& view) {
  std::vector<LatLongView> pictures;
  pictures.reserve(view.faces.size());
  for (const void* const face : view.faces) {
    pictures.push_back({face, view.size, view.size, view.row_stride_bytes, view.format});
  }
  return pictures;
}

Bc6hPictureLevels encode_bc6h_pictures(std::span<const std::vector<LatLongView>> levels, const Bc6hOptions& options,
                                       const Control& control) {
  if (options.effort < Bc6hEffort::fast || options.effort > Bc6hEffort::slow) {
    throw Error(ErrorCode::invalid_argument, "the effort for BC6H is not one of the enumerators; pass one of them");
  }
  Bc6hPictureLevels encoded;
  std::vector<std::vector<BlockLight>> lights;
  for (const std::vector<LatLongView>& pictures : levels) {
    encoded.levels.push_back({std::vector<std::uint8_t>(block_bytes(pictures)), 0.0});
    lights.emplace_back(block_bytes(pictures) / kBlockBytes);
  }
  const std::vector<Tile> tiles = tiles_of(levels);
  std::vector<TileResult> results(tiles.size());
  const jobs::Placement placement = jobs::placement_for(texels_of(levels.front()));
  const std::size_t workers = jobs::worker_count(placement);
  const auto scratch = platform::make_unique_for_overwrite<Scratch[]>(workers);
  jobs::run_tiles(tiles.size(), placement, workers, jobs::part_of(control, 0.0, 0.98),
                  [&](std::size_t tile, std::size_t worker) {
                    const std::size_t level = tiles[tile].level;
                    results[tile] = TileEncoder(levels[level], tiles[tile], options, scratch[worker],
                                                encoded.levels[level].blocks.data(), lights[level].data())
                                        .encode();
                  });
  std::vector<double> squares(levels.size());
  for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
    squares[tiles[tile].level] += results[tile].squares;
    encoded.values_clamped += results[tile].clamped;
  }
  jobs::run_tiles(levels.size(), placement, workers, jobs::part_of(control, 0.98, 1.0),
                  [&](std::size_t level, std::size_t /*worker*/) {
                    squares[level] += balance_bc6h(levels[level], options.is_signed, lights[level], squares[level],
                                                   encoded.levels[level].blocks.data());
                  });
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const double values = 3.0 * static_cast<double>(texels_of(levels[level]));
    encoded.levels[level].estimated_error = std::sqrt(squares[level] * kMeanSquareOfUnits / values) / 1024.0;
  }
  return encoded;
}

}  // namespace image

Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  std::vector<std::vector<LatLongView>> levels;
  levels.reserve(mips.size());
  for (const CubemapView& view : mips) levels.push_back(image::pictures_of(view));
  image::Bc6hPictureLevels encoded = image::encode_bc6h_pictures(levels, options, control);
  Bc6hCubemap cubemap;
  cubemap.is_signed = options.is_signed;
  cubemap.values_clamped = encoded.values_clamped;
  cubemap.levels.reserve(mips.size());
  for (std::size_t level = 0; level < mips.size(); ++level) {
    image::Bc6hPictures& here = encoded.levels[level];
    cubemap.levels.push_back({mips[level].size, std::move(here.blocks), here.estimated_error});
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
