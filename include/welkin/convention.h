// Where things lie in other engines: their axes, their lat-longs, their cube faces.
//
// An environment in Welkin lives in Welkin's axes: right-handed, y up, a lat-long's centre along +z and +x a quarter
// in from the left (as in OpenEXR). A convention says how the same surroundings lie in an engine's axes, so that a
// person who looks around in the engine sees the same picture, not mirrored.
#pragma once

#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

enum class Engine { welkin, openexr, babylon, three, filament, gltf, unity, unreal, blender, godot };

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
  glm::dmat3 from_welkin;

  /// Takes a direction in the engine's axes to the one in the frames of `CubemapView` under which the engine's cube
  /// faces hold it. None if the engine has no cubemaps of its own.
  std::optional<glm::dmat3> faces_from_engine;
};

[[nodiscard]] const Convention& convention(Engine engine) noexcept;

/// All of them, in the order of `Engine`.
[[nodiscard]] std::span<const Convention> conventions() noexcept;

/// By `Convention::name`. Throws `Error` (invalid_argument) listing the names.
[[nodiscard]] const Convention& convention(std::string_view name);

}  // namespace welkin
