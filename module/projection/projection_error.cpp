#include "projection/projection_error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>

#include "welkin/spherical_harmonics.h"

namespace welkin::projection {
namespace {

constexpr double kRounding = 2e-7;

using BandNorms = std::array<double, kMaximumBands>;

/// |c_l| of each band, over orders and channels; returns those that there are.
std::span<const double> band_norms(std::span<const glm::dvec3> radiance, BandNorms& norms) {
  std::size_t bands = 0;
  for (std::size_t at = 0; at < radiance.size(); ++bands) {
    double sum = 0.0;
    for (const std::size_t end = (bands + 1) * (bands + 1); at < end; ++at) sum += glm::dot(radiance[at], radiance[at]);
    norms[bands] = std::sqrt(sum);
  }
  return {norms.data(), bands};
}

}  // namespace

double relative_error(std::span<const glm::dvec3> radiance, std::span<const glm::dvec3> exact, double beyond) {
  double exact_squared = 0.0;
  double off_squared = 0.0;
  for (std::size_t f = 0; f < radiance.size(); ++f) {
    const glm::dvec3 off = radiance[f] - exact[f];
    exact_squared += glm::dot(exact[f], exact[f]);
    off_squared += glm::dot(off, off);
  }
  const double lost = std::sqrt(off_squared) + beyond;
  if (exact_squared == 0.0) return lost > 0.0 ? 1.0 : 0.0;
  return kRounding + lost / std::sqrt(exact_squared);
}

double mip_error(std::span<const glm::dvec3> radiance, double size) {
  BandNorms room;
  const std::span<const double> norms = band_norms(radiance, room);
  double total_squared = 0.0;
  for (const double norm : norms) total_squared += norm * norm;
  if (total_squared == 0.0) return 0.0;
  double error_squared = 0.0;
  const auto add = [&](double error) { error_squared += error * error; };
  // Without a band 2 nothing is known of how concentrated the light is; band 1 is the next best witness.
  const std::size_t witness = std::min<std::size_t>(2, norms.size() - 1);
  const double point_norm = std::sqrt(2.0 * static_cast<double>(witness) + 1.0) * norms[0];
  const double point_share = norms[0] > 0.0 ? std::min(1.0, norms[witness] / point_norm) : 1.0;
  double varied_squared = 0.0;
  for (std::size_t band = 1; band < norms.size(); ++band) varied_squared += norms[band] * norms[band];
  add(0.45 * std::min(norms[0], 100.0 * std::sqrt(varied_squared)) / (size * size));
  const double cell = 0.5 * std::numbers::pi / size;
  for (std::size_t band = 1; band < norms.size(); ++band) {
    const auto l = static_cast<double>(band);
    add(l * (l + 1.0) * cell * cell / 7.0 * norms[band]);
    add(0.35 * l * cell * point_share * std::sqrt(2.0 * l + 1.0) * norms[0]);
  }
  return std::sqrt(error_squared / total_squared);
}

std::optional<int> effective_target(int size, const ProjectionOptions& options) noexcept {
  if (!options.target_size) return std::nullopt;
  const int target = options.quadrature == Quadrature::midpoint
                         ? static_cast<int>(std::bit_floor(static_cast<unsigned>(*options.target_size)))
                         : *options.target_size;
  return target < size ? std::optional(target) : std::nullopt;
}

// Where a > t > b are neighbours, a is nearer if a / t < t / b.
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
