// The near part of a narrow lobe, as either kind of source needs it.
#include "reflections/near_parts.h"

#include <cmath>
#include <numbers>

#include "math/elementary.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

/// The Gaussians from the split on: see `kGaussianStep`. Their weights are their integrals over the sphere; t + 2 in
/// place of t is the lobe's factor 1 - 2 s.
GaussianLobe gaussians_of(double split, double q) {
  constexpr double end = 14.0;  // t q: 1e-5 of the lobe lies beyond
  const double ratio = math::exponential(kGaussianStep);
  GaussianLobe lobe{};
  for (double t = split; lobe.count < GaussianLobe::kMost && (lobe.count == 0 || t * q < end); t *= ratio) {
    const double weight = kGaussianStep * t * t * math::exponential(-t * q) / (t + 2.0);
    lobe.root[lobe.count] = static_cast<float>(0.5 * std::sqrt(t + 2.0));
    lobe.weight[lobe.count] = static_cast<float>(0.25 * q * weight);
    ++lobe.count;
  }
  return lobe;
}

SplitLobe split_lobe(const NarrowSplit& split, double alpha) {
  const double square = alpha * alpha;
  const double rest = 1.0 - square;
  SplitLobe lobe{};
  lobe.width_squared = static_cast<float>(4.0 * square);
  lobe.split = static_cast<float>(split.split);
  lobe.offset = static_cast<float>(split.split * square / rest);
  lobe.far_scale = static_cast<float>(square * split.split * split.split / (4.0 * std::numbers::pi * rest * rest));
  return lobe;
}

}  // namespace

void add_near_parts(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha, int size,
                    const std::array<float*, 6>& faces, const Control& control) {
  const double energy = 1.0 - far_part(source.cubemap(), split, alpha, 1).front();
  const NearPart part{source, split, energy, size, faces};
  if (source.cubemap()) {
    add_cubemap_near(part, split_lobe(split, alpha), control);
  } else {
    add_lat_long_near(part, gaussians_of(split.split, alpha * alpha / (1.0 - alpha * alpha)), control);
  }
}

}  // namespace welkin::reflections
