// Promises: from the same harmonics, the same polynomial as Babylon.js 9.34, to the last bit; its terms mean what
// the header says.
#include <array>
#include <cmath>
#include <numbers>

#include "babylon/recorded_cases.h"
#include "support/catch.h"
#include "welkin/babylon.h"

namespace {

using namespace welkin;
using namespace welkin::test;

constexpr double kPi = std::numbers::pi;

/// Babylon.js's coefficients are Welkin's with the odd orders negated.
SphericalHarmonics from_babylon_signs(const std::array<glm::dvec3, 9>& theirs) {
  SphericalHarmonics ours(3);
  for (int l = 0; l < 3; ++l) {
    for (int m = -l; m <= l; ++m) {
      ours.at(l, m) = theirs[SphericalHarmonics::index(l, m)] * (m % 2 == 0 ? 1.0 : -1.0);
    }
  }
  return ours;
}

/// Nine coefficients without any symmetry, each channel its own.
SphericalHarmonics any_radiance(int bands) {
  SphericalHarmonics radiance(bands);
  double i = 0.0;
  for (glm::dvec3& coefficient : radiance.coefficients()) {
    i += 1.0;
    coefficient = {std::sin(i), std::cos(2.3 * i), 1.0 / i};
  }
  return radiance;
}

/// Band 1 and 2 monomials as radiance of 1: (l, m), basis constant.
SphericalHarmonics single(int l, int m, double value) {
  SphericalHarmonics radiance(3);
  radiance.at(l, m) = glm::dvec3(value);
  return radiance;
}

}  // namespace

TEST_CASE("from Babylon.js's own harmonics comes its own polynomial, to the last bit", "[babylon][sh]") {
  int compared = 0;
  for (const RecordedCase& recorded : recorded_cases()) {
    if (!recorded.radiance) continue;
    ++compared;
    INFO(recorded.description());
    CHECK(terms(babylon_polynomial(from_babylon_signs(*recorded.radiance))) == recorded.polynomial);
  }
  CHECK(compared >= 20);
}

TEST_CASE("each term of the polynomial answers to its own monomial of radiance", "[babylon][sh]") {
  // The lobe is carried twice: (2/3)^2 for band 1, (1/4)^2 for band 2. Constants are truncated to six digits.
  const double one_over_k1 = std::sqrt(4.0 * kPi / 3.0);
  const double one_over_k2 = std::sqrt(4.0 * kPi / 15.0);
  struct Expectation {
    int l, m;
    double value;  ///< the coefficient of the monomial
    PolynomialTerms polynomial;
  };
  const auto only = [](std::size_t term, double value) {
    PolynomialTerms list{};
    list[term] = glm::dvec3(value);
    return list;
  };
  PolynomialTerms difference{};  // of x^2 - y^2
  difference[3] = glm::dvec3(1.0 / 16.0);
  difference[4] = glm::dvec3(-1.0 / 16.0);
  PolynomialTerms zonal{};  // of 3 z^2 - 1 = 2 z^2 - x^2 - y^2
  zonal[3] = zonal[4] = glm::dvec3(-1.0 / 16.0);
  zonal[5] = glm::dvec3(2.0 / 16.0);
  const std::array<Expectation, 8> expectations{{
      {1, 1, one_over_k1, only(0, 4.0 / 9.0)},
      {1, -1, one_over_k1, only(1, 4.0 / 9.0)},
      {1, 0, one_over_k1, only(2, 4.0 / 9.0)},
      {2, -1, one_over_k2, only(6, 1.0 / 16.0)},
      {2, 1, one_over_k2, only(7, 1.0 / 16.0)},
      {2, -2, one_over_k2, only(8, 1.0 / 16.0)},
      {2, 2, 2.0 * one_over_k2, difference},
      {2, 0, std::sqrt(16.0 * kPi / 5.0), zonal},
  }};
  for (const Expectation& expected : expectations) {
    INFO("l = " << expected.l << ", m = " << expected.m);
    const PolynomialTerms found = terms(babylon_polynomial(single(expected.l, expected.m, expected.value)));
    CHECK(relative_deviation(found, expected.polynomial) <= 5e-6);
  }
}

TEST_CASE("a uniform radiance of 1 gives Babylon.js's 1.0000565, its slip of the sixth digit included",
          "[babylon][sh]") {
  const BabylonPolynomial polynomial = babylon_polynomial(constant_radiance({1.0, 2.0, 0.5}));
  for (const glm::dvec3& square : {polynomial.xx, polynomial.yy, polynomial.zz}) {
    CHECK(std::abs(square.x - 1.0000565) <= 1e-7);
    CHECK(square.y == 2.0 * square.x);
    CHECK(square.z == 0.5 * square.x);
  }
  for (const glm::dvec3& other :
       {polynomial.x, polynomial.y, polynomial.z, polynomial.yz, polynomial.zx, polynomial.xy}) {
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(other[channel] == 0.0);
      CHECK_FALSE(std::signbit(other[channel]));  // a report would show -0
    }
  }
}

