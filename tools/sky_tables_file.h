// Tables of a sky: from a file if they fit, else made, and kept there.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "welkin/control.h"
#include "welkin/sky_tables.h"

namespace welkin::tool {

struct ReadyTables {
  std::shared_ptr<const SkyTables> tables;
  PassRecord pass;  ///< "reuse" or "run", and why
};

/// Without a file they are made. With one that is there, they are its if atmosphere and options are what is asked for;
/// else they are made and saved over it. A file that holds no tables is left as it is, and an error: corrupt_file,
/// unsupported_file. Throws what `precompute_sky`, `load_sky_tables` and `save_sky_tables` throw.
[[nodiscard]] ReadyTables ready_tables(const Atmosphere& atmosphere, const SkyTableOptions& options,
                                       const std::optional<std::string>& file, const Control& control);

}  // namespace welkin::tool
