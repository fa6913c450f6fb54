// `welkin sh`: an environment's spherical harmonics.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/sh_options.h"
#include "tools/sh_report.h"

namespace welkin::tool {

/// Adds the subcommand; parsing it runs it. Throws what the library throws.
void add_sh_command(CLI::App& program);

[[nodiscard]] std::string sh_formatted(const ShReport& report, ShFormat format);

}  // namespace welkin::tool
