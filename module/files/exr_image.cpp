#include <ImfStandardAttributes.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "files/exr.h"
#include "files/layout.h"
#include "files/row_source.h"
#include "files/textures.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

[[noreturn]] void refuse(const EnvironmentInfo& info, const std::string& found_and_remedy) {
  throw platform::file_error(ErrorCode::unsupported_file, info.path, found_and_remedy);
}

// The rectangle of an OpenEXR file that is the image.

/// The image's rectangle and that of the stored texels, in one frame of coordinates: x right, y down, both
/// inclusive. Texels of the image that are not stored are black.
struct Windows {
  Imath::Box2i image;
  Imath::Box2i data;
};

// In 64 bits, as corners may be any 32-bit numbers.
struct Extent {
  std::int64_t width = 0;
  std::int64_t height = 0;

  [[nodiscard]] bool is_empty() const { return width < 1 || height < 1; }
  [[nodiscard]] std::int64_t texels() const { return is_empty() ? 0 : width * height; }
};

Extent extent(const Imath::Box2i& window) {
  return {std::int64_t{window.max.x} - window.min.x + 1, std::int64_t{window.max.y} - window.min.y + 1};
}

Extent overlap(const Imath::Box2i& a, const Imath::Box2i& b) {
  return {std::int64_t{std::min(a.max.x, b.max.x)} - std::max(a.min.x, b.min.x) + 1,
          std::int64_t{std::min(a.max.y, b.max.y)} - std::max(a.min.y, b.min.y) + 1};
}

std::string text(const Extent& size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

std::optional<Layout> layout_of_shape(const Extent& size) {
  if (size.width == 2 * size.height) return Layout::lat_long;
  for (const Layout layout :
       {Layout::vertical_strip, Layout::horizontal_strip, Layout::horizontal_cross, Layout::vertical_cross}) {
    const CubePlacement& faces = cube_placement(layout);
    if (faces.rows * size.width == faces.columns * size.height) return layout;
  }
  return std::nullopt;
}

bool display_window_is_image(const Imath::Box2i& data, const Imath::Box2i& display, Layout asked_for) {
  const Extent data_size = extent(data);
  const Extent display_size = extent(display);
  const std::optional<Layout> shape = display_size.is_empty() ? std::nullopt : layout_of_shape(display_size);
  if (!shape || overlap(data, display).is_empty()) {
    return false;
  }
  if (asked_for != Layout::automatic) {
    return *shape == asked_for;
  }
  return layout_of_shape(data_size).value_or(*shape) == *shape;
}

void require_bounded(const EnvironmentInfo& info, const char* window, const Extent& size) {
  if (size.width > kMaximumWidth || size.height > kMaximumHeight) {
    refuse(info, std::string("its ") + window + " window of " + text(size) + " is larger than any layout holds (" +
                     text({kMaximumWidth, kMaximumHeight}) + "); reduce it first");
  }
}

void require_substance(const EnvironmentInfo& info, const Extent& display, const Extent& stored) {
  constexpr std::int64_t kLargestMostlyBlack = std::int64_t{16384} * 8192;
  constexpr std::int64_t kMinShare = 64;
  if (display.texels() > kLargestMostlyBlack && display.texels() / kMinShare > stored.texels()) {
    refuse(info, "stores " + text(stored) + " texels of a display window of " + text(display) + ", less than a " +
                     std::to_string(kMinShare) + "th; save it with the intended display window");
  }
}

void note_windows(EnvironmentInfo& info, const Extent& data, const Extent& display, const Extent& stored) {
  if (stored.texels() < data.texels()) {
    info.notes.push_back("overscan cropped: the data window of " + text(data) +
                         " extends beyond the display window of " + text(display));
  }
  if (stored.texels() < display.texels()) {
    info.notes.push_back("padded with black: the data window of " + text(data) +
                         " does not fill the display window of " + text(display));
  }
}

/// Chooses the image's window. It is the data window, wherever it lies, unless the file frames it: the display window
/// is the image if
/// - the header has no envmap attribute, which makes the data window the map (ImfEnvmap.h), and no mip chain, which
///   belongs to the data window,
/// - the windows differ in size and overlap,
/// - it has the shape of a layout (2:1, 1:6, 6:1, 4:3, 3:4): of the requested one, if any, and
/// - the data window does not have the shape of another layout, if none was requested.
/// So overscan is cut off and a cropped render is put back in its frame; `info.notes` states either.
///
/// Both windows are then at most kMaximumWidth x kMaximumHeight, and of an image above 16384 x 8192 texels at least
/// a 64th is stored, so that a few bytes cannot make hours of work.
/// Throws `Error`: corrupt_file for an empty data window, unsupported_file for what is too large.
Windows choose_windows(EnvironmentInfo& info, const Imf::Header& header, bool has_levels, Layout asked_for) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  const Extent data_size = extent(data);
  const Extent display_size = extent(display);
  if (data_size.is_empty()) {
    throw platform::file_error(ErrorCode::corrupt_file, info.path,
                               "its OpenEXR header is damaged: the data window is empty; fetch or export it again");
  }
  require_bounded(info, "data", data_size);
  const bool same_size = data_size.width == display_size.width && data_size.height == display_size.height;
  if (same_size || Imf::hasEnvmap(header) || has_levels) {
    return {data, data};
  }
  if (!display_window_is_image(data, display, asked_for)) {
    info.notes.push_back("the data window of " + text(data_size) +
                         " is the image; the display window has another size and is ignored");
    return {data, data};
  }
  const Extent stored = overlap(data, display);
  require_bounded(info, "display", display_size);
  require_substance(info, display_size, stored);
  note_windows(info, data_size, display_size, stored);
  return {display, data};
}

