#include "reflections/prefilter_plan.h"

#include <algorithm>
#include <array>
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
constexpr double kMinRmsError = 1e-6;  ///< what float arithmetic leaves
constexpr double kMinMaximumError = 1e-5;

[[noreturn]] void refuse(ErrorCode code, const std::string& message) { throw Error(code, message); }

/// Refuses an enumerator beyond the last one.
template <class Enumeration>
void require_known(const char* what, Enumeration value, Enumeration last) {
  const int number = static_cast<int>(value);
  if (number >= 0 && value <= last) return;
  refuse(ErrorCode::invalid_argument,
         std::string("the ") + what + " " + std::to_string(number) + " is unknown; pass one of the enumerators");
}

void check_error_bound(const char* what, double value, double minimum, PrefilterMethod method) {
  if (!(value > 0.0 && value <= 1.0))
    refuse(ErrorCode::invalid_argument,
           std::string(what) + " is " + platform::number_text(value) + "; it must be above 0, at most 1");
  if (value >= minimum || method == PrefilterMethod::reference) return;
  refuse(ErrorCode::limit_exceeded, std::string(what) + " below " + (minimum < 5e-6 ? "1e-6" : "1e-5") +
                                        " is more than float arithmetic gives; the reference method has no bound");
}

void check_lobe(const PrefilterOptions& options) {
  require_known("lobe", options.lobe, LobeFamily::spectra);
  if ((options.lobe == LobeFamily::spectra) == !options.spectra.empty()) return;
  refuse(ErrorCode::invalid_argument, options.spectra.empty()
                                          ? "the lobe is spectra, and there are none; pass one for each mip"
                                          : std::string("spectra are given, and the lobe is ") + name(options.lobe) +
                                                "; set it to spectra, or leave them out");
}

double least_roughness(LobeFamily lobe) noexcept {
  constexpr double kMinPhongRoughness = 0.12;  // below, a power needs too many harmonics
  if (lobe == LobeFamily::charlie) return kMinCharlieRoughness;
  return lobe == LobeFamily::phong || lobe == LobeFamily::blinn ? kMinPhongRoughness : 0.0;
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

RoughnessSchedule schedule_of(LobeFamily lobe) {
  return lobe == LobeFamily::charlie ? RoughnessSchedule::linear : RoughnessSchedule::filament;
}

std::vector<double> roughness_of(const PrefilterOptions& options, int mips) {
  if (!options.roughness.empty()) check_roughness("roughness", options.roughness, mips);
  std::vector<double> roughness = options.roughness;
  if (roughness.empty()) {
    roughness = mip_roughness(schedule_of(options.lobe), mips, options.size);
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
  return default_mip_count(schedule_of(options.lobe), options.size);
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
  if (mip.alpha < kMinAlpha) return MipMethod::copy;
  if (options.method == PrefilterMethod::reference) return MipMethod::reference;
  // the spectrum falls like exp(-2 alpha l): to exp(-reach) at so many
  const double bands = reach / (2.0 * mip.alpha);
  if (bands <= transforms::kMaximumSpectrumBands) return MipMethod::spectral;
  if (options.method == PrefilterMethod::automatic) return MipMethod::near_far;
  refuse(ErrorCode::limit_exceeded, "roughness " + platform::number_text(mip.roughness) + " needs " +
                                        std::to_string(static_cast<std::int64_t>(std::ceil(bands))) +
                                        " harmonic bands, " + std::to_string(transforms::kMaximumSpectrumBands) +
                                        " are possible; use another method, or automatic");
}

}  // namespace

ErrorBounds bounds_of(const PrefilterOptions& options) noexcept { return {options.rms_error, options.texel_bound()}; }

std::vector<double> roughness_of_chain(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  return roughness_of(options, mips_of(options));
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
    if (mip.method == MipMethod::near_far) {
      plan.near_far_size = std::max(plan.near_far_size, mip.size);
      plan.bands = std::max(plan.bands, kBandStep);
    }
    plan.mips.push_back(std::move(mip));
  }
}

