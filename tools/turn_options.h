// How an environment is turned between its file and its result: conventions, yaw, mirror, quaternion.
#pragma once

#include <CLI/CLI.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <string>

#include "welkin/convention.h"

namespace welkin::tool {

struct TurnOptions {
  Engine from = Engine::welkin;
  Engine to = Engine::welkin;
  double yaw_degrees = 0.0;
  bool mirror = false;
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

/// --for alone: of light that was never in a file.
void add_engine_option(CLI::App& command, TurnOptions& options);

/// --from, --for, --yaw, --mirror, --rotation.
void add_turn_options(CLI::App& command, TurnOptions& options);

/// Takes a direction as the file has it (by the frames of LatLongView or CubemapView) to the one in which the result
/// has it, in the axes of the engine that it is for: out of the file's convention, mirrored (x changes its sign),
/// turned by the quaternion and then about y, in Welkin's axes, and into the engine's. For coefficients and lights.
[[nodiscard]] glm::dmat3 turn_of_light(const TurnOptions& options, bool source_is_cubemap);

/// The same where the result is a picture, by the frames of LatLongView or CubemapView: a cubemap's faces are where
/// the engine looks for them; a lat-long is the same picture for all engines.
[[nodiscard]] glm::dmat3 turn_of_picture(const TurnOptions& options, bool source_is_cubemap, bool result_is_cubemap);

/// The result's axes in words.
[[nodiscard]] std::string axes_text(const TurnOptions& options);

}  // namespace welkin::tool