// For a header that is not checked yet: the tile description may be missing.
const Imf::TileDescription* tile_description(const ExrPart& part) {
  return part.tiled && part.header.hasTileDescription() ? &part.header.tileDescription() : nullptr;
}

bool has_levels(const ExrPart& part) {
  const Imf::TileDescription* tiles = tile_description(part);
  return tiles != nullptr && tiles->mode != Imf::ONE_LEVEL;
}

void name_compression(ExrImage& image, const Imf::Header& header) {
  const CompressionKind* const kind = compression_kind(header.compression());
  if (kind == nullptr) {
    refuse(image.info, "has an unknown compression (method " + std::to_string(static_cast<int>(header.compression())) +
                           "); save it as zip or piz");
  }
  image.info.compression = kind->name;
}

void place_windows(ExrImage& image, const ExrPart& part, Layout asked_for) {
  const auto [whole, data] = choose_windows(image.info, part.header, has_levels(part), asked_for);
  image.info.width = whole.max.x - whole.min.x + 1;
  image.info.height = whole.max.y - whole.min.y + 1;
  image.first_column = data.min.x;
  image.first_row = data.min.y;
  image.data_width = data.max.x - data.min.x + 1;
  image.data_height = data.max.y - data.min.y + 1;
  image.column_offset = whole.min.x - data.min.x;
  image.row_offset = whole.min.y - data.min.y;
}

void decide_exr_layout(ExrImage& image, const Imf::Header& header, Layout asked_for) {
  std::optional<Layout> stated;
  if (Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_LATLONG) {
    stated = Layout::lat_long;
  } else if (Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE) {
    stated = Layout::vertical_strip;
  }
  decide_layout(image.info, asked_for, stated);
  image.cube_frames = image.info.layout == Layout::vertical_strip && stated == Layout::vertical_strip;
}

// A smaller level has the layout of the full size, and must still have its shape: a strip needs faces of at least a
// texel.
void choose_level(ExrImage& image, const ExrPart& part, int level) {
  EnvironmentInfo& info = image.info;
  info.levels = part.tiled ? level_sizes(part.header.tileDescription(), info.width, info.height)
                           : std::vector<LevelInfo>{{info.width, info.height}};
  require_level(info, static_cast<int>(info.levels.size()), level);
  if (level > 0) {
    image.level = level;
    const LevelInfo& size = info.levels[static_cast<std::size_t>(level)];
    image.data_width = info.width = size.width;
    image.data_height = info.height = size.height;
    const std::string reason = info.layout_reason;
    decide_layout(info, info.layout, std::nullopt);
    info.layout_reason = reason;
  }
}

// Counts all channels, also unused ones: they are in the same blocks.
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