/// Returns the bands of the first transform for a lobe other than GGX: as many as it takes for an image with many
/// edges, whose energy of degree l is kEdges / l^2 of the whole. Without the degrees from `bands` on the mip's error
/// has the square Sum kEdges / l^2 k_l^2, which is summed from the end until it exceeds its share of the bound's.
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
    while (bands > kMinLobeBands) {
      const double ratio = spectrum[static_cast<std::size_t>(bands - 1)] / bands;
      lost += kEdges * ratio * ratio;
      if (lost > kShare * kOfBound * rms_error * rms_error) break;
      --bands;
    }
    // The part beyond is at most about as much as what lies in the last third: a spectrum that falls like l^-1/2, as
    // slowly as any (docs/maths/reflections.md), makes terms of l^-3, of which 0.8 times as many lie beyond L as from
    // 2 L / 3 to L. Kinks' l^-5/2 makes it a tenth.
    if (bands < looked_at * 2 / 3 || looked_at == most)
      return std::min(most, (bands + kBandStep - 1) / kBandStep * kBandStep);
  }
}

/// Adds the mips of other lobes, whose bands the image decides.
void plan_kernels(const std::vector<ZonalLobe>& kernels, bool reference, PrefilterPlan& plan) {
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

ZonalLobe kernel_of(LobeFamily lobe, double roughness) {
  const double alpha = roughness * roughness;
  // Walter et al. 2007, "Microfacet models for refraction through rough surfaces": a Blinn distribution of this power
  // is about as wide as one of Beckmann's or GGX's of alpha. cos^n h falls like exp(-n h^2 / 2) = exp(-h^2 / alpha^2),
  // which is Beckmann's near h = 0.
  const double power = 2.0 / (alpha * alpha) - 2.0;  // as wide as GGX (Walter et al. 2007)
  switch (lobe) {
    case LobeFamily::charlie: return ZonalLobe::charlie(roughness);
    case LobeFamily::phong: return ZonalLobe::phong(std::max(1.0, power));
    default: return ZonalLobe::blinn(std::max(0.0, power));
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
  std::vector<ZonalLobe> kernels;
  for (std::size_t level = 0; level < roughness.size(); ++level) {
    if (options.lobe == LobeFamily::spectra) {
      kernels.push_back(ZonalLobe::from_spectrum(options.spectra[level]));
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
  require_known("method", options.method, PrefilterMethod::reference);
  check_error_bound("rms_error", options.rms_error, kMinRmsError, options.method);
  if (options.maximum_error)
    check_error_bound("maximum_error", *options.maximum_error, kMinMaximumError, options.method);
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

PrefilterPlan plan_prefilter(const LobeChainOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  image::require_range("the number of kernels, which is that of mips,",
                       static_cast<int>(std::min<std::size_t>(options.lobes.size(), 99)), 1,
                       full_chain_levels(options.size));
  if (!(options.rms_error >= kMinRmsError && options.rms_error <= 1.0)) {
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
  plan_kernels(options.lobes, reference, plan);
  return plan;
}

}  // namespace welkin::reflections

namespace welkin {

const char* name(Quality quality) noexcept {
  static constexpr std::array kNames{"normal", "fast", "reference"};
  return platform::name_in<Quality::reference>(kNames, quality, "normal");
}

double PrefilterOptions::texel_bound() const noexcept {
  const reflections::ErrorBounds usual;
  return maximum_error.value_or(std::min(1.0, rms_error / usual.rms * usual.maximum));
}

PrefilterOptions PrefilterOptions::at(Quality quality) {
  reflections::require_known("quality", quality, Quality::reference);
  PrefilterOptions options;
  if (quality == Quality::fast) options.rms_error = 1e-2;
  if (quality == Quality::reference) options.method = PrefilterMethod::reference;
  return options;
}

const char* name(LobeFamily lobe) noexcept {
  static constexpr std::array kNames{"ggx", "charlie", "lambert", "phong", "blinn", "spectra"};
  return platform::name_in<LobeFamily::spectra>(kNames, lobe, "ggx");
}

int default_mip_count(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, reflections::kLargestSize);
  return reflections::mips_of(options);
}

}  // namespace welkin
