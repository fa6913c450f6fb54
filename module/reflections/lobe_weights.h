// The weights of one texel of a blurred mip: see `LobeTable`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "image/geometry.h"
#include "math/quadrature.h"
#include "reflections/cube_levels.h"

namespace welkin::reflections {

/// A lobe about some directions, as weights of the points of a cubemap's levels.
class LobeWeights {
 public:
  struct Weight {
    std::uint32_t level;
    std::uint32_t point;
    double value;  ///< of light
  };

  LobeWeights(const std::vector<CubeLevel>& levels, double alpha);

  /// The weights about a direction; even light of 1 gives 1. Valid until the next call.
  const std::vector<Weight>& about(const glm::dvec3& direction);

  /// What the last weights err by: of each texel's radiance, the weight less the lobe's integral. Valid until the next
  /// call.
  const std::vector<double>& errors();

 private:
  struct Level {
    CubeLevel shape;
    std::vector<glm::dvec3> places;  ///< unit directions of the points
    std::vector<double> shrunk;      ///< of a face: square of how near its points lie to each other, over the middle's
    std::vector<float> light;        ///< of even radiance of 1, of a face
    std::vector<double> values;      ///< of what the weights stand for, where `known` says so
    std::vector<std::uint32_t> known;  ///< the call that found it
    double step = 0.0;                 ///< from a point to the next one, in the face's plane
    double fourth = 0.0;               ///< share of fourth differences that is added to the lobe
    double open = 0.0;                 ///< points with less than this of 2 (1 - cosine) are left to finer levels
    double strip = 0.0;                ///< points nearer to the horizon than that are near to its cut
  };

  void place_points();
  void spread_even_light();
  void choose_levels();
  [[nodiscard]] bool is_open(const Level& level, std::size_t point) const;
  [[nodiscard]] bool is_cut(const Level& level, std::size_t point) const;
  [[nodiscard]] double lobe_over(std::size_t which, std::size_t point) const;
  [[nodiscard]] double lobe_at(const image::Frame& frame, double u, double v) const;
  [[nodiscard]] double wanted(std::size_t which, std::size_t point) const;
  [[nodiscard]] double value(std::size_t which, std::size_t point);
  [[nodiscard]] double interpolated(std::size_t which, std::size_t point);
  void start(std::vector<std::uint32_t>& open);
  void refine(std::size_t which, const std::vector<std::uint32_t>& parents, std::vector<std::uint32_t>& open);
  void add(std::size_t which, std::size_t point, double value);

  double alpha_;
  double scale_ = 0.0;         ///< 1 over the lobe's integral
  double width_square_ = 0.0;  ///< of the lobe, as 2 (1 - cosine)
  double kink_ = 0.0;          ///< the lobe's slope at the horizon
  double smooth_ = 0.0;        ///< the lobe's factor: see `lobe_at`
  std::vector<Level> levels_;
  std::size_t top_ = 0;  ///< the coarsest level that is used
  glm::dvec3 direction_{};
  std::uint32_t call_ = 0;
  double even_ = 1.0;
  math::GaussRule rule_;
  std::vector<std::uint32_t> open_, next_open_;
  std::vector<Weight> weights_;
  std::vector<double> errors_;
};

}  // namespace welkin::reflections
