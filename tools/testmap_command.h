// `welkin testmap`: an environment that shows by itself how it is turned.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

/// Adds the subcommand; parsing it runs it. Throws what the library throws.
void add_testmap_command(CLI::App& program);

}  // namespace welkin::tool
