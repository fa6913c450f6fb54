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
#include "reflections/sampled_kernels.h"

namespace welkin::reflections {
namespace {

constexpr std::int64_t kTileTaps = 65536;  ///< texels times taps: some 0.3 ms

/// Puts a tap into lane `lane` of a group: its weight is divided between the two levels that it lies between.
void put_tap(const PaddedCube& source, const Tap& tap, std::size_t lane, TapGroup& group) {
  group.x[lane] = tap.x;
  group.y[lane] = tap.y;
  group.z[lane] = tap.z;
  const int below = static_cast<int>(tap.level);
  const float share = tap.level - static_cast<float>(below);
  const int above = share > 0.0F ? below + 1 : below;
  const float further = tap.weight * share;
  const auto read = [&source, lane](TapLevel& level, int which, float weight) {
    level.texels[lane] = source.texels(which);
    level.size[lane] = static_cast<float>(source.size(which));
    level.weight[lane] = weight;
  };
  read(group.fine, below, tap.weight - further);
  read(group.coarse, above, further);
  group.two_levels = group.two_levels || further != 0.0F;
}

std::vector<TapGroup> grouped(const PaddedCube& source, const std::vector<Tap>& taps) {
  constexpr std::size_t lanes = simd::kLanes;
  std::vector<TapGroup> groups((taps.size() + lanes - 1) / lanes);
  for (std::size_t i = 0; i < lanes * groups.size(); ++i) {
    Tap tap = taps[std::min(i, taps.size() - 1)];
    if (i >= taps.size()) tap.weight = 0.0F;
    put_tap(source, tap, i % lanes, groups[i / lanes]);
  }
  return groups;
}

TapFrame frame_about(const glm::dvec3& normal) {
  // Any two axes across it will do.
  const glm::dvec3 up = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(up, normal));
  const glm::vec3 x(across);
  const glm::vec3 y(glm::cross(normal, across));
  const glm::vec3 z(normal);
  return {{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}};
}

}  // namespace

void sample_mip(const PaddedCube& source, const std::vector<Tap>& taps, int size, const std::array<float*, 6>& faces,
                const Control& control) {
  const std::vector<TapGroup> groups = grouped(source, taps);
  const SumTaps sum_taps = sampled_kernels().sum_taps;
  const std::int64_t texels = std::int64_t{6} * size * size;
  const auto taps_in_all = texels * static_cast<std::int64_t>(taps.size());
  const std::int64_t per_tile = std::clamp<std::int64_t>(kTileTaps / static_cast<std::int64_t>(taps.size()), 1, texels);
  const auto placement = jobs::placement_for(taps_in_all * 15);
  jobs::run_tiles(static_cast<std::size_t>((texels + per_tile - 1) / per_tile), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t /*worker*/) {
                    const std::int64_t first = static_cast<std::int64_t>(tile) * per_tile;
                    for (std::int64_t texel = first; texel < std::min(texels, first + per_tile); ++texel) {
                      const auto face = static_cast<int>(texel / (std::int64_t{size} * size));
                      const auto place = static_cast<int>(texel % (std::int64_t{size} * size));
                      const int row = place / size;
                      const glm::dvec3 normal = image::face_direction(size, face, place % size + 0.5, row + 0.5);
                      sum_taps(groups.data(), static_cast<int>(groups.size()), frame_about(normal),
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

}  // namespace welkin::reflections
