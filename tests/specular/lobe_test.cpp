// Promise: the lobe's closed forms and its spectrum are those of k(c) = c D, to 1e-10.
#include "specular/lobe.h"

#include <cmath>
#include <numbers>

#include "support/catch.h"
#include "tables/logarithm.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// As specular.h writes it.
double textbook_lobe(double c, double a) {
  if (c <= 0.0) return 0.0;
  const double h2 = (1.0 + c) / 2.0;
  const double root = h2 * (a * a - 1.0) + 1.0;
  return c * a * a / (kPi * root * root);
}

/// Simpson's rule in t, c = 1 - t^4: dense where the lobe is sharp.
template <class Function>
double integral(const Function& function) {
  constexpr int steps = 200'000;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double weight = i == 0 || i == steps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * function(1.0 - t * t * t * t) * 4.0 * t * t * t;
  }
  return 2.0 * kPi * sum / (3.0 * steps);
}

/// Sum (2l + 1) / (4 pi) k_l / k_0 P_l(c): the lobe over its integral, if the bands are enough.
double legendre_sum(const std::vector<double>& spectrum, double c) {
  double before = 0.0;
  double here = 1.0;
  double sum = 0.0;
  for (std::size_t l = 0; l < spectrum.size(); ++l) {
    const auto n = static_cast<double>(l);
    sum += (2.0 * n + 1.0) / (4.0 * kPi) * spectrum[l] * here;
    const double next = ((2.0 * n + 1.0) * c * here - n * before) / (n + 1.0);
    before = here;
    here = next;
  }
  return sum;
}

}  // namespace

TEST_CASE("The lobe is c times GGX's distribution", "[specular][lobe]") {
  for (const double alpha : {1.0, 0.5, 0.1, 0.0123, 1e-3}) {
    for (const double c : {1.0, 0.9999, 0.9, 0.5, 0.01, 0.0, -0.3}) {
      CAPTURE(alpha, c);
      CHECK(specular::lobe(c, alpha) == Approx(textbook_lobe(c, alpha)).epsilon(1e-9));
    }
  }
}

TEST_CASE("The lobe's integral has a closed form", "[specular][lobe]") {
  CHECK(specular::lobe_integral(1.0) == Approx(1.0).epsilon(1e-14));  // a cosine over pi
  for (const double alpha : {0.999, 0.96, 0.95, 0.9, 0.5, 0.1, 0.0123}) {
    CAPTURE(alpha);
    const double expected = integral([&](double c) { return textbook_lobe(c, alpha); });
    CHECK(specular::lobe_integral(alpha) == Approx(expected).epsilon(1e-9));
  }
}

TEST_CASE("The spectrum of alpha 1 is the cosine lobe's", "[specular][lobe]") {
  const std::vector<double> spectrum = specular::lobe_spectrum(1.0, 32);
  for (int l = 0; l < 32; ++l) {
    CAPTURE(l);
    CHECK(std::abs(spectrum[static_cast<std::size_t>(l)] - cosine_lobe(l) / kPi) < 1e-10);
  }
}

TEST_CASE("The spectrum is that of dense integration, l = 0 being 1", "[specular][lobe]") {
  for (const double alpha : {0.7, 0.1, 0.0123, 2e-3}) {
    const std::vector<double> spectrum = specular::lobe_spectrum(alpha, 61);
    CHECK(spectrum[0] == 1.0);
    for (const unsigned l : {1U, 17U, 60U}) {
      CAPTURE(alpha, l);
      const double expected = integral([&](double c) { return textbook_lobe(c, alpha) * std::legendre(l, c); });
      CHECK(std::abs(spectrum[l] - expected / specular::lobe_integral(alpha)) < 1e-9);
    }
  }
}

TEST_CASE("Legendre sums of the spectrum give the lobe back at every angle", "[specular][lobe]") {
  for (const double alpha : {0.2, 0.05, 0.0123}) {
    const int bands = static_cast<int>(14.0 / alpha) + 200;
    const std::vector<double> spectrum = specular::lobe_spectrum(alpha, bands);
    const double peak = specular::lobe(1.0, alpha) / specular::lobe_integral(alpha);
    for (const double c : {1.0, 0.9999, 0.99, 0.7, 0.2, -0.5, -1.0}) {
      CAPTURE(alpha, c);
      const double expected = specular::lobe(c, alpha) / specular::lobe_integral(alpha);
      // The kink at the horizon leaves what falls like l^-3/2.
      CHECK(std::abs(legendre_sum(spectrum, c) - expected) < 1e-9 * peak + 1e-3 * alpha * alpha);
    }
  }
}

TEST_CASE("More bands change none of the first", "[specular][lobe]") {
  for (const double alpha : {1.0, 0.1, 1e-3}) {
    const std::vector<double> few = specular::lobe_spectrum(alpha, 64);
    const std::vector<double> many = specular::lobe_spectrum(alpha, 1024);
    for (std::size_t l = 0; l < few.size(); ++l) CHECK(std::abs(few[l] - many[l]) < 1e-11);
  }
}

TEST_CASE("The spectrum falls like exp(-2 alpha l)", "[specular][lobe]") {
  const double alpha = 0.02;
  const std::vector<double> spectrum = specular::lobe_spectrum(alpha, 600);
  // z K_1(z), z = 2 alpha l, is the plane's; its decay from l = 200 to 400 is exp(-8) sqrt(2) and a few per cent.
  CHECK(spectrum[400] / spectrum[200] == Approx(std::exp(-8.0) * std::sqrt(2.0)).epsilon(0.08));
}

TEST_CASE("Our logarithm is the logarithm", "[tables]") {
  for (const double x : {1e-300, 1e-9, 0.3, 0.70710678, 0.7071068, 0.999999, 1.0, 1.000001, 1.4142135, 2.0, 3e5, 1e300})
    CHECK(std::abs(tables::logarithm(x) - std::log(x)) < 5e-16 + 3e-16 * std::abs(std::log(x)));
  CHECK(tables::logarithm(1.0) == 0.0);
}

}  // namespace welkin::test
