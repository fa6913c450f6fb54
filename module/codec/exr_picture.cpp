#include "codec/exr_picture.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "codec/exr_attributes.h"
#include "codec/exr_stream.h"
#include "codec/layout.h"
#include "codec/row_source.h"

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

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found_and_remedy) {
  throw file_error(ErrorCode::unsupported_file, path, found_and_remedy);
}

// Magic number and version, then the attributes. Leaves the file behind the header.
Imf::Header read_header(ByteFile& file, int& version) {
  std::array<unsigned char, 8> start{};
  file.read(start.data(), start.size());
  version = start[4] | start[5] << 8 | start[6] << 16;  // the top byte is kept free by the format
  if (Imf::getVersion(version) != Imf::EXR_VERSION || start[7] != 0 || !Imf::supportsFlags(Imf::getFlags(version))) {
    refuse(file.path(), "is of an OpenEXR version or kind that is not known here (version " +
                            std::to_string(Imf::getVersion(version)) + ", flags " +
                            std::to_string(Imf::getFlags(version) >> 8) + "); save it as OpenEXR 2");
  }
  if (Imf::isNonImage(version)) {
    refuse(file.path(), "is a deep OpenEXR file; flatten it to a plain picture (RGB, half or float)");
  }
  if (Imf::isMultiPart(version)) {
    refuse(file.path(),
           "is a multi-part OpenEXR file; save the part that holds the environment as a file of its own "
           "(exrmultipart -separate)");
  }
  check_exr_attributes(file);
  file.seek(start.size());
  Imf::Header header;
  ExrStream stream(file);
  header.readFrom(stream, version);
  return header;
}

// "half", "float" or "uint"
const char* type_name(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT: return "uint";
    case Imf::HALF: return "half";
    case Imf::FLOAT: return "float";
    default: return "unknown";
  }
}

std::string channel_names(const EnvironmentInfo& info) {
  std::string names;
  for (const ChannelInfo& channel : info.channels) {
    names += (names.empty() ? "" : ", ") + channel.name;
  }
  return printable(names);
}

void require_usable_channel(const std::filesystem::path& path, const char* name, const Imf::Channel& channel) {
  if (channel.type != Imf::HALF && channel.type != Imf::FLOAT) {
    refuse(path, std::string("channel ") + name + " is of type " + type_name(channel.type) +
                     "; half and float are read: convert it");
  }
  if (channel.xSampling != 1 || channel.ySampling != 1) {
    refuse(path, std::string("channel ") + name + " is subsampled (" + std::to_string(channel.xSampling) + " x " +
                     std::to_string(channel.ySampling) + "); save it at full resolution");
  }
}

// R, G and B if they are there, else Y alone. Further channels (alpha, depth) are read past.
void choose_channels(ExrPicture& picture, const Imf::ChannelList& channels) {
  const std::filesystem::path& path = picture.info.path;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    picture.info.channels.push_back({printable(channel.name()), type_name(channel.channel().type)});
  }
  const bool coloured = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
  if (!coloured && (channels.findChannel("RY") || channels.findChannel("BY"))) {
    refuse(path, "holds luminance and chroma (channels " + channel_names(picture.info) +
                     "); R, G, B or Y alone are read: convert it to RGB");
  }
  picture.grey = !coloured;
  const std::vector<const char*> wanted = coloured ? std::vector{"R", "G", "B"} : std::vector{"Y"};
  for (const char* name : wanted) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (channel == nullptr) {
      refuse(path, "has channels " + channel_names(picture.info) +
                       "; R, G and B, or Y alone, are read: rename or convert the channels");
    }
    require_usable_channel(path, name, *channel);
  }
}

void measure_window(ExrPicture& picture, const Imath::Box2i& window) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1) {
    throw file_error(ErrorCode::corrupt_file, picture.info.path,
                     "its OpenEXR header is damaged: the data window is empty; fetch or export it again");
  }
  if (width > kMaximumWidth || height > kMaximumHeight) {
    refuse(picture.info.path, "its data window of " + std::to_string(width) + " x " + std::to_string(height) +
                                  " is larger than any layout holds (" + std::to_string(kMaximumWidth) + " x " +
                                  std::to_string(kMaximumHeight) + "); reduce it first");
  }
  picture.info.width = static_cast<int>(width);
  picture.info.height = static_cast<int>(height);
  picture.first_column = window.min.x;
  picture.first_row = window.min.y;
}

// All channels, also those that are not wanted: they are in the same blocks.
std::uint64_t bytes_per_texel(const Imf::ChannelList& channels) {
  std::uint64_t bytes = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    bytes += channel.channel().type == Imf::HALF ? 2 : 4;
  }
  return bytes;
}

