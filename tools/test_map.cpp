#include "tools/test_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"

namespace welkin {
namespace {

// Letters as strokes of a pen, drawn by their distance.

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

/// Distance from (x, y) to the line from (x0, y0) to (x1, y1).
double distance_to_line(double x, double y, double x0, double y0, double x1, double y1) noexcept {
  const double along_x = x1 - x0;
  const double along_y = y1 - y0;
  const double squared = along_x * along_x + along_y * along_y;
  const double share = std::clamp(((x - x0) * along_x + (y - y0) * along_y) / squared, 0.0, 1.0);
  const double off_x = x - x0 - share * along_x;
  const double off_y = y - y0 - share * along_y;
  return std::sqrt(off_x * off_x + off_y * off_y);
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

/// How far a label reaches from its middle along the text.
constexpr double label_half_width(std::string_view text) noexcept {
  return 3.0 * static_cast<double>(text.size()) - 1.0;
}

/// Letters are 4 wide and 6 high with a gap of 2 between them; the label's middle is at (0, 0), x runs along the text
/// and y up. The distance from (x, y) to the nearest pen line; 100 where it is farther than a letter's cell.
/// Known: + - and the capitals that name the axes and directions; others are blank.
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

// The map.

/// A side of the cube around the viewer, seen from inside: `right` and `up` are those of its writing.
struct Side {
  const char* axis;
  const char* word;
  glm::dvec3 right;
  glm::dvec3 up;
  glm::dvec3 colour;
  bool wall;
};

// A positive axis has its primary colour, a negative one the complement. Who looks along `forward` has forward x up on
// the right. The ceiling reads for one who faces +z and looks up, the floor for one who faces +z and looks down.
const std::array<Side, 6> kSides{{
    {"+X", "LEFT", {0, 0, 1}, {0, 1, 0}, {0.60, 0.07, 0.05}, true},
    {"-X", "RIGHT", {0, 0, -1}, {0, 1, 0}, {0.03, 0.38, 0.42}, true},
    {"+Y", "UP", {-1, 0, 0}, {0, 0, -1}, {0.08, 0.36, 0.07}, false},
    {"-Y", "DOWN", {-1, 0, 0}, {0, 0, 1}, {0.40, 0.06, 0.34}, false},
    {"+Z", "FRONT", {-1, 0, 0}, {0, 1, 0}, {0.05, 0.13, 0.58}, true},
    {"-Z", "BACK", {1, 0, 0}, {0, 1, 0}, {0.62, 0.38, 0.03}, true},
}};

const glm::dvec3 kInk(1.0, 1.0, 1.0);
const glm::dvec3 kShadow(0.012, 0.012, 0.016);

glm::dvec3 mixed(const glm::dvec3& below, const glm::dvec3& above, double share) {
  return below + (above - below) * share;
}

/// How far an angle in turns is from the nearest multiple of `step`, in degrees.
double degrees_off(double turns, double step) {
  const double steps = turns / step;
  return std::abs(steps - std::floor(steps + 0.5)) * step * 360.0;
}

/// Every 15 degrees a line; the equator and the four meridians through the axes are wider. Meridians thin out
/// towards the poles, where they would run into one another.
double grid_share(const glm::dvec3& unit) {
  const double horizontal = std::sqrt(unit.x * unit.x + unit.z * unit.z);
  const double latitude = math::turns_of(unit.y, horizontal);
  const double longitude = math::turns_of(unit.x, unit.z);
  constexpr double kThin = 0.28;
  constexpr double kWide = 0.5;
  constexpr double kFine = 1.0 / 24.0;
  double share = 0.0;
  const double parallel = degrees_off(latitude, kFine);
  if (parallel < kThin) share = 0.35;
  const double meridian = degrees_off(longitude, kFine) * horizontal;
  if (meridian < kThin && std::abs(latitude) < 10.5 * kFine / 2.0) share = 0.35;
  const double quarter = degrees_off(longitude, 0.25) * horizontal;
  if (std::abs(latitude) * 360.0 < kWide || quarter < kWide) share = 0.7;
  return share;
}

struct Label {
  double size;   ///< of a letter, in units of half a side
  double y;      ///< of its middle
  double pen;    ///< half the pen's width, in letter units of 1/6 of its height
  double shade;  ///< how far its dark rim reaches beyond
};

constexpr Label kAxisLabel{0.72, 0.02, 0.62, 0.42};
constexpr Label kWordLabel{0.25, -0.62, 0.60, 0.50};

/// Ink and rim of one label over what is below it; (x, y) on the side, both from -1 to 1.
glm::dvec3 written(const glm::dvec3& below, const char* text, const Label& label, double x, double y) {
  const double scale = 6.0 / label.size;
  const double distance = distance_to_label(text, x * scale, (y - label.y) * scale);
  if (distance < label.pen) return kInk;
  return distance < label.pen + label.shade ? mixed(below, kShadow, 0.85) : below;
}

/// An arrow that points up, over the axis's name.
glm::dvec3 with_arrow(const glm::dvec3& below, double x, double y) {
  constexpr double kTip = 0.90;
  constexpr double kFoot = 0.56;
  constexpr double kPen = 0.035;
  constexpr double kRim = 0.03;
  const double distance =
      std::min({distance_to_line(x, y, 0.0, kFoot, 0.0, kTip), distance_to_line(x, y, -0.13, kTip - 0.15, 0.0, kTip),
                distance_to_line(x, y, 0.13, kTip - 0.15, 0.0, kTip)});
  if (distance < kPen) return kInk;
  return distance < kPen + kRim ? mixed(below, kShadow, 0.85) : below;
}

/// The map is this function; texels are its means.
glm::dvec3 colour_towards(const glm::dvec3& unit) {
  const int face = image::face_of(unit);
  const Side& side = kSides[static_cast<std::size_t>(face)];
  const double depth = glm::dot(unit, image::face_frame(face).normal);
  const double x = glm::dot(unit, side.right) / depth;
  const double y = glm::dot(unit, side.up) / depth;

  // A checkerboard, hardly seen, to judge sharpness and stretching by.
  const bool odd = ((static_cast<int>(std::floor(x * 4.0)) + static_cast<int>(std::floor(y * 4.0))) & 1) != 0;
  glm::dvec3 colour = side.colour * (odd ? 0.80 : 1.0);
  colour = mixed(colour, kInk, grid_share(unit) * 0.45);
  if (std::max(std::abs(x), std::abs(y)) > 0.965) colour = mixed(side.colour, kInk, 0.8);
  if (side.wall) colour = with_arrow(colour, x, y);
  colour = written(colour, side.axis, kAxisLabel, x, y);
  return written(colour, side.word, kWordLabel, x, y);
}

/// Samples along a texel's edge, so that a quarter turn has a thousand or so, and no texel fewer than two.
int samples_along_edge(int texels_a_quarter_turn) {
  return std::clamp(1024 / std::max(1, texels_a_quarter_turn), 2, 8);
}

/// `unit_at(column, row)`: the direction of a place that is counted in texels.
template <typename UnitAt>
void draw(int columns, int rows, int samples, float* rgb, const Control& control, const UnitAt& unit_at) {
  const jobs::Placement where = jobs::placement_for(std::int64_t{16} * columns * rows);
  jobs::run_tiles(static_cast<std::size_t>(rows), where, jobs::worker_count(where), control,
                  [&](std::size_t row, std::size_t) {
                    float* texel = rgb + row * static_cast<std::size_t>(columns) * 3;
                    for (int column = 0; column < columns; ++column, texel += 3) {
                      glm::dvec3 sum(0.0);
                      for (int sample = 0; sample < samples * samples; ++sample) {
                        const double across = (sample % samples + 0.5) / samples;
                        const int sub_row = sample / samples;
                        const double down = (sub_row + 0.5) / samples;
                        sum += colour_towards(unit_at(column + across, static_cast<double>(row) + down));
                      }
                      sum /= static_cast<double>(samples * samples);
                      for (int channel = 0; channel < 3; ++channel) texel[channel] = static_cast<float>(sum[channel]);
                    }
                  });
}

}  // namespace

LatLongImage test_map_lat_long(int width, int height, const Control& control) {
  image::check_lat_long_size(width, height);
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  LatLongImage map{width, height, std::vector<float>(3 * texels)};
  draw(width, height, samples_along_edge(std::min(width / 4, height / 2)), map.pixels.data(), control,
       [&](double column, double row) { return image::lat_long_direction(width, height, column, row); });
  return map;
}

CubemapImage test_map_cubemap(int size, const Control& control) {
  image::check_face_size(size);
  const std::size_t texels = std::size_t{6} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  CubemapImage map{size, std::vector<float>(3 * texels)};
  draw(size, 6 * size, samples_along_edge(size), map.pixels.data(), control, [&](double column, double row) {
    const int face = std::min(5, static_cast<int>(row / size));
    return image::face_direction(size, face, column, row - 1.0 * face * size);
  });
  return map;
}

}  // namespace welkin
