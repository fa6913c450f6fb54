#include "tables/legendre_factors.h"

#include <cmath>

#include "tables/table_cache.h"

namespace welkin::tables {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;  // 512 bands take 4 MiB, 1536 take 38
constexpr int kBeyond = 9;                                   // degrees that kernels run past the last one

/// e(l, m); 0 for l = m.
double ratio(double l, double m) { return std::sqrt((l - m) * (l + m) / ((2.0 * l - 1.0) * (2.0 * l + 1.0))); }

}  // namespace

std::shared_ptr<const LegendreFactors> LegendreFactors::get(int bands) {
  static TableCache<int, LegendreFactors> cache(kCacheBytes);
  return cache.get(bands, [&] { return std::make_shared<const LegendreFactors>(bands); });
}

LegendreFactors::LegendreFactors(int bands) {
  for (int m = 0; m < bands; ++m) {
    starts_.push_back(length_);
    length_ += static_cast<std::size_t>(bands - m + kBeyond);
  }
  values_ = AlignedBuffer<double>(4 * length_);
  single_ = AlignedBuffer<float>(length_);
  for (int m = 0; m < bands; ++m) fill_order(m, bands - m + kBeyond);
  for (std::size_t k = 0; k < length_; ++k) single_.data()[k] = static_cast<float>(values_.data()[k]);
}

void LegendreFactors::fill_order(int m, int count) {
  double* const a = values_.data() + start(m);
  double* const gamma = a + length_;
  double* const alpha = gamma + length_;
  double* const beta = alpha + length_;
  a[0] = alpha[0] = beta[0] = 0.0;  // not used
  gamma[0] = 1.0;
  double ratio_before = 0.0;  // e(l - 1)
  for (int i = 1; i < count; ++i) {
    const double l = m + i;
    const double ratio_here = ratio(l, m);
    gamma[i] = i == 1 ? 1.0 : ratio_before / ratio_here * gamma[i - 2];
    a[i] = gamma[i - 1] / (ratio_here * gamma[i]);
    alpha[i] = (l - 2.0) * ratio_before / ((l + 1.0) * ratio_here);
    beta[i] = gamma[i - 1] / ((l + 1.0) * ratio_here);
    ratio_before = ratio_here;
  }
}

}  // namespace welkin::tables
