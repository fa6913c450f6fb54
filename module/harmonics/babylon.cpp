// Babylon.js 9.34's SphericalPolynomial, operation for operation, so that equal harmonics give equal bits.
//
// Source: @babylonjs/core 9.34.0, Maths/sphericalPolynomial (SphericalHarmonics.convertIncidentRadianceToIrradiance,
// convertIrradianceToLambertianRadiance, SphericalPolynomial.updateFromHarmonics).
#include "harmonics/babylon.h"

#include <numbers>

#include "math/direction.h"
#include "platform/float_environment.h"
#include "welkin/engines.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInversePi = 1.0 / kPi;

// The cosine lobe's factors as Babylon.js spells them.
constexpr double kLobe0 = kPi;
constexpr double kLobe1 = (2.0 * kPi) / 3.0;
constexpr double kLobe2 = kPi / 4.0;

// updateFromHarmonics's constants: the lobe's factor A_l times the basis function's own constant, six digits each:
// sqrt(pi) / 2, sqrt(pi / 3), sqrt(15 pi) / 8 and half of it, sqrt(5 pi) / 8 and half of it. Babylon.js writes 0.886277
// where 0.886227 is meant, so a uniform radiance of 1 becomes 1.0000565. Its shaders expect that.
constexpr double kBand0 = 0.886277;
constexpr double kBand1 = 1.02333;
constexpr double kBand2 = 0.858086;
constexpr double kBand2HalfDifference = 0.429043;
// sqrt(5 pi) / 8 = 0.4954159 rounds to 0.495416; 0.495417 is Babylon.js's own number.
constexpr double kBand2Zonal = 0.495417;
constexpr double kBand2HalfZonal = 0.247708;

/// Coefficient (l, m) after Babylon.js's two conversions: the lobe's factor makes irradiance, 1 / pi what a white
/// surface reflects. Babylon.js's harmonics carry the Condon-Shortley sign (odd m negated) and its polynomial takes
/// that sign out again; a change of sign rounds nothing, so both are left out here.
glm::dvec3 lambertian(const SphericalHarmonics& radiance, int l, int m) {
  if (l >= radiance.bands()) return glm::dvec3(0.0);
  const double lobe = l == 0 ? kLobe0 : l == 1 ? kLobe1 : kLobe2;
  return radiance.at(l, m) * lobe * kInversePi;
}

}  // namespace

BabylonPolynomial babylon_polynomial(const SphericalHarmonics& radiance) {
  const platform::FloatingPointScope floating_point;
  // A band-2 harmonic as a quadratic form, with 1 = xx + yy + zz: 3 zz - 1 = 2 zz - xx - yy, so Y(2, 0) gives zz the
  // whole zonal constant and xx, yy minus one half of it; Y(2, 2) gives xx - yy; a constant c is c xx + c yy + c zz.
  const glm::dvec3 ambient = lambertian(radiance, 0, 0) * kBand0;
  const glm::dvec3 zonal = lambertian(radiance, 2, 0) * kBand2Zonal;
  const glm::dvec3 half_zonal = lambertian(radiance, 2, 0) * kBand2HalfZonal;
  const glm::dvec3 half_difference = lambertian(radiance, 2, 2) * kBand2HalfDifference;

  // The last 1 / pi is Babylon.js's own: it divides by pi in the harmonics and here once more.
  BabylonPolynomial polynomial;
  polynomial.x = lambertian(radiance, 1, 1) * kBand1 * kInversePi;
  polynomial.y = lambertian(radiance, 1, -1) * kBand1 * kInversePi;
  polynomial.z = lambertian(radiance, 1, 0) * kBand1 * kInversePi;
  polynomial.xx = (ambient - half_zonal + half_difference) * kInversePi;
  polynomial.yy = (ambient - half_zonal - half_difference) * kInversePi;
  polynomial.zz = (ambient + zonal) * kInversePi;
  polynomial.yz = lambertian(radiance, 2, -1) * kBand2 * kInversePi;
  polynomial.zx = lambertian(radiance, 2, 1) * kBand2 * kInversePi;
  polynomial.xy = lambertian(radiance, 2, -2) * kBand2 * kInversePi;
  return polynomial;
}

glm::dvec3 evaluate(const BabylonPolynomial& polynomial, const glm::dvec3& normal) {
  const platform::FloatingPointScope floating_point;
  const glm::dvec3 unit = math::as_unit_direction(normal, "normal");
  const double x = unit.x;
  const double y = unit.y;
  const double z = unit.z;
  return polynomial.x * x + polynomial.y * y + polynomial.z * z + polynomial.xx * (x * x) + polynomial.yy * (y * y) +
         polynomial.zz * (z * z) + polynomial.yz * (y * z) + polynomial.zx * (z * x) + polynomial.xy * (x * y);
}

}  // namespace welkin

namespace welkin::harmonics {

SphericalHarmonics radiance_of(const BabylonPolynomial& polynomial) {
  // From what `lambertian` hands out back to radiance, and over `updateFromHarmonics` against its direction.
  const auto from_lambertian = [](const glm::dvec3& value, double lobe) { return value * (kPi / lobe); };
  // With a = ambient and s = the harmonic (2, 0): pi (xx + yy) / 2 = a - kBand2HalfZonal s, pi zz = a + kBand2Zonal s.
  // Their difference gives s, and then a; pi (xx - yy) / 2 is the half difference.
  const glm::dvec3 sum = (polynomial.xx + polynomial.yy) * (0.5 * kPi);  // ambient - half zonal
  const glm::dvec3 zonal = (polynomial.zz * kPi - sum) / (kBand2Zonal + kBand2HalfZonal);
  const glm::dvec3 ambient = (polynomial.zz * kPi - zonal * kBand2Zonal) / kBand0;
  const glm::dvec3 difference = (polynomial.xx - polynomial.yy) * (0.5 * kPi) / kBand2HalfDifference;

  SphericalHarmonics radiance(3);
  radiance.at(0, 0) = from_lambertian(ambient, kLobe0);
  radiance.at(1, 1) = from_lambertian(polynomial.x * kPi / kBand1, kLobe1);
  radiance.at(1, -1) = from_lambertian(polynomial.y * kPi / kBand1, kLobe1);
  radiance.at(1, 0) = from_lambertian(polynomial.z * kPi / kBand1, kLobe1);
  radiance.at(2, 0) = from_lambertian(zonal, kLobe2);
  radiance.at(2, 2) = from_lambertian(difference, kLobe2);
  radiance.at(2, -1) = from_lambertian(polynomial.yz * kPi / kBand2, kLobe2);
  radiance.at(2, 1) = from_lambertian(polynomial.zx * kPi / kBand2, kLobe2);
  radiance.at(2, -2) = from_lambertian(polynomial.xy * kPi / kBand2, kLobe2);
  return radiance;
}

}  // namespace welkin::harmonics
