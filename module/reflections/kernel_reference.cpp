#include "reflections/kernel_reference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kOfScale = 0.8;       ///< a part's radius that four points along an edge are enough for
constexpr double kOfBreak = 1.0 / 32;  ///< the same where a break cuts it
constexpr double kWidest = 0.1;        ///< radians: the mapping itself is smooth enough over that
constexpr int kOrder = 4;

/// A part of a texel, in units of texels: centre and half an edge.
struct Part {
  int face;
  double column, row;
  double half;
};

/// Pixels on the sphere, and the kernel about one direction.
class Texels {
 public:
  Texels(const projection::SanitizedSource& source, const Lobe& kernel)
      : source_(source), kernel_(kernel), rule_(math::gauss_legendre(kOrder)) {
    const int rows = source.rows();
    const double edge = source.cubemap() ? 2.0 / source.columns() : kPi * std::max(1.0 / rows, 2.0 / source.columns());
    radius_ = std::numbers::sqrt2 * edge;  // of a part of half an edge of 1, at most
  }

  /// Int k over a texel.
  [[nodiscard]] double integral(int row, int column, const glm::dvec3& axis) const noexcept {
    const int face = source_.cubemap() ? row / source_.columns() : 0;
    return integrate({face, column + 0.5, row - face * source_.columns() + 0.5, 0.5}, axis);
  }

 private:
  [[nodiscard]] glm::dvec3 direction(int face, double column, double row) const noexcept {
    return source_.cubemap() ? image::face_direction(source_.columns(), face, column, row)
                             : image::lat_long_direction(source_.columns(), source_.rows(), column, row);
  }

  /// Steradians a unit of area.
  [[nodiscard]] double density(double column, double row) const noexcept {
    if (!source_.cubemap()) {
      return 2.0 * kPi / source_.columns() * (kPi / source_.rows()) *
             math::sine_cosine_of_turns(0.5 * row / source_.rows()).sine;
    }
    const double per_texel = 2.0 / source_.columns();
    const double u = per_texel * column - 1.0;
    const double v = per_texel * row - 1.0;
    const double square = 1.0 + u * u + v * v;
    return per_texel * per_texel / (square * std::sqrt(square));
  }

  [[nodiscard]] double integrate(const Part& part, const glm::dvec3& axis) const noexcept {
    const double radius = radius_ * part.half;
    const glm::dvec3 chord = direction(part.face, part.column, part.row) - axis;
    const double s = std::min(1.0, 0.5 * std::sqrt(glm::dot(chord, chord)));
    const bool unseen = s - 0.5 * radius > kernel_.farthest() || s + 0.5 * radius < kernel_.nearest();
    if (unseen) return 0.0;
    const bool cut = std::any_of(kernel_.breaks().begin(), kernel_.breaks().end(),
                                 [&](double at) { return std::abs(at - s) <= 0.5 * radius; });
    if (radius > kWidest || radius > (cut ? kOfBreak : kOfScale) * kernel_.scale()) {
      double sum = 0.0;
      for (const double down : {-0.5, 0.5}) {
        for (const double across : {-0.5, 0.5})
          sum += integrate({part.face, part.column + across * part.half, part.row + down * part.half, 0.5 * part.half},
                           axis);
      }
      return sum;
    }
    double sum = 0.0;
    for (int j = 0; j < kOrder; ++j) {
      for (int i = 0; i < kOrder; ++i) {
        const double column = part.column + part.half * rule_.nodes[i];
        const double row = part.row + part.half * rule_.nodes[j];
        const glm::dvec3 apart = direction(part.face, column, row) - axis;
        sum += rule_.weights[i] * rule_.weights[j] * density(column, row) *
               kernel_.value(1.0 - 0.5 * glm::dot(apart, apart));
      }
    }
    return sum * part.half * part.half;
  }

  const projection::SanitizedSource& source_;
  const Lobe& kernel_;
  math::GaussRule rule_;
  double radius_ = 0.0;
};

glm::dvec3 integrate_towards(const projection::SanitizedSource& source, const Lobe& kernel, const glm::dvec3& axis) {
  const Texels texels(source, kernel);
  glm::dvec3 sum(0.0);
  double whole = 0.0;
  for (int row = 0; row < source.rows(); ++row) {
    const float* rgb = source.row(row);
    for (int column = 0; column < source.columns(); ++column, rgb += 3) {
      const double share = texels.integral(row, column, axis);
      whole += share;
      for (int c = 0; c < 3; ++c) sum[c] += share * static_cast<double>(rgb[c]);
    }
  }
  return sum / whole;
}

}  // namespace

std::vector<glm::dvec3> integrate_kernel(const projection::SanitizedSource& source, const Lobe& kernel,
                                         std::span<const glm::dvec3> directions, const Control& control) {
  std::vector<glm::dvec3> result(directions.size());
  constexpr auto placement = jobs::Placement::arena;
  jobs::run_tiles(directions.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    result[tile] = integrate_towards(source, kernel, directions[tile]);
                  });
  return result;
}

}  // namespace welkin::reflections
