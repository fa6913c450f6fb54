// The BRDF table as files.
#pragma once

#include "tools/bake_options.h"
#include "tools/output_folder.h"

namespace welkin::tool {

/// Writes the table in each container that was asked for and that can hold a plain picture.
void write_brdf(const BrdfTable& table, const BakeCommandOptions& options, OutputFolder& folder,
                const Control& control);

/// The names of those files.
[[nodiscard]] std::vector<std::string> brdf_names(const BakeCommandOptions& options);

/// What its channels are, for the manifest.
[[nodiscard]] std::vector<std::string> brdf_channels(const BrdfTableOptions& options);

}  // namespace welkin::tool
