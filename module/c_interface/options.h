// What a caller asks of a projection and of a file. Null asks for nothing; zero is the default.
#pragma once

#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// These throw `Error` (invalid_argument) for what no structure could hold; ranges are checked by those who use them.
[[nodiscard]] ProjectionOptions projection_options(const welkin_projection_options* options);
[[nodiscard]] ReadOptions file_options(const welkin_read_options* options);

}  // namespace welkin::c_interface
