// How much of a kernel falls on each texel.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include "image/geometry.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "projection/kernel_integrals.h"

namespace welkin::projection {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWidestCut = 0.3;  ///< radius in radians of the largest part that is cut along the horizon
constexpr int kMaxDepth = 24;
constexpr int kMaxPoints = 8;  ///< along an edge, where a part cannot be divided further

/// A part of a texel in units of texels, halves of its edges.
struct Part {
  double column, row;  ///< centre
  double across, down;
};

/// `row`: the first one, within its face.
Part part_of(const TexelRectangle& texels, int row) noexcept {
  const double across = 0.5 * texels.columns;
  const double down = 0.5 * texels.rows;
  return {texels.column + across, row + down, across, down};
}

/// For unit a and b, |a - b|^2 / 2 = (1 - 2 a.b + 1) / 2 = 1 - a.b. The plain 1 - a.b is off by a double's rounding of
/// 1, 1e-16, which is all of x at an angle of 1e-8; the chord's components keep their own relative rounding.
double distance_of(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  const glm::dvec3 chord = a - b;
  return 0.5 * glm::dot(chord, chord);
}

/// Returns whether points within `radius` (= d) of one at x may lie at `at`. With at = 1 - cos t,
///   |cos(t + d) - cos t| <= sin t d + d^2 / 2,   sin t = sqrt(at (2 - at)) <= sqrt(2 at),
/// (Taylor's theorem; the second derivative is at most 1), and the change is at most d in any case. So near the axis,
/// where sin t is small, far fewer texels are taken for ones that a break cuts than by the bound d alone.
bool reaches(double x, double at, double radius) noexcept {
  return std::abs(x - at) <= std::min(radius, (std::sqrt(2.0 * at) + 0.5 * radius) * radius);
}

// A part that the horizon cuts. The kernel has a kink there, so the rule is applied to what lies above: along one
// coordinate from the edge to the crossing, and along the other between the places at which the crossing meets an edge.

/// An interval of a coordinate; empty if `high` is not above `low`.
struct Range {
  double low, high;
};

/// Ends of the intervals of the outer coordinate, ascending.
struct Breaks {
  explicit Breaks(const Range& whole) : whole_(whole) { add(whole.low); }

  void add_inside(double position) noexcept {
    if (position > whole_.low && position < whole_.high && count < kMax - 1) add(position);
  }
  void close() noexcept {
    add(whole_.high);
    std::sort(at.begin(), at.begin() + count);
  }

  static constexpr int kMax = 32;
  std::array<double, kMax> at{};
  int count = 0;

