// `welkin sh`: an environment's spherical harmonics.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

/// Adds the subcommand; parsing it runs it. Throws what the library throws.
void add_sh_command(CLI::App& program);

}  // namespace welkin::tool
