#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "files/exr.h"
#include "files/primaries.h"
#include "files/textures.h"
#include "platform/file.h"

namespace welkin::files {
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

namespace {

glm::dvec2 to_glm(const Imath::V2f& xy) { return {xy.x, xy.y}; }

Chromaticities read_chromaticities(const Imf::Header& header) {
  const Imf::Chromaticities& stated = Imf::chromaticities(header);
  return {to_glm(stated.red), to_glm(stated.green), to_glm(stated.blue), to_glm(stated.white)};
}

std::optional<glm::dvec2> read_neutral(const Imf::Header& header) {
  return Imf::hasAdoptedNeutral(header) ? std::optional(to_glm(Imf::adoptedNeutral(header))) : std::nullopt;
}

[[noreturn]] void reject(const EnvironmentInfo& info, const char* attribute, const Chromaticities& found,
                         const char* remedy) {
  throw platform::file_error(ErrorCode::corrupt_file, info.path,
                             std::string("its attribute \"") + attribute + "\" makes no colours, with chromaticities " +
                                 describe(found) + "; " + remedy);
}

// Photoshop writes Rec. 709 as an ICC profile has it: adapted to D50. The way back is no more than its roundings.
bool is_nearly_nothing(const glm::dmat3& matrix) {
  constexpr double kRounding = 2e-3;
  double worst = 0.0;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      worst = std::max(worst, std::abs(matrix[column][row] - (row == column ? 1.0 : 0.0)));
    }
  }
  return worst < kRounding;
}

}  // namespace

std::optional<glm::dmat3> exr_colour_matrix(EnvironmentInfo& info, const Imf::Header& header, ExrChannels::Kind kind,
                                            Primaries wanted) {
  if (!Imf::hasChromaticities(header) || kind == ExrChannels::Kind::luminance) {
    return std::nullopt;
  }
  const Chromaticities stated = read_chromaticities(header);
  const std::optional<glm::dvec2> neutral = read_neutral(header);
  const bool sound = rgb_to_xyz(stated).has_value();
  if (!sound && kind == ExrChannels::Kind::luminance_chroma) {
    reject(info, "chromaticities", stated, "luminance and chroma cannot be taken apart: export it again");
  }
  Chromaticities balanced = stated;
  balanced.white = neutral.value_or(stated.white);
  if (nearly_same(stated, kRec709) && nearly_same(balanced, kRec709)) {
    return std::nullopt;
  }
  if (wanted == Primaries::as_stored) {
    info.notes.push_back("colours left in the primaries of the file: " + describe(stated));
    return std::nullopt;
  }
  const std::optional<glm::dmat3> matrix = to_rec709(stated, neutral);
  if (!matrix) {
    reject(info, sound && neutral ? "adoptedNeutral" : "chromaticities", stated,
           "pass --primaries as-stored to read the numbers unchanged, or export it again");
  }
  if (is_nearly_nothing(*matrix)) {
    info.notes.push_back("colours left as they are: the primaries of the file, " + describe(stated) +
                         ", are those of Rec. 709 seen under another white");
    return std::nullopt;
  }
  info.notes.push_back("primaries converted from " + describe(stated) + " to Rec. 709");
  return matrix;
}

// Blocks of OpenEXR files that unpack to less than their texels. The library (3.1) looks at the length of what most of
// its codecs give, but not of ZIP's, RLE's and uncompressed blocks: the rest of their texels would be whatever its
// memory held.

namespace {

/// How many of the positions first to last are multiples of `step`.
std::size_t samples(int first, int last, int step) {
  const auto below = [step](int position) {  // multiples up to this one, from an arbitrary one on
    return position >= 0 ? position / step : -((-position + step - 1) / step);
  };
  return static_cast<std::size_t>(below(last) - below(first - 1));
}

/// Of one row, all channels.
std::uint64_t row_bytes(const Imf::ChannelList& channels, int row, int first_column, int last_column) {
  std::uint64_t bytes = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const Imf::Channel& one = channel.channel();
    if (samples(row, row, one.ySampling) == 0) continue;
    bytes += samples(first_column, last_column, one.xSampling) * (one.type == Imf::HALF ? 2U : 4U);
  }
  return bytes;
}

/// What OpenEXR's run lengths unpack to: a count below 0 stands before so many bytes, one from 0 on before a byte that
/// stands for one more than that (ImfRle.cpp).
std::uint64_t unpacked_rle_bytes(std::span<const char> packed) {
  std::uint64_t bytes = 0;
  for (std::size_t at = 0; at + 1 < packed.size();) {
    constexpr std::size_t kMinNegative = 128;  // of bytes that stand for numbers in two's complement
    const std::size_t count = static_cast<unsigned char>(packed[at]);
    const bool negative = count >= kMinNegative;
    const std::size_t length = negative ? 2 * kMinNegative - count : count + 1;
    bytes += length;
    at += negative ? 1 + length : 2;
  }
  return bytes;
}

}  // namespace

void ExrBlocks::check_rows(ExrStream& stream, int row) const {
  const std::optional<std::span<const char>> block = stream.take_block();
  if (!block) return;
  const Imath::Box2i& window = header_.dataWindow();
  const int first = row - (row - window.min.y) % picture_.unit_rows;
  std::uint64_t expected = 0;
  for (int each = first; each <= std::min(first + picture_.unit_rows - 1, window.max.y); ++each) {
    expected += row_bytes(header_.channels(), each, window.min.x, window.max.x);
  }
  check(*block, expected, "the block of row " + std::to_string(first));
}

void ExrBlocks::check_tile(ExrStream& stream, int column, int row) const {
  const std::optional<std::span<const char>> block = stream.take_block();
  if (!block) return;
  const Imf::TileDescription& tiles = header_.tileDescription();
  const auto width = static_cast<int>(tiles.xSize);
  const int columns = std::min(width, picture_.data_width - column * width);
  const int rows = std::min(picture_.unit_rows, picture_.data_height - row * picture_.unit_rows);
  const std::uint64_t expected = static_cast<std::uint64_t>(rows) * row_bytes(header_.channels(), 0, 0, columns - 1);
  check(*block, expected, "tile " + std::to_string(column) + ", " + std::to_string(row));
}

void ExrBlocks::check(std::span<const char> block, std::uint64_t expected, const std::string& what) const {
  std::optional<std::uint64_t> unpacked = block.size();
  if (block.size() < expected) {  // a longer one is not packed, whatever the header says
    switch (header_.compression()) {
      case Imf::NO_COMPRESSION: break;
      case Imf::RLE_COMPRESSION: unpacked = unpacked_rle_bytes(block); break;
      case Imf::ZIP_COMPRESSION:
      case Imf::ZIPS_COMPRESSION: unpacked = unpacked_zlib_bytes(block, expected); break;
      default: return;
    }
  }
  if (!unpacked || *unpacked >= expected) return;
  throw platform::file_error(ErrorCode::corrupt_file, picture_.info.path,
                             what + " unpacks to " + std::to_string(*unpacked) + " bytes, its texels take " +
                                 std::to_string(expected) + "; fetch or export it again");
}

}  // namespace welkin::files
