// Projections, synchronous and as jobs; harmonics, and light in the forms of engines.
#include <algorithm>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/requests.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

static_assert(WELKIN_MAXIMUM_BANDS == welkin::kMaximumBands);

// Entries of C cannot be in a namespace.
using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

welkin_status welkin_project(const welkin_environment* mips, int32_t mip_count,
                             const welkin_projection_options* options, const welkin_control* control,
                             welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    const auto light = mip_count == 1 ? welkin::project(environment_view(mips, "mips"), wanted, control_of(control))
                                      : welkin::project(cubemap_views(mips, mip_count), wanted, control_of(control));
    write_projection(projection, light.radiance, light.diagnostics);
  });
}

welkin_status welkin_project_many(const welkin_environment* probes, int64_t probe_count,
                                  const welkin_projection_options* options, const welkin_control* control,
                                  double* coefficients, welkin_projection* totals) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    const auto views = probe_views(probes, probe_count);
    if (totals != nullptr) require_room(totals, 0);
    if (!views.empty()) require(coefficients, "coefficients");
    const std::size_t count = views.size() * static_cast<std::size_t>(wanted.bands * wanted.bands);
    const auto sum = welkin::project_many(views, triples(coefficients, count), wanted, control_of(control));
    if (totals != nullptr) write_diagnostics(totals, sum);
  });
}

welkin_status welkin_post_project(welkin_worker* worker, const welkin_environment* mips, int32_t mip_count,
                                  const welkin_projection_options* options, const welkin_post_options* post,
                                  welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    auto views = mip_count == 1 ? std::vector<welkin::CubemapView>{} : cubemap_views(mips, mip_count);
    const auto whole = views.empty() ? environment_view(mips, "mips") : views.front();
    const auto wanted = projection_options(options);
    auto owner = make_owner(std::move(posting.handed_over));
    auto source = views.empty() ? welkin::EnvironmentSource(whole, std::move(owner))
                                : welkin::EnvironmentSource(std::move(views), std::move(owner));
    return welkin::Project{std::move(source), wanted};
  });
}

welkin_status welkin_job_projection(const welkin_job* job, welkin_projection* projection) {
  return with_result<welkin::Projection>(job, "projection", [&](const welkin::Projection& light) {
    write_projection(projection, light.radiance, light.diagnostics);
  });
}

// Harmonics.

welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance) {
  return guarded([&] {
    require(irradiance, "irradiance");
    write_harmonics(welkin::irradiance_from_radiance(read_harmonics(bands, radiance, "radiance")), irradiance);
  });
}

welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction, double* value) {
  return guarded([&] {
    const glm::dvec3 towards = read_triple(direction, "direction");
    require(value, "value");
    write_triple(welkin::evaluate(read_harmonics(bands, coefficients, "coefficients"), towards), value);
  });
}

welkin_status welkin_rotate(int32_t bands, const double* coefficients, const double* matrix, double* rotated) {
  return guarded([&] {
    require(matrix, "matrix");
    require(rotated, "rotated");
    const glm::dmat3 orthogonal(read_triple(matrix, "matrix"), read_triple(matrix + 3, "matrix"),
                                read_triple(matrix + 6, "matrix"));
    write_harmonics(welkin::rotate(read_harmonics(bands, coefficients, "coefficients"), orthogonal), rotated);
  });
}

static_assert(WELKIN_WINDOW_HANNING == static_cast<int>(welkin::Window::hanning));
static_assert(WELKIN_WINDOW_LANCZOS == static_cast<int>(welkin::Window::lanczos));
static_assert(WELKIN_WINDOW_MIN_LAPLACIAN == static_cast<int>(welkin::Window::min_laplacian));

welkin_status welkin_apply_window(int32_t bands, const double* radiance, welkin_window window, double width,
                                  double* windowed) {
  return guarded([&] {
    require(windowed, "windowed");
    const auto wanted = enumerator("window", window, welkin::Window::min_laplacian);
    write_harmonics(welkin::apply_window(read_harmonics(bands, radiance, "radiance"), wanted, width).radiance,
                    windowed);
  });
}

welkin_status welkin_exposure_of(int32_t bands, const double* radiance, double* exposure) {
  return guarded([&] {
    require(exposure, "exposure");
    *exposure = welkin::exposure_of(read_harmonics(bands, radiance, "radiance"));
  });
}

