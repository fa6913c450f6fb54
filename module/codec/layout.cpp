#include "codec/layout.h"

#include "codec/byte_file.h"

namespace welkin::codec {
namespace {

constexpr int kLargestLatLongWidth = 65536;
constexpr int kLargestLatLongHeight = 32768;
constexpr int kLargestFace = 16384;

std::string shape(const EnvironmentInfo& info) {
  return std::to_string(info.width) + " x " + std::to_string(info.height);
}

bool is_two_to_one(const EnvironmentInfo& info) { return info.width == 2 * info.height; }

bool is_one_to_six(const EnvironmentInfo& info) { return info.height == 6 * info.width; }

void settle(EnvironmentInfo& info, Layout layout, const std::string& reason) {
  info.layout = layout;
  info.layout_reason = reason;
}

void settle_by_shape(EnvironmentInfo& info) {
  if (is_two_to_one(info)) {
    settle(info, Layout::lat_long, shape(info) + " is 2:1");
  } else if (is_one_to_six(info)) {
    settle(info, Layout::vertical_strip, shape(info) + " is 1:6");
  } else {
    throw file_error(ErrorCode::unsupported_file, info.path,
                     shape(info) +
                         " is neither a 2:1 lat-long nor a 1:6 vertical strip; pass --layout to say "
                         "otherwise");
  }
}

void require_fitting_shape(const EnvironmentInfo& info) {
  if (info.layout == Layout::vertical_strip) {
    if (!is_one_to_six(info)) {
      throw file_error(ErrorCode::unsupported_file, info.path,
                       shape(info) + " is not a 1:6 vertical strip of six square faces (" + info.layout_reason +
                           "); pass --layout lat-long if it is one, or export the faces from top to bottom");
    }
    if (info.width > kLargestFace) {
      throw file_error(ErrorCode::unsupported_file, info.path,
                       "its faces are " + std::to_string(info.width) + " texels wide; reduce them to " +
                           std::to_string(kLargestFace) + " or fewer");
    }
  } else if (info.width > kLargestLatLongWidth || info.height > kLargestLatLongHeight) {
    throw file_error(ErrorCode::unsupported_file, info.path,
                     shape(info) + " is larger than the largest lat-long, " + std::to_string(kLargestLatLongWidth) +
                         " x " + std::to_string(kLargestLatLongHeight) + "; reduce it first");
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

}  // namespace welkin::codec

namespace welkin {

const char* name(Layout layout) noexcept {
  switch (layout) {
    case Layout::automatic: return "automatic";
    case Layout::lat_long: return "lat-long";
    case Layout::vertical_strip: return "vertical-strip";
  }
  return "unknown";
}

}  // namespace welkin
