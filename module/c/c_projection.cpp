// Projections while the caller waits.
#include "c/c_projection.h"

#include <algorithm>
#include <cstddef>
#include <glm/vec3.hpp>
#include <iterator>
#include <limits>
#include <string>

#include "c/c_support.h"
#include "welkin/engine_light.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
namespace {

constexpr std::int32_t kMostLevels = 15;  // of 16384 texels

static_assert(WELKIN_FORMAT_RGBA_SRGB8 == static_cast<int>(PixelFormat::rgba_srgb8));
static_assert(WELKIN_FORMAT_RGB_F16 == static_cast<int>(PixelFormat::rgb_f16));
static_assert(WELKIN_FORMAT_RGB_U8 == static_cast<int>(PixelFormat::rgb_u8));

PixelFormat pixel_format(welkin_format format) { return enumerator("format", format, PixelFormat::rgba_srgb8); }

/// The most negative stride has no opposite to be compared with.
std::ptrdiff_t stride(std::int64_t row_stride_bytes) {
  if (row_stride_bytes == std::numeric_limits<std::int64_t>::min()) {
    refuse("row_stride_bytes is " + std::to_string(row_stride_bytes) + "; no picture is that large");
  }
  return row_stride_bytes;
}

CubemapView cubemap_view(const welkin_cubemap* cubemap) {
  const welkin_cubemap given = read_struct(cubemap, "mips");
  CubemapView view;
  std::copy(std::begin(given.faces), std::end(given.faces), view.faces.begin());
  if (given.size < 0 || given.size > std::numeric_limits<int>::max()) {
    refuse("the cubemap's size is " + std::to_string(given.size) + "; it must be from 1 to 16384");
  }
  view.size = static_cast<int>(given.size);
  view.row_stride_bytes = stride(given.row_stride_bytes);
  view.format = pixel_format(given.format);
  return view;
}

}  // namespace

std::vector<CubemapView> cubemap_views(const welkin_cubemap* mips, std::int32_t mip_count) {
  if (mip_count < 1 || mip_count > kMostLevels) {
    refuse("mip_count is " + std::to_string(mip_count) + "; it must be from 1 to " + std::to_string(kMostLevels));
  }
  const std::size_t step = stated_size(mips, sizeof(welkin_cubemap), alignof(welkin_cubemap), "mips");
  std::vector<CubemapView> views;
  for (std::int32_t level = 0; level < mip_count; ++level) {
    // The caller's structures may be shorter or longer than ours: the next one lies where this one ends for them.
    const auto* place = reinterpret_cast<const std::byte*>(mips) + static_cast<std::size_t>(level) * step;
    const auto* mip = reinterpret_cast<const welkin_cubemap*>(place);
    if (stated_size(mip, sizeof(welkin_cubemap), alignof(welkin_cubemap), "mips") != step) {
      refuse("mips[" + std::to_string(level) + "].struct_size differs from that of mips[0]");
    }
    views.push_back(cubemap_view(mip));
  }
  return views;
}

LatLongView lat_long_view(const welkin_lat_long* lat_long) {
  const welkin_lat_long given = read_struct(lat_long, "lat_long");
  return {given.pixels, given.width, given.height, stride(given.row_stride_bytes), pixel_format(given.format)};
}

namespace {

static_assert(WELKIN_MAXIMUM_BANDS == kMaximumBands);
static_assert(WELKIN_QUADRATURE_MIDPOINT == static_cast<int>(Quadrature::midpoint));
static_assert(WELKIN_NON_FINITE_REJECT == static_cast<int>(NonFinitePolicy::reject));
static_assert(WELKIN_NEGATIVE_REPLACE == static_cast<int>(NegativePolicy::replace));
static_assert(WELKIN_NEGATIVE_REJECT == static_cast<int>(NegativePolicy::reject));

}  // namespace

ProjectionOptions projection_options(const welkin_projection_options* options) {
  const auto given = read_options(options, "options");
  ProjectionOptions wanted;
  if (given.bands != 0) wanted.bands = given.bands;
  wanted.quadrature = enumerator("quadrature", given.quadrature, Quadrature::midpoint);
  wanted.target_size = given.target_size;
  const bool preserve_colour = flag("clamp_preserve_colour", given.clamp_preserve_colour);
  if (given.clamp_maximum != 0.0F) wanted.clamp = RadianceClamp{given.clamp_maximum, preserve_colour};
  wanted.gamma = flag("gamma", given.gamma);
  wanted.nan = enumerator("nan", given.nan, NonFinitePolicy::reject);
  wanted.infinity = enumerator("infinity", given.infinity, NonFinitePolicy::reject);
  wanted.negative = enumerator("negative", given.negative, NegativePolicy::reject);
  return wanted;
}

}  // namespace welkin::c_interface

