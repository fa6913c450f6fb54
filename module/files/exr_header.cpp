#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/exr.h"
#include "files/primaries.h"

namespace welkin::files {
namespace {

// Indexed by Imf::Compression.
constexpr std::array kCompressions{
    CompressionKind{"none", 1},  CompressionKind{"rle", 1},    CompressionKind{"zips", 1}, CompressionKind{"zip", 16},
    CompressionKind{"piz", 32},  CompressionKind{"pxr24", 16}, CompressionKind{"b44", 32}, CompressionKind{"b44a", 32},
    CompressionKind{"dwaa", 32}, CompressionKind{"dwab", 256}};
static_assert(Imf::DWAB_COMPRESSION + 1 == kCompressions.size());

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

}  // namespace

const CompressionKind* compression_kind(Imf::Compression compression) noexcept {
  const auto index = static_cast<std::size_t>(compression);
  return index < kCompressions.size() ? &kCompressions[index] : nullptr;
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

namespace {

double tile_count(const Imf::TileDescription& tiles, int width, int height) {
  if (tiles.mode != Imf::RIPMAP_LEVELS) {
    double count = 0.0;
    for (const LevelInfo& level : level_sizes(tiles, width, height)) {
      count += tiles_across(level.width, tiles.xSize) * tiles_across(level.height, tiles.ySize);
    }
    return count;
  }
  // Its levels are all pairs of a width and a height.
  const auto across_all = [&](int edge, unsigned tile) {
    double count = 0.0;
    for (const std::int64_t each : edges(edge, tiles.roundingMode)) count += tiles_across(each, tile);
    return count;
  };
  return across_all(width, tiles.xSize) * across_all(height, tiles.ySize);
}

/// Returns the entries in the table of offsets of a part with a valid header, as many as the library will make. The
/// result is a double so that no count can wrap around.
double chunk_count(const Imf::Header& header, bool tiled) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (tiled) {
    return tile_count(header.tileDescription(), static_cast<int>(width), static_cast<int>(height));
  }
  const CompressionKind* const kind = compression_kind(header.compression());
  return std::ceil(static_cast<double>(height) / (kind != nullptr ? kind->scanlines : 1));
}

// OpenEXR allows 255 bytes for a name; the longest valid header seen was a few megabytes of preview.
constexpr std::size_t kLongestName = 255;
constexpr std::uint64_t kLargestHeader = std::uint64_t{256} << 20U;

struct FixedSize {
  std::string_view type;
  std::uint32_t bytes;
};

// The types that always take the same number of bytes.
constexpr std::array kFixedSizes{
    FixedSize{"box2f", 16},   FixedSize{"box2i", 16},      FixedSize{"chromaticities", 32},
    FixedSize{"double", 8},   FixedSize{"compression", 1}, FixedSize{"deepImageState", 1},
    FixedSize{"envmap", 1},   FixedSize{"float", 4},       FixedSize{"int", 4},
    FixedSize{"keycode", 28}, FixedSize{"lineOrder", 1},   FixedSize{"m33d", 72},
    FixedSize{"m33f", 36},    FixedSize{"m44d", 128},      FixedSize{"m44f", 64},
    FixedSize{"rational", 8}, FixedSize{"tiledesc", 9},    FixedSize{"timecode", 8},
    FixedSize{"v2d", 16},     FixedSize{"v2f", 8},         FixedSize{"v2i", 8},
    FixedSize{"v3d", 24},     FixedSize{"v3f", 12},        FixedSize{"v3i", 12},
};

[[noreturn]] void reject(const std::filesystem::path& path, const std::string& what) {
  throw platform::file_error(ErrorCode::corrupt_file, path,
                             "its OpenEXR header is damaged: " + what + "; fetch or export it again");
}

// Little-endian, as all of OpenEXR.
std::uint32_t read_uint32(platform::ByteFile& file) {
  std::array<std::uint8_t, 4> bytes{};
  file.read(bytes.data(), bytes.size());
  return platform::read_little_endian<std::uint32_t>(bytes.data());
}

std::string read_name(platform::ByteFile& file, std::uint64_t end) {
  std::string name;
  while (true) {
    char c = 0;
    if (file.position() >= end) {
      reject(file.path(), "a name does not end");
    }
    file.read(&c, 1);
    if (c == 0) {
      return name;
    }
    name += c;
    if (name.size() > kLongestName) {
      reject(file.path(), "a name is longer than " + std::to_string(kLongestName) + " bytes");
    }
  }
}

// Skips names with 16 bytes of description each, ended by an empty name.
void walk_channels(platform::ByteFile& file, std::uint64_t end) {
  constexpr std::uint64_t kDescription = 16;
  while (!read_name(file, end).empty()) {
    file.seek(file.position() + kDescription);
  }
}

// Skips strings with their length before each.
void walk_strings(platform::ByteFile& file, std::uint64_t end) {
  while (file.position() < end) {
    const std::uint32_t length = read_uint32(file);
    file.seek(file.position() + length);
  }
}

// Skips width and height, then four bytes per pixel.
void walk_preview(platform::ByteFile& file) {
  const std::uint64_t width = read_uint32(file);
  const std::uint64_t height = read_uint32(file);
  if (width > kLargestHeader || height > kLargestHeader) {
    reject(file.path(), "its preview is too large");
  }
  file.seek(file.position() + 4 * width * height);
}

// Moves past the value as OpenEXR will for the type.
void walk_value(platform::ByteFile& file, const std::string& type, std::uint32_t size) {
  const std::uint64_t end = file.position() + size;
  const auto* fixed = std::find_if(kFixedSizes.begin(), kFixedSizes.end(),
                                   [&](const FixedSize& candidate) { return candidate.type == type; });
  if (fixed != kFixedSizes.end()) {
    file.seek(file.position() + fixed->bytes);
  } else if (type == "chlist") {
    walk_channels(file, end);
  } else if (type == "stringvector") {
    walk_strings(file, end);
  } else if (type == "preview") {
    walk_preview(file);
  } else if (type == "floatvector") {
    file.seek(file.position() + size / 4 * 4);
  } else {
    file.seek(end);
  }
}

/// Walks the header's attributes from the current position (after magic number and version) to their end,
/// and checks that what OpenEXR 3 will allocate for each is no more than the bytes that the file has for it.
///
/// The library allocates by stated sizes and for most types reads what the type takes, whatever size was stated. So it
/// can be led to read a value's bytes as the next attribute's header, and to allocate gigabytes for a file of a few
/// hundred bytes. Where every stated size is the one that is consumed, the library takes the same walk. Throws `Error`
/// (corrupt_file) naming the attribute.
void check_attributes(platform::ByteFile& file) {
  const std::uint64_t limit = std::min(file.size(), file.position() + kLargestHeader);
  for (std::string name = read_name(file, limit); !name.empty(); name = read_name(file, limit)) {
    const std::string type = read_name(file, limit);
    const std::uint32_t size = read_uint32(file);
    const std::string title =
        "attribute \"" + platform::printable(name) + "\" of type \"" + platform::printable(type) + "\"";
    if (file.position() > limit || size > limit - file.position()) {
      reject(file.path(), title + " claims " + std::to_string(size) + " bytes, which it does not have");
    }
    const std::uint64_t end = file.position() + size;
    walk_value(file, type, size);
    if (file.position() != end) {
      reject(file.path(), title + " claims " + std::to_string(size) + " bytes, which is not its size");
    }
  }
}

// The library keeps a few kilobytes for each; the largest productions have a few dozen.
constexpr std::size_t kMaxParts = 1024;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found_and_remedy) {
  throw platform::file_error(ErrorCode::unsupported_file, path, found_and_remedy);
}

int read_version(platform::ByteFile& file) {
  std::array<unsigned char, 8> start{};
  file.read(start.data(), start.size());
  const int version = start[4] | start[5] << 8 | start[6] << 16;  // the top byte is kept free by the format
  if (Imf::getVersion(version) != Imf::EXR_VERSION || start[7] != 0 || !Imf::supportsFlags(Imf::getFlags(version))) {
    refuse(file.path(), "has an unknown OpenEXR version or kind (version " + std::to_string(Imf::getVersion(version)) +
                            ", flags " + std::to_string(Imf::getFlags(version) >> 8) + "); save it as OpenEXR 2");
  }
  if (Imf::isMultiPart(version) && Imf::isTiled(version)) {
    reject(file.path(), "it claims to be single-part tiled and multi-part at once");
  }
  return version;
}

// Checks the attributes first, then lets the library read them.
Imf::Header read_header(platform::ByteFile& file, ExrStream& stream, int version) {
  const std::uint64_t start = file.position();
  check_attributes(file);
  file.seek(start);
  Imf::Header header;
  header.readFrom(stream, version);
  return header;
}

// Headers of a multi-part file end with an empty one: a single zero byte.
bool at_last_header(platform::ByteFile& file) {
  char byte = 0;
  file.read(&byte, 1);
  if (byte != 0) {
    file.seek(file.position() - 1);
  }
  return byte == 0;
}

// As in the library, a single-part image's flags decide its type, whatever its type attribute says.
ExrPart describe_part(Imf::Header header, int version, const std::filesystem::path& path, std::size_t index) {
  ExrPart part;
  part.name = header.hasName() ? platform::printable(header.name()) : "";
  if (Imf::isMultiPart(version)) {
    if (!header.hasName() || !header.hasType()) {
      reject(path, "part " + std::to_string(index) + " lacks a " + (header.hasName() ? "type" : "name"));
    }
    part.tiled = header.type() == Imf::TILEDIMAGE;
    part.deep = !part.tiled && header.type() != Imf::SCANLINEIMAGE;
  } else {
    part.tiled = Imf::isTiled(version);
    part.deep = Imf::isNonImage(version) ||
                (header.hasType() && header.type() != Imf::TILEDIMAGE && header.type() != Imf::SCANLINEIMAGE);
  }
  part.header = std::move(header);
  return part;
}

// 0 "mask", 1 "beauty" (deep)
std::string part_list(const ExrParts& parts) {
  std::string list;
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    list += (i == 0 ? "" : ", ") + std::to_string(i) + " \"" + parts.parts[i].name + "\"" +
            (parts.parts[i].deep ? " (deep)" : "");
  }
  return platform::printable(list);
}

