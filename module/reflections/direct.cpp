// The reference: the prefilter's integral at chosen directions.
#include "reflections/direct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "image/geometry.h"
#include "image/pixels.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sun_detection.h"
#include "reflections/lobe.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kMaxDirections = 10'000'000;

/// Points of the Gauss rule for a part of radius h whose nearest pole is l away: its error falls like (2 l / h)^(-2
/// n), as the largest ellipse about the part that has no pole has half axes that add up to l / h + sqrt(l^2 / h^2 +
/// 1), about 2 l / h of them. At the limits below that is 6e-8 for one point, 1e-8 for two to four, 5e-10 for six and
/// eight.
int order_for(double reach) noexcept {  // l / h
  if (reach > 2000.0) return 1;
  if (reach > 50.0) return 2;
  if (reach > 11.0) return 3;
  if (reach > 5.0) return 4;
  if (reach > 3.0) return 6;
  return reach >= 2.0 ? 8 : 0;
}

/// A lobe that bends nowhere but at the horizon, as cubics in even steps of s.
class CubicTable {
 public:
  /// Empty if it would have too many cells.
  explicit CubicTable(const Lobe& lobe) {
    // The cubic through four points a third of a cell w apart errs by w^4 / (24 81) of the fourth derivative at most.
    // A bell's is 3 / d^4 and its scale 1.65 d: 3 1.65^4 / (64^4 24 81) = 7e-10 of the peak.
    constexpr double kCellsOfScale = 64.0;  // error 1e-9 of the peak, which may lie far above the mean
    constexpr double kMaxCells = 1 << 16;
    const double horizon = std::sqrt(0.5);
    const double above = std::ceil(std::max(32.0, horizon * kCellsOfScale / (0.5 * lobe.scale())));
    if (above > kMaxCells) return;
    cells_of_s_ = above / horizon;
    const auto cells = static_cast<int>(std::ceil(cells_of_s_));
    for (int cell = 0; cell < cells; ++cell) {
      const double width = std::min(1.0, cells_of_s_ - cell);  // the last one ends at s = 1
      const auto at = [&](double share) {
        const double s = std::min(1.0, (cell + share * width) / cells_of_s_);
        return lobe.value(1.0 - 2.0 * s * s);
      };
      const std::array<double, 4> values{at(1e-9), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0 - 1e-9)};
      // Newton's polynomial through the values at 0, 1/3, 2/3 and 1, with u = 3 t:
      //   f0 + u first + u (u - 1) / 2 second + u (u - 1) (u - 2) / 6 third,
      // sorted by powers of t.
      const double first = values[1] - values[0];
      const double second = values[2] - 2.0 * values[1] + values[0];
      const double third = values[3] - 3.0 * values[2] + 3.0 * values[1] - values[0];
      cubics_.push_back({values[0], (3.0 * first - 1.5 * second + third) / width,
                         4.5 * (second - third) / (width * width), 4.5 * third / (width * width * width)});
    }
  }

  [[nodiscard]] bool empty() const noexcept { return cubics_.empty(); }
  [[nodiscard]] double at(double x) const noexcept {
    const double position = cells_of_s_ * std::sqrt(std::max(0.0, 0.5 * x));
    const auto cell = std::min(static_cast<std::size_t>(position), cubics_.size() - 1);
    const double t = position - static_cast<double>(cell);
    const std::array<double, 4>& cubic = cubics_[cell];
    return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]));
  }

 private:
  std::vector<std::array<double, 4>> cubics_;
  double cells_of_s_ = 0.0;
};

/// Points of a Gauss rule for 1e-6 of a function that a polynomial of degree 19 follows to 1e-12 over `widths` times
/// the rule's interval: its error falls like (4 widths)^(-2 n). `radius`: of the part of a texel.
/// Degree 19 to 1e-12 means that its Legendre coefficients fall like 4^-j (4^-20 = 9e-13): it is analytic within the
/// ellipse whose half axes add up to 4 half widths of its own interval, or 4 widths half widths of the rule's. 1e-6
/// takes n = ln(1e6) / (2 ln(4 widths)) = 6.9 / ln(4 widths).
int order_over(double widths, double radius) noexcept {
  constexpr int kMax = 12;
  if (widths < 0.45) return 0;
  const double order = std::ceil(6.9 / math::logarithm(4.0 * widths));
  const int of_mapping = radius < 0.03 ? 2 : (radius < 0.1 ? 3 : 4);  // from the sphere to rows and columns
  return order <= kMax ? std::max(of_mapping, static_cast<int>(order)) : 0;
}

