// How an environment is turned between its file and its result: conventions, yaw, mirror, quaternion.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <string>

#include "tools/arguments.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/image.h"

namespace welkin::tool {

struct OrientationOptions {
  Engine from = Engine::welkin;
  Engine to = Engine::welkin;
  double yaw_degrees = 0.0;
  bool mirror = false;
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

/// --for alone: of light that was never in a file.
void add_engine_option(Options& table, OrientationOptions& options);

/// --from, --for, --yaw, --mirror, --rotation.
void add_orientation_options(Options& table, OrientationOptions& options);

/// Takes a direction as the file has it (by the frames of LatLongView or CubemapView) to the one in which the result
/// has it, in the axes of the engine that it is for: out of the file's convention, mirrored (x changes its sign),
/// turned by the quaternion and then about y, in Welkin's axes, and into the engine's. For coefficients and lights.
[[nodiscard]] glm::dmat3 light_rotation(const OrientationOptions& options, bool source_is_cubemap);

/// The same where the result is a picture, by the frames of LatLongView or CubemapView: a cubemap's faces are where
/// the engine looks for them; a lat-long is the same picture for all engines.
[[nodiscard]] glm::dmat3 picture_rotation(const OrientationOptions& options, bool source_is_cubemap,
                                          bool result_is_cubemap);

/// The result's axes in words.
[[nodiscard]] std::string axes_text(const OrientationOptions& options);

/// What takes Welkin's axes to the places in the engine's cube faces: one of the cube's 48 symmetries. Throws `Error`
/// (invalid_argument) for an engine that has no cube faces.
[[nodiscard]] glm::dmat3 faces_of(Engine engine);

/// Every texel is moved as it is.
[[nodiscard]] Cubemap rotate(const Cubemap& chain, const glm::dmat3& symmetry, const Control& control);

}  // namespace welkin::tool
