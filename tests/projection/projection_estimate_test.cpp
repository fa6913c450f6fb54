// Promise: the error estimate of a projection is at least its true error, whatever the image is, and says no more
// than some times that where it is known: by the midpoint rule, to a target size, by all ways to a projection alike.
#include "image/geometry.h"
#include "math/elementary.h"
#include "projection/kernel_integrals.h"
#include "reference/reference_projection.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::test {

namespace {

template <class Radiance>
Cubemap cubemap_by_texels(int size, const Radiance& radiance) {
  std::vector<float> pixels;
  for (int row = 0; row < 6 * size; ++row) {
    for (int column = 0; column < size; ++column) pixels.insert(pixels.end(), 3, radiance(column, row));
  }
  return {size, pixels};
}

Cubemap checkers(int size, int period) {
  return cubemap_by_texels(
      size, [=](int column, int row) { return (column / period + row % size / period) % 2 == 0 ? 0.0F : 1.0F; });
}

template <class View>
void check_honest(const View& view, const ProjectionOptions& options, double most_times) {
  const SphericalHarmonics truth = reference_projection(view, {.bands = options.bands});
  const Projection found = project(view, options);
  const double error = relative_error(found.radiance, truth);
  CAPTURE(options.bands, options.target_size.value_or(0), error, found.diagnostics.error_estimate);
  CHECK(error <= found.diagnostics.error_estimate);
  CHECK(found.diagnostics.error_estimate <= most_times * error + 1e-6);
}

}  // namespace

// Seen: 266 times the estimate, which lacked what band 0 leaks into bands 4, 6 and 8 on a cube.
TEST_CASE("An even cubemap does not deceive the midpoint rule's estimate", "[sh][estimates][truth]") {
  for (const int size : {16, 32, 64, 128}) {
    for (const int bands : {5, 7, 9}) {
      CAPTURE(size);
      const Cubemap even = cubemap_by_texels(size, [](int, int) { return 1.0F; });
      check_honest(even.view(), {.bands = bands, .quadrature = Quadrature::midpoint}, 5.0);
    }
  }
  const Cubemap slope =
      cubemap_by_texels(64, [](int, int row) { return 1.0F + 0.02F * static_cast<float>(row) / 384.0F; });
  check_honest(slope.view(), {.bands = 5, .quadrature = Quadrature::midpoint}, 5.0);
}

TEST_CASE("No texel errs by more than the midpoint rule's estimate", "[sh][estimates]") {
  for (const int size : {1, 2, 3, 8, 21}) {
    const int half = (size + 1) / 2;
    for (const int bands : {2, 3, 5, 9}) {
      for (int texel = 0; texel<half * half; texel += size> 8 ? 3 : 1) {
        CAPTURE(size, texel);
        const int lit_row = size * (texel % 6) + texel / half;
        const Cubemap lamp = cubemap_by_texels(
            size, [=](int column, int row) { return row == lit_row && column == texel % half ? 1e6F : 1.0F; });
        const Projection found = project(lamp.view(), {.bands = bands, .quadrature = Quadrature::midpoint});
        const SphericalHarmonics truth = project(lamp.view(), {.bands = bands}).radiance;
        CHECK(relative_error(found.radiance, truth) <= found.diagnostics.error_estimate);
      }
    }
  }
}

// Regression: the error was 905 times an estimate from the coefficients alone, which do not contain a pattern that
// cells average away.
TEST_CASE("Checkers do not deceive the estimate of a target size", "[sh][target][estimates][truth]") {
  for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
    for (const int period : {1, 3}) {
      const Cubemap cubemap = checkers(72, period);
      const Cubemap half = checkers(48, period);
      const LatLongView lat_long{half.face(0), 48, 24, 0, PixelFormat::rgb32f};
      for (const int target : {4, 7, 16}) {
        CAPTURE(period);
        check_honest(cubemap.view(), {.bands = 5, .quadrature = quadrature, .target_size = target}, 1.5);
        check_honest(lat_long, {.quadrature = quadrature, .target_size = target}, 1.5);
      }
      check_honest(cubemap.view(), {.bands = 5, .quadrature = Quadrature::midpoint}, 30.0);
      check_honest(lat_long, {.bands = 5, .quadrature = Quadrature::midpoint}, 1.5);
    }
  }
}

