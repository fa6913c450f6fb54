// Labels in images: capitals, digits and + - . as strokes of a pen, drawn by their distance, at any size.
#pragma once

#include <string_view>

namespace welkin::tool {

/// Returns the distance from (x, y) to the line from (x0, y0) to (x1, y1).
[[nodiscard]] double distance_to_line(double x, double y, double x0, double y0, double x1, double y1) noexcept;

/// Returns half the length of a label along the text, in the units of `distance_to_label`.
[[nodiscard]] double label_half_width(std::string_view text) noexcept;

/// Returns the distance from (x, y) to the nearest pen line; 100 beyond a letter's cell. Letters are 4 wide and 6 high
/// with a gap of 2 between them; the label's middle is at (0, 0), x runs along the text and y up. Characters other than
/// capitals, digits and + - . are blank.
[[nodiscard]] double distance_to_label(std::string_view text, double x, double y) noexcept;

}  // namespace welkin::tool
