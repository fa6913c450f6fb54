// The minimum of harmonics, and the windows that keep light from being negative.
#include "harmonics/windowing.h"

#include "harmonics/derivatives.h"
#include "math/elementary.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: the minimum over the sphere is the global one, to rounding, at the direction that is named.

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Returns the lowest values of a dense grid: above the true minimum by about (bands / points)^2.
glm::dvec3 lowest_of_dense_grid(const SphericalHarmonics& harmonics, int rings) {
  glm::dvec3 lowest(std::numeric_limits<double>::infinity());
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = kPi * ring / rings;
    for (int k = 0; k < 2 * rings; ++k) {
      const double azimuth = kPi * k / rings;
      lowest = glm::min(lowest, evaluate(harmonics, {std::sin(polar) * std::cos(azimuth),
                                                     std::sin(polar) * std::sin(azimuth), std::cos(polar)}));
    }
  }
  return lowest;
}

}  // namespace

TEST_CASE("No point of a dense grid is lower than the minimum, and one is nearly as low", "[sh][minimum]") {
  RandomLight light(31);
  for (const int bands : {1, 2, 3, 4, 5, 8, 16}) {
    for (int k = 0; k < (bands > 5 ? 2 : 10); ++k) {
      const SphericalHarmonics harmonics = light.harmonics(bands);
      const HarmonicMinimum found = minimum(harmonics);
      const int rings = 20 * bands;
      const glm::dvec3 lowest = lowest_of_dense_grid(harmonics, rings);
      CAPTURE(bands, k);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.value[c] <= lowest[c] + 1e-12);
        CHECK(found.value[c] >= lowest[c] - 0.01 * norm(harmonics));
        CHECK(std::abs(evaluate(harmonics, found.direction[c])[c] - found.value[c]) < 1e-12 * norm(harmonics));
        CHECK(glm::length(found.direction[c]) == Approx(1.0).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("The minimum turns with the light and does not change", "[sh][minimum]") {
  RandomLight light(32);
  for (const int bands : {2, 3, 5, 16}) {
    const SphericalHarmonics harmonics = light.harmonics(bands);
    const HarmonicMinimum before = minimum(harmonics);
    for (int k = 0; k < 5; ++k) {
      const glm::dquat rotation = light.rotation();
      const HarmonicMinimum after = minimum(rotate(harmonics, rotation));
      for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(after.value[c] - before.value[c]) < 1e-12);
        CHECK(glm::length(after.direction[c] - rotation * before.direction[c]) < 1e-6);
      }
    }
  }
}

TEST_CASE("Minima known in closed form are found, on rings and at poles too", "[sh][minimum]") {
  RandomLight light(33);
  for (int k = 0; k < 20; ++k) {
    const glm::dquat rotation = k == 0 ? glm::dquat(1, 0, 0, 0) : light.rotation();
    SphericalHarmonics linear(2);
    linear.at(1, 0) = {1.0, -2.0, 0.0};
    linear = rotate(linear, rotation);
    const double y1 = std::sqrt(3.0 / (4.0 * kPi));
    CHECK(glm::length(minimum(linear).value - glm::dvec3(-y1, -2.0 * y1, 0.0)) < 1e-14);

    SphericalHarmonics zonal(3);  // sqrt(5 / 16 pi) (3 z^2 - 1): a ring of minima, or two poles if negative
    zonal.at(2, 0) = {1.0, -1.0, 1e-30};
    zonal = rotate(zonal, rotation);
    const double y2 = std::sqrt(5.0 / (16.0 * kPi));
    const glm::dvec3 found = minimum(zonal).value;
    CHECK(std::abs(found.x + y2) < 1e-14);
    CHECK(std::abs(found.y + 2.0 * y2) < 1e-14);
  }
}

TEST_CASE("Of several valleys that run around the sphere, level or nearly so, the lowest place is found",
          "[sh][minimum][truth]") {
  RandomLight light(41);
  for (const int bands : {3, 5, 8, 12}) {
    for (int k = 0; k < trials(16); ++k) {
      SphericalHarmonics zonal(bands);
      for (int l = 0; l < bands; ++l) zonal.at(l, 0) = (k % 2 == 0 || l % 2 == 0 ? 1.0 : 1e-4) * light.colour();
      if (k % 4 >= 2) {
        for (int l = 1; l < bands; ++l) zonal.at(l, 1) = 1e-5 * light.colour();
      }
      const HarmonicMinimum found = minimum(zonal);
      const int steps = 500;
      glm::dvec3 lowest(std::numeric_limits<double>::infinity());
      for (int i = -steps; i <= steps; ++i) {
        const double polar = kPi * i / steps;
        lowest = glm::min(lowest, evaluate(zonal, {std::sin(polar), 0.0, std::cos(polar)}));
      }
      CAPTURE(bands, k);
      for (int c = 0; c < 3; ++c) CHECK(found.value[c] <= lowest[c] + 1e-12);
    }
  }
}

TEST_CASE("Light of any size, none and no number have their minima", "[sh][minimum]") {
  RandomLight light(34);
  const SphericalHarmonics harmonics = light.harmonics(3);
  const HarmonicMinimum found = minimum(harmonics);
  for (const double size : {0x1p100, 0x1p-100, 0x1p900, 0x1p-900}) {
    const HarmonicMinimum scaled = minimum(scale(harmonics, glm::dvec3(size)));
    for (int c = 0; c < 3; ++c) CHECK(scaled.value[c] == Approx(found.value[c] * size).epsilon(1e-13));
  }
  CHECK(minimum(SphericalHarmonics(16)).value == glm::dvec3(0.0));
  const glm::dvec3 constant = minimum(constant_radiance({1, -2, 0}, 16)).value;
  CHECK(glm::length(constant - glm::dvec3(1, -2, 0)) < 1e-14);
  SphericalHarmonics broken = harmonics;
  broken.at(2, 1).g = std::numeric_limits<double>::quiet_NaN();
  broken.at(2, 1).b = -std::numeric_limits<double>::infinity();
  CHECK(minimum(broken).value.r == found.value.r);
  CHECK(std::isnan(minimum(broken).value.g));
  CHECK(std::isnan(minimum(broken).value.b));
}

TEST_CASE("Slopes and curvatures agree with differences", "[sh][minimum]") {
  RandomLight light(35);
  for (const int bands : {1, 2, 3, 8, 16}) {
    std::vector<double> channel(static_cast<std::size_t>(bands * bands));
    for (double& value : channel) value = light.number();
    const glm::dvec3 d = light.direction();
    const auto at = [&](const glm::dvec3& p) { return harmonics::harmonic_derivatives(channel, bands, p); };
    const harmonics::HarmonicDerivatives here = at(d);
    const double step = 1e-5;
    const double size = std::pow(bands, 4.0);  // third derivatives grow so
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 along(0.0);
      along[i] = step;
      const harmonics::HarmonicDerivatives ahead = at(d + along);
      const harmonics::HarmonicDerivatives behind = at(d - along);
      CAPTURE(bands, i);
      CHECK(std::abs((ahead.value - behind.value) / (2.0 * step) - here.gradient[i]) < 1e-8 * size);
      CHECK(glm::length((ahead.gradient - behind.gradient) / (2.0 * step) - here.hessian[i]) < 1e-7 * size);
    }
  }
}

