// How loose the prefilter's bounds may be, and how small its source.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "estimates/budget.h"
#include "estimates/spectrum_errors.h"
#include "image/check_views.h"
#include "jobs/tiles.h"
#include "specular/cube_rings.h"
#include "specular/extreme_values.h"
#include "welkin/mip_chain.h"
#include "welkin/resampling.h"

namespace welkin {
namespace {

using specular::CleanSource;
using specular::MipPlan;
using specular::PrefilterPlan;
using specular::Spectrum;

/// `rms_error` of the settings; `maximum_error` is ten times it.
constexpr std::array<double, 7> kBounds{1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4};
/// Of the energies' sum against texels' differences, and what is not in it: docs/error_budget.md.
constexpr double kSafety = 1.5;
constexpr double kRounding = 5e-5;
constexpr double kUnknown = 1.0;               ///< a sampled mip: no estimate
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

double predicted(const PrefilterPlan& plan, const CleanSource& source) {
  const int rings = source.cubemap() ? plan.rows_for_cubemap(source.columns()) : source.rows();
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

/// The energies reach as far as the narrowest lobe that is spectral at the finest bounds: others have no estimate.
Errors errors_of(const PrefilterPlan& plan, const PrefilterPlan& finest,
                 const estimates::EnvironmentEnergies& energies) {
  Errors errors;
  for (std::size_t k = 0; k < plan.mips.size(); ++k) {
    const MipPlan& mip = plan.mips[k];
    double error = 0.0;
    if (!mip.copy) {
      const bool known = mip.bands.bands() > 0 && finest.mips[k].bands.bands() > 0;
      error = known ? kSafety * estimates::spectral_mip_error(mip, energies) + kRounding : kUnknown;
    }
    errors.mips.push_back(error);
    errors.worst = std::max(errors.worst, error);
  }
  return errors;
}

CubemapChain reduced(const LatLongView& view, const Control& control) {
  const int size =
      std::clamp(static_cast<int>(std::bit_floor(static_cast<unsigned>(view.height))) / 2, 1, kMostReducedSize);
  return build_mips(to_cubemap(view, size, glm::dmat3(1.0), control).view(), MipFilter::solid_angle, 0, control);
}

CubemapChain reduced(const CubemapView& view, const Control& control) {
  return build_mips(view, MipFilter::solid_angle, 0, control);
}

/// From the smallest reduced source up: the first that each mip can do with.
void find_source_sizes(const CubemapChain& chain, const PrefilterPlan& plan,
                       const estimates::EnvironmentEnergies& energies, double budget, const Control& control,
                       std::vector<MipNeed>& needs) {
  const int bands = std::min(energies.spectrum.bands(), kMostReducedBands);
  const std::span<const double> whole(energies.whole);
  for (int level = chain.levels(); level-- > 0;) {
    const int size = chain.level_size(level);
    const bool all_found =
        std::all_of(needs.begin(), needs.end(), [](const MipNeed& need) { return need.source_size > 0; });
    if (size > kMostReducedSize || all_found) break;
    const LatLongImage rings =
        specular::rings_of_cubemap(chain.view(level), plan.rows_for_cubemap(size), {control.stop, {}});
    const Spectrum spectrum = specular::analyse(rings.view(), bands, {control.stop, {}});
    const std::vector<double> lost = estimates::difference_energies(spectrum, energies.spectrum);
    for (std::size_t k = 0; k < needs.size(); ++k) {
      const MipPlan& mip = plan.mips[k];
      if (mip.copy || needs[k].source_size > 0 || mip.bands.bands() == 0 || mip.bands.bands() > bands) continue;
      const double rms = estimates::blurred_rms(mip.alpha, whole);
      // What the source itself loses on its rings is not in the difference of the two.
      const double change = estimates::blurred_rms(mip.alpha, lost) + estimates::blurred_rms(mip.alpha, energies.rings);
      const double error = rms > 0.0 ? kSafety * change / rms + kRounding : 0.0;
      if (error > budget) continue;
      needs[k].source_size = size;
      needs[k].source_size_error = error;
    }
  }
}

const LatLongView& clean_view(const CleanSource& source, const LatLongView& /*view*/) { return source.lat_long(); }
const CubemapView& clean_view(const CleanSource& source, const CubemapView& /*view*/) { return source.cube(); }

template <class View>
PrefilterChoice choose_for(const View& view, const CleanSource& source, const PrefilterOptions& options,
                           const ErrorBudget& budget, bool source_sizes, const Control& control) {
  const PrefilterPlan finest = specular::plan_prefilter(with_bounds(options, kBounds.back()));
  PrefilterChoice choice;
  choice.relative_to = "root mean square of the mip over the sphere, of the worst mip";
  estimates::EnvironmentEnergies energies;
  if (finest.bands > 0) energies = estimates::analyse_energies(source, finest, finest.bands, control);
  std::vector<Errors> errors;
  for (const double bound : kBounds) {
    const PrefilterOptions setting = with_bounds(options, bound);
    const PrefilterPlan plan = specular::plan_prefilter(setting);
    errors.push_back(errors_of(plan, finest, energies));
    choice.tried.push_back({setting, errors.back().worst, predicted(plan, source)});
  }
  estimates::settle(choice, budget);
  const PrefilterPlan chosen = specular::plan_prefilter(choice.setting);
  const auto place = std::find(kBounds.begin(), kBounds.end(), choice.setting.rms_error) - kBounds.begin();
  for (std::size_t k = 0; k < chosen.mips.size(); ++k)
    choice.mips.push_back({chosen.mips[k].roughness, errors[static_cast<std::size_t>(place)].mips[k], 0, 0.0});
  if (source_sizes && finest.bands > 0)
    find_source_sizes(reduced(clean_view(source, view), {control.stop, {}}), chosen, energies, budget.relative, control,
                      choice.mips);
  if (control.progress) control.progress(1.0);
  return choice;
}

template <class View>
PrefilterChoice choose(const View& view, const PrefilterOptions& options, const ErrorBudget& budget, bool source_sizes,
                       const Control& control) {
  estimates::check_budget(budget);
  image::check_view(view);
  const CleanSource source(view, options.pixels, {control.stop, {}});
  const float scale = specular::safe_scale(source);
  if (scale == 1.0F) return choose_for(view, source, options, budget, source_sizes, control);
  const auto pixels = specular::scaled(source, view, scale);  // as the prefilter itself does
  const CleanSource clean(pixels.view(), {}, {control.stop, {}});
  return choose_for(pixels.view(), clean, options, budget, source_sizes, control);
}

}  // namespace

PrefilterChoice choose_prefilter(const LatLongView& source, const PrefilterOptions& options, const ErrorBudget& budget,
                                 bool source_sizes, const Control& control) {
  return choose(source, options, budget, source_sizes, control);
}

PrefilterChoice choose_prefilter(const CubemapView& source, const PrefilterOptions& options, const ErrorBudget& budget,
                                 bool source_sizes, const Control& control) {
  return choose(source, options, budget, source_sizes, control);
}

}  // namespace welkin
