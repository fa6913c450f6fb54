// Encodes ASTC blocks with the library astcenc.
#include <astcenc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <string>

#include "files/textures.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/standard_library.h"

namespace welkin::files {
namespace {

constexpr std::size_t kBlockBytes = 16;
/// Blocks of a row per tile: some milliseconds of work, so that a call can be cancelled soon.
constexpr int kTileBlocks = 64;
constexpr unsigned kOneThread = 1;
constexpr unsigned kThread = 0;  ///< the index of a context's only thread

struct FreeContext {
  void operator()(astcenc_context* context) const noexcept { astcenc_context_free(context); }
};
using Context = std::unique_ptr<astcenc_context, FreeContext>;

/// Welkin makes all arguments, so a call fails only for lack of memory or with a mismatched library.
void require_success(astcenc_error error) {
  if (error == ASTCENC_SUCCESS) return;
  if (error == ASTCENC_ERR_OUT_OF_MEM) throw std::bad_alloc();
  throw Error(ErrorCode::unsupported_file, std::string("astcenc cannot encode: ") + astcenc_get_error_string(error) +
                                               "; choose another texel format");
}

Context context_for(astcenc_profile profile, TexelKind kind, float quality, unsigned flags) {
  const auto edge = static_cast<unsigned>(block_edge(kind));
  astcenc_config config{};
  require_success(astcenc_config_init(profile, edge, edge, 1, quality, flags, &config));
  astcenc_context* context = nullptr;
  require_success(astcenc_context_alloc(&config, kOneThread, &context));
  return Context(context);
}

/// An image of RGBA floats in astcenc's form.
class Image {
 public:
  Image(int width, int height)
      : values_(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        image_{static_cast<unsigned>(width), static_cast<unsigned>(height), 1, ASTCENC_TYPE_F32, &slice_} {}
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  [[nodiscard]] float* values() noexcept { return values_.data(); }
  [[nodiscard]] astcenc_image* image() noexcept { return &image_; }

 private:
  std::vector<float> values_;
  void* slice_ = values_.data();
  astcenc_image image_;
};

constexpr astcenc_swizzle kAsItIs{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};

void decode_rows(astcenc_context* context, int edge, const std::uint8_t* blocks, int width, int first_row, int rows,
                 float* rgb) {
  const int top = first_row / edge * edge;
  const int bottom = (first_row + rows + edge - 1) / edge * edge;
  const int across = (width + edge - 1) / edge;
  const auto bytes = kBlockBytes * static_cast<std::size_t>(across) * static_cast<std::size_t>((bottom - top) / edge);
  Image image(width, bottom - top);
  require_success(astcenc_decompress_image(context, blocks, bytes, image.image(), &kAsItIs, kThread));
  const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows);
  const float* rgba = image.values() + std::ptrdiff_t{4} * width * (first_row - top);
  for (std::size_t k = 0; k < texels; ++k, rgba += 4, rgb += 3) std::copy_n(rgba, 3, rgb);
}

float quality_of(AstcEffort effort) {
  switch (effort) {
    case AstcEffort::fastest: return ASTCENC_PRE_FASTEST;
    case AstcEffort::fast: return ASTCENC_PRE_FAST;
    case AstcEffort::medium: return ASTCENC_PRE_MEDIUM;
    case AstcEffort::thorough: return ASTCENC_PRE_THOROUGH;
  }
  throw Error(ErrorCode::invalid_argument, "the effort for ASTC is not one of the enumerators; pass one of them");
}

/// Smaller levels have few blocks, whose changes would have to be visible to keep the mean.
constexpr int kBalancedWidth = 16;

/// Blocks of an image that are encoded together: neighbours in a row of blocks.
struct Tile {
  std::size_t level;
  std::size_t image;  ///< index in the level
  int block_row;
  int first_block;  ///< in the row
  int blocks;
};

std::vector<Tile> tiles_of(std::span<const std::vector<LatLongView>> levels, int edge) {
  std::vector<Tile> tiles;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (std::size_t image = 0; image < levels[level].size(); ++image) {
      const LatLongView& view = levels[level][image];
      const int across = (view.width + edge - 1) / edge;
      for (int row = 0; row * edge < view.height; ++row) {
        for (int first = 0; first < across; first += kTileBlocks)
          tiles.push_back({level, image, row, first, std::min(kTileBlocks, across - first)});
      }
    }
  }
  return tiles;
}

/// The texels of a run of blocks.
struct Area {
  int left, top, width, height;
};

Area area_of(const LatLongView& view, const Tile& tile, int edge) {
  const int left = tile.first_block * edge;
  const int top = tile.block_row * edge;
  return {left, top, std::min(tile.blocks * edge, view.width - left), std::min(edge, view.height - top)};
}

/// Writes texels of an image as floats within the range of half floats, and returns how many were clamped.
std::uint64_t read_area(const LatLongView& view, const Area& area, Image& image) {
  const auto [left, top, width, height] = area;
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(width));
  std::uint64_t clamped = 0;
  float* rgba = image.values();
  for (int row = 0; row < height; ++row) {
    const auto* const texels = static_cast<const std::byte*>(image::row_of(view, top + row)) +
                               static_cast<std::ptrdiff_t>(bytes_per_texel(view.format)) * left;
    image::decode_texels(view.format, texels, width, rgb.data());
    for (std::size_t k = 0; k < rgb.size(); k += 3, rgba += 4) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        rgba[channel] = image::bounded(rgb[k + channel], image::kLargestHalf, clamped);
      }
      rgba[3] = 1.0F;
    }
  }
  return clamped;
}

