#include "sky/even_legendre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace welkin::sky {

void even_legendre(int bands, double zenith_cosine, double* values) noexcept {
  const double sine = std::sqrt(std::max(0.0, (1.0 - zenith_cosine) * (1.0 + zenith_cosine)));
  double start = std::sqrt(0.25 / std::numbers::pi);
  for (int m = 0; m < bands; ++m) {
    if (m > 0) start *= sine * std::sqrt((2.0 * m + 1.0) / (2.0 * m) * (m == 1 ? 2.0 : 1.0));
    double before = 0.0;
    double here = start;
    for (int l = m; l < bands; ++l) {
      values[pair_index(bands, l, m)] = here;
      const double n = l + 1.0;
      const double a = std::sqrt((4.0 * n * n - 1.0) / (n * n - m * m));
      const double b =
          l > m ? std::sqrt((2.0 * n + 1.0) * ((n - 1.0) * (n - 1.0) - m * m) / ((2.0 * n - 3.0) * (n * n - m * m)))
                : 0.0;
      const double next = a * zenith_cosine * here - b * before;
      before = here;
      here = next;
    }
  }
}

}  // namespace welkin::sky
