// Harmonics of a sky, and the dynamic sky of an engine's loop.
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "welkin/reflections.h"
#include "welkin/requests.h"
#include "welkin/sky.h"
#include "welkin/sky_light.h"
#include "welkin/welkin.h"

/// A dynamic sky, and the chains that it lends, as in the reflections of its last update.
struct welkin_sky_light {
  template <class... Arguments>
  explicit welkin_sky_light(Arguments&&... arguments) : light(std::forward<Arguments>(arguments)...) {}

  struct Lent {
    std::shared_ptr<const welkin::PrefilteredSpecular> specular;
    welkin_chain chain;
    std::uint64_t id = 0;
  };

  welkin::SkyLight light;
  std::array<Lent, 2> lent;
  std::uint64_t last_id = 0;
};

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

// Harmonics.

namespace welkin::c_interface {
namespace {

const SkyCurve& curve_of(const welkin_sky_curve* curve) {
  require(curve, "curve");
  return curve->curve;
}

}  // namespace

SkyCurveOptions curve_options(const welkin_sky_harmonics_options* options) {
  const auto given = read_options(options, "curve options");
  SkyCurveOptions wanted;
  set_unless_zero(wanted.bands, given.bands);
  set_unless_zero(wanted.projection.zeniths, given.zeniths);
  set_unless_zero(wanted.projection.azimuths, given.azimuths);
  set_unless_zero(wanted.nodes, given.nodes);
  return wanted;
}

}  // namespace welkin::c_interface

welkin_status welkin_sky_curve_create(const welkin_sky_view* view, const welkin_sky_harmonics_options* options,
                                      const welkin_control* control, welkin_sky_curve** curve) {
  return guarded_making(curve, "curve", [&] {
    return new welkin_sky_curve{welkin::SkyCurve(view_of(view), curve_options(options), control_of(control))};
  });
}

void welkin_sky_curve_destroy(welkin_sky_curve* curve) { destroy(curve); }

welkin_status welkin_sky_curve_at(const welkin_sky_curve* curve, const double* sun, double* coefficients,
                                  double* sun_irradiance) {
  return guarded([&] {
    const welkin::SkyCurve& light = curve_of(curve);
    const glm::dvec3 towards_sun = read_triple(sun, "sun");
    const auto functions = static_cast<std::size_t>(light.bands() * light.bands());
    light.at(towards_sun, triples(coefficients, functions, "coefficients"));
    if (sun_irradiance != nullptr) write_triple(light.sun_irradiance(towards_sun), sun_irradiance);
  });
}

welkin_status welkin_post_sky_curve(welkin_worker* worker, const welkin_sky_tables* tables, double altitude_m,
                                    const welkin_sky_harmonics_options* options, const welkin_post_options* post,
                                    welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& /*posting*/) {
    return welkin::BakeSkyCurve{tables_of(tables), altitude_m, curve_options(options)};
  });
}

welkin_status welkin_job_get_sky_curve(const welkin_job* job, welkin_sky_curve** curve) {
  return hand_out_result<welkin::SkyCurve>(job, curve, "curve",
                                           [](const welkin::SkyCurve& made) { return new welkin_sky_curve{made}; });
}

// The dynamic sky.

