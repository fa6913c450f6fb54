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
#include "platform/text.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/lobe.h"
#include "reflections/radiance_scale.h"
#include "reflections/ring_table.h"
#include "transform/spectrum.h"
#include "welkin/irradiance.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kLeastBands = 96;
constexpr int kMostBands = 384;
constexpr int kBandStep = 16;

/// What a light alone in the dark may err by, over `rms_error`. Bright lights do not go through the harmonics, and what
/// is left of a picture has most of its light in the lowest degrees.
constexpr double kOfLoneLight = 3.5;

constexpr double kDefaultError = 1e-3;  ///< from there on lights are merged as far off as they may ever be

constexpr double kLargestOverRms = 10.0;  ///< largest error of a texel over the rms error, of bounds

constexpr double kLambertAlpha = 1.0;  ///< the GGX lobe of roughness 1 is the clipped cosine

constexpr int kLargestDoubled = 255;  ///< texels along an edge of odd faces

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

/// Each texel as 2 x 2: the same picture on faces of an even size, which ring tables serve.
CubemapImage doubled(const CubemapView& source) {
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.size);
  CubemapImage result{2 * source.size, std::vector<float>(24 * row_values * static_cast<std::size_t>(source.size))};
  float* to = result.pixels.data();
  for (int row = 0; row < 6 * source.size; ++row) {
    const auto* const from = static_cast<const float*>(image::row_of(source, row / source.size, row % source.size));
    for (std::size_t k = 0; k < 2 * row_values; ++k) to[k] = from[k / 6 * 3 + k % 3];
    std::copy_n(to, 2 * row_values, to + 2 * row_values);
    to += 4 * row_values;
  }
  return result;
}

/// The spectrum of a picture without its lights.
transforms::Spectrum analyse(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             const IrradiancePlan& plan, const Control& control) {
  const Control quiet{control.stop, {}};
  if (!source.cubemap() || plan.face_size == source.columns()) {
    const Rings rings = rings_of(source, bright, plan.rings, quiet);
    return transforms::analyse(rings.view, plan.bands, control, transforms::SourceRows::fewer);
  }
  const CubemapImage rest{source.columns(), bright.empty() ? std::vector<float>() : pixels_without(bright, source)};
  const CubemapView whole = bright.empty() ? source.cube() : rest.view();
  const CubemapImage other =
      plan.face_size > whole.size ? doubled(whole) : to_cubemap(whole, plan.face_size, glm::dmat3(1.0), quiet);
  const LatLongImage rings = sharp_rings_of_cubemap(other.view(), plan.rings, quiet);
  return transforms::analyse(rings.view(), plan.bands, control, transforms::SourceRows::fewer);
}

/// The mean of the radiance that a surface sees, weighed by the cosine: irradiance over pi.
CubemapImage blurred(const projection::SanitizedSource& source, int size, const IrradiancePlan& plan,
                     const Control& control) {
  const std::vector<BrightTexel> bright =
      find_bright_texels(source, kIrradianceLightAlpha, kMostBright, {control.stop, {}});
  const BrightLights lights(bright, PictureShape::of(source), kLambertAlpha, plan.reach, LightsOf::kernels);
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
  lights.add({kLambertAlpha}, size, faces, jobs::part_of(control, 0.9, 1.0));
  return result;
}

template <class View>
CubemapImage convolved(const projection::SanitizedSource& source, const View& view, int size,
                       const IrradiancePlan& plan, const Control& control) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  const float scale = safe_scale(source);
  CubemapImage result;
  if (scale == 1.0F) {
    result = blurred(source, size, plan, control);
  } else {
    const auto pixels = scaled(source, view, scale);
    result = blurred(projection::SanitizedSource(pixels.view(), {}, {control.stop, {}}), size, plan, control);
  }
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
  const std::vector<double> lobe = lobe_of(kMostBands + kBandStep);
  while (plan.bands <= kMostBands && lost_by_taper(lobe, plan.bands) > kOfLoneLight * rms_error)
    plan.bands += kBandStep;
  if (plan.bands > kMostBands) return {};
  const double light_error = std::min(rms_error, kDefaultError);
  plan.reach = reach_for(light_error, kLargestOverRms * light_error);
  if (!source.cubemap) return plan;
  plan.face_size = source.columns;
  if (plan.face_size % 2 != 0 && plan.face_size <= kLargestDoubled) plan.face_size *= 2;
  const int least = kLeastFace * plan.bands / kLeastBands;
  while (plan.face_size % 4 == 0 && plan.face_size / 2 >= least) plan.face_size /= 2;
  plan.rings = 2 * plan.bands;
  if (RingTable::serves({plan.face_size, plan.rings})) return plan;
  const int edges = 2 * plan.face_size;  // of texels, from pole to pole: rings must lie evenly among them
  plan.rings = edges * std::max(2, (512 + edges - 1) / edges);
  return plan;
}

CubemapImage irradiance_cubemap(const projection::SanitizedSource& source, int size, double rms_error,
                                const Control& control) {
  const IrradiancePlan plan = plan_irradiance(PictureShape::of(source), rms_error);
  if (plan.bands == 0)
    return source.cubemap() ? direct_irradiance_cubemap(source.cube(), size, control)
                            : direct_irradiance_cubemap(source.lat_long(), size, control);
  return source.cubemap() ? convolved(source, source.cube(), size, plan, control)
                          : convolved(source, source.lat_long(), size, plan, control);
}

}  // namespace welkin::reflections
