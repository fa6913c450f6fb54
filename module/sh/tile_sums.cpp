#include "sh/tile_sums.h"

#include <cmath>
#include <numbers>

namespace welkin::sh {

SphericalHarmonics TileSums::total() const {
  std::vector<double> sums(3 * functions_);
  for (std::size_t at = 0; at < values_.size(); at += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += values_[at + k];
  }
  SphericalHarmonics result(static_cast<int>(std::lround(std::sqrt(static_cast<double>(functions_)))));
  for (std::size_t f = 0; f < functions_; ++f) {
    result.coefficients()[f] = {sums[f], sums[functions_ + f], sums[2 * functions_ + f]};
  }
  return result;
}

CleaningRecord TileSums::total_record() const {
  CleaningRecord total;
  for (const CleaningRecord& record : records_) total.add(record);
  return total;
}

bool all_finite(std::span<const double> sums) noexcept {
  // x - x is 0 for finite x and NaN else; adding those up needs no branch.
  double poison = 0.0;
  for (const double sum : sums) poison += sum - sum;
  return poison == 0.0;
}

void weighted_sums_in_double(const double* planes, int class_count, const float* weights,
                             const simd::ClassCounts& counts, int positions, double* sums) noexcept {
  for (int channel = 0; channel < 3; ++channel) {
    const float* weight = weights;
    for (int symmetry = 0; symmetry < class_count; ++symmetry) {
      const double* const plane = planes + static_cast<std::ptrdiff_t>(channel * class_count + symmetry) * simd::kChunk;
      for (int i = 0; i < counts.count[symmetry]; ++i, weight += simd::kChunk, ++sums) {
        for (int k = 0; k < positions; ++k) *sums += plane[k] * static_cast<double>(weight[k]);
      }
    }
  }
}

ProjectionDiagnostics diagnostics_of(const SphericalHarmonics& radiance, const CleaningRecord& record,
                                     double flux_per_weight) {
  ProjectionDiagnostics diagnostics;
  diagnostics.nans_replaced = record.nans;
  diagnostics.infinities_replaced = record.infinities;
  diagnostics.negatives_replaced = record.negatives;
  diagnostics.texels_clamped = record.clamped;
  // c(0,0) = Int L Y(0,0), and Y(0,0) = 1 / sqrt(4 pi).
  diagnostics.flux = radiance.at(0, 0) * (2.0 * std::sqrt(std::numbers::pi));
  diagnostics.flux_before_clamp = diagnostics.flux + record.flux_removed * flux_per_weight;
  return diagnostics;
}

}  // namespace welkin::sh
