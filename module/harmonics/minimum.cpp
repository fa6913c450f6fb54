// Where a sum of harmonics is least: a grid that no valley slips through, then Newton's steps from those of its points
// around which the function may be lower than what was found before. Low points alone would not do: along a valley that
// is nearly level, as behind a light at a pole, all of them may lie off its lowest place, or on another valley.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "harmonics/derivatives.h"
#include "math/basis.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::harmonics {
namespace {

// With the notation of math/basis.h, f = sum over m of A_m(z) C_m(x, y) + B_m(z) S_m(x, y), where
// A_m = sum over l of c(l, m) q(l, m) and B_m the same with c(l, -m). C_m + i S_m = (x + i y)^m has
//   d/dx (C_m, S_m) = m (C_(m-1), S_(m-1)),   d/dy (C_m, S_m) = m (-S_(m-1), C_(m-1)),
// and q's derivatives obey its own recurrence, differentiated once and twice.

/// A function of z with its first two derivatives.
struct Column {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;

  void add(double factor, const Column& other) noexcept {
    value += factor * other.value;
    slope += factor * other.slope;
    curvature += factor * other.curvature;
  }
};

struct Orders {
  Column a;  ///< A_m
  Column b;  ///< B_m
};

Orders sum_over_bands(std::span<const double> coefficients, int bands, int m, double z) noexcept {
  const math::BasisRecurrence& recurrence = math::basis_constants();
  Orders sums;
  Column before;
  Column here{recurrence.start[m], 0.0, 0.0};
  for (int l = m;;) {
    const auto centre = static_cast<std::size_t>(l * (l + 1));
    const auto order = static_cast<std::size_t>(m);
    sums.a.add(coefficients[centre + order], here);
    if (m > 0) sums.b.add(coefficients[centre - order], here);
    if (++l == bands) return sums;
    const double a = recurrence.a[m][l];
    const double b = recurrence.b[m][l];
    const Column next{a * (z * here.value) - b * before.value, a * (z * here.slope + here.value) - b * before.slope,
                      a * (z * here.curvature + 2.0 * here.slope) - b * before.curvature};
    before = here;
    here = next;
  }
}

}  // namespace

HarmonicDerivatives harmonic_derivatives(std::span<const double> coefficients, int bands,
                                         const glm::dvec3& direction) noexcept {
  HarmonicDerivatives d{0.0, glm::dvec3(0.0), glm::dmat3(0.0)};
  // C and S of orders m, m - 1 and m - 2.
  double cosine[3] = {1.0, 0.0, 0.0};
  double sine[3] = {0.0, 0.0, 0.0};
  for (int m = 0; m < bands; ++m) {
    const auto [a, b] = sum_over_bands(coefficients, bands, m, direction.z);
    const double once = m;
    const double twice = once * (once - 1.0);
    d.value += a.value * cosine[0] + b.value * sine[0];
    d.gradient.x += once * (a.value * cosine[1] + b.value * sine[1]);
    d.gradient.y += once * (b.value * cosine[1] - a.value * sine[1]);
    d.gradient.z += a.slope * cosine[0] + b.slope * sine[0];
    d.hessian[0][0] += twice * (a.value * cosine[2] + b.value * sine[2]);
    d.hessian[0][1] += twice * (b.value * cosine[2] - a.value * sine[2]);
    d.hessian[0][2] += once * (a.slope * cosine[1] + b.slope * sine[1]);
    d.hessian[1][2] += once * (b.slope * cosine[1] - a.slope * sine[1]);
    d.hessian[2][2] += a.curvature * cosine[0] + b.curvature * sine[0];
    const double next_cosine = direction.x * cosine[0] - direction.y * sine[0];
    const double next_sine = direction.x * sine[0] + direction.y * cosine[0];
    cosine[2] = cosine[1];
    sine[2] = sine[1];
    cosine[1] = cosine[0];
    sine[1] = sine[0];
    cosine[0] = next_cosine;
    sine[0] = next_sine;
  }
  d.hessian[1][1] = -d.hessian[0][0];  // C_m and S_m are harmonic in the plane
  d.hessian[1][0] = d.hessian[0][1];
  d.hessian[2][0] = d.hessian[0][2];
  d.hessian[2][1] = d.hessian[1][2];
  return d;
}

}  // namespace welkin::harmonics

