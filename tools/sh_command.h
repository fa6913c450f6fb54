// What `welkin sh` can be asked, and what of that other commands share.
#pragma once

#include <optional>
#include <string>

#include "tools/arguments.h"
#include "tools/input.h"
#include "tools/sh_report.h"
#include "tools/turning.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

enum class ShFormat { table, json, text, c_header, glsl, c_sharp };

struct ShOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the built-in sky
  bool sky = false;                  ///< `--sky`; the command wants either this or an input
  ShFormat format = ShFormat::table;
  ProjectionOptions projection;
  int target_size = 0;  ///< 0: none
  ClampChoice clamp;
  TurnOptions turn;
  SunChoice sun;
  Window window = Window::none;
  double window_width = 0.0;
  bool irradiance_error = false;
};

/// --format and --json.
void add_format_options(Options& table, ShOptions& options);
void add_bands_option(Options& table, ShOptions& options);
/// --window and --window-width.
void add_window_options(Options& table, ShOptions& options);

/// Fills in what follows from `report.projection.radiance`, which is in the result's axes, and from the options:
/// window, dominant light, irradiance, the forms of engines.
void complete(ShReport& report, const ShOptions& options);

/// Throws `Error` (invalid_argument) for C# of another engine than Unity.
[[nodiscard]] std::string sh_formatted(const ShReport& report, ShFormat format);

}  // namespace welkin::tool
