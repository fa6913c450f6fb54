#include "image/label_strokes.h"

#include <algorithm>
#include <cmath>

namespace welkin::image {
namespace {

constexpr double kFar = 100.0;
constexpr double kReach = 1.5;  // around a letter's cell, within which its distance is wanted

/// The points that the pen goes through, two digits each (x from 0 to 4, y from 0 to 6); a space lifts it.
const char* strokes_of(char letter) noexcept {
  switch (letter) {
    case '+': return "0343 2125";
    case '-': return "0343";
    case 'A': return "002640 1232";
    case 'B': return "0006364544330343 334241300000";
    case 'C': return "4536160501103041";
    case 'D': return "00062645412000";
    case 'E': return "46060040 0333";
    case 'F': return "460600 0333";
    case 'G': return "453616050110304143 4323";
    case 'H': return "0006 4046 0343";
    case 'I': return "2026 1030 1636";
    case 'K': return "0006 4602 1440";
    case 'L': return "060040";
    case 'N': return "00064046";
    case 'O': return "103041453616050110";
    case 'P': return "000636454433031303";
    case 'R': return "0006364544330323 2340";
    case 'T': return "0646 2620";
    case 'U': return "060110304146";
    case 'W': return "0610243046";
    case 'X': return "0046 0640";
    case 'Y': return "0623 4623 2320";
    case 'Z': return "06460040";
    default: return "";
  }
}

double distance_to_letter(char letter, double x, double y) noexcept {
  double nearest = kFar;
  const char* pen = strokes_of(letter);
  while (pen[0] != '\0') {
    const bool draws = pen[2] != '\0' && pen[2] != ' ';
    if (draws) {
      nearest = std::min(nearest, distance_to_line(x, y, pen[0] - '0', pen[1] - '0', pen[2] - '0', pen[3] - '0'));
    }
    pen += pen[2] == ' ' ? 3 : 2;
  }
  return nearest;
}

}  // namespace

double distance_to_line(double x, double y, double x0, double y0, double x1, double y1) noexcept {
  const double along_x = x1 - x0;
  const double along_y = y1 - y0;
  const double squared = along_x * along_x + along_y * along_y;
  const double share = std::clamp(((x - x0) * along_x + (y - y0) * along_y) / squared, 0.0, 1.0);
  const double off_x = x - x0 - share * along_x;
  const double off_y = y - y0 - share * along_y;
  return std::sqrt(off_x * off_x + off_y * off_y);
}

double distance_to_label(std::string_view text, double x, double y) noexcept {
  if (std::abs(y) > 3.0 + kReach || std::abs(x) > label_half_width(text) + kReach) return kFar;
  double nearest = kFar;
  double left = -label_half_width(text);
  for (const char letter : text) {
    if (x > left - kReach && x < left + 4.0 + kReach) {
      nearest = std::min(nearest, distance_to_letter(letter, x - left, y + 3.0));
    }
    left += 6.0;
  }
  return nearest;
}

}  // namespace welkin::image
