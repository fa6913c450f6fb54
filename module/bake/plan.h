// Plans put together: what photographs, files and changes have in common.
#pragma once

#include <vector>

#include "bake/bake_plan.h"
#include "bake/needs.h"
#include "welkin/plan.h"

namespace welkin::baking {

/// `stored`: what the source brings along and may be taken.
[[nodiscard]] Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored,
                               const CostModel& costs);

}  // namespace welkin::baking