TEST_CASE("Every way to a projection has the same estimate", "[sh][target][estimates]") {
  const Cubemap cubemap = checkers(40, 3);
  const CubemapView views[] = {cubemap.view()};
  for (const ProjectionOptions& options :
       {ProjectionOptions{.target_size = 7}, ProjectionOptions{.bands = 5, .quadrature = Quadrature::midpoint}}) {
    const double estimate = project(cubemap.view(), options).diagnostics.error_estimate;
    CHECK(estimate > 1e-6);
    CHECK(same_bits(combine(project_faces(cubemap.view(), options)).diagnostics.error_estimate, estimate));
    std::vector<dvec3> many(static_cast<std::size_t>(options.bands * options.bands));
    CHECK(same_bits(project_many(views, many, options).error_estimate, estimate));
  }
}

// Promise: one program integrates images over kernels, and its references agree: a kernel's integrals over all texels
// add up to that over the sphere, and a cosine's integral is the same under every name.

namespace {

using image::TexelGrid, projection::texel_integrals_of;

std::vector<glm::dvec3> some_axes() {
  RandomLight light(61);
  std::vector<glm::dvec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6, 0, 0.8}};
  while (axes.size() < 8) axes.push_back(light.direction());
  return axes;
}

double whole(const TexelGrid& grid, const glm::dvec3& axis, const projection::KernelFunction& kernel) {
  const auto texels = texel_integrals_of(grid);
  double sum = 0.0;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) sum += texels->integral({row, column}, axis, kernel);
  }
  return sum;
}

/// The largest |a - b| / |b|.
double worst_ratio(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b, double scale) {
  double worst = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k)
    worst = std::max(worst, glm::length(scale * a[k] - b[k]) / glm::length(b[k]));
  return worst;
}

void check_cosines(const EnvironmentView& view) {
  const std::vector<glm::dvec3> axes = some_axes();
  const std::vector<glm::dvec3> irradiance = direct_irradiance(view, axes);
  CHECK(worst_ratio(reference_specular(view, 1.0, axes), irradiance, std::numbers::pi) < 2e-5);
  CHECK(worst_ratio(reference_by_lobe(view, ZonalLobe::lambert(), axes), irradiance, std::numbers::pi) < 1e-5);
}

}  // namespace

