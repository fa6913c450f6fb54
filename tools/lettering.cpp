#include "tools/lettering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace welkin::tool {
namespace {

constexpr double kFar = 100.0;
constexpr double kReach = 1.5;  // distance around a letter's cell that is evaluated

/// The points of the pen's path, two digits each (x from 0 to 4, y from 0 to 6); a space lifts it.
struct Glyph {
  char letter;
  const char* strokes;
};

constexpr std::array<Glyph, 39> kGlyphs{{{'+', "0343 2125"},
                                         {'-', "0343"},
                                         {'.', "1020"},
                                         {'0', "103041453616050110"},
                                         {'1', "142620 1030"},
                                         {'2', "05163645440040"},
                                         {'3', "0516364544334241301001 1333"},
                                         {'4', "30360242"},
                                         {'5', "460603334241301001"},
                                         {'6', "4536160501103041423303"},
                                         {'7', "064610"},
                                         {'8', "13040516364544331302011030414233"},
                                         {'9', "0110304145361605041343"},
                                         {'A', "002640 1232"},
                                         {'B', "0006364544330343 334241300000"},
                                         {'C', "4536160501103041"},
                                         {'D', "00062645412000"},
                                         {'E', "46060040 0333"},
                                         {'F', "460600 0333"},
                                         {'G', "453616050110304143 4323"},
                                         {'H', "0006 4046 0343"},
                                         {'I', "2026 1030 1636"},
                                         {'J', "4641301001"},
                                         {'K', "0006 4602 1440"},
                                         {'L', "060040"},
                                         {'M', "0006234640"},
                                         {'N', "00064046"},
                                         {'O', "103041453616050110"},
                                         {'P', "000636454433031303"},
                                         {'Q', "103041453616050110 2240"},
                                         {'R', "0006364544330323 2340"},
                                         {'S', "453616050413334241301001"},
                                         {'T', "0646 2620"},
                                         {'U', "060110304146"},
                                         {'V', "062046"},
                                         {'W', "0610243046"},
                                         {'X', "0046 0640"},
                                         {'Y', "0623 4623 2320"},
                                         {'Z', "06460040"}}};

const char* strokes_of(char letter) noexcept {
  const auto* const glyph =
      std::find_if(kGlyphs.begin(), kGlyphs.end(), [letter](const Glyph& each) { return each.letter == letter; });
  return glyph == kGlyphs.end() ? "" : glyph->strokes;
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

double label_half_width(std::string_view text) noexcept { return 3.0 * static_cast<double>(text.size()) - 1.0; }

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

}  // namespace welkin::tool
