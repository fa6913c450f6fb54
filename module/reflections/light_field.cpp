#include "reflections/light_field.h"

#include <algorithm>

namespace welkin::reflections {
namespace {

constexpr double kFar = 0.92387953251128674;   ///< cos(pi / 8): Chebyshev's points are there and
constexpr double kNear = 0.38268343236508977;  ///< at cos(3 pi / 8), on either side
constexpr std::array<double, LightField::kEdge> kNodes{-kFar, -kNear, kNear, kFar};

/// The centres of texels [first, end) of a face along one axis: their middle and half their extent.
struct Span {
  Span(int first, int end, int size)
      : middle(place_on_face(0.5 * (first + end - 1), size)), half(static_cast<double>(end - first - 1) / size) {}

  /// Sets each point's share of the value at a point t: Lagrange's polynomials of the nodes -kFar, -kNear, kNear and
  /// kFar. That of -kFar is (t^2 - kNear^2) (t - kFar) over (kFar^2 - kNear^2) (-2 kFar), that of -kNear is (t^2 -
  /// kFar^2) (t - kNear) over (kNear^2 - kFar^2) (-2 kNear); the others are their mirror images. Chebyshev's points,
  /// the roots of T_4, keep the largest of (t - x_0) ... (t - x_3) to 2^-3 over the whole span: the cubic's error is
  /// at most 2^-3 / 4! of the fourth derivative in units of half the span.
  template <class Shares>
  void share(double position, std::size_t index, Shares& shares) const noexcept {
    constexpr double kScale = 1.0 / (2.0 * (kFar * kFar - kNear * kNear));
    const double t = half > 0.0 ? (position - middle) / half : 0.0;
    const double outer = (t * t - kNear * kNear) * (kScale / kFar);
    const double inner = (kFar * kFar - t * t) * (kScale / kNear);
    shares[0][index] = static_cast<float>((kFar - t) * outer);
    shares[1][index] = static_cast<float>((kNear - t) * inner);
    shares[2][index] = static_cast<float>((kNear + t) * inner);
    shares[3][index] = static_cast<float>((kFar + t) * outer);
  }

  double middle;
  double half;
};

}  // namespace

double LightField::point(int first, int end, int size, std::size_t k) noexcept {
  const Span span(first, end, size);
  return span.middle + span.half * kNodes[k];
}

/// Interpolates at the products of positions along both axes, to[channel][row][column].
template <std::size_t Points>
void LightField::interpolate(const Shares<Points>& down, const Shares<Points>& across, float* to) const {
  for (std::size_t c = 0; c < 3; ++c) {
    const float* const from = values_.data() + c * kPoints;
    for (std::size_t row = 0; row < Points; ++row, to += Points) {
      std::array<float, kEdge> line{};
      for (std::size_t j = 0; j < kEdge; ++j) {
        for (std::size_t i = 0; i < kEdge; ++i) line[i] += down[j][row] * from[j * kEdge + i];
      }
      for (std::size_t k = 0; k < Points; ++k)
        to[k] = (line[0] * across[0][k] + line[1] * across[1][k]) + (line[2] * across[2][k] + line[3] * across[3][k]);
    }
  }
}

LightField LightField::within(const FaceArea& area, const FaceArea& part) const {
  LightField field;
  if (dark_) return field;
  Shares<kEdge> down{};
  Shares<kEdge> across{};
  const Span rows(area.row, area.end_row, area.size);
  const Span columns(area.column, area.end_column, area.size);
  for (std::size_t k = 0; k < kEdge; ++k) {
    rows.share(point(part.row, part.end_row, area.size, k), k, down);
    columns.share(point(part.column, part.end_column, area.size, k), k, across);
  }
  interpolate(down, across, field.lit().data());
  return field;
}

namespace {

/// Returns each point's share of the values at the centres of `texels` texels.
const auto& texel_shares(int texels) {
  using Shares = std::array<std::array<float, LightField::kMaxWidth>, LightField::kEdge>;
  static const auto kept = [] {
    std::array<Shares, LightField::kMaxWidth + 1> by_texels{};
    for (int count = 1; count <= LightField::kMaxWidth; ++count) {
      const Span span(0, count, count);
      for (int k = 0; k < count; ++k)
        span.share(place_on_face(k, count), static_cast<std::size_t>(k), by_texels[static_cast<std::size_t>(count)]);
    }
    return by_texels;
  }();
  return kept[static_cast<std::size_t>(texels)];
}

}  // namespace

void LightField::write(const FaceArea& area, int count, float* sums) const {
  Shares<kMaxEdge> down{};
  Shares<kMaxEdge> across{};
  for (std::size_t k = 0; k < kEdge; ++k) {
    std::copy_n(texel_shares(area.down())[k].begin(), area.down(), down[k].begin());
    std::copy_n(texel_shares(area.across())[k].begin(), area.across(), across[k].begin());
  }
  std::array<float, std::size_t{3} * kMaxEdge * kMaxEdge> all;
  interpolate(down, across, all.data());
  for (int c = 0; c < 3; ++c) {
    for (int row = 0; row < area.down(); ++row)
      std::copy_n(all.data() + kMaxEdge * (kMaxEdge * c + row), area.across(), sums + c * count + row * area.across());
  }
}

void LightField::add_to(const FaceArea& area, float scale, float* rgb) const {
  const auto& down = texel_shares(area.down());
  const auto& across = texel_shares(area.across());
  const auto wide = static_cast<std::size_t>(area.across());
  std::array<std::array<float, kMaxWidth>, 3> light;
  for (int row = area.row; row < area.end_row; ++row) {
    const auto k = static_cast<std::size_t>(row - area.row);
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const from = values_.data() + c * kPoints;
      std::array<float, kEdge> line{};
      for (std::size_t i = 0; i < kEdge; ++i) {
        line[i] = scale * ((down[0][k] * from[i] + down[1][k] * from[kEdge + i]) +
                           (down[2][k] * from[2 * kEdge + i] + down[3][k] * from[3 * kEdge + i]));
      }
      for (std::size_t j = 0; j < wide; ++j)
        light[c][j] =
            (line[0] * across[0][j] + line[1] * across[1][j]) + (line[2] * across[2][j] + line[3] * across[3][j]);
    }
    float* const texels = rgb + 3 * (std::ptrdiff_t{row} * area.size + area.column);
    for (std::size_t j = 0; j < wide; ++j) {
      for (std::size_t c = 0; c < 3; ++c) texels[3 * j + c] += light[c][j];
    }
  }
}

}  // namespace welkin::reflections
