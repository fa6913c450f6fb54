#include "reflections/prefilter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <numbers>
#include <utility>

#include "image/area_resampling.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sanitized_pixels.h"
#include "reflections/cube_rings.h"
#include "reflections/lobe_chain.h"
#include "reflections/near_sums.h"
#include "reflections/radiance_scale.h"
#include "welkin/resampling.h"

namespace welkin::reflections {

void fill_level(const projection::SanitizedSource& source, Cubemap& chain, int level, const Control& control) {
  const int size = chain.level_size(level);
  const CubemapView& cube = source.cube();
  if (!source.cubemap()) {
    image::fill_cubemap(source.lat_long(), chain, level, ResampleFilter::area, control);
  } else if (cube.size == size) {
    const std::size_t row_values = 3 * static_cast<std::size_t>(size);
    float* to = chain.face(level, 0);
    for (int row = 0; row < source.rows(); ++row, to += row_values) {
      jobs::throw_if_cancelled(control);
      std::memcpy(to, source.row(row), row_values * sizeof(float));
    }
    if (control.progress) control.progress(1.0);
  } else {
    const Cubemap image = to_cubemap(cube, size, glm::dmat3(1.0), ResampleFilter::area, control);
    std::copy(image.pixels().begin(), image.pixels().end(), chain.face(level, 0));
  }
}

void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular) {
  std::vector<PassRecord> passes = std::move(specular.pixels.passes);
  specular.pixels = sanitized;
  specular.pixels.passes = std::move(passes);
  specular.pixels.total_radiance = 4.0 * std::numbers::pi * specular.mips.front().mean;
  specular.pixels.total_radiance_before_clamp = specular.pixels.total_radiance + clamped_radiance;
}

void make_tables(const PrefilterPlan& plan, int face_size, const Control& control) {
  if (plan.bands == 0) return;
  const PrefilterPlan own = plan.at_step(0, {true, face_size, face_size});
  for (const MipPlan& mip : own.mips) {
    if (mip.near.face > 0) static_cast<void>(NearTable::get(mip.near));
  }
  RingTable::get({own.face_for_cubemap(face_size), own.rows_for_cubemap()}, {control.stop});
}

PrefilteredSpecular prefilter(const projection::SanitizedSource& source, const PrefilterPlan& plan, Cubemap room,
                              const Control& control, IrradianceMap* irradiance) {
  const float scale = safe_scale(source);
  if (scale == 1.0F) return LobeChain(source, plan, std::move(room), control.memory).run(control, scale, irradiance);
  const ScaledSource scaled(source, scale, {control.stop, {}});
  return LobeChain(scaled.source(), plan, std::move(room), control.memory).run(control, scale, irradiance);
}

PrefilteredSpecular prefilter(const EnvironmentView& view, const PrefilterPlan& plan, const PixelPolicy& pixels,
                              Cubemap room, const Control& control) {
  const projection::SanitizedSource source(view, pixels, jobs::part_of(control, 0.0, 0.05));
  PrefilteredSpecular result = prefilter(source, plan, std::move(room), jobs::part_of(control, 0.05, 1.0));
  result.peak_bytes += source.bytes();
  describe_pixels(source.diagnostics(), source.clamped_radiance(), result);
  return result;
}

}  // namespace welkin::reflections

namespace welkin {

const char* name(PrefilterMethod method) noexcept {
  static constexpr std::array kNames{"automatic", "spectral", "reference"};
  return platform::name_in<PrefilterMethod::reference>(kNames, method, "automatic");
}

const char* name(MipMethod method) noexcept {
  static constexpr std::array kNames{"copy", "spectral", "reference", "stored", "near_far"};
  return platform::name_in<MipMethod::near_far>(kNames, method, "copy");
}

PrefilteredSpecular prefilter_specular(const EnvironmentView& source, const PrefilterOptions& options,
                                       const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  return reflections::prefilter(source, reflections::plan_prefilter(options), options.pixels, {}, control);
}

}  // namespace welkin
