// The prefilter's internal interface: what it leaves for callers that bake more than reflections.
#pragma once

#include <cstddef>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "reflections/prefilter_plan.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

/// An irradiance cubemap, W/m2 for W/m2/sr, and how it was made: as a mip of roughness 1 times pi.
struct IrradianceMap {
  Cubemap cubemap;
  MipRecord record;
};

/// Blurs a sanitized source by the lobes of a plan. The result reuses `into` if that has its shape. `pixels` of it
/// is empty but for the passes: see `describe_pixels`. `irradiance` takes that of the plan, and may be null without
/// one. Throws `Error` (cancelled, limit_exceeded).
[[nodiscard]] PrefilteredSpecular prefilter(const projection::SanitizedSource& source, const PrefilterPlan& plan,
                                            Cubemap into, const Control& control, IrradianceMap* irradiance = nullptr);

/// Sanitizes a view, then does the same, and describes its pixels. Throws `Error` (rejected_pixel) as well.
[[nodiscard]] PrefilteredSpecular prefilter(const EnvironmentView& view, const PrefilterPlan& plan,
                                            const PixelPolicy& pixels, Cubemap into, const Control& control);

/// Makes the tables that cubemaps of such faces take by the plan, if they are not kept yet. Throws `Error` (cancelled).
void make_tables(const PrefilterPlan& plan, int face_size, const Control& control);

/// The power of two that an image is to be multiplied by before it is transformed: 2^-100 where a magnitude is above
/// 1e18 and sums over it would leave the range of floats, 2^100 where none is above 1e-25 and they would lose bits, 1
/// elsewhere and of black.
[[nodiscard]] float safe_scale(const projection::SanitizedSource& source) noexcept;

/// Resamples a source by area into a level of `chain`: a copy of a cubemap of the same size.
void fill_level(const projection::SanitizedSource& source, Cubemap& chain, int level, const Control& control);

/// Fills in `pixels`, but for its passes: what was read, as sanitizing found it. The total radiance is that of the mip
/// with the most texels: centres stand for texels there.
void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular);

// Irradiance as a cubemap: an image blurred by the Lambert lobe, which is a mip of roughness 1 times pi.

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