/// A zonal lobe as it is integrated over texels.
class ShapeFunction final : public projection::KernelFunction {
 public:
  explicit ShapeFunction(const Lobe& shape) : shape_(shape), table_(shape), narrowest_(shape.smooth_over(0.0, 1.0)) {
    const auto x_of = [](double s) { return 2.0 * s * s; };
    first = x_of(shape.nearest());
    last = x_of(shape.farthest());
    hemisphere = shape.hemisphere();
    for (const double s : shape.breaks()) {
      if (!hemisphere || std::abs(x_of(s) - 1.0) > 1e-9) breaks.push_back(x_of(s));
    }
  }

  [[nodiscard]] double at(double x) const noexcept override {
    return breaks.empty() && !table_.empty() ? table_.at(x) : shape_.value(1.0 - x);
  }
  void evaluate(std::span<double> x) const noexcept override {
    for (double& value : x) value = at(value);
  }
  [[nodiscard]] int order(double x, double radius) const noexcept override {
    const double s = std::sqrt(0.5 * x);
    const bool cut = std::any_of(breaks.begin(), breaks.end(),
                                 [&](double at) { return std::abs(std::sqrt(0.5 * at) - s) <= 0.5 * radius; });
    if (radius > kWidest || (cut && radius > shape_.scale() / 32)) return 0;
    if (cut) return 4;
    // s moves by half of the angle; an edge of a square of this radius is sqrt(2) radius, 0.7 of it in s
    return order_over(shape_.smooth_over(s - 0.5 * radius, s + 0.5 * radius) / (kEdgeOfRadius * radius), radius);
  }
  [[nodiscard]] double far(double radius) const noexcept override {
    // The value at the centroid of a square of this radius r misses r^2 / 12 of the Laplacian, which is 2 / d^2 at the
    // peak of a bell: with its scale 1.65 d that is 2e-6. x is never 3.
    return radius < 0.002 * shape_.scale() ? 0.0 : 3.0;
  }
  [[nodiscard]] int shared_order(double radius) const noexcept override {
    constexpr int kMax = 6;
    const int order = radius > kWidest ? 0 : order_over(narrowest_ / (kEdgeOfRadius * radius), radius);
    return order <= kMax ? order : 0;
  }

 private:
  static constexpr double kWidest = 0.3;        ///< the mapping itself is smooth enough over that
  static constexpr double kEdgeOfRadius = 0.7;  ///< in s

  const Lobe& shape_;
  CubicTable table_;
  double narrowest_;
};

int clamped(double position, int count) noexcept {
  return std::clamp(static_cast<int>(std::floor(position)), 0, count - 1);
}

/// Returns the radiance of the texel that a unit direction lies in: the limit for roughness 0.
glm::dvec3 radiance_towards(const projection::SanitizedSource& source, const glm::dvec3& d) noexcept {
  const int columns = source.columns();
  if (!source.cubemap()) {
    const double longitude = math::turns_of(d.x, d.z);
    const double latitude = math::turns_of(d.y, std::sqrt(d.x * d.x + d.z * d.z));
    const int column = clamped((0.5 - longitude) * columns, columns);
    const int row = clamped((0.25 - latitude) * 2.0 * source.rows(), source.rows());
    return projection::radiance_of(source.row(row) + std::ptrdiff_t{3} * column);
  }
  const int face = image::face_of(d);
  const image::Frame& frame = image::face_frame(face);
  const auto along = [&](const glm::dvec3& axis) { return d.x * axis.x + d.y * axis.y + d.z * axis.z; };
  const double normal = along(frame.normal);
  const int column = clamped(0.5 * (along(frame.u) / normal + 1.0) * columns, columns);
  const int row = clamped(0.5 * (along(frame.v) / normal + 1.0) * columns, columns);
  return projection::radiance_of(source.row(face * columns + row) + std::ptrdiff_t{3} * column);
}

}  // namespace