 private:
  void add(double position) noexcept { at[static_cast<std::size_t>(count++)] = position; }
  Range whole_;
};

/// Horizon: `breaks(part)` of its outer coordinate; `line(part, outer)`: what points of that outer coordinate share,
/// among it `above`, the range of the inner one; `value(line, offset, kernel)`: the kernel times steradians an area
/// unit, at `offset` from the middle of that range.
/// Returns Int over outer of (Int over inner of value), by Gauss rules in both. The inner limit is the crossing, a
/// smooth function of the outer coordinate between two breaks, so both integrands are smooth and the rule keeps its
/// order. A rule over the whole part would be off by its first order in the part's size, for the cosine bends at the
/// horizon.
template <class Horizon>
double integrate_above(const Horizon& horizon, const Part& part, const KernelFunction& kernel, int order) noexcept {
  const math::GaussRule rule = math::gauss_legendre(order);
  const Breaks breaks = horizon.breaks(part);
  double sum = 0.0;
  for (std::size_t k = 1; k < static_cast<std::size_t>(breaks.count); ++k) {
    const double half = 0.5 * (breaks.at[k] - breaks.at[k - 1]);
    const double middle = 0.5 * (breaks.at[k] + breaks.at[k - 1]);
    for (int i = 0; i < rule.order; ++i) {
      const auto line = horizon.line(part, middle + half * rule.nodes[i]);
      const double high = 0.5 * (line.above.high - line.above.low);
      if (!(high > 0.0)) continue;
      double along = 0.0;
      for (int j = 0; j < rule.order; ++j) along += rule.weights[j] * horizon.value(line, high * rule.nodes[j], kernel);
      sum += rule.weights[i] * half * high * along;
    }
  }
  return sum;
}

/// Points along an edge for what the horizon leaves of a part. A cosine has no poles near by.
int points_above(double radius, int order, const KernelFunction& kernel) noexcept {
  if (kernel.cosine) return order;
  return radius > 0.05 ? 10 : std::max(3, order);
}

/// Mapping: `horizon(axis)`; `direction(column, row)`, unit; `density(column, row)`, steradians an area unit there;
/// `radius(part)`; `too_wide(part)`: the mapping itself is not smooth enough over the part.
template <class Mapping>
double integrate(const Mapping& mapping, const Part& part, const glm::dvec3& axis, const KernelFunction& kernel,
                 int depth) noexcept {
  const glm::dvec3 centre = mapping.direction(part.column, part.row);
  const double radius = mapping.radius(part);
  const double x = distance_of(centre, axis);
  const bool unseen =
      (x > kernel.last && !reaches(x, kernel.last, radius)) || (x < kernel.first && !reaches(x, kernel.first, radius));
  if (unseen) return 0.0;
  const bool cut = kernel.hemisphere && std::abs(x - 1.0) <= radius;
  const int order = kernel.order(x, radius);
  // Quarters halve the radius, and each kernel's `order` is above 0 for a part that is small enough for its distance
  // from what is not smooth. At kMaxDepth a part is 2^-24 of the texel's edge and 2^-48 of its area.
  if (depth < kMaxDepth && (order == 0 || (cut && radius > kWidestCut) || mapping.too_wide(part))) {
    double sum = 0.0;
    for (const double down : {-0.5, 0.5}) {
      for (const double across : {-0.5, 0.5}) {
        const Part quarter{part.column + across * part.across, part.row + down * part.down, 0.5 * part.across,
                           0.5 * part.down};
        sum += integrate(mapping, quarter, axis, kernel, depth + 1);
      }
    }
    return sum;
  }
  if (cut) return integrate_above(mapping.horizon(axis), part, kernel, points_above(radius, order, kernel));
  const math::GaussRule rule = math::gauss_legendre(order == 0 ? kMaxPoints : order);
  double sum = 0.0;
  for (int j = 0; j < rule.order; ++j) {
    for (int i = 0; i < rule.order; ++i) {
      const double column = part.column + part.across * rule.nodes[i];
      const double row = part.row + part.down * rule.nodes[j];
      sum += rule.weights[i] * rule.weights[j] * mapping.density(column, row) *
             kernel.at(distance_of(mapping.direction(column, row), axis));
    }
  }
  return sum * part.across * part.down;
}

/// The points of a row, which is `row` of the mapping.
template <class Mapping>
void fill_points(const Mapping& mapping, int row, int columns, int order, TexelPoints& points) {
  const math::GaussRule rule = math::gauss_legendre(order);
  for (std::vector<double>* const list : {&points.x, &points.y, &points.z, &points.weight}) list->clear();
  points.count = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
  for (int column = 0; column < columns; ++column) {
    for (int j = 0; j < order; ++j) {
      const double down = row + 0.5 + 0.5 * rule.nodes[j];
      for (int i = 0; i < order; ++i) {
        const double across = column + 0.5 + 0.5 * rule.nodes[i];
        const glm::dvec3 direction = mapping.direction(across, down);
        points.x.push_back(direction.x);
        points.y.push_back(direction.y);
        points.z.push_back(direction.z);
        // The rule's interval from -1 to 1 is a texel's edge: half a texel in each coordinate, a quarter in the area.
        points.weight.push_back(0.25 * rule.weights[i] * rule.weights[j] * mapping.density(across, down));
      }
    }
  }
}

/// The horizon in longitude and latitude. With h(longitude) = n.x sin + n.z cos = r cos(longitude - that of n), the
/// cosine is n.y sin(latitude) + h cos(latitude): at each longitude the horizon is crossed once, where tan(latitude) =
/// -h / n.y.
class LatLongHorizon {
 public:
  LatLongHorizon(int width, int height, const glm::dvec3& axis)
      : width_(width),
        height_(height),
        axis_(axis),
        radius_(std::sqrt(axis.x * axis.x + axis.z * axis.z)),
        turns_(math::turns_of(axis.x, axis.z)) {}

