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

// Atmospheres.

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_PHASE_HENYEY_GREENSTEIN == static_cast<int>(AerosolPhase::henyey_greenstein));

constexpr int kMostLayers = 8;
constexpr int kMostAbsorbers = 4;
constexpr int kMostWavelengths = 96;

/// `count` doubles; `most` is what there can be of them.
std::vector<double> read_list(const double* values, std::int32_t count, int most, const char* name) {
  if (count < 0 || count > most) {
    refuse(std::string("the number of values in ") + name + " is " + std::to_string(count) + "; it must be from 0 to " +
           std::to_string(most));
  }
  if (count == 0) return {};
  require(values, name);
  return {values, values + count};
}

Constituent constituent_of(const welkin_constituent* constituent, std::size_t wavelengths) {
  if (constituent == nullptr) return {};
  const auto given = read_struct(constituent, "constituent");
  constexpr int kLayerValues = 5;
  if (given.layer_count < 0 || given.layer_count > kMostLayers) {
    refuse("layer_count is " + std::to_string(given.layer_count) + "; it must be from 0 to " +
           std::to_string(kMostLayers));
  }
  const auto layers = read_list(given.layers, kLayerValues * given.layer_count, kLayerValues * kMostLayers, "layers");
  Constituent matter;
  for (std::size_t i = 0; i < layers.size(); i += kLayerValues) {
    matter.density.push_back({layers[i], layers[i + 1], layers[i + 2], layers[i + 3], layers[i + 4]});
  }
  const auto coefficients = [&](const double* values) {
    return values == nullptr ? std::vector<double>{} : std::vector<double>(values, values + wavelengths);
  };
  matter.scattering_per_m = coefficients(given.scattering_per_m);
  matter.absorption_per_m = coefficients(given.absorption_per_m);
  return matter;
}

void set_absorber(Atmosphere& air, std::size_t number, bool there, Constituent matter) {
  if (number > air.absorbers.size() || (number == air.absorbers.size() && !there)) {
    refuse("matter is absorber " + std::to_string(number) + "; there are " + std::to_string(air.absorbers.size()) +
           ", and only the next one can be added");
  }
  if (!there) {
    air.absorbers.erase(air.absorbers.begin() + static_cast<std::ptrdiff_t>(number));
  } else if (number == air.absorbers.size()) {
    air.absorbers.push_back(std::move(matter));
  } else {
    air.absorbers[number] = std::move(matter);
  }
}

Atmosphere planet_of(welkin_planet planet) {
  require_enumerator("planet", planet, WELKIN_PLANET_EARTH_POLLUTED);
  const std::vector<double> wavelengths = Atmosphere{}.wavelengths_nm;
  switch (planet) {
    case WELKIN_PLANET_EARTH: return earth();
    case WELKIN_PLANET_EARTH_HILLAIRE: return earth_hillaire();
    case WELKIN_PLANET_MARS: return mars();
    case WELKIN_PLANET_EARTH_BRUNETON: return earth_bruneton();
    case WELKIN_PLANET_EARTH_HAZY: return earth(wavelengths, AerosolKind::hazy);
    case WELKIN_PLANET_EARTH_DUSTY: return earth(wavelengths, AerosolKind::dusty);
    case WELKIN_PLANET_EARTH_POLLUTED: return earth(wavelengths, AerosolKind::polluted);
    default: return {};
  }
}

Atmosphere& air_of(welkin_atmosphere* atmosphere) {
  require(atmosphere, "atmosphere");
  return atmosphere->air;
}

}  // namespace

const Atmosphere& air_of(const welkin_atmosphere* atmosphere) {
  require(atmosphere, "atmosphere");
  return atmosphere->air;
}

}  // namespace welkin::c_interface

welkin_status welkin_atmosphere_create(welkin_planet planet, welkin_atmosphere** atmosphere) {
  return guarded_making(atmosphere, "atmosphere", [&] { return new welkin_atmosphere{planet_of(planet)}; });
}

welkin_status welkin_atmosphere_create_earth(const double* wavelengths_nm, int32_t count,
                                             welkin_atmosphere** atmosphere) {
  return guarded_making(atmosphere, "atmosphere", [&] {
    return new welkin_atmosphere{welkin::earth(read_list(wavelengths_nm, count, kMostWavelengths, "wavelengths_nm"))};
  });
}

void welkin_atmosphere_destroy(welkin_atmosphere* atmosphere) { destroy(atmosphere); }

welkin_status welkin_atmosphere_set_wavelengths(welkin_atmosphere* atmosphere, const double* wavelengths_nm,
                                                int32_t count) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air.wavelengths_nm = read_list(wavelengths_nm, count, kMostWavelengths, "wavelengths_nm");
  });
}

