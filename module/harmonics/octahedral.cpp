#include "harmonics/octahedral.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "harmonics/octahedral_border.h"
#include "harmonics/octahedral_overlap.h"
#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/direction.h"
#include "platform/float_environment.h"
#include "welkin/image.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

/// On the octahedron |x| + |y| + |z| = 1; `x`, `y` from -1 to 1.
dvec3 point_on_octahedron(double x, double y) noexcept {
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) return {x, y, z};
  return {std::copysign(1.0 - std::abs(y), x), std::copysign(1.0 - std::abs(x), y), z};
}

struct SquarePoint {
  double x;
  double y;
};

/// From beyond an edge back into the square from -1 to 1: over the edge, and turned along it.
SquarePoint folded(double x, double y) noexcept {
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

/// A texel's centre in half texels from the middle of the square inside the border.
struct Centre {
  int a, b;
};

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what); }

int border_of(const OctahedralOptions& options) {
  return options.border > 0 ? options.border : 1 << (options.levels - 1);
}

}  // namespace

void octahedral::check_options(const OctahedralOptions& options, int most_levels) {
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
    refuse("an octahedral map of " + std::to_string(options.size) + " texels is all border (" + std::to_string(border) +
           " on each side); pass a larger size or a smaller border");
  }
}

std::uint64_t octahedral::map_bytes(const OctahedralOptions& options) noexcept {
  std::uint64_t texels = 0;
  for (int level = 0; level < options.levels; ++level) {
    const auto edge = static_cast<std::uint64_t>(options.size >> level);
    texels += edge * edge;
  }
  return texels * 3 * sizeof(float);
}

std::uint64_t octahedral::working_bytes(const OctahedralOptions& options, int cube_size, std::size_t workers) noexcept {
  // Level 0 takes most: a copy of the cubemap with rings, a list of texels, and for each worker the weights of one
  // texel, which overlaps three faces at most, each by six times the mean. A vector that grows is there twice.
  const auto square = [](std::uint64_t edge) { return edge * edge; };
  const auto ringed = 6 * square(static_cast<std::uint64_t>(cube_size) + 2);
  const auto inner = static_cast<std::uint64_t>(std::max(1, options.size - 2 * border_of(options)));
  const auto overlap = 3 * square(6 * static_cast<std::uint64_t>(cube_size) / inner + 4);
  return ringed * 3 * sizeof(float) + square(inner) * sizeof(Centre) / 2 +
         workers * 3 * sizeof(double) * std::min(ringed, overlap);
}

namespace {

/// The pixels of one level.
class Level {
 public:
  explicit Level(const Square& square)
      : square_(square), pixels_(3 * static_cast<std::size_t>(square.size) * static_cast<std::size_t>(square.size)) {}

  /// Column and row are counted from 0 inside the border.
  [[nodiscard]] float* texel(int column, int row) noexcept {
    return pixels_.data() +
           3 * (static_cast<std::size_t>(row + square_.border) * static_cast<std::size_t>(square_.size) +
                static_cast<std::size_t>(column + square_.border));
  }
  void set(int column, int row, const dvec3& rgb) noexcept {
    for (int c = 0; c < 3; ++c) texel(column, row)[c] = static_cast<float>(rgb[c]);
  }

  /// Copies texels to the border.
  [[nodiscard]] std::vector<float> finished() && {
    const int inner = square_.inner();
    for (int row = -square_.border; row < inner + square_.border; ++row) {
      for (int column = -square_.border; column < inner + square_.border; ++column) {
        int from_column = column;
        int from_row = row;
        octahedral::move_inside(inner, from_column, from_row);
        if (from_column != column || from_row != row) std::copy_n(texel(from_column, from_row), 3, texel(column, row));
      }
    }
    return std::move(pixels_);
  }

 private:
  Square square_;
  std::vector<float> pixels_;
};

/// Returns the texels whose images under the map's symmetries are all texels. If `inner` is even, the symmetries
/// include the exchange of the square's halves with z above and below 0.
std::vector<Centre> texels_of_their_own(int inner) {
  std::vector<Centre> centres;
  for (int a = 1 - inner % 2; a < inner; a += 2) {
    const int last = inner % 2 == 0 ? std::min(a, inner - a) : a;
    for (int b = 1 - inner % 2; b <= last; b += 2) centres.push_back({a, b});
  }
  return centres;
}

/// A cubemap's level to one of a map.
class Resampling {
 public:
  Resampling(const CubemapView& view, const Square& square)
      : source_(view), inner_(square.inner()), level_(square), centres_(texels_of_their_own(inner_)) {
    const int edge = view.size + 2;  // with the ring, from whose first texel columns and rows count
    for (std::size_t number = 0; number < kSymmetries; ++number) {
      for (int face = 0; face < 6; ++face) {
        images_[number][static_cast<std::size_t>(face)] =
            image::image_of_face(face, [&](const image::CubeTexel& texel) {
              return image::texel_at(edge, moved(number, image::point_of(edge, texel)));
            });
      }
    }
  }