  // With T(longitude) = -h / n.y the crossing is atan(T), whose branch points are T = +-i. A Gauss rule of k points
  // converges like rho^(-2k), rho = |z + sqrt(z^2 - 1)| for a singularity at z in the interval scaled to [-1, 1]: from
  // -1 to 1 z = i and rho = 1 + sqrt(2) = 2.4; from T to 4 T z = (i - 2.5 T) / (1.5 T) and rho is from 3.4 (T = 1) to
  // 3.0. Beyond |T| = 256 the crossing is within 1/256 of a pole, where hardly any solid angle is left.
  struct Line {
    Range above;
    double along;             ///< h
    math::SineCosine middle;  ///< of the latitude in the middle
  };

  /// Where the crossing meets the part's upper and lower edge. For axes near the equator it rises steeply: there its
  /// arc tangent is cut where it bends, so that no interval is wider than its distance from the arc tangent's poles.
  [[nodiscard]] Breaks breaks(const Part& part) const noexcept {
    Breaks breaks({part.column - part.across, part.column + part.across});
    const double lowest = tangent_at(part.row + part.down);
    const double highest = tangent_at(part.row - part.down);
    add_crossing(lowest, breaks);
    add_crossing(highest, breaks);
    for (const double tangent : {-256.0, -64.0, -16.0, -4.0, -1.0, 1.0, 4.0, 16.0, 64.0, 256.0}) {
      if (tangent > lowest && tangent < highest) add_crossing(tangent, breaks);
    }
    breaks.close();
    return breaks;
  }

  [[nodiscard]] Line line(const Part& part, double column) const noexcept {
    const math::SineCosine longitude = math::sine_cosine_of_turns(0.5 - column / width_);
    const double h = axis_.x * longitude.sine + axis_.z * longitude.cosine;
    // The cosine is n.y sin(lat) + h cos(lat) = A sin(lat - lat0) with lat0 = atan2(-h, n.y) and A > 0. For n.y >= 0
    // lat0 is a latitude, and the part north of it is above the horizon. For n.y < 0 the crossing is at lat0 plus half
    // a turn, atan2(h, -n.y), and the part south of it is above. Rows fall with latitude.
    const bool up = axis_.y >= 0.0;
    const double latitude = up ? math::turns_of(-h, axis_.y) : math::turns_of(h, -axis_.y);
    const double row = (0.25 - latitude) * 2.0 * height_;
    const Range whole{part.row - part.down, part.row + part.down};
    const Range above = up ? Range{whole.low, std::min(whole.high, row)} : Range{std::max(whole.low, row), whole.high};
    return {above, h, latitude_at(0.5 * (above.low + above.high))};
  }

  [[nodiscard]] double value(const Line& line, double offset, const KernelFunction& kernel) const noexcept {
    // The inner points lie within half a texel of the middle, whose sine and cosine are known: the sum formulas with
    // short series in `angle` take the place of a call for each point. The first terms left out are angle^7 / 5040 and
    // angle^8 / 40320: 3e-16 and 1e-18 at 0.02.
    const double angle = -kPi / height_ * offset;
    math::SineCosine latitude{};
    if (std::abs(angle) < 0.02) {  // the series are exact to 1e-15
      const double square = angle * angle;
      const double cosine = 1.0 - square * (0.5 - square * (1.0 / 24 - square / 720));
      const double sine = angle * (1.0 - square * (1.0 / 6 - square / 120));
      latitude = {line.middle.sine * cosine + line.middle.cosine * sine,
                  line.middle.cosine * cosine - line.middle.sine * sine};
    } else {
      latitude = latitude_at(0.5 * (line.above.low + line.above.high) + offset);
    }
    const double steradians = 2.0 * kPi / width_ * (kPi / height_) * latitude.cosine;
    return steradians * kernel.at(1.0 - (axis_.y * latitude.sine + line.along * latitude.cosine));
  }

