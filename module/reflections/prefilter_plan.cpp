#include "reflections/prefilter_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "reflections/halved_faces.h"
#include "transform/ring_fft.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr int kLargestSize = 8192;
constexpr double kLeastAlpha = 1e-6;      ///< below, a lobe is narrower than any texel by far: a copy
constexpr double kEndOversampling = 2.0;  ///< of the synthesis' rings, for spectra that end without a taper
constexpr double kLeastRmsError = 1e-6;   ///< what float arithmetic leaves
constexpr double kLeastMaximumError = 1e-5;
constexpr double kLeastHalved = 64.0;  ///< texels of halved faces at the default bounds

[[noreturn]] void refuse(ErrorCode code, const std::string& message) { throw Error(code, message); }

void check_error_bound(const char* what, double value, double least, PrefilterMethod method) {
  if (!(value > 0.0 && value <= 1.0))
    refuse(ErrorCode::invalid_argument,
           std::string(what) + " is " + platform::number_text(value) + "; it must be above 0, at most 1");
  if (value >= least || method == PrefilterMethod::reference) return;
  refuse(ErrorCode::limit_exceeded, std::string(what) + " below " + (least < 5e-6 ? "1e-6" : "1e-5") +
                                        " is more than float arithmetic gives; the reference method has no bound");
}

void check_lobe(const PrefilterOptions& options) {
  if (static_cast<int>(options.lobe) < 0 || options.lobe > LobeFamily::spectra) {
    refuse(ErrorCode::invalid_argument,
           "the lobe " + std::to_string(static_cast<int>(options.lobe)) + " is unknown; pass one of the enumerators");
  }
  if ((options.lobe == LobeFamily::spectra) == !options.spectra.empty()) return;
  refuse(ErrorCode::invalid_argument, options.spectra.empty()
                                          ? "the lobe is spectra, and there are none; pass one for each mip"
                                          : std::string("spectra are given, and the lobe is ") + name(options.lobe) +
                                                "; set it to spectra, or leave them out");
}

double least_roughness(LobeFamily lobe) noexcept {
  constexpr double kLeastPhongRoughness = 0.12;  // below, a power asks for too many harmonics
  if (lobe == LobeFamily::charlie) return kLeastCharlieRoughness;
  return lobe == LobeFamily::phong || lobe == LobeFamily::blinn ? kLeastPhongRoughness : 0.0;
}

void check_roughness(const char* what, const std::vector<double>& table, int mips) {
  if (table.size() < static_cast<std::size_t>(mips)) {
    refuse(ErrorCode::invalid_argument, std::to_string(mips) + " mips, but " + what + " names " +
                                            std::to_string(table.size()) + "; it needs one for each mip");
  }
  for (std::size_t mip = 0; mip < static_cast<std::size_t>(mips); ++mip) {
    if (table[mip] >= 0.0 && table[mip] <= 1.0) continue;
    refuse(ErrorCode::invalid_argument, std::string(what) + " of mip " + std::to_string(mip) + " is " +
                                            platform::number_text(table[mip]) + "; it must be from 0 to 1");
  }
}

std::vector<double> roughness_of(const PrefilterOptions& options, int mips) {
  if (!options.roughness.empty()) check_roughness("roughness", options.roughness, mips);
  std::vector<double> roughness = options.roughness;
  if (roughness.empty()) {
    roughness = options.lobe == LobeFamily::charlie
                    ? charlie_roughness_of_mips(mips, options.size)
                    : roughness_of_mips(RoughnessSchedule::filament, mips, options.size);
  }
  roughness.resize(static_cast<std::size_t>(mips));
  for (double& value : roughness) value = std::max(value, least_roughness(options.lobe));
  return roughness;
}

/// Returns the roughness of each mip's lobe. `roughness`: where shaders find them.
std::vector<double> lobes_of(const PrefilterOptions& options, const std::vector<double>& roughness) {
  if (options.lobe_roughness.empty()) return roughness;
  check_roughness("lobe_roughness", options.lobe_roughness, static_cast<int>(roughness.size()));
  std::vector<double> lobes(options.lobe_roughness.begin(), options.lobe_roughness.begin() + std::ssize(roughness));
  for (double& value : lobes) value = std::max(value, least_roughness(options.lobe));
  return lobes;
}

