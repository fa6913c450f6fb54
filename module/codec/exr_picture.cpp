#include "codec/exr_picture.h"

#include <ImfStandardAttributes.h>

#include <algorithm>
#include <string>

#include "codec/exr_levels.h"
#include "codec/exr_parts.h"
#include "codec/exr_primaries.h"
#include "codec/exr_stream.h"
#include "codec/exr_windows.h"
#include "codec/layout.h"
#include "codec/roughness_key.h"

namespace welkin::codec {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found_and_remedy) {
  throw file_error(ErrorCode::unsupported_file, path, found_and_remedy);
}

// Of a header that is not checked yet: the tile description may not be there at all.
const Imf::TileDescription* tile_description(const ExrPart& part) {
  return part.tiled && part.header.hasTileDescription() ? &part.header.tileDescription() : nullptr;
}

bool has_levels(const ExrPart& part) {
  const Imf::TileDescription* tiles = tile_description(part);
  return tiles != nullptr && tiles->mode != Imf::ONE_LEVEL;
}

void name_compression(ExrPicture& picture, const Imf::Header& header) {
  const char* name = compression_name(header.compression());
  if (name == nullptr) {
    refuse(picture.info.path, "is compressed in a way that is not known here (method " +
                                  std::to_string(static_cast<int>(header.compression())) + "); save it as zip or piz");
  }
  picture.info.compression = name;
}

void place_windows(ExrPicture& picture, const ExrPart& part, Layout asked_for) {
  const auto [whole, data] = choose_exr_windows(picture.info, part.header, has_levels(part), asked_for);
  picture.info.width = whole.max.x - whole.min.x + 1;
  picture.info.height = whole.max.y - whole.min.y + 1;
  picture.first_column = data.min.x;
  picture.first_row = data.min.y;
  picture.data_width = data.max.x - data.min.x + 1;
  picture.data_height = data.max.y - data.min.y + 1;
  picture.column_offset = whole.min.x - data.min.x;
  picture.row_offset = whole.min.y - data.min.y;
}

void decide_exr_layout(ExrPicture& picture, const Imf::Header& header, Layout asked_for) {
  std::optional<Layout> stated;
  if (Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_LATLONG) {
    stated = Layout::lat_long;
  } else if (Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE) {
    stated = Layout::vertical_strip;
  }
  decide_layout(picture.info, asked_for, stated);
  picture.cube_frames = picture.info.layout == Layout::vertical_strip && stated == Layout::vertical_strip;
}

// A smaller level has the layout of the full size, and must still have its shape: a strip of faces of less than a
// texel is none.
void choose_level(ExrPicture& picture, const ExrPart& part, int level) {
  EnvironmentInfo& info = picture.info;
  info.levels = part.tiled ? level_sizes(part.header.tileDescription(), info.width, info.height)
                           : std::vector<LevelInfo>{{info.width, info.height}};
  if (level < 0 || static_cast<std::size_t>(level) >= info.levels.size()) {
    refuse(info.path, "has no level " + std::to_string(level) + "; it has " +
                          (info.levels.size() == 1 ? "one, level 0: leave --level out"
                                                   : std::to_string(info.levels.size()) + ": pass --level 0 to " +
                                                         std::to_string(info.levels.size() - 1)));
  }
  if (level > 0) {
    picture.level = level;
    const LevelInfo& size = info.levels[static_cast<std::size_t>(level)];
    picture.data_width = info.width = size.width;
    picture.data_height = info.height = size.height;
    const std::string reason = info.layout_reason;
    decide_layout(info, info.layout, std::nullopt);
    info.layout_reason = reason;
  }
}

// All channels, also those that are not wanted: they are in the same blocks.
std::uint64_t bytes_per_texel(const Imf::ChannelList& channels) {
  std::uint64_t bytes = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    bytes += channel.channel().type == Imf::HALF ? 2 : 4;
  }
  return bytes;
}

std::string describe_tiles(const Imf::TileDescription& tiles) {
  const char* kind = tiles.mode == Imf::MIPMAP_LEVELS   ? "mip-mapped tiles "
                     : tiles.mode == Imf::RIPMAP_LEVELS ? "rip-mapped tiles "
                                                        : "tiled ";
  return kind + std::to_string(tiles.xSize) + " x " + std::to_string(tiles.ySize);
}

void measure_units(ExrPicture& picture, const Imf::Header& header) {
  const std::uint64_t texel = bytes_per_texel(header.channels());
  const auto height = static_cast<std::uint64_t>(picture.data_height);
  if (picture.tiled) {
    const Imf::TileDescription& tiles = header.tileDescription();
    picture.info.storage = describe_tiles(tiles);
    picture.unit_rows = static_cast<int>(std::min<std::uint64_t>(tiles.ySize, height));
    // Neither factor is above 2^31, and the last one only divides: no product overflows.
    const std::uint64_t area = std::uint64_t{tiles.xSize} * tiles.ySize;
    picture.unit_bytes = area > kMaximumUnitBytes ? area : area * texel;
  } else {
    const auto scanlines = static_cast<std::uint64_t>(scanlines_per_block(header.compression()));
    picture.info.storage = "scanline";
    picture.unit_rows = static_cast<int>(std::min(scanlines, height));
    picture.unit_bytes = texel * static_cast<std::uint64_t>(picture.data_width) * scanlines;
  }
  if (picture.unit_bytes > kMaximumUnitBytes) {
    throw file_error(ErrorCode::limit_exceeded, picture.info.path,
                     "one block of it (" + picture.info.storage + ") takes " +
                         std::to_string(picture.unit_bytes >> 20U) + " MiB, above the " +
                         std::to_string(kMaximumUnitBytes >> 20U) +
                         " that are decoded at once; save it with smaller tiles or fewer channels");
  }
}

void name_parts(EnvironmentInfo& info, const ExrParts& parts) {
  for (const ExrPart& part : parts.parts) {
    if (parts.multi_part) {
      info.parts.push_back(part.name);
    }
  }
}

// The library's copies of a header are several times as large as it is in the file, and it keeps two.
std::uint64_t bytes_of_headers(const ExrParts& parts) {
  constexpr std::uint64_t kTimes = 16;
  return kTimes * parts.header_bytes;
}

bool has_roughness(const Imf::Header& header) {
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    if (speaks_of_roughness(attribute.name())) return true;
  }
  return false;
}

}  // namespace

ExrPicture inspect_exr(ByteFile& file, const ReadOptions& options) {
  return call_openexr(file.path(), [&] {
    const ExrParts parts = read_exr_parts(file);
    ExrPicture picture;
    picture.info.path = file.path();
    picture.info.format = "OpenEXR";
    name_parts(picture.info, parts);
    const std::size_t index = choose_exr_part(parts, file.path(), options.part, options.layer);
    const ExrPart& part = parts.parts[index];
    picture.part = static_cast<int>(index);
    picture.tiled = part.tiled;
    name_compression(picture, part.header);
    place_windows(picture, part, options.layout);
    picture.table_bytes = bytes_of_headers(parts) + check_exr_tables(parts, file);
    picture.channels = choose_exr_channels(picture.info, part.header.channels(), options.layer);
    decide_exr_layout(picture, part.header, options.layout);
    choose_level(picture, part, options.level);
    measure_units(picture, part.header);
    picture.prefiltered = has_roughness(part.header);
    picture.to_rec709 = exr_colour_matrix(picture.info, part.header, picture.channels.kind, options.primaries);
    return picture;
  });
}

}  // namespace welkin::codec
