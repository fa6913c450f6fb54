// The form in which Babylon.js 9.34 keeps an environment's diffuse light.
#pragma once

#include <glm/vec3.hpp>

#include "welkin/export.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Babylon.js's SphericalPolynomial: a quadratic in the surface normal (x, y, z), one RGB triple a term.
/// Its values are Lambertian radiance (irradiance / pi) with the cosine factors of bands 1 and 2 carried
/// twice and constants truncated as they are in Babylon.js; its shader's way back undoes that.
struct BabylonPolynomial {
  glm::dvec3 x{};   ///< factor of the normal's x
  glm::dvec3 y{};   ///< of y
  glm::dvec3 z{};   ///< of z
  glm::dvec3 xx{};  ///< of x squared
  glm::dvec3 yy{};  ///< of y squared
  glm::dvec3 zz{};  ///< of z squared
  glm::dvec3 yz{};  ///< of y z
  glm::dvec3 zx{};  ///< of z x
  glm::dvec3 xy{};  ///< of x y
};

/// What CubeMapToSphericalPolynomialTools makes of the same light: irradiance / pi in Babylon's signs (odd
/// orders negated), then SphericalPolynomial.FromHarmonics with its own constants (0.886277 included).
/// Bands above the third are left out, missing ones are zero.
[[nodiscard]] BabylonPolynomial babylon_polynomial(const SphericalHarmonics& radiance);

/// The polynomial of a single ambient colour (a placeholder until the real light is there): that colour
/// for every normal, no direction in it. Exactly `colour` in xx, yy and zz, zero elsewhere.
[[nodiscard]] BabylonPolynomial babylon_constant_polynomial(const glm::dvec3& colour);

/// The polynomial's value for a unit normal.
[[nodiscard]] glm::dvec3 evaluate(const BabylonPolynomial& polynomial, const glm::dvec3& normal);

}  // namespace welkin
