// What `welkin sh` can be asked.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "tools/options.h"
#include "tools/pixel_options.h"
#include "tools/sun_options.h"
#include "tools/turn_options.h"
#include "welkin/projection.h"
#include "welkin/windowing.h"

namespace welkin::tool {

enum class ShFormat { table, json, text, c_header };

struct ShOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the built-in sky
  ShFormat format = ShFormat::table;
  ProjectionOptions projection;
  ClampChoice clamp;
  TurnOptions turn;
  SunChoice sun;
  Window window = Window::none;
  double window_width = 0.0;
  bool irradiance_error = false;
};

/// --format, which is returned, and --json.
CLI::Option* add_format_options(CLI::App& command, ShOptions& options);
void add_bands_option(CLI::App& command, ShOptions& options);
/// --window and --window-width.
void add_window_options(CLI::App& command, ShOptions& options);

/// Adds all options to the command. `options` must outlive it.
void add_sh_options(CLI::App& command, ShOptions& options);

}  // namespace welkin::tool