namespace welkin {
namespace {

/// Rings for each band above band 0. A function of band limit L is on every great circle a trigonometric polynomial of
/// degree L, whose k-th derivative is at most L^k times half its range (Bernstein). No place is farther than
/// 0.71 pi / (8 L) from a point of the grid, so the one next to the minimum is at most half L^2 / 2 times the square of
/// that, 1.95 % of the range, higher; and the parabola at that point is within half L^3 / 6 times the cube, 0.18 % of
/// the range, of the function. Both shares are rounded up, since the grid sees a little less than the range.
constexpr int kRingsPerBand = 8;
constexpr double kReach = 0.7072;  ///< in steps of the grid
constexpr double kShareOfRange = 0.025;
constexpr double kShareOffParabola = 0.0025;
constexpr double kNoGain = 1e-13;  ///< of the largest coefficient: lower than that is not looked for
constexpr int kMaxSteps = 60;

/// One channel on rings of equal latitude, `2 rings` points each.
struct Grid {
  int rings;
  std::vector<double> values;

  [[nodiscard]] int points() const noexcept { return 2 * rings; }
  [[nodiscard]] double at(int ring, int point) const noexcept {
    return values[static_cast<std::size_t>(ring * points() + point)];
  }
  [[nodiscard]] glm::dvec3 direction(int ring, int point) const noexcept {
    const math::SineCosine polar = math::sine_cosine_of_turns((ring + 0.5) / (2.0 * rings));
    const math::SineCosine azimuth = math::sine_cosine_of_turns(static_cast<double>(point) / points());
    return {polar.sine * azimuth.cosine, polar.sine * azimuth.sine, polar.cosine};
  }
};

/// On a ring Y(l, +-m) is Y(l, m) at azimuth 0 times the cosine or sine of m azimuths: sums over l first, then over m.
Grid evaluate_on_grid(const std::vector<double>& channel, int bands) {
  Grid grid{kRingsPerBand * (bands - 1), {}};
  std::vector<math::SineCosine> azimuths(static_cast<std::size_t>(grid.points()));
  for (int k = 0; k < grid.points(); ++k) {
    azimuths[static_cast<std::size_t>(k)] = math::sine_cosine_of_turns(static_cast<double>(k) / grid.points());
  }
  std::vector<double> basis(channel.size());
  std::vector<double> even(static_cast<std::size_t>(bands));
  std::vector<double> odd(static_cast<std::size_t>(bands));
  for (int ring = 0; ring < grid.rings; ++ring) {
    const math::SineCosine polar = math::sine_cosine_of_turns((ring + 0.5) / (2.0 * grid.rings));
    math::evaluate_basis(polar.sine, 0.0, polar.cosine, bands, basis.data());
    std::fill(even.begin(), even.end(), 0.0);
    std::fill(odd.begin(), odd.end(), 0.0);
    for (int l = 0; l < bands; ++l) {
      for (int m = 0; m <= l; ++m) {
        even[static_cast<std::size_t>(m)] +=
            channel[SphericalHarmonics::index(l, m)] * basis[SphericalHarmonics::index(l, m)];
        odd[static_cast<std::size_t>(m)] +=
            channel[SphericalHarmonics::index(l, -m)] * basis[SphericalHarmonics::index(l, m)];
      }
    }
    for (int k = 0; k < grid.points(); ++k) {
      double sum = even[0];
      for (int m = 1; m < bands; ++m) {
        const math::SineCosine& turn = azimuths[static_cast<std::size_t>((m * k) % grid.points())];
        sum += even[static_cast<std::size_t>(m)] * turn.cosine + odd[static_cast<std::size_t>(m)] * turn.sine;
      }
      grid.values.push_back(sum);
    }
  }
  return grid;
}

/// A function's course around a direction: along the axes of its curvature, in the tangent plane.
struct Parabola {
  glm::dvec3 axis[2];
  double slope[2];
  double curvature[2];  ///< the larger one first
};

Parabola parabola_at(const harmonics::HarmonicDerivatives& d, const glm::dvec3& n) {
  // Any two axes of the tangent plane; the larger of two cross products keeps away from zero.
  const glm::dvec3 other = std::abs(n.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 t = glm::normalize(glm::cross(other, n));
  const glm::dvec3 s = glm::cross(n, t);
  // Along the great circle through n and t the second derivative is t H t - n . gradient.
  const double radial = glm::dot(n, d.gradient);
  const double tt = glm::dot(t, d.hessian * t) - radial;
  const double ts = glm::dot(t, d.hessian * s);
  const double ss = glm::dot(s, d.hessian * s) - radial;

  // Eigenvalues mean +- half; (x, y) is the axis of the larger one, from the row that does not cancel.
  const double mean = 0.5 * (tt + ss);
  const double difference = 0.5 * (tt - ss);
  const double half = std::sqrt(difference * difference + ts * ts);
  double x = difference >= 0.0 ? difference + half : ts;
  double y = difference >= 0.0 ? ts : half - difference;
  const double length = std::sqrt(x * x + y * y);
  if (length > 0.0) {
    x /= length;
    y /= length;
  } else {
    x = 1.0;
  }
  const glm::dvec3 along = x * t + y * s;
  const glm::dvec3 across = x * s - y * t;
  return {{along, across}, {glm::dot(along, d.gradient), glm::dot(across, d.gradient)}, {mean + half, mean - half}};
}

/// The least of slope x + curvature x^2 / 2 for |x| <= reach; never above zero.
double least_within(double slope, double curvature, double reach) {
  const double down = std::abs(slope);
  if (down < curvature * reach) return -0.5 * down * down / curvature;
  return reach * (0.5 * curvature * reach - down);
}

struct Start {
  double bound;  ///< the function is nowhere lower around here
  glm::dvec3 direction;
};

/// The points of the grid around which the minimum may be, the most promising first.
std::vector<Start> starts_on_grid(const std::vector<double>& channel, int bands) {
  const Grid grid = evaluate_on_grid(channel, bands);
  const auto [least, most] = std::minmax_element(grid.values.begin(), grid.values.end());
  const double range = *most - *least;
  const double reach = kReach * std::numbers::pi / grid.rings;
  std::vector<Start> starts;
  for (int ring = 0; ring < grid.rings; ++ring) {
    for (int point = 0; point < grid.points(); ++point) {
      if (grid.at(ring, point) > *least + kShareOfRange * range) continue;
      const glm::dvec3 direction = grid.direction(ring, point);
      const harmonics::HarmonicDerivatives here = harmonics::harmonic_derivatives(channel, bands, direction);
      const Parabola parabola = parabola_at(here, direction);
      double bound = here.value - kShareOffParabola * range;
      for (int k = 0; k < 2; ++k) bound += least_within(parabola.slope[k], parabola.curvature[k], reach);
      starts.push_back({bound, direction});
    }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.bound < b.bound; });
  return starts;
}

struct Low {
  double value;
  glm::dvec3 direction;
};

/// The way from a direction to the minimum of the parabola that fits the function there, in the tangent plane; where
/// the function does not curve up the curvature is taken as its size. At most `limit` long.
glm::dvec3 newton_step(const Parabola& parabola, double limit) {
  const double sizes[2] = {std::abs(parabola.curvature[0]), std::abs(parabola.curvature[1])};
  const double floor = 1e-9 * std::max(sizes[0], sizes[1]) + std::numeric_limits<double>::min();
  glm::dvec3 step(0.0);
  for (int k = 0; k < 2; ++k) step -= (parabola.slope[k] / std::max(sizes[k], floor)) * parabola.axis[k];
  const double size = glm::length(step);
  return size > limit ? step * (limit / size) : step;
}

Low descend(const std::vector<double>& channel, int bands, Low low) {
  const double limit = 3.0 / (kRingsPerBand * bands);
  for (int count = 0; count < kMaxSteps; ++count) {
    const harmonics::HarmonicDerivatives here = harmonics::harmonic_derivatives(channel, bands, low.direction);
    low.value = here.value;
    glm::dvec3 step = newton_step(parabola_at(here, low.direction), limit);
    // The gain is of second order in the step: with 1e-9 it is below rounding.
    for (;; step *= 0.5) {
      if (!(glm::length(step) > 1e-9)) return low;
      const glm::dvec3 next = glm::normalize(low.direction + step);
      if (harmonics::harmonic_derivatives(channel, bands, next).value < low.value) {
        low.direction = next;
        break;
      }
    }
  }
  low.value = harmonics::harmonic_derivatives(channel, bands, low.direction).value;
  return low;
}

Low channel_minimum(std::vector<double> channel, int bands) {
  double largest = 0.0;
  for (const double value : channel) {
    if (!std::isfinite(value)) return {std::numeric_limits<double>::quiet_NaN(), {0, 0, 1}};
    largest = std::max(largest, std::abs(value));
  }
  if (largest == 0.0) return {0.0, {0, 0, 1}};
  for (double& value : channel) value /= largest;  // so that no square under- or overflows
  if (bands == 1) {
    double basis = 0.0;
    math::evaluate_basis(0.0, 0.0, 1.0, 1, &basis);
    return {largest * (channel[0] * basis), {0, 0, 1}};
  }
  Low best{std::numeric_limits<double>::infinity(), {0, 0, 1}};
  for (const Start& start : starts_on_grid(channel, bands)) {
    if (start.bound > best.value - kNoGain) break;
    const Low found = descend(channel, bands, {0.0, start.direction});
    if (found.value < best.value) best = found;
  }
  best.value *= largest;
  return best;
}

}  // namespace

HarmonicMinimum minimum(const SphericalHarmonics& harmonics) {
  const platform::FloatingPointScope floating_point;
  HarmonicMinimum result;
  std::vector<double> channel(harmonics.coefficients().size());
  for (int c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < channel.size(); ++k) channel[k] = harmonics.coefficients()[k][c];
    const Low low = channel_minimum(channel, harmonics.bands());
    result.value[c] = low.value;
    result.direction[c] = low.direction;
  }
  return result;
}

}  // namespace welkin
