// Grids over the sphere: borders that wrap, splines through the samples, and the faces made of them.
#include "image/sphere_grid.h"

#include <glm/glm.hpp>

#include "image/geometry.h"
#include "support/catch.h"
#include "support/images.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "transform/direct_transform.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::test {

// A grid's border holds what lies there on the sphere; its spline takes the function's values.

namespace {

using image::GridContent;
using image::SphereGrid;

/// The uniform cubic B-spline.
double cubic_weight(double distance) {
  const double x = std::abs(distance);
  if (x >= 2.0) return 0.0;
  return x >= 1.0 ? (2 - x) * (2 - x) * (2 - x) / 6 : (4 - 6 * x * x + 3 * x * x * x) / 6;
}

/// Evaluates the spline, or the bilinear interpolation, in double and without the border, at a position in columns and
/// rings that is integral at texel centres.
glm::dvec3 value_at(const SphereGrid& grid, double x, double y) {
  const bool cubic = grid.content() == GridContent::spline_coefficients;
  const int columns = grid.columns();
  const int rings = grid.rings();
  glm::dvec3 sum(0.0);
  for (int ring = static_cast<int>(std::floor(y)) - 1; ring <= std::floor(y) + 2; ++ring) {
    for (int column = static_cast<int>(std::floor(x)) - 1; column <= std::floor(x) + 2; ++column) {
      const auto weight = [&](double distance) {
        return cubic ? cubic_weight(distance) : std::max(0.0, 1.0 - std::abs(distance));
      };
      // Past a pole it continues columns / 2 further; with two rings, past both poles.
      int at_ring = ring;
      int at_column = column;
      while (at_ring < 0 || at_ring >= rings) {
        at_ring = at_ring < 0 ? -1 - at_ring : 2 * rings - 1 - at_ring;
        at_column += columns / 2;
      }
      at_column = (at_column % columns + columns) % columns;
      const float* texel = grid.texel(at_column, at_ring);
      sum += weight(x - column) * weight(y - ring) * glm::dvec3(texel[0], texel[1], texel[2]);
    }
  }
  return sum;
}

transforms::Spectrum spectrum_of_noise(int bands) {
  const TestLatLong noise = make_lat_long(Content::random, 96, 48, 11);
  return transforms::analyse(noise.view(), bands, {});
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
  const transforms::Spectrum spectrum = spectrum_of_noise(110);
  for (const int bands : {1, 2, 13, 24, 110}) {  // the last are too many for `SplineFunctions`
    const std::vector<double> zonal(static_cast<std::size_t>(bands), 1.0);
    for (const auto& [rings, columns] :
         {std::pair{1, 48}, std::pair{2, 50}, std::pair{5, 48}, std::pair{31, 64}, std::pair{32, 64}, std::pair{33, 96},
          std::pair{80, 160}, std::pair{120, 240}}) {
      if (columns < 2 * bands - 1) continue;
      CAPTURE(bands, rings, columns);
      SphereGrid samples(rings, columns, GridContent::samples);
      SphereGrid spline(rings, columns, GridContent::spline_coefficients);
      transforms::synthesise(spectrum, zonal, samples, {});
      transforms::synthesise(spectrum, zonal, spline, {});
      double most = 0.0;
      double error = 0.0;
      for (int ring = 0; ring < rings; ++ring) {
        for (int column = 0; column < columns; ++column) {
          const glm::dvec3 found = value_at(spline, column, ring);
          for (int c = 0; c < 3; ++c) {
            const double sample = samples.texel(column, ring)[c];
            most = std::max(most, std::abs(sample));
            error = std::max(error, std::abs(found[c] - sample));
          }
        }
      }
      CHECK(error < 1e-6 * most);
    }
  }
}

TEST_CASE("Between its texels the spline is as near as it is said to be", "[specular][transform][grid]") {
  // A single degree, midway between four texels: the worst positions.
  const int bands = 48;
  const transforms::Spectrum spectrum = spectrum_of_noise(bands);
  const transforms::GridSize size = transforms::grid_for_bands(bands);
  CHECK(size == transforms::GridSize{64, 128});
  const auto [degree, bound] =
      GENERATE(std::pair{8, 5e-5}, std::pair{16, 1.5e-3}, std::pair{32, 3e-2}, std::pair{47, 0.15});
  std::vector<double> zonal(static_cast<std::size_t>(bands), 0.0);
  zonal[static_cast<std::size_t>(degree)] = 1.0;
  SphereGrid spline(size.rings, size.columns, GridContent::spline_coefficients);
  transforms::synthesise(spectrum, zonal, spline, {});
  const Coefficients c = coefficients_of(spectrum);
  double squares = 0.0;
  double errors = 0.0;
  for (int ring = -1; ring < size.rings; ring += 7) {
    for (int column = -1; column < size.columns; column += 11) {
      const double theta = std::numbers::pi * (ring + 1.0) / size.rings;
      const double longitude = std::numbers::pi - 2.0 * std::numbers::pi * (column + 1.0) / size.columns;
      const double truth = direct_value(c, zonal, 0, theta, longitude);
      const double error = value_at(spline, column + 0.5, ring + 0.5).x - truth;
      squares += truth * truth;
      errors += error * error;
    }
  }
  CAPTURE(degree);
  CHECK(std::sqrt(errors / squares) < bound);
}

// Promise: faces hold a grid's function at their texels' centres, whichever the grid and the size, without seams and
// with the same bits everywhere.

namespace {

constexpr double kPi = std::numbers::pi;

using Radiance = std::function<glm::dvec3(const glm::dvec3&)>;

SphereGrid grid_of(int rings, int columns, GridContent content, const Radiance& radiance) {
  SphereGrid grid(rings, columns, content);
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) {
      const glm::dvec3 value = radiance(image::lat_long_direction(columns, rings, column + 0.5, ring + 0.5));
      for (int c = 0; c < 3; ++c) grid.texel(column, ring)[c] = static_cast<float>(value[c]);
      grid.texel(column, ring)[3] = 1e30F;  // never looked at
    }
  }
  grid.fill_sides(0, rings);
  grid.fill_poles();
  return grid;
}

