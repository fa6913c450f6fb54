// A file as the source of a bake.
#pragma once

#include "bake/artefacts.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"

namespace welkin::files {

/// Bakes a file; what is said of a rejected pixel names it. Throws as `run_bake`.
[[nodiscard]] BakeResult bake_file_source(const StoredEnvironment& file, const Plan& plan, baking::ArtefactStore* store,
                                          const Control& control);

}  // namespace welkin::files
