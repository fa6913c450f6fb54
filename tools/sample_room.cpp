#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "tools/test_map.h"

namespace welkin {
namespace {

using glm::dvec3;

constexpr double kPi = 3.14159265358979323846;

// The scene: metres, y up, the viewer at kEye. All objects are boxes along the axes; colours are linear.

enum class Pattern { plain, planks, rug, books, painting };

struct Box {
  dvec3 low;
  dvec3 high;
  dvec3 albedo;
  dvec3 glow{0.0};  ///< emitted radiance
  Pattern pattern = Pattern::plain;
};

bool shines(const Box& box) { return box.glow.x > 0.0; }

const dvec3 kEye(0.0, 1.5, 0.0);
// Light is stored for points inside these bounds: the room, and the recess of its window.
const dvec3 kRoomLow(-3.0, 0.0, -2.6);
const dvec3 kRoomHigh(3.25, 2.8, 3.5);
// The window: y and z of its opening, and the middle of the wall that it is in.
constexpr double kSill = 0.6, kLintel = 2.4, kSouth = -0.6, kNorth = 2.4, kGlass = 3.12;

const dvec3 kPlaster(0.74, 0.72, 0.68);
const dvec3 kTeal(0.10, 0.21, 0.22);
const dvec3 kWood(0.29, 0.19, 0.115);
const dvec3 kDark(0.05, 0.045, 0.04);
const dvec3 kTerracotta(0.52, 0.19, 0.09);
const dvec3 kLinen(0.66, 0.60, 0.50);
const dvec3 kLeaf(0.07, 0.20, 0.05);
const dvec3 kBulb(85.0, 64.0, 40.0);

std::vector<Box> scene() {
  std::vector<Box> boxes{
      // The shell; its +x wall surrounds the window.
      {{-3.2, -0.2, -2.8}, {3.25, 0.0, 3.7}, kWood, {}, Pattern::planks},
      {{-3.2, 2.8, -2.8}, {3.25, 3.0, 3.7}, {0.84, 0.83, 0.81}},
      {{-3.2, 0.0, 3.5}, {3.25, 2.8, 3.7}, kTeal},
      {{-3.2, 0.0, -2.8}, {3.25, 2.8, -2.6}, kPlaster},
      {{-3.2, 0.0, -2.6}, {-3.0, 2.8, 3.5}, kPlaster},
      {{3.0, 0.0, -2.6}, {3.25, kSill, 3.5}, kPlaster},
      {{3.0, kLintel, -2.6}, {3.25, 2.8, 3.5}, kPlaster},
      {{3.0, kSill, -2.6}, {3.25, kLintel, kSouth}, kPlaster},
      {{3.0, kSill, kNorth}, {3.25, kLintel, 3.5}, kPlaster},
      // The window's bars, its curtains and their rod.
      {{3.17, kSill, 0.37}, {3.22, kLintel, 0.43}, kLinen},
      {{3.17, kSill, 1.37}, {3.22, kLintel, 1.43}, kLinen},
      {{3.17, 1.83, kSouth}, {3.22, 1.88, kNorth}, kLinen},
      {{2.86, 2.52, -1.2}, {2.90, 2.56, 3.0}, kDark},
      // Sofa: seat, back, arms, three cushions.
      {{-1.25, 0.10, 2.45}, {1.25, 0.45, 3.35}, kTerracotta},
      {{-1.25, 0.45, 3.15}, {1.25, 0.90, 3.40}, kTerracotta},
      {{-1.50, 0.10, 2.45}, {-1.25, 0.65, 3.40}, kTerracotta},
      {{1.25, 0.10, 2.45}, {1.50, 0.65, 3.40}, kTerracotta},
      {{-1.15, 0.45, 2.95}, {-0.70, 0.82, 3.15}, {0.60, 0.44, 0.12}},
      {{0.72, 0.45, 2.97}, {1.15, 0.80, 3.15}, kTeal},
      {{0.40, 0.45, 2.92}, {0.74, 0.72, 3.06}, kLinen},
      // Rug; low table with books and a vase.
      {{-1.7, 0.0, 0.75}, {1.7, 0.015, 2.65}, {0.40, 0.36, 0.30}, {}, Pattern::rug},
      {{-0.65, 0.36, 1.25}, {0.65, 0.41, 1.85}, kWood},
      {{-0.60, 0.0, 1.30}, {-0.54, 0.36, 1.36}, kDark},
      {{0.54, 0.0, 1.30}, {0.60, 0.36, 1.36}, kDark},
      {{-0.60, 0.0, 1.74}, {-0.54, 0.36, 1.80}, kDark},
      {{0.54, 0.0, 1.74}, {0.60, 0.36, 1.80}, kDark},
      {{0.15, 0.41, 1.40}, {0.47, 0.45, 1.62}, {0.08, 0.13, 0.34}},
      {{0.18, 0.45, 1.42}, {0.44, 0.48, 1.60}, {0.62, 0.55, 0.42}},
      {{-0.34, 0.41, 1.50}, {-0.22, 0.64, 1.62}, {0.55, 0.56, 0.55}},
      // Floor lamp.
      {{-2.20, 0.0, 2.85}, {-1.90, 0.03, 3.15}, kDark},
      {{-2.065, 0.03, 2.985}, {-2.035, 1.45, 3.015}, kDark},
      {{-2.25, 1.45, 2.80}, {-1.85, 1.78, 3.20}, kLinen, {8.0, 5.6, 3.2}},
      // Bookcase against the -x wall; its front has the books.
      {{-3.0, 0.0, -0.4}, {-2.70, 2.15, 2.0}, {0.36, 0.27, 0.19}, {}, Pattern::books},
      // Table with two benches under three bulbs.
      {{-1.1, 0.70, -1.95}, {1.1, 0.75, -1.15}, kWood},
      {{-1.0, 0.0, -1.85}, {-0.92, 0.70, -1.25}, kDark},
      {{0.92, 0.0, -1.85}, {1.0, 0.70, -1.25}, kDark},
      {{-0.95, 0.38, -2.45}, {0.95, 0.43, -2.15}, kTeal},
      {{-0.95, 0.38, -0.98}, {0.95, 0.43, -0.70}, kTeal},
      {{-0.16, 0.75, -1.66}, {0.16, 0.84, -1.42}, {0.60, 0.44, 0.12}},
      // Paintings, with their frames.
      {{-0.90, 1.30, 3.46}, {0.90, 2.30, 3.50}, kDark},
      {{-0.85, 1.35, 3.45}, {0.85, 2.25, 3.46}, {0.40, 0.28, 0.20}, {}, Pattern::painting},
      {{-1.70, 1.20, -2.60}, {-0.70, 1.90, -2.57}, {0.55, 0.40, 0.12}},
      {{0.60, 1.20, -2.60}, {1.60, 1.90, -2.57}, {0.10, 0.19, 0.30}},
      // Pot of a plant.
      {{2.25, 0.0, 2.80}, {2.60, 0.40, 3.15}, {0.62, 0.60, 0.56}},
  };
  for (const double x : {-0.65, 0.0, 0.65}) {
    boxes.push_back({{x - 0.006, 1.94, -1.556}, {x + 0.006, 2.8, -1.544}, kDark});
    boxes.push_back({{x - 0.05, 1.80, -1.60}, {x + 0.05, 1.90, -1.50}, dvec3(0.5), kBulb});
  }
  for (int pleat = 0; pleat < 5; ++pleat) {  // of each curtain
    const double depth = pleat % 2 == 0 ? 0.0 : 0.05;
    for (const double z : {kSouth - 0.45 + 0.09 * pleat, kNorth + 0.09 * pleat}) {
      boxes.push_back({{2.84 - depth, 0.05, z}, {2.92 - depth, 2.54, z + 0.09}, kLinen});
    }
  }
  for (int leaf = 0; leaf < 14; ++leaf) {  // upwards in a spiral, wider in the middle
    const math::SineCosine turn = math::sine_cosine_of_turns(0.382 * leaf);
    const double reach = 0.10 + 0.02 * std::min(leaf, 14 - leaf);
    const dvec3 middle(2.42 + reach * turn.sine, 0.48 + 0.07 * leaf, 2.97 + reach * turn.cosine);
    const dvec3 half(0.06 + 0.05 * std::abs(turn.sine), 0.035, 0.06 + 0.05 * std::abs(turn.cosine));
    boxes.push_back({middle - half, middle + half, kLeaf * (0.8 + 0.05 * (leaf % 8))});
  }
  return boxes;
}

/// Returns a hash of the number that is uniform in [0, 1).
double scattered(std::uint32_t number) {
  number = (number ^ (number >> 16U)) * 0x7feb352dU;
  number = (number ^ (number >> 15U)) * 0x846ca68bU;
  return (number ^ (number >> 16U)) / 4294967296.0;
}

double cell_noise(double a, double b) {
  const auto whole = [](double x) { return static_cast<std::uint32_t>(static_cast<int>(std::floor(x)) + 4096); };
  return scattered(whole(a) * 8191U + whole(b));
}

/// Returns the colour of a point on a box, whose mean over the box is about its albedo.
dvec3 albedo_at(const Box& box, const dvec3& point) {
  switch (box.pattern) {
    case Pattern::plain: break;
    case Pattern::planks: {
      const double across = point.x / 0.16;
      const double along = point.z / 1.3 + scattered(static_cast<std::uint32_t>(std::floor(across) + 64.0));
      const bool gap = across - std::floor(across) < 0.04 || along - std::floor(along) < 0.006;
      return box.albedo * (gap ? 0.35 : 0.75 + 0.5 * cell_noise(across, along));
    }
    case Pattern::rug: {
      const dvec3 off = glm::abs(point - 0.5 * (box.low + box.high));
      const double edge = std::min(0.5 * (box.high.x - box.low.x) - off.x, 0.5 * (box.high.z - box.low.z) - off.z);
      if (edge < 0.08 || (edge > 0.16 && edge < 0.20)) return kTeal;
      const double diamond = off.x / 0.5 + off.z / 0.36;
      return diamond - std::floor(diamond) < 0.25 ? kTerracotta : box.albedo * 1.15;
    }
    case Pattern::books: {
      const double shelf = point.y / 0.358;
      const double up = (shelf - std::floor(shelf)) * 0.358;
      const double spine = point.z / 0.045;
      const double tall = 0.20 + 0.11 * cell_noise(spine, shelf);
      if (up < 0.03 || point.x < box.high.x - 1e-3) return box.albedo;
      if (up > 0.03 + tall || cell_noise(spine / 7.0, shelf + 50.0) < 0.12) return kDark;
      constexpr std::array<std::array<double, 3>, 6> kSpines{{{0.42, 0.10, 0.07},
                                                              {0.08, 0.17, 0.30},
                                                              {0.60, 0.52, 0.38},
                                                              {0.12, 0.25, 0.17},
                                                              {0.55, 0.36, 0.08},
                                                              {0.16, 0.12, 0.11}}};
      const auto& colour = kSpines[static_cast<std::size_t>(6.0 * cell_noise(spine, shelf + 100.0))];
      return {colour[0], colour[1], colour[2]};
    }
    case Pattern::painting: {  // hills under a round sun
      const double x = point.x / 0.85;
      const double y = (point.y - 1.80) / 0.45;
      const double sun = (x + 0.3) * (x + 0.3) * 3.6 + (y - 0.25) * (y - 0.25);
      if (y < -0.55 - 0.25 * (x - 0.5) * (x - 0.5)) return kTeal * 0.6;
      if (y < -0.15 - 0.5 * (x + 0.4) * (x + 0.4)) return kTerracotta * 0.9;
      return sun < 0.16 ? dvec3(0.75, 0.50, 0.14) : dvec3(0.62, 0.52 + 0.06 * y, 0.40 + 0.08 * y);
    }
  }
  return box.albedo;
}

// Light from outside.

const dvec3 kSun = glm::normalize(dvec3(1.0, 0.25, 0.2));
const dvec3 kSunRadiance(28000.0, 21000.0, 13000.0);
constexpr double kSunInside = 0.00003, kSunOutside = 0.00007;  // 1 - cosine where the disc begins to fade, and its end
const dvec3 kSunIrradiance = kSunRadiance * (kPi * (kSunInside + kSunOutside));

dvec3 sky(const dvec3& unit) {
  const double towards = std::max(0.0, glm::dot(unit, kSun));
  const double bearing = math::turns_of(unit.z, unit.x);
  const double hills = 0.02 + 0.02 * math::sine_cosine_of_turns(5.0 * bearing + 0.1).sine +
                       0.012 * math::sine_cosine_of_turns(17.0 * bearing).sine;
  double wide = towards;  // to the powers 16 and 256
  for (int k = 0; k < 4; ++k) wide *= wide;
  double narrow = wide;
  for (int k = 0; k < 4; ++k) narrow *= narrow;
  if (unit.y < hills) {
    const double near = std::min(1.0, 4.0 * (hills - unit.y));
    return glm::mix(dvec3(0.55, 0.60, 0.66), dvec3(0.16, 0.20, 0.09), near) * (1.0 + 2.0 * wide);
  }
  const double high = std::min(1.0, 1.8 * unit.y);
  dvec3 light = glm::mix(dvec3(2.2, 1.8, 1.45), dvec3(0.6, 1.05, 2.0), high * (2.0 - high));
  light += wide * dvec3(2.5, 1.3, 0.4) + narrow * dvec3(14.0, 8.0, 3.0);
  const double off = 1.0 - glm::dot(unit, kSun);
  return light + kSunRadiance * std::clamp((kSunOutside - off) / (kSunOutside - kSunInside), 0.0, 1.0);
}

// Rays.

constexpr double kFar = 1e9;
constexpr double kOff = 1e-4;  // distance of a ray's origin from its surface

struct Hit {
  double distance = kFar;
  const Box* box = nullptr;  ///< null: the sky
  int axis = 0;              ///< of the face that was hit
};

/// Returns the distance at which a ray enters a box, and the axis of that face: `kFar` if it passes by, 0 from inside.
Hit entered(const Box& box, const dvec3& from, const dvec3& inverse) {
  const dvec3 a = (box.low - from) * inverse;
  const dvec3 b = (box.high - from) * inverse;
  const dvec3 near = glm::min(a, b);
  const dvec3 far = glm::max(a, b);
  const int axis = near.x > near.y ? (near.x > near.z ? 0 : 2) : (near.y > near.z ? 1 : 2);
  const double leave = std::min({far.x, far.y, far.z});
  if (leave <= std::max(near[axis], 0.0)) return {};
  return {std::max(near[axis], 0.0), &box, axis};
}

dvec3 inverse_of(const dvec3& unit) {
  const auto one = [](double x) { return 1.0 / (std::abs(x) < 1e-12 ? 1e-12 : x); };
  return {one(unit.x), one(unit.y), one(unit.z)};
}

Hit traced(const std::vector<Box>& boxes, const dvec3& from, const dvec3& unit) {
  const dvec3 inverse = inverse_of(unit);
  Hit first;
  for (const Box& box : boxes) {
    const Hit hit = entered(box, from, inverse);
    if (hit.distance < first.distance) first = hit;
  }
  return first;
}

/// Returns whether nothing but a lamp is in the way.
bool is_free(const std::vector<Box>& boxes, const dvec3& from, const dvec3& unit, double distance) {
  const dvec3 inverse = inverse_of(unit);
  return std::none_of(boxes.begin(), boxes.end(),
                      [&](const Box& box) { return !shines(box) && entered(box, from, inverse).distance < distance; });
}

// Light on surfaces, stored per square.

struct Face {
  std::size_t first = 0;  ///< index of its first square
  int columns = 0;
  int rows = 0;
};

struct Square {
  dvec3 point;  ///< just in front of the surface
  dvec3 normal;
  int set = 0;             ///< index of its set of directions, 0 to 8: three by three squares have all nine
  bool is_inside = false;  ///< false: on the outside of the house
};

/// A face of a box, in the order -x +x -y +y -z +z.
struct Side {
  explicit Side(int face) : axis(face / 2), u((axis + 1) % 3), v((axis + 2) % 3), is_high(face % 2 == 1) {
    normal[axis] = is_high ? 1.0 : -1.0;
  }
  /// Returns a point on it: (across, down) from 0 to 1.
  [[nodiscard]] dvec3 at(const Box& box, double across, double down) const {
    dvec3 point(is_high ? box.high : box.low);
    point[u] = glm::mix(box.low[u], box.high[u], across);
    point[v] = glm::mix(box.low[v], box.high[v], down);
    return point;
  }

