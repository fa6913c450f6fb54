// Texels as lights: their positions, points that stand for them and parts that the horizon cuts.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "image/geometry.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "platform/standard_library.h"
#include "reflections/bright_lights.h"

namespace welkin::reflections {

/// Directions of an image's points. A tree needs the same rows and columns repeatedly: sines of the latest are kept.
class Directions {
 public:
  explicit Directions(const ImageShape& shape) : shape_(shape), kept_(shape.cubemap ? 0 : kKept) {}

  [[nodiscard]] const ImageShape& shape() const noexcept { return shape_; }
  [[nodiscard]] glm::dvec3 at(int face, double column, double row) {
    if (shape_.cubemap) return image::face_direction(shape_.columns, face, column, row);
    const math::SineCosine latitude = of_turns(0.25 - row / (2.0 * shape_.rows));
    const math::SineCosine longitude = of_turns(0.5 - column / shape_.columns);
    return {longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine};
  }
  /// Solid angle a texel there, but for a constant.
  [[nodiscard]] double density_at(double column, double row) {
    if (!shape_.cubemap) return of_turns(row / (2.0 * shape_.rows)).sine;
    const double u = 2.0 * column / shape_.columns - 1.0;
    const double v = 2.0 * row / shape_.columns - 1.0;
    const double square = 1.0 + u * u + v * v;
    return 1.0 / (square * std::sqrt(square));
  }
  [[nodiscard]] math::SineCosine of_turns(double turns) {
    const auto bits = platform::bit_cast<std::uint64_t>(turns);
    Kept& kept = kept_[static_cast<std::size_t>((bits * 0x9E3779B97F4A7C15U) >> (64 - kKeptBits))];
    if (kept.bits != bits) kept = {bits, math::sine_cosine_of_turns(turns)};
    return kept.of;
  }

 private:
  static constexpr int kKeptBits = 10;
  static constexpr std::size_t kKept = std::size_t{1} << kKeptBits;
  struct Kept {
    std::uint64_t bits = ~std::uint64_t{0};  // of no number
    math::SineCosine of{};
  };

  ImageShape shape_;
  std::vector<Kept> kept_;
};

/// Light at a position of the image.
struct Sample {
  int face = 0;
  double column = 0.0;
  double row = 0.0;
  glm::dvec3 light{0.0};
};
using Samples = std::vector<Sample, platform::WorkingAllocator<Sample>>;

/// Returns the same light on an image with `cuts` times as many rows and columns.
[[nodiscard]] std::vector<BrightTexel> cut_texels(const std::vector<BrightTexel>& texels, const ImageShape& shape,
                                                  int cuts);

/// Adds Gauss points on a texel, `count` x `count` of them.
void add_points(const BrightTexel& texel, Directions& directions, int count, Samples& samples);

/// Adds `count` x `count` equal parts of a texel.
void add_parts(const BrightTexel& texel, Directions& directions, int count, LightsOf use, Samples& samples);

[[nodiscard]] LobeLight light_of(Directions& directions, const Sample& sample);

/// Returns one of `parts` along a texel's edge.
[[nodiscard]] CutLight cut_light_of(Directions& directions, const Sample& sample, int parts, LightsOf use);

}  // namespace welkin::reflections
