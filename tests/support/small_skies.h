// Tables that are made once for all tests of views and harmonics.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "welkin/sky.h"

namespace welkin::test {

/// Bruneton's Earth, two orders, at the default sizes along zeniths and suns; few heights.
[[nodiscard]] std::shared_ptr<const SkyTables> small_earth();

/// Sizes that take milliseconds.
[[nodiscard]] SkyTableOptions tiny_tables();

/// |a - b| / |b|, the worst channel; |a| where b is black.
[[nodiscard]] double relative_difference(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b);

}  // namespace welkin::test
