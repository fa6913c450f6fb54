#include "sky/table_sizes.h"

#include <algorithm>
#include <string>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/text.h"
#include "sky/ray_nodes.h"
#include "sky/scattering_solver.h"
#include "sky/sunlight.h"
#include "welkin/core.h"

namespace welkin::sky {
namespace {

void require(const std::string& name, double value, double low, double high) {
  platform::require_between("sky table option " + name, value, low, high);
}

std::uint64_t product(std::initializer_list<int> sizes) {
  std::uint64_t result = 1;
  for (const int size : sizes) result *= static_cast<std::uint64_t>(size);  // each below 2^11: cannot overflow
  return result;
}

/// How many scale heights of the air the lowest interval between a source's heights holds at most. An even source over
/// many of them passes light on from order to order without loss; fewer leave too few nodes above.
constexpr double kMaxScaleHeights = 4.0;

// With fewer nodes those that crowd at the horizon or about sunset are missing elsewhere.
constexpr int kMinViews = 48;
constexpr int kMinSuns = 48;
constexpr int kMinAzimuths = 8;

constexpr int kCompactHeights = 28;  ///< of 16 errors by day are three times as large

}  // namespace

void check_options(const SkyTableOptions& options) {
  if (options.layout != ScatteringLayout::full && options.layout != ScatteringLayout::compact) {
    throw Error(ErrorCode::invalid_argument, "the sky table option layout has no known value; pass full or compact");
  }
  if (options.colour != SkyColour::spectral && options.colour != SkyColour::linear_srgb) {
    throw Error(ErrorCode::invalid_argument,
                "the sky table option colour has no known value; pass spectral or linear_srgb");
  }
  require("heights", options.heights, 2, 128);
  require("view_zeniths", options.view_zeniths, 4, 1024);
  if (options.view_zeniths % 2 != 0) {
    throw Error(ErrorCode::invalid_argument, "sky table option view_zeniths is " +
                                                 std::to_string(options.view_zeniths) +
                                                 "; it must be even: half of them are for rays that meet the ground");
  }
  require("sun_zeniths", options.sun_zeniths, 4, 256);
  require("sun_angles", options.sun_angles, 2, 128);
  require("transmittance_heights", options.transmittance_heights, 2, 1024);
  require("transmittance_zeniths", options.transmittance_zeniths, 2, 2048);
  require("irradiance_heights", options.irradiance_heights, 2, 1024);
  require("irradiance_sun_zeniths", options.irradiance_sun_zeniths, 2, 1024);
  require("minimum_sun_elevation_degrees", options.minimum_sun_elevation_degrees, -90.0, 0.0);
  require("orders", options.orders, 1, 64);
  require("convergence_threshold", options.convergence_threshold, 0.0, 1e300);
}

int angles_of(const SkyTableOptions& options) noexcept {
  return options.layout == ScatteringLayout::full ? options.sun_angles : 1;
}

TableNodes table_nodes(const SkyTableOptions& options) noexcept {
  if (options.layout != ScatteringLayout::full) return {};
  return {.many_views = options.view_zeniths >= kMinViews,
          .many_suns = options.sun_zeniths >= kMinSuns,
          .many_azimuths = options.sun_zeniths >= kMinSuns && options.sun_angles >= kMinAzimuths};
}

TableMapping mapping_of(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept {
  TableNodes nodes = table_nodes(options);
  // A narrow lobe's sources are so sharp in angles that other suns' nodes make them no better, and some worse.
  nodes.high_suns = nodes.many_suns && narrow_lobe(atmosphere, options.orders) == NarrowLobe::none;
  return {atmosphere.bottom_radius_m, atmosphere.top_radius_m,
          math::sine_cosine_of_turns(options.minimum_sun_elevation_degrees / 360.0).sine,
          atmosphere.sun_angular_radius_degrees, nodes};
}

std::uint64_t scattering_texels(const SkyTableOptions& options) noexcept {
  return product({options.heights, options.view_zeniths, angles_of(options), options.sun_zeniths});
}

std::uint64_t transmittance_floats(const SkyTableOptions& options) noexcept {
  return product({options.transmittance_heights, options.transmittance_zeniths, 3});
}

std::uint64_t irradiance_floats(const SkyTableOptions& options) noexcept {
  return product({options.irradiance_heights, options.irradiance_sun_zeniths, 3});
}

namespace {

/// Without the air's bend.
SourceShape source_shape(const SkyTableOptions& options, NarrowLobe lobe) noexcept {
  const int suns = (std::clamp(options.sun_zeniths, 16, 48) + 15) / 16 * 16;
  const bool small = options.heights < 12 || options.view_zeniths < 16;
  // With a lobe that is narrow forward, light of a low sun changes fast with the height, and about the horizontal: 16
  // heights leave low places near the sun 2 % too dark, zenith angles 6 degrees apart those near the horizon 3 %.
  const bool narrow = lobe != NarrowLobe::none;
  const bool fine = lobe == NarrowLobe::forward && !small;
  // Compact tables, which have no azimuth, are wrong by more than what fewer nodes lose.
  if (options.layout == ScatteringLayout::compact && !narrow) {
    return {.heights = std::clamp(options.heights, 4, kCompactHeights),
            .zeniths = 17,
            .angles = 13,
            .suns = std::min(suns, 32),
            .azimuths = 10};
  }
  return {.heights = fine ? 32 : std::clamp(options.heights, 4, 32),
          .zeniths = small ? 17 : (fine ? 65 : 33),
          .angles = small ? 13 : 25,
          .suns = suns,
          // On n midpoints of half a circle cos(m phi) is -cos((2 n - m) phi): 32 distinguish all of 28 bands. With 16,
          // of 20 bands those of m > 16 count as 32 - m, whose moments for g below 0.76 are under 0.013.
          .azimuths = narrow ? 32 : 16,  // 16 mistake high bands of a narrow lobe for lower ones
          .narrow = narrow};
}

}  // namespace

SourceShape source_shape(const SkyTableOptions& options, const AirModel& air, const TableMapping& mapping) {
  SourceShape shape = source_shape(options, narrow_lobe(air.atmosphere(), options.orders));
  // b x / (1 + b - x) = y: the node at x lies at y. As y nears x, b grows beyond all bounds, and nothing is bent.
  const double x = 1.0 / (shape.heights - 1);
  const double y = mapping.height_coordinate(kMaxScaleHeights * air.scale_height());
  // x = (1 + b) y / (y + b) gives b = y (1 - x) / (x - y).
  if (y < x) shape.height_bend = y * (1.0 - x) / (x - y);
  return shape;
}

SunPaths::Size sun_path_size(const SkyTableOptions& options, const AirModel& air,
                             const TableMapping& mapping) noexcept {
  SunPaths::Size size;
  if (options.layout == ScatteringLayout::compact) size = {.heights = 64, .zeniths = 128};
  if (options.heights < 12 || options.view_zeniths < 16) size = {.heights = 32, .zeniths = 64};
  return mapping.altitude(1.0 / (size.heights - 1)) < air.scale_height() ? size : SunPaths::Size{};
}

std::uint64_t single_mie_floats(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept {
  return options.layout == ScatteringLayout::full && scatters(atmosphere.aerosol) ? 4 * scattering_texels(options) : 0;
}

std::uint64_t result_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept {
  return sizeof(float) * (4 * scattering_texels(options) + single_mie_floats(atmosphere, options) +
                          transmittance_floats(options) + irradiance_floats(options));
}

// Results; colours of spectra summed in double; paths of sunlight and their transmittances; the solver; scratch of each
// worker that there can be.
std::uint64_t sky_table_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options) {
  check(atmosphere);
  check_options(options);
  if (options.colour == SkyColour::spectral && atmosphere.wavelengths_nm.size() != 3) {
    throw Error(ErrorCode::invalid_argument,
                "the atmosphere has " + std::to_string(atmosphere.wavelengths_nm.size()) +
                    " wavelengths; spectral tables hold three: use colour = linear_srgb, or three wavelengths");
  }
  const bool with_aerosol = scatters(atmosphere.aerosol);
  const std::uint64_t sun_nodes = std::uint64_t{128} * 256;
  const std::uint64_t kept_rays = sun_nodes + transmittance_floats(options) / 3;  // and their lengths
  const std::uint64_t sunlight = kept_rays * (sizeof(PerConstituent) + sizeof(Ray)) + sun_nodes * 4 * sizeof(float);
  const std::uint64_t ray_suns =
      static_cast<std::uint64_t>(angles_of(options)) * static_cast<std::uint64_t>(options.sun_zeniths) + 1024;
  const std::uint64_t worker = kMaxRayNodes * sizeof(RayNode) + 64 * ray_suns + (std::uint64_t{1} << 20U);
  const std::uint64_t workers = jobs::worker_count(jobs::Placement::arena);
  return result_bytes(atmosphere, options) + sunlight + 16 * irradiance_floats(options) +
         SourceSolver::bytes(source_shape(options, narrow_lobe(atmosphere, options.orders)), with_aerosol) +
         workers * worker;
}

}  // namespace welkin::sky

namespace welkin {

std::uint64_t SkyTables::bytes() const noexcept {
  return 4 * (transmittance.size() + scattering.size() + single_mie.size() + irradiance.size());
}

}  // namespace welkin
