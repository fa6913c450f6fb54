// How loose the prefilter's bounds may be, and how small its source.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "budget/budget.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/radiance_scale.h"
#include "transform/transform_kernels.h"
#include "welkin/resampling.h"

namespace welkin {
namespace {

using projection::SanitizedSource;
using reflections::MipPlan;
using reflections::PrefilterPlan;
using transforms::Spectrum;

/// `rms_error` of the settings; `maximum_error` is ten times it.
constexpr std::array<double, 7> kBounds{1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4};
/// Of the energies' sum against texels' differences, and what is not in it: docs/error_budget.md.
constexpr double kSafety = 1.5;
constexpr double kRounding = 5e-6;
constexpr double kUnknown = 1.0;               ///< a mip of the reference method: no estimate
constexpr double kNarrow = 1e-3;               ///< rms of a narrow mip, at most: docs/reflections.md
constexpr double kMultiplyNanoseconds = 0.05;  ///< of the transforms, DESIGN.md: 2.2 ms for 50 million
constexpr double kTexelNanoseconds = 15.0;     ///< of a mip: interpolation and lobes of bright texels
constexpr int kMostReducedSize = 256;
constexpr int kMostReducedBands = 384;

PrefilterOptions with_bounds(const PrefilterOptions& options, double bound) {
  PrefilterOptions setting = options;
  setting.method = PrefilterMethod::automatic;
  setting.rms_error = bound;
  setting.maximum_error = std::min(1.0, 10.0 * bound);
  return setting;
}

double transform_nanoseconds(double bands, double rings) {
  return kMultiplyNanoseconds * bands * bands / 2.0 * rings / 2.0 * 6.0;
}

double predicted(const PrefilterPlan& plan, const SanitizedSource& source) {
  const int rings = source.cubemap() ? plan.rows_for_cubemap() : source.rows();
  double sum = transform_nanoseconds(plan.bands, rings);
  for (const MipPlan& mip : plan.mips) {
    const double texels = 6.0 * mip.size * mip.size;
    sum += transform_nanoseconds(mip.bands.bands(), 4.0 / 3.0 * mip.bands.bands()) + kTexelNanoseconds * texels;
  }
  return sum;
}

struct Errors {
  std::vector<double> mips;  ///< 0: a copy
  double worst = 0.0;
};

double spectral_error(const PrefilterPlan& plan, const MipPlan& mip, const SanitizedSource& source,
                      const budget::EnvironmentEnergies& energies, const reflections::BrightLights& lights) {
  const double own = kSafety * budget::spectral_mip_error(mip, energies, lights);
  if (!source.cubemap()) return own;
  // the energies are those of finer rings than the plan's
  const reflections::SpectralSource on_rings{energies.rest, source.columns(), plan.rows_for_cubemap()};
  const double rms = budget::blurred_rms(mip.alpha, energies.whole);
  return std::max(own, reflections::spectral_rms_error(mip, on_rings, lights.error(*mip.lobe, mip.size, rms), rms));
}

/// The energies reach as far as the narrowest lobe that is spectral at the finest bounds: others have no estimate.
Errors errors_of(const PrefilterPlan& plan, const PrefilterPlan& finest, const SanitizedSource& source,
                 const budget::EnvironmentEnergies& energies) {
  Errors errors;
  const reflections::BrightLights lights(energies.bright, energies.shape, plan.least_alpha, plan.reach);
  for (std::size_t k = 0; k < plan.mips.size(); ++k) {
    const MipPlan& mip = plan.mips[k];
    double error = 0.0;
    if (mip.method != MipMethod::copy) {
      if (mip.method == MipMethod::narrow) {
        errors.mips.push_back(kNarrow);
        errors.worst = std::max(errors.worst, kNarrow);
        continue;
      }
      const bool known = mip.bands.bands() > 0 && finest.mips[k].bands.bands() > 0;
      error = known ? spectral_error(plan, mip, source, energies, lights) + kRounding : kUnknown;
    }
    errors.mips.push_back(error);
    errors.worst = std::max(errors.worst, error);
  }
  return errors;
}

CubemapChain reduced(const SanitizedSource& source, const Control& control) {
  if (source.cubemap()) return build_mips(source.cube(), MipFilter::solid_angle, std::nullopt, control);
  const int size =
      std::clamp(static_cast<int>(std::bit_floor(static_cast<unsigned>(source.rows()))) / 2, 1, kMostReducedSize);
  const CubemapImage cube = to_cubemap(source.lat_long(), size, glm::dmat3(1.0), ResampleFilter::area, control);
  return build_mips(cube.view(), MipFilter::solid_angle, std::nullopt, control);
}

/// From the smallest reduced source up: the first that each mip can do with.
void find_source_sizes(const CubemapChain& chain, const PrefilterPlan& plan,
                       const budget::EnvironmentEnergies& energies, double budget, const Control& control,
                       std::vector<MipNeed>& needs) {
  const int bands = std::min(energies.spectrum.bands(), kMostReducedBands);
  const std::span<const double> whole(energies.whole);
  for (int level = chain.levels(); level-- > 0;) {
    const int size = chain.level_size(level);
    const bool all_found =
        std::all_of(needs.begin(), needs.end(), [](const MipNeed& need) { return need.source_size > 0; });
    if (size > kMostReducedSize || all_found) break;
    const reflections::Rings rings =
        reflections::rings_of_cubemap(chain.view(level), plan.rows_for_cubemap(), {control.stop, {}});
    const Spectrum spectrum = transforms::analyse(rings.view, bands, {control.stop, {}});
    const std::vector<double> lost = budget::difference_energies(spectrum, energies.spectrum);
    for (std::size_t k = 0; k < needs.size(); ++k) {
      const MipPlan& mip = plan.mips[k];
      if (needs[k].source_size > 0 || mip.bands.bands() == 0 || mip.bands.bands() > bands) continue;
      const double rms = budget::blurred_rms(mip.alpha, whole);
      // What the source itself loses on its rings is not in the difference of the two.
      const double change = budget::blurred_rms(mip.alpha, lost) + budget::blurred_rms(mip.alpha, energies.rings);
      const double error = rms > 0.0 ? kSafety * change / rms + kRounding : 0.0;
      if (error > budget) continue;
      needs[k].source_size = size;
      needs[k].source_size_error = error;
    }
  }
}

PrefilterChoice choose_for(const SanitizedSource& source, const PrefilterOptions& options, const ErrorBudget& budget,
                           bool source_sizes, const Control& control) {
  const PrefilterPlan finest = reflections::plan_prefilter(with_bounds(options, kBounds.back()));
  PrefilterChoice choice;
  choice.relative_to = "root mean square of the mip over the sphere, of the worst mip";
  budget::EnvironmentEnergies energies;
  if (finest.bands > 0) energies = budget::analyse_energies(source, finest, finest.bands, control);
  std::vector<Errors> errors;
  for (const double bound : kBounds) {
    const PrefilterOptions setting = with_bounds(options, bound);
    const PrefilterPlan plan = reflections::plan_prefilter(setting);
    errors.push_back(errors_of(plan, finest, source, energies));
    choice.tried.push_back({setting, errors.back().worst, predicted(plan, source)});
  }
  budget::settle(choice, budget);
  const PrefilterPlan chosen = reflections::plan_prefilter(choice.setting);
  const auto place = std::find(kBounds.begin(), kBounds.end(), choice.setting.rms_error) - kBounds.begin();
  for (std::size_t k = 0; k < chosen.mips.size(); ++k)
    choice.mips.push_back({chosen.mips[k].roughness, errors[static_cast<std::size_t>(place)].mips[k], 0, 0.0});
  if (source_sizes && finest.bands > 0)
    find_source_sizes(reduced(source, {control.stop, {}}), chosen, energies, budget.relative, control, choice.mips);
  if (control.progress) control.progress(1.0);
  return choice;
}

template <class View>
PrefilterChoice choose(const View& view, const PrefilterOptions& options, const ErrorBudget& budget, bool source_sizes,
                       const Control& control) {
  budget::check_budget(budget);
  if (options.lobe != LobeFamily::ggx) {
    throw Error(ErrorCode::invalid_argument,
                std::string("an error budget has estimates of GGX lobes alone, and the lobe "
                            "is ") +
                    name(options.lobe) + "; set rms_error instead");
  }
  image::check_view(view);
  const SanitizedSource source(view, options.pixels, {control.stop, {}});
  const float scale = reflections::safe_scale(source);
  if (scale == 1.0F) return choose_for(source, options, budget, source_sizes, control);
  const reflections::ScaledSource scaled(source, scale, {control.stop, {}});  // as the prefilter itself does
  return choose_for(scaled.source(), options, budget, source_sizes, control);
}

}  // namespace

PrefilterChoice choose_prefilter(const LatLongView& source, const PrefilterOptions& options, const ErrorBudget& budget,
                                 bool source_sizes, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return choose(source, options, budget, source_sizes, control);
}

PrefilterChoice choose_prefilter(const CubemapView& source, const PrefilterOptions& options, const ErrorBudget& budget,
                                 bool source_sizes, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return choose(source, options, budget, source_sizes, control);
}

}  // namespace welkin

