// The commands of the program.
#pragma once

#include <string>

#include "tools/arguments.h"
#include "welkin/core.h"

namespace welkin::tool {

struct BakeCommandOptions;

[[nodiscard]] Command bake_command();
[[nodiscard]] Command sh_command();
[[nodiscard]] Command sky_command();
[[nodiscard]] Command info_command();
[[nodiscard]] Command check_command();
[[nodiscard]] Command convert_command();
[[nodiscard]] Command testmap_command();
[[nodiscard]] Command sample_command();
[[nodiscard]] Command importance_command();
[[nodiscard]] Command batch_command();

/// Bakes the input or sky of the options into their folder; concurrent bakes need folders of their own. `settle_files`
/// has been called. Returns the manifest or, for a person, a table. Throws `Error`.
[[nodiscard]] std::string bake_to_folder(const BakeCommandOptions& options, const Control& control);

}  // namespace welkin::tool
