// Skies: atmospheres, tables and views.
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "welkin/bake.h"
#include "welkin/requests.h"
#include "welkin/sky.h"
#include "welkin/welkin.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

namespace welkin::c_interface {
namespace {

constexpr int kMaxLayers = 8;
constexpr int kMaxAbsorbers = 4;
constexpr int kMaxWavelengths = 96;

/// Returns one value per wavelength; none if the pointer is null.
std::vector<double> by_wavelength(const double* values, std::size_t wavelengths) {
  return values == nullptr ? std::vector<double>{} : std::vector<double>(values, values + wavelengths);
}

Constituent constituent_of(const welkin_constituent* constituent, const char* name, std::size_t wavelengths) {
  constexpr std::ptrdiff_t kLayerValues = 5;
  const auto given = read_struct(constituent, name);
  image::require_range("layer_count", given.layer_count, 0, kMaxLayers);
  if (given.layer_count > 0) require(given.layers, "layers");
  Constituent matter;
  for (std::int32_t i = 0; i < given.layer_count; ++i) {
    const double* const layer = given.layers + kLayerValues * i;
    matter.density.push_back({layer[0], layer[1], layer[2], layer[3], layer[4]});
  }
  matter.scattering_per_m = by_wavelength(given.scattering_per_m, wavelengths);
  matter.absorption_per_m = by_wavelength(given.absorption_per_m, wavelengths);
  return matter;
}

/// Returns the planet at the caller's wavelengths, if there are any.
Atmosphere planet_of(const welkin_atmosphere& given) {
  require_enumerator("planet", given.planet, WELKIN_PLANET_EARTH_POLLUTED);
  image::require_range("wavelength_count", given.wavelength_count, 0, kMaxWavelengths);
  std::vector<double> wavelengths = Atmosphere{}.wavelengths_nm;
  if (given.wavelength_count > 0) {
    require(given.wavelengths_nm, "wavelengths_nm");
    wavelengths.assign(given.wavelengths_nm, given.wavelengths_nm + given.wavelength_count);
  }
  Atmosphere air;
  switch (given.planet) {
    case WELKIN_PLANET_EARTH: return earth(wavelengths);
    case WELKIN_PLANET_EARTH_HAZY: return earth(wavelengths, AerosolKind::hazy);
    case WELKIN_PLANET_EARTH_DUSTY: return earth(wavelengths, AerosolKind::dusty);
    case WELKIN_PLANET_EARTH_POLLUTED: return earth(wavelengths, AerosolKind::polluted);
    case WELKIN_PLANET_EARTH_HILLAIRE: air = earth_hillaire(); break;
    case WELKIN_PLANET_MARS: air = mars(); break;
    case WELKIN_PLANET_EARTH_BRUNETON: air = earth_bruneton(); break;
    default: break;
  }
  if (given.wavelength_count > 0) air.wavelengths_nm = std::move(wavelengths);
  return air;
}

void read_aerosol(const welkin_atmosphere& given, Atmosphere& air) {
  const std::size_t wavelengths = air.wavelengths_nm.size();
  if (given.aerosol != nullptr && given.aerosol_optics != nullptr)
    refuse("aerosol and aerosol_optics are both given; pass either");
  if (given.aerosol != nullptr) air.aerosol = constituent_of(given.aerosol, "aerosol", wavelengths);
  if (const double* const optics = given.aerosol_optics; optics != nullptr) {
    air = with_aerosol(air, {.optical_depth = optics[0],
                             .angstrom_exponent = optics[1],
                             .single_scattering_albedo = optics[2],
                             .asymmetry = optics[3]});
  }
  require_enumerator("aerosol_phase", given.aerosol_phase, WELKIN_PHASE_HENYEY_GREENSTEIN);
  if (given.aerosol_phase != WELKIN_PHASE_DEFAULT) {
    const bool henyey_greenstein = given.aerosol_phase == WELKIN_PHASE_HENYEY_GREENSTEIN;
    air.aerosol_phase = henyey_greenstein ? AerosolPhase::henyey_greenstein : AerosolPhase::cornette_shanks;
  }
  if (given.aerosol_asymmetry != 0.0) {
    air.aerosol_asymmetry = given.aerosol_asymmetry;
    air.aerosol_asymmetries.clear();
  }
  if (given.aerosol_asymmetries != nullptr)
    air.aerosol_asymmetries = by_wavelength(given.aerosol_asymmetries, wavelengths);
}

}  // namespace

Atmosphere atmosphere_of(const welkin_atmosphere* atmosphere) {
  const auto given = read_struct(atmosphere, "atmosphere");
  Atmosphere air = planet_of(given);
  const std::size_t wavelengths = air.wavelengths_nm.size();
  if (given.rayleigh != nullptr) air.rayleigh = constituent_of(given.rayleigh, "rayleigh", wavelengths);
  read_aerosol(given, air);
  image::require_range("absorber_count", given.absorber_count, -1, kMaxAbsorbers);
  if (given.absorber_count != 0) air.absorbers.clear();
  for (std::int32_t i = 0; i < given.absorber_count; ++i)
    air.absorbers.push_back(constituent_of(given.absorbers[i], "absorbers", wavelengths));
  set_unless_zero(air.bottom_radius_m, given.bottom_radius_m);
  set_unless_zero(air.top_radius_m, given.top_radius_m);
  if (given.ground_albedo != nullptr) air.ground_albedo = by_wavelength(given.ground_albedo, wavelengths);
  if (given.sun_irradiance != nullptr) air.solar_irradiance = by_wavelength(given.sun_irradiance, wavelengths);
  set_unless_zero(air.sun_angular_radius_degrees, given.sun_angular_radius_degrees);
  set_unless_zero(air.night_zenith_luminance, given.night_zenith_luminance);
  return air;
}

namespace {

using TablesPointer = std::shared_ptr<const SkyTables>;

welkin_sky_tables* handle_of(TablesPointer tables) { return new welkin_sky_tables{std::move(tables)}; }

}  // namespace

SkyTableOptions table_options(const welkin_sky_table_options* options) {
  const auto given = read_options(options, "table options");
  SkyTableOptions wanted;
  if (flag("compact", given.compact)) wanted.layout = ScatteringLayout::compact;
  set_unless_zero(wanted.heights, given.heights);
  set_unless_zero(wanted.view_zeniths, given.view_zeniths);
  set_unless_zero(wanted.sun_zeniths, given.sun_zeniths);
  set_unless_zero(wanted.sun_angles, given.sun_angles);
  set_unless_zero(wanted.transmittance_heights, given.transmittance_heights);
  set_unless_zero(wanted.transmittance_zeniths, given.transmittance_zeniths);
  set_unless_zero(wanted.irradiance_heights, given.irradiance_heights);
  set_unless_zero(wanted.irradiance_sun_zeniths, given.irradiance_sun_zeniths);
  set_unless_zero(wanted.minimum_sun_elevation_degrees, given.minimum_sun_elevation_degrees);
  set_unless_zero(wanted.orders, given.orders);
  wanted.convergence_threshold = given.convergence_threshold;
  wanted.truncate_orders = given.truncate_orders != 0;
  if (flag("linear_srgb", given.linear_srgb)) wanted.colour = SkyColour::linear_srgb;
  set_unless_zero(wanted.memory_limit_bytes, given.memory_limit_bytes);
  return wanted;
}

const TablesPointer& tables_of(const welkin_sky_tables* tables) {
  require(tables, "tables");
  return tables->tables;
}

namespace {

glm::dvec3 read_sun(const double* sun) { return read_triple(sun, "sun"); }

}  // namespace

const SkyView& view_of(const welkin_sky_view* view) {
  require(view, "view");
  return view->view;
}

}  // namespace welkin::c_interface

