#include "codec/exr_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace welkin::codec {
namespace {

struct CompressionKind {
  const char* name;
  int scanlines;  // that are compressed together
};

// By Imf::Compression's values.
constexpr std::array kCompressions{
    CompressionKind{"none", 1},  CompressionKind{"rle", 1},    CompressionKind{"zips", 1}, CompressionKind{"zip", 16},
    CompressionKind{"piz", 32},  CompressionKind{"pxr24", 16}, CompressionKind{"b44", 32}, CompressionKind{"b44a", 32},
    CompressionKind{"dwaa", 32}, CompressionKind{"dwab", 256}};
static_assert(Imf::DWAB_COMPRESSION + 1 == kCompressions.size());

const CompressionKind* find_compression(Imf::Compression compression) noexcept {
  const auto index = static_cast<std::size_t>(compression);
  return index < kCompressions.size() ? &kCompressions[index] : nullptr;
}

std::int64_t halve(std::int64_t edge, Imf::LevelRoundingMode rounding) {
  return std::max<std::int64_t>((rounding == Imf::ROUND_UP ? edge + 1 : edge) / 2, 1);
}

// The edge at every level, down to 1. Halving again and again rounds as dividing once by 2^level does.
std::vector<std::int64_t> edges(std::int64_t edge, Imf::LevelRoundingMode rounding) {
  std::vector<std::int64_t> sizes{edge};
  while (sizes.back() > 1) {
    sizes.push_back(halve(sizes.back(), rounding));
  }
  return sizes;
}

std::int64_t at_level(const std::vector<std::int64_t>& sizes, std::size_t level) {
  return sizes[std::min(level, sizes.size() - 1)];
}

double tiles_across(std::int64_t edge, unsigned tile) {
  return std::ceil(static_cast<double>(edge) / static_cast<double>(tile));
}

double tile_count(const Imf::TileDescription& tiles, std::int64_t width, std::int64_t height) {
  if (tiles.mode != Imf::MIPMAP_LEVELS && tiles.mode != Imf::RIPMAP_LEVELS) {
    return tiles_across(width, tiles.xSize) * tiles_across(height, tiles.ySize);
  }
  const std::vector<std::int64_t> widths = edges(width, tiles.roundingMode);
  const std::vector<std::int64_t> heights = edges(height, tiles.roundingMode);
  double count = 0.0;
  if (tiles.mode == Imf::MIPMAP_LEVELS) {
    for (std::size_t level = 0; level < std::max(widths.size(), heights.size()); ++level) {
      count += tiles_across(at_level(widths, level), tiles.xSize) * tiles_across(at_level(heights, level), tiles.ySize);
    }
    return count;
  }
  double across = 0.0;
  double down = 0.0;
  for (const std::int64_t edge : widths) {
    across += tiles_across(edge, tiles.xSize);
  }
  for (const std::int64_t edge : heights) {
    down += tiles_across(edge, tiles.ySize);
  }
  return across * down;
}

}  // namespace

int scanlines_per_block(Imf::Compression compression) noexcept {
  const CompressionKind* kind = find_compression(compression);
  return kind == nullptr ? 0 : kind->scanlines;
}

const char* compression_name(Imf::Compression compression) noexcept {
  const CompressionKind* kind = find_compression(compression);
  return kind == nullptr ? nullptr : kind->name;
}

std::vector<LevelInfo> level_sizes(const Imf::TileDescription& tiles, int width, int height) {
  if (tiles.mode != Imf::MIPMAP_LEVELS && tiles.mode != Imf::RIPMAP_LEVELS) {
    return {{width, height}};
  }
  const std::vector<std::int64_t> widths = edges(width, tiles.roundingMode);
  const std::vector<std::int64_t> heights = edges(height, tiles.roundingMode);
  const std::size_t count = tiles.mode == Imf::MIPMAP_LEVELS ? std::max(widths.size(), heights.size())
                                                             : std::min(widths.size(), heights.size());
  std::vector<LevelInfo> levels;
  for (std::size_t level = 0; level < count; ++level) {
    levels.push_back({static_cast<int>(at_level(widths, level)), static_cast<int>(at_level(heights, level))});
  }
  return levels;
}

double chunk_count(const Imf::Header& header, bool tiled) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (tiled) {
    return tile_count(header.tileDescription(), width, height);
  }
  const int scanlines = std::max(scanlines_per_block(header.compression()), 1);
  return std::ceil(static_cast<double>(height) / scanlines);
}

}  // namespace welkin::codec
