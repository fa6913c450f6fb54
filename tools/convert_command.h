// `welkin convert`: an environment in another format, layout, size or orientation.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

/// Adds the subcommand; parsing it runs it. Throws what the library throws.
void add_convert_command(CLI::App& program);

}  // namespace welkin::tool
