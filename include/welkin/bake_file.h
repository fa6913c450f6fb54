// Bakes of files: read whole and baked, or planned with what the file carries already.
#pragma once

#include <filesystem>

#include "welkin/bake.h"
#include "welkin/control.h"
#include "welkin/cost_model.h"
#include "welkin/environment_file.h"
#include "welkin/export.h"
#include "welkin/plan.h"
#include "welkin/scene_needs.h"
#include "welkin/stored_environment.h"

namespace WELKIN_EXPORT welkin {

/// Reads and bakes a file: all that `read_environment` reads; the full size of .env, KTX2 and DDS cubemaps. Throws as
/// `read_environment` too.
[[nodiscard]] BakeResult bake_file(const std::filesystem::path& path, const ReadOptions& read_options = {},
                                   const BakeOptions& options = {}, const Control& control = {});

/// Of a file that was probed: with what it carries. Where nothing wants pixels it is projected while it is read, or not
/// even read. Nothing is read here: an error budget is refused as of a shape.
[[nodiscard]] Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& whole = {},
                        const CostModel& costs = {});

/// Carries out the plan of a file. Throws as `bake` and `bake_file`, and invalid_argument for another file's plan.
[[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

}  // namespace welkin
