// The options that say what becomes of a pixel before it is light.
#pragma once

#include <CLI/CLI.hpp>

#include "welkin/projection.h"

namespace welkin::tool {

/// A clamp as it is put together from two options, either of which may be absent.
struct ClampChoice {
  RadianceClamp clamp;
  bool clamps = false;

  void apply(ProjectionOptions& options) const {
    if (clamps) options.clamp = clamp;
  }
};

[[nodiscard]] CLI::Validator finite_and_positive();

/// --clamp, --preserve-clamped, --gamma, --nan, --infinity, --negative.
void add_pixel_options(CLI::App& command, ProjectionOptions& options, ClampChoice& clamp);

}  // namespace welkin::tool
