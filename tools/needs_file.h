// What a scene needs as JSON, what work costs as JSON, and plans.
#pragma once

#include <filesystem>

#include "tools/json_text.h"
#include "welkin/cost_model.h"
#include "welkin/plan.h"
#include "welkin/scene_needs.h"

namespace welkin::tool {

/// Every member; "glossy" is {"least", "greatest"}, or null where there are no glossy materials;
/// "error_budget" a number or null.
[[nodiscard]] Json needs_json(const SceneNeeds& needs);
/// What is missing is as in a default `SceneNeeds`. Throws `Error`: file_access, limit_exceeded (more than a megabyte),
/// corrupt_file naming the key, for what is no JSON and for members of another name, kind or range.
[[nodiscard]] SceneNeeds read_needs(const std::filesystem::path& path);

/// Nanoseconds by name: what `welkin report --calibrate` writes and `--costs` reads. Missing ones are the stored ones.
[[nodiscard]] Json costs_json(const CostModel& costs);
/// Throws as `read_needs`; each must be above 0.
[[nodiscard]] CostModel read_costs(const std::filesystem::path& path);
void save_costs(const CostModel& costs, const std::filesystem::path& path);

[[nodiscard]] Json plan_json(const Plan& plan);

}  // namespace welkin::tool
