// A grid's border holds what lies there on the sphere; its spline takes the function's values.
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "specular/direct_transform.h"
#include "specular/spectrum.h"
#include "support/catch.h"
#include "support/test_environments.h"

namespace welkin::test {
namespace {

using image::GridContent;
using image::SphereGrid;

/// The uniform cubic B-spline's weights at the knots and half way between: 1/6 4/6 1/6 and 1/48 23/48 23/48 1/48.
double spline_at(const SphereGrid& grid, int column, int ring, bool half_column, bool half_ring, int channel) {
  const double knot[4] = {0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  const double middle[4] = {1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0};
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const double weight = (half_column ? middle : knot)[i] * (half_ring ? middle : knot)[j];
      if (weight == 0.0) continue;
      // Half a texel on, texels -1, 0, 1, 2 meet; at a texel's centre -1, 0, 1 (weights 1 to 3).
      const int x = column + (half_column ? i - 1 : i - 2);
      const int y = ring + (half_ring ? j - 1 : j - 2);
      sum += weight * static_cast<double>(grid.texel(x, y)[channel]);
    }
  }
  return sum;
}

specular::Spectrum spectrum_of_noise(int bands) {
  const TestLatLong noise = make_lat_long(Content::random, 96, 48, 11);
  return specular::analyse(noise.view(), bands, {});
}

}  // namespace

TEST_CASE("A grid's border continues it over seam and poles", "[specular][transform][grid]") {
  for (const auto& [rings, columns] :
       {std::pair{1, 2}, std::pair{2, 2}, std::pair{3, 6}, std::pair{7, 10}, std::pair{64, 128}}) {
    CAPTURE(rings, columns);
    SphereGrid grid(rings, columns, GridContent::samples);
    for (int ring = 0; ring < rings; ++ring) {
      for (int column = 0; column < columns; ++column) {
        for (int c = 0; c < 4; ++c) grid.texel(column, ring)[c] = static_cast<float>(1000 * ring + 4 * column + c);
      }
    }
    grid.fill_sides(0, rings);
    grid.fill_poles();
    int wrong = 0;
    for (int ring = -SphereGrid::kBorder; ring < rings + SphereGrid::kBorder; ++ring) {
      for (int column = -SphereGrid::kBorder; column < columns + SphereGrid::kBorder; ++column) {
        // Along the circle through both poles: south on the near side, north on the far one.
        const int along = ((ring % (2 * rings)) + 2 * rings) % (2 * rings);
        const bool far_side = along >= rings;
        const int true_ring = far_side ? 2 * rings - 1 - along : along;
        const int true_column = (column + (far_side ? columns / 2 : 0) + 8 * columns) % columns;
        for (int c = 0; c < 4; ++c) {
          wrong += grid.texel(column, ring)[c] != static_cast<float>(1000 * true_ring + 4 * true_column + c) ? 1 : 0;
        }
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("Spline coefficients give back the samples", "[specular][transform][grid]") {
  const specular::Spectrum spectrum = spectrum_of_noise(24);
  for (const int bands : {1, 2, 13, 24}) {
    const std::vector<double> zonal(static_cast<std::size_t>(bands), 1.0);
    for (const auto& [rings, columns] : {std::pair{1, 48}, std::pair{2, 50}, std::pair{5, 48}, std::pair{31, 64},
                                         std::pair{32, 64}, std::pair{33, 96}, std::pair{80, 160}}) {
      CAPTURE(bands, rings, columns);
      SphereGrid samples(rings, columns, GridContent::samples);
      SphereGrid spline(rings, columns, GridContent::spline_coefficients);
      specular::synthesise(spectrum, zonal, samples, {});
      specular::synthesise(spectrum, zonal, spline, {});
      double most = 0.0;
      double error = 0.0;
      for (int ring = 0; ring < rings; ++ring) {
        for (int column = 0; column < columns; ++column) {
          for (int c = 0; c < 3; ++c) {
            const double sample = samples.texel(column, ring)[c];
            most = std::max(most, std::abs(sample));
            error = std::max(error, std::abs(spline_at(spline, column, ring, false, false, c) - sample));
          }
        }
      }
      CHECK(error < 1e-6 * most);
    }
  }
}

TEST_CASE("Between its texels the spline is as near as it is said to be", "[specular][transform][grid]") {
  // One degree alone, half way between four texels: the worst places.
  const int bands = 48;
  const specular::Spectrum spectrum = spectrum_of_noise(bands);
  const specular::GridSize size = specular::grid_for_bands(bands);
  CHECK(size == specular::GridSize{64, 128});
  const auto [degree, bound] =
      GENERATE(std::pair{8, 5e-5}, std::pair{16, 1.5e-3}, std::pair{32, 3e-2}, std::pair{47, 0.15});
  std::vector<double> zonal(static_cast<std::size_t>(bands), 0.0);
  zonal[static_cast<std::size_t>(degree)] = 1.0;
  SphereGrid spline(size.rings, size.columns, GridContent::spline_coefficients);
  specular::synthesise(spectrum, zonal, spline, {});
  const Coefficients c = coefficients_of(spectrum);
  double squares = 0.0;
  double errors = 0.0;
  for (int ring = -1; ring < size.rings; ring += 7) {
    for (int column = -1; column < size.columns; column += 11) {
      const double theta = std::numbers::pi * (ring + 1.0) / size.rings;
      const double longitude = std::numbers::pi - 2.0 * std::numbers::pi * (column + 1.0) / size.columns;
      const double truth = direct_value(c, zonal, 0, theta, longitude);
      const double error = spline_at(spline, column, ring, true, true, 0) - truth;
      squares += truth * truth;
      errors += error * error;
    }
  }
  CAPTURE(degree);
  CHECK(std::sqrt(errors / squares) < bound);
}

}  // namespace welkin::test
