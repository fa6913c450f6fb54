// Coefficients of spherical harmonics, and the forms that engines need.
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "calls.h"
#include "support/random_harmonics.h"
#include "welkin/engines.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// Coefficients that a thread which flushes denormals takes for zero.
SphericalHarmonics faint(const SphericalHarmonics& light) { return scale(light, glm::dvec3(1e-310)); }

/// Calls the functions that are linear in coefficients.
void call_linear(Calls& calls, const SphericalHarmonics& a, const SphericalHarmonics& b) {
  const glm::dvec3 direction(0.36, -0.48, 0.8);
  const glm::dquat rotation(0.4, 0.2, -0.4, 0.8);
  const glm::dvec3 colour(0.1, 1.7, 3.3);
  calls.call("evaluate(SphericalHarmonics const&, dvec3", [&] { return evaluate(a, direction); });
  calls.call("evaluate(SphericalHarmonics const&, span", [&] {
    dvec3 value;
    evaluate(a, {&direction, 1}, {&value, 1});
    return value;
  });
  calls.call("irradiance_from_radiance(", [&] { return irradiance_from_radiance(a); });
  calls.call("lambertian_from_irradiance(", [&] { return lambertian_from_irradiance(a); });
  calls.call("mean_radiance(", [&] { return mean_radiance(a); });
  calls.call("exposure_of(SphericalHarmonics", [&] { return exposure_of(a); });
  calls.call("rotate(SphericalHarmonics const&, Quaternion", [&] { return rotate(a, rotation); });
  calls.call("rotate(SphericalHarmonics const&, glm::mat",
             [&] { return rotate(a, glm::dmat3(0.6, 0.0, 0.8, 0.0, 1.0, 0.0, 0.8, 0.0, -0.6)); });
  calls.call("add(", [&] { return add(a, b); });
  calls.call("scale(", [&] { return scale(a, colour); });
  calls.call("lerp(", [&] { return lerp(a, b, 0.3); });
  calls.call("resized(", [&] { return resized(a, 7); });
  calls.call("product(", [&] { return product(a, b, 6); });

  const BabylonPolynomial polynomial = calls.call("babylon_polynomial(", [&] { return babylon_polynomial(a); });
  calls.call("evaluate(BabylonPolynomial", [&] { return evaluate(polynomial, direction); });
  for (const Convention& convention : conventions()) {
    if (!has_engine_light(convention.engine)) continue;
    calls.call("engine_light(", [&] { return engine_light(a, convention.engine); });
    calls.call("engine_light_unrotated(", [&] { return engine_light_unrotated(a, convention.engine); });
  }
}

}  // namespace

void call_harmonics(Calls& calls) {
  const SphericalHarmonics a = RandomLight(1).harmonics(5);
  const SphericalHarmonics b = RandomLight(2).harmonics(4);
  call_linear(calls, a, b);
  call_linear(calls, faint(a), b);

  const glm::dvec3 direction(0.36, -0.48, 0.8);
  const glm::dvec3 colour(0.1, 1.7, 3.3);
  calls.call("evaluate_basis(", [&] {
    std::vector<double> values(64);
    evaluate_basis(direction, 8, values);
    return values;
  });
  calls.call("cosine_lobe(", [&] { return cosine_lobe(8); });
  calls.call("rotation_about_y(", [] { return rotation_about_y(33.3); });
  calls.refused("rotate(SphericalHarmonics const&, glm::mat", [&] { static_cast<void>(rotate(a, glm::dmat3(0.3))); });

  calls.call("minimum(", [&] { return minimum(a); });
  SphericalHarmonics light = a;
  light.at(0, 0) = glm::dvec3(2.1, 2.2, 2.3);  // else there is no light that a window could keep above zero
  for (const Window window : {Window::hanning, Window::lanczos, Window::min_laplacian}) {
    calls.call("apply_window(", [&] { return apply_window(light, window); });
  }
  calls.call("dominant_light(", [&] { return dominant_light(light); });
  Sun sun;
  sun.direction = direction;
  sun.irradiance = colour;
  calls.call("sun_harmonics(", [&] { return sun_harmonics(sun, 4); });
}

}  // namespace welkin::test
