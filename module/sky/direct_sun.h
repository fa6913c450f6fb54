// The direct sun at a place, by the tables.
#pragma once

#include <glm/vec3.hpp>

#include "sky/table_mapping.h"
#include "welkin/sky_tables.h"

namespace welkin::sky {

/// Steradians: a disc of less is a point, whose radiance would overflow.
inline constexpr double kPoint = 1e-60;

/// Sine of the lowest sun's elevation.
[[nodiscard]] double lowest_sun_sine(const SkyTables& tables) noexcept;

/// The mapping of an atmosphere's tables.
[[nodiscard]] TableMapping mapping_of(const SkyTables& tables) noexcept;

/// Transmittance from an altitude within the air along a ray to the top; of one below the horizon that of the
/// horizon's.
[[nodiscard]] glm::dvec3 transmittance_to_top(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                              double zenith_cosine) noexcept;

/// Visible share of the sun's disc (sky_reference.h). Any altitude.
[[nodiscard]] double visible_share(const Atmosphere& atmosphere, double altitude, double sun_zenith_cosine) noexcept;

/// What arrives of the sun's light above the air, 0 to 1: through the air, past the horizon. Any altitude.
[[nodiscard]] glm::dvec3 sun_share(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                   double sun_zenith_cosine) noexcept;

/// Irradiance of the sky on the ground or above it (tables' irradiance), facing up.
[[nodiscard]] glm::dvec3 sky_irradiance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                        double sun_zenith_cosine) noexcept;

/// 1 down to the tables' lowest sun, 0 at the nadir, smooth between: how much of the last sky is left.
[[nodiscard]] double sun_fade(const SkyTables& tables, double sun_zenith_cosine) noexcept;

}  // namespace welkin::sky
