// Priorities are numbers around 0, the default.
#pragma once

#include "welkin/job.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// Throws `Error` (invalid_argument) if there is none of that number.
[[nodiscard]] Priority priority_of(welkin_priority priority);

[[nodiscard]] welkin_priority number_of(Priority priority) noexcept;

}  // namespace welkin::c_interface
