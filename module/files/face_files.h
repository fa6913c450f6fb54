// Six files as one vertical strip.
#pragma once

#include <memory>

#include "files/row_source.h"

namespace welkin::files {

/// A strip N x 6N, layout six_files, whose rows come from the six square pictures of `face_files(path)`, each a
/// section of its own. Throws as `inspect_environment`; unsupported_file naming the file that is not square or not
/// of the first one's size.
[[nodiscard]] std::unique_ptr<RowSource> open_six_files(const std::filesystem::path& path, const ReadOptions& options,
                                                        const std::string& reason);

}  // namespace welkin::files
