// Light in an engine's own form, as plain numbers.
#include "welkin/engine_light.h"

#include <algorithm>
#include <iterator>

#include "c_interface/enumeration.h"
#include "c_interface/error_status.h"
#include "c_interface/harmonics.h"
#include "c_interface/versioned_struct.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
namespace {

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
