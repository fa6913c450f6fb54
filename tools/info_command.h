// `welkin info`: what is in an environment file.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

/// Adds the subcommand; parsing it runs it. Throws what the library throws.
void add_info_command(CLI::App& program);

}  // namespace welkin::tool