  int axis, u, v;
  bool is_high;
  dvec3 normal{0.0};
};

class LitRoom {
 public:
  LitRoom(double square_m, const Control& control) : boxes_(scene()), square_m_(square_m) {
    for (const Box& box : boxes_) {
      for (int face = 0; face < 6; ++face) add_face(box, Side(face));
    }
    soft_.resize(squares_.size());
    std::vector<dvec3> sun(squares_.size());
    each_square(jobs::part_of(control, 0.0, 0.4), [&](std::size_t k) {
      soft_[k] = from_lamps(squares_[k]) + from_window(squares_[k]);
      sun[k] = sun_on(squares_[k].point, squares_[k].normal);
    });
    constexpr int kReflections = 3;
    const std::vector<dvec3> direct = soft_;
    std::vector<dvec3> gathered(squares_.size());
    for (int pass = 0; pass < kReflections; ++pass) {
      for (std::size_t k = 0; k < sun.size(); ++k) soft_[k] += sun[k];
      each_square(jobs::part_of(control, 0.4 + 0.2 * pass, 0.6 + 0.2 * pass),
                  [&](std::size_t k) { gathered[k] = gather(squares_[k]); });
      soft_ = direct;
      for (const Face& face : faces_) add_means(face, gathered);
    }
  }

