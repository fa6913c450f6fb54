// How the job that a caller's function runs for is steered.
#pragma once

#include "welkin/control.h"
#include "welkin/welkin.h"

/// Lives on the stack of whoever calls the function.
struct welkin_control {
  const welkin::Control& control;
};

namespace welkin::c_interface {

/// One that asks for nothing if it is null.
[[nodiscard]] Control control_of(const welkin_control* control);

}  // namespace welkin::c_interface
