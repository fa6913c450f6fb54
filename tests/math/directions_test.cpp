// Directions that callers give: one rule in every call that takes one.
#include "math/basis.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/importance.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

// Promise: a direction may have any finite length but 0, which changes the result by no more than rounding; one that is
// zero or not finite is refused.
namespace welkin::test {
namespace {

/// What a call makes of a direction, as numbers.
struct Taking {
  const char* name;
  std::function<std::vector<double>(const dvec3&)> call;
};

std::vector<double> numbers(const dvec3& value) { return {value.x, value.y, value.z}; }

SphericalHarmonics made_up() {
  SphericalHarmonics light(4);
  for (std::size_t k = 0; k < light.coefficients().size(); ++k) {
    light.coefficients()[k] = dvec3(std::sin(1.0 + 3.7 * static_cast<double>(k)), 0.1, 0.2 * static_cast<double>(k));
  }
  return light;
}

BakedProbes lit_probe() {
  BakedProbes probes;
  probes.bands = 3;
  const SphericalHarmonics light = resized(made_up(), 3);
  probes.coefficients.assign(light.coefficients().begin(), light.coefficients().end());
  probes.coefficients[0] = dvec3(20.0);
  probes.validity = {1.0F};
  probes.passes = {0};
  return probes;
}

std::vector<Taking> calls_about_light() {
  return {
      {"evaluate", [](const dvec3& d) { return numbers(evaluate(made_up(), d)); }},
      {"evaluate_basis",
       [](const dvec3& d) {
         std::vector<double> values(25);
         evaluate_basis(d, 5, values);
         return values;
       }},
      {"evaluate of Babylon.js's polynomial",
       [](const dvec3& d) { return numbers(evaluate(babylon_polynomial(made_up()), d)); }},
      {"sun_harmonics",
       [](const dvec3& d) {
         return numbers(sun_harmonics({.direction = d, .irradiance = dvec3(1, 2, 3)}, 3).coefficients()[7]);
       }},
      {"octahedral_encode",
       [](const dvec3& d) {
         const std::array<double, 2> place = octahedral_encode(d);
         return std::vector<double>{place[0], place[1]};
       }},
      {"probe_irradiance", [](const dvec3& d) { return numbers(probe_irradiance(lit_probe(), {}, d)); }},
  };
}

std::vector<Taking> calls_about_images() {
  const auto image = std::make_shared<LatLongImage>(grey_lat_long(16, 8, 1.0F));
  image->pixels[100] = 30.0F;
  const LatLongView view = image->view();
  const auto table = std::make_shared<ImportanceTable>(importance_table(view));
  return {
      {"direct_irradiance", [=](const dvec3& d) { return numbers(direct_irradiance(image->view(), d)); }},
      {"reference_specular", [=](const dvec3& d) { return numbers(reference_specular(image->view(), 0.5, {d})[0]); }},
      {"reference_by_lobe",
       [=](const dvec3& d) { return numbers(reference_by_lobe(image->view(), ZonalLobe::lambert(), {d})[0]); }},
      {"ImportanceTable::density", [=](const dvec3& d) { return std::vector<double>{table->density(d)}; }},
  };
}

std::vector<Taking> calls_about_skies() {
  const auto view = std::make_shared<SkyView>(small_earth(), 0.0);
  const auto curve = std::make_shared<SkyCurve>(*view, SkyCurveOptions{.nodes = 8});
  const dvec3 sun = sun_direction(30.0, 10.0);
  return {
      {"SkyView::radiance", [=](const dvec3& d) { return numbers(view->radiance(d, sun)); }},
      {"SkyView::radiance, the sun",
       [=](const dvec3& d) {
         return numbers(view->radiance({0, 1, 0}, d));
       }},
      {"SkyView::sun", [=](const dvec3& d) { return numbers(view->sun_light(d).irradiance); }},
      {"SkyView::irradiance", [=](const dvec3& d) { return numbers(view->irradiance(d)); }},
      {"SkyCurve::at", [=](const dvec3& d) { return numbers(curve->at(d).at(1, 1)); }},
      {"SkyCurve::sun_irradiance", [=](const dvec3& d) { return numbers(curve->sun_irradiance(d)); }},
  };
}

void check(const Taking& taking) {
  const std::string name = taking.name;
  const dvec3 unit = glm::normalize(dvec3(0.48, 0.6, 0.64));
  const std::vector<double> wanted = taking.call(unit);
  for (const double length : {2.0, 0.3, 1.0 + 1e-6, 1e-12, 1e200, 1e-200}) {
    CAPTURE(name, length);
    const std::vector<double> found = taking.call(length * unit);
    for (std::size_t k = 0; k < wanted.size(); ++k) CHECK(found[k] == Approx(wanted[k]).epsilon(1e-6).margin(1e-12));
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<dvec3> refused = {{0, 0, 0},       {nan, 1, 1}, {1, nan, 1},      {1, 1, nan},
                                      {nan, nan, nan}, {0, nan, 0}, {infinity, 1, 1}, {1, 1, -infinity}};
  for (const dvec3& direction : refused) {
    CAPTURE(name, direction.x, direction.y, direction.z);
    const ThrownError error = thrown_by([&] { static_cast<void>(taking.call(direction)); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("it must be finite and not zero, of any length"));
  }
}

}  // namespace

TEST_CASE("directions of any length are normalised, those without one are refused", "[directions]") {
  for (const Taking& taking : calls_about_light()) check(taking);
  for (const Taking& taking : calls_about_images()) check(taking);
  for (const Taking& taking : calls_about_skies()) check(taking);
}

TEST_CASE("directions of unit length are taken as they are, bit by bit", "[directions]") {
  std::vector<double> found(25);
  std::vector<double> wanted(25);
  for (int k = 0; k < 1000; ++k) {
    const dvec3 d = glm::normalize(dvec3(std::sin(1.0 + k), std::sin(2.0 + 3.0 * k), std::sin(3.0 + 7.0 * k)));
    evaluate_basis(d, 5, found);
    math::evaluate_basis(d.x, d.y, d.z, 5, wanted.data());
    CHECK(same_bytes<double>(found, wanted));
  }
}

TEST_CASE("directions that are refused are numbered among many", "[directions]") {
  const LatLongImage image = grey_lat_long(4, 2, 1.0F);
  const std::vector<dvec3> normals = {{0, 1, 0}, {3, 0, 0}, {0, 0, 0}};
  CHECK(thrown_by([&] { static_cast<void>(direct_irradiance(image.view(), normals)); }).says("normal 2 is (0, 0, 0)"));
  CHECK(thrown_by([&] {
          static_cast<void>(reference_specular(image.view(), 0.5, normals));
        }).says("direction 2 is (0, 0, 0)"));
}

}  // namespace welkin::test
