#include "reflections/sampled.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"

namespace welkin::reflections {
namespace {

constexpr std::int64_t kTileTaps = 8192;  ///< texels times taps: some 0.3 ms

void sample_texel(const PaddedCube& source, const std::vector<Tap>& taps, const glm::dvec3& normal, float* rgb) {
  // Any two axes across it will do.
  const glm::dvec3 up = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(up, normal));
  const glm::vec3 x(across);
  const glm::vec3 y(glm::cross(normal, across));
  const glm::vec3 z(normal);
  float sum[4] = {};
  for (const Tap& tap : taps) {
    source.add({tap.x * x.x + tap.y * y.x + tap.z * z.x, tap.x * x.y + tap.y * y.y + tap.z * z.y,
                tap.x * x.z + tap.y * y.z + tap.z * z.z},
               tap.level, tap.weight, sum);
  }
  std::copy_n(sum, 3, rgb);
}

}  // namespace

void sample_mip(const PaddedCube& source, const std::vector<Tap>& taps, int size, const std::array<float*, 6>& faces,
                const Control& control) {
  const std::int64_t texels = std::int64_t{6} * size * size;
  const auto taps_in_all = texels * static_cast<std::int64_t>(taps.size());
  const std::int64_t per_tile = std::clamp<std::int64_t>(kTileTaps / static_cast<std::int64_t>(taps.size()), 1, texels);
  const auto placement = jobs::placement_for(taps_in_all * 50);
  jobs::run_tiles(static_cast<std::size_t>((texels + per_tile - 1) / per_tile), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t /*worker*/) {
                    const std::int64_t first = static_cast<std::int64_t>(tile) * per_tile;
                    for (std::int64_t texel = first; texel < std::min(texels, first + per_tile); ++texel) {
                      const auto face = static_cast<int>(texel / (std::int64_t{size} * size));
                      const auto place = static_cast<int>(texel % (std::int64_t{size} * size));
                      const int row = place / size;
                      const glm::dvec3 normal = image::face_direction(size, face, place % size + 0.5, row + 0.5);
                      sample_texel(source, taps, normal,
                                   faces[static_cast<std::size_t>(face)] + std::ptrdiff_t{3} * place);
                    }
                  });
}

namespace {

constexpr double kPi = std::numbers::pi;

/// The bits of `i` mirrored about the point: van der Corput's sequence.
double radical_inverse(std::uint32_t i) noexcept {
  std::uint32_t mirrored = 0;
  for (int bit = 0; bit < 32; ++bit) mirrored |= ((i >> bit) & 1U) << (31 - bit);
  return mirrored * 0x1p-32;
}

}  // namespace

std::vector<Tap> make_taps(double alpha, int samples, int level_size, int levels) {
  const double square = alpha * alpha;
  const double texel = 4.0 * kPi / (6.0 * level_size * level_size);
  std::vector<Tap> taps;
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double share = (i + 0.5) / samples;
    const double denominator = 1.0 + (square - 1.0) * share;
    const double cosine_squared = (1.0 - share) / denominator;  // of the half vector
    const double cosine = 2.0 * cosine_squared - 1.0;
    if (!(cosine > 0.0)) continue;
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const math::SineCosine turn = math::sine_cosine_of_turns(radical_inverse(static_cast<std::uint32_t>(i)));
    const double lobe = cosine_squared * (square - 1.0) + 1.0;
    const double density = square / (kPi * lobe * lobe) / 4.0;
    const double level = 0.5 * math::logarithm(1.0 / (samples * density * texel)) / std::numbers::ln2 + 1.0;
    taps.push_back({static_cast<float>(sine * turn.cosine), static_cast<float>(sine * turn.sine),
                    static_cast<float>(cosine), static_cast<float>(cosine),
                    static_cast<float>(std::clamp(level, 0.0, levels - 1.0))});
    sum += cosine;
  }
  if (taps.empty()) taps.push_back({0.0F, 0.0F, 1.0F, 1.0F, 0.0F});
  if (sum > 0.0) {
    for (Tap& tap : taps) tap.weight = static_cast<float>(static_cast<double>(tap.weight) / sum);
  }
  return taps;
}

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
    levels_.push_back({size, platform::AlignedBuffer<float>(6 * edge * edge * 4)});
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

}  // namespace welkin::reflections
