#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "perf/report/passes.h"
#include "welkin/resampling.h"

namespace welkin::report {
namespace {

constexpr double kPi = std::numbers::pi;

/// A level of the source's mips with one additional texel beyond each edge of each face: the neighbouring face's, at a
/// corner the mean of the three that meet there. Bilinear lookups then need no other face.
class PaddedLevel {
 public:
  PaddedLevel(const Cubemap& chain, int level)
      : size_(chain.level_size(level)), texels_(6 * static_cast<std::size_t>((size_ + 2) * (size_ + 2))) {
    for (int face = 0; face < 6; ++face) {
      const float* from = chain.face(level, face);
      for (int row = 0; row < size_; ++row) {
        for (int column = 0; column < size_; ++column, from += 3) at(face, column, row) = {from[0], from[1], from[2]};
      }
    }
    for (int face = 0; face < 6; ++face) {
      for (int i = 0; i < size_; ++i) {
        for (const auto& [column, row] : {std::array{-1, i}, {size_, i}, {i, -1}, {i, size_}}) {
          const image::CubeTexel other = image::across_edge(size_, {face, column, row});
          at(face, column, row) = at(other.face, other.column, other.row);
        }
      }
      for (const int column : {-1, size_}) {
        for (const int row : {-1, size_}) {
          const int inner_column = std::clamp(column, 0, size_ - 1);
          const int inner_row = std::clamp(row, 0, size_ - 1);
          at(face, column, row) =
              (at(face, inner_column, inner_row) + at(face, column, inner_row) + at(face, inner_column, row)) / 3.0F;
        }
      }
    }
  }

  /// Returns the bilinear value. `u` and `v`: -1 to 1 along the face's rows and columns.
  [[nodiscard]] glm::vec3 bilinear(int face, float u, float v) const {
    const float x = texels_along(u);
    const float y = texels_along(v);
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const float right = x - static_cast<float>(column);
    const float below = y - static_cast<float>(row);
    const glm::vec3* const upper = &texels_[index(face, column - 1, row - 1)];
    const glm::vec3* const lower = upper + size_ + 2;
    return (1.0F - below) * ((1.0F - right) * upper[0] + right * upper[1]) +
           below * ((1.0F - right) * lower[0] + right * lower[1]);
  }

 private:
  [[nodiscard]] std::size_t index(int face, int column, int row) const {
    return static_cast<std::size_t>((face * (size_ + 2) + row + 1) * (size_ + 2) + column + 1);
  }
  [[nodiscard]] glm::vec3& at(int face, int column, int row) { return texels_[index(face, column, row)]; }
  /// Returns positions from 0.5, the edge, half a texel before the first centre, to size + 0.5.
  [[nodiscard]] float texels_along(float u) const {
    const auto size = static_cast<float>(size_);
    return std::clamp((u + 1.0F) * 0.5F * size + 0.5F, 0.5F, size + 0.5F);
  }

