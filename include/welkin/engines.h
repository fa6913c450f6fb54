// Conventions of other engines, and diffuse light in their own forms.
//
//   welkin::EngineLight light = welkin::engine_light(projection.radiance, welkin::Engine::unity);
//   for (const welkin::EngineVector& vector : light.vectors) material.set(vector.name, vector.value);
//
// Welkin's axes are right-handed with y up; the centre of a lat-long is at +z, and +x lies a quarter of the width from
// its left edge (as in OpenEXR). A convention states how the same surroundings lie in an engine's axes, so that a
// viewer in the engine sees the same image, not mirrored.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Axes, lat-longs and cube faces

/// Engines and formats with known conventions; `conventions()` describes them.
enum class Engine {
  welkin,
  openexr,
  babylon,
  three,
  filament,
  gltf,
  unity,
  unreal,
  blender,
  godot,
  bevy,
  usd,
  playcanvas,
  qt
};

/// The conventions of one engine.
struct Convention {
  Engine engine;         ///< the engine
  const char* name;      ///< name on the command line: "babylon", "three", ...
  const char* title;     ///< display name: "Babylon.js", "three.js", ...
  bool right_handed;     ///< handedness of the engine's axes
  const char* axes;      ///< description: "left-handed, y up, ..."
  const char* lat_long;  ///< description: "centre +z, right +x"
  const char* source;  ///< file and function of the engine that show it; what follows "derived" is concluded from them

  /// Matrix from directions in Welkin's axes to the engine's axes, as both lay out a lat-long image. Orthogonal, with
  /// determinant -1 for left-handed engines.
  dmat3 from_welkin;

  /// Matrix from directions in the engine's axes to the axes of `CubemapView`, in which the engine's cubemap faces
  /// store them. Empty if the engine has no cubemaps of its own.
  std::optional<dmat3> faces_from_engine;
};

/// Returns the conventions of an engine. Cost: a table lookup.
[[nodiscard]] const Convention& convention(Engine engine) noexcept;

/// Returns all conventions, in the order of `Engine`.
[[nodiscard]] std::span<const Convention> conventions() noexcept;

/// Returns the convention with a `Convention::name`. Throws `Error` (invalid_argument) that lists the names.
[[nodiscard]] const Convention& convention(std::string_view name);

// ---- Babylon.js's polynomial, as in version 9.34

/// Babylon.js's SphericalPolynomial: a quadratic in the surface normal (x, y, z), one RGB triple per term. Its value is
/// Lambertian radiance (irradiance / pi) to which the cosine factors of bands 1 and 2 were applied twice, with
/// constants truncated as in Babylon.js; its shader compensates for that.
struct BabylonPolynomial {
  dvec3 x{};   ///< coefficient of x
  dvec3 y{};   ///< coefficient of y
  dvec3 z{};   ///< coefficient of z
  dvec3 xx{};  ///< coefficient of x squared
  dvec3 yy{};  ///< coefficient of y squared
  dvec3 zz{};  ///< coefficient of z squared
  dvec3 yz{};  ///< coefficient of y z
  dvec3 zx{};  ///< coefficient of z x
  dvec3 xy{};  ///< coefficient of x y
};

/// Returns the polynomial that CubeMapToSphericalPolynomialTools makes of the same light: irradiance / pi in
/// Babylon.js's signs (odd orders negated), then SphericalPolynomial.FromHarmonics with its own constants (including
/// 0.886277). Bands above the third are dropped; missing ones are zero.
[[nodiscard]] BabylonPolynomial babylon_polynomial(const SphericalHarmonics& radiance);

/// Returns the polynomial's value for a normal. Throws `Error` (invalid_argument) for one that is zero or not finite.
[[nodiscard]] dvec3 evaluate(const BabylonPolynomial& polynomial, const dvec3& normal);

// ---- Diffuse light in an engine's own form

/// A named RGB triple of an engine's form.
struct EngineTerm {
  std::string name;  ///< the engine's name: "xx", "coefficients[4]", "irradianceCoefficients[0]", ...
  dvec3 rgb{};       ///< red, green, blue
};

/// A named four-vector that an engine's shader reads.
struct EngineVector {
  std::string name;  ///< the shader's name: "unity_SHAr", "SkyIrradianceEnvironmentMap[0]", ...
  dvec4 value{};     ///< x, y, z, w as the shader reads them
};

/// Light in an engine's own form.
struct EngineLight {
  Engine engine{};                ///< the engine
  std::string form;               ///< the engine's type: "SphericalPolynomial", "SphericalHarmonics3", ...
  std::string formula;            ///< definition with pi, signs and order, and how the shader evaluates it; for people
  std::vector<EngineTerm> terms;  ///< in the engine's order

  /// The same light as packed for the engine's shader, by channel: seven vectors for Unity and Unreal, in memory order
  /// (SHA of red, green and blue, SHB of red, green and blue, SHC). Empty for engines whose shaders read the terms.
  std::vector<EngineVector> vectors;
};

/// Returns whether the engine has a form; openexr, blender, bevy, usd, playcanvas and qt have none. The `formula` of
/// Engine::welkin is a GLSL function.
[[nodiscard]] bool has_engine_light(Engine engine) noexcept;

/// Converts radiance in Welkin's axes to an engine's form: rotates it to the engine's axes (`Convention::from_welkin`),
/// then applies signs, order and scale. Bands above the third are dropped; missing ones are zero. Coefficients of faces
/// that the engine rendered itself are not in Welkin's axes; see `engine_light_unrotated` and
/// `Convention::faces_from_engine`. Throws `Error` (invalid_argument) for an engine without a form, naming those that
/// have one.
[[nodiscard]] EngineLight engine_light(const SphericalHarmonics& radiance, Engine engine);

/// Converts radiance that is already in the engine's axes to the engine's form. Throws the errors of `engine_light`.
[[nodiscard]] EngineLight engine_light_unrotated(const SphericalHarmonics& radiance, Engine engine);

}  // namespace welkin
