#include "codec/exr_windows.h"

#include <ImfStandardAttributes.h>

#include <algorithm>
#include <optional>
#include <string>

#include "codec/byte_file.h"
#include "codec/row_source.h"

namespace welkin::codec {
namespace {

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
  if (size.width == 2 * size.height) {
    return Layout::lat_long;
  }
  if (size.height == 6 * size.width) {
    return Layout::vertical_strip;
  }
  if (size.width == 6 * size.height) {
    return Layout::horizontal_strip;
  }
  if (3 * size.width == 4 * size.height) {
    return Layout::horizontal_cross;
  }
  if (4 * size.width == 3 * size.height) {
    return Layout::vertical_cross;
  }
  return std::nullopt;
}

bool display_window_is_picture(const Imath::Box2i& data, const Imath::Box2i& display, Layout asked_for) {
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
    throw file_error(ErrorCode::unsupported_file, info.path,
                     std::string("its ") + window + " window of " + text(size) + " is larger than any layout holds (" +
                         text({kMaximumWidth, kMaximumHeight}) + "); reduce it first");
  }
}

void require_substance(const EnvironmentInfo& info, const Extent& display, const Extent& stored) {
  constexpr std::int64_t kLargestMostlyBlack = std::int64_t{16384} * 8192;
  constexpr std::int64_t kLeastShare = 64;
  if (display.texels() > kLargestMostlyBlack && display.texels() / kLeastShare > stored.texels()) {
    throw file_error(ErrorCode::unsupported_file, info.path,
                     "stores " + text(stored) + " texels of a display window of " + text(display) + ", less than a " +
                         std::to_string(kLeastShare) + "th; save it with the display window that is meant");
  }
}

void note_windows(EnvironmentInfo& info, const Extent& data, const Extent& display, const Extent& stored) {
  if (stored.texels() < data.texels()) {
    info.notes.push_back("overscan cut off: the data window of " + text(data) + " reaches over the display window of " +
                         text(display));
  }
  if (stored.texels() < display.texels()) {
    info.notes.push_back("black where nothing is stored: the data window of " + text(data) +
                         " does not fill the display window of " + text(display));
  }
}

}  // namespace

ExrWindows choose_exr_windows(EnvironmentInfo& info, const Imf::Header& header, bool has_levels, Layout asked_for) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  const Extent data_size = extent(data);
  const Extent display_size = extent(display);
  if (data_size.is_empty()) {
    throw file_error(ErrorCode::corrupt_file, info.path,
                     "its OpenEXR header is damaged: the data window is empty; fetch or export it again");
  }
  require_bounded(info, "data", data_size);
  const bool same_size = data_size.width == display_size.width && data_size.height == display_size.height;
  if (same_size || Imf::hasEnvmap(header) || has_levels) {
    return {data, data};
  }
  if (!display_window_is_picture(data, display, asked_for)) {
    info.notes.push_back("the data window of " + text(data_size) +
                         " is the picture; the display window is not of its size and left out");
    return {data, data};
  }
  const Extent stored = overlap(data, display);
  require_bounded(info, "display", display_size);
  require_substance(info, display_size, stored);
  note_windows(info, data_size, display_size, stored);
  return {display, data};
}

}  // namespace welkin::codec
