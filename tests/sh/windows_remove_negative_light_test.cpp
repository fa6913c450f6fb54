// Promise: each window's factors are its formula's; the least window is the least that leaves no irradiance negative.
#include <cmath>
#include <limits>

#include "sh/least_window.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/windowing.h"

namespace welkin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A sky of radiance 1 with a sun of `irradiance`.
SphericalHarmonics sunny(const glm::dvec3& direction, const glm::dvec3& irradiance, int bands) {
  return add(constant_radiance(glm::dvec3(1.0), bands), point_light(direction, irradiance, bands));
}

glm::dvec3 least_irradiance(const SphericalHarmonics& radiance, double lambda) {
  std::vector<double> factors;
  for (int l = 0; l < radiance.bands(); ++l) factors.push_back(sh::least_window_factor(l, lambda));
  return minimum(irradiance_from_radiance(sh::with_factors(radiance, factors))).value;
}

double smallest(const glm::dvec3& v) { return std::min({v.x, v.y, v.z}); }

}  // namespace

TEST_CASE("The factors of every window are its formula's", "[sh][window]") {
  const SphericalHarmonics light = sunny({0, 1, 0}, {100, 90, 80}, 6);
  for (const double width : {0.0, 0.5, 2.0, 3.7, 6.0, 20.0}) {
    const double w = width > 0.0 ? width : 6.0;
    const Windowed hanning = apply_window(light, Window::hanning, width);
    const Windowed lanczos = apply_window(light, Window::lanczos, width);
    CHECK(hanning.parameter == w);
    CHECK(lanczos.parameter == w);
    for (int l = 0; l < 6; ++l) {
      const double x = kPi * l / w;
      CAPTURE(width, l);
      const auto band = static_cast<std::size_t>(l);
      CHECK(hanning.factors[band] == Approx(l < w ? (1.0 + std::cos(x)) / 2.0 : 0.0).margin(1e-15));
      CHECK(lanczos.factors[band] == Approx(l == 0 ? 1.0 : l < w ? std::sin(x) / x : 0.0).margin(1e-15));
      for (int m = -l; m <= l; ++m) {
        CHECK(hanning.radiance.at(l, m) == light.at(l, m) * hanning.factors[band]);
        CHECK(lanczos.radiance.at(l, m) == light.at(l, m) * lanczos.factors[band]);
      }
    }
  }
  const Windowed none = apply_window(light, Window::none);
  CHECK(same_bits(none.radiance, light));
  CHECK(none.parameter == 0.0);
  CHECK(none.factors == std::vector<double>(6, 1.0));
  CHECK(none.minimum_before == none.minimum_after);
  const Windowed least = apply_window(light, Window::least);
  for (int l = 0; l < 6; ++l) {
    CHECK(least.factors[static_cast<std::size_t>(l)] ==
          Approx(1.0 / (1.0 + least.parameter * l * l * (l + 1) * (l + 1))).epsilon(1e-15));
  }
}

TEST_CASE("Three bands of a sun are negative behind it, by a known amount", "[sh][window]") {
  // E(c) = 1/4 + c/2 + (5/16) (3 c^2 - 1) / 2 times the sun's irradiance, least at c = -8/15: -19/480.
  const SphericalHarmonics sun = point_light(glm::normalize(glm::dvec3(1, 2, 3)), {1, 10, 1e6}, 3);
  const glm::dvec3 least = apply_window(sun, Window::none).minimum_before;
  CHECK(glm::length(least / glm::dvec3(1, 10, 1e6) + 19.0 / 480.0) < 1e-13);
  // Two bands: 1/4 - 1/2 opposite the sun.
  CHECK(apply_window(with_bands(sun, 2), Window::none).minimum_before.x == Approx(-0.25).epsilon(1e-13));
}

TEST_CASE("The least window of a lone sun in two bands is known", "[sh][window]") {
  // 1/4 - w/2 >= 0: w = 1/2 = 1 / (1 + 4 lambda), lambda = 1/4.
  const Windowed found = apply_window(point_light({0, 0, 1}, {1, 2, 3}, 2), Window::least);
  CHECK(found.parameter == Approx(0.25).epsilon(1e-8));
  CHECK(found.factors[1] == Approx(0.5).epsilon(1e-8));
}

TEST_CASE("The least window is found where the minimum falls before it rises", "[sh][window]") {
  // Irradiance 1/2 + z + 0.3 (3 z^2 - 1) / 2: least at z = -1, where the window takes band 2's help away first.
  const auto light = [](double constant) {
    SphericalHarmonics radiance(3);
    radiance.at(0, 0) = glm::dvec3(constant / (cosine_lobe(0) * std::sqrt(1.0 / (4.0 * kPi))));
    radiance.at(1, 0) = glm::dvec3(1.0 / (cosine_lobe(1) * std::sqrt(3.0 / (4.0 * kPi))));
    radiance.at(2, 0) = glm::dvec3(0.3 / (cosine_lobe(2) * std::sqrt(5.0 / (4.0 * kPi))));
    return radiance;
  };
  CHECK(least_irradiance(light(0.5), 0.0).x == Approx(-0.2).epsilon(1e-12));
  CHECK(least_irradiance(light(0.5), 0.01).x < -0.24);
  for (const double constant : {0.2, 0.5, 0.69}) {
    const double lambda = apply_window(light(constant), Window::least).parameter;
    CAPTURE(constant, lambda);
    CHECK(std::abs(constant - 1.0 / (1.0 + 4.0 * lambda) + 0.3 / (1.0 + 36.0 * lambda)) < 1e-9);
    CHECK(least_irradiance(light(constant), 0.999 * lambda).x < 0.0);
  }
  CHECK(apply_window(light(0.7001), Window::least).parameter == 0.0);  // although windows in between would ring
}

