// Results leave here.
#pragma once

#include <iostream>
#include <string>

#include "welkin/error.h"

namespace welkin::tool {

/// Writes a finished result to standard output in one piece: after an error nothing is there that could be
/// taken for a result. Throws `Error` (file_access) if it cannot be written (a full disk, say).
inline void print_result(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) throw Error(ErrorCode::file_access, "standard output: cannot be written");
}

}  // namespace welkin::tool
