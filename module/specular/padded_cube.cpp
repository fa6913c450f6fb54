#include "specular/padded_cube.h"

#include <algorithm>
#include <cmath>

#include "image/cube_texels.h"

namespace welkin::specular {
namespace {

/// Which components of a direction run along u and v, and their signs, as `CubemapView` has them.
struct Axes {
  int normal, u, v;
  float u_sign, v_sign;
};
constexpr std::array<Axes, 6> kAxes{{{0, 2, 1, -1.0F, -1.0F},
                                     {0, 2, 1, 1.0F, -1.0F},
                                     {1, 0, 2, 1.0F, 1.0F},
                                     {1, 0, 2, 1.0F, -1.0F},
                                     {2, 0, 1, 1.0F, -1.0F},
                                     {2, 0, 1, -1.0F, -1.0F}}};

}  // namespace

PaddedCube::PaddedCube(const CubemapChain& chain) {
  for (int level = 0; level < chain.levels(); ++level) {
    const int size = chain.level_size(level);
    const auto edge = static_cast<std::size_t>(size + 2);
    levels_.push_back({size, tables::AlignedBuffer<float>(6 * edge * edge * 4)});
    levels_.back().fill(chain, level);
  }
}

std::size_t PaddedCube::bytes() const noexcept {
  std::size_t bytes = 0;
  for (const Level& level : levels_) bytes += level.texels.bytes();
  return bytes;
}

void PaddedCube::Level::fill(const CubemapChain& chain, int level) {
  const auto put = [&](float* to, int face, int column, int row) {
    std::copy_n(chain.face(level, face) + 3 * (static_cast<std::ptrdiff_t>(row) * size + column), 3, to);
    to[3] = 0.0F;
  };
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) put(texel(face, column, row), face, column, row);
    }
    for (int i = 0; i < size; ++i) {
      for (const auto& [column, row] : {std::array{-1, i}, {size, i}, {i, -1}, {i, size}}) {
        const image::CubeTexel other = image::across_edge(size, {face, column, row});
        put(texel(face, column, row), other.face, other.column, other.row);
      }
    }
    for (const int column : {-1, size}) {
      for (const int row : {-1, size}) fill_corner(face, column, row);
    }
  }
}

void PaddedCube::Level::fill_corner(int face, int column, int row) {
  const int inner_column = column < 0 ? 0 : size - 1;
  const int inner_row = row < 0 ? 0 : size - 1;
  for (int c = 0; c < 4; ++c) {
    const float sum =
        texel(face, inner_column, inner_row)[c] + texel(face, column, inner_row)[c] + texel(face, inner_column, row)[c];
    texel(face, column, row)[c] = sum / 3.0F;
  }
}

void PaddedCube::Level::add(int face, float u, float v, float weight, float* sum) const noexcept {
  const auto edge = static_cast<float>(size);
  const float column = std::clamp((u + 1.0F) * 0.5F * edge - 0.5F, -0.5F, edge - 0.5F);
  const float row = std::clamp((v + 1.0F) * 0.5F * edge - 0.5F, -0.5F, edge - 0.5F);
  const int left = static_cast<int>(column + 1.0F) - 1;
  const int top = static_cast<int>(row + 1.0F) - 1;
  const float right_share = column - static_cast<float>(left);
  const float bottom_share = row - static_cast<float>(top);
  const float* const above = texel(face, left, top);
  const float* const below = above + 4 * (size + 2);
  const float bottom = weight * bottom_share;
  const float top_weight = weight - bottom;
  const float top_right = top_weight * right_share;
  const float bottom_right = bottom * right_share;
  for (int c = 0; c < 4; ++c) {
    sum[c] += (top_weight - top_right) * above[c] + top_right * above[4 + c] + (bottom - bottom_right) * below[c] +
              bottom_right * below[4 + c];
  }
}

void PaddedCube::add(const std::array<float, 3>& d, float level, float weight, float* sum) const noexcept {
  const float x = std::abs(d[0]);
  const float y = std::abs(d[1]);
  const float z = std::abs(d[2]);
  int face = x >= y && x >= z ? 0 : (y >= z ? 2 : 4);
  if (d[static_cast<std::size_t>(face / 2)] < 0.0F) ++face;
  const Axes& axes = kAxes[static_cast<std::size_t>(face)];
  const float inverse = 1.0F / std::abs(d[static_cast<std::size_t>(axes.normal)]);
  const float u = axes.u_sign * d[static_cast<std::size_t>(axes.u)] * inverse;
  const float v = axes.v_sign * d[static_cast<std::size_t>(axes.v)] * inverse;
  const int fine = static_cast<int>(level);
  const float share = level - static_cast<float>(fine);
  levels_[static_cast<std::size_t>(fine)].add(face, u, v, weight * (1.0F - share), sum);
  if (share > 0.0F) levels_[static_cast<std::size_t>(fine) + 1].add(face, u, v, weight * share, sum);
}

}  // namespace welkin::specular