TEST_CASE("The least window leaves nothing negative, and a lesser one does", "[sh][window]") {
  RandomLight light(41);
  for (const int bands : {2, 3, 4, 5, 7, 16}) {
    for (const double strength : {6.0, 20.0, 1e3, 222208.0, 1e30}) {
      const SphericalHarmonics radiance =
          add(sunny(light.direction(), strength * glm::dvec3(1.0, 0.8, 0.6), bands),
              scale(point_light(light.direction(), glm::dvec3(0.3, 0.5, 0.4), bands), glm::dvec3(strength)));
      const Windowed found = apply_window(radiance, Window::least);
      const glm::dvec3 mean = kPi * average_radiance(radiance);
      CAPTURE(bands, strength, found.parameter);
      for (int c = 0; c < 3; ++c) CHECK(found.minimum_after[c] >= -1e-9 * mean[c]);
      CHECK(average_radiance(found.radiance) == average_radiance(radiance));
      if (smallest(found.minimum_before / mean) >= -1e-9) {
        CHECK(found.parameter == 0.0);
        CHECK(same_bits(found.radiance, radiance));
        continue;
      }
      CHECK(found.parameter > 0.0);
      for (const double share : {0.0, 0.1, 0.5, 0.9, 0.99, 0.99999}) {
        CHECK(smallest(least_irradiance(radiance, share * found.parameter) / mean) < -1e-9);
      }
    }
  }
}

TEST_CASE("The least window is the same for the turned light", "[sh][window]") {
  RandomLight light(42);
  for (const int bands : {3, 5}) {
    const SphericalHarmonics radiance = sunny(light.direction(), {90, 80, 70}, bands);
    const double lambda = apply_window(radiance, Window::least).parameter;
    for (int k = 0; k < 5; ++k) {
      CHECK(apply_window(rotate(radiance, light.turn()), Window::least).parameter == Approx(lambda).epsilon(1e-7));
    }
  }
}

TEST_CASE("The least window does not depend on the light's unit, and is 0 where nothing is negative", "[sh][window]") {
  RandomLight light(43);
  const SphericalHarmonics radiance = sunny(light.direction(), {90, 80, 70}, 3);
  const double lambda = apply_window(radiance, Window::least).parameter;
  for (const double size : {0x1p100, 0x1p-100}) {
    CHECK(apply_window(scale(radiance, glm::dvec3(size)), Window::least).parameter == lambda);
  }
  CHECK(apply_window(sunny({1, 0, 0}, {1, 1, 1}, 3), Window::least).parameter == 0.0);
  CHECK(apply_window(SphericalHarmonics(16), Window::least).parameter == 0.0);
  CHECK(apply_window(constant_radiance({1, 0, 2}, 16), Window::least).parameter == 0.0);
}

TEST_CASE("One channel that is dark does not hinder the others", "[sh][window]") {
  const Windowed found = apply_window(point_light({0, 1, 0}, {5, 0, 1}, 3), Window::least);
  CHECK(found.parameter > 0.0);
  CHECK(found.minimum_after.g == 0.0);
}

TEST_CASE("Wider windows keep more, and each lifts the minimum behind a sun", "[sh][window]") {
  const SphericalHarmonics sun = sunny({0, 1, 0}, {1000, 900, 800}, 3);
  const Windowed least = apply_window(sun, Window::least);
  for (const Window window : {Window::hanning, Window::lanczos}) {
    const Windowed narrow = apply_window(sun, window, 1.5);
    CHECK(narrow.minimum_after.r > narrow.minimum_before.r);
    CHECK(norm(narrow.radiance) < norm(apply_window(sun, window, 5.0).radiance));
  }
  CHECK(std::string(name(Window::least)) == "least");
  CHECK(least.minimum_before.r < 0.0);
}

TEST_CASE("Windows that cannot be are refused, with what would do", "[sh][window]") {
  const SphericalHarmonics sun = sunny({0, 1, 0}, {10, 10, 10}, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double width : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    const ThrownError error = thrown_by([&] { (void)apply_window(sun, Window::hanning, width); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("width"));
  }
  const ThrownError negative = thrown_by([&] { (void)apply_window(constant_radiance({1, -1, 1}, 3), Window::least); });
  CHECK(negative.code == ErrorCode::invalid_argument);
  CHECK(negative.says("green"));
  CHECK(negative.says("NegativePolicy::replace"));
  SphericalHarmonics no_mean = sun;
  no_mean.at(0, 0).b = 0.0;
  CHECK(thrown_by([&] { (void)apply_window(no_mean, Window::least); }).says("blue"));
  SphericalHarmonics broken = sun;
  broken.at(1, 0).r = nan;
  CHECK(thrown_by([&] { (void)apply_window(broken, Window::least); }).says("not finite"));
}

}  // namespace welkin::test
