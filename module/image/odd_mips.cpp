#include "image/odd_mips.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tables/trigonometry.h"

namespace welkin::image {
namespace {

/// The solid angle of the rectangle from the middle of a face to (u, v): atan(u v / sqrt(1 + u^2 + v^2)).
double corner_solid_angle(double u, double v) noexcept {
  const double angle = tables::turns_of(std::abs(u * v), std::sqrt(1.0 + u * u + v * v)) * 2.0 * std::numbers::pi;
  return u * v < 0.0 ? -angle : angle;
}

/// Where texel `index` of m is cut by the edges of 2 m + 1 texels, in those texels: its ends and the edges between.
std::array<double, 4> cuts(int index, int half) noexcept {
  const double share = static_cast<double>(index) / half;  // how far the texels below have got ahead
  return {2.0 * index + share, 2.0 * index + 1.0, 2.0 * index + 2.0, 2.0 * (index + 1) + share + 1.0 / half};
}

}  // namespace

OddMipRow::OddMipRow(int size, MipFilter filter)
    : size_(size), filter_(filter), parts_(static_cast<std::size_t>(size / 2)) {}

// Texel i covers from i (2 + 1/m) to (i + 1) (2 + 1/m): of texel 2 i the part 1 - i/m, all of 2 i + 1, and (i + 1)/m of
// texel 2 i + 2.
void OddMipRow::place(int row) noexcept {
  row_ = row;
  const int half = size_ / 2;
  const auto place_of = [&](double cut) { return 2.0 * cut / size_ - 1.0; };
  const std::array<double, 4> rows = cuts(row, half);
  for (int column = 0; column < half; ++column) {
    std::array<double, 9>& parts = parts_[static_cast<std::size_t>(column)];
    const std::array<double, 4> columns = cuts(column, half);
    double sum = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = 0; i < 3; ++i) {
        double part = (columns[i + 1] - columns[i]) * (rows[j + 1] - rows[j]);
        if (filter_ == MipFilter::solid_angle) {
          const auto corner = [&](std::size_t a, std::size_t b) {
            return corner_solid_angle(place_of(columns[a]), place_of(rows[b]));
          };
          part = std::max(0.0, (corner(i + 1, j + 1) - corner(i, j + 1)) - (corner(i + 1, j) - corner(i, j)));
        }
        parts[3 * j + i] = part;
        sum += part;
      }
    }
    for (double& part : parts) part /= sum;
  }
}

void OddMipRow::reduce(const float* face, float* rgb) const noexcept {
  const auto stride = static_cast<std::size_t>(3 * size_);
  for (std::size_t column = 0; column < parts_.size(); ++column) {
    const std::array<double, 9>& parts = parts_[column];
    const float* const first = face + 2 * static_cast<std::size_t>(row_) * stride + 6 * column;
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          sum += parts[3 * j + i] * static_cast<double>(first[j * stride + 3 * i + c]);
        }
      }
      rgb[3 * column + c] = static_cast<float>(sum);
    }
  }
}

}  // namespace welkin::image
