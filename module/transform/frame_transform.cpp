#include "transform/frame_transform.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <numbers>

#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::transforms {

/// A quadrature over the sphere that is exact for products of two harmonics of as many bands: Gauss points in z, twice
/// as many even azimuths as bands.
struct SphereRule {
  explicit SphereRule(int its_bands) : bands(its_bands) {
    const auto count = static_cast<std::size_t>(bands * bands);
    // Products of two harmonics have degrees up to 2 bands - 2: `bands` Gauss points are exact up to 2 bands - 1 in z,
    // and 2 bands equal azimuths for orders up to 2 bands - 1.
    const math::GaussRule rule = math::gauss_legendre(bands);
    const int azimuths = 2 * bands;
    for (int i = 0; i < rule.order; ++i) {
      const double z = rule.nodes[i];
      const double ring = std::sqrt(1.0 - z * z);
      const double weight = rule.weights[i] * 2.0 * std::numbers::pi / azimuths;
      for (int k = 0; k < azimuths; ++k) {
        const math::SineCosine azimuth = math::sine_cosine_of_turns((k + 0.5) / azimuths);
        Point& point = points.emplace_back(Point{ring * azimuth.cosine, ring * azimuth.sine, z, weight, {}});
        point.harmonics.resize(count);
        math::evaluate_basis(point.x, point.y, z, bands, point.harmonics.data());
      }
    }
  }

  struct Point {
    double x, y, z;
    double weight;
    std::vector<double> harmonics;  ///< [bands^2], at this point
  };
  int bands;
  std::vector<Point> points;
};

namespace {

constexpr image::Frame kLatLong{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};

/// All seven transforms for one number of bands.
struct Transforms {
  explicit Transforms(int bands) {
    const SphereRule rule(bands);
    for (int face = 0; face < 6; ++face) faces.emplace_back(image::face_frame(face), rule);
    lat_long = FrameTransform(kLatLong, rule);
  }
  std::vector<FrameTransform> faces;
  FrameTransform lat_long;
};

const Transforms& transforms(int bands) {
  // Never destroyed: a worker's thread may still compute while the program exits.
  static std::array<std::once_flag, kMaximumBands + 1> built;
  static auto& all = *new std::array<std::unique_ptr<const Transforms>, kMaximumBands + 1>;
  const auto index = static_cast<std::size_t>(bands);
  std::call_once(built[index], [&] { all[index] = std::make_unique<const Transforms>(bands); });
  return *all[index];
}

}  // namespace

// T_l[m][m'] = Int Y(l, m)(frame d) Y(l, m')(d) dd. The integrand is a polynomial of degree 2l, which the rule
// integrates exactly. Harmonics of different degrees do not mix. Entries are sums of products of a few square roots;
// what is not one is rounding and dropped.
FrameTransform::FrameTransform(const image::Frame& frame, const SphereRule& rule)
    : functions_(rule.bands * rule.bands) {
  const auto count = static_cast<std::size_t>(functions_);
  const int bands = rule.bands;
  std::vector<double> matrix(count * count);
  std::vector<double> canonical(count);
  for (const SphereRule::Point& point : rule.points) {
    const glm::dvec3 world = point.x * frame.u + point.y * frame.v + point.z * frame.normal;
    math::evaluate_basis(world.x, world.y, world.z, bands, canonical.data());
    for (std::size_t first = 0, end = 1, width = 1; first < count; first = end, width += 2, end += width) {
      for (std::size_t row = first; row < end; ++row) {
        for (std::size_t column = first; column < end; ++column)
          matrix[row * count + column] += point.weight * canonical[row] * point.harmonics[column];
      }
    }
  }
  constexpr double rounding = 1e-13;
  for (int l = 0; l < bands; ++l) {
    for (int row = l * l; row < (l + 1) * (l + 1); ++row) {
      for (int column = l * l; column < (l + 1) * (l + 1); ++column) {
        const double factor = matrix[static_cast<std::size_t>(row) * count + static_cast<std::size_t>(column)];
        if (std::abs(factor) > rounding) entries_.push_back({row, column, factor});
      }
    }
  }
}

void FrameTransform::add(const double* local, const int* rows, double* canonical) const noexcept {
  for (int channel = 0; channel < 3; ++channel) {
    const double* const from = local + channel * functions_;
    double* const to = canonical + channel * functions_;
    // f = sum of local c' Y' gives c = Int f Y = sum of c' Int Y' Y: the matrix times the local coefficients.
    for (const Entry& entry : entries_) to[entry.canonical] += entry.factor * from[rows[entry.local]];
  }
}

const FrameTransform& face_transform(int face, int bands) {
  return transforms(bands).faces[static_cast<std::size_t>(face)];
}

const FrameTransform& lat_long_transform(int bands) { return transforms(bands).lat_long; }

}  // namespace welkin::transforms
