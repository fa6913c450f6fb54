// The light that settings of skies are judged by.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/error_budget.h"

namespace welkin::budget {

/// Throws `Error` (invalid_argument) unless there is at least one, each finite and with a length.
void check_suns(std::span<const glm::dvec3> suns);

/// The largest relative difference |a - b| / |b| over suns.
[[nodiscard]] double worst_difference(std::span<const SphericalHarmonics> a, std::span<const SphericalHarmonics> b);

/// Three bands of the tables' sky for each of the probe's suns, by the default quadrature.
[[nodiscard]] std::vector<SphericalHarmonics> light_of(const SkyTables& tables, const SkyProbe& probe);

}  // namespace welkin::budget
