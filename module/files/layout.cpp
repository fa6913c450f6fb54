#include "files/layout.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "image/pixels.h"
#include "platform/file.h"
#include "platform/text.h"
#include "welkin/core.h"

namespace welkin::files {
namespace {

// Layouts that a shape determines, and their names in messages.
struct CubeShape {
  Layout layout;
  const char* ratio;
  const char* description;
};

constexpr std::array kCubeShapes{
    CubeShape{Layout::vertical_strip, "1:6", "vertical strip of six square faces"},
    CubeShape{Layout::horizontal_strip, "6:1", "horizontal strip of six square faces"},
    CubeShape{Layout::horizontal_cross, "4:3", "horizontal cross of six square faces"},
    CubeShape{Layout::vertical_cross, "3:4", "vertical cross of six square faces"},
};

constexpr const char* kAllLayouts =
    "lat-long (any ratio), vertical-strip (1:6), horizontal-strip (6:1), horizontal-cross (4:3), "
    "vertical-cross (3:4) or six-files (1:1 each)";

std::string shape(const EnvironmentInfo& info) {
  return std::to_string(info.width) + " x " + std::to_string(info.height);
}

void settle(EnvironmentInfo& info, Layout layout, const std::string& reason) {
  info.layout = layout;
  info.layout_reason = reason;
}

[[noreturn]] void refuse(const EnvironmentInfo& info, const std::string& found_and_remedy) {
  throw platform::file_error(ErrorCode::unsupported_file, info.path, found_and_remedy);
}

void settle_by_shape(EnvironmentInfo& info) {
  if (info.width == 2 * info.height) {
    settle(info, Layout::lat_long, shape(info) + " is 2:1");
    return;
  }
  for (const CubeShape& cube : kCubeShapes) {
    if (face_size(cube.layout, info.width, info.height) > 0) {
      settle(info, cube.layout, shape(info) + " is " + cube.ratio);
      return;
    }
  }
  if (info.width == info.height) {
    settle(info, Layout::six_files, shape(info) + " is square, and its name and five others are those of six faces");
    return;
  }
  refuse(info, shape(info) +
                   " is neither a 2:1 lat-long nor a 1:6 vertical strip, a 6:1 horizontal strip, a 4:3 or a 3:4 cross; "
                   "pass --layout to say what it is: " +
                   kAllLayouts);
}

void require_faces(const EnvironmentInfo& info) {
  for (const CubeShape& cube : kCubeShapes) {
    if (cube.layout == info.layout && face_size(info.layout, info.width, info.height) == 0) {
      refuse(info, shape(info) + " is not a " + cube.ratio + " " + cube.description + " (" + info.layout_reason +
                       "); pass --layout lat-long if it is one, or export the faces again");
    }
  }
}

void require_fitting_shape(const EnvironmentInfo& info) {
  if (info.layout == Layout::lat_long) {
    if (info.width > image::kLargestLatLongWidth || info.height > image::kLargestLatLongHeight) {
      refuse(info, shape(info) + " is larger than the largest lat-long, " +
                       std::to_string(image::kLargestLatLongWidth) + " x " +
                       std::to_string(image::kLargestLatLongHeight) + "; reduce it first");
    }
    return;
  }
  require_faces(info);
  const int size = face_size(info.layout, info.width, info.height);
  if (size > image::kLargestFace) {
    refuse(info, "its faces are " + std::to_string(size) + " texels wide; reduce them to " +
                     std::to_string(image::kLargestFace) + " or fewer");
  }
}

}  // namespace

void refuse_square(const EnvironmentInfo& info, const std::string& reason) {
  refuse(info, shape(info) + " is square, so it would be a face among six files, but " + reason +
                   ". If it is something else, pass --layout to say what: " + kAllLayouts);
}

void decide_layout(EnvironmentInfo& info, Layout asked_for, std::optional<Layout> stated_by_header) {
  if (asked_for != Layout::automatic) {
    settle(info, asked_for, std::string(name(asked_for)) + " was requested");
  } else if (stated_by_header) {
    const char* word = *stated_by_header == Layout::lat_long ? "latlong" : "cube";
    settle(info, *stated_by_header, std::string("the header's envmap attribute says ") + word);
  } else {
    settle_by_shape(info);
  }
  require_fitting_shape(info);
}

int face_size(Layout layout, int width, int height) noexcept {
  if (layout == Layout::automatic || layout == Layout::lat_long) return 0;
  const CubePlacement& placement = cube_placement(layout);
  const int size = width / placement.columns;
  return size * placement.columns == width && size * placement.rows == height ? size : 0;
}

namespace {

// {column, row} of +X -X +Y -Y +Z -Z.
constexpr CubePlacement kVerticalStrip{1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}};
constexpr CubePlacement kHorizontalStrip{6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}};
constexpr CubePlacement kHorizontalCross{4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}};
constexpr CubePlacement kVerticalCross{3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true, true}}}};
constexpr CubePlacement kOpenExrCube{1,
                                     6,
                                     {{{0, 0, true, false},
                                       {0, 1, true, false},
                                       {0, 2, false, true},
                                       {0, 3, false, true},
                                       {0, 4, true, false},
                                       {0, 5, true, false}}}};

}  // namespace