int default_mips(const PrefilterOptions& options) {
  if (!options.roughness.empty()) return static_cast<int>(std::min<std::size_t>(options.roughness.size(), 99));
  if (!options.spectra.empty()) return static_cast<int>(std::min<std::size_t>(options.spectra.size(), 99));
  if (options.lobe == LobeFamily::lambert) return 1;
  return mips_of_chain(options.lobe == LobeFamily::charlie ? RoughnessSchedule::linear : RoughnessSchedule::filament,
                       options.size);
}

int mips_of(const PrefilterOptions& options) {
  check_lobe(options);
  const int whole = full_chain_levels(options.size);
  const int mips = options.mips ? *options.mips : default_mips(options);
  if (mips >= 1 && mips <= whole) return mips;
  refuse(ErrorCode::invalid_argument, std::to_string(mips) + " mips; a cubemap of " + std::to_string(options.size) +
                                          " texels along an edge has 1 to " + std::to_string(whole));
}

MipMethod method_for(const PrefilterOptions& options, double reach, const MipPlan& mip) {
  if (mip.alpha < kLeastAlpha) return MipMethod::copy;
  if (options.method == PrefilterMethod::reference) return MipMethod::reference;
  const double bands = reach / (2.0 * mip.alpha);
  if (bands <= transforms::kMaximumSpectrumBands) return MipMethod::spectral;
  if (options.method == PrefilterMethod::automatic) return MipMethod::narrow;
  refuse(ErrorCode::limit_exceeded, "roughness " + platform::number_text(mip.roughness) + " needs " +
                                        std::to_string(static_cast<std::int64_t>(std::ceil(bands))) +
                                        " harmonic bands, " + std::to_string(transforms::kMaximumSpectrumBands) +
                                        " are possible; use another method, or automatic");
}

}  // namespace

PrefilterPlan PrefilterPlan::without(int sharp, int rough) const {
  const auto count = static_cast<int>(mips.size());
  image::require_range("the number of sharp mips that are left out", sharp, 0, count - 1);
  image::require_range("the number of rough mips that are left out", rough, 0, count - 1 - sharp);
  PrefilterPlan rest = *this;
  rest.first_mip += sharp;
  rest.mips.assign(mips.begin() + sharp, mips.end() - rough);
  if (!rest.uses(MipMethod::spectral) && !rest.irradiance) rest.bands = 0;
  return rest;
}

bool PrefilterPlan::uses(MipMethod method) const noexcept {
  return platform::ranges::find(mips, method, &MipPlan::method) != mips.end();
}

namespace {

int halved_to(int face, double least, const ErrorBounds& bounds) noexcept {
  // texels beside the edges of coarser ones gain or lose too much
  const double looser = std::max(1.0, std::min(bounds.rms / 1e-3, bounds.maximum / 1e-2));
  least = std::max(least, kLeastHalved / std::sqrt(looser));
  while (can_be_halved(face) && face >= 2.0 * least) face /= 2;
  return face;
}

/// Returns alpha of the GGX lobe that takes so many bands at the default bounds.
double alpha_of_bands(int bands) noexcept {
  return std::clamp(reach_within({}) / (2.0 * std::max(1, bands)), kLeastAlpha, 1.0);
}

}  // namespace

int PrefilterPlan::face_for_cubemap(int face) const noexcept {
  const bool ggx = lights.of == LightsOf::ggx;
  const double least = ggx ? face_texels_within(ring_alpha, bands_for_dark(tight()), tight())
                           : face_texels_within(alpha_of_bands(bands), bands, {});
  return halved_to(face, least, ggx ? tight() : ErrorBounds{});
}

int PrefilterPlan::rows_for_cubemap() const noexcept {
  const double wanted =
      lights.of == LightsOf::ggx ? rings_within(ring_alpha, tight()) : rings_within(alpha_of_bands(bands), {});
  return 2 * transforms::fast_even_length(static_cast<int>(std::ceil(0.5 * wanted)));
}