void require_flat(const ExrParts& parts, std::size_t index, const std::filesystem::path& path) {
  if (parts.parts[index].deep) {
    const std::string what = parts.multi_part ? "its part \"" + parts.parts[index].name + "\"" : "it";
    refuse(path, what + " is a deep OpenEXR image; flatten it to a plain one (RGB, half or float)");
  }
}

std::size_t find_part(const ExrParts& parts, const std::filesystem::path& path, const std::string& asked_for) {
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    const ExrPart& part = parts.parts[i];
    if (part.header.hasName() && (part.name == asked_for || part.header.name() == asked_for)) {
      return i;
    }
  }
  std::size_t number = 0;
  const char* end = asked_for.data() + asked_for.size();
  const auto [stop, failure] = std::from_chars(asked_for.data(), end, number);
  if (failure == std::errc() && stop == end && number < parts.parts.size()) {
    return number;
  }
  if (!parts.multi_part) {
    refuse(path,
           "has a single part, and part \"" + platform::printable(asked_for) + "\" was requested; leave --part out");
  }
  refuse(path, "has no part \"" + platform::printable(asked_for) + "\"; its parts are " + part_list(parts) +
                   ": pass one's name or number with --part");
}

}  // namespace

ExrParts read_exr_parts(platform::ByteFile& file) {
  const int version = read_version(file);
  ExrStream stream(file);
  ExrParts result;
  result.multi_part = Imf::isMultiPart(version);
  do {
    if (result.parts.size() == kMaxParts) {
      refuse(file.path(), "has more than " + std::to_string(kMaxParts) +
                              " parts; save the part that holds the environment as a file of its own "
                              "(exrmultipart -separate)");
    }
    result.parts.push_back(
        describe_part(read_header(file, stream, version), version, file.path(), result.parts.size()));
  } while (result.multi_part && !at_last_header(file));
  result.header_bytes = file.position();
  return result;
}

