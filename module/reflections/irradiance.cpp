#include "reflections/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "platform/memory.h"
#include "platform/text.h"
#include "reflections/band_choice.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/lobe.h"
#include "reflections/radiance_scale.h"
#include "transform/spectrum.h"
#include "welkin/irradiance.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kLeastBands = 96;
constexpr int kMostBands = 384;
constexpr int kIrradianceStep = 16;

/// What a light alone in the dark may err by, over `rms_error`. Bright lights do not go through the harmonics, and what
/// is left of a picture has most of its light in the lowest degrees.
constexpr double kOfLoneLight = 3.5;

constexpr double kDefaultError = 1e-3;  ///< from there on lights are merged as far off as they may ever be

constexpr double kLargestOverRms = 10.0;  ///< largest error of a texel over the rms error, of bounds

constexpr double kLambertAlpha = 1.0;  ///< the GGX lobe of roughness 1 is the clipped cosine

/// A cubemap's harmonics are found from faces no smaller than this, at the default bound: the mean over 2 x 2 texels
/// moves light by half a texel at most.
constexpr int kLeastFace = 64;

/// Returns what a light alone loses when the lobe ends with a taper at `bands`: root mean square over the whole's.
double lost_by_taper(const std::vector<double>& lobe, int bands) {
  double kept = 0.0;
  for (int l = 0; l < bands; ++l) {
    const double left = 1.0 - taper(l, bands);
    kept +=
        (2.0 * l + 1.0) * lobe[static_cast<std::size_t>(l)] * lobe[static_cast<std::size_t>(l)] * (1.0 - left * left);
  }
  constexpr double kWhole = 8.0 / 3.0 * kPi * kPi;  // 4 pi times the square's integral
  return std::sqrt(std::max(0.0, kWhole - kept) / kWhole);
}

/// Returns `cosine_lobe` of each degree below `bands`.
std::vector<double> lobe_of(int bands) {
  std::vector<double> lobe(static_cast<std::size_t>(bands), 0.0);
  for (int l = 0; l < std::min(bands, 3); ++l) lobe[static_cast<std::size_t>(l)] = cosine_lobe(l);
  for (std::size_t l = 4; l < lobe.size(); l += 2)
    lobe[l] = -lobe[l - 2] * (static_cast<double>(l) - 3.0) / (static_cast<double>(l) + 2.0);
  return lobe;
}

/// The spectrum of a picture without its lights.
transforms::Spectrum analyse(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             const IrradiancePlan& plan, const Control& control) {
  const Control quiet{control.stop, {}};
  if (!source.cubemap() || plan.face_size == source.columns()) {
    const Rings rings = rings_of(source, bright, plan.rings, quiet);
    return transforms::analyse(rings.view, plan.bands, control, transforms::SourceRows::fewer);
  }
  const auto rest = bright.empty() ? platform::AlignedBuffer<float>() : pixels_without(bright, source);
  const CubemapView whole = bright.empty() ? source.cube() : image::packed_cubemap(rest.data(), source.columns());
  const CubemapImage smaller = to_cubemap(whole, plan.face_size, glm::dmat3(1.0), quiet);
  const Rings rings = rings_of_cubemap(smaller.view(), plan.rings, quiet);
  return transforms::analyse(rings.view, plan.bands, control, transforms::SourceRows::fewer);
}

/// The mean of the radiance that a surface sees, weighed by the cosine: irradiance over pi.
CubemapImage blurred(const projection::SanitizedSource& source, int size, const IrradiancePlan& plan,
                     const Control& control) {
  const std::vector<BrightTexel> bright =
      find_bright_texels(source, kIrradianceLightAlpha, kMostBright, {control.stop, {}});
  const BrightLights lights(bright, PictureShape::of(source), kLambertAlpha, plan.reach, LightsOf::any);
  const transforms::Spectrum spectrum = analyse(source, bright, plan, jobs::part_of(control, 0.0, 0.6));
  std::vector<double> zonal = lobe_of(plan.bands);
  for (int l = 0; l < plan.bands; ++l) zonal[static_cast<std::size_t>(l)] *= taper(l, plan.bands) / kPi;
  const transforms::GridSize grid_size = transforms::grid_for_bands(plan.bands);
  image::SphereGrid grid(grid_size.rings, grid_size.columns, image::GridContent::spline_coefficients);
  transforms::synthesise(spectrum, zonal, grid, jobs::part_of(control, 0.6, 0.8));
  const auto face_values = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  CubemapImage result{size, std::vector<float>(6 * face_values)};
  std::array<float*, 6> faces{};
  for (std::size_t face = 0; face < 6; ++face) faces[face] = result.pixels.data() + face * face_values;
  image::sample_faces(grid, size, faces, {.not_negative = !source.has_negatives()}, jobs::part_of(control, 0.8, 0.9));
  lights.add({Lobe(kLambertAlpha)}, size, faces, jobs::part_of(control, 0.9, 1.0));
  return result;
}

CubemapImage convolved(const projection::SanitizedSource& source, int size, const IrradiancePlan& plan,
                       const Control& control) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  const float scale = safe_scale(source);
  CubemapImage result = scale == 1.0F
                            ? blurred(source, size, plan, control)
                            : blurred(ScaledSource(source, scale, {control.stop, {}}).source(), size, plan, control);
  const double factor = kPi / static_cast<double>(scale);
  for (float& value : result.pixels)
    value = static_cast<float>(std::clamp(factor * static_cast<double>(value), -most, most));
  return result;
}

}  // namespace

void check_irradiance_error(double rms_error) {
  if (rms_error >= 1e-6 && rms_error <= 1.0) return;
  throw Error(ErrorCode::invalid_argument,
              "irradiance.rms_error is " + platform::number_text(rms_error) + "; it must be from 1e-6 to 1");
}

IrradiancePlan plan_irradiance(const PictureShape& source, double rms_error) {
  IrradiancePlan plan;
  plan.bands = kLeastBands;
  const std::vector<double> lobe = lobe_of(kMostBands + kIrradianceStep);
  while (plan.bands <= kMostBands && lost_by_taper(lobe, plan.bands) > kOfLoneLight * rms_error)
    plan.bands += kIrradianceStep;
  if (plan.bands > kMostBands) return {};
  const double light_error = std::min(rms_error, kDefaultError);
  plan.reach = reach_for(light_error, kLargestOverRms * light_error);
  if (!source.cubemap) return plan;
  plan.face_size = source.columns;
  const int least = kLeastFace * plan.bands / kLeastBands;
  while (plan.face_size % 4 == 0 && plan.face_size / 2 >= least) plan.face_size /= 2;
  plan.rings = 2 * plan.bands;
  return plan;
}

CubemapImage irradiance_cubemap(const projection::SanitizedSource& source, int size, double rms_error,
                                const Control& control) {
  const IrradiancePlan plan = plan_irradiance(PictureShape::of(source), rms_error);
  if (plan.bands == 0)
    return source.cubemap() ? direct_irradiance_cubemap(source.cube(), size, control)
                            : direct_irradiance_cubemap(source.lat_long(), size, control);
  return convolved(source, size, plan, control);
}

}  // namespace welkin::reflections
