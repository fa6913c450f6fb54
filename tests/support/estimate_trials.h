// Every kind of result with an estimate of its error, on random environments, against its true error in double.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/honesty.h"
#include "welkin/image.h"

namespace welkin::test {

/// Trials by the kind of result, in the order of their names.
using EstimateTrials = std::map<std::string, std::unique_ptr<Honesty>>;

struct RoughnessSpan {
  double least;
  double most;
  double rms_error = 1e-3;  ///< asked for
};

/// Makes `count` environments of the seeds from `seed` on (of suns, noise, patterns, gradients, horizons; dark ones;
/// cubemaps of 4 to 20 texels and lat-longs of 6 to 32 rows; now and then one of `pictures`, turned into such a one),
/// projects each, prefilters each to a mip of a roughness within `roughness`, and adds what was estimated and what is
/// true. Errors of projections are relative to the norm of the coefficients, those of mips (if their record has an
/// estimate) to their root mean square over the sphere, at up to 192 of its texels.
void add_estimate_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness,
                         const std::vector<Cubemap>& pictures, EstimateTrials& trials);

/// The same of environments of each `Family` in turn, by up to nine bands. Their sources have 4 to 16 rows, or with
/// `large` up to 24, and now and then 67, 72 or 88. Where `roughness` begins below 0.1, two fifths are below that. Now
/// and then a mip of a chain of 16 or 64 is judged, too.
void add_family_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness, bool large,
                       EstimateTrials& trials);

/// Makes `count` environments of the seeds from `seed` on, of all kinds and families and of `pictures`, blurs each by a
/// lobe other than GGX (Charlie of 0.05 to 1, Phong and Blinn of 1 to 2000, Lambert, given spectra) to a mip of 4 to 32
/// texels, now and then 64, within 1e-3 or 1e-4, and adds what was estimated and what is true. Returns how many were
/// refused.
int add_lobe_trials(std::uint32_t seed, int count, const std::vector<Cubemap>& pictures, EstimateTrials& trials);

}  // namespace welkin::test