  /// Returns the radiance that arrives at the eye.
  [[nodiscard]] dvec3 seen(const dvec3& unit) const {
    const Hit hit = traced(boxes_, kEye, unit);
    if (hit.box == nullptr) return sky(unit);
    if (shines(*hit.box)) return hit.box->glow;
    const dvec3 point = kEye + hit.distance * unit;
    const Side side(2 * hit.axis + (unit[hit.axis] > 0.0 ? 0 : 1));
    return albedo_at(*hit.box, point) * (soft_at(hit, point, side) + sun_on(point + kOff * side.normal, side.normal)) /
           kPi;
  }

 private:
  void add_face(const Box& box, const Side& side) {
    const dvec3 size = box.high - box.low;
    const Face face{squares_.size(), static_cast<int>(std::ceil(size[side.u] / square_m_)),
                    static_cast<int>(std::ceil(size[side.v] / square_m_))};
    for (int k = 0; k < face.columns * face.rows; ++k) {
      const int column = k % face.columns, row = k / face.columns;
      const dvec3 point = side.at(box, (column + 0.5) / face.columns, (row + 0.5) / face.rows) + kOff * side.normal;
      const bool is_inside = glm::all(glm::greaterThan(point, kRoomLow)) && glm::all(glm::lessThan(point, kRoomHigh));
      squares_.push_back({point, side.normal, row % 3 * 3 + column % 3, is_inside});
    }
    faces_.push_back(face);
  }