/// Encodes a row of blocks. Beyond the edge of an image astcenc repeats its texels.
void encode(Image& image, int blocks, astcenc_context* context, std::uint8_t* to) {
  constexpr astcenc_swizzle opaque{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_1};
  require_success(astcenc_compress_reset(context));
  require_success(astcenc_compress_image(context, image.image(), &opaque, to,
                                         kBlockBytes * static_cast<std::size_t>(blocks), kThread));
}

void add_light(const Area& area, int edge, const float* rgba, image::BlockLight* lights) {
  for (int row = 0; row < area.height; ++row) {
    for (int column = 0; column < area.width; ++column, rgba += 4) {
      for (std::size_t c = 0; c < 3; ++c) lights[column / edge][c] += rgba[c];
    }
  }
}

/// Encodes a level's brightest blocks again to keep each channel's mean as far as possible: astcenc receives texels
/// that are scaled by the light that it lost.
class Balancer {
 public:
  Balancer(const std::vector<LatLongView>& images, int edge, astcenc_context* context,
           const std::vector<image::BlockLight>& lights, const stop_token& stop, std::uint8_t* blocks)
      : images_(images),
        edge_(edge),
        context_(context),
        stop_(stop),
        blocks_(blocks),
        total_(image::total_light(lights)),
        brightest_(image::brightest_blocks(lights, total_)) {}

  void run() {
    for (const auto& [share, block] : brightest_) {
      const Area area = area_of(block);
      Image given(area.width, area.height);
      read_area(image_of(block), area, given);
      off_ = image::sum(off_, error_of(area, given, bytes_of(block)).light);
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (const auto& [share, block] : brightest_) {
        if (excess(off_) <= 0.0) return;
        if (sweep == 0 || share >= image::kLargeShare) improve(block, share >= image::kLargeShare ? kTrials : 2);
      }
    }
  }

 private:
  using Sums = image::ChannelSums;
  static constexpr int kSweeps = 3;
  static constexpr int kTrials = 32;
  /// A total error of the means of this size counts as much as a mean squared relative error of 1.
  static constexpr double kWorth = 0.01;