  int size_;
  std::vector<glm::vec3> texels_;
};

/// One sample in the frame whose z axis is the texel's direction.
struct Tap {
  glm::vec3 direction;
  float weight;  ///< the list's weights add up to 1
  float level;   ///< of the source's mips
};

/// Returns an element of van der Corput's sequence.
double radical_inverse(std::uint32_t i) {
  std::uint32_t mirrored = 0;
  for (int bit = 0; bit < 32; ++bit) mirrored |= ((i >> bit) & 1U) << (31 - bit);
  return mirrored * 0x1p-32;
}

/// Returns taps of half vectors by GGX's distribution at a Hammersley set, reflected; directions below the horizon are
/// left out. A texel of the level covers four times the solid angle of the tap, 1 / (samples pdf), pdf = D / 4.
std::vector<Tap> taps_of(double alpha, int samples, int level_size, int levels) {
  const double square = alpha * alpha;
  const double texel = 4.0 * kPi / (6.0 * level_size * level_size);
  std::vector<Tap> taps;
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double share = (i + 0.5) / samples;
    const double cosine_squared = (1.0 - share) / (1.0 + (square - 1.0) * share);  // of the half vector
    const double cosine = 2.0 * cosine_squared - 1.0;
    if (!(cosine > 0.0)) continue;
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const math::SineCosine turn = math::sine_cosine_of_turns(radical_inverse(static_cast<std::uint32_t>(i)));
    const double lobe = cosine_squared * (square - 1.0) + 1.0;
    const double density = square / (kPi * lobe * lobe) / 4.0;
    const double level = 0.5 * math::logarithm(1.0 / (samples * density * texel)) / std::numbers::ln2 + 1.0;
    taps.push_back({glm::vec3(sine * turn.cosine, sine * turn.sine, cosine), static_cast<float>(cosine),
                    static_cast<float>(std::clamp(level, 0.0, levels - 1.0))});
    sum += cosine;
  }
  if (taps.empty()) return {{{0.0F, 0.0F, 1.0F}, 1.0F, 0.0F}};
  for (Tap& tap : taps) tap.weight = static_cast<float>(static_cast<double>(tap.weight) / sum);
  return taps;
}

glm::vec3 sum_of_taps(const std::vector<PaddedLevel>& source, const std::vector<Tap>& taps, const glm::dvec3& normal) {
  const glm::dvec3 up = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(up, normal));
  const glm::vec3 x(across);
  const glm::vec3 y(glm::cross(normal, across));
  const glm::vec3 z(normal);
  glm::vec3 sum(0.0F);
  for (const Tap& tap : taps) {
    const glm::dvec3 direction(tap.direction.x * x + tap.direction.y * y + tap.direction.z * z);
    const int face = image::face_of(direction);
    const image::Frame& frame = image::face_frame(face);
    const double depth = glm::dot(direction, frame.normal);
    const auto u = static_cast<float>(glm::dot(direction, frame.u) / depth);
    const auto v = static_cast<float>(glm::dot(direction, frame.v) / depth);
    const auto level = static_cast<std::size_t>(tap.level);
    const float share = tap.level - static_cast<float>(level);
    glm::vec3 value = (1.0F - share) * source[level].bilinear(face, u, v);
    if (share > 0.0F) value += share * source[level + 1].bilinear(face, u, v);
    sum += tap.weight * value;
  }
  return sum;
}

}  // namespace

Cubemap importance_sampled(const LatLongView& source, int size, const std::vector<double>& roughness, int samples) {
  const Cubemap plain = build_mips(to_cubemap(source, size, glm::dmat3(1.0), ResampleFilter::area).view());
  std::vector<PaddedLevel> levels;
  levels.reserve(static_cast<std::size_t>(plain.levels()));
  for (int level = 0; level < plain.levels(); ++level) levels.emplace_back(plain, level);
  Cubemap result(size, static_cast<int>(roughness.size()));
  for (int level = 0; level < result.levels(); ++level) {
    const int edge = result.level_size(level);
    const double alpha = roughness[static_cast<std::size_t>(level)] * roughness[static_cast<std::size_t>(level)];
    if (alpha == 0.0) {
      std::copy_n(plain.face(level, 0), 18 * edge * edge, result.face(level, 0));
      continue;
    }
    const std::vector<Tap> taps = taps_of(alpha, samples, size, plain.levels());
    jobs::run_tiles(6 * static_cast<std::size_t>(edge), jobs::Placement::arena,
                    jobs::worker_count(jobs::Placement::arena), {}, [&](std::size_t tile, std::size_t /*worker*/) {
                      const int face = static_cast<int>(tile) / edge;
                      const int row = static_cast<int>(tile) % edge;
                      float* to = result.face(level, face) + std::ptrdiff_t{3} * row * edge;
                      for (int column = 0; column < edge; ++column, to += 3) {
                        const glm::vec3 sum =
                            sum_of_taps(levels, taps, image::face_direction(edge, face, column + 0.5, row + 0.5));
                        for (int c = 0; c < 3; ++c) to[c] = sum[c];
                      }
                    });
  }
  return result;
}

}  // namespace welkin::report
