// A bake must not write over what it reads.
#pragma once

#include <string>
#include <vector>

#include "tools/bake_options.h"

namespace welkin::tool {

/// The names in the output folder that a bake of these options writes, manifest included. `bake`: of
/// `library_options`.
[[nodiscard]] std::vector<std::string> names_to_write(const BakeCommandOptions& options, const BakeOptions& bake);

/// Throws `Error`: file_access if one of those is a file of the input (by whatever name or link), of six files and of a
/// directory any of the six; what `inspect_environment` throws.
void check_input_is_kept(const BakeCommandOptions& options, const BakeOptions& bake);

}  // namespace welkin::tool