SphereGrid noise_grid(int rings, int columns, GridContent content, std::uint32_t seed) {
  std::mt19937 generator(seed);
  const auto next = [&] { return static_cast<double>(generator() % 4096U) / 2048.0 - 1.0; };
  return grid_of(rings, columns, content, [&](const glm::dvec3&) {
    const double red = next();
    const double green = next();
    return glm::dvec3(red, green, next());
  });
}

std::array<float*, 6> faces_of(Cubemap& map) {
  std::array<float*, 6> faces{};
  for (std::size_t face = 0; face < 6; ++face) {
    faces[face] = map.face(0) + face * map.pixels().size() / 6;
  }
  return faces;
}

Cubemap sampled(const SphereGrid& grid, int size, const image::GridSampling& sampling = {},
                const Control& control = {}) {
  Cubemap map{size, std::vector<float>(static_cast<std::size_t>(18 * size * size), NAN)};
  image::sample_faces(grid, size, faces_of(map), sampling, control);
  return map;
}

std::vector<glm::dvec3> texels_of(const Cubemap& map) {
  std::vector<glm::dvec3> texels;
  for (std::size_t k = 0; k < map.pixels().size(); k += 3)
    texels.emplace_back(map.pixels()[k], map.pixels()[k + 1], map.pixels()[k + 2]);
  return texels;
}

/// Returns the grid's value at a direction, by libm's angles.
glm::dvec3 value_at(const SphereGrid& grid, const glm::dvec3& to) {
  return value_at(grid, (0.5 - std::atan2(to.x, to.z) / (2.0 * kPi)) * grid.columns() - 0.5,
                  std::atan2(std::hypot(to.x, to.z), to.y) / kPi * grid.rings() - 0.5);
}

double worst_component(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

TEST_CASE("Faces hold the grid's function at their texels' centres", "[faces]") {
  struct Shape {
    int rings, columns;
  };
  for (const GridContent content : {GridContent::spline_coefficients, GridContent::samples}) {
    for (const auto& [rings, columns] : {Shape{1, 2}, {2, 2}, {3, 6}, {8, 16}, {33, 70}, {200, 402}}) {
      const SphereGrid grid = noise_grid(rings, columns, content, 5);
      for (const int size : {1, 2, 3, 7, 64, 257}) {
        if (size == 257 && rings < 200) continue;
        CAPTURE(rings, columns, size);
        const std::vector<glm::dvec3> texels = texels_of(sampled(grid, size));
        const std::vector<glm::dvec3> centres = texel_centres(size);
        double worst = 0.0;
        for (std::size_t k = 0; k < texels.size(); ++k)
          worst = std::max(worst, worst_component(texels[k] - value_at(grid, centres[k])));
        CHECK(worst < 4e-7);
      }
    }
  }
}

TEST_CASE("Equal texels give equal faces, to four units in the last place", "[faces]") {
  for (const GridContent content : {GridContent::spline_coefficients, GridContent::samples}) {
    const SphereGrid grid = grid_of(30, 62, content, [](const glm::dvec3&) { return glm::dvec3(1.0, 0.1, 60000.0); });
    for (const int size : {1, 3, 64, 129}) {
      for (const glm::dvec3& texel : texels_of(sampled(grid, size)))
        REQUIRE(worst_component(texel / glm::dvec3(1.0, static_cast<double>(0.1F), 60000.0) - 1.0) < 3e-7);
    }
  }
}

TEST_CASE("A grid's quarter turn permutes the faces bit for bit", "[faces]") {
  for (const int size : {1, 2, 7, 12}) {
    const SphereGrid grid = noise_grid(40, 80, GridContent::spline_coefficients, 7);
    SphereGrid rotated(40, 80, GridContent::spline_coefficients);
    for (int ring = 0; ring < 40; ++ring) {
      for (int column = 0; column < 80; ++column) {
        std::copy_n(grid.texel((column + 20) % 80, ring), 4, rotated.texel(column, ring));
      }
    }
    rotated.fill_sides(0, 40);
    rotated.fill_poles();
    const std::vector<glm::dvec3> after = texels_of(sampled(rotated, size));
    // The texel at column + 20 has a longitude that is less by 90 degrees. (No texel's bits change here.)
    const std::vector<glm::dvec3> wanted =
        texels_of(to_cubemap(sampled(grid, size).view(), size, rotation_about_y(90.0)));
    const std::vector<glm::dvec3> centres = texel_centres(size);
    for (std::size_t k = 0; k < after.size(); ++k) {
      if (std::abs(centres[k].y) == 1.0) continue;  // the pole itself has no longitude
      REQUIRE(after[k] == wanted[k]);
    }
  }
}

TEST_CASE("Sampling a grid can be stopped", "[faces]") {
  const SphereGrid grid = noise_grid(8, 16, GridContent::samples, 1);
  stop_source stop;
  stop.request_stop();
  CHECK(thrown_by([&] { return sampled(grid, 8, {}, {stop.get_token(), {}}); }).code == ErrorCode::cancelled);
}

}  // namespace welkin::test
