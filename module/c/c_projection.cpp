// What is made of coefficients.
#include "c/c_projection.h"

#include <algorithm>
#include <cstddef>
#include <glm/vec3.hpp>
#include <iterator>
#include <string>

#include "c/c_support.h"
#include "welkin/engine_light.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
namespace {

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

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

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