  [[nodiscard]] int across() const { return (images_.front().width + edge_ - 1) / edge_; }
  [[nodiscard]] int down() const { return (images_.front().height + edge_ - 1) / edge_; }
  [[nodiscard]] const LatLongView& image_of(std::size_t block) const {
    return images_[block / static_cast<std::size_t>(across() * down())];
  }
  [[nodiscard]] Area area_of(std::size_t block) const {
    const auto number = static_cast<int>(block);
    return files::area_of(image_of(block), {0, 0, number / across() % down(), number % across(), 1}, edge_);
  }
  [[nodiscard]] std::uint8_t* bytes_of(std::size_t block) const { return blocks_ + kBlockBytes * block; }

  struct Error {
    double squares = 0.0;  ///< of relative errors
    Sums light{};          ///< excess over the source
  };

  [[nodiscard]] Error error_of(const Area& area, Image& given, const std::uint8_t* bytes) const {
    Image decoded(area.width, area.height);
    require_success(astcenc_decompress_reset(context_));
    require_success(astcenc_decompress_image(context_, bytes, kBlockBytes, decoded.image(), &kAsItIs, kThread));
    Error error;
    for (int k = 0; k < 4 * area.width * area.height; ++k) {
      if (k % 4 == 3) continue;
      const auto value = static_cast<double>(given.values()[k]);
      const double off = static_cast<double>(decoded.values()[k]) - value;
      error.light[static_cast<std::size_t>(k % 4)] += off;
      error.squares += off * off / std::max(value * value, 0x1p-28);
    }
    return error;
  }

  [[nodiscard]] double excess(const Sums& off) const { return image::excess_of_means(off, total_); }

  [[nodiscard]] double cost_of(const Sums& rest, const Error& error) const {
    const double values = 3.0 * images_.front().width * images_.front().height * static_cast<double>(images_.size());
    return excess(image::sum(rest, error.light)) + error.squares / (kWorth * values);
  }

  /// Returns texels times a factor per channel, clamped to the range of half floats.
  [[nodiscard]] static std::vector<float> scaled(std::span<const float> rgba, const Sums& scale) {
    std::vector<float> to(rgba.begin(), rgba.end());
    for (std::size_t k = 0; k < to.size(); ++k) {
      if (k % 4 == 3) continue;
      to[k] = std::min(static_cast<float>(static_cast<double>(to[k]) * scale[k % 4]), image::kLargestHalf);
    }
    return to;
  }

  void improve(std::size_t block, int trials) {
    jobs::throw_if_cancelled(stop_);
    const Area area = area_of(block);
    Image given(area.width, area.height);
    read_area(image_of(block), area, given);
    Sums light{};
    for (int k = 0; k < 4 * area.width * area.height; ++k) {
      if (k % 4 != 3) light[static_cast<std::size_t>(k % 4)] += static_cast<double>(given.values()[k]);
    }
    Error error = error_of(area, given, bytes_of(block));
    const Sums rest = image::sum(off_, error.light, -1.0);
    double minimum_cost = cost_of(rest, error);
    Sums scale{1.0, 1.0, 1.0};
    Sums best_scale = scale;
    std::uint32_t state = 1;
    for (int trial = 0; trial < trials && excess(off_) > 0.0; ++trial) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double wanted = light[c] - rest[c];
        const double got = light[c] + error.light[c];
        const double ratio = got > 0.0 ? wanted / got : 1.0;
        scale[c] *= ratio;
        if (trial % 2 == 1) {  // the outcome moves in steps: try around the best, by up to 8 %
          state = 1664525U * state + 1013904223U;
          scale[c] = best_scale[c] * (0.92 + 0.16 * static_cast<double>(state >> 16U) / 65535.0);
        }
        scale[c] = std::clamp(scale[c], 0.5, 2.0);
      }
      Image changed(area.width, area.height);
      const auto values = std::size_t{4} * static_cast<std::size_t>(area.width * area.height);
      platform::ranges::copy(scaled({given.values(), values}, scale), changed.values());
      std::array<std::uint8_t, kBlockBytes> bytes{};
      encode(changed, 1, context_, bytes.data());
      error = error_of(area, given, bytes.data());
      const double cost = cost_of(rest, error);
      if (cost >= minimum_cost || excess(image::sum(rest, error.light)) >= excess(off_)) continue;
      minimum_cost = cost;
      best_scale = scale;
      off_ = image::sum(rest, error.light);
      std::copy_n(bytes.data(), kBlockBytes, bytes_of(block));
    }
  }

  const std::vector<LatLongView>& images_;
  int edge_;
  astcenc_context* context_;
  const stop_token& stop_;
  std::uint8_t* blocks_;
  Sums total_;
  std::vector<image::BlockShare> brightest_;
  Sums off_{};  ///< the level's excess over the source
};

}  // namespace

