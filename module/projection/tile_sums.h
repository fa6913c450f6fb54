// Sums of tiles and faces, and how they become a projection.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "welkin/projection.h"

namespace welkin::projection {

/// One slot of sums, [3][bands^2] in double, and one record of the sanitizing for every tile. Made before the tiles
/// run; each tile writes its own slot; totals add them in the tiles' order.
struct TileSums {
  TileSums(std::size_t tiles, int bands)
      : functions(static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands)),
        values(tiles * 3 * functions),
        records(tiles) {}

  [[nodiscard]] double* tile(std::size_t index) noexcept { return values.data() + index * 3 * functions; }
  [[nodiscard]] const double* tile(std::size_t index) const noexcept { return values.data() + index * 3 * functions; }

  [[nodiscard]] std::vector<double> sum() const;  ///< [3][functions]
  /// The sum as coefficients, where slots are in canonical order; allocates nothing.
  void total(std::span<glm::dvec3> coefficients) const noexcept;
  [[nodiscard]] SanitizeRecord total_record() const;

  std::size_t functions;
  std::vector<double> values;           ///< of each tile
  std::vector<SanitizeRecord> records;  ///< of each tile
};

/// In the face's own frame, in the order of the weights: the same for the same pixels on any face.
struct FaceSums : TileSums {
  using TileSums::TileSums;

  /// The sums of the texels as areas, [3][functions] in the same order, where `values` are of averages; else empty.
  std::vector<double> exact;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof *this + (values.size() + exact.size()) * sizeof(double) + records.size() * sizeof(SanitizeRecord);
  }
};

/// True if no sum is NaN or infinite: then no texel was either, and none overflowed.
[[nodiscard]] bool all_finite(std::span<const double> sums) noexcept;

/// `weighted_sums` in double, for the rare chunk of finite texels whose float sums overflow.
/// planes: [3][class_count][kChunk], of which the first `positions` count.
void weighted_sums_in_double(const double* planes, int class_count, const float* weights, const ClassCounts& counts,
                             int positions, double* sums) noexcept;

/// Puts the diagnostics' counts and total radiances together. `steradians_per_weight`: what the records' total radiance
/// is multiplied by.
[[nodiscard]] ProjectionDiagnostics diagnostics_of(std::span<const glm::dvec3> radiance, const SanitizeRecord& record,
                                                   double steradians_per_weight);

/// Adds one probe's diagnostics to those of many: counts and total radiance are added up, the error estimate is the
/// largest.
void add(ProjectionDiagnostics& sum, const ProjectionDiagnostics& one);

}  // namespace welkin::projection
