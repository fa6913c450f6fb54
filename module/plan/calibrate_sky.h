// The sky's share of a calibration.
#pragma once

#include "welkin/control.h"
#include "welkin/cost_model.h"

namespace welkin::planning {

/// Fills in what a sky's passes cost.
void calibrate_sky(CostModel& costs, const Control& control);

}  // namespace welkin::planning
