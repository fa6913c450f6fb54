// Promise: one program integrates pictures over kernels, and its truths agree: a kernel is shared out among all texels,
// and a cosine is the same by whatever name it comes.
#include "projection/kernel_integrals.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/test_environments.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

using projection::TexelIntegrals;

std::vector<glm::dvec3> some_axes() {
  RandomLight light(61);
  std::vector<glm::dvec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6, 0, 0.8}};
  while (axes.size() < 8) axes.push_back(light.direction());
  return axes;
}

double whole(const TexelIntegrals& texels, const glm::dvec3& axis, const projection::KernelFunction& kernel) {
  double sum = 0.0;
  for (int row = 0; row < texels.rows(); ++row) {
    for (int column = 0; column < texels.columns(); ++column) sum += texels.integral({row, column}, axis, kernel);
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

template <class View>
void check_cosines(const View& view) {
  const std::vector<glm::dvec3> axes = some_axes();
  const std::vector<glm::dvec3> irradiance = direct_irradiance(view, axes);
  CHECK(worst_ratio(reference_specular(view, 1.0, axes), irradiance, std::numbers::pi) < 2e-5);
  CHECK(worst_ratio(reference_by_kernel(view, ZonalKernel::lambert(), axes), irradiance, std::numbers::pi) < 1e-5);
}

}  // namespace

TEST_CASE("A lobe's integrals over all texels are its integral over the sphere", "[kernel_integrals]") {
  for (const double alpha : {1.0, 0.3, 0.01}) {
    const reflections::GgxFunction kernel(alpha);
    const double expected = reflections::lobe_integral(alpha);
    for (const glm::dvec3& axis : some_axes()) {
      CAPTURE(alpha, axis.x, axis.y, axis.z);
      CHECK(whole(*projection::texels_of_lat_long(1, 1), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(*projection::texels_of_lat_long(7, 4), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(*projection::texels_of_lat_long(96, 40), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(*projection::texels_of_cubemap(1), axis, kernel) == Approx(expected).epsilon(1e-7));
      CHECK(whole(*projection::texels_of_cubemap(12), axis, kernel) == Approx(expected).epsilon(1e-7));
    }
  }
}

TEST_CASE("The integral over a rectangle is that of its texels", "[kernel_integrals]") {
  const reflections::GgxFunction kernel(0.2);
  for (const auto& texels : {projection::texels_of_lat_long(32, 16), projection::texels_of_cubemap(16)}) {
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

TEST_CASE("A row's moments and solid angles are those of its areas", "[kernel_integrals]") {
  // Int d dw over the sphere is 0, and Int dw is 4 pi.
  for (const auto& texels : {projection::texels_of_lat_long(5, 3), projection::texels_of_cubemap(2)}) {
    projection::TexelRow row(static_cast<std::size_t>(texels->columns()));
    glm::dvec3 moment(0.0);
    double steradians = 0.0;
    for (int j = 0; j < texels->rows(); ++j) {
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
