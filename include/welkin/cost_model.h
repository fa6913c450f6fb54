// What each kind of work costs on a machine: nanoseconds of one thread a unit.
//
//   welkin::CostModel costs;   // the stored numbers; or what `welkin report --calibrate` has measured here
//   welkin::Plan plan = welkin::plan(panorama, needs, {}, costs);
#pragma once

#include <span>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// The stored numbers are estimates from benchmarks of single passes: their ratios hold roughly, their sum is another
/// on every machine, which is what `welkin report --calibrate` is for. They predict, they never decide a result's bits.
struct CostModel {
  // Of a source's pixels.
  double clean_texel = 0.45;            ///< looked through, or copied as RGB floats
  double project_texel = 0.45;          ///< read for harmonics,
  double project_sum = 0.045;           ///< and each of its n (n + 1) / 2 sums for n bands
  double resample_texel = 16.0;         ///< a texel of a cubemap by area,
  double resample_source = 3.2;         ///< and a texel of the source that goes into it
  double resample_cube_texel = 540.0;   ///< the same where the source is a cubemap, too, of another size:
  double resample_cube_source = 800.0;  ///< faces do not line up with rows, and outlines are cut
  double mip_texel = 3.0;               ///< a texel of level 0, for all levels below it
  double copy_texel = 1.1;              ///< a texel of a result that is copied
  double read_texel = 20.0;             ///< of a file, compressed: OpenEXR, .hdr, PNG, .env
  double read_plain_texel = 3.0;        ///< of a file, as it is: PFM, KTX2, DDS

  // Of the prefilter.
  double ring_texel = 95.0;            ///< a texel of the lat-long that a cubemap goes through
  double bright_texel = 0.7;           ///< a texel that is looked at for its own brightness
  double fourier_texel = 4.0;          ///< a texel of a ring, transformed either way
  double legendre_term = 0.5;          ///< a ring's share of one degree and order, either way, three channels
  double face_texel = 16.0;            ///< a texel of a mip, looked up in rings
  double tap = 35.0;                   ///< a tap of a texel of the sampled method
  double reference_pair = 5.0;         ///< a texel of the source for a texel of the reference method,
  double reference_direction = 6.5e6;  ///< and once for each of these: source texels near its peak are divided

  // Of diffuse light and the table.
  double irradiance_term = 0.9;         ///< a coefficient of a texel of the irradiance cubemap
  double irradiance_pair = 8.5;         ///< a texel of the source for a texel of direct convolution,
  double irradiance_direction = 2.4e5;  ///< and once for each of these: source texels near its horizon are divided
  double brdf_texel = 500.0;            ///< of the table, without sheen
  double sheen_texel = 1200.0;          ///< and with

  // Of a sky, for three wavelengths.
  double transmittance_texel = 4200.0;  ///< of the transmittance table
  double sun_path_node = 5000.0;        ///< of the lengths to the sun that all wavelengths share
  double first_order_node = 9000.0;     ///< of the radiance of the first order, by height, direction and sun
  double order_node = 5600.0;           ///< of each order above
  double scattered_once = 950.0;        ///< a texel of the scattering table: light from the sun itself,
  double scattered_often = 450.0;       ///< and all other light
  double slice_texel = 75.0;            ///< a texel of a scattering table that a view's slice is made from
  double sky_direction = 60.0;          ///< a direction looked up
  double projected_direction = 17.5;    ///< a direction of a curve's node

  friend bool operator==(const CostModel&, const CostModel&) = default;
};

/// One of its numbers.
struct CostUnit {
  const char* name;          ///< the member's
  double CostModel::*value;  ///< the member that holds it
};

/// All of them, in order: for files and tables.
[[nodiscard]] std::span<const CostUnit> cost_units() noexcept;

}  // namespace welkin
