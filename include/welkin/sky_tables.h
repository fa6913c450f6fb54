// Precomputed scattering: everything a planet's sky can look like, in tables (Bruneton and Neyret 2008; Bruneton 2017).
//
//   auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth()));
//   welkin::SkyView view(tables, 0.0);
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "welkin/atmosphere.h"
#include "welkin/control.h"
#include "welkin/export.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

enum class ScatteringLayout {
  /// Height x cosine of view's zenith x cosine of sun's zenith x cosine of the azimuth between view and sun (Bruneton,
  /// who has the cosine between view and sun for the last).
  full,
  /// Without the last: what varies with it is but the phase functions (32 x 64 x 32 in the article). RGBA: Rayleigh and
  /// all higher orders in rgb, the first channel of single Mie scattering in a; its other channels are extrapolated.
  compact,
};

/// Sizes of the tables, and how far the scattering is followed.
struct SkyTableOptions {
  ScatteringLayout layout = ScatteringLayout::full;  ///< four-dimensional, or compact
  int heights = 32;                                  ///< of the scattering table, 2 to 128
  int view_zeniths = 64;                             ///< even, 4 to 1024: half of them for rays that meet the ground
  int sun_zeniths = 64;                              ///< 4 to 256
  int sun_angles = 8;                                ///< cosines of azimuths between view and sun, full only: 2 to 128
  int transmittance_heights = 64;                    ///< 2 to 1024
  int transmittance_zeniths = 256;                   ///< 2 to 2048
  int irradiance_heights = 16;                       ///< 2 to 1024
  int irradiance_sun_zeniths = 64;                   ///< 2 to 1024

  /// Elevation of the lowest sun that tables hold, degrees; below it the sky is that of the last one, faded to nothing.
  /// -90 to 0.
  double lowest_sun_degrees = -30.0;

  int orders = 4;  ///< of scattering, ground reflections included: 1 (single) to 64

  /// Stops before `orders` when an order added less than this share of all light before it (mean radiance, over all
  /// heights and suns). 0: never. Folded spectra stop three wavelengths at a time: `orders` is then the most of them.
  double until_change = 0.0;

  SkyColour colour = SkyColour::spectral;                      ///< wavelengths, or three primaries
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U;  ///< tables that need more are refused

  friend bool operator==(const SkyTableOptions&, const SkyTableOptions&) = default;
};

/// The tables. Channels are three wavelengths' or linear sRGB's (`options.colour`).
struct SkyTables {
  Atmosphere atmosphere;    ///< what they were computed from
  SkyTableOptions options;  ///< those that they were made with

  /// Transmittance to the top (not past the ground): [transmittance_heights][transmittance_zeniths][3]. Of spectra that
  /// are folded: sRGB light of a white sun (the sun's own spectrum folded) through it, relative to that above the air.
  std::vector<float> transmittance;

  /// [heights][view_zeniths][sun_angles][sun_zeniths][4], as a texture of sun_angles * sun_zeniths x view_zeniths x
  /// heights RGBA: Rayleigh scattering without its phase function and higher orders divided by it, times solar
  /// irradiance; in a single Mie scattering's first channel, likewise without phase function.
  std::vector<float> scattering;

  /// Full layout: single Mie scattering's channels (and 0), same shape. Compact, or no aerosol that scatters: empty.
  std::vector<float> single_mie;

  /// Irradiance of the sky, without direct sun, on horizontal ground facing up: [irradiance_heights]
  /// [irradiance_sun_zeniths][3].
  std::vector<float> irradiance;

  int orders = 0;                  ///< that were computed
  double last_change = 0.0;        ///< share that the last of them added
  std::vector<PassRecord> passes;  ///< wall time of each step

  /// Memory of all tables.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
};

/// Memory that `precompute_sky` needs at most, results included; some 1 MB of it for each thread of the caller's arena.
/// Throws `Error` (invalid_argument), also for radiances of other than three wavelengths.
[[nodiscard]] std::uint64_t sky_table_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options);

/// Precomputes: about two seconds of processor time for the defaults, a third of it for one order; three wavelengths
/// each. Small tables are computed from fewer nodes.
///
/// Single scattering at texels: root mean square error 1e-5 of the mean by day, 1e-4 by night (Earth, Mars). Higher
/// orders are not integrated over directions for each direction, as Bruneton does it: radiance about a point is
/// projected to spherical harmonics (up to 20 bands) about the vertical, where phase functions are products; the second
/// order agrees with direct integration to 0.5 %. For |g| above 0.79 their aureoles lose detail finer than 9 degrees,
/// no energy.
///
/// The same bits on any number of threads and instruction set. Nothing in them is negative or not finite.
/// Throws `Error`: invalid_argument, limit_exceeded, cancelled.
[[nodiscard]] SkyTables precompute_sky(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                       const Control& control = {});

}  // namespace welkin
