// `welkin sky`: the light of a computed sky.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

void add_sky_command(CLI::App& program);

}  // namespace welkin::tool
