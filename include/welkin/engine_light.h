// A radiance projection in the form in which an engine wants it.
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "welkin/convention.h"
#include "welkin/export.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// One named number triple of an engine's form.
struct EngineTerm {
  std::string name;  ///< as the engine calls it: "xx", "coefficients[4]", "irradianceCoefficients[0]", ...
  glm::dvec3 rgb{};  ///< red, green, blue
};

/// One named four-vector that an engine's shader reads.
struct EngineVector {
  std::string name;    ///< as the shader calls it: "unity_SHAr", "SkyIrradianceEnvironmentMap[0]", ...
  glm::dvec4 value{};  ///< x, y, z, w as the shader reads them
};

/// Light in an engine's own form.
struct EngineLight {
  Engine engine{};      ///< whose form it is
  std::string form;     ///< the engine's type: "SphericalPolynomial", "SphericalHarmonics3", ...
  std::string formula;  ///< what it is, with pi, signs and order, and how the shader evaluates it; for a person
  std::vector<EngineTerm> terms;  ///< in the engine's order

  /// The same light as the engine packs it for its shader, a channel at a time: seven for Unity and for Unreal, in the
  /// order in which they lie in memory; none for engines whose shaders read the terms.
  std::vector<EngineVector> vectors;
};

/// Whether the engine has a form of its own: not welkin, openexr, blender.
[[nodiscard]] bool has_engine_light(Engine engine) noexcept;

/// The terms of an engine's form from radiance in Welkin's axes: turned to the engine's axes
/// (`Convention::from_welkin`), then signs, order and scale. Bands above the third are left out, missing ones are
/// zero. Throws `Error` (invalid_argument) for an engine that has no such form (openexr, blender), naming those that
/// do.
[[nodiscard]] EngineLight engine_light(const SphericalHarmonics& radiance, Engine engine);

/// The same without the turn: `radiance` is in the engine's axes already.
[[nodiscard]] EngineLight engine_light_in_place(const SphericalHarmonics& radiance, Engine engine);

}  // namespace welkin