AstcDecoder make_astc_decoder(TexelKind kind, const std::filesystem::path& /*path*/) {
  const std::shared_ptr<astcenc_context> context =
      context_for(ASTCENC_PRF_HDR, kind, 0.0F, ASTCENC_FLG_DECOMPRESS_ONLY);
  return
      [context, edge = block_edge(kind)](const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) {
        decode_rows(context.get(), edge, blocks, width, first_row, rows, rgb);
      };
}

BlockLevels encode_astc(std::span<const std::vector<LatLongView>> levels, TexelKind kind, AstcEffort effort,
                        const Control& control) {
  const float quality = quality_of(effort);
  const int edge = block_edge(kind);
  const auto blocks_across = [edge](int texels) { return static_cast<std::size_t>((texels + edge - 1) / edge); };
  BlockLevels encoded;
  std::vector<std::vector<image::BlockLight>> lights;
  for (const std::vector<LatLongView>& images : levels) {
    const LatLongView& first = images.front();
    encoded.levels.emplace_back(kBlockBytes * blocks_across(first.width) * blocks_across(first.height) * images.size());
    lights.emplace_back(encoded.levels.back().size() / kBlockBytes);
  }
  const std::vector<Tile> tiles = tiles_of(levels, edge);
  std::vector<std::uint64_t> clamped(tiles.size());
  // Encoding a texel takes a thousand times as long as the work that `placement_for` is tuned for.
  const jobs::Placement placement = tiles.size() > 1 ? jobs::Placement::arena : jobs::Placement::calling_thread;
  std::vector<Context> contexts(jobs::worker_count(placement));
  const auto context_of = [&](std::size_t worker) {
    if (!contexts[worker]) contexts[worker] = context_for(ASTCENC_PRF_HDR_RGB_LDR_A, kind, quality, 0);
    return contexts[worker].get();
  };
  const auto encode_tile = [&](std::size_t index, std::size_t worker) {
    const Tile& tile = tiles[index];
    const LatLongView& view = levels[tile.level][tile.image];
    const std::size_t rows_above = tile.image * blocks_across(view.height) + static_cast<std::size_t>(tile.block_row);
    const std::size_t block = rows_above * blocks_across(view.width) + static_cast<std::size_t>(tile.first_block);
    std::uint8_t* const to = encoded.levels[tile.level].data() + kBlockBytes * block;
    const Area area = area_of(view, tile, edge);
    Image image(area.width, area.height);
    clamped[index] = read_area(view, area, image);
    add_light(area, edge, image.values(), lights[tile.level].data() + block);
    encode(image, tile.blocks, context_of(worker), to);
  };
  jobs::run_tiles(tiles.size(), placement, contexts.size(), jobs::part_of(control, 0.0, 0.95), encode_tile);
  jobs::run_tiles(levels.size(), placement, contexts.size(), jobs::part_of(control, 0.95, 1.0),
                  [&](std::size_t level, std::size_t worker) {
                    if (levels[level].front().width < kBalancedWidth) return;
                    Balancer(levels[level], edge, context_of(worker), lights[level], control.stop,
                             encoded.levels[level].data())
                        .run();
                  });
  for (const std::uint64_t values : clamped) encoded.values_clamped += values;
  return encoded;
}

}  // namespace welkin::files
