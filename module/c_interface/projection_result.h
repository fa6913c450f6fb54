// A projection, written to the caller's structure.
#pragma once

#include "welkin/projection.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// Throws `Error` (invalid_argument) for null, and if the structure ends before the coefficients of that many bands do.
void require_room(const welkin_projection* projection, int bands);

/// Throws likewise; nothing is written then.
void write_projection(welkin_projection* projection, const Projection& light);

}  // namespace welkin::c_interface