// Atmospheres.

welkin_status welkin_sun_direction(double elevation_degrees, double azimuth_degrees, double* direction) {
  return guarded([&] {
    require(direction, "direction");
    write_triple(welkin::sun_direction(elevation_degrees, azimuth_degrees), direction);
  });
}

welkin_status welkin_sun_position(const char* date, double latitude, double longitude, int32_t refraction,
                                  double* elevation_degrees, double* azimuth_degrees, double* direction) {
  return guarded([&] {
    require(date, "date");
    require(elevation_degrees, "elevation_degrees");
    require(azimuth_degrees, "azimuth_degrees");
    const auto sun = welkin::sun_position(
        date,
        {.latitude_degrees = latitude, .longitude_degrees = longitude, .refraction = flag("refraction", refraction)});
    *elevation_degrees = sun.elevation_degrees;
    *azimuth_degrees = sun.azimuth_degrees;
    if (direction != nullptr) write_triple(sun.direction, direction);
  });
}

// Tables.

welkin_status welkin_sky_tables_create(const welkin_atmosphere* atmosphere, const welkin_sky_table_options* options,
                                       const welkin_control* control, welkin_sky_tables** tables) {
  return guarded_making(tables, "tables", [&] {
    const welkin::PrecomputeSky call{atmosphere_of(atmosphere), table_options(options)};
    return handle_of(call(control_of(control)));
  });
}

