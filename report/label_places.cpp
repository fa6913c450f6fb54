#include "report/label_places.h"

#include <algorithm>

namespace welkin::report {
namespace {

constexpr double kLetter = 0.56;  // a letter's width in its size, on the safe side
constexpr double kGap = 9.0;      // from the point's centre

bool touch(const Box& a, const Box& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

}  // namespace

std::optional<LabelPlace> LabelPlaces::place(double x, double y, const std::string& text, double size) {
  const double width = kLetter * size * static_cast<double>(text.size());
  const double half = 0.35 * size;  // from the baseline to the middle of small letters
  const LabelPlace tries[] = {{x + kGap, y + half, "start"},
                              {x + 0.7 * kGap, y - kGap, "start"},
                              {x + 0.7 * kGap, y + kGap + 2.0 * half, "start"},
                              {x - kGap, y + half, "end"},
                              {x - 0.7 * kGap, y - kGap, "end"},
                              {x - 0.7 * kGap, y + kGap + 2.0 * half, "end"}};
  for (const LabelPlace& place : tries) {
    const double left = place.anchor[0] == 's' ? place.x : place.x - width;
    const Box box{left, place.y - 0.8 * size, left + width, place.y + 0.25 * size};
    const bool inside =
        box.left >= area_.left && box.right <= area_.right && box.top >= area_.top && box.bottom <= area_.bottom;
    if (!inside || std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return touch(box, other); }))
      continue;
    taken_.push_back(box);
    return place;
  }
  return std::nullopt;
}

}  // namespace welkin::report