std::uint64_t check_exr_tables(const ExrParts& parts, const platform::ByteFile& file) {
  double chunks = 0.0;
  for (const ExrPart& part : parts.parts) {
    const std::string type = part.header.hasType() ? part.header.type() : "";
    const bool known = type.empty() || Imf::isSupportedType(type);
    part.header.sanityCheck(part.tiled || type == Imf::DEEPTILE, parts.multi_part);
    if (known) {
      chunks += chunk_count(part.header, part.tiled || type == Imf::DEEPTILE);
    } else {
      chunks += part.header.hasChunkCount() ? std::max(part.header.chunkCount(), 0) : 0;
    }
  }
  if (chunks * sizeof(std::uint64_t) > static_cast<double>(file.remaining())) {
    throw platform::file_error(ErrorCode::corrupt_file, file.path(),
                               "ends too early: its header tells of " +
                                   std::to_string(static_cast<std::uint64_t>(chunks)) +
                                   " blocks or tiles, for whose table alone it is too short; fetch or export it again");
  }
  return static_cast<std::uint64_t>(chunks) * sizeof(std::uint64_t);
}

std::size_t choose_exr_part(const ExrParts& parts, const std::filesystem::path& path, const std::string& asked_for,
                            const std::string& layer) {
  if (!asked_for.empty()) {
    const std::size_t index = find_part(parts, path, asked_for);
    require_flat(parts, index, path);
    return index;
  }
  if (parts.parts.size() == 1) {
    require_flat(parts, 0, path);
    return 0;
  }
  for (const bool in_colour : {true, false}) {
    for (std::size_t i = 0; i < parts.parts.size(); ++i) {
      const ExrPart& part = parts.parts[i];
      if (!part.deep && holds_image(part.header.channels(), layer, in_colour)) {
        return i;
      }
    }
  }
  refuse(path, "none of its parts (" + part_list(parts) + ") is a flat image with R, G and B or Y" +
                   (layer.empty() ? "" : " in a layer \"" + platform::printable(layer) + "\"") +
                   "; pass the part with --part and its layer with --layer, or convert it");
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

// Photoshop writes Rec. 709 as an ICC profile has it: adapted to D50. Converted back, only its roundings remain.
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

}  // namespace welkin::files
