// The details of a plan for one image: faces, rings, near sums, and further steps where its contrast is high.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/standard_library.h"
#include "reflections/band_choice.h"
#include "reflections/halved_faces.h"
#include "reflections/lobe.h"
#include "reflections/near_sums.h"
#include "reflections/prefilter_plan.h"
#include "transform/ring_fft.h"
#include "transform/spectrum.h"

namespace welkin::reflections {
namespace {

constexpr double kEndOversampling = 2.0;   ///< of the synthesis' rings, for spectra that end without a taper
constexpr double kFarOversampling = 1.2;   ///< for narrow lobes' far parts, which have little at their end
constexpr double kMinHalvedTexels = 64.0;  ///< texels of halved faces at the default bounds

int halved_to(int face, double minimum, const ErrorBounds& bounds) noexcept {
  // texels next to the edges of coarser ones gain or lose too much
  const double looser = std::max(1.0, std::min(bounds.rms / 1e-3, bounds.maximum / 1e-2));
  minimum = std::max(minimum, kMinHalvedTexels / std::sqrt(looser));
  while (can_be_halved(face) && face >= 2.0 * minimum) face /= 2;
  return face;
}

/// Returns alpha of the GGX lobe that takes `bands` bands at the default bounds.
double alpha_of_bands(int bands) noexcept {
  return std::clamp(reach_within({}) / (2.0 * std::max(1, bands)), kMinAlpha, 1.0);
}

}  // namespace

PrefilterPlan PrefilterPlan::without(int sharp, int rough) const {
  const auto count = static_cast<int>(mips.size());
  image::require_range("the number of sharp mips that are left out", sharp, 0, count - 1);
  image::require_range("the number of rough mips that are left out", rough, 0, count - 1 - sharp);
  PrefilterPlan rest = *this;
  rest.first_mip += sharp;
  rest.mips.assign(mips.begin() + sharp, mips.end() - rough);
  if (!rest.uses(MipMethod::spectral) && !rest.uses(MipMethod::near_far) && !rest.irradiance) rest.bands = 0;
  return rest;
}

bool PrefilterPlan::uses(MipMethod method) const noexcept {
  return platform::ranges::find(mips, method, &MipPlan::method) != mips.end();
}

int PrefilterPlan::face_for_cubemap(int face) const noexcept {
  const bool ggx = lights.of == LightsOf::ggx;
  const double minimum = ggx ? face_texels_within(ring_alpha, bands_for_dark(tight()), tight())
                             : face_texels_within(alpha_of_bands(bands), bands, {});
  return halved_to(face, minimum, ggx ? tight() : ErrorBounds{});
}

int PrefilterPlan::rows_for_cubemap() const noexcept {
  const double wanted =
      lights.of == LightsOf::ggx ? rings_within(ring_alpha, tight()) : rings_within(alpha_of_bands(bands), {});
  return 2 * transforms::fast_even_length(static_cast<int>(std::ceil(0.5 * wanted)));
}

namespace {

/// Returns the bands of a far part times its reach. Its spectrum falls by a factor of 6 for each unit, what its end
/// leaves of an image by 3 to 4.
double bands_of_reach(double bound) noexcept {
  constexpr double kAtPercent = 7.0;
  constexpr double kOfLogarithm = 0.7;
  constexpr double kLessFromThousandth = 0.15;  // up to a percent
  const double looser = std::clamp(math::logarithm(bound / 1e-3), 0.0, math::logarithm(10.0));
  return kAtPercent + kOfLogarithm * std::max(0.0, math::logarithm(1e-2 / bound)) - kLessFromThousandth * looser;
}

/// Returns the bound on the root mean square error that both amount to.
double least_of(const ErrorBounds& bounds) noexcept { return std::min(bounds.rms, 0.1 * bounds.maximum); }

/// Returns the bands of a lobe that harmonics alone make.
int bands_of_step(double alpha, const ErrorBounds& bounds, int tightenings) {
  if (tightenings == 0) return first_bands_within(alpha, bounds);
  return std::max(bands_within(alpha, bounds.tightened(tightenings)),
                  bands_for_dark(bounds.tightened(tightenings - 1)));
}

/// Returns the texels along an edge of the faces of a lobe's near sums. Few are cut into parts, as their weights err by
/// a share of the square of their size.
int face_of_near_sums(int face, double alpha, const ErrorBounds& bounds) {
  const double bound = least_of(bounds);
  const int minimum = bound > 5e-4 ? 14 : bound > 5e-5 ? 28 : 56;
  int near = halved_to(face, face_texels_within(alpha, 0, bounds), bounds);
  while (near < minimum) near *= 2;
  return near;
}

/// Returns a GGX lobe's mip with near sums, or without if harmonics alone take no longer.
MipPlan split_where_cheaper(const PrefilterPlan& plan, std::shared_ptr<const Lobe> lobe, int size, int face) {
  const ErrorBounds bounds = plan.tight();
  MipPlan mip;
  mip.lobe = std::move(lobe);
  mip.alpha = mip.lobe->alpha();
  mip.size = size;
  mip.method = MipMethod::spectral;
  if (mip.alpha >= kMaxNearAlpha || size % 2 != 0) return mip;
  const NearSplit near =
      cheapest_split(face_of_near_sums(face, mip.alpha, bounds), size, mip.alpha, bands_of_reach(least_of(bounds)));
  constexpr double kWorth = 0.6;  // of the harmonics' time: what is gained is to make up for a step that fails
  const int whole = bands_of_step(mip.alpha, plan.bounds, plan.tightenings);
  if (near.bands > 0 && milliseconds_of(near) < kWorth * milliseconds_of_harmonics(whole)) mip.near = near;
  return mip;
}

/// Gives all splits the bands of the largest, whose reach is shorter then. Returns false if that is too short for a
/// lobe, which is then left to harmonics.
bool share_bands(PrefilterPlan& plan, std::vector<MipPlan>& mips) {
  plan.bands = plan.tightenings > 0 ? bands_for_dark(plan.bounds.tightened(plan.tightenings - 1)) : kBandStep;
  plan.ring_alpha = 1.0;
  for (const MipPlan& mip : mips)
    plan.bands = std::max(plan.bands,
                          mip.near.face > 0 ? mip.near.bands : bands_of_step(mip.alpha, plan.bounds, plan.tightenings));
  for (MipPlan& mip : mips) {
    if (mip.near.face > 0) {
      mip.near.bands = plan.bands;
      const double shorter = std::min(mip.near.reach, bands_of_reach(least_of(plan.tight())) / plan.bands);
      if (shorter < mip.near.reach_of_lobe()) {
        mip.near = {};
        return false;
      }
      mip.near.reach = std::max(mip.near.reach_of_texels(), shorter);
    }
    plan.ring_alpha = std::min(plan.ring_alpha, mip.ring_alpha());
  }
  return true;
}

PrefilterPlan with_near_sums(PrefilterPlan plan, int face) {
  constexpr double kMinBound = 9e-5;
  if (!plan.may_integrate || plan.bands == 0 || least_of(plan.bounds) < kMinBound || face % 2 != 0) return plan;
  std::vector<MipPlan> spectral;
  for (std::size_t k = 0; k < plan.spectral_lobes.size(); ++k)
    spectral.push_back(split_where_cheaper(plan, plan.spectral_lobes[k], plan.spectral_sizes[k], face));
  PrefilterPlan split = plan;
  while (!share_bands(split, spectral)) {
  }
  for (MipPlan& mip : spectral) {
    if (mip.near.face == 0) continue;
    mip.bands.zonal.assign(static_cast<std::size_t>(split.bands), 0.0);
    for (MipPlan& made : split.mips) {
      if (made.lobe != mip.lobe) continue;
      made.near = mip.near;
      made.bands = mip.bands;
    }
    split.near_mips.push_back(std::move(mip));
  }
  return split.near_mips.empty() ? plan : split;
}

/// Splits narrow lobes. Texels in their near parts stay in the image, lights are added to their far parts alone.
void split_near_far(PrefilterPlan& plan, const ImageShape& image) {
  constexpr double kLights = 1.0 / 3.0;     // of the reach, alpha of a lobe as narrow as a far part's peak
  constexpr double kTwoPoints = 2.0 / 3.0;  // of the reach, alpha that two points a texel's edge do for
  const int rows = image.cubemap ? 0 : image.rows;
  const NearSplit finest = near_far_split(image.columns, rows, plan.near_far_size, 0.0);
  const ErrorBounds usual;
  plan.bands = std::max(plan.bands, finest.bands);
  plan.reach = std::max(plan.reach, reach_for(usual.rms, usual.maximum));
  plan.light_alpha = std::min(plan.light_alpha, kLights * finest.reach);
  plan.lights.least_alpha = std::min(plan.lights.least_alpha, kTwoPoints * finest.reach);
  MipPlan whole;
  whole.near = finest;
  plan.ring_alpha = std::min(plan.ring_alpha, whole.ring_alpha());
  for (MipPlan& mip : plan.mips) {
    if (mip.method != MipMethod::near_far) continue;
    mip.near = near_far_split(image.columns, rows, mip.size, mip.alpha);
    mip.bands.zonal.assign(static_cast<std::size_t>(mip.near.bands), 0.0);
  }
}

/// Returns a plan of GGX lobes with more bands and rings.
PrefilterPlan tightened(PrefilterPlan plan, int step) {
  plan.tightenings = step;
  const auto bands_of = [&](double alpha, const ErrorBounds& bounds) {
    return std::min(transforms::kMaximumSpectrumBands, bands_of_step(alpha, bounds, step));
  };
  for (MipPlan& mip : plan.mips) {
    if (mip.method == MipMethod::spectral) mip.bands = tapered_lobe(mip.alpha, bands_of(mip.alpha, plan.bounds));
  }
  if (plan.bands == 0) return plan;
  for (const auto& lobe : plan.spectral_lobes) plan.bands = std::max(plan.bands, bands_of(lobe->alpha(), plan.bounds));
  if (plan.irradiance) {  // whose bounds are not tighter than the chain's
    MipPlan& mip = *plan.irradiance;
    mip.bands = tapered_lobe(mip.alpha, std::min(plan.bands, bands_of(mip.alpha, plan.irradiance_bounds)));
  }
  return plan;
}

/// Returns a plan of other lobes that no image makes this one exceed.
PrefilterPlan largest(PrefilterPlan plan) {
  if (plan.bands == 0) return plan;
  const auto ends = [](const auto& lobe) { return lobe->last_band() > 0; };
  if (!platform::ranges::all_of(plan.spectral_lobes, ends)) plan.bands = transforms::kMaximumSpectrumBands;
  for (MipPlan& mip : plan.mips) {
    if (mip.method != MipMethod::spectral) continue;
    const int last = mip.lobe->last_band();
    mip.bands.zonal.assign(static_cast<std::size_t>(last > 0 ? last : plan.bands), 0.0);
  }
  return plan;
}

}  // namespace

PrefilterPlan PrefilterPlan::at_step(int step, const ImageShape& image) const {
  if (lights.of != LightsOf::ggx) return step > 0 ? largest(*this) : *this;
  constexpr int kMaxEdgeSearched = 64;  // `ImageSums` show what few bands do not
  PrefilterPlan plan = step > 0 ? reflections::tightened(*this, step) : *this;
  const bool unseen = !image.cubemap || image.columns > kMaxEdgeSearched;
  if (step == 0 && bands > 0 && unseen) plan.bands = std::max(bands, bands_for_dark(bounds));
  if (image.cubemap) plan = with_near_sums(plan, image.columns);
  if (step == 0 && near_far_size > 0) split_near_far(plan, image);
  return plan;
}

transforms::GridSize MipPlan::grid() const noexcept {
  if (method == MipMethod::near_far) return transforms::grid_for_bands(bands.bands(), kFarOversampling);
  return lobe->last_band() > 0 ? transforms::grid_for_bands(bands.bands(), kEndOversampling)
                               : transforms::grid_for_bands(bands.bands());
}

}  // namespace welkin::reflections