  template <typename Work>
  void each_square(const Control& control, const Work& work) const {
    constexpr std::size_t kTile = 128;
    const auto where = jobs::Placement::arena;
    jobs::run_tiles((squares_.size() + kTile - 1) / kTile, where, jobs::worker_count(where), control,
                    [&](std::size_t tile, std::size_t) {
                      const std::size_t end = std::min(squares_.size(), (tile + 1) * kTile);
                      for (std::size_t k = tile * kTile; k < end; ++k) {
                        if (squares_[k].is_inside) work(k);
                      }
                    });
  }

  /// Returns the irradiance of a square by a patch of light, per radiance. `unit`: the direction to it.
  [[nodiscard]] double share_of(const Square& square, const dvec3& patch, const dvec3& normal, double area,
                                dvec3& unit) const {
    const dvec3 path = patch - square.point;
    const double squared = glm::dot(path, path);
    const double distance = std::sqrt(squared);
    unit = path / distance;
    const double cosines = std::max(0.0, glm::dot(unit, square.normal)) * std::max(0.0, -glm::dot(unit, normal));
    if (cosines <= 0.0 || !is_free(boxes_, square.point, unit, distance - kOff)) return 0.0;
    return cosines * area / (squared + area / kPi);  // bounded close to a patch
  }

