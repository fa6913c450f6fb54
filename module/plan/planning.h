// Plans put together: what photographs, files and changes have in common.
#pragma once

#include <vector>

#include "bake/bake_plan.h"
#include "plan/needed_options.h"
#include "welkin/plan.h"

namespace welkin::planning {

/// `stored`: what the source brings along and may be taken.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed,
                               const baking::StoredKinds& stored, const CostModel& costs);

}  // namespace welkin::planning