// Entries of C have no namespace to be in.
using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_project_cubemap(const welkin_cubemap* mips, int32_t mip_count,
                                     const welkin_projection_options* options, const welkin_control* control,
                                     welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(cubemap_views(mips, mip_count), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

welkin_status welkin_project_lat_long(const welkin_lat_long* lat_long, const welkin_projection_options* options,
                                      const welkin_control* control, welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(lat_long_view(lat_long), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

namespace welkin::c_interface {
namespace {

// What is made of coefficients.

void write_triple(const glm::dvec3& rgb, double* target) {
  for (int channel = 0; channel < 3; ++channel) target[channel] = rgb[channel];
}

}  // namespace

void require_room(const welkin_projection* projection, int bands) {
  const std::size_t size = stated_size(projection, sizeof(welkin_projection), alignof(welkin_projection), "projection");
  const auto count = static_cast<std::size_t>(std::clamp(bands, 1, kMaximumBands));
  const std::size_t needed = offsetof(welkin_projection, coefficients) + 3 * count * count * sizeof(double);
  if (size < needed) {
    refuse("projection->struct_size is " + std::to_string(size) + "; " + std::to_string(count) + " bands need " +
           std::to_string(needed));
  }
}

void write_projection(welkin_projection* projection, const Projection& light) {
  require_room(projection, light.radiance.bands());
  welkin_projection values{};
  values.bands = light.radiance.bands();
  const ProjectionDiagnostics& diagnostics = light.diagnostics;
  values.texels = diagnostics.texels;
  values.nans_replaced = diagnostics.nans_replaced;
  values.infinities_replaced = diagnostics.infinities_replaced;
  values.negatives_replaced = diagnostics.negatives_replaced;
  values.texels_clamped = diagnostics.texels_clamped;
  write_triple(diagnostics.total_radiance_before_clamp, values.total_radiance_before_clamp);
  write_triple(diagnostics.total_radiance, values.total_radiance);
  values.error_estimate = diagnostics.error_estimate;
  double* place = values.coefficients;
  for (const glm::dvec3& rgb : light.radiance.coefficients()) {
    write_triple(rgb, place);
    place += 3;
  }
  write_struct(projection, values, "projection");
}

SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name) {
  require(coefficients, name);
  SphericalHarmonics harmonics(bands);
  for (glm::dvec3& rgb : harmonics.coefficients()) {
    rgb = {coefficients[0], coefficients[1], coefficients[2]};
    coefficients += 3;
  }
  return harmonics;
}

}  // namespace welkin::c_interface

welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance) {
  return guarded([&] {
    require(irradiance, "irradiance");
    const auto result = welkin::irradiance_from_radiance(read_harmonics(bands, radiance, "radiance"));
    for (const glm::dvec3& rgb : result.coefficients()) {
      for (int channel = 0; channel < 3; ++channel) *irradiance++ = rgb[channel];
    }
    return WELKIN_OK;
  });
}

welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction, double* value) {
  return guarded([&] {
    require(direction, "direction");
    require(value, "value");
    const glm::dvec3 rgb = welkin::evaluate(read_harmonics(bands, coefficients, "coefficients"),
                                            {direction[0], direction[1], direction[2]});
    for (int channel = 0; channel < 3; ++channel) value[channel] = rgb[channel];
    return WELKIN_OK;
  });
}

namespace welkin::c_interface {
namespace {

// Light in an engine's own form, as plain numbers.

static_assert(WELKIN_ENGINE_BABYLON == static_cast<int>(Engine::babylon));
static_assert(WELKIN_ENGINE_THREE == static_cast<int>(Engine::three));
static_assert(WELKIN_ENGINE_FILAMENT == static_cast<int>(Engine::filament));
static_assert(WELKIN_ENGINE_GLTF == static_cast<int>(Engine::gltf));
static_assert(WELKIN_ENGINE_UNITY == static_cast<int>(Engine::unity));
static_assert(WELKIN_ENGINE_UNREAL == static_cast<int>(Engine::unreal));
static_assert(WELKIN_ENGINE_GODOT == static_cast<int>(Engine::godot));

welkin_engine_light plain(const EngineLight& light) {
  welkin_engine_light values{};
  values.engine = static_cast<welkin_engine>(light.engine);
  if (light.terms.size() > std::size(values.terms) || light.vectors.size() > std::size(values.vectors)) {
    throw StatusError(WELKIN_INTERNAL, "an engine's form has more terms than welkin_engine_light");
  }
  values.term_count = static_cast<std::int32_t>(light.terms.size());
  values.vector_count = static_cast<std::int32_t>(light.vectors.size());
  for (std::size_t i = 0; i < light.terms.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) values.terms[i][channel] = light.terms[i].rgb[channel];
  }
  for (std::size_t i = 0; i < light.vectors.size(); ++i) {
    for (int component = 0; component < 4; ++component) {
      values.vectors[i][component] = light.vectors[i].value[component];
    }
  }
  return values;
}

using Form = EngineLight (*)(const SphericalHarmonics&, Engine);

welkin_status write_form(Form form, int32_t bands, const double* radiance, welkin_engine engine,
                         welkin_engine_light* light) {
  return guarded([&] {
    const Engine wanted = enumerator("engine", engine, Engine::godot);
    write_struct(light, plain(form(read_harmonics(bands, radiance, "radiance"), wanted)), "light");
    return WELKIN_OK;
  });
}

}  // namespace
}  // namespace welkin::c_interface

welkin_status welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                                welkin_engine_light* light) {
  return welkin::c_interface::write_form(&welkin::engine_light, bands, radiance, engine, light);
}

welkin_status welkin_engine_light_in_place(int32_t bands, const double* radiance, welkin_engine engine,
                                           welkin_engine_light* light) {
  return welkin::c_interface::write_form(&welkin::engine_light_in_place, bands, radiance, engine, light);
}