namespace welkin::c_interface {
SkyLightOptions light_options(const welkin_sky_light_options* options) {
  const auto given = read_options(options, "options");
  // Zero selects the default; a negative value sets 0, which is no threshold.
  const auto set_threshold = [](double& target, double value) {
    if (value != 0.0) target = std::max(value, 0.0);
  };
  SkyLightOptions wanted;
  wanted.tables = table_options(given.tables);
  wanted.curve = curve_options(given.curve);
  wanted.altitude_m = given.altitude_m;
  wanted.specular = prefilter_options(given.specular, kSkyReflections, false);
  if (flag("without_specular", given.without_specular)) wanted.specular.size = 0;
  set_threshold(wanted.sun_threshold_degrees, given.sun_threshold_degrees);
  set_threshold(wanted.specular_threshold_degrees, given.specular_threshold_degrees);
  set_threshold(wanted.altitude_threshold_m, given.altitude_threshold_m);
  set_threshold(wanted.blend_seconds, given.blend_seconds);
  wanted.priority = priority_of(given.priority);
  return wanted;
}

namespace {

template <class Handle>
auto& light_of(Handle* light) {
  require(light, "light");
  return light->light;
}

/// Lends the chains of this frame. A chain that was already lent keeps its id, whichever slot it is in now.
void lend(welkin_sky_light& sky, const SkyLightFrame& frame) {
  const auto& wanted = frame.reflections;
  if (sky.lent[0].specular == wanted[0].specular && sky.lent[1].specular == wanted[1].specular) return;
  std::array<welkin_sky_light::Lent, 2> next;
  std::uint64_t last_id = sky.last_id;
  for (std::size_t i = 0; i < next.size(); ++i) {
    const auto& specular = wanted[i].specular;
    if (!specular) continue;
    for (const auto& before : sky.lent) {
      if (before.specular == specular) next[i] = before;
    }
    if (next[i].id == 0) next[i] = {specular, welkin_chain(specular), ++last_id};
  }
  sky.lent = std::move(next);
  sky.last_id = last_id;
}

void write_frame(const welkin_sky_light& sky, const SkyLightFrame& light, welkin_sky_frame* frame) {
  welkin_sky_frame values{};
  values.ready = light.ready ? 1 : 0;
  values.settled = light.settled ? 1 : 0;
  values.bands = light.radiance.bands();
  write_triple(light.sun.direction, values.sun_direction);
  write_triple(light.sun.irradiance, values.sun_irradiance);
  values.sun_solid_angle = light.sun.solid_angle;
  for (std::size_t i = 0; i < light.reflections.size(); ++i) {
    const auto& lent = sky.lent[i];
    values.reflections[i].chain = lent.id != 0 ? &lent.chain : nullptr;
    values.reflections[i].id = lent.id;
    values.reflections[i].weight = light.reflections[i].weight;
    write_matrix(light.reflections[i].rotation, values.reflections[i].rotation);
  }
  write_harmonics(light.radiance, values.coefficients);
  write_struct(frame, values, "frame");
}

}  // namespace
}  // namespace welkin::c_interface

welkin_status welkin_sky_light_create(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                      const welkin_sky_tables* tables, const welkin_sky_light_options* options,
                                      welkin_sky_light** light) {
  return guarded_making(light, "light", [&] {
    require(worker, "worker");
    const welkin::SkyLightOptions wanted = light_options(options);
    return tables == nullptr ? new welkin_sky_light(worker->worker, atmosphere_of(atmosphere), wanted)
                             : new welkin_sky_light(worker->worker, tables_of(tables), wanted);
  });
}

void welkin_sky_light_destroy(welkin_sky_light* light) { destroy(light); }

welkin_status welkin_sky_light_set_sun(welkin_sky_light* light, const double* sun) {
  return guarded([&] { light_of(light).set_sun(read_triple(sun, "sun")); });
}

welkin_status welkin_sky_light_set_intensity(welkin_sky_light* light, double intensity) {
  return guarded([&] { light_of(light).set_intensity(intensity); });
}

welkin_status welkin_sky_light_set_altitude(welkin_sky_light* light, double altitude_m) {
  return guarded([&] { light_of(light).set_altitude(altitude_m); });
}

welkin_status welkin_sky_light_set_atmosphere(welkin_sky_light* light, const welkin_atmosphere* atmosphere) {
  return guarded([&] { light_of(light).set_atmosphere(atmosphere_of(atmosphere)); });
}

welkin_status welkin_sky_light_update(welkin_sky_light* light, double seconds, welkin_sky_frame* frame) {
  return guarded([&] {
    require_room_for_bands(frame, light_of(light).light().radiance.bands(), "frame");
    const auto& now = light_of(light).update(seconds);
    lend(*light, now);
    write_frame(*light, now, frame);
  });
}

welkin_status welkin_sky_light_get_status(const welkin_sky_light* light) {
  return guarded([&] {
    const std::exception_ptr error = light_of(light).error();
    return error ? report(outcome_of(error)) : WELKIN_OK;
  });
}
