// The caller's pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "welkin/image_view.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

/// A cubemap and the levels behind it. Throws `Error` (invalid_argument) for null, for a count that is none, for sizes
/// that differ, for unknown formats. Whether the pixels are sound is left to those who read them.
[[nodiscard]] std::vector<CubemapView> cubemap_views(const welkin_cubemap* mips, std::int32_t mip_count);

/// Throws likewise.
[[nodiscard]] LatLongView lat_long_view(const welkin_lat_long* lat_long);

// What a caller asks of a projection and of a file. Null asks for nothing; zero is the default.

/// These throw `Error` (invalid_argument) for what no structure could hold; ranges are checked by those who use them.
[[nodiscard]] ProjectionOptions projection_options(const welkin_projection_options* options);

// A projection, written to the caller's structure.

/// Throws `Error` (invalid_argument) for null, and if the structure ends before the coefficients of that many bands do.
void require_room(const welkin_projection* projection, int bands);

/// Throws likewise; nothing is written then.
void write_projection(welkin_projection* projection, const Projection& light);

// Coefficients as plain numbers.

/// 3 bands^2 numbers. Throws `Error` (invalid_argument) for null or for bands out of range.
[[nodiscard]] SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name);

}  // namespace welkin::c_interface
