#include "welkin/octahedral.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <string>

#include "harmonics/octahedral_border.h"
#include "image/pixels.h"
#include "image/resampling.h"
#include "jobs/tiles.h"
#include "math/direction.h"
#include "platform/float_environment.h"
#include "welkin/image.h"

namespace welkin {
namespace {

/// On the octahedron |x| + |y| + |z| = 1; `x`, `y` from -1 to 1.
dvec3 point_on_octahedron(double x, double y) noexcept {
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) return {x, y, z};
  return {std::copysign(1.0 - std::abs(y), x), std::copysign(1.0 - std::abs(x), y), z};
}

struct Place {
  double x;
  double y;
};

/// From beyond an edge back into the square from -1 to 1: over the edge, and turned along it.
Place folded(double x, double y) noexcept {
  if (std::abs(x) > 1.0) {
    x = (x > 0.0 ? 2.0 : -2.0) - x;
    y = -y;
  }
  if (std::abs(y) > 1.0) {
    y = (y > 0.0 ? 2.0 : -2.0) - y;
    x = -x;
  }
  return {x, y};
}

/// Inside and beyond the borders of one level.
struct Square {
  int size;
  int border;

  [[nodiscard]] int inner() const noexcept { return size - 2 * border; }
};

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what); }

int border_of(const OctahedralOptions& options) {
  return options.border > 0 ? options.border : 1 << (options.levels - 1);
}

/// Throws `Error` (invalid_argument).
void check_options(const OctahedralOptions& options, int most_levels) {
  image::require_range("size of an octahedral map", options.size, 1, image::kLargestFace);
  image::require_range("levels of an octahedral map", options.levels, 1, most_levels);
  const int step = 1 << (options.levels - 1);
  if (options.border < 0) refuse("border is " + std::to_string(options.border) + "; it must be 0 or above");
  const int border = border_of(options);
  if (options.size % step != 0 || border % step != 0) {
    refuse("an octahedral map of " + std::to_string(options.size) + " texels with a border of " +
           std::to_string(border) + " has no whole texels at level " + std::to_string(options.levels - 1) +
           "; both must be multiples of " + std::to_string(step));
  }
  if (options.size <= 2 * border) {
    refuse("an octahedral map of " + std::to_string(options.size) + " texels has no room inside borders of " +
           std::to_string(border));
  }
}

/// Inner texels by `texel(column, row)`, counted from 0 inside the border; then the border.
template <class Texel>
std::vector<float> make_level(const Square& square, const Control& control, const Texel& texel) {
  const auto edge = static_cast<std::size_t>(square.size);
  std::vector<float> pixels(3 * edge * edge);
  const auto at = [&](int column, int row) {
    return pixels.data() + 3 * (static_cast<std::size_t>(row + square.border) * edge +
                                static_cast<std::size_t>(column + square.border));
  };
  const int inner = square.inner();
  const auto placement = jobs::placement_for(std::int64_t{inner} * inner);
  jobs::run_tiles(static_cast<std::size_t>(inner), placement, jobs::worker_count(placement), control,
                  [&](std::size_t row, std::size_t /*worker*/) {
                    for (int column = 0; column < inner; ++column) {
                      const dvec3 rgb = texel(column, static_cast<int>(row));
                      for (int c = 0; c < 3; ++c) at(column, static_cast<int>(row))[c] = static_cast<float>(rgb[c]);
                    }
                  });
  for (int row = -square.border; row < inner + square.border; ++row) {
    for (int column = -square.border; column < inner + square.border; ++column) {
      int from_column = column;
      int from_row = row;
      octahedral::move_inside(inner, from_column, from_row);
      if (from_column != column || from_row != row) std::copy_n(at(from_column, from_row), 3, at(column, row));
    }
  }
  return pixels;
}

/// The mean over an inner texel of `samples` x `samples` places.
dvec3 mean_of_texel(const image::CubemapSampler& source, int inner, int column, int row, int samples) {
  dvec3 sum(0.0);
  double whole = 0.0;
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const double x = 2.0 * (column + (i + 0.5) / samples) / inner - 1.0;
      const double y = 2.0 * (row + (j + 0.5) / samples) / inner - 1.0;
      const dvec3 point = point_on_octahedron(x, y);
      const double square = glm::dot(point, point);
      const double weight = 1.0 / (square * std::sqrt(square));  // steradians an area of the octahedron
      source.add(point, weight, sum);
      whole += weight;
    }
  }
  return sum / whole;
}

}  // namespace

std::array<double, 2> octahedral_place(const dvec3& direction) {
  const platform::FloatingPointScope floating_point;
  const dvec3 towards = math::moderate_direction(direction, "direction");
  const double sum = std::abs(towards.x) + std::abs(towards.y) + std::abs(towards.z);
  const double x = towards.x / sum;
  const double y = towards.y / sum;
  if (towards.z >= 0.0) return {0.5 * x + 0.5, 0.5 * y + 0.5};
  return {0.5 * std::copysign(1.0 - std::abs(y), x) + 0.5, 0.5 * std::copysign(1.0 - std::abs(x), y) + 0.5};
}

dvec3 octahedral_direction(double column, double row) noexcept {
  const platform::FloatingPointScope floating_point;
  const Place place = folded(2.0 * column - 1.0, 2.0 * row - 1.0);
  return glm::normalize(point_on_octahedron(place.x, place.y));
}

OctahedralMap to_octahedral(const CubemapChain& chain, const OctahedralOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (chain.levels() == 0) refuse("a chain without levels; an octahedral map needs one level at least");
  check_options(options, std::min(chain.levels(), full_chain_levels(options.size)));
  OctahedralMap map{options.size, border_of(options), {}};
  for (int level = 0; level < options.levels; ++level) {
    const image::CubemapSampler source(chain.view(level));
    const Square square{map.level_size(level), map.border >> level};
    // A texel is 1.75 times as wide as at +z where an octant has its middle, and a cube's half as wide in its corners.
    const double dense = 1.75 * chain.level_size(level) / square.inner();
    const int samples = std::max(1, static_cast<int>(std::ceil(dense - 1e-9)));
    const double from = static_cast<double>(level) / options.levels;
    map.levels.push_back(
        make_level(square, jobs::part_of(control, from, from + 1.0 / options.levels),
                   [&](int column, int row) { return mean_of_texel(source, square.inner(), column, row, samples); }));
  }
  return map;
}

OctahedralMap to_octahedral(const SphericalHarmonics& harmonics, const OctahedralOptions& options,
                            const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_options(options, 1);
  OctahedralMap map{options.size, border_of(options), {}};
  const Square square{map.size, map.border};
  map.levels.push_back(make_level(square, control, [&](int column, int row) {
    const dvec3 point =
        point_on_octahedron(2.0 * (column + 0.5) / square.inner() - 1.0, 2.0 * (row + 0.5) / square.inner() - 1.0);
    return evaluate(harmonics, glm::normalize(point));
  }));
  return map;
}

}  // namespace welkin