void measure_units(ExrImage& image, const Imf::Header& header) {
  const std::uint64_t texel = bytes_per_texel(header.channels());
  const auto height = static_cast<std::uint64_t>(image.data_height);
  if (image.tiled) {
    const Imf::TileDescription& tiles = header.tileDescription();
    image.info.storage = describe_tiles(tiles);
    image.unit_rows = static_cast<int>(std::min<std::uint64_t>(tiles.ySize, height));
    // Neither factor is above 2^31, and the last one only divides: no product overflows.
    const std::uint64_t area = std::uint64_t{tiles.xSize} * tiles.ySize;
    image.unit_bytes = area > kMaximumUnitBytes ? area : area * texel;
  } else {
    const auto scanlines = static_cast<std::uint64_t>(compression_kind(header.compression())->scanlines);
    image.info.storage = "scanline";
    image.unit_rows = static_cast<int>(std::min(scanlines, height));
    image.unit_bytes = texel * static_cast<std::uint64_t>(image.data_width) * scanlines;
  }
  if (image.unit_bytes > kMaximumUnitBytes) {
    throw platform::file_error(ErrorCode::limit_exceeded, image.info.path,
                               "one block of it (" + image.info.storage + ") takes " +
                                   std::to_string(image.unit_bytes >> 20U) + " MiB, above the " +
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

using Kind = ExrChannels::Kind;

// Spellings of the three colours in programs. "red" is Nuke's in layers.
constexpr std::array<std::array<const char*, 3>, 4> kSpellings{{
    {"R", "G", "B"},
    {"r", "g", "b"},
    {"red", "green", "blue"},
    {"Red", "Green", "Blue"},
}};

struct Layer {
  std::string name;
  ExrChannels channels;
};

ChannelType type_of(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT: return ChannelType::uint32;
    case Imf::HALF: return ChannelType::half;
    case Imf::FLOAT: return ChannelType::float32;
    default: return ChannelType::unknown;
  }
}

std::string channel_names(const EnvironmentInfo& info) {
  std::string names;
  for (const ChannelInfo& channel : info.channels) {
    names += (names.empty() ? "" : ", ") + channel.name;
  }
  return platform::printable(names);
}

std::optional<ExrChannels> image_in(const Imf::ChannelList& channels, const std::string& layer) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  const auto has = [&](const char* name) { return channels.findChannel(prefix + name) != nullptr; };
  for (const auto& [red, green, blue] : kSpellings) {
    if (has(red) && has(green) && has(blue)) {
      return ExrChannels{Kind::colour, {prefix + red, prefix + green, prefix + blue}};
    }
  }
  if (!has("Y") || (has("X") && has("Z"))) {
    return std::nullopt;
  }
  if (has("RY") || has("BY")) {
    return ExrChannels{Kind::luminance_chroma, {prefix + "RY", prefix + "Y", prefix + "BY"}};
  }
  return ExrChannels{Kind::luminance, {prefix + "Y", "", ""}};
}

std::vector<Layer> find_images(const Imf::ChannelList& channels) {
  std::set<std::string> names;
  channels.layers(names);
  names.insert("");  // the channels without one
  std::vector<Layer> found;
  for (const std::string& name : names) {
    if (const std::optional<ExrChannels> image = image_in(channels, name)) {
      found.push_back({name, *image});
    }
  }
  return found;
}

std::string list_layers(const std::vector<Layer>& layers) {
  std::string list;
  for (const Layer& layer : layers) {
    list += (list.empty() ? "" : ", ") + (layer.name.empty() ? std::string("the one without a name") : layer.name);
  }
  return platform::printable(list);
}

const Layer& find_layer(const EnvironmentInfo& info, const std::vector<Layer>& layers, const std::string& asked_for) {
  const auto layer = std::find_if(layers.begin(), layers.end(), [&](const Layer& candidate) {
    return candidate.name == asked_for || platform::printable(candidate.name) == asked_for;
  });
  if (layer == layers.end()) {
    refuse(info, "has no layer \"" + platform::printable(asked_for) + "\" with R, G and B or Y (channels " +
                     channel_names(info) + "); " +
                     (info.layers.empty() ? "leave --layer out" : "pass --layer with one of: " + list_layers(layers)));
  }
  return *layer;
}

const Layer& choose_layer(const EnvironmentInfo& info, const std::vector<Layer>& layers) {
  if (layers.empty()) {
    refuse(info, "has channels " + channel_names(info) +
                     "; R, G and B, or Y alone or with RY and BY, are read: rename or convert the channels");
  }
  if (layers.front().name.empty() || layers.size() == 1) {
    return layers.front();
  }
  const auto in_colour = [](const Layer& layer) { return layer.channels.kind != Kind::luminance; };
  const auto first = std::find_if(layers.begin(), layers.end(), in_colour);
  if (first == layers.end() || std::any_of(first + 1, layers.end(), in_colour)) {
    refuse(info, "has several layers; pass --layer with one of: " + list_layers(layers));
  }
  return *first;
}

void require_sampling(const EnvironmentInfo& info, const std::string& name, const Imf::Channel& channel, int wanted) {
  if (channel.xSampling != wanted || channel.ySampling != wanted) {
    refuse(info, "channel " + platform::printable(name) + " is sampled at every " + std::to_string(channel.xSampling) +
                     " x " + std::to_string(channel.ySampling) + " texels where " + std::to_string(wanted) + " x " +
                     std::to_string(wanted) + (wanted == 1 ? " is" : " (luminance-chroma) is") +
                     " read; save it as R, G and B at full resolution");
  }
}

void require_usable(const EnvironmentInfo& info, const ExrChannels& chosen, const Imf::ChannelList& channels) {
  for (std::size_t i = 0; i < chosen.names.size(); ++i) {
    const Imf::Channel* channel = chosen.names[i].empty() ? nullptr : channels.findChannel(chosen.names[i]);
    if (channel != nullptr) {
      const bool chroma = chosen.kind == Kind::luminance_chroma && i != 1;
      require_sampling(info, chosen.names[i], *channel, chroma ? 2 : 1);
    }
  }
}

/// Fills in `info.channels` and `info.layers` and chooses: the requested layer; else the channels without one; else the
/// only layer in colour; else the only layer. Needs `info.path`. Values of uint are used unscaled, as half and float
/// are.
/// Throws `Error` (unsupported_file) naming what there is and, if layers are to choose from, --layer.
ExrChannels choose_exr_channels(EnvironmentInfo& info, const Imf::ChannelList& channels, const std::string& layer) {
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    info.channels.push_back({platform::printable(channel.name()), type_of(channel.channel().type)});
  }
  const std::vector<Layer> layers = find_images(channels);
  for (const Layer& found : layers) {
    if (!found.name.empty()) {
      info.layers.push_back(platform::printable(found.name));
    }
  }
  const ExrChannels& chosen = (layer.empty() ? choose_layer(info, layers) : find_layer(info, layers, layer)).channels;
  require_usable(info, chosen, channels);
  return chosen;
}

}  // namespace