 private:
  [[nodiscard]] math::SineCosine latitude_at(double row) const noexcept {
    return math::sine_cosine_of_turns(0.25 - row / (2.0 * height_));
  }
  /// Returns the tangent of the latitude of a row's edge; beyond 1e12 at the poles.
  [[nodiscard]] double tangent_at(double row) const noexcept {
    const math::SineCosine latitude = latitude_at(row);
    return latitude.sine / std::max(latitude.cosine, 1e-13);
  }
  void add_crossing(double tangent, Breaks& breaks) const noexcept {
    // tan(latitude) = -h / n.y with h = r cos(longitude - that of n): the edge is met where cos = -n.y tan / r, on both
    // sides of the axis. The sine is the root of (1 - c) (1 + c), which does not cancel for c near +-1.
    const double cosine = -axis_.y * tangent / radius_;
    if (!(std::abs(cosine) < 1.0)) return;
    const double aside = math::turns_of(std::sqrt((1.0 - cosine) * (1.0 + cosine)), cosine);
    for (const double longitude : {turns_ - aside, turns_ + aside}) {
      const double turns = 0.5 - longitude;
      breaks.add_inside((turns - std::floor(turns)) * width_);
    }
  }

  int width_;
  int height_;
  glm::dvec3 axis_;
  double radius_;  ///< r
  double turns_;   ///< the axis' longitude
};

/// Longitude u and latitude v: d = (sin u cos v, sin v, cos u cos v), dw = cos v du dv.
class LatLongTexels final : public TexelIntegrals {
 public:
  LatLongTexels(int width, int height) : width_(width), height_(height) {
    const double node = math::gauss_legendre(2).nodes[1];
    for (int i = 0; i < width; ++i) {
      longitudes_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
      for (const double side : {-0.5, 0.5})
        two_longitudes_.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5 + side * node) / width));
    }
    for (int j = 0; j < height; ++j) {
      for (const double side : {-0.5, 0.5})
        two_latitudes_.push_back(math::sine_cosine_of_turns(0.25 - (j + 0.5 + side * node) / (2.0 * height)));
    }
  }

  /// Over a texel with centre (u, v) and half-widths (a, b): Int sin u du = 2 sin a sin u,
  /// Int cos^2 v dv = b + sin b cos b cos 2v, Int sin v cos v dv = sin b cos b sin 2v.
  void fill(int row, TexelRow& texels) const override {
    const math::SineCosine twice = math::sine_cosine_of_turns(0.5 - (row + 0.5) / height_);  // 2v
    const math::SineCosine half_row = math::sine_cosine_of_turns(0.25 / height_);            // b
    // d = (sin u cos v, sin v, cos u cos v) and dw = cos v du dv, so with the azimuth of the texel's middle removed
    //   level = Int cos(u - u0) du Int cos^2 v dv = 2 sin a (b + sin b cos b cos 2v),
    //   up    = Int du Int sin v cos v dv         = 2 a sin b cos b sin 2v,
    // a = pi / width, b = pi / (2 height). (level, up) is the mean of d times the solid angle, so its direction is the
    // centroid's latitude and its length the moment.
    const double skew = half_row.sine * half_row.cosine;
    const double level =
        2.0 * math::sine_cosine_of_turns(0.5 / width_).sine * (kPi / (2.0 * height_) + skew * twice.cosine);
    const double up = 2.0 * kPi / width_ * skew * twice.sine;
    const double moment = std::sqrt(level * level + up * up);
    const double steradians = image::lat_long_texel_solid_angle(width_, height_, row);
    // A texel that is the whole sphere has no centroid.
    const bool whole = moment < 1e-9 * steradians;
    const math::SineCosine latitude =
        whole ? math::SineCosine{0.0, 1.0} : math::SineCosine{up / moment, level / moment};
    for (std::size_t i = 0; i < longitudes_.size(); ++i) {
      texels.x[i] = longitudes_[i].sine * latitude.cosine;
      texels.y[i] = latitude.sine;
      texels.z[i] = longitudes_[i].cosine * latitude.cosine;
    }
    std::fill(texels.solid_angle.begin(), texels.solid_angle.end(), steradians);
    std::fill(texels.moment.begin(), texels.moment.end(), moment);
    const math::SineCosine middle = math::sine_cosine_of_turns(0.25 - (row + 0.5) / (2.0 * height_));
    const double aside = std::abs(latitude.sine * middle.cosine - latitude.cosine * middle.sine);
    // `radius` is from the middle of the texel; the centroid's latitude is off it by `aside`.
    texels.radius = whole ? kPi : radius({0.5, row + 0.5, 0.5, 0.5}) + aside;
  }

  /// With c the centroid, at the latitude p, d.east = cos v sin(u - u0) and d.north = sin(v - p) for u = u0. The
  /// variances are the means of their squares, dw = cos v du dv: of sin^2(u - u0) over u0 +- a (1 - sin 2a / 2a) / 2,
  /// and over v by a Gauss rule, since a row next to a pole is a triangle.
  void fill(int row, const TexelRow& texels, TexelSpread& spread) const override {
    const double width = 2.0 * kPi / width_;  // 2a
    const math::GaussRule rule = math::gauss_legendre(4);
    const double sine = texels.y.front();
    const double cosine = std::sqrt(std::max(0.0, (1.0 - sine) * (1.0 + sine)));
    double whole = 0.0;
    double north = 0.0;
    double east = 0.0;
    for (int k = 0; k < rule.order; ++k) {
      const math::SineCosine v = math::sine_cosine_of_turns(0.25 - (row + 0.5 + 0.5 * rule.nodes[k]) / (2.0 * height_));
      const double weight = rule.weights[k] * v.cosine;
      const double along = v.sine * cosine - v.cosine * sine;
      whole += weight;
      north += weight * along * along;
      east += weight * v.cosine * v.cosine;
    }
    // 1 - sin(t) / t = t^2 / 6 (1 - t^2 / 20 + t^4 / 840 - ...), which cancels for narrow texels
    const double square = width * width;
    const double bent = width < 0.1 ? square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
                                    : 1.0 - math::sine_cosine_of_turns(1.0 / width_).sine / width;
    const double across = std::sqrt(0.5 * bent * east / whole);
    const double down = std::sqrt(north / whole);
    for (std::size_t i = 0; i < longitudes_.size(); ++i) {
      spread.length[i] = texels.moment[i] / texels.solid_angle[i];
      spread.ax[i] = across * longitudes_[i].cosine;
      spread.ay[i] = 0.0;
      spread.az[i] = -across * longitudes_[i].sine;
      spread.bx[i] = -down * sine * longitudes_[i].sine;
      spread.by[i] = down * cosine;
      spread.bz[i] = -down * sine * longitudes_[i].cosine;
    }
  }

  void fill(int row, int order, TexelPoints& points) const override { fill_points(*this, row, width_, order, points); }

  [[nodiscard]] double integral(const TexelRectangle& texels, const glm::dvec3& axis,
                                const KernelFunction& kernel) const noexcept override {
    const Part part = part_of(texels, texels.row);
    if (texels.rows == 1 && texels.columns == 1 && !too_wide(part)) {
      const double size = radius(part);
      const double x = distance_of(centre_at(texels.row, texels.column), axis);
      const int order = kernel.order(x, size);
      const bool cut = kernel.hemisphere && std::abs(x - 1.0) <= size;
      if (cut && order > 0 && size <= kWidestCut)
        return integrate_above(horizon(axis), part, kernel, points_above(size, order, kernel));
      if (!cut && order > 0 && order <= 2) return by_four(texels.row, texels.column, axis, kernel);
    }
    return integrate(*this, part, axis, kernel, 0);
  }

  [[nodiscard]] glm::dvec3 direction(double column, double row) const noexcept {
    return image::lat_long_direction(width_, height_, column, row);
  }
  [[nodiscard]] double density(double /*column*/, double row) const noexcept {
    const double cosine = math::sine_cosine_of_turns(0.5 * row / height_).sine;
    return 2.0 * kPi / width_ * (kPi / height_) * cosine;
  }
  /// |d cos(v) / dv| <= 1, so no cosine of a latitude in the part is above that at its centre by more than half its
  /// height. The straight line in (u, v) to a corner has the length Int sqrt(dv^2 + cos^2 v du^2) <= sqrt(down^2 +
  /// (cosine half width)^2), and an arc of a great circle is no longer.
  [[nodiscard]] double radius(const Part& part) const noexcept {
    const double down = kPi / height_ * part.down;
    const double cosine = std::min(1.0, math::sine_cosine_of_turns(0.5 * part.row / height_).sine + down);
    const double across = 2.0 * kPi / width_ * part.across * cosine;
    return std::sqrt(across * across + down * down);
  }
  [[nodiscard]] LatLongHorizon horizon(const glm::dvec3& axis) const noexcept { return {width_, height_, axis}; }
  [[nodiscard]] bool too_wide(const Part& part) const noexcept {
    return part.across > 0.125 * width_ || part.down > 0.25 * height_;  // 45 degrees each side
  }

 private:
  [[nodiscard]] static glm::dvec3 towards(const math::SineCosine& longitude, const math::SineCosine& latitude) {
    return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
  }
  [[nodiscard]] glm::dvec3 centre_at(int row, int column) const noexcept {
    return towards(longitudes_[static_cast<std::size_t>(column)],
                   math::sine_cosine_of_turns(0.25 - (row + 0.5) / (2.0 * height_)));
  }

  /// `integrate` by the Gauss rule with two points along each edge, from tables.
  [[nodiscard]] double by_four(int row, int column, const glm::dvec3& axis,
                               const KernelFunction& kernel) const noexcept {
    double sum = 0.0;
    for (std::size_t j = 0; j < 2; ++j) {
      const math::SineCosine& latitude = two_latitudes_[2 * static_cast<std::size_t>(row) + j];
      for (std::size_t i = 0; i < 2; ++i) {
        const math::SineCosine& longitude = two_longitudes_[2 * static_cast<std::size_t>(column) + i];
        sum += latitude.cosine * kernel.at(distance_of(towards(longitude, latitude), axis));
      }
    }
    // The weights of the two-point rule are 1, its nodes +-1 / sqrt(3) half texels; the half-widths of a texel are pi /
    // width and pi / (2 height).
    return sum * (kPi / width_) * (kPi / (2.0 * height_));
  }

  int width_;
  int height_;
  std::vector<math::SineCosine> longitudes_;
  std::vector<math::SineCosine> two_longitudes_;  ///< of the two points of each column
  std::vector<math::SineCosine> two_latitudes_;
};

