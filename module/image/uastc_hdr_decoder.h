// Reads blocks of UASTC HDR (uastc_hdr.h), of all of the format's 24 kinds and not only of those that are written here.
#pragma once

#include <cstdint>

namespace welkin::image {

/// Rows of a picture of blocks. `blocks`: the row of blocks that holds `first_row`, those below it follow.
/// rgb: [rows][width][3]. A block that the format does not have gives NaN.
void decode_uastc_hdr_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) noexcept;

}  // namespace welkin::image