  [[nodiscard]] dvec3 from_lamps(const Square& square) const {
    dvec3 sum(0.0);
    dvec3 unit;
    for (const Box& lamp : boxes_) {
      if (!shines(lamp)) continue;
      const dvec3 size = lamp.high - lamp.low;
      const int edge = size.x > 0.2 ? 3 : 1;  // patches along it
      for (int face = 0; face < 6; ++face) {
        const Side side(face);
        for (int part = 0; part < edge * edge; ++part) {
          const int row = part / edge;
          const dvec3 patch = side.at(lamp, (part % edge + 0.5) / edge, (row + 0.5) / edge);
          sum += lamp.glow * share_of(square, patch, side.normal, size[side.u] * size[side.v] / (edge * edge), unit);
        }
      }
    }
    return sum;
  }

  [[nodiscard]] dvec3 from_window(const Square& square) const {
    constexpr int kColumns = 8, kRows = 5;
    constexpr double kArea = (kLintel - kSill) * (kNorth - kSouth) / (kColumns * kRows);
    dvec3 sum(0.0);
    dvec3 unit;
    for (int part = 0; part < kColumns * kRows; ++part) {
      const int row = part / kColumns;
      const dvec3 patch(kGlass, glm::mix(kSill, kLintel, (row + 0.5) / kRows),
                        glm::mix(kSouth, kNorth, (part % kColumns + 0.5) / kColumns));
      const double share = share_of(square, patch, {-1.0, 0.0, 0.0}, kArea, unit);
      if (share > 0.0) sum += glm::min(sky(unit), dvec3(30.0)) * share;  // without the sun's disc
    }
    return sum;
  }

