// How much of a lobe falls on each texel.
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
#include "reflections/direct.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWidestCut = 0.3;  ///< radius in radians of the largest part that is cut along the horizon
constexpr int kMostDepth = 24;

/// The lobe with its constants at hand.
struct Lobe {
  explicit Lobe(double alpha) : square(alpha * alpha), slope(0.5 * (1.0 - square)), scale(square / kPi) {}

  /// x = 1 - cosine.
  [[nodiscard]] double at(double x) const noexcept {
    if (x >= 1.0) return 0.0;
    const double width = square + x * slope;
    return (1.0 - x) * scale / (width * width);
  }

  double square;
  double slope;
  double scale;
};

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

/// 1 - cosine without cancellation: both are of unit length.
double distance_of(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  const glm::dvec3 chord = a - b;
  return 0.5 * glm::dot(chord, chord);
}

/// Points of the Gauss rule for a part of radius h whose nearest pole is l away: its error falls like (2 l / h)^(-2 n).
int order_for(double reach) noexcept {  // l / h
  if (reach > 2000.0) return 1;
  if (reach > 50.0) return 2;
  if (reach > 11.0) return 3;
  if (reach > 5.0) return 4;
  return reach > 3.0 ? 6 : 8;
}

// A part that the horizon cuts. The lobe has a kink there, so the rule is applied to what lies above: along one
// coordinate from the edge to the crossing, and along the other between the places at which the crossing meets an edge.

/// An interval of a coordinate; empty if `high` is not above `low`.
struct Range {
  double low, high;
};

/// Ends of the intervals of the outer coordinate, ascending.
struct Breaks {
  explicit Breaks(const Range& whole) : whole_(whole) { add(whole.low); }

  void add_inside(double place) noexcept {
    if (place > whole_.low && place < whole_.high && count < kMost - 1) add(place);
  }
  void close() noexcept {
    add(whole_.high);
    std::sort(at.begin(), at.begin() + count);
  }

  static constexpr int kMost = 32;
  std::array<double, kMost> at{};
  int count = 0;

 private:
  void add(double place) noexcept { at[static_cast<std::size_t>(count++)] = place; }
  Range whole_;
};

/// Horizon: `breaks(part)` of its outer coordinate; `above(part, outer)`, the range of the inner one;
/// `value(outer, inner, lobe)`, the lobe times steradians an area unit.
template <class Horizon>
double integrate_above(const Horizon& horizon, const Part& part, const Lobe& lobe, int order) noexcept {
  const math::GaussRule rule = math::gauss_legendre(order);
  const Breaks breaks = horizon.breaks(part);
  double sum = 0.0;
  for (std::size_t k = 1; k < static_cast<std::size_t>(breaks.count); ++k) {
    const double half = 0.5 * (breaks.at[k] - breaks.at[k - 1]);
    const double middle = 0.5 * (breaks.at[k] + breaks.at[k - 1]);
    for (int i = 0; i < rule.order; ++i) {
      const double outer = middle + half * rule.nodes[i];
      const Range inner = horizon.above(part, outer);
      const double high = 0.5 * (inner.high - inner.low);
      if (!(high > 0.0)) continue;
      double line = 0.0;
      for (int j = 0; j < rule.order; ++j)
        line += rule.weights[j] * horizon.value(outer, 0.5 * (inner.high + inner.low) + high * rule.nodes[j], lobe);
      sum += rule.weights[i] * half * high * line;
    }
  }
  return sum;
}

/// Mapping: `horizon(normal)`; `direction(column, row)`, unit; `density(column, row)`, steradians an area unit there;
/// `radius(part)`; `too_wide(part)`: the mapping itself is not smooth enough over the part.
template <class Mapping>
double integrate(const Mapping& mapping, const Part& part, const glm::dvec3& normal, const Lobe& lobe,
                 int depth) noexcept {
  const glm::dvec3 centre = mapping.direction(part.column, part.row);
  const double radius = mapping.radius(part);
  const double x = distance_of(centre, normal);
  if (x - 1.0 > radius) return 0.0;
  const double reach = std::sqrt(2.0 * x + 4.0 * lobe.square) / radius;
  const bool cut = std::abs(x - 1.0) <= radius;
  if (depth < kMostDepth && ((cut && radius > kWidestCut) || reach < 2.0 || mapping.too_wide(part))) {
    double sum = 0.0;
    for (const double down : {-0.5, 0.5}) {
      for (const double across : {-0.5, 0.5}) {
        const Part quarter{part.column + across * part.across, part.row + down * part.down, 0.5 * part.across,
                           0.5 * part.down};
        sum += integrate(mapping, quarter, normal, lobe, depth + 1);
      }
    }
    return sum;
  }
  if (cut)
    return integrate_above(mapping.horizon(normal), part, lobe, radius > 0.05 ? 10 : std::max(3, order_for(reach)));
  const math::GaussRule rule = math::gauss_legendre(order_for(reach));
  double sum = 0.0;
  for (int j = 0; j < rule.order; ++j) {
    for (int i = 0; i < rule.order; ++i) {
      const double column = part.column + part.across * rule.nodes[i];
      const double row = part.row + part.down * rule.nodes[j];
      sum += rule.weights[i] * rule.weights[j] * mapping.density(column, row) *
             lobe.at(distance_of(mapping.direction(column, row), normal));
    }
  }
  return sum * part.across * part.down;
}