std::uint64_t ceiling_of_quotient(std::uint64_t dividend, std::uint64_t divisor) {
  return (dividend + divisor - 1) / divisor;
}

// The library keeps eight bytes a tile in memory before it reads any. They are in the file too, so a file
// that is too short for them is refused here. (The levels of a mip map add a third, of a rip map three times.)
void require_room_for_tile_table(const ExrPicture& picture, const ByteFile& file, const Imf::TileDescription& tiles) {
  const std::uint64_t count = ceiling_of_quotient(static_cast<std::uint64_t>(picture.info.width), tiles.xSize) *
                              ceiling_of_quotient(static_cast<std::uint64_t>(picture.info.height), tiles.ySize);
  if (count * sizeof(std::uint64_t) > file.remaining()) {
    throw file_error(ErrorCode::corrupt_file, picture.info.path,
                     "ends too early: its header tells of " + std::to_string(count) +
                         " tiles, for whose table alone it is too short; fetch or export it again");
  }
}

void measure_units(ExrPicture& picture, const ByteFile& file, const Imf::Header& header) {
  const std::uint64_t texel = bytes_per_texel(header.channels());
  const auto height = static_cast<std::uint64_t>(picture.info.height);
  if (picture.tiled) {
    const Imf::TileDescription& tiles = header.tileDescription();
    require_room_for_tile_table(picture, file, tiles);
    picture.info.storage = "tiled " + std::to_string(tiles.xSize) + " x " + std::to_string(tiles.ySize);
    picture.unit_rows = static_cast<int>(std::min<std::uint64_t>(tiles.ySize, height));
    // Neither factor is above 2^31, and the last one only divides: no product overflows.
    const std::uint64_t area = std::uint64_t{tiles.xSize} * tiles.ySize;
    picture.unit_bytes = area > kMaximumUnitBytes ? area : area * texel;
  } else {
    const int scanlines = kCompressions[static_cast<std::size_t>(header.compression())].scanlines;
    picture.info.storage = "scanline";
    picture.unit_rows = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(scanlines), height));
    picture.unit_bytes = texel * static_cast<std::uint64_t>(picture.info.width) * static_cast<std::uint64_t>(scanlines);
  }
  if (picture.unit_bytes > kMaximumUnitBytes) {
    throw file_error(ErrorCode::limit_exceeded, picture.info.path,
                     "one block of it (" + picture.info.storage + ") takes " +
                         std::to_string(picture.unit_bytes >> 20U) + " MiB, above the " +
                         std::to_string(kMaximumUnitBytes >> 20U) +
                         " that are decoded at once; save it with smaller tiles or fewer channels");
  }
}

std::optional<Layout> layout_by_header(const Imf::Header& header) {
  if (!Imf::hasEnvmap(header)) {
    return std::nullopt;
  }
  switch (Imf::envmap(header)) {
    case Imf::ENVMAP_LATLONG: return Layout::lat_long;
    case Imf::ENVMAP_CUBE: return Layout::vertical_strip;
    default: return std::nullopt;
  }
}

void name_compression(ExrPicture& picture, const Imf::Header& header) {
  const auto index = static_cast<std::size_t>(header.compression());
  if (index >= kCompressions.size()) {
    refuse(picture.info.path, "is compressed in a way that is not known here (method " + std::to_string(index) +
                                  "); save it as zip or piz");
  }
  picture.info.compression = kCompressions[index].name;
}

void require_flat(const ExrPicture& picture, const Imf::Header& header) {
  if (header.hasType() && header.type() != "scanlineimage" && header.type() != "tiledimage") {
    refuse(picture.info.path, "is of type \"" + printable(header.type()) +
                                  "\"; flatten it to a plain picture (scanlineimage or tiledimage)");
  }
}

}  // namespace

ExrPicture inspect_exr(ByteFile& file, const ReadOptions& options) {
  return call_openexr(file.path(), [&] {
    int version = 0;
    const Imf::Header header = read_header(file, version);
    ExrPicture picture;
    picture.info.path = file.path();
    picture.info.format = "OpenEXR";
    picture.tiled = Imf::isTiled(version);
    require_flat(picture, header);
    name_compression(picture, header);
    measure_window(picture, header.dataWindow());
    header.sanityCheck(picture.tiled);
    choose_channels(picture, header.channels());
    measure_units(picture, file, header);
    const std::optional<Layout> stated = layout_by_header(header);
    decide_layout(picture.info, options.layout, stated);
    picture.cube_frames = picture.info.layout == Layout::vertical_strip && stated == Layout::vertical_strip;
    return picture;
  });
}

}  // namespace welkin::codec