welkin_status welkin_atmosphere_set_matter(welkin_atmosphere* atmosphere, welkin_matter matter,
                                           const welkin_constituent* constituent) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    require_enumerator("matter", matter, WELKIN_MATTER_ABSORBER + kMostAbsorbers - 1);
    auto wanted = constituent_of(constituent, air.wavelengths_nm.size());
    if (matter == WELKIN_MATTER_RAYLEIGH) {
      air.rayleigh = std::move(wanted);
    } else if (matter == WELKIN_MATTER_AEROSOL) {
      air.aerosol = std::move(wanted);
    } else {
      const auto number = static_cast<std::size_t>(matter - WELKIN_MATTER_ABSORBER);
      set_absorber(air, number, constituent != nullptr, std::move(wanted));
    }
  });
}

welkin_status welkin_atmosphere_set_aerosol_phase(welkin_atmosphere* atmosphere, welkin_aerosol_phase phase,
                                                  double asymmetry) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air.aerosol_phase = enumerator("phase", phase, welkin::AerosolPhase::henyey_greenstein);
    air.aerosol_asymmetry = asymmetry;
    air.aerosol_asymmetries.clear();
  });
}

welkin_status welkin_atmosphere_set_aerosol_asymmetries(welkin_atmosphere* atmosphere, const double* asymmetries,
                                                        int32_t count) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air.aerosol_asymmetries =
        count == 0 ? std::vector<double>{} : read_list(asymmetries, count, kMostWavelengths, "asymmetries");
  });
}

welkin_status welkin_atmosphere_set_night(welkin_atmosphere* atmosphere, double zenith_luminance) {
  return guarded([&] { air_of(atmosphere).night_zenith_luminance = zenith_luminance; });
}

welkin_status welkin_atmosphere_set_aerosol(welkin_atmosphere* atmosphere, double optical_depth,
                                            double angstrom_exponent, double single_scattering_albedo,
                                            double asymmetry) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air = welkin::with_aerosol(air, {.optical_depth = optical_depth,
                                     .angstrom_exponent = angstrom_exponent,
                                     .single_scattering_albedo = single_scattering_albedo,
                                     .asymmetry = asymmetry});
  });
}

welkin_status welkin_atmosphere_set_radii(welkin_atmosphere* atmosphere, double bottom_m, double top_m) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air.bottom_radius_m = bottom_m;
    air.top_radius_m = top_m;
  });
}

welkin_status welkin_atmosphere_set_ground_albedo(welkin_atmosphere* atmosphere, const double* albedo, int32_t count) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    auto values = read_list(albedo, count, kMostWavelengths, "albedo");
    if (values.size() == 1) {
      air = welkin::with_ground_albedo(air, values[0]);
    } else {
      air.ground_albedo = std::move(values);
    }
  });
}

welkin_status welkin_atmosphere_set_sun(welkin_atmosphere* atmosphere, const double* irradiance, int32_t count,
                                        double angular_radius_degrees) {
  return guarded([&] {
    welkin::Atmosphere& air = air_of(atmosphere);
    air.solar_irradiance = read_list(irradiance, count, kMostWavelengths, "irradiance");
    air.sun_angular_radius_degrees = angular_radius_degrees;
  });
}

welkin_status welkin_atmosphere_check(const welkin_atmosphere* atmosphere) {
  return guarded([&] { welkin::check(air_of(atmosphere)); });
}

welkin_status welkin_sun_direction(double elevation_degrees, double azimuth_degrees, double* direction) {
  return guarded([&] {
    require(direction, "direction");
    write_triple(welkin::sun_direction(elevation_degrees, azimuth_degrees), direction);
  });
}

// Tables.

namespace welkin::c_interface {
namespace {

static_assert(WELKIN_SCATTERING_COMPACT == static_cast<int>(ScatteringLayout::compact));
static_assert(WELKIN_SKY_COLOUR_LINEAR_SRGB == static_cast<int>(SkyColour::linear_srgb));

using TablesPointer = std::shared_ptr<const SkyTables>;

welkin_sky_tables* handle_of(TablesPointer tables) { return new welkin_sky_tables{std::move(tables)}; }

}  // namespace

SkyTableOptions table_options(const welkin_sky_table_options* options) {
  const auto given = read_options(options, "table options");
  SkyTableOptions wanted;
  wanted.layout = enumerator("layout", given.layout, ScatteringLayout::compact);
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
  wanted.until_change = given.until_change;
  wanted.exact_orders = given.exact_orders != 0;
  wanted.colour = enumerator("colour", given.colour, SkyColour::linear_srgb);
  set_unless_zero(wanted.memory_limit_bytes, given.memory_limit_bytes);
  return wanted;
}

const TablesPointer& tables_of(const welkin_sky_tables* tables) {
  require(tables, "tables");
  return tables->tables;
}

}  // namespace welkin::c_interface

welkin_status welkin_sky_tables_create(const welkin_atmosphere* atmosphere, const welkin_sky_table_options* options,
                                       const welkin_control* control, welkin_sky_tables** tables) {
  return guarded_making(tables, "tables", [&] {
    const welkin::PrecomputeSky call{air_of(atmosphere), table_options(options)};
    return handle_of(call(control_of(control)));
  });
}