void welkin_sky_tables_destroy(welkin_sky_tables* tables) { destroy(tables); }

welkin_status welkin_post_sky_tables(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                     const welkin_sky_table_options* options, const welkin_post_options* post,
                                     welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& /*posting*/) {
    return welkin::PrecomputeSky{atmosphere_of(atmosphere), table_options(options)};
  });
}

welkin_status welkin_job_get_sky_tables(const welkin_job* job, welkin_sky_tables** tables) {
  return hand_out_result<TablesPointer>(job, tables, "tables", handle_of);
}

// Views.

welkin_status welkin_sky_view_create(const welkin_sky_tables* tables, double altitude_m, int32_t without_ground,
                                     welkin_sky_view** view) {
  return guarded_making(view, "view", [&] {
    const welkin::SkyViewOptions wanted{!flag("without_ground", without_ground)};
    return new welkin_sky_view{welkin::SkyView(tables_of(tables), altitude_m, wanted)};
  });
}

void welkin_sky_view_destroy(welkin_sky_view* view) { destroy(view); }

welkin_status welkin_sky_view_radiance(const welkin_sky_view* view, const float* directions, size_t count,
                                       const double* sun, float* rgb) {
  return guarded([&] {
    const welkin::SkyView& sky = view_of(view);
    const glm::dvec3 towards_sun = read_sun(sun);
    if (count == 0) return;
    require(directions, "directions");
    require(rgb, "rgb");
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && alignof(glm::vec3) == alignof(float));
    sky.radiance(std::span(reinterpret_cast<const glm::vec3*>(directions), count), towards_sun,
                 std::span(reinterpret_cast<glm::vec3*>(rgb), count));
  });
}

welkin_status welkin_sky_view_sun(const welkin_sky_view* view, const double* sun, double* irradiance,
                                  double* solid_angle) {
  return guarded([&] {
    const welkin::Sun seen = view_of(view).sun_light(read_sun(sun));
    require(irradiance, "irradiance");
    require(solid_angle, "solid_angle");
    write_triple(seen.irradiance, irradiance);
    *solid_angle = seen.solid_angle;
  });
}

welkin_status welkin_sky_view_image(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                    const welkin_control* control, const welkin_target* target,
                                    uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::SkyView& sky = view_of(view);
    const glm::dvec3 towards_sun = read_sun(sun);
    const welkin::SkyImageOptions wanted{flag("sun_disc", sun_disc)};
    const Target checked = target_of(target);
    if (checked.count == 6) {
      const auto image = welkin::sky_cubemap(sky, towards_sun, checked.width, wanted, control_of(control));
      return tell(write_faces(checked, image.view()), values_clamped);
    }
    require_size(checked, 2 * checked.height, checked.height);
    const auto image = welkin::sky_lat_long(sky, towards_sun, checked.height, wanted, control_of(control));
    tell(write_image(checked, 0, image.pixels.data(), 3), values_clamped);
  });
}

welkin_status welkin_sky_view_specular(const welkin_sky_view* view, const double* sun, int32_t sun_disc,
                                       const welkin_prefilter_options* options, const welkin_control* control,
                                       welkin_chain** chain) {
  return guarded_making(chain, "chain", [&] {
    const auto wanted = prefilter_options(options, kSkyReflections, false);
    return new welkin_chain(std::make_shared<const welkin::PrefilteredSpecular>(
        welkin::sky_specular(view_of(view), read_sun(sun), wanted, {flag("sun_disc", sun_disc)}, control_of(control))));
  });
}

welkin_status welkin_post_sky_specular(welkin_worker* worker, const welkin_sky_tables* tables, double altitude_m,
                                       const double* sun, const welkin_prefilter_options* options,
                                       const welkin_post_options* post, welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& /*posting*/) {
    return welkin::SkySpecular{tables_of(tables), altitude_m, read_sun(sun),
                               prefilter_options(options, kSkyReflections, false)};
  });
}
