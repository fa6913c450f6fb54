#include "welkin/sky_light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "sky/sky_geometry.h"
#include "sky/sky_projection.h"
#include "sky/sunlight.h"
#include "sky/table_sizes.h"
#include "welkin/core.h"
#include "worker/sky_baker.h"

namespace welkin {
namespace {

constexpr double kLargestIntensity = 1e12;

bool same_but_for_name(const Atmosphere& a, const Atmosphere& b) {
  Atmosphere renamed = a;
  renamed.name = b.name;
  return renamed == b;
}

const SkyLightOptions& checked(const SkyLightOptions& options) {
  sky::check_altitude(options.altitude_m);
  platform::require_between("dynamic sky: nodes of the curve", options.curve.nodes, 8, 4096);
  platform::require_between("dynamic sky: size of the reflections", options.specular.size, 0, 8192);
  platform::require_between("dynamic sky: sun threshold in degrees", options.sun_threshold_degrees, 0.0, 10.0);
  platform::require_between("dynamic sky: specular threshold in degrees", options.specular_threshold_degrees, 0.0,
                            90.0);
  platform::require_between("dynamic sky: altitude threshold in metres", options.altitude_threshold_m, 0.0, 1e6);
  SkyHarmonicsOptions projection = options.curve.projection;
  projection.bands = options.curve.bands;
  (void)sky::sky_rule(projection, 0.0, 1.0, 0.0);  // throws what the bake would throw later
  platform::require_between("dynamic sky: blend in seconds", options.blend_seconds, 0.0, 3600.0);
  return options;
}

glm::dvec3 unit(const glm::dvec3& direction) {
  return glm::normalize(math::rescaled_direction(direction, "dynamic sky: the sun's direction"));
}

/// Returns the sun's azimuth as (sine, cosine); at the zenith that of +z.
glm::dvec2 azimuth(const glm::dvec3& sun) {
  const double across = std::sqrt(sun.x * sun.x + sun.z * sun.z);
  return across > 0.0 ? glm::dvec2(sun.x / across, sun.z / across) : glm::dvec2(0.0, 1.0);
}

/// Returns the rotation about the vertical from one sun's azimuth to the other's.
glm::dmat3 rotate(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec2 a = azimuth(from);
  const glm::dvec2 b = azimuth(to);
  const double cosine = a.x * b.x + a.y * b.y;
  const double sine = b.x * a.y - b.y * a.x;
  return {cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine};
}

/// sin^2 of half the angle between two elevations.
double elevation_gap(const glm::dvec3& a, const glm::dvec3& b) {
  const double across = std::sqrt(a.x * a.x + a.z * a.z) - std::sqrt(b.x * b.x + b.z * b.z);
  const double up = a.y - b.y;
  return 0.25 * (across * across + up * up);
}

double half_angle_square(double degrees) {
  const double sine = math::sine_cosine_of_turns(degrees / 720.0).sine;
  return sine * sine;
}

/// An old and a new thing, and how far it is from the one to the other.
template <class Thing>
struct Blend {
  Thing newer{};
  Thing older{};
  double part = 1.0;  ///< of the newer

  [[nodiscard]] bool under_way() const noexcept { return part < 1.0; }
  void take(Thing thing, bool at_once) {
    older = std::exchange(newer, std::move(thing));
    part = at_once ? 1.0 : 0.0;
  }
};

}  // namespace

struct SkyLight::State {
  SkyLightOptions options;
  std::shared_ptr<worker::SkyBaker> baker;
  worker::SkyTarget target;
  SkyLightFrame frame;
  SkyLightCounters counters;
  glm::dvec3 sun{0.0, 1.0, 0.0};
  double intensity = 1.0;
  double sun_gap;       ///< sin^2 of half the threshold
  double specular_gap;  ///< sin^2 of half the threshold for reflections
  Blend<worker::BakedCurve> curves;
  Blend<worker::BakedReflections> reflections;
  std::vector<glm::dvec3> older_light;
  std::array<std::shared_ptr<const void>, 4> garbage;  ///< to be freed on the worker
  bool dirty = true;

  /// `tables` may be null: they are made first then.
  State(Worker& worker, std::shared_ptr<const Atmosphere> atmosphere, std::shared_ptr<const SkyTables> tables,
        const SkyLightOptions& its_options);