// Promise: each window's factors are its formula's; the minimum-Laplacian window is the gentlest that leaves no
// irradiance negative.

namespace {

/// A sky of radiance 1 with a sun of `irradiance`.
SphericalHarmonics sunny(const glm::dvec3& direction, const glm::dvec3& irradiance, int bands) {
  return add(constant_radiance(glm::dvec3(1.0), bands), point_light(direction, irradiance, bands));
}

glm::dvec3 lowest_irradiance(const SphericalHarmonics& radiance, double lambda) {
  std::vector<double> factors;
  for (int l = 0; l < radiance.bands(); ++l) factors.push_back(harmonics::min_laplacian_factor(l, lambda));
  return minimum(irradiance_from_radiance(harmonics::with_factors(radiance, factors))).value;
}

double smallest(const glm::dvec3& v) { return std::min({v.x, v.y, v.z}); }

}  // namespace

TEST_CASE("The factors of every window are its formula's", "[sh][window]") {
  const SphericalHarmonics light = sunny({0, 1, 0}, {100, 90, 80}, 6);
  for (const double width : {0.0, 0.5, 2.0, 3.7, 6.0, 20.0}) {
    const double w = width > 0.0 ? width : 6.0;
    const WindowResult hanning = apply_window(light, Window::hanning, width);
    const WindowResult lanczos = apply_window(light, Window::lanczos, width);
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
  const WindowResult none = apply_window(light, Window::none);
  CHECK(same_bits(none.radiance, light));
  CHECK(none.parameter == 0.0);
  CHECK(none.factors == std::vector<double>(6, 1.0));
  CHECK(none.minimum_before == none.minimum_after);
  const WindowResult laplacian = apply_window(light, Window::min_laplacian);
  for (int l = 0; l < 6; ++l) {
    CHECK(laplacian.factors[static_cast<std::size_t>(l)] ==
          Approx(1.0 / (1.0 + laplacian.parameter * l * l * (l + 1) * (l + 1))).epsilon(1e-15));
  }
}

TEST_CASE("The minimum-Laplacian window is found where the minimum falls before it rises", "[sh][window]") {
  // Irradiance 1/2 + z + 0.3 (3 z^2 - 1) / 2: lowest at z = -1, where the window first reduces band 2, which raises it.
  const auto light = [](double constant) {
    SphericalHarmonics radiance(3);
    radiance.at(0, 0) = glm::dvec3(constant / (cosine_lobe(0) * std::sqrt(1.0 / (4.0 * kPi))));
    radiance.at(1, 0) = glm::dvec3(1.0 / (cosine_lobe(1) * std::sqrt(3.0 / (4.0 * kPi))));
    radiance.at(2, 0) = glm::dvec3(0.3 / (cosine_lobe(2) * std::sqrt(5.0 / (4.0 * kPi))));
    return radiance;
  };
  CHECK(lowest_irradiance(light(0.5), 0.0).x == Approx(-0.2).epsilon(1e-12));
  CHECK(lowest_irradiance(light(0.5), 0.01).x < -0.24);
  for (const double constant : {0.2, 0.5, 0.69}) {
    const double lambda = apply_window(light(constant), Window::min_laplacian).parameter;
    CAPTURE(constant, lambda);
    CHECK(std::abs(constant - 1.0 / (1.0 + 4.0 * lambda) + 0.3 / (1.0 + 36.0 * lambda)) < 1e-9);
    CHECK(lowest_irradiance(light(constant), 0.999 * lambda).x < 0.0);
  }
  CHECK(apply_window(light(0.7001), Window::min_laplacian).parameter == 0.0);  // although windows in between would ring
}

TEST_CASE("The minimum-Laplacian window leaves nothing negative, and a lesser one does", "[sh][window][truth]") {
  RandomLight light(41);
  for (const int bands : {2, 3, 4, 5, 7, 16}) {
    for (const double strength : {6.0, 20.0, 1e3, 222208.0, 1e30}) {
      const SphericalHarmonics radiance =
          add(sunny(light.direction(), strength * glm::dvec3(1.0, 0.8, 0.6), bands),
              scale(point_light(light.direction(), glm::dvec3(0.3, 0.5, 0.4), bands), glm::dvec3(strength)));
      const WindowResult found = apply_window(radiance, Window::min_laplacian);
      const glm::dvec3 mean = kPi * mean_radiance(radiance);
      CAPTURE(bands, strength, found.parameter);
      for (int c = 0; c < 3; ++c) CHECK(found.minimum_after[c] >= -1e-9 * mean[c]);
      CHECK(mean_radiance(found.radiance) == mean_radiance(radiance));
      if (smallest(found.minimum_before / mean) >= -1e-9) {
        CHECK(found.parameter == 0.0);
        CHECK(same_bits(found.radiance, radiance));
        continue;
      }
      CHECK(found.parameter > 0.0);
      for (const double share : {0.0, 0.1, 0.5, 0.9, 0.99, 0.99999}) {
        CHECK(smallest(lowest_irradiance(radiance, share * found.parameter) / mean) < -1e-9);
      }
    }
  }
}

TEST_CASE("Windows that cannot be are refused, with what would do", "[sh][window]") {
  const SphericalHarmonics sun = sunny({0, 1, 0}, {10, 10, 10}, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double width : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    const ThrownError error = thrown_by([&] { (void)apply_window(sun, Window::hanning, width); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("width"));
  }
  const ThrownError negative = thrown_by([&] {
    (void)apply_window(constant_radiance({1, -1, 1}, 3), Window::min_laplacian);
  });
  CHECK(negative.code == ErrorCode::invalid_argument);
  CHECK(negative.says("green"));
  CHECK(negative.says("NegativePolicy::replace"));
  SphericalHarmonics no_mean = sun;
  no_mean.at(0, 0).b = 0.0;
  CHECK(thrown_by([&] { (void)apply_window(no_mean, Window::min_laplacian); }).says("blue"));
  SphericalHarmonics broken = sun;
  broken.at(1, 0).r = nan;
  CHECK(thrown_by([&] { (void)apply_window(broken, Window::min_laplacian); }).says("not finite"));
}

namespace {

LatLongImage halves(float upper, float lower) {
  LatLongImage image{64, 32, std::vector<float>(std::size_t{3} * 64 * 32, upper)};
  std::fill(image.pixels.begin() + 3 * 64 * 16, image.pixels.end(), lower);
  return image;
}

}  // namespace

TEST_CASE("exposure of harmonics takes the mean to middle grey", "[exposure]") {
  CHECK(exposure_of(constant_radiance(dvec3(9.0), 3)) == Approx(0.02).epsilon(1e-14));
  CHECK(exposure_of(constant_radiance(dvec3(0.0, 1.0, 0.0), 1)) == Approx(0.18 / 0.7152).epsilon(1e-14));
  CHECK(exposure_of(constant_radiance(dvec3(0.0), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(-1.0), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(1e-310), 3)) == 1.0);
  CHECK(exposure_of(constant_radiance(dvec3(std::numeric_limits<double>::quiet_NaN()), 3)) == 1.0);
}

TEST_CASE("exposure of an image takes three quarters of what is lit to 0.36", "[exposure]") {
  CHECK(exposure_of(halves(5.0F, 5.0F).view()) == Approx(0.36 / 5.0));
  CHECK(exposure_of(halves(8.0F, 2.0F).view()) == Approx(0.36 / 8.0));
  CHECK(exposure_of(halves(8.0F, 0.0F).view()) == Approx(0.36 / 8.0));  // black is not lit
  CHECK(exposure_of(halves(0.0F, 0.0F).view()) == 1.0);
  LatLongImage sunny = halves(8.0F, 8.0F);
  sunny.pixels[3 * 64 * 10] = 1e9F;  // a sun moves nothing
  sunny.pixels[3 * 64 * 20] = std::numeric_limits<float>::quiet_NaN();
  CHECK(exposure_of(sunny.view()) == Approx(0.36 / 8.0));
}

TEST_CASE("exposure weighs texels by solid angle, of cubes as of lat-longs, in every format", "[exposure]") {
  // The top third of the rows is 0.25 of the sphere: just the brightest quarter.
  LatLongImage image = halves(1.0F, 1.0F);
  std::fill_n(image.pixels.begin(), 3 * 64 * 10, 3.0F);
  CHECK(exposure_of(image.view()) == Approx(0.36));
  std::fill_n(image.pixels.begin(), 3 * 64 * 11, 3.0F);
  CHECK(exposure_of(image.view()) == Approx(0.12));
  std::fill_n(image.pixels.begin(), 3 * 64 * 13, 3.0F);  // no mixed texel of the cube is in question
  CHECK(exposure_of(to_cubemap(image.view(), 32).view()) == Approx(0.12).epsilon(1e-5));
  const std::vector<std::uint8_t> bytes(std::size_t{4} * 8 * 4, 255);
  CHECK(exposure_of(LatLongView{bytes.data(), 8, 4, 0, PixelFormat::rgba8}) == Approx(0.36));
  CHECK_THROWS_AS(exposure_of(LatLongView{}), Error);
}

}  // namespace welkin::test
