// Tables that are built once for all tests of views and harmonics.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "welkin/sky.h"

namespace welkin::test {

/// Returns Bruneton's Earth, two orders, at the default sizes along zeniths and suns, with few heights.
[[nodiscard]] std::shared_ptr<const SkyTables> small_earth();

/// Returns tables of an atmosphere, to share among views.
[[nodiscard]] std::shared_ptr<const SkyTables> sky_tables_of(const Atmosphere& atmosphere,
                                                             const SkyTableOptions& options = {});
/// Returns the sky of an atmosphere, seen from an altitude.
[[nodiscard]] SkyView sky_view_of(const Atmosphere& atmosphere, const SkyTableOptions& options = {},
                                  double altitude_m = 0.0);

/// Returns table sizes that take milliseconds.
[[nodiscard]] SkyTableOptions tiny_tables();

/// Returns |a - b| / |b| of the worst channel; |a| where b is black.
[[nodiscard]] double relative_difference(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b);

}  // namespace welkin::test