/// The horizon on a cubemap's face: the cosine is (a u + b v + c) / r, and the horizon a straight line.
class FaceHorizon {
 public:
  FaceHorizon(int size, int face, const glm::dvec3& axis) : per_texel_(2.0 / size) {
    const image::Frame& frame = image::face_frame(face);
    // In texels u = 2 column / size - 1.
    const double along_u = glm::dot(frame.u, axis);
    const double along_v = glm::dot(frame.v, axis);
    // cos r = a u + b v + c is linear, so the horizon is a line. The inner coordinate is the one with the larger of |a|
    // and |b|: the crossing is divided by that factor, and its slope |outer / inner| is at most 1.
    by_rows_ = std::abs(along_u) > std::abs(along_v);
    outer_ = per_texel_ * (by_rows_ ? along_v : along_u);
    inner_ = per_texel_ * (by_rows_ ? along_u : along_v);
    constant_ = glm::dot(frame.normal, axis) - along_u - along_v;
  }

  struct Line {
    Range above;
    double outer;
  };

  [[nodiscard]] Breaks breaks(const Part& part) const noexcept {
    Breaks breaks(by_rows_ ? rows_of(part) : columns_of(part));
    const Range inner = by_rows_ ? columns_of(part) : rows_of(part);
    if (outer_ != 0.0) {
      breaks.add_inside(-(constant_ + inner_ * inner.low) / outer_);
      breaks.add_inside(-(constant_ + inner_ * inner.high) / outer_);
    }
    breaks.close();
    return breaks;
  }