welkin_status welkin_dominant_light(int32_t bands, const double* radiance, double* direction, double* irradiance,
                                    int32_t* found) {
  return guarded([&] {
    require(direction, "direction");
    require(irradiance, "irradiance");
    require(found, "found");
    const auto light = welkin::dominant_light(read_harmonics(bands, radiance, "radiance"));
    const auto values = light.value_or(welkin::DominantLight{});
    write_triple(values.direction, direction);
    write_triple(values.irradiance, irradiance);
    *found = light ? 1 : 0;
  });
}

welkin_status welkin_sun_harmonics(const double* direction, const double* irradiance, double solid_angle, int32_t bands,
                                   double* coefficients) {
  return guarded([&] {
    require(coefficients, "coefficients");
    welkin::Sun light;
    light.direction = read_triple(direction, "direction");
    light.irradiance = read_triple(irradiance, "irradiance");
    light.solid_angle = solid_angle;
    write_harmonics(welkin::sun_harmonics(light, bands), coefficients);
  });
}

// Engines.

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_ENGINE_WELKIN == static_cast<int>(Engine::welkin));
static_assert(WELKIN_ENGINE_OPENEXR == static_cast<int>(Engine::openexr));
static_assert(WELKIN_ENGINE_BLENDER == static_cast<int>(Engine::blender));
static_assert(WELKIN_ENGINE_BABYLON == static_cast<int>(Engine::babylon));
static_assert(WELKIN_ENGINE_THREE == static_cast<int>(Engine::three));
static_assert(WELKIN_ENGINE_FILAMENT == static_cast<int>(Engine::filament));
static_assert(WELKIN_ENGINE_GLTF == static_cast<int>(Engine::gltf));
static_assert(WELKIN_ENGINE_UNITY == static_cast<int>(Engine::unity));
static_assert(WELKIN_ENGINE_UNREAL == static_cast<int>(Engine::unreal));
static_assert(WELKIN_ENGINE_GODOT == static_cast<int>(Engine::godot));
static_assert(WELKIN_ENGINE_BEVY == static_cast<int>(Engine::bevy));
static_assert(WELKIN_ENGINE_USD == static_cast<int>(Engine::usd));
static_assert(WELKIN_ENGINE_PLAYCANVAS == static_cast<int>(Engine::playcanvas));
static_assert(WELKIN_ENGINE_QT == static_cast<int>(Engine::qt));

welkin_engine_light plain(const EngineLight& light) {
  welkin_engine_light values{};
  values.engine = static_cast<welkin_engine>(light.engine);
  if (light.terms.size() > std::size(values.terms) || light.vectors.size() > std::size(values.vectors)) {
    throw StatusError(WELKIN_INTERNAL, "an engine's form has more terms than welkin_engine_light");
  }
  values.term_count = static_cast<std::int32_t>(light.terms.size());
  values.vector_count = static_cast<std::int32_t>(light.vectors.size());
  for (std::size_t i = 0; i < light.terms.size(); ++i) {
    write_triple(light.terms[i].rgb, values.terms[i]);
  }
  for (std::size_t i = 0; i < light.vectors.size(); ++i) {
    for (int component = 0; component < 4; ++component) {
      values.vectors[i][component] = light.vectors[i].value[component];
    }
  }
  return values;
}

}  // namespace
}  // namespace welkin::c_interface

welkin_status welkin_engine_light_from_radiance(int32_t bands, const double* radiance, welkin_engine engine,
                                                int32_t in_place, welkin_engine_light* light) {
  return guarded([&] {
    const auto wanted = enumerator("engine", engine, welkin::Engine::qt);
    const auto harmonics = read_harmonics(bands, radiance, "radiance");
    const auto form = flag("in_place", in_place) ? welkin::engine_light_unrotated(harmonics, wanted)
                                                 : welkin::engine_light(harmonics, wanted);
    write_struct(light, plain(form), "light");
  });
}

welkin_status welkin_get_axes(welkin_engine engine, double* from_welkin, double* faces_from_engine) {
  return guarded([&] {
    require(from_welkin, "from_welkin");
    require(faces_from_engine, "faces_from_engine");
    const auto& known = welkin::convention(enumerator("engine", engine, welkin::Engine::qt));
    write_matrix(known.from_welkin, from_welkin);
    write_matrix(known.faces_from_engine.value_or(welkin::dmat3(0.0)), faces_from_engine);
  });
}