void welkin_sky_tables_destroy(welkin_sky_tables* tables) { destroy(tables); }

welkin_status welkin_sky_tables_get_info(const welkin_sky_tables* tables, welkin_sky_tables_info* info) {
  return guarded([&] {
    const welkin::SkyTables& made = *tables_of(tables);
    welkin_sky_tables_info values{};
    values.orders = made.orders;
    values.last_change = made.last_change;
    values.bytes = made.bytes();
    write_struct(info, values, "info");
  });
}

welkin_status welkin_post_sky_tables(welkin_worker* worker, const welkin_atmosphere* atmosphere,
                                     const welkin_sky_table_options* options, const welkin_post_options* post,
                                     welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    welkin::PrecomputeSky request{air_of(atmosphere), table_options(options)};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}

welkin_status welkin_job_get_sky_tables(const welkin_job* job, welkin_sky_tables** tables) {
  return hand_out_result<TablesPointer>(job, tables, "tables", handle_of);
}

// Views.

namespace welkin::c_interface {
namespace {

glm::dvec3 read_sun(const double* sun) { return read_triple(sun, "sun"); }

SkyPictureOptions picture_options(const welkin_sky_picture_options* options) {
  return {flag("sun_disc", read_options(options, "picture options").sun_disc)};
}

}  // namespace

const SkyView& view_of(const welkin_sky_view* view) {
  require(view, "view");
  return view->view;
}

}  // namespace welkin::c_interface

welkin_status welkin_sky_view_create(const welkin_sky_tables* tables, double altitude_m,
                                     const welkin_sky_view_options* options, welkin_sky_view** view) {
  return guarded_making(view, "view", [&] {
    const auto given = read_options(options, "view options");
    const welkin::SkyViewOptions wanted{!flag("without_ground", given.without_ground)};
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

welkin_status welkin_sky_view_sun(const welkin_sky_view* view, const double* sun, welkin_sun* light) {
  return guarded([&] {
    const welkin::Sun seen = view_of(view).sun(read_sun(sun));
    welkin_sun values{};
    write_triple(seen.direction, values.direction);
    write_triple(seen.irradiance, values.irradiance);
    write_triple(seen.radiance, values.radiance);
    values.solid_angle = seen.solid_angle;
    values.angular_radius_degrees = seen.angular_radius_degrees;
    write_struct(light, values, "light");
  });
}

welkin_status welkin_sky_view_irradiance(const welkin_sky_view* view, const double* sun, double* irradiance) {
  return guarded([&] {
    require(irradiance, "irradiance");
    write_triple(view_of(view).irradiance(read_sun(sun)), irradiance);
  });
}

welkin_status welkin_sky_view_cubemap(const welkin_sky_view* view, const double* sun,
                                      const welkin_sky_picture_options* options, const welkin_control* control,
                                      const welkin_cubemap_target* target, uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::SkyView& sky = view_of(view);
    const glm::dvec3 towards_sun = read_sun(sun);
    const auto wanted = picture_options(options);
    const Target checked = cubemap_target(target);
    const auto picture = welkin::sky_cubemap(sky, towards_sun, checked.width, wanted, control_of(control));
    tell(write_faces(checked, picture.view()), values_clamped);
  });
}

welkin_status welkin_sky_view_lat_long(const welkin_sky_view* view, const double* sun,
                                       const welkin_sky_picture_options* options, const welkin_control* control,
                                       const welkin_image_target* target, uint64_t* values_clamped) {
  return guarded([&] {
    const welkin::SkyView& sky = view_of(view);
    const glm::dvec3 towards_sun = read_sun(sun);
    const auto wanted = picture_options(options);
    const Target checked = image_target(target);
    require_size(checked, 2 * checked.height, checked.height);
    const auto picture = welkin::sky_lat_long(sky, towards_sun, checked.height, wanted, control_of(control));
    tell(write_picture(checked, 0, picture.pixels.data(), 3), values_clamped);
  });
}

welkin_status welkin_sky_view_specular(const welkin_sky_view* view, const double* sun,
                                       const welkin_prefilter_options* options,
                                       const welkin_sky_picture_options* picture, const welkin_control* control,
                                       welkin_cubemap_chain** chain) {
  return guarded_making(chain, "chain", [&] {
    const auto wanted = prefilter_options(options, kSkyReflections, false);
    return new welkin_cubemap_chain(std::make_shared<const welkin::PrefilteredSpecular>(
        welkin::sky_specular(view_of(view), read_sun(sun), wanted, picture_options(picture), control_of(control))));
  });
}

welkin_status welkin_post_sky_specular(welkin_worker* worker, const welkin_sky_tables* tables, double altitude_m,
                                       const double* sun, const welkin_prefilter_options* options,
                                       const welkin_post_options* post, welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    welkin::SkySpecular request{tables_of(tables), altitude_m, read_sun(sun),
                                prefilter_options(options, kSkyReflections, false)};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}