namespace {

/// Returns the bands of a far part times its reach. Its spectrum falls by a factor of 6 for each unit, what its end
/// leaves of a picture by 3 to 4.
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
  const int least = bound > 5e-4 ? 14 : bound > 5e-5 ? 28 : 56;
  int near = halved_to(face, face_texels_within(alpha, 0, bounds), bounds);
  while (near < least) near *= 2;
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
  if (mip.alpha >= kMostNearAlpha || size % 2 != 0) return mip;
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
  constexpr double kLeastBound = 9e-5;
  if (!plan.may_integrate || plan.bands == 0 || least_of(plan.bounds) < kLeastBound || face % 2 != 0) return plan;
  std::vector<MipPlan> own;
  for (std::size_t k = 0; k < plan.spectral_lobes.size(); ++k)
    own.push_back(split_where_cheaper(plan, plan.spectral_lobes[k], plan.spectral_sizes[k], face));
  PrefilterPlan split = plan;
  while (!share_bands(split, own)) {
  }
  for (MipPlan& mip : own) {
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

/// Returns a plan of other lobes that no picture makes this one exceed.
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

PrefilterPlan PrefilterPlan::at_step(int step, int face) const {
  if (lights.of != LightsOf::ggx) return step > 0 ? largest(*this) : *this;
  constexpr int kMostLookedThrough = 64;  // `PictureSums` tell what few bands do not
  PrefilterPlan plan = step > 0 ? reflections::tightened(*this, step) : *this;
  const bool unseen = face == 0 || face > kMostLookedThrough;
  if (step == 0 && bands > 0 && unseen) plan.bands = std::max(bands, bands_for_dark(bounds));
  return face > 0 ? with_near_sums(plan, face) : plan;
}

double narrow_reach(const PrefilterPlan& plan) noexcept {
  const ErrorBounds usual;
  return std::max(plan.reach, reach_for(usual.rms, usual.maximum));
}

ErrorBounds bounds_of(const PrefilterOptions& options) noexcept { return {options.rms_error, options.texel_bound()}; }

std::vector<double> roughness_of_chain(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  return roughness_of(options, mips_of(options));
}

transforms::GridSize MipPlan::grid() const noexcept {
  return lobe->last_band() > 0 ? transforms::grid_for_bands(bands.bands(), kEndOversampling)
                               : transforms::grid_for_bands(bands.bands());
}

namespace {

/// Adds a spectral mip to what all of them share.
void take_in(const MipPlan& mip, int bands, PrefilterPlan& plan) {
  plan.light_alpha = std::min(plan.light_alpha, mip.lobe->light_alpha());
  plan.lights.take_in(*mip.lobe);
  plan.bands = std::max(plan.bands, bands);
  plan.ring_alpha = std::min(plan.ring_alpha, mip.lobe->width_alpha());
  plan.spectral_lobes.push_back(mip.lobe);
  plan.spectral_sizes.push_back(mip.size);
}

/// Adds the mips of GGX lobes.
void plan_ggx(const PrefilterOptions& options, const std::vector<double>& roughness, const std::vector<double>& lobes,
              PrefilterPlan& plan) {
  plan.lookups = formula_of(roughness, options.size);
  for (std::size_t level = 0; level < roughness.size(); ++level) {
    MipPlan mip;
    mip.size = std::max(1, options.size >> level);
    mip.roughness = roughness[level];
    mip.lobe_roughness = lobes[level];
    mip.alpha = mip.lobe_roughness * mip.lobe_roughness;
    if (level + 1 < roughness.size()) {
      mip.to_next = MipPair{static_cast<int>(level),
                            {roughness[level], roughness[level + 1]},
                            {lobes[level], lobes[level + 1]},
                            {mip.size, std::max(1, mip.size / 2)}};
    }
    mip.method = method_for(options, plan.reach, mip);
    if (mip.method != MipMethod::copy) mip.lobe = std::make_shared<const Lobe>(mip.alpha);
    if (mip.method == MipMethod::spectral) {
      mip.bands = tapered_lobe(mip.alpha,
                               std::min(transforms::kMaximumSpectrumBands, first_bands_within(mip.alpha, plan.bounds)));
      take_in(mip, std::max(mip.bands.bands(), first_bands_for_dark(plan.bounds)), plan);
    }
    if (mip.method == MipMethod::narrow) plan.narrow_size = std::max(plan.narrow_size, mip.size);
    plan.mips.push_back(std::move(mip));
  }
}

/// Returns the bands of the first transform for a lobe other than GGX: as many as it takes for a picture with many
/// edges, whose energy of degree l is kEdges / l^2 of the whole.
int first_bands(const Lobe& lobe, double rms_error) {
  constexpr double kEdges = 6.0;
  constexpr double kShare = 0.4;
  constexpr int kFirstLook = 256;
  constexpr int most = transforms::kMaximumSpectrumBands;
  if (lobe.last_band() > 0) return lobe.last_band();
  for (int looked_at = kFirstLook;; looked_at = std::min(most, 2 * looked_at)) {
    const std::vector<double> spectrum = lobe.spectrum(looked_at);
    double lost = 0.0;
    int bands = looked_at;
    while (bands > kLeastLobeBands) {
      const double ratio = spectrum[static_cast<std::size_t>(bands - 1)] / bands;
      lost += kEdges * ratio * ratio;
      if (lost > kShare * kOfBound * rms_error * rms_error) break;
      --bands;
    }
    // what lies beyond is as much as what lies in the last third
    if (bands < looked_at * 2 / 3 || looked_at == most)
      return std::min(most, (bands + kBandStep - 1) / kBandStep * kBandStep);
  }
}

/// Adds the mips of other lobes, whose bands the picture decides.
void plan_kernels(const std::vector<ZonalKernel>& kernels, bool reference, PrefilterPlan& plan) {
  const ErrorBounds usual;
  plan.reach = reach_for(std::min(usual.rms, plan.bounds.rms), usual.maximum);
  plan.lights.of = LightsOf::any;
  for (std::size_t level = 0; level < kernels.size(); ++level) {
    MipPlan mip;
    mip.size = std::max(1, plan.size >> level);
    mip.roughness = kernels[level].roughness();
    mip.lobe_roughness = mip.roughness;
    mip.lobe = kernels[level].lobe();
    mip.method = reference ? MipMethod::reference : MipMethod::spectral;
    if (!reference) take_in(mip, first_bands(*mip.lobe, plan.bounds.rms), plan);
    plan.mips.push_back(std::move(mip));
  }
}

ZonalKernel kernel_of(LobeFamily lobe, double roughness) {
  const double alpha = roughness * roughness;
  const double power = 2.0 / (alpha * alpha) - 2.0;  // as wide as GGX (Walter et al. 2007)
  switch (lobe) {
    case LobeFamily::charlie: return ZonalKernel::charlie(roughness);
    case LobeFamily::phong: return ZonalKernel::phong(std::max(1.0, power));
    default: return ZonalKernel::blinn(std::max(0.0, power));
  }
}

/// Adds the mips of the clipped cosine, which is the GGX lobe of roughness 1.
void plan_lambert(const PrefilterOptions& options, const std::vector<double>& roughness,
                  const std::vector<double>& lobes, PrefilterPlan& plan) {
  const std::vector<double> rough(roughness.size(), 1.0);
  plan_ggx(options, rough, rough, plan);
  plan.family = LobeFamily::lambert;
  plan.light_alpha = kMatteLightAlpha;
  for (std::size_t level = 0; level < roughness.size(); ++level) {
    MipPlan& mip = plan.mips[level];
    mip.roughness = roughness[level];
    mip.lobe_roughness = lobes[level];
    mip.to_next.reset();
    plan.family_numbers.push_back({lobes[level]});
  }
}

/// Adds the mips of a family other than GGX and Lambert.
void plan_family(const PrefilterOptions& options, const std::vector<double>& roughness,
                 const std::vector<double>& lobes, PrefilterPlan& plan) {
  if (options.lobe == LobeFamily::spectra && options.spectra.size() < roughness.size()) {
    refuse(ErrorCode::invalid_argument, std::to_string(roughness.size()) + " mips, but there are " +
                                            std::to_string(options.spectra.size()) + " spectra; each mip needs one");
  }
  plan.family = options.lobe;
  std::vector<ZonalKernel> kernels;
  for (std::size_t level = 0; level < roughness.size(); ++level) {
    if (options.lobe == LobeFamily::spectra) {
      kernels.push_back(ZonalKernel::from_spectrum(options.spectra[level]));
      plan.family_numbers.push_back(options.spectra[level]);
    } else {
      kernels.push_back(kernel_of(options.lobe, lobes[level]));
      plan.family_numbers.push_back({lobes[level]});
    }
  }
  plan_kernels(kernels, options.method == PrefilterMethod::reference, plan);
  for (std::size_t level = 0; level < roughness.size(); ++level) {
    plan.mips[level].roughness = roughness[level];
    plan.mips[level].lobe_roughness = lobes[level];
  }
}

}  // namespace

PrefilterPlan plan_prefilter(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  if (static_cast<int>(options.method) < 0 || options.method > PrefilterMethod::reference) {
    refuse(ErrorCode::invalid_argument, "the method " + std::to_string(static_cast<int>(options.method)) +
                                            " is unknown; pass one of the enumerators");
  }
  check_error_bound("rms_error", options.rms_error, kLeastRmsError, options.method);
  if (options.maximum_error)
    check_error_bound("maximum_error", *options.maximum_error, kLeastMaximumError, options.method);
  projection::check_policy(options.pixels);
  const int mips = mips_of(options);
  const std::vector<double> roughness = roughness_of(options, mips);
  const std::vector<double> lobes = lobes_of(options, roughness);
  PrefilterPlan plan;
  plan.size = options.size;
  plan.bounds = bounds_of(options);
  plan.reach = reach_for(plan.bounds.rms, plan.bounds.maximum);
  plan.may_integrate = options.method == PrefilterMethod::automatic;
  if (options.lobe == LobeFamily::ggx) {
    plan_ggx(options, roughness, lobes, plan);
  } else if (options.lobe == LobeFamily::lambert) {
    plan_lambert(options, roughness, lobes, plan);
  } else {
    plan_family(options, roughness, lobes, plan);
  }
  return plan;
}

PrefilterPlan plan_prefilter(const KernelChainOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  image::require_range("the number of kernels, which is that of mips,",
                       static_cast<int>(std::min<std::size_t>(options.kernels.size(), 99)), 1,
                       full_chain_levels(options.size));
  if (!(options.rms_error >= kLeastRmsError && options.rms_error <= 1.0)) {
    refuse(ErrorCode::invalid_argument,
           "rms_error is " + platform::number_text(options.rms_error) + "; it must be from 1e-6 to 1");
  }
  const bool reference = options.method == PrefilterMethod::reference;
  if (!reference && options.method != PrefilterMethod::automatic && options.method != PrefilterMethod::spectral)
    refuse(ErrorCode::invalid_argument,
           "kernels are prefiltered by the methods automatic, spectral, "
           "reference");
  projection::check_policy(options.pixels);
  PrefilterPlan plan;
  plan.size = options.size;
  plan.bounds = bounds_of({.rms_error = options.rms_error});
  plan.may_integrate = options.method == PrefilterMethod::automatic;
  plan_kernels(options.kernels, reference, plan);
  return plan;
}

}  // namespace welkin::reflections

namespace welkin {

const char* name(Quality quality) noexcept {
  switch (quality) {
    case Quality::normal: break;
    case Quality::fast: return "fast";
    case Quality::reference: return "reference";
  }
  return "normal";
}

double PrefilterOptions::texel_bound() const noexcept {
  const reflections::ErrorBounds usual;
  return maximum_error.value_or(std::min(1.0, rms_error / usual.rms * usual.maximum));
}

PrefilterOptions PrefilterOptions::at(Quality quality) {
  if (static_cast<int>(quality) < 0 || quality > Quality::reference) {
    reflections::refuse(ErrorCode::invalid_argument, "the quality " + std::to_string(static_cast<int>(quality)) +
                                                         " is unknown; pass one of the enumerators");
  }
  PrefilterOptions options;
  if (quality == Quality::fast) options.rms_error = 1e-2;
  if (quality == Quality::reference) options.method = PrefilterMethod::reference;
  return options;
}

const char* name(LobeFamily lobe) noexcept {
  switch (lobe) {
    case LobeFamily::ggx: break;
    case LobeFamily::charlie: return "charlie";
    case LobeFamily::lambert: return "lambert";
    case LobeFamily::phong: return "phong";
    case LobeFamily::blinn: return "blinn";
    case LobeFamily::spectra: return "spectra";
  }
  return "ggx";
}

int mips_of_chain(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, reflections::kLargestSize);
  return reflections::mips_of(options);
}

}  // namespace welkin
