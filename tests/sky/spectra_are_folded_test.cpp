// Spectra become linear sRGB luminances as the CIE's observer sees them.
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/atmosphere.h"

namespace welkin {
namespace {

std::vector<double> spread(double low, double high, int count) {
  std::vector<double> result;
  for (int i = 0; i < count; ++i) result.push_back(low + (high - low) * i / (count - 1));
  return result;
}

template <class Spectrum>
glm::dvec3 folded(const std::vector<double>& wavelengths, const Spectrum& spectrum) {
  const std::vector<glm::dvec3> weights = srgb_weights(wavelengths);
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * spectrum(wavelengths[i]);
  return sum;
}

double luminance(const glm::dvec3& rgb) {
  return 0.2126390058715103 * rgb.r + 0.7151686787677559 * rgb.g + 0.0721923153607337 * rgb.b;
}

/// Planck's law at 6500 K, scaled: a smooth white.
double hot(double nm) {
  const double m = nm * 1e-9;
  return 1e-31 / (m * m * m * m * m) / (std::exp(0.014387769 / (m * 6500.0)) - 1.0);
}

}  // namespace

TEST_CASE("sky: an even spectrum is the equal-energy white", "[sky][air]") {
  // Chromaticity (1/3, 1/3): sRGB in proportion 1.205 : 0.948 : 0.909; luminance 683 times the integral of y,
  // 106.857.
  const glm::dvec3 even = folded({360.0, 600.0, 830.0}, [](double) { return 1.0; });
  CHECK(luminance(even) == Approx(683.0 * 106.857).epsilon(1e-5));
  CHECK(even.r / luminance(even) == Approx(1.205).epsilon(5e-4));
  CHECK(even.g / luminance(even) == Approx(0.9483).epsilon(5e-4));
  CHECK(even.b / luminance(even) == Approx(0.909).epsilon(5e-4));
  // However many wavelengths, wherever they are, and in both orders.
  for (const auto& wavelengths : {spread(440.0, 680.0, 3), spread(680.0, 440.0, 7), spread(200.0, 1200.0, 96),
                                  spread(900.0, 1000.0, 5), std::vector<double>{549.0, 550.0, 551.0}}) {
    const glm::dvec3 same = folded(wavelengths, [](double) { return 1.0; });
    for (int c = 0; c < 3; ++c) CHECK(same[c] == Approx(even[c]).epsilon(1e-12));
  }
}

TEST_CASE("sky: a line has the colour of its wavelength", "[sky][air]") {
  // One nanometre's triangle of 1 W/m2/sr/nm about 555 nm, where y is 1: 683 cd/m2 and no red's or blue's excess.
  const std::vector<glm::dvec3> weights = srgb_weights({100.0, 554.999, 555.0, 555.001, 1000.0});
  const glm::dvec3 line = weights[2] / 0.001;
  CHECK(luminance(line) == Approx(683.0).epsilon(1e-4));
  // x 0.51205, y 1, z 0.00575 through the matrix.
  CHECK(line.r == Approx(683.0 * (3.24097 * 0.51205 - 1.53738 - 0.49861 * 0.00575)).epsilon(1e-3));
  CHECK(line.g == Approx(683.0 * (-0.96924 * 0.51205 + 1.87597 + 0.04156 * 0.00575)).epsilon(1e-3));
  CHECK(line.b == Approx(683.0 * (0.05563 * 0.51205 - 0.20398 + 1.05697 * 0.00575)).epsilon(1e-3));
  // The observer sees nothing beyond its table.
  const std::vector<glm::dvec3> dark = srgb_weights({100.0, 200.0, 359.0, 831.0, 900.0});
  CHECK(dark[0] == glm::dvec3(0.0));
  CHECK(dark[4] == glm::dvec3(0.0));
}

TEST_CASE("sky: weights follow their wavelengths, rising or falling", "[sky][air]") {
  const std::vector<glm::dvec3> rising = srgb_weights({440.0, 550.0, 680.0});
  const std::vector<glm::dvec3> falling = srgb_weights({680.0, 550.0, 440.0});
  CHECK(rising[0].b > rising[0].g);
  CHECK(rising[2].r > rising[2].g);
  for (std::size_t i = 0; i < 3; ++i) CHECK(falling[i] == rising[2 - i]);
}

TEST_CASE("sky: more wavelengths come closer to the whole spectrum", "[sky][air]") {
  const glm::dvec3 truth = folded(spread(360.0, 830.0, 95), hot);
  double before = 1.0;
  for (const int count : {3, 6, 12, 24, 48}) {
    const double error = glm::length(folded(spread(380.0, 740.0, count), hot) - truth) / glm::length(truth);
    INFO(count << " wavelengths: " << error);
    CHECK(error < 0.6 * before);
    before = error;
  }
  CHECK(before < 1e-3);
  // A black body of 6500 K is (255, 249, 253) in sRGB bytes (Charity, "What color is a blackbody").
  CHECK(truth.r / truth.g == Approx(1.055).margin(0.015));
  CHECK(truth.b / truth.g == Approx(1.04).margin(0.015));
}

TEST_CASE("sky: weights refuse what is no list of wavelengths", "[sky][air]") {
  CHECK(test::thrown_by([] { return srgb_weights({550.0}); }).says("1 wavelengths"));
  CHECK(test::thrown_by([] { return srgb_weights({440.0, 550.0, 550.0}); }).says("all rise or all fall"));
  CHECK(test::thrown_by([] { return srgb_weights({440.0, NAN, 550.0}); }).says("wavelengths_nm[1]"));
}

}  // namespace welkin
