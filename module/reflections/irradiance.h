// Irradiance as a cubemap: an image blurred by the Lambert lobe, which is a mip of roughness 1 times pi.
#pragma once

#include "projection/sanitized_pixels.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Returns how irradiance alone is made within `rms_error` rms and ten times that at any texel: a chain without mips.
/// Without bands the bound is so narrow that the integral itself is taken.
[[nodiscard]] PrefilterPlan plan_irradiance(int size, double rms_error);

/// Makes irradiance one more synthesis of a chain's harmonics if they keep the bound. That follows from sizes and
/// bounds alone, before mips are left out of the chain. Returns whether it does.
[[nodiscard]] bool share_harmonics(PrefilterPlan& chain, int size, double rms_error);

/// Throws `Error` (invalid_argument) unless `rms_error` is from 1e-6 to 1.
void check_irradiance_error(double rms_error);

/// Returns irradiance by a plan, of whose mips none is made: bright texels each by the clipped cosine, the rest by
/// harmonics. Not negative where the source is not. Values beyond the floats become the largest float. The same bits on
/// any number of threads and instruction set. Cost: one reading of the source, and below 10 ns per texel of the result;
/// 5 ns per texel of the source and of the result where the integral itself is taken. Throws `Error`: cancelled;
/// limit_exceeded, where the estimated error exceeds the bound.
[[nodiscard]] IrradianceMap irradiance_cubemap(const projection::SanitizedSource& source, PrefilterPlan plan,
                                               const Control& control);

/// The integral itself.
[[nodiscard]] IrradianceMap integrated_irradiance(const projection::SanitizedSource& source, int size,
                                                  const Control& control);

}  // namespace welkin::reflections
