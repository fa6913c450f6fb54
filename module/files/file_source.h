// A file as the source of a bake.
#pragma once

#include "bake/artefacts.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"

namespace welkin::files {

/// The plan of a bake of everything that the options ask for: of what the file carries its light alone is taken, which
/// is more than its pixels hold.
[[nodiscard]] Plan plan_whole(const StoredEnvironment& file, const BakeOptions& options);

/// Bakes a file; what is said of a rejected pixel names it. Throws as `run_bake`.
[[nodiscard]] BakeResult bake_file_source(const StoredEnvironment& file, const Plan& plan, baking::ArtefactStore* store,
                                          const Control& control);

}  // namespace welkin::files