const CubePlacement& cube_placement(Layout layout) {
  switch (layout) {
    case Layout::vertical_strip:
    case Layout::six_files: return kVerticalStrip;
    case Layout::horizontal_strip: return kHorizontalStrip;
    case Layout::horizontal_cross: return kHorizontalCross;
    case Layout::vertical_cross: return kVerticalCross;
    case Layout::automatic:
    case Layout::lat_long: break;
  }
  throw Error(ErrorCode::invalid_argument,
              std::string("the layout ") + name(layout) + " has no faces; pass a strip, a cross or six files");
}

const CubePlacement& openexr_cube_placement() noexcept { return kOpenExrCube; }

RowSegments row_segments(const CubePlacement& placement, int size, int image_row) noexcept {
  RowSegments found;
  const int row_of_faces = image_row / size;
  const int row = image_row % size;
  for (int column = 0; column < placement.columns; ++column) {
    for (std::size_t face = 0; face < placement.faces.size(); ++face) {
      const FacePlacement& position = placement.faces[face];
      if (position.row != row_of_faces || position.column != column) continue;
      const int face_row = position.mirrored_rows ? size - 1 - row : row;
      found.segments[found.count++] = {static_cast<int>(face), face_row, column * size, position.mirrored_columns};
    }
  }
  return found;
}

void copy_segment(const float* from, float* to, int size, bool mirrored) noexcept {
  const auto floats = std::ptrdiff_t{3} * size;
  if (!mirrored) {
    std::copy_n(from, floats, to);
    return;
  }
  for (std::ptrdiff_t texel = 0; texel < floats; texel += 3) {
    std::copy_n(from + texel, 3, to + (floats - 3 - texel));
  }
}

void add_channels(EnvironmentInfo& info, std::string_view names, ChannelType type) {
  for (const char name : names) info.channels.push_back({std::string(1, name), type});
}

void require_level(const EnvironmentInfo& info, int levels, int level) {
  if (level >= 0 && level < levels) return;
  throw platform::file_error(
      ErrorCode::unsupported_file, info.path,
      "has no level " + std::to_string(level) + "; it has " +
          (levels == 1 ? "one, level 0: leave --level out"
                       : std::to_string(levels) + ": pass --level 0 to " + std::to_string(levels - 1)));
}

void require_element(const std::filesystem::path& path, int elements, int element) {
  if (element >= 0 && element < elements) return;
  throw platform::file_error(ErrorCode::unsupported_file, path,
                             "has no element " + std::to_string(element) +
                                 (elements == 1 ? ": it is not an array; leave --element out"
                                                : "; it has " + std::to_string(elements) + ": pass --element 0 to " +
                                                      std::to_string(elements - 1)));
}

void settle_cube(EnvironmentInfo& info, int size, int levels, const ReadOptions& options) {
  if (options.layout != Layout::automatic && options.layout != Layout::vertical_strip) {
    throw platform::file_error(ErrorCode::unsupported_file, info.path,
                               std::string("was requested as a ") + name(options.layout) + ", and " +
                                   name(info.format) +
                                   " holds six faces, read as a vertical strip; leave --layout out");
  }
  require_level(info, levels, options.level);
  for (int level = 0; level < levels; ++level) {
    const int edge = std::max(1, size >> level);
    info.levels.push_back({edge, 6 * edge});
  }
  info.layout = Layout::vertical_strip;
  info.layout_reason = std::string(name(info.format)) + " holds six faces";
  info.width = info.levels[static_cast<std::size_t>(options.level)].width;
  info.height = 6 * info.width;
}

}  // namespace welkin::files

namespace welkin {
namespace {

// Indexed by Layout.
constexpr std::array kLayouts{"automatic",        "lat-long",       "vertical-strip", "horizontal-strip",
                              "horizontal-cross", "vertical-cross", "six-files"};
constexpr std::array kFormats{"OpenEXR", "Radiance", "PFM", "PNG", "KTX2", "DDS", "Babylon.js .env", "KTX", "JPEG"};
constexpr std::array kChannelTypes{"unknown", "half",   "float",    "uint",     "rgbe",
                                   "xyze",    "rgbd",   "uint1",    "uint2",    "uint4",
                                   "uint8",   "uint16", "ufloat10", "ufloat11", "shared exponent"};

}  // namespace

const char* name(Layout layout) noexcept { return platform::name_in<Layout::six_files>(kLayouts, layout, "unknown"); }
const char* name(FileFormat format) noexcept {
  return platform::name_in<FileFormat::jpeg>(kFormats, format, "unknown");
}
const char* name(ChannelType type) noexcept {
  return platform::name_in<ChannelType::shared_exponent>(kChannelTypes, type, "unknown");
}

}  // namespace welkin