namespace welkin::budget {
namespace {

using transforms::Spectrum;

constexpr double kPi = std::numbers::pi;
constexpr int kMostRings = 2048;

/// Share of degree l that a cubic spline over `rings` rings loses half way between samples: a fit to the figures of
/// `specular::grid_for_bands` (6e-5 at an eighth, 2.8e-2 at a half, 0.24 at three quarters), each met within 15 %.
double spline_loss(int l, int rings) {
  const double x = static_cast<double>(l) / rings;
  return x * x * x * x * (0.24 + 0.2 * x + 0.65 * x * x);
}

/// Of order m's coefficients the squares of the six numbers that count; orders above 0 stand for two.
template <class Value>
std::vector<double> sum_squares(int bands, const Value& value) {
  std::vector<double> energies(static_cast<std::size_t>(bands));
  for (int m = 0; m < bands; ++m) {
    for (int l = m; l < bands; ++l) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) {
        const double number = value(m, (l - m) * transforms::kHarmonicFloats + k);
        sum += number * number;
      }
      energies[static_cast<std::size_t>(l)] += m == 0 ? sum : 2.0 * sum;
    }
  }
  return energies;
}

}  // namespace

std::vector<double> band_energies(const Spectrum& spectrum) {
  return sum_squares(spectrum.bands(), [&](int m, int k) { return static_cast<double>(spectrum.order(m)[k]); });
}