  [[nodiscard]] Line line(const Part& part, double outer) const noexcept {
    const Range whole = by_rows_ ? columns_of(part) : rows_of(part);
    const double crossing = -(constant_ + outer_ * outer) / inner_;
    return {inner_ > 0.0 ? Range{std::max(whole.low, crossing), whole.high}
                         : Range{whole.low, std::min(whole.high, crossing)},
            outer};
  }

  [[nodiscard]] double value(const Line& line, double offset, const KernelFunction& kernel) const noexcept {
    const double inner = 0.5 * (line.above.low + line.above.high) + offset;
    const double u = per_texel_ * inner - 1.0;
    const double v = per_texel_ * line.outer - 1.0;
    // A texel is (2 / size)^2 of the plane at distance 1, where dw = du dv / r^3; `square` is r^-2.
    const double square = 1.0 / (1.0 + u * u + v * v);
    const double inverse = std::sqrt(square);
    const double cosine = (constant_ + outer_ * line.outer + inner_ * inner) * inverse;
    return per_texel_ * per_texel_ * square * inverse * kernel.at(1.0 - cosine);
  }

 private:
  [[nodiscard]] static Range columns_of(const Part& part) noexcept {
    return {part.column - part.across, part.column + part.across};
  }
  [[nodiscard]] static Range rows_of(const Part& part) noexcept { return {part.row - part.down, part.row + part.down}; }