bool holds_image(const Imf::ChannelList& channels, const std::string& layer, bool in_colour) {
  const std::vector<Layer> layers = find_images(channels);
  return std::any_of(layers.begin(), layers.end(), [&](const Layer& found) {
    return (layer.empty() || found.name == layer || platform::printable(found.name) == layer) &&
           (!in_colour || found.channels.kind != Kind::luminance);
  });
}

ExrImage inspect_exr(platform::ByteFile& file, const ReadOptions& options) {
  return call_openexr(file.path(), [&] {
    const ExrParts parts = read_exr_parts(file);
    ExrImage image;
    image.info.path = file.path();
    image.info.format = FileFormat::openexr;
    image.input = input_of(file);
    name_parts(image.info, parts);
    const std::size_t index = choose_exr_part(parts, file.path(), options.part, options.layer);
    const ExrPart& part = parts.parts[index];
    image.part = static_cast<int>(index);
    image.tiled = part.tiled;
    name_compression(image, part.header);
    place_windows(image, part, options.layout);
    image.table_bytes = bytes_of_headers(parts) + check_exr_tables(parts, file);
    image.channels = choose_exr_channels(image.info, part.header.channels(), options.layer);
    decide_exr_layout(image, part.header, options.layout);
    choose_level(image, part, options.level);
    measure_units(image, part.header);
    image.prefiltered = has_roughness(part.header);
    image.to_rec709 = exr_colour_matrix(image.info, part.header, image.channels.kind, options.primaries);
    return image;
  });
}

}  // namespace welkin::files