  [[nodiscard]] dvec3 sun_on(const dvec3& point, const dvec3& normal) const {
    const double cosine = glm::dot(normal, kSun);
    return cosine > 0.0 && is_free(boxes_, point, kSun, kFar) ? kSunIrradiance * cosine : dvec3(0.0);
  }

  /// Returns the light that surfaces reflect to a square.
  [[nodiscard]] dvec3 gather(const Square& square) const {
    constexpr int kDirections = 32;
    const int axis = square.normal.x != 0.0 ? 0 : square.normal.y != 0.0 ? 1 : 2;
    dvec3 sum(0.0);
    for (int ray = 0; ray < kDirections; ++ray) {
      const double out = (ray + (square.set + 0.5) / 9.0) / kDirections;  // squared sine of the angle to the normal
      const math::SineCosine turn = math::sine_cosine_of_turns(0.6180339887498949 * (ray + square.set * 7.3));
      dvec3 unit;
      unit[axis] = square.normal[axis] * std::sqrt(1.0 - out);
      unit[(axis + 1) % 3] = std::sqrt(out) * turn.cosine;
      unit[(axis + 2) % 3] = std::sqrt(out) * turn.sine;
      const Hit hit = traced(boxes_, square.point, unit);
      if (hit.box == nullptr || hit.distance <= 0.0) continue;
      const Side side(2 * hit.axis + (unit[hit.axis] > 0.0 ? 0 : 1));
      sum += hit.box->albedo * soft_at(hit, square.point + hit.distance * unit, side);
    }
    return sum / static_cast<double>(kDirections);
  }

