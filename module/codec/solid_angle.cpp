#include "codec/solid_angle.h"

#include <array>
#include <cmath>
#include <numbers>

namespace welkin::codec {
namespace {

struct GaussRule {
  int count;
  std::array<double, 4> nodes;    // on [-1, 1]
  std::array<double, 4> weights;  // they sum to 2
};

// Gauss-Legendre rules (Abramowitz and Stegun, table 25.4).
constexpr GaussRule kTwo{2, {-0.57735026918962576, 0.57735026918962576}, {1.0, 1.0}};
constexpr GaussRule kFour{4,
                          {-0.86113631159405258, -0.33998104358485626, 0.33998104358485626, 0.86113631159405258},
                          {0.34785484513745386, 0.65214515486254614, 0.65214515486254614, 0.34785484513745386}};

// A texel of edge h = 2 / size leaves an n-point rule a relative error of some (h/2)^(2n): where two points
// reach 1e-12, four would only cost.
const GaussRule& rule_for(std::size_t size) {
  constexpr std::size_t kFineSize = 1024;
  return size >= kFineSize ? kTwo : kFour;
}

// The integral of (1 + u^2 + v^2)^(-3/2), the solid angle of an area element on the plane at distance 1, over
// a texel. As a sum of positive terms nothing cancels, unlike in the closed form's four arctangents.
double texel_solid_angle(const GaussRule& rule, double u, double v, double half_edge) {
  double sum = 0.0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(rule.count); ++j) {
    const double y = v + half_edge * rule.nodes[j];
    for (std::size_t i = 0; i < static_cast<std::size_t>(rule.count); ++i) {
      const double x = u + half_edge * rule.nodes[i];
      const double r2 = 1.0 + x * x + y * y;
      sum += rule.weights[i] * rule.weights[j] / (r2 * std::sqrt(r2));
    }
  }
  return sum * half_edge * half_edge;
}

// A face of one or two texels is too coarse for one rule a texel.
double subdivided_solid_angle(double u, double v, double half_edge) {
  constexpr int kParts = 16;
  const double part = half_edge / kParts;
  double sum = 0.0;
  for (int j = 0; j < kParts; ++j) {
    for (int i = 0; i < kParts; ++i) {
      sum += texel_solid_angle(kFour, u + part * (2 * i + 1 - kParts), v + part * (2 * j + 1 - kParts), part);
    }
  }
  return sum;
}

}  // namespace

// The integral of cos(latitude) over the texel is 2 pi / width (sin(top) - sin(bottom)); with the row's
// polar angle theta at its centre that difference is the product 2 sin(theta) sin(pi / (2 height)).
double lat_long_texel_solid_angle(int width, int height, int row) {
  constexpr double kPi = std::numbers::pi;
  const double theta = kPi * (row + 0.5) / height;
  return 2.0 * kPi / width * 2.0 * std::sin(theta) * std::sin(0.5 * kPi / height);
}

void cubemap_row_solid_angles(int row, std::span<double> row_angles) {
  constexpr std::size_t kCoarseSize = 32;
  const std::size_t size = row_angles.size();
  const GaussRule& rule = rule_for(size);
  const double half_edge = 1.0 / static_cast<double>(size);
  const double v = (2.0 * row + 1.0) * half_edge - 1.0;
  for (std::size_t column = 0; column < (size + 1) / 2; ++column) {
    const double u = (2.0 * static_cast<double>(column) + 1.0) * half_edge - 1.0;
    const double angle =
        size < kCoarseSize ? subdivided_solid_angle(u, v, half_edge) : texel_solid_angle(rule, u, v, half_edge);
    row_angles[column] = row_angles[size - 1 - column] = angle;
  }
}

}  // namespace welkin::codec