  double per_texel_;
  bool
      by_rows_;  ///< whether the outer coordinate is the row: the inner one is that along which the cosine changes more
  double outer_;  ///< what the cosine times r changes by a texel
  double inner_;
  double constant_;  ///< the cosine times r at column 0, row 0
};

/// With d = (u, v, 1) / r in the face's frame, dw = du dv / r^3.
class CubemapTexels final : public TexelIntegrals {
 public:
  explicit CubemapTexels(int size) : size_(size) {}

  /// By a Gauss rule that is exact to rounding.
  void fill(int row, TexelRow& texels) const override {
    const image::Frame& frame = image::face_frame(row / size_);
    const math::GaussRule rule = math::texel_rule(size_);
    const double half = 1.0 / size_;
    const double v0 = (2.0 * (row % size_) + 1.0) * half - 1.0;
    for (int column = 0; column < size_; ++column) {
      const double u0 = (2.0 * column + 1.0) * half - 1.0;
      glm::dvec3 local(0.0);
      double solid_angle = 0.0;
      for (int j = 0; j < rule.order; ++j) {
        for (int i = 0; i < rule.order; ++i) {
          const double u = u0 + half * rule.nodes[i];
          const double v = v0 + half * rule.nodes[j];
          const double q = 1.0 / (1.0 + u * u + v * v);
          const double weight = rule.weights[i] * rule.weights[j] * half * half * q;
          // With q = r^-2: Int d dw = Int (u, v, 1) r^-4 du dv, and Int dw = Int r^-3 du dv.
          local += weight * q * glm::dvec3(u, v, 1.0);
          solid_angle += weight * std::sqrt(q);
        }
      }
      const glm::dvec3 moment = local.x * frame.u + local.y * frame.v + local.z * frame.normal;
      const auto i = static_cast<std::size_t>(column);
      texels.solid_angle[i] = solid_angle;
      texels.moment[i] = glm::length(moment);
      texels.x[i] = moment.x / texels.moment[i];
      texels.y[i] = moment.y / texels.moment[i];
      texels.z[i] = moment.z / texels.moment[i];
    }
    // Half a diagonal on a plane at distance 1 or more.
    texels.radius = std::numbers::sqrt2 / size_;
  }

