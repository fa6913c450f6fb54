#include <algorithm>
#include <cmath>

#include "specular/spectrum.h"
#include "tables/ring_fourier.h"

namespace welkin::specular {

GridSize grid_for_bands(int bands, double oversampling) noexcept {
  constexpr double least_rings = 8.0;
  constexpr double most_rings = 32768.0;
  const double rings = std::clamp(std::ceil(bands * oversampling - 1e-9), least_rings, most_rings);
  const int columns = tables::fast_even_length(2 * static_cast<int>(rings));
  return {columns / 2, columns};
}

}  // namespace welkin::specular
