// Options of C about files.
#pragma once

#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// Throw `Error` (invalid_argument).
[[nodiscard]] ReadOptions file_options(const welkin_read_options* options);
[[nodiscard]] TextureOptions texture_options(const welkin_texture_options* options);

}  // namespace welkin::c_interface