TEST_CASE("A lobe's integrals over all texels are its integral over the sphere", "[kernel_integrals]") {
  for (const double alpha : {1.0, 0.3, 0.01}) {
    const reflections::GgxFunction kernel(alpha);
    const double expected = reflections::lobe_integral(alpha);
    for (const glm::dvec3& axis : some_axes()) {
      CAPTURE(alpha, axis.x, axis.y, axis.z);
      CHECK(whole(TexelGrid::lat_long(1, 1), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(TexelGrid::lat_long(7, 4), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(TexelGrid::lat_long(96, 40), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(TexelGrid::cubemap(1), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(TexelGrid::cubemap(12), axis, kernel) == Approx(expected).epsilon(1e-7));
    }
  }
}

TEST_CASE("The integral over a rectangle is that of its texels", "[kernel_integrals]") {
  const reflections::GgxFunction kernel(0.2);
  for (const TexelGrid& grid : {TexelGrid::lat_long(32, 16), TexelGrid::cubemap(16)}) {
    const auto texels = texel_integrals_of(grid);
    for (const glm::dvec3& axis : some_axes()) {
      double sum = 0.0;
      for (int row = 2; row < 11; ++row) {
        for (int column = 3; column < 15; ++column) sum += texels->integral({row, column}, axis, kernel);
      }
      CHECK(texels->integral({2, 3, 9, 12}, axis, kernel) == Approx(sum).epsilon(1e-6).margin(1e-12));
    }
  }
}

TEST_CASE("A cosine is the same as irradiance, as GGX of roughness 1 and as a kernel", "[kernel_integrals]") {
  check_cosines(make_lat_long(Content::high_range, 24, 12, 5).view());
  check_cosines(make_lat_long(Content::high_range, 200, 90, 5).view());
  check_cosines(make_cubemap(Content::high_range, 9, 3, 5).view());
  check_cosines(make_cubemap(Content::high_range, 64, 3, 5).view());
}

namespace {

/// The largest relative error of a lone texel's light as directions see it through GGX lobes, all about the texel and
/// from where its row stops being integrated texel by texel on.
double worst_of_lone_texel(const EnvironmentView& view, const TexelGrid& grid, int row, int column) {
  const auto texels = texel_integrals_of(grid);
  projection::TexelRow centres(static_cast<std::size_t>(grid.columns()));
  texels->fill(row, centres);
  const auto i = static_cast<std::size_t>(column);
  const glm::dvec3 centre(centres.x[i], centres.y[i], centres.z[i]);
  const glm::dvec3 aside = glm::normalize(glm::cross(centre, glm::dvec3(0.36, 0.48, 0.8)));
  std::vector<glm::dvec3> axes;
  for (const double degrees : {30.0, 50.0, 65.0}) {
    const math::SineCosine away = math::sine_cosine_of_turns(degrees / 360.0);
    for (int k = 0; k < 8; ++k) {
      const math::SineCosine about = math::sine_cosine_of_turns(k / 8.0);
      axes.push_back(away.cosine * centre +
                     away.sine * (about.cosine * aside + about.sine * glm::cross(centre, aside)));
    }
  }
  double worst = 0.0;
  for (const double roughness : {0.1, 0.2}) {
    const double alpha = roughness * roughness;
    const reflections::GgxFunction kernel(alpha);
    const std::vector<glm::dvec3> found = reference_specular(view, roughness, axes);
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const double truth = texels->integral({row, column}, axes[k], kernel) / reflections::lobe_integral(alpha);
      worst = std::max(worst, std::abs(found[k].x / truth - 1.0));
    }
  }
  return worst;
}

}  // namespace

// The value at the centroid was taken for the mean: 6.6e-5 off on cubemaps, 1.6e-4 in the long texels next to poles.
TEST_CASE("A texel afar has its share of a lobe to 5e-6, whatever its shape", "[kernel_integrals][truth]") {
  constexpr int kSize = 256;
  for (const auto& [row, column] : {std::pair{0, 0}, std::pair{128, 128}, std::pair{2 * kSize + 5, 130}}) {
    std::vector<float> pixels(std::size_t{18} * kSize * kSize);
    std::fill_n(pixels.begin() + 3 * (row * kSize + column), 3, 1.0F);
    const Cubemap lamp(kSize, pixels);
    CAPTURE(row, column);
    CHECK(worst_of_lone_texel(lamp.view(), TexelGrid::cubemap(kSize), row, column) < 5e-6);
  }
  for (const int row : {0, 1, 60, 127, 255}) {
    std::vector<float> pixels(std::size_t{3} * 2 * kSize * kSize);
    std::fill_n(pixels.begin() + std::ptrdiff_t{3} * (row * 2 * kSize + 77), 3, 1.0F);
    const LatLongView view{pixels.data(), 2 * kSize, kSize, 0, PixelFormat::rgb32f};
    CAPTURE(row);
    CHECK(worst_of_lone_texel(view, TexelGrid::lat_long(2 * kSize, kSize), row, 77) < 5e-6);
  }
}

TEST_CASE("A row's moments and solid angles are those of its areas", "[kernel_integrals]") {
  // Int d dw over the sphere is 0, and Int dw is 4 pi.
  for (const TexelGrid& grid : {TexelGrid::lat_long(5, 3), TexelGrid::cubemap(2)}) {
    const auto texels = texel_integrals_of(grid);
    projection::TexelRow row(static_cast<std::size_t>(grid.columns()));
    glm::dvec3 moment(0.0);
    double steradians = 0.0;
    for (int j = 0; j < grid.rows(); ++j) {
      texels->fill(j, row);
      for (std::size_t i = 0; i < row.x.size(); ++i) {
        moment += row.moment[i] * glm::dvec3(row.x[i], row.y[i], row.z[i]);
        steradians += row.solid_angle[i];
        CHECK(row.moment[i] < row.solid_angle[i]);
      }
    }
    CHECK(glm::length(moment) < 1e-13);
    CHECK(steradians == Approx(4.0 * std::numbers::pi).epsilon(1e-13));
  }
}

}  // namespace welkin::test
