// The dynamic sky of an engine's loop: set the sun, get the light, every frame.
//
//   welkin::Worker worker;
//   welkin::SkyLight sky(worker, welkin::earth());
//   ...                                            // each frame
//   sky.set_sun(elevation_degrees, azimuth_degrees);
//   const welkin::SkyLightFrame& light = sky.update(seconds_since_last_frame);
//   if (light.ready) shade_with(light.radiance, light.sun, light.reflections);
//
// What a change costs: docs/guides/moving_sky.md.
//
//   sun's azimuth        the curve's coefficients are turned, reflections get another turn: no work
//   intensity            a factor
//   sun's elevation      the curve, at once; reflections anew, later, once it moved by `specular_threshold_degrees`
//   altitude             a new curve (milliseconds) and new reflections, later
//   atmosphere           new tables (seconds), curve and reflections, later; other jobs run in between
//   below the threshold  nothing
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

/// What a dynamic sky computes.
struct SkyLightOptions {
  SkyTableOptions tables{};  ///< sizes and orders of its tables
  SkyCurveOptions curve{};   ///< with the number of bands
  double altitude_m = 0.0;   ///< the observer's, above the ground

  /// Of the sky's reflections; `size` 0: none.
  PrefilterOptions specular{.size = 32};

  /// The sun stays where it is until it is to move by at least this angle: 0 to 10.
  double sun_threshold_degrees = 0.01;
  /// Reflections are made anew when the sun's elevation is this far from that of the last ones: 0 to 90.
  double specular_threshold_degrees = 0.5;

  /// The altitude stays where it is until it is to change by at least this: 0 to 1e6 m.
  double altitude_threshold_m = 1.0;

  /// How long it takes from an old curve or old reflections to new ones, in the caller's seconds: 0 (at once) to 3600.
  double blend_seconds = 0.5;

  TaskPriority priority = TaskPriority::normal;  ///< of what is posted
};

/// A prefiltered sky, and how it is to be used now.
struct SkyReflections {
  std::shared_ptr<const PrefilteredSpecular> specular;  ///< of intensity 1; null: none yet
  /// From where the sun was when it was made to where it is now, about the vertical: what came from direction d comes
  /// from turn * d. A shader that reflects along R looks up
  /// `textureLod(specular, transpose(mat3(turn)) * R, mip)`.
  dmat3 turn{1.0};
  double weight = 0.0;  ///< of its light
};

/// The light of a frame.
struct SkyLightFrame {
  bool ready = false;    ///< false until the first curve has come: all is black
  bool settled = false;  ///< nothing is being made or blended: the light is exactly what the direct calls give

  SphericalHarmonics radiance;  ///< sky and ground, intensity included, without the sun's disc
  Sun sun;                      ///< as a directional light, intensity included

  /// Newer and older; both weights add up to 1 once there are any, times the intensity.
  std::array<SkyReflections, 2> reflections;
};

/// What was done and what was not, since the object was made.
struct SkyLightCounters {
  std::uint64_t frames = 0;           ///< calls of `update`
  std::uint64_t lights = 0;           ///< of them those that computed coefficients: others had nothing to do
  std::uint64_t moves_ignored = 0;    ///< of sun or altitude, below their thresholds
  std::uint64_t turns = 0;            ///< moves of the azimuth alone
  std::uint64_t elevations = 0;       ///< moves of the elevation
  std::uint64_t intensities = 0;      ///< changes of the intensity
  std::uint64_t specular_spared = 0;  ///< moves of the elevation that asked for no reflections
  std::uint64_t posts = 0;            ///< requests given to the worker
  std::uint64_t tables_baked = 0;     ///< tables, curves and reflections that were made
  std::uint64_t curves_baked = 0;     ///< curves that were made
  std::uint64_t speculars_baked = 0;  ///< chains of reflections that were made
  std::uint64_t given_up = 0;         ///< bakes that were stopped as a newer atmosphere, or the end, overtook them
  std::uint64_t failures = 0;         ///< bakes that ended with an error
};

/// One at a time in the worker's hands: a change that comes while something is made is looked at when that is done, the
/// last one only. A new atmosphere stops tables that are made for an old one, but not again before tables have been
/// finished and curve and reflections made from them. So a sun that never rests still gets new reflections, an
/// atmosphere that changes every frame is seen as it was when the last tables were begun, and a storm of moves costs no
/// more than one.
///
/// While tables are made, each thread of the worker that makes them runs one waiting job after each piece, which takes
/// milliseconds: an environment that is posted later does not wait for the tables. (In a lent executor only the threads
/// that run jobs do so.)
///
/// If the worker lets go of a request (it is full, or was terminated), `error()` says so, the light stays what it was,
/// and the next call of any `set_` asks again.
///
/// For one thread at a time. The worker must outlive it.
class SkyLight {
 public:
  /// Asks for the first tables; the sun stands in the zenith. Throws `Error` (invalid_argument) for an atmosphere or
  /// options that cannot be computed, and what `Worker::post` throws.
  SkyLight(Worker& worker, const Atmosphere& atmosphere, const SkyLightOptions& options = {});
  /// The same with tables that are there, whose options count.
  SkyLight(Worker& worker, std::shared_ptr<const SkyTables> tables, const SkyLightOptions& options = {});
  /// Stops what is being made; does not wait.
  ~SkyLight();
  SkyLight(const SkyLight&) = delete;
  SkyLight& operator=(const SkyLight&) = delete;

  // These look and compare; they post a request (which allocates) only if there is something to make and nothing is
  // being made. All throw `Error` (invalid_argument).

  /// Degrees; azimuth from +z towards +x.
  void set_sun(double elevation_degrees, double azimuth_degrees);
  /// Sets the direction towards the sun.
  void set_sun(const dvec3& direction);
  /// A factor of all light, 0 to 1e12.
  void set_intensity(double intensity);
  /// Moves the observer; above the ground, in metres. Curve and reflections are made anew.
  void set_altitude(double altitude_m);
  /// New tables unless it is the same but for its name. (Brighter sunlight alone is better said by `set_intensity`.)
  void set_atmosphere(const Atmosphere& atmosphere);

  /// Takes what has come, goes on with what is being blended, and gives the light. Never waits, never allocates.
  /// Throws `Error` (invalid_argument) for a negative time or one that is no number.
  const SkyLightFrame& update(double seconds);
  /// As of the last `update`.
  [[nodiscard]] const SkyLightFrame& light() const noexcept;

  /// How much work was done so far.
  [[nodiscard]] SkyLightCounters counters() const;
  /// What the last bake that failed threw, null if none did since the last change that asked for one. What was there
  /// before stays in use.
  [[nodiscard]] std::exception_ptr error() const;

 private:
  struct WELKIN_HIDDEN State;
  std::unique_ptr<State> state_;
};

}  // namespace welkin
