// What the sky's cases share: atmospheres, directions where skies are hard, errors against the reference.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "welkin/atmosphere.h"
#include "welkin/sky_tables.h"
#include "welkin/sky_view.h"

namespace welkin::report::stability {

/// Earth with all scattering and absorption times a factor.
[[nodiscard]] Atmosphere dense_earth(double factor);

/// A planet with nothing but Rayleigh's air: optical depth 0.1 from the ground up at the middle wavelength.
[[nodiscard]] Atmosphere plain_planet(double radius_m, double thickness_m, double scale_height_m);

/// One order, few heights, else the default sizes.
[[nodiscard]] SkyTableOptions single_order();

/// Earth by these, made once a program.
[[nodiscard]] const std::shared_ptr<const SkyTables>& earth_tables();

/// From the zenith to the nadir, close to the horizon from both sides, at three azimuths; from space across the planet
/// and through its limb.
[[nodiscard]] std::vector<glm::dvec3> hard_directions(const Atmosphere& atmosphere, double altitude_m);

/// Root mean square of the view's error over that of the reference's single scattering, over directions. The view must
/// be of one order and without ground.
[[nodiscard]] double radiance_error(const SkyView& view, const std::vector<glm::dvec3>& directions,
                                    double sun_elevation_degrees);

/// The same for an atmosphere's own view at `hard_directions`.
[[nodiscard]] double sky_error(const Atmosphere& atmosphere, double altitude_m, double sun_elevation_degrees,
                               const SkyTableOptions& options = single_order());

/// How many values of all tables are negative or not finite.
[[nodiscard]] double unsound_values(const SkyTables& tables);

}  // namespace welkin::report::stability