  /// d = (u, v, 1) / r gives dd/du = (U - d (d.U)) / r, U the axis along u, and the same with v. Over +-h about the
  /// middle u has the variance h^2 / 3, and so has v. 1 / r is d.normal.
  void fill(int row, const TexelRow& texels, TexelSpread& spread) const override {
    const image::Frame& frame = image::face_frame(row / size_);
    const double scale = 1.0 / (size_ * std::numbers::sqrt3);
    for (std::size_t i = 0; i < spread.length.size(); ++i) {
      const glm::dvec3 d(texels.x[i], texels.y[i], texels.z[i]);
      const double share = scale * glm::dot(d, frame.normal);
      const glm::dvec3 a = share * (frame.u - glm::dot(d, frame.u) * d);
      const glm::dvec3 b = share * (frame.v - glm::dot(d, frame.v) * d);
      spread.length[i] = texels.moment[i] / texels.solid_angle[i];
      spread.ax[i] = a.x;
      spread.ay[i] = a.y;
      spread.az[i] = a.z;
      spread.bx[i] = b.x;
      spread.by[i] = b.y;
      spread.bz[i] = b.z;
    }
  }

  void fill(int row, int order, TexelPoints& points) const override {
    fill_points(Face{size_, row / size_}, row % size_, size_, order, points);
  }

  [[nodiscard]] double integral(const TexelRectangle& texels, const glm::dvec3& axis,
                                const KernelFunction& kernel) const noexcept override {
    const Face face{size_, texels.row / size_};
    return integrate(face, part_of(texels, texels.row % size_), axis, kernel, 0);
  }

 private:
  struct Face {
    int size;
    int face;

    [[nodiscard]] glm::dvec3 direction(double column, double row) const noexcept {
      return image::face_direction(size, face, column, row);
    }
    [[nodiscard]] double density(double column, double row) const noexcept {
      const double u = 2.0 * column / size - 1.0;
      const double v = 2.0 * row / size - 1.0;
      const double q = 1.0 / (1.0 + u * u + v * v);
      return 4.0 / (static_cast<double>(size) * size) * q * std::sqrt(q);
    }
    [[nodiscard]] double radius(const Part& part) const noexcept {
      return 2.0 / size * std::sqrt(part.across * part.across + part.down * part.down);
    }
    [[nodiscard]] FaceHorizon horizon(const glm::dvec3& axis) const noexcept { return {size, face, axis}; }
    // The density's poles are at distance 1 or more from a plane point, and 0.13 size is a half-width of 0.26 in u:
    // rho >= 1 / 0.26 + sqrt(1 / 0.26^2 + 1) = 7.8, and each point of a Gauss rule takes off a factor of 60.
    [[nodiscard]] bool too_wide(const Part& part) const noexcept { return part.across > 0.13 * size; }
  };

  int size_;
};

}  // namespace

TexelRow::TexelRow(std::size_t columns) : x(columns), y(columns), z(columns), solid_angle(columns), moment(columns) {}

TexelSpread::TexelSpread(std::size_t columns)
    : length(columns), ax(columns), ay(columns), az(columns), bx(columns), by(columns), bz(columns) {}

std::unique_ptr<TexelIntegrals> texel_integrals_of(const image::TexelGrid& grid) {
  if (grid.kind() == image::TexelGrid::Kind::cubemap) return std::make_unique<CubemapTexels>(grid.columns());
  return std::make_unique<LatLongTexels>(grid.columns(), grid.rows());
}

}  // namespace welkin::projection