TEST_CASE("Babylon.js's way back from the polynomial returns the harmonics", "[babylon][sh]") {
  // SphericalHarmonics.FromPolynomial's constants (CONVENTIONS: "Back"), signs left out on both sides.
  const SphericalHarmonics radiance = any_radiance(3);
  const BabylonPolynomial p = babylon_polynomial(radiance);
  const SphericalHarmonics lambertian = lambertian_from_irradiance(irradiance_from_radiance(radiance));
  const PolynomialTerms back{
      kPi * (0.376127 * (p.xx + p.yy) + 0.376126 * p.zz),
      kPi * 0.977204 * p.y,
      kPi * 0.977204 * p.z,
      kPi * 0.977204 * p.x,
      kPi * 1.16538 * p.xy,
      kPi * 1.16538 * p.yz,
      kPi * (1.34567 * p.zz - 0.672834 * (p.xx + p.yy)),
      kPi * 1.16538 * p.zx,
      kPi * 1.16538 * (p.xx - p.yy),
  };
  PolynomialTerms expected{};
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = lambertian.coefficients()[i];
  CHECK(relative_deviation(back, expected) <= 1e-4);
}

TEST_CASE("a unit normal's value is the radiance with the cosine lobe carried twice", "[babylon][sh]") {
  const SphericalHarmonics radiance = any_radiance(3);
  const auto reflect = [](const SphericalHarmonics& light) {
    return lambertian_from_irradiance(irradiance_from_radiance(light));
  };
  const SphericalHarmonics twice = reflect(reflect(radiance));
  const BabylonPolynomial polynomial = babylon_polynomial(radiance);
  for (int i = 0; i < 50; ++i) {
    const double z = 1.0 - (2 * i + 1) / 50.0;
    const double ring = std::sqrt(1.0 - z * z);
    const glm::dvec3 normal{ring * std::cos(2.4 * i), ring * std::sin(2.4 * i), z};
    const glm::dvec3 found = evaluate(polynomial, normal);
    const glm::dvec3 expected = evaluate(twice, normal);
    for (int channel = 0; channel < 3; ++channel) CHECK(std::abs(found[channel] - expected[channel]) <= 1e-4);
  }
}

TEST_CASE("bands above the third are left out, missing ones are zero", "[babylon][sh]") {
  const SphericalHarmonics nine = any_radiance(3);
  const auto first_bands = [&nine](int bands) {
    SphericalHarmonics fewer(bands);
    for (std::size_t i = 0; i < fewer.coefficients().size(); ++i) fewer.coefficients()[i] = nine.coefficients()[i];
    return fewer;
  };
  CHECK(terms(babylon_polynomial(any_radiance(10))) == terms(babylon_polynomial(nine)));
  for (const int bands : {1, 2}) {
    SphericalHarmonics padded = nine;
    for (std::size_t i = static_cast<std::size_t>(bands * bands); i < 9; ++i)
      padded.coefficients()[i] = glm::dvec3(0.0);
    CHECK(terms(babylon_polynomial(first_bands(bands))) == terms(babylon_polynomial(padded)));
  }
}

TEST_CASE("the constant polynomial is its colour for every normal", "[babylon][sh]") {
  const glm::dvec3 colour{0.25, 1.5, 3000.0};
  const PolynomialTerms found = terms(babylon_constant_polynomial(colour));
  const glm::dvec3 none(0.0);
  CHECK(found == PolynomialTerms{none, none, none, colour, colour, colour, none, none, none});
  const std::array<glm::dvec3, 3> normals{{{0, 1, 0}, {2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, {-0.6, 0, 0.8}}};
  for (const glm::dvec3& normal : normals) {
    const glm::dvec3 value = evaluate(babylon_constant_polynomial(colour), normal);
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(std::abs(value[channel] - colour[channel]) <= 1e-15 * colour[channel]);
    }
  }
}

TEST_CASE("a polynomial is evaluated term by term", "[babylon][sh]") {
  const glm::dvec3 normal{2.0, 3.0, 5.0};  // not of unit length, so that no two terms have the same value
  const std::array<double, 9> values{2.0, 3.0, 5.0, 4.0, 9.0, 25.0, 15.0, 10.0, 6.0};
  for (std::size_t term = 0; term < values.size(); ++term) {
    std::array<glm::dvec3, 9> list{};
    list[term] = {1.0, -2.0, 0.5};
    const BabylonPolynomial polynomial{list[0], list[1], list[2], list[3], list[4], list[5], list[6], list[7], list[8]};
    CHECK(evaluate(polynomial, normal) == glm::dvec3(values[term], -2.0 * values[term], 0.5 * values[term]));
  }
}
