#include "tools/test_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "tools/lettering.h"

namespace welkin {
namespace {

// The map.

/// A side of the cube around the viewer, seen from inside: `right` and `up` are those of its label.
struct Side {
  const char* axis;
  const char* word;
  glm::dvec3 right;
  glm::dvec3 up;
  glm::dvec3 colour;
  bool wall;
};

// A positive axis has its primary colour, a negative one the complement. For a view along `forward`, forward x up is on
// the right. For a viewer who faces +z, the ceiling reads when looking up, the floor when looking down.
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

/// Returns the distance of an angle in turns from the nearest multiple of `step`, in degrees.
double degrees_off(double turns, double step) {
  const double steps = turns / step;
  return std::abs(steps - std::floor(steps + 0.5)) * step * 360.0;
}

/// Draws a line every 15 degrees; the equator and the four meridians through the axes are wider. Meridians thin out
/// towards the poles, where they would merge.
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
  double shade;  ///< width of its dark rim
};

constexpr Label kAxisLabel{0.72, 0.02, 0.62, 0.42};
constexpr Label kWordLabel{0.25, -0.62, 0.60, 0.50};

/// Blends ink and rim of one label over the colour below; (x, y) on the side, both from -1 to 1.
glm::dvec3 written(const glm::dvec3& below, const char* text, const Label& label, double x, double y) {
  const double scale = 6.0 / label.size;
  const double distance = tool::distance_to_label(text, x * scale, (y - label.y) * scale);
  if (distance < label.pen) return kInk;
  return distance < label.pen + label.shade ? mixed(below, kShadow, 0.85) : below;
}

/// Draws an arrow that points up, above the axis's name.
glm::dvec3 with_arrow(const glm::dvec3& below, double x, double y) {
  constexpr double kTip = 0.90;
  constexpr double kFoot = 0.56;
  constexpr double kPen = 0.035;
  constexpr double kRim = 0.03;
  const double distance = std::min({tool::distance_to_line(x, y, 0.0, kFoot, 0.0, kTip),
                                    tool::distance_to_line(x, y, -0.13, kTip - 0.15, 0.0, kTip),
                                    tool::distance_to_line(x, y, 0.13, kTip - 0.15, 0.0, kTip)});
  if (distance < kPen) return kInk;
  return distance < kPen + kRim ? mixed(below, kShadow, 0.85) : below;
}

/// For each side, the side whose axis names it.
using Names = std::array<std::size_t, 6>;

Names names_of(const TestMapAxes& axes) {
  Names names{};
  for (int face = 0; face < 6; ++face) {
    names[static_cast<std::size_t>(face)] =
        static_cast<std::size_t>(image::face_of(axes.names * image::face_frame(face).normal));
  }
  return names;
}

/// The map as a function, of which texels are means.
glm::dvec3 colour_towards(const glm::dvec3& unit, const Names& names) {
  const int face = image::face_of(unit);
  const Side& side = kSides[static_cast<std::size_t>(face)];
  const Side& named = kSides[names[static_cast<std::size_t>(face)]];
  const double depth = glm::dot(unit, image::face_frame(face).normal);
  const double x = glm::dot(unit, side.right) / depth;
  const double y = glm::dot(unit, side.up) / depth;

  // A faint checkerboard shows sharpness and stretching.
  const bool odd = ((static_cast<int>(std::floor(x * 4.0)) + static_cast<int>(std::floor(y * 4.0))) & 1) != 0;
  glm::dvec3 colour = named.colour * (odd ? 0.80 : 1.0);
  colour = mixed(colour, kInk, grid_share(unit) * 0.45);
  if (std::max(std::abs(x), std::abs(y)) > 0.965) colour = mixed(named.colour, kInk, 0.8);
  if (side.wall) colour = with_arrow(colour, x, y);
  colour = written(colour, named.axis, kAxisLabel, x, y);
  return written(colour, side.word, kWordLabel, x, y);
}

/// Returns the samples along a texel's edge: about a thousand per 90 degrees, and at least two per texel.
int samples_along_edge(int texels_per_90_degrees) {
  return std::clamp(1024 / std::max(1, texels_per_90_degrees), 2, 8);
}

/// `unit_at(column, row)`: the direction of a position in texels.
template <typename UnitAt>
void draw(int columns, int rows, int samples, float* rgb, const Control& control, const Names& names,
          const UnitAt& unit_at) {
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
                        sum += colour_towards(unit_at(column + across, static_cast<double>(row) + down), names);
                      }
                      sum /= static_cast<double>(samples * samples);
                      for (int channel = 0; channel < 3; ++channel) texel[channel] = static_cast<float>(sum[channel]);
                    }
                  });
}

}  // namespace

LatLongImage test_map_lat_long(int width, int height, const Control& control, const TestMapAxes& axes) {
  image::check_lat_long_size(width, height);
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  LatLongImage map{width, height, std::vector<float>(3 * texels)};
  draw(width, height, samples_along_edge(std::min(width / 4, height / 2)), map.pixels.data(), control, names_of(axes),
       [&](double column, double row) { return image::lat_long_direction(width, height, column, row); });
  return map;
}

Cubemap test_map_cubemap(int size, const Control& control, const TestMapAxes& axes) {
  image::check_face_size(size);
  Cubemap map(size);
  const glm::dmat3 from_faces = glm::transpose(axes.places);
  draw(size, 6 * size, samples_along_edge(size), map.face(0), control, names_of(axes), [&](double column, double row) {
    const int face = std::min(5, static_cast<int>(row / size));
    return from_faces * image::face_direction(size, face, column, row - 1.0 * face * size);
  });
  return map;
}

}  // namespace welkin
