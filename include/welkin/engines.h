// Other engines: where things lie in them, and the form in which they want diffuse light.
//
//   welkin::EngineLight light = welkin::engine_light(projection.radiance, welkin::Engine::unity);
//   for (const welkin::EngineVector& vector : light.vectors) material.set(vector.name, vector.value);
//
// An environment in Welkin lives in Welkin's axes: right-handed, y up, a lat-long's centre along +z and +x a quarter
// in from the left (as in OpenEXR). A convention says how the same surroundings lie in an engine's axes, so that a
// person who looks around in the engine sees the same picture, not mirrored.
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

/// The engines and formats whose conventions are known; `conventions()` describes them.
enum class Engine { welkin, openexr, babylon, three, filament, gltf, unity, unreal, blender, godot, bevy, usd };

/// Where things lie in one engine.
struct Convention {
  Engine engine;         ///< whose it is
  const char* name;      ///< as on the command line: "babylon", "three", ...
  const char* title;     ///< "Babylon.js", "three.js", ...
  bool right_handed;     ///< whether the engine's axes are right-handed
  const char* axes;      ///< in words: "left-handed, y up, ..."
  const char* lat_long;  ///< in words: "centre +z, right +x"
  const char* source;    ///< where that can be checked: file and function of the engine; what follows "derived" is
                         ///< concluded from it, the rest stands there

  /// Takes a direction in Welkin's axes to the engine's axes, as a lat-long picture is laid out by both. Orthogonal;
  /// of determinant -1 for left-handed engines.
  dmat3 from_welkin;

  /// Takes a direction in the engine's axes to the one in the frames of `CubemapView` under which the engine's cube
  /// faces hold it. None if the engine has no cubemaps of its own.
  std::optional<dmat3> faces_from_engine;
};

/// How things lie in an engine. Cost: a look into a table.
[[nodiscard]] const Convention& convention(Engine engine) noexcept;

/// All of them, in the order of `Engine`.
[[nodiscard]] std::span<const Convention> conventions() noexcept;

/// By `Convention::name`. Throws `Error` (invalid_argument) listing the names.
[[nodiscard]] const Convention& convention(std::string_view name);

// ---- Babylon.js's polynomial, as version 9.34 has it

/// Babylon.js's SphericalPolynomial: a quadratic in the surface normal (x, y, z), one RGB triple a term.
/// Its values are Lambertian radiance (irradiance / pi) with the cosine factors of bands 1 and 2 carried
/// twice and constants truncated as they are in Babylon.js; its shader's way back undoes that.
struct BabylonPolynomial {
  dvec3 x{};   ///< factor of the normal's x
  dvec3 y{};   ///< of y
  dvec3 z{};   ///< of z
  dvec3 xx{};  ///< of x squared
  dvec3 yy{};  ///< of y squared
  dvec3 zz{};  ///< of z squared
  dvec3 yz{};  ///< of y z
  dvec3 zx{};  ///< of z x
  dvec3 xy{};  ///< of x y
};

/// What CubeMapToSphericalPolynomialTools makes of the same light: irradiance / pi in Babylon's signs (odd
/// orders negated), then SphericalPolynomial.FromHarmonics with its own constants (0.886277 included).
/// Bands above the third are left out, missing ones are zero.
[[nodiscard]] BabylonPolynomial babylon_polynomial(const SphericalHarmonics& radiance);

/// The polynomial of a single ambient colour (a placeholder until the real light is there): that colour
/// for every normal, no direction in it. Exactly `colour` in xx, yy and zz, zero elsewhere.
[[nodiscard]] BabylonPolynomial babylon_constant_polynomial(const dvec3& colour);

/// Returns the polynomial's value for a normal. Throws `Error` (invalid_argument) for one that is zero or not finite.
[[nodiscard]] dvec3 evaluate(const BabylonPolynomial& polynomial, const dvec3& normal);

// ---- Diffuse light in an engine's own form

/// One named number triple of an engine's form.
struct EngineTerm {
  std::string name;  ///< as the engine calls it: "xx", "coefficients[4]", "irradianceCoefficients[0]", ...
  dvec3 rgb{};       ///< red, green, blue
};

/// One named four-vector that an engine's shader reads.
struct EngineVector {
  std::string name;  ///< as the shader calls it: "unity_SHAr", "SkyIrradianceEnvironmentMap[0]", ...
  dvec4 value{};     ///< x, y, z, w as the shader reads them
};

/// Light in an engine's own form.
struct EngineLight {
  Engine engine{};      ///< whose form it is
  std::string form;     ///< the engine's type: "SphericalPolynomial", "SphericalHarmonics3", ...
  std::string formula;  ///< what it is, with pi, signs and order, and how the shader evaluates it; for a person
  std::vector<EngineTerm> terms;  ///< in the engine's order

  /// The same light as the engine packs it for its shader, a channel at a time: seven for Unity and for Unreal, in the
  /// order in which they lie in memory (SHA of red, green and blue, SHB of red, green and blue, SHC); none for engines
  /// whose shaders read the terms.
  std::vector<EngineVector> vectors;
};

/// Returns whether the engine has a form: openexr, blender, bevy and usd have none. The `formula` of Engine::welkin is
/// a GLSL function.
[[nodiscard]] bool has_engine_light(Engine engine) noexcept;

/// The terms of an engine's form from radiance in Welkin's axes: turned to the engine's axes
/// (`Convention::from_welkin`), then signs, order and scale. Bands above the third are left out, missing ones are
/// zero. Coefficients of faces that the engine rendered itself are not in Welkin's axes: see `engine_light_in_place`
/// and `Convention::faces_from_engine`. Throws `Error` (invalid_argument) for an engine that has no such form (openexr,
/// blender, bevy, usd), naming those that do.
[[nodiscard]] EngineLight engine_light(const SphericalHarmonics& radiance, Engine engine);

/// The same without the turn: `radiance` is in the engine's axes already.
[[nodiscard]] EngineLight engine_light_in_place(const SphericalHarmonics& radiance, Engine engine);

}  // namespace welkin
