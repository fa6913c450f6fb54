// What tiles and faces add to a projection, and how that becomes one.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::projection {

/// In the face's own frame: the same for the same pixels on any face.
struct FaceSums {
  FaceSums(std::size_t tiles, int bands)
      : functions(static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands)),
        values(tiles * 3 * functions),
        records(tiles) {}

  std::size_t functions;
  std::vector<double> values;           ///< of each tile, [3][functions] in the order of the weights
  std::vector<SanitizeRecord> records;  ///< of each tile

  /// The sums of the texels as areas, [3][functions] in the same order, where `values` are of averages; else empty.
  std::vector<double> exact;

  [[nodiscard]] double* tile(std::size_t index) noexcept { return values.data() + index * 3 * functions; }
  [[nodiscard]] const double* tile(std::size_t index) const noexcept { return values.data() + index * 3 * functions; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof *this + (values.size() + exact.size()) * sizeof(double) + records.size() * sizeof(SanitizeRecord);
  }
};

/// One slot of canonical sums, [3][bands^2] in double, and one record of the sanitizing for every tile. Made before
/// the tiles run; each tile writes its own slot; `total` adds them in the tiles' order.
class TileSums {
 public:
  TileSums(std::size_t tiles, int bands)
      : functions_(static_cast<std::size_t>(bands * bands)), values_(tiles * 3 * functions_), records_(tiles) {}

  [[nodiscard]] double* values(std::size_t tile) noexcept { return values_.data() + tile * 3 * functions_; }
  [[nodiscard]] SanitizeRecord& record(std::size_t tile) noexcept { return records_[tile]; }

  [[nodiscard]] SphericalHarmonics total() const;
  [[nodiscard]] SanitizeRecord total_record() const;

 private:
  std::size_t functions_;
  std::vector<double> values_;
  std::vector<SanitizeRecord> records_;
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

/// Of many probes together: counts and total radiance are added up, the error estimate is the largest.
void add(ProjectionDiagnostics& sum, const ProjectionDiagnostics& one);

}  // namespace welkin::projection