/// The horizon in longitude and latitude. With h(longitude) = n.x sin + n.z cos = r cos(longitude - that of n), the
/// cosine is n.y sin(latitude) + h cos(latitude): at each longitude the horizon is crossed once, where tan(latitude) =
/// -h / n.y. Mapping: as of `integrate`, with `width()` and `height()`.
template <class Mapping>
class LatLongHorizon {
 public:
  LatLongHorizon(const Mapping& mapping, const glm::dvec3& normal)
      : mapping_(mapping),
        normal_(normal),
        radius_(std::sqrt(normal.x * normal.x + normal.z * normal.z)),
        turns_(math::turns_of(normal.x, normal.z)) {}

  /// Where the crossing meets the part's upper and lower edge. For normals near the equator it rises steeply: there its
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

  [[nodiscard]] Range above(const Part& part, double column) const noexcept {
    const math::SineCosine longitude = math::sine_cosine_of_turns(0.5 - column / mapping_.width());
    const double h = normal_.x * longitude.sine + normal_.z * longitude.cosine;
    const bool up = normal_.y >= 0.0;
    const double latitude = up ? math::turns_of(-h, normal_.y) : math::turns_of(h, -normal_.y);
    const double row = (0.25 - latitude) * 2.0 * mapping_.height();
    const Range whole{part.row - part.down, part.row + part.down};
    return up ? Range{whole.low, std::min(whole.high, row)} : Range{std::max(whole.low, row), whole.high};
  }

  [[nodiscard]] double value(double column, double row, const Lobe& lobe) const noexcept {
    return mapping_.density(column, row) * lobe.at(distance_of(mapping_.direction(column, row), normal_));
  }

 private:
  /// Of the latitude of a row's edge; beyond 1e12 at the poles.
  [[nodiscard]] double tangent_at(double row) const noexcept {
    const math::SineCosine latitude = math::sine_cosine_of_turns(0.25 - row / (2.0 * mapping_.height()));
    return latitude.sine / std::max(latitude.cosine, 1e-13);
  }
  void add_crossing(double tangent, Breaks& breaks) const noexcept {
    const double cosine = -normal_.y * tangent / radius_;
    if (!(std::abs(cosine) < 1.0)) return;
    const double aside = math::turns_of(std::sqrt((1.0 - cosine) * (1.0 + cosine)), cosine);
    for (const double longitude : {turns_ - aside, turns_ + aside}) {
      const double turns = 0.5 - longitude;
      breaks.add_inside((turns - std::floor(turns)) * mapping_.width());
    }
  }

  const Mapping& mapping_;
  glm::dvec3 normal_;
  double radius_;  ///< r
  double turns_;   ///< the normal's longitude
};

/// Longitude and latitude.
class LatLongTexels final : public LobeTexels {
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

  [[nodiscard]] int rows() const noexcept override { return height_; }
  [[nodiscard]] int columns() const noexcept override { return width_; }

  void fill(int row, TexelRow& texels) const override {
    const math::SineCosine latitude = math::sine_cosine_of_turns(0.25 - centroid(row) / (2.0 * height_));
    for (std::size_t i = 0; i < longitudes_.size(); ++i) {
      texels.x[i] = longitudes_[i].sine * latitude.cosine;
      texels.y[i] = latitude.sine;
      texels.z[i] = longitudes_[i].cosine * latitude.cosine;
    }
    const double steradians = image::lat_long_texel_solid_angle(width_, height_, row);
    std::fill(texels.solid_angle.begin(), texels.solid_angle.end(), steradians);
    texels.radius = radius({0.5, row + 0.5, 0.5, 0.5});
  }