std::vector<double> difference_energies(const Spectrum& a, const Spectrum& b) {
  return sum_squares(std::min(a.bands(), b.bands()), [&](int m, int k) {
    return static_cast<double>(a.order(m)[k]) - static_cast<double>(b.order(m)[k]);
  });
}

namespace {

/// What is lost on `rows` rings, from twice as many, or from half where those would be too many. The loss falls with
/// their number at least, so it is at most twice the difference to twice as many, and at most the difference to half as
/// many.
std::vector<double> ring_energies(const CubemapView& cube, int rows, const Spectrum& spectrum, const Control& quiet) {
  const bool finer = 2 * rows <= kMostRings;
  const reflections::Rings other = reflections::rings_of_cubemap(cube, finer ? 2 * rows : rows / 8 * 4, quiet);
  std::vector<double> lost = difference_energies(transforms::analyse(other.view, spectrum.bands(), quiet), spectrum);
  if (finer) {
    for (double& energy : lost) energy *= 4.0;
  }
  return lost;
}

}  // namespace

EnvironmentEnergies analyse_energies(const projection::SanitizedSource& source, const reflections::PrefilterPlan& plan,
                                     int bands, const Control& control) {
  const Control quiet{control.stop, {}};
  EnvironmentEnergies energies;
  const std::vector<reflections::BrightTexel> bright =
      reflections::find_bright_texels(source, plan.light_alpha, reflections::kMostBright, quiet);
  energies.bright = bright;
  energies.shape = reflections::PictureShape::of(source);
  const int rows = source.cubemap() ? plan.rows_for_cubemap() : source.rows();
  energies.spectrum = transforms::analyse(reflections::rings_of(source, {}, rows, quiet).view, bands, quiet);
  energies.whole = band_energies(energies.spectrum);
  if (source.cubemap()) energies.rings = ring_energies(source.cube(), rows, energies.spectrum, quiet);
  energies.rest = energies.whole;
  energies.rings_of_rest = energies.rings;
  if (!bright.empty()) {
    const Spectrum rest = transforms::analyse(reflections::rings_of(source, bright, rows, quiet).view, bands, quiet);
    energies.rest = band_energies(rest);
    if (source.cubemap()) {
      const platform::AlignedBuffer<float> pixels = reflections::pixels_without(bright, source);
      const CubemapView cube = image::packed_cubemap(pixels.data(), source.columns());
      energies.rings_of_rest = ring_energies(cube, rows, rest, quiet);
    }
  }
  return energies;
}

double blurred_rms(double alpha, std::span<const double> energies) {
  if (energies.empty()) return 0.0;
  const std::vector<double> lobe = reflections::lobe_spectrum(alpha, static_cast<int>(energies.size()));
  double sum = 0.0;
  for (std::size_t l = 0; l < energies.size(); ++l) sum += lobe[l] * lobe[l] * energies[l];
  return std::sqrt(sum / (4.0 * kPi));
}

double spectral_mip_error(const reflections::MipPlan& mip, const EnvironmentEnergies& energies,
                          const reflections::BrightLights& lights) {
  const auto bands = static_cast<int>(energies.rest.size());
  const std::vector<double> lobe = reflections::lobe_spectrum(mip.alpha, bands);
  const int rings = mip.grid().rings;
  double sum = 0.0;
  for (int l = 0; l < bands; ++l) {
    const auto band = static_cast<std::size_t>(l);
    const double zonal = l < mip.bands.bands() ? mip.bands.zonal[band] : 0.0;
    const double truncated = lobe[band] - zonal;
    const double interpolated = zonal * spline_loss(l, rings);
    sum += (truncated * truncated + interpolated * interpolated) * energies.rest[band];
  }
  const double whole = blurred_rms(mip.alpha, energies.whole);
  if (whole == 0.0) return 0.0;
  return (std::sqrt(sum / (4.0 * kPi)) + blurred_rms(mip.alpha, energies.rings_of_rest) +
          lights.error(*mip.lobe, mip.size, whole)) /
         whole;
}

}  // namespace welkin::budget