// c D over the sphere by x = 1 - c, see `lobe`: alpha^2 (1 - x) / (pi (alpha^2 + x (1 - alpha^2) / 2)^2).
GgxFunction::GgxFunction(double alpha)
    : square_(alpha * alpha), slope_(0.5 * (1.0 - square_)), scale_(square_ / std::numbers::pi) {
  hemisphere = true;
  curved = true;
  last = 1.0;
}

void GgxFunction::evaluate(std::span<double> x) const noexcept {
  for (double& value : x) value = at(value);
}

// k = s (1 - x) w^-2, w = alpha^2 + b x, has k' = -s (w^-2 + 2 b (1 - x) w^-3), and half of its second derivative is
// s (2 b w^-3 + 3 b^2 (1 - x) w^-4).
void GgxFunction::evaluate_means(std::span<double> x, std::span<const double> variances) const noexcept {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double above = 1.0 - x[i];
    const double inverse = 1.0 / (square_ + x[i] * slope_);
    const double bend = slope_ * inverse * (2.0 + 3.0 * slope_ * above * inverse);
    x[i] = above > 0.0 ? scale_ * inverse * inverse * (above + variances[i] * bend) : 0.0;
  }
}

int GgxFunction::order(double x, double radius) const noexcept {
  // The square of the chord to the axis is 2 x, and the lobe's pole is where that is -w, w = 4 alpha^2 / (1 - alpha^2).
  // On a line that passes the axis at a distance d it is d^2 + t^2, so the poles t = +-i sqrt(d^2 + w) lie
  // sqrt(2 x + w) from the place where it is 2 x, whatever the line. w is at least 4 alpha^2.
  return order_for(std::sqrt(2.0 * x + 4.0 * square_) / radius);
}

double GgxFunction::far(double radius) const noexcept {
  // x at which the poles are `reach` away, see `order`. What the variance leaves is of higher order: of L^-4 along a
  // long texel 7 (r / L)^4, and in a row next to a pole, a triangle whose third moment is r^3 / 17, 20 / 17 (r / L)^3:
  // 3e-7 and 3e-6 for r / L = 0.014.
  const double reach = radius / 0.014;
  return std::max(0.0, 0.5 * (reach * reach - 4.0 * square_));
}

std::vector<glm::dvec3> integrate_lobe(const projection::SanitizedSource& source, const Lobe& lobe,
                                       std::span<const glm::dvec3> directions, const Control& control) {
  if (lobe.alpha() == 0.0) return projection::integrate_kernel(source, ShapeFunction(lobe), directions, control);
  std::vector<glm::dvec3> result = projection::integrate_kernel(source, GgxFunction(lobe.alpha()), directions, control);
  const double whole = lobe_integral(lobe.alpha());
  for (glm::dvec3& value : result) value /= whole;
  return result;
}

std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions) {
  if (directions.empty() || directions.size() > kMaxDirections) {
    throw Error(ErrorCode::invalid_argument, std::to_string(directions.size()) + " directions; 1 to " +
                                                 std::to_string(kMaxDirections) + " are possible");
  }
  return math::unit_directions(directions, "direction");
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr double kMinAlpha = 1e-6;

}  // namespace

std::vector<glm::dvec3> reference_specular(const EnvironmentView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  if (!(roughness >= 0.0 && roughness <= 1.0)) {
    throw Error(ErrorCode::invalid_argument,
                "roughness " + platform::number_text(roughness) + " is out of range; pass 0 to 1");
  }
  const std::vector<glm::dvec3> units = reflections::unit_directions(directions);
  const projection::SanitizedSource texels(source, {}, {control.stop, {}});
  const double alpha = roughness * roughness;
  if (alpha >= kMinAlpha) return reflections::integrate_lobe(texels, reflections::Lobe(alpha), units, control);
  std::vector<glm::dvec3> values;
  values.reserve(units.size());
  for (const glm::dvec3& unit : units) values.push_back(reflections::radiance_towards(texels, unit));
  return values;
}

}  // namespace welkin