  /// Adds the mean over three by three squares to each square of a face.
  void add_means(const Face& face, const std::vector<dvec3>& gathered) {
    for (int k = 0; k < face.columns * face.rows; ++k) {
      dvec3 sum(0.0);
      for (int near = 0; near < 9; ++near)
        sum += gathered[index(face, k % face.columns + near % 3 - 1, k / face.columns + near / 3 - 1)];
      soft_[face.first + static_cast<std::size_t>(k)] += sum / 9.0;
    }
  }

  /// Returns the index of a square; outside of the face that of the nearest.
  static std::size_t index(const Face& face, int column, int row) {
    return face.first + static_cast<std::size_t>(std::clamp(row, 0, face.rows - 1) * face.columns +
                                                 std::clamp(column, 0, face.columns - 1));
  }

  /// Interpolates between the four nearest squares.
  [[nodiscard]] dvec3 soft_at(const Hit& hit, const dvec3& point, const Side& side) const {
    const auto box = static_cast<std::size_t>(hit.box - boxes_.data());
    const Face& face = faces_[6 * box + 2 * static_cast<std::size_t>(side.axis) + (side.is_high ? 1 : 0)];
    const dvec3 share = (point - hit.box->low) / (hit.box->high - hit.box->low);
    const double x = share[side.u] * face.columns - 0.5, y = share[side.v] * face.rows - 0.5;
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    const auto at = [&](int column, int row) { return soft_[index(face, left + column, top + row)]; };
    return glm::mix(glm::mix(at(0, 0), at(1, 0), x - left), glm::mix(at(0, 1), at(1, 1), x - left), y - top);
  }

  std::vector<Box> boxes_;
  double square_m_;          ///< the longest edge of a square
  std::vector<Face> faces_;  ///< six per box
  std::vector<Square> squares_;
  std::vector<dvec3> soft_;  ///< irradiance of squares: in the lit room all except direct sunlight
};

}  // namespace

LatLongImage sample_room(int width, int height, const Control& control) {
  image::check_lat_long_size(width, height);
  constexpr double kLit = 0.6;                                 // fraction of the progress
  const double square_m = std::clamp(20.0 / width, 0.1, 0.3);  // finer than texels show
  const LitRoom room(square_m, jobs::part_of(control, 0.0, kLit));
  LatLongImage image{
      width, height,
      std::vector<float>(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  const int samples = std::clamp(2048 / width, 2, 4);  // along a texel's edge
  const auto where = jobs::Placement::arena;
  jobs::run_tiles(static_cast<std::size_t>(height), where, jobs::worker_count(where), jobs::part_of(control, kLit, 1.0),
                  [&](std::size_t row, std::size_t) {
                    float* texel = image.pixels.data() + row * static_cast<std::size_t>(width) * 3;
                    for (int column = 0; column < width; ++column, texel += 3) {
                      dvec3 sum(0.0);
                      for (int sample = 0; sample < samples * samples; ++sample) {
                        const int sub_row = sample / samples;
                        const double x = column + (sample % samples + 0.5) / samples;
                        const double y = static_cast<double>(row) + (sub_row + 0.5) / samples;
                        sum += room.seen(image::lat_long_direction(width, height, x, y));
                      }
                      sum /= static_cast<double>(samples * samples);
                      for (int channel = 0; channel < 3; ++channel) texel[channel] = static_cast<float>(sum[channel]);
                    }
                  });
  return image;
}

}  // namespace welkin
