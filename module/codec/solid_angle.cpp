#include "codec/solid_angle.h"

#include <cstddef>
#include <numbers>

#include "tables/solid_angle.h"
#include "tables/texel_weights.h"
#include "tables/trigonometry.h"

namespace welkin::codec {

// The integral of cos(latitude) over the texel is 2 pi / width (sin(top) - sin(bottom)); with the row's
// polar angle theta at its centre that difference is the product 2 sin(theta) sin(pi / (2 height)).
double lat_long_texel_solid_angle(int width, int height, int row) {
  const double polar_sine = tables::sine_cosine_of_turns((row + 0.5) / (2.0 * height)).sine;
  return 2.0 * std::numbers::pi / width * 2.0 * polar_sine * tables::sine_cosine_of_turns(0.25 / height).sine;
}

void cubemap_row_solid_angles(int row, std::span<double> row_angles) {
  const std::size_t size = row_angles.size();
  const simd::GaussRule rule = tables::texel_rule(static_cast<int>(size));
  const double half_edge = 1.0 / static_cast<double>(size);
  const double v = (2.0 * row + 1.0) * half_edge - 1.0;
  for (std::size_t column = 0; column < (size + 1) / 2; ++column) {
    const double u = (2.0 * static_cast<double>(column) + 1.0) * half_edge - 1.0;
    row_angles[column] = row_angles[size - 1 - column] =
        tables::rectangle_solid_angle(u, v, half_edge, half_edge, rule);
  }
}

}  // namespace welkin::codec