  [[nodiscard]] double integral(int row, int column, const glm::dvec3& normal, double alpha) const noexcept override {
    const Lobe lobe(alpha);
    const Part texel{column + 0.5, row + 0.5, 0.5, 0.5};
    const double double_x = 2.0 * distance_of(centre_at(row, column), normal);
    const double reach = std::sqrt(double_x + 4.0 * lobe.square) / radius(texel);
    const bool cut = std::abs(0.5 * double_x - 1.0) <= radius(texel);
    if (cut || reach < 50.0 || too_wide(texel)) return integrate(*this, texel, normal, lobe, 0);
    return by_four(row, column, normal, lobe);
  }

  [[nodiscard]] double integral(const TexelRectangle& texels, const glm::dvec3& normal,
                                double alpha) const noexcept override {
    return integrate(*this, part_of(texels, texels.row), normal, Lobe(alpha), 0);
  }

  [[nodiscard]] glm::dvec3 direction(double column, double row) const noexcept {
    return image::lat_long_direction(width_, height_, column, row);
  }
  [[nodiscard]] double density(double /*column*/, double row) const noexcept {
    const double cosine = math::sine_cosine_of_turns(0.5 * row / height_).sine;
    return 2.0 * kPi / width_ * (kPi / height_) * cosine;
  }
  /// No cosine of a latitude in the part is above that at its centre by more than half its height.
  [[nodiscard]] double radius(const Part& part) const noexcept {
    const double down = kPi / height_ * part.down;
    const double cosine = std::min(1.0, math::sine_cosine_of_turns(0.5 * part.row / height_).sine + down);
    const double across = 2.0 * kPi / width_ * part.across * cosine;
    return std::sqrt(across * across + down * down);
  }
  [[nodiscard]] LatLongHorizon<LatLongTexels> horizon(const glm::dvec3& normal) const noexcept {
    return {*this, normal};
  }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] bool too_wide(const Part& part) const noexcept {
    return part.across > 0.125 * width_ || part.down > 0.25 * height_;  // 45 degrees each side
  }

 private:
  /// Where a row's area has its centre: at a pole at two thirds of the row, not in its middle.
  [[nodiscard]] double centroid(int row) const noexcept {
    const math::GaussRule rule = math::gauss_legendre(3);
    double moment = 0.0;
    double whole = 0.0;
    for (int j = 0; j < rule.order; ++j) {
      const double place = row + 0.5 + 0.5 * rule.nodes[j];
      const double weight = rule.weights[j] * math::sine_cosine_of_turns(place / (2.0 * height_)).sine;
      moment += weight * 0.5 * rule.nodes[j];
      whole += weight;
    }
    return row + 0.5 + moment / whole;
  }
  [[nodiscard]] static glm::dvec3 towards(const math::SineCosine& longitude, const math::SineCosine& latitude) {
    return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
  }
  [[nodiscard]] glm::dvec3 centre_at(int row, int column) const noexcept {
    return towards(longitudes_[static_cast<std::size_t>(column)],
                   math::sine_cosine_of_turns(0.25 - (row + 0.5) / (2.0 * height_)));
  }

  /// `integrate` by the Gauss rule with two points along each edge, from tables.
  [[nodiscard]] double by_four(int row, int column, const glm::dvec3& normal, const Lobe& lobe) const noexcept {
    double sum = 0.0;
    for (std::size_t j = 0; j < 2; ++j) {
      const math::SineCosine& latitude = two_latitudes_[2 * static_cast<std::size_t>(row) + j];
      for (std::size_t i = 0; i < 2; ++i) {
        const math::SineCosine& longitude = two_longitudes_[2 * static_cast<std::size_t>(column) + i];
        sum += latitude.cosine * lobe.at(distance_of(towards(longitude, latitude), normal));
      }
    }
    return sum * (kPi / width_) * (kPi / (2.0 * height_));
  }

  int width_;
  int height_;
  std::vector<math::SineCosine> longitudes_;
  std::vector<math::SineCosine> two_longitudes_;  ///< of the two points of each column
  std::vector<math::SineCosine> two_latitudes_;
};

/// The horizon on a cubemap's face: the cosine is (a u + b v + c) / r, and the horizon a straight line.
/// Mapping: as of `integrate`, with `size` and `face`.
template <class Mapping>
class FaceHorizon {
 public:
  FaceHorizon(const Mapping& mapping, const glm::dvec3& normal) : mapping_(mapping), normal_(normal) {
    const image::Frame& frame = image::face_frame(mapping.face);
    // In texels u = 2 column / size - 1.
    const double per_texel = 2.0 / mapping.size;
    const double along_u = glm::dot(frame.u, normal);
    const double along_v = glm::dot(frame.v, normal);
    by_rows_ = std::abs(along_u) > std::abs(along_v);
    outer_ = per_texel * (by_rows_ ? along_v : along_u);
    inner_ = per_texel * (by_rows_ ? along_u : along_v);
    constant_ = glm::dot(frame.normal, normal) - along_u - along_v;
  }

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

