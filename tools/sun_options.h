// The options of commands that can take the sun out of an environment, and what they say of it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "welkin/directional_light.h"

namespace welkin::tool {

struct SunChoice {
  bool take_out = false;
  SunOptions options;
};

/// --take-out-sun, which is returned, and --sun-threshold, --sun-radius, --sun-contrast, --sun-share.
CLI::Option* add_sun_options(CLI::App& command, SunChoice& choice);

/// Some lines for a person about the sun that was taken out or is apart, or that there was none.
[[nodiscard]] std::string sun_text(const std::optional<Sun>& sun, bool z_is_up);

}  // namespace welkin::tool
