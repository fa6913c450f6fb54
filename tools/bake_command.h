// `welkin bake`: an environment to all that a renderer loads.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

void add_bake_command(CLI::App& program);

}  // namespace welkin::tool
