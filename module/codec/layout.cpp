#include "codec/layout.h"

#include <array>

#include "codec/byte_file.h"
#include "codec/face_placement.h"
#include "sh/check_arguments.h"

namespace welkin::codec {
namespace {

// Layouts that a shape tells, and how each is called in messages.
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
  throw file_error(ErrorCode::unsupported_file, info.path, found_and_remedy);
}

// A square is one of six files, if anything. Why it is not is in the message: a missing face above all.
void settle_by_name(EnvironmentInfo& info) {
  try {
    static_cast<void>(face_files(info.path));
  } catch (const Error& failure) {
    refuse(info, shape(info) + " is square, so it would be a face among six files, but " + failure.what() +
                     ". If it is something else, pass --layout to say what: " + kAllLayouts);
  }
  settle(info, Layout::six_files, shape(info) + " is square, and its name and five others are those of six faces");
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
    settle_by_name(info);
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
                       "); pass --layout lat-long if it is one, or export the faces anew");
    }
  }
}

void require_fitting_shape(const EnvironmentInfo& info) {
  if (info.layout == Layout::lat_long) {
    if (info.width > sh::kLargestLatLongWidth || info.height > sh::kLargestLatLongHeight) {
      refuse(info, shape(info) + " is larger than the largest lat-long, " + std::to_string(sh::kLargestLatLongWidth) +
                       " x " + std::to_string(sh::kLargestLatLongHeight) + "; reduce it first");
    }
    return;
  }
  require_faces(info);
  const int size = face_size(info.layout, info.width, info.height);
  if (size > sh::kLargestFace) {
    refuse(info, "its faces are " + std::to_string(size) + " texels wide; reduce them to " +
                     std::to_string(sh::kLargestFace) + " or fewer");
  }
}

}  // namespace

void decide_layout(EnvironmentInfo& info, Layout asked_for, std::optional<Layout> stated_by_header) {
  if (asked_for != Layout::automatic) {
    settle(info, asked_for, std::string(name(asked_for)) + " was asked for");
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

}  // namespace welkin::codec

namespace welkin {

const char* name(Layout layout) noexcept {
  switch (layout) {
    case Layout::automatic: return "automatic";
    case Layout::lat_long: return "lat-long";
    case Layout::vertical_strip: return "vertical-strip";
    case Layout::horizontal_strip: return "horizontal-strip";
    case Layout::horizontal_cross: return "horizontal-cross";
    case Layout::vertical_cross: return "vertical-cross";
    case Layout::six_files: return "six-files";
  }
  return "unknown";
}

}  // namespace welkin
