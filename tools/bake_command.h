// `welkin bake`: an environment to all that a renderer loads.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/bake_options.h"

namespace welkin::tool {

void add_bake_command(CLI::App& program);

/// Bakes what the options name or compute into their folder. The manifest or, for a person, a table. Throws `Error`.
[[nodiscard]] std::string bake_to_folder(const BakeCommandOptions& options);

}  // namespace welkin::tool