  [[nodiscard]] Range above(const Part& part, double outer) const noexcept {
    const Range whole = by_rows_ ? columns_of(part) : rows_of(part);
    const double crossing = -(constant_ + outer_ * outer) / inner_;
    return inner_ > 0.0 ? Range{std::max(whole.low, crossing), whole.high}
                        : Range{whole.low, std::min(whole.high, crossing)};
  }

  [[nodiscard]] double value(double outer, double inner, const Lobe& lobe) const noexcept {
    const double column = by_rows_ ? inner : outer;
    const double row = by_rows_ ? outer : inner;
    return mapping_.density(column, row) * lobe.at(distance_of(mapping_.direction(column, row), normal_));
  }

 private:
  [[nodiscard]] static Range columns_of(const Part& part) noexcept {
    return {part.column - part.across, part.column + part.across};
  }
  [[nodiscard]] static Range rows_of(const Part& part) noexcept { return {part.row - part.down, part.row + part.down}; }

  const Mapping& mapping_;
  glm::dvec3 normal_;
  bool
      by_rows_;  ///< whether the outer coordinate is the row: the inner one is that along which the cosine changes more
  double outer_;  ///< what the cosine times r changes by a texel
  double inner_;
  double constant_;  ///< the cosine times r at column 0, row 0
};

class CubemapTexels final : public LobeTexels {
 public:
  explicit CubemapTexels(int size) : size_(size) {}

  [[nodiscard]] int rows() const noexcept override { return 6 * size_; }
  [[nodiscard]] int columns() const noexcept override { return size_; }

  void fill(int row, TexelRow& texels) const override {
    image::cubemap_row_solid_angles(row % size_, texels.solid_angle);
    for (int column = 0; column < size_; ++column) {
      const auto i = static_cast<std::size_t>(column);
      const glm::dvec3 d = image::face_direction(size_, row / size_, column + 0.5, row % size_ + 0.5);
      texels.x[i] = d.x;
      texels.y[i] = d.y;
      texels.z[i] = d.z;
    }
    texels.radius = std::numbers::sqrt2 / size_;
  }

  [[nodiscard]] double integral(int row, int column, const glm::dvec3& normal, double alpha) const noexcept override {
    const Face face{size_, row / size_};
    return integrate(face, {column + 0.5, row % size_ + 0.5, 0.5, 0.5}, normal, Lobe(alpha), 0);
  }

  [[nodiscard]] double integral(const TexelRectangle& texels, const glm::dvec3& normal,
                                double alpha) const noexcept override {
    const Face face{size_, texels.row / size_};
    return integrate(face, part_of(texels, texels.row % size_), normal, Lobe(alpha), 0);
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
    [[nodiscard]] FaceHorizon<Face> horizon(const glm::dvec3& normal) const noexcept { return {*this, normal}; }
    [[nodiscard]] bool too_wide(const Part& part) const noexcept { return part.across > 0.13 * size; }
  };

  int size_;
};

}  // namespace

std::unique_ptr<LobeTexels> lobe_texels_of_lat_long(int width, int height) {
  return std::make_unique<LatLongTexels>(width, height);
}

std::unique_ptr<LobeTexels> lobe_texels_of_cubemap(int size) { return std::make_unique<CubemapTexels>(size); }

bool fill_lobe_integrals(const LobeTexels& texels, int row, const TexelRow& centres, const glm::dvec3& normal,
                         double alpha, std::vector<double>& integrals) {
  const Lobe lobe(alpha);
  const std::size_t count = integrals.size();
  double* const x = integrals.data();
  for (std::size_t i = 0; i < count; ++i)
    x[i] = 1.0 - (normal.x * centres.x[i] + normal.y * centres.y[i] + normal.z * centres.z[i]);
  // Within `near` of the direction, or at the horizon, a texel is looked at more closely.
  const double reach = centres.radius / 0.007;
  const double near = std::max(0.0, 0.5 * (reach * reach - 4.0 * lobe.square));
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (x[i] < near || std::abs(x[i] - 1.0) <= centres.radius) {
      x[i] = texels.integral(row, static_cast<int>(i), normal, alpha);
    } else {
      x[i] = lobe.at(x[i]) * centres.solid_angle[i];
    }
    largest = std::max(largest, x[i]);
  }
  return largest > 0.0;
}

}  // namespace welkin::reflections