  void move_sun(const glm::dvec3& to);
  void request_light(bool stop);
  void take_news();
  [[nodiscard]] bool advance(double seconds);
  void compute_light();
  void place_reflections();
  [[nodiscard]] Sun sun_of(const glm::dvec3& irradiance, double radius_degrees) const;
  void let_go(std::shared_ptr<const void> old);
};

SkyLight::State::State(Worker& worker, std::shared_ptr<const Atmosphere> atmosphere,
                       std::shared_ptr<const SkyTables> tables, const SkyLightOptions& its_options)
    : options(checked(its_options)),
      baker(std::make_shared<worker::SkyBaker>(worker, options, tables)),
      sun_gap(half_angle_square(options.sun_threshold_degrees)),
      specular_gap(half_angle_square(options.specular_threshold_degrees)),
      older_light(static_cast<std::size_t>(options.curve.bands) * static_cast<std::size_t>(options.curve.bands)) {
  frame.radiance = SphericalHarmonics(options.curve.bands);
  target = {.versions = {.tables = tables ? 0U : 1U, .curve = 1, .specular = options.specular.size > 0 ? 1U : 0U},
            .atmosphere = std::move(atmosphere),
            .altitude_m = options.altitude_m};
  baker->set(target, false);
}

SkyLight::SkyLight(Worker& worker, const Atmosphere& atmosphere, const SkyLightOptions& options) {
  const platform::FloatingPointScope floating_point;
  (void)sky::sky_table_bytes(atmosphere, checked(options).tables);
  state_ = std::make_unique<State>(worker, std::make_shared<const Atmosphere>(atmosphere), nullptr, options);
}

SkyLight::SkyLight(Worker& worker, std::shared_ptr<const SkyTables> tables, const SkyLightOptions& options) {
  const platform::FloatingPointScope floating_point;
  if (!tables)
    throw Error(ErrorCode::invalid_argument, "dynamic sky: the tables are a null pointer; precompute_sky makes some");
  SkyLightOptions with_tables = checked(options);
  with_tables.tables = tables->options;
  (void)sky::sky_table_bytes(tables->atmosphere, tables->options);
  auto atmosphere = std::shared_ptr<const Atmosphere>(tables, &tables->atmosphere);
  state_ = std::make_unique<State>(worker, std::move(atmosphere), std::move(tables), with_tables);
}

SkyLight::~SkyLight() { state_->baker->close(); }

void SkyLight::set_sun(double elevation_degrees, double azimuth_degrees) {
  const platform::FloatingPointScope floating_point;
  state_->move_sun(unit(sun_direction(elevation_degrees, azimuth_degrees)));
}

void SkyLight::set_sun(const glm::dvec3& direction) {
  const platform::FloatingPointScope floating_point;
  state_->move_sun(unit(direction));
}

void SkyLight::State::move_sun(const glm::dvec3& to) {
  baker->retry();
  const glm::dvec3 chord = to - sun;
  const double moved = glm::dot(chord, chord);  // (2 sin(angle / 2))^2
  if (moved == 0.0) return;
  if (moved < 4.0 * sun_gap) {
    ++counters.moves_ignored;
    return;
  }
  constexpr double same_elevation = 1e-20;
  const bool rises = elevation_gap(to, sun) > same_elevation;
  sun = to;
  dirty = true;
  if (!rises) {
    ++counters.rotations;
    return;
  }
  ++counters.elevations;
  if (options.specular.size == 0) return;
  if (elevation_gap(to, target.sun) < specular_gap) {
    ++counters.reflections_skipped;
    return;
  }
  target.sun = to;
  ++target.versions.specular;
  baker->set(target, false);
}

void SkyLight::set_intensity(double intensity) {
  const platform::FloatingPointScope floating_point;
  platform::require_between("dynamic sky: intensity", intensity, 0.0, kLargestIntensity);
  state_->baker->retry();
  if (intensity == state_->intensity) return;
  state_->intensity = intensity;
  state_->dirty = true;
  ++state_->counters.intensities;
}

void SkyLight::set_altitude(double altitude_m) {
  const platform::FloatingPointScope floating_point;
  sky::check_altitude(altitude_m);
  worker::SkyTarget& target = state_->target;
  state_->baker->retry();
  if (altitude_m == target.altitude_m) return;
  if (std::abs(altitude_m - target.altitude_m) < state_->options.altitude_threshold_m) {
    ++state_->counters.moves_ignored;
    return;
  }
  target.altitude_m = altitude_m;
  state_->request_light(false);
}

void SkyLight::set_atmosphere(const Atmosphere& atmosphere) {
  const platform::FloatingPointScope floating_point;
  (void)sky::sky_table_bytes(atmosphere, state_->options.tables);
  worker::SkyTarget& target = state_->target;
  state_->baker->retry();
  if (same_but_for_name(*target.atmosphere, atmosphere)) return;
  target.atmosphere = std::make_shared<const Atmosphere>(atmosphere);
  ++target.versions.tables;
  state_->request_light(true);
}

/// A curve and reflections of what the target has become.
void SkyLight::State::request_light(bool stop) {
  target.sun = sun;
  ++target.versions.curve;
  if (options.specular.size > 0) ++target.versions.specular;
  baker->set(target, stop);
}

/// Takes new results. Those that come during a blend wait for its end: a blend has two slots only.
void SkyLight::State::take_news() {
  std::optional<worker::SkyUpdates> news = baker->try_take(!curves.under_way(), !reflections.under_way(), garbage);
  frame.settled = news && !news->more_to_come;
  if (!news) return;
  const bool blends = options.blend_seconds > 0.0;
  if (news->curve.curve) {
    let_go(std::move(curves.older.curve));
    curves.take(std::move(news->curve), !frame.ready || !blends);
    frame.ready = true;
    dirty = true;
  }
  if (news->reflections.specular) {
    let_go(std::move(reflections.older.specular));
    const bool first = !reflections.newer.specular;
    reflections.take(std::move(news->reflections), first || !blends);
    dirty = true;
  }
}

void SkyLight::State::let_go(std::shared_ptr<const void> old) {
  const auto slot = std::find(garbage.begin(), garbage.end(), nullptr);
  if (slot != garbage.end()) *slot = std::move(old);
}

/// Returns whether anything moved.
bool SkyLight::State::advance(double seconds) {
  const double step = options.blend_seconds > 0.0 ? seconds / options.blend_seconds : 1.0;
  bool moved = false;
  const auto go_on = [&](auto& blend) {
    if (!blend.under_way()) return;
    blend.part = std::min(1.0, blend.part + step);
    moved = true;
  };
  go_on(curves);
  go_on(reflections);
  return moved;
}

Sun SkyLight::State::sun_of(const glm::dvec3& irradiance, double radius_degrees) const {
  Sun light;
  light.direction = sun;
  light.irradiance = irradiance;
  light.angular_radius_degrees = radius_degrees;
  light.solid_angle = 4.0 * std::numbers::pi * half_angle_square(radius_degrees);
  if (light.solid_angle > sky::kPoint) light.radiance = irradiance / light.solid_angle;
  return light;
}

void SkyLight::State::compute_light() {
  ++counters.lights;
  const std::span<glm::dvec3> light = frame.radiance.coefficients();
  curves.newer.curve->at(sun, light);
  glm::dvec3 irradiance = curves.newer.curve->sun_irradiance(sun);
  double radius = curves.newer.sun_radius_degrees;
  if (curves.under_way()) {
    const double part = curves.part;
    curves.older.curve->at(sun, older_light);
    for (std::size_t k = 0; k < light.size(); ++k) light[k] = (1.0 - part) * older_light[k] + part * light[k];
    irradiance = (1.0 - part) * curves.older.curve->sun_irradiance(sun) + part * irradiance;
    radius = (1.0 - part) * curves.older.sun_radius_degrees + part * radius;
  }
  if (intensity != 1.0) {
    for (glm::dvec3& coefficient : light) coefficient *= intensity;
    irradiance *= intensity;
  }
  frame.sun = sun_of(irradiance, radius);
}

void SkyLight::State::place_reflections() {
  using worker::BakedReflections;
  const auto place = [&](const BakedReflections& from, double weight) {
    return SkyReflections{from.specular, rotate(from.sun, sun), from.specular ? weight * intensity : 0.0};
  };
  frame.reflections[0] = place(reflections.newer, reflections.part);
  frame.reflections[1] =
      place(reflections.under_way() ? reflections.older : BakedReflections{}, 1.0 - reflections.part);
}

const SkyLightFrame& SkyLight::update(double seconds) {
  const platform::FloatingPointScope floating_point;
  platform::require_between("dynamic sky: seconds of a frame", seconds, 0.0, std::numeric_limits<double>::infinity());
  State& state = *state_;
  ++state.counters.frames;
  state.take_news();
  const bool moved = state.advance(seconds);
  if (state.curves.under_way() || state.reflections.under_way()) state.frame.settled = false;
  if (state.frame.ready && (state.dirty || moved)) {
    state.compute_light();
    state.place_reflections();
    state.dirty = false;
  }
  return state.frame;
}

const SkyLightFrame& SkyLight::light() const noexcept { return state_->frame; }

SkyLightCounters SkyLight::counters() const {
  SkyLightCounters counters = state_->counters;
  const worker::SkyBakeCounts baked = state_->baker->counts();
  counters.posts = baked.posts;
  counters.tables_baked = baked.tables;
  counters.curves_baked = baked.curves;
  counters.speculars_baked = baked.speculars;
  counters.cancelled = baked.cancelled;
  counters.failures = baked.failures;
  return counters;
}

std::exception_ptr SkyLight::error() const { return state_->baker->error(); }

}  // namespace welkin