  [[nodiscard]] std::vector<float> run(const Control& control) && {
    // Single ones where there are few, as each of them may hold much of the cubemap.
    const std::size_t at_once = std::clamp<std::size_t>(centres_.size() / 64, 1, 64);
    const std::size_t tiles = (centres_.size() + at_once - 1) / at_once;
    const auto placement =
        jobs::placement_for(std::int64_t{6} * source_.size() * source_.size() + std::int64_t{inner_} * inner_);
    const std::size_t workers = jobs::worker_count(placement);
    std::vector<octahedral::TexelOverlap> overlaps(workers, octahedral::TexelOverlap(inner_, source_.size()));
    jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
      const std::size_t end = std::min(centres_.size(), (tile + 1) * at_once);
      for (std::size_t k = tile * at_once; k < end; ++k) {
        overlaps[worker].find(centres_[k].a, centres_[k].b);
        fill_images(centres_[k], overlaps[worker]);
      }
    });
    return std::move(level_).finished();
  }

 private:
  static constexpr std::size_t kSymmetries = 16;

  /// A symmetry of the map, which is one of the cube too: exchange of x and y, then other signs.
  [[nodiscard]] static glm::ivec3 moved(std::size_t number, glm::ivec3 point) noexcept {
    if ((number & 1U) != 0) std::swap(point.x, point.y);
    for (int axis = 0; axis < 3; ++axis) {
      if ((number >> (axis + 1) & 1U) != 0) point[axis] = -point[axis];
    }
    return point;
  }

  /// Fills the texel and its images, each once.
  void fill_images(const Centre& centre, const octahedral::TexelOverlap& overlap) {
    const auto [a, b] = centre;
    for (std::size_t number = 0; number < kSymmetries; ++number) {
      const bool swapped = (number & 1U) != 0;
      int x = swapped ? b : a;
      int y = swapped ? a : b;
      if (swapped && a == b) continue;
      if (((number & 2U) != 0 && x == 0) || ((number & 4U) != 0 && y == 0)) continue;
      if ((number & 8U) != 0) {
        if (inner_ % 2 != 0 || a + b == inner_) continue;
        x = std::exchange(y, inner_ - x);
        x = inner_ - x;
      }
      if ((number & 2U) != 0) x = -x;
      if ((number & 4U) != 0) y = -y;
      level_.set((x + inner_ - 1) / 2, (y + inner_ - 1) / 2, mean(overlap, images_[number]));
    }
  }

  [[nodiscard]] dvec3 mean(const octahedral::TexelOverlap& overlap,
                           const std::array<image::FaceImage, 6>& images) const noexcept {
    dvec3 sum(0.0);
    double whole = 0.0;
    const int edge = source_.size() + 2;
    for (const octahedral::Patch& patch : overlap.patches()) {
      const image::FaceImage& image = images[static_cast<std::size_t>(patch.face)];
      const float* const first =
          source_.texel(image.face, image.column + image.across_columns * patch.column + image.down_columns * patch.row,
                        image.row + image.across_rows * patch.column + image.down_rows * patch.row);
      const std::ptrdiff_t across = std::ptrdiff_t{3} * (image.across_columns + image.across_rows * edge);
      const std::ptrdiff_t down = std::ptrdiff_t{3} * (image.down_columns + image.down_rows * edge);
      const double* weight = overlap.weights(patch);
      for (int row = 0; row < patch.rows; ++row) {
        const float* texel = first + row * down;
        for (int column = 0; column < patch.columns; ++column, texel += across, ++weight) {
          sum.r += *weight * static_cast<double>(texel[0]);
          sum.g += *weight * static_cast<double>(texel[1]);
          sum.b += *weight * static_cast<double>(texel[2]);
          whole += *weight;
        }
      }
    }
    return sum / whole;
  }

  octahedral::RingedCube source_;
  int inner_;
  Level level_;
  std::vector<Centre> centres_;
  std::array<std::array<image::FaceImage, 6>, kSymmetries> images_{};
};

}  // namespace

std::array<double, 2> octahedral_encode(const dvec3& direction) {
  const platform::FloatingPointScope floating_point;
  const dvec3 towards = math::moderate_direction(direction, "direction");
  const double sum = std::abs(towards.x) + std::abs(towards.y) + std::abs(towards.z);
  const double x = towards.x / sum;
  const double y = towards.y / sum;
  if (towards.z >= 0.0) return {0.5 * x + 0.5, 0.5 * y + 0.5};
  return {0.5 * std::copysign(1.0 - std::abs(y), x) + 0.5, 0.5 * std::copysign(1.0 - std::abs(x), y) + 0.5};
}

dvec3 octahedral_decode(double column, double row) noexcept {
  const platform::FloatingPointScope floating_point;
  const SquarePoint index = folded(2.0 * column - 1.0, 2.0 * row - 1.0);
  return glm::normalize(point_on_octahedron(index.x, index.y));
}

OctahedralMap to_octahedral(const Cubemap& chain, const OctahedralOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (chain.levels() == 0) refuse("a chain without levels; an octahedral map needs one level at least");
  octahedral::check_options(options, std::min(chain.levels(), full_chain_levels(options.size)));
  OctahedralMap map{options.size, border_of(options), {}};
  for (int level = 0; level < options.levels; ++level) {
    const double from = static_cast<double>(level) / options.levels;
    const Square square{map.level_size(level), map.border >> level};
    map.levels.push_back(
        Resampling(chain.view(level), square).run(jobs::part_of(control, from, from + 1.0 / options.levels)));
  }
  return map;
}

OctahedralMap to_octahedral(const SphericalHarmonics& harmonics, const OctahedralOptions& options,
                            const Control& control) {
  const platform::FloatingPointScope floating_point;
  octahedral::check_options(options, 1);
  OctahedralMap map{options.size, border_of(options), {}};
  const Square square{map.size, map.border};
  const int inner = square.inner();
  Level level(square);
  const auto placement = jobs::placement_for(std::int64_t{inner} * inner);
  jobs::run_tiles(static_cast<std::size_t>(inner), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    const auto row = static_cast<int>(tile);
                    for (int column = 0; column < inner; ++column) {
                      const dvec3 point =
                          point_on_octahedron(2.0 * (column + 0.5) / inner - 1.0, 2.0 * (row + 0.5) / inner - 1.0);
                      level.set(column, row, evaluate(harmonics, glm::normalize(point)));
                    }
                  });
  map.levels.push_back(std::move(level).finished());
  return map;
}

}  // namespace welkin
