#include "projection/target_size.h"

#include <bit>
#include <cstdint>

namespace welkin::projection {

std::optional<int> effective_target(int size, const ProjectionOptions& options) noexcept {
  if (!options.target_size) return std::nullopt;
  const int target = options.quadrature == Quadrature::midpoint
                         ? static_cast<int>(std::bit_floor(static_cast<unsigned>(*options.target_size)))
                         : *options.target_size;
  return target < size ? std::optional(target) : std::nullopt;
}

// Of neighbours a > t > b the first is nearer if a / t < t / b.
std::size_t nearest_level(std::span<const int> sizes, int target) noexcept {
  std::size_t level = 0;
  while (level + 1 < sizes.size() && sizes[level] > target) {
    const std::int64_t a = sizes[level];
    const std::int64_t b = sizes[level + 1];
    const std::int64_t t = target;
    if (b <= t && a * b < t * t) break;
    ++level;
  }
  return level;
}

}  // namespace welkin::projection
