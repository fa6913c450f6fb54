#include "image/texel_geometry.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tables/solid_angle.h"
#include "tables/texel_weights.h"
#include "tables/trigonometry.h"

namespace welkin::image {
namespace {

constexpr std::array<Frame, 6> kFaces{{
    {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}},
    {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
    {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
}};

}  // namespace

const Frame& face_frame(int face) noexcept { return kFaces[static_cast<std::size_t>(face)]; }

glm::dvec3 face_direction(int size, int face, double column, double row) noexcept {
  const Frame& frame = face_frame(face);
  const double u = 2.0 * column / size - 1.0;
  const double v = 2.0 * row / size - 1.0;
  return (frame.normal + u * frame.u + v * frame.v) / std::sqrt(1.0 + u * u + v * v);
}

glm::dvec3 lat_long_direction(int width, int height, double column, double row) noexcept {
  const tables::SineCosine latitude = tables::sine_cosine_of_turns(0.25 - row / (2.0 * height));
  const tables::SineCosine longitude = tables::sine_cosine_of_turns(0.5 - column / width);
  return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
}

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

}  // namespace welkin::image
