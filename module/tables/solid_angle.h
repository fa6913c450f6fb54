// The solid angle of a part of a cubemap face.
#pragma once

#include "simd/kernels.h"

namespace welkin::tables {

/// Int Int (1 + u^2 + v^2)^-3/2 du dv over the rectangle of half-widths (u_half, v_half) around (u, v), in steradians,
/// by a product Gauss rule: no difference of large angles, so small texels keep all digits.
[[nodiscard]] double rectangle_solid_angle(double u, double v, double u_half, double v_half,
                                           const simd::GaussRule& rule) noexcept;

}  // namespace welkin::tables
