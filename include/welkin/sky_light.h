// The dynamic sky of an engine's loop: set the sun, get the light, every frame.
//
//   welkin::Worker worker;
//   welkin::SkyLight sky(worker, welkin::earth());
//   ...                                            // each frame
//   sky.set_sun(elevation_degrees, azimuth_degrees);
//   const welkin::SkyLightFrame& light = sky.update(seconds_since_last_frame);
//   if (light.ready) shade_with(light.radiance, light.sun, light.reflections);
//
// Cost of a change (docs/guides/moving_sky.md):
//
//   sun's azimuth        none: coefficients and reflections are rotated
//   intensity            none: a factor
//   sun's elevation      coefficients at once; new reflections after each `specular_threshold_degrees`, on the worker
//   altitude             a new curve (milliseconds) and new reflections, on the worker
//   atmosphere           new tables (seconds), curve and reflections, on the worker; other jobs run in between
//   below a threshold    none
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <memory>

#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/worker.h"

namespace WELKIN_EXPORT welkin {

/// Options of a dynamic sky.
struct SkyLightOptions {
  SkyTableOptions tables{};  ///< sizes of the tables and orders of scattering
  SkyCurveOptions curve{};   ///< includes the number of bands
  double altitude_m = 0.0;   ///< altitude of the observer above the ground

  /// Specular chain of the sky; `size` 0 for none.
  PrefilterOptions specular{.size = 32};

  /// Smaller movements of the sun are ignored: 0 to 10 degrees.
  double sun_threshold_degrees = 0.01;
  /// Change of the sun's elevation after which reflections are recomputed: 0 to 90.
  double specular_threshold_degrees = 0.5;

  /// Smaller changes of altitude are ignored: 0 to 1e6 m.
  double altitude_threshold_m = 1.0;

  /// Time to blend from an old curve or old reflections to new ones, in the caller's seconds: 0 (at once) to 3600.
  double blend_seconds = 0.5;

  TaskPriority priority = TaskPriority::normal;  ///< priority of posted jobs
};

/// A prefiltered sky, with its weight and rotation for this frame.
struct SkyReflections {
  std::shared_ptr<const PrefilteredSpecular> specular;  ///< for intensity 1; null if there is none yet
  /// Rotation about the vertical from the sun's position when it was computed to the current one: light from direction
  /// d comes from rotation * d. A shader that reflects along R looks up
  /// `textureLod(specular, transpose(mat3(rotation)) * R, mip)`.
  dmat3 rotation{1.0};
  double weight = 0.0;  ///< factor of its light
};

/// The light of a frame.
struct SkyLightFrame {
  bool ready = false;    ///< false until the first curve is available: all light is black
  bool settled = false;  ///< nothing is being computed or blended: the light is that of direct calls

  SphericalHarmonics radiance;  ///< radiance of sky and ground without the sun's disc, including intensity
  Sun sun;                      ///< the sun as a directional light, including intensity

  /// Newer and older reflections. Once there are any, the weights add up to the intensity.
  std::array<SkyReflections, 2> reflections;
};

/// Counts of work since the object was created.
struct SkyLightCounters {
  std::uint64_t frames = 0;               ///< calls of `update`
  std::uint64_t lights = 0;               ///< calls of `update` that recomputed coefficients
  std::uint64_t moves_ignored = 0;        ///< moves of sun or altitude below their thresholds
  std::uint64_t rotations = 0;            ///< changes of azimuth only
  std::uint64_t elevations = 0;           ///< changes of elevation
  std::uint64_t intensities = 0;          ///< changes of intensity
  std::uint64_t reflections_skipped = 0;  ///< changes of elevation that needed no new reflections
  std::uint64_t posts = 0;                ///< requests posted to the worker
  std::uint64_t tables_baked = 0;         ///< scattering tables computed
  std::uint64_t curves_baked = 0;         ///< curves computed
  std::uint64_t speculars_baked = 0;      ///< specular chains computed
  std::uint64_t cancelled = 0;            ///< bakes cancelled because of a newer atmosphere, or at the end
  std::uint64_t failures = 0;             ///< bakes that failed
};

/// The dynamic sky of an engine's loop. For one thread at a time. The worker must outlive it.
///
/// At most one request is in flight. Changes made meanwhile are coalesced: when it completes, only the latest one is
/// applied. A new atmosphere cancels tables for an old one once; tables, a curve and reflections must then be completed
/// before it cancels again. A sun that always moves therefore gets new reflections, and an atmosphere that changes
/// every frame is shown as it was when the latest tables were started.
///
/// While tables are computed, each worker thread involved runs one waiting job after each piece of a few milliseconds,
/// so that jobs posted later do not wait for the tables. (With an `Executor`, only the threads that run jobs do.)
///
/// If the worker refuses or drops a request, because it is full or was terminated, `error()` reports it, the light
/// stays unchanged, and the next call of any `set_` function tries again.
class SkyLight {
 public:
  /// Posts the request for the first tables, with the sun at the zenith. Throws `Error` (invalid_argument) for an
  /// atmosphere or options that cannot be computed, and whatever `Worker::post` throws.
  SkyLight(Worker& worker, const Atmosphere& atmosphere, const SkyLightOptions& options = {});
  /// Starts with existing tables, whose own options apply. Throws the same errors as the constructor above.
  SkyLight(Worker& worker, std::shared_ptr<const SkyTables> tables, const SkyLightOptions& options = {});
  /// Cancels work in flight, without waiting.
  ~SkyLight();
  SkyLight(const SkyLight&) = delete;
  SkyLight& operator=(const SkyLight&) = delete;

  // The setters compare and return. They post a request (which allocates) only if something must be computed and
  // nothing is in flight. All throw `Error` (invalid_argument).

  /// Sets the sun's elevation and azimuth in degrees; azimuth from +z towards +x.
  void set_sun(double elevation_degrees, double azimuth_degrees);
  /// Sets the direction towards the sun.
  void set_sun(const dvec3& direction);
  /// Sets the factor of all light, 0 to 1e12.
  void set_intensity(double intensity);
  /// Sets the observer's altitude above the ground in metres. Curve and reflections are recomputed.
  void set_altitude(double altitude_m);
  /// Sets the atmosphere. Tables are recomputed unless it differs in its name only. (For brighter sunlight,
  /// `set_intensity` suffices.)
  void set_atmosphere(const Atmosphere& atmosphere);

  /// Collects finished results, advances blending, and returns the light. Never waits and never allocates; the setters
  /// do when they post. Throws `Error` (invalid_argument) for a negative time or NaN.
  const SkyLightFrame& update(double seconds);
  /// Returns the light of the last `update`.
  [[nodiscard]] const SkyLightFrame& light() const noexcept;

  /// Returns counts of work.
  [[nodiscard]] SkyLightCounters counters() const;
  /// Returns the exception of the last bake that failed, or null if none has failed since the last change that needed
  /// one. The previous results stay in use.
  [[nodiscard]] std::exception_ptr error() const;

 private:
  struct WELKIN_HIDDEN State;
  std::unique_ptr<State> state_;
};

}  // namespace welkin
