#include "projection/tile_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace welkin::projection {

std::vector<double> TileSums::sum() const {
  std::vector<double> sums(3 * functions);
  for (std::size_t at = 0; at < values.size(); at += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += values[at + k];
  }
  return sums;
}

void TileSums::total(std::span<glm::dvec3> coefficients) const noexcept {
  std::fill_n(coefficients.begin(), functions, glm::dvec3(0.0));
  for (std::size_t at = 0; at < values.size(); at += 3 * functions) {
    const double* const slot = values.data() + at;
    for (std::size_t f = 0; f < functions; ++f)
      coefficients[f] += glm::dvec3(slot[f], slot[f + functions], slot[f + 2 * functions]);
  }
}

SanitizeRecord TileSums::total_record() const {
  SanitizeRecord total;
  for (const SanitizeRecord& record : records) total.add(record);
  return total;
}

bool all_finite(std::span<const double> sums) noexcept {
  // x - x is 0 for finite x and NaN else; adding those up needs no branch.
  double poison = 0.0;
  for (const double sum : sums) poison += sum - sum;
  return poison == 0.0;
}

void weighted_sums_in_double(const double* planes, int class_count, const float* weights, const ClassCounts& counts,
                             int positions, double* sums) noexcept {
  for (int channel = 0; channel < 3; ++channel) {
    const float* weight = weights;
    for (int symmetry = 0; symmetry < class_count; ++symmetry) {
      const double* const plane = planes + static_cast<std::ptrdiff_t>(channel * class_count + symmetry) * kChunk;
      for (int i = 0; i < counts.count[symmetry]; ++i, weight += kChunk, ++sums) {
        for (int k = 0; k < positions; ++k) *sums += plane[k] * static_cast<double>(weight[k]);
      }
    }
  }
}

ProjectionDiagnostics diagnostics_of(std::span<const glm::dvec3> radiance, const SanitizeRecord& record,
                                     double steradians_per_weight) {
  ProjectionDiagnostics diagnostics;
  diagnostics.nans_replaced = record.nans;
  diagnostics.infinities_replaced = record.infinities;
  diagnostics.negatives_replaced = record.negatives;
  diagnostics.texels_clamped = record.clamped;
  // c(0,0) = Int L Y(0,0), and Y(0,0) = 1 / sqrt(4 pi).
  diagnostics.total_radiance = radiance.front() * (2.0 * std::sqrt(std::numbers::pi));
  diagnostics.total_radiance_before_clamp =
      diagnostics.total_radiance + record.radiance_removed * steradians_per_weight;
  return diagnostics;
}

void add(ProjectionDiagnostics& sum, const ProjectionDiagnostics& one) {
  sum.texels += one.texels;
  sum.nans_replaced += one.nans_replaced;
  sum.infinities_replaced += one.infinities_replaced;
  sum.negatives_replaced += one.negatives_replaced;
  sum.texels_clamped += one.texels_clamped;
  sum.total_radiance_before_clamp += one.total_radiance_before_clamp;
  sum.total_radiance += one.total_radiance;
  sum.error_estimate = std::max(sum.error_estimate, one.error_estimate);
}

}  // namespace welkin::projection
