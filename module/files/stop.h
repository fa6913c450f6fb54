// A caller's wish to stop, inside work that is no tile of its own.
#pragma once

#include <stop_token>

#include "welkin/error.h"

namespace welkin::files {

/// Throws `Error` (cancelled) once stop is requested.
inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
}

}  // namespace welkin::files
