// All six faces, and a row and its mirror image on each, share their weights: a quarter of a face's are worked out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "image/image_kernels.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/float_environment.h"
#include "simd/dispatch.h"
#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::image {
namespace {

// A face of odd size to one of half the size: texels are cut.

/// Which texels of a face of `size` = 2 m + 1 texels along an edge lie under a row of the m x m below, and with which
/// part of that texel: a texel below covers size / m = 2 + 1 / m texels either way, so part of at most 3 x 3.
class OddMipRow {
 public:
  /// size >= 3.
  OddMipRow(int size, MipFilter filter);

  /// Goes to row `row` of the smaller face.
  void place(int row) noexcept;

  /// The row's texels: rgb[3 m] from a packed face.
  void reduce(const float* face, float* rgb) const noexcept;

 private:
  int size_;
  int row_ = 0;
  MipFilter filter_;
  std::vector<std::array<double, 9>> parts_;  ///< [m]: by rows; they add up to 1
};

/// The solid angle of the rectangle from the middle of a face to (u, v): atan(u v / sqrt(1 + u^2 + v^2)).
double corner_solid_angle(double u, double v) noexcept {
  const double angle = math::turns_of(std::abs(u * v), std::sqrt(1.0 + u * u + v * v)) * 2.0 * std::numbers::pi;
  return u * v < 0.0 ? -angle : angle;
}

/// Where texel `index` of m is cut by the edges of 2 m + 1 texels, in those texels: its ends and the edges between.
std::array<double, 4> cuts(int index, int half) noexcept {
  const double share = static_cast<double>(index) / half;  // how far the texels below have got ahead
  return {2.0 * index + share, 2.0 * index + 1.0, 2.0 * index + 2.0, 2.0 * (index + 1) + share + 1.0 / half};
}

OddMipRow::OddMipRow(int size, MipFilter filter)
    : size_(size), filter_(filter), parts_(static_cast<std::size_t>(size / 2)) {}

// Texel i covers from i (2 + 1/m) to (i + 1) (2 + 1/m): of texel 2 i the part 1 - i/m, all of 2 i + 1, and (i + 1)/m of
// texel 2 i + 2.
void OddMipRow::place(int row) noexcept {
  row_ = row;
  const int half = size_ / 2;
  const auto coordinate_of = [&](double cut) { return 2.0 * cut / size_ - 1.0; };
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
            return corner_solid_angle(coordinate_of(columns[a]), coordinate_of(rows[b]));
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

}  // namespace
}  // namespace welkin::image

namespace welkin {
namespace {

constexpr std::int64_t kTileTexels = 32768;    ///< of the level above
constexpr std::int64_t kInlineTexels = 32768;  ///< some 30 microseconds

/// One worker's scratch: the weights of the texels of a pair of rows.
struct Scratch {
  explicit Scratch(int size) {
    const auto padded = static_cast<std::size_t>((size + 1) / 2 + simd::kLanes);
    for (auto& row : angles) row.resize(padded);
    for (auto& row : weights) row.resize(static_cast<std::size_t>(3 * size));
  }
  std::vector<float> angles[2];   ///< in proportion to the solid angles of the left half
  std::vector<float> weights[2];  ///< as `reduce_pairs` takes them: three times each
};

void put_weight(std::vector<float>& weights, int column, float weight) {
  for (int c = 0; c < 3; ++c) weights[static_cast<std::size_t>(3 * column + c)] = weight;
}

/// Reduces level - 1 to level, if the former has an even number of texels.
class EvenReduction {
 public:
  EvenReduction(Cubemap& chain, int level, MipFilter filter)
      : chain_(chain), level_(level), size_(chain.level_size(level)), filter_(filter) {}

  /// Row `row` of the upper half of all faces, and the rows opposite.
  void reduce(int row, Scratch& scratch) const {
    fill_weights(row, scratch);
    const auto source_row = static_cast<std::size_t>(6 * size_);
    for (int face = 0; face < 6; ++face) {
      const float* const from = chain_.face(level_ - 1, face);
      float* const to = chain_.face(level_, face);
      const auto reduce_row = [&](int target, int outer, int inner) {
        kernels_.reduce_pairs(from + static_cast<std::size_t>(outer) * source_row,
                              from + static_cast<std::size_t>(inner) * source_row, scratch.weights[0].data(),
                              scratch.weights[1].data(), size_,
                              to + static_cast<std::size_t>(3 * size_) * static_cast<std::size_t>(target));
      };
      reduce_row(row, 2 * row, 2 * row + 1);
      const int opposite = size_ - 1 - row;
      if (opposite != row) reduce_row(opposite, 2 * opposite + 1, 2 * opposite);
    }
  }

 private:
  void fill_angles(int row, float* angles) const {
    const image::TexelRun run{2 * size_, row, 0, size_, 1, false};
    constexpr int only_row = 0;
    if (2 * size_ > math::kLargestIntegratedFace) {
      texel_kernels_.expand_texels(run, &only_row, angles, 0);
    } else {
      texel_kernels_.integrate_texels(run, math::basis_constants(), math::texel_rule(2 * size_), &only_row, angles, 0);
    }
  }

  void fill_weights(int row, Scratch& scratch) const {
    if (filter_ == MipFilter::box) {
      for (std::vector<float>& weights : scratch.weights) std::fill(weights.begin(), weights.end(), 0.25F);
      return;
    }
    for (int k = 0; k < 2; ++k) fill_angles(2 * row + k, scratch.angles[k].data());
    const float* const outer = scratch.angles[0].data();
    const float* const inner = scratch.angles[1].data();
    for (int column = 0; column < (size_ + 1) / 2; ++column) {
      // The texel in the middle of an odd number covers a pair of mirror images.
      const int left = 2 * column;
      const int right = left + 1 < size_ ? left + 1 : left;
      const float scale = 1.0F / ((outer[left] + inner[left]) + (outer[right] + inner[right]));
      const float outer_left = outer[left] * scale;
      const float inner_left = inner[left] * scale;
      const float outer_right = outer[right] * scale;
      // As the kernel adds, these come to 1 exactly: what the first two lack is representable but for half a unit.
      const float inner_right = (1.0F - (outer_left + inner_left)) - outer_right;
      const int mirror = 2 * size_ - 1 - left;
      put_weight(scratch.weights[0], left, outer_left);
      put_weight(scratch.weights[1], left, inner_left);
      put_weight(scratch.weights[0], left + 1, outer_right);
      put_weight(scratch.weights[1], left + 1, inner_right);
      if (mirror - 1 == left) continue;
      put_weight(scratch.weights[0], mirror, outer_left);
      put_weight(scratch.weights[1], mirror, inner_left);
      put_weight(scratch.weights[0], mirror - 1, outer_right);
      put_weight(scratch.weights[1], mirror - 1, inner_right);
    }
  }

  const image::ImageKernels& kernels_ = image::image_kernels();
  const image::TexelKernels& texel_kernels_ = image::texel_kernels();
  Cubemap& chain_;
  int level_;
  int size_;
  MipFilter filter_;
};

/// Returns the rows of a tile, which are of `row_texels` texels of work each.
int tile_rows(int rows, std::int64_t row_texels) {
  return static_cast<int>(std::clamp<std::int64_t>(kTileTexels / row_texels, 1, rows));
}

jobs::Placement placement_of(std::int64_t texels) {
  return texels <= kInlineTexels ? jobs::Placement::calling_thread : jobs::Placement::arena;
}

void fill_level(Cubemap& chain, int level, MipFilter filter, const Control& control) {
  const int size = chain.level_size(level);
  const int above = chain.level_size(level - 1);
  const std::int64_t texels = std::int64_t{6} * above * above;
  const jobs::Placement placement = placement_of(texels);
  const std::size_t workers = jobs::worker_count(placement);
  if (above % 2 == 0) {
    const EvenReduction reduction(chain, level, filter);
    std::vector<Scratch> scratch(workers, Scratch(above));
    const int rows = (size + 1) / 2;
    jobs::run_rows(rows, tile_rows(rows, std::int64_t{24} * above), placement, workers, control,
                   [&](int row, std::size_t worker) { reduction.reduce(row, scratch[worker]); });
    return;
  }
  std::vector<image::OddMipRow> scratch(workers, image::OddMipRow(above, filter));
  const int of_tile = tile_rows(size, std::int64_t{12} * above);
  jobs::run_rows(size, of_tile, placement, workers, control, [&](int row, std::size_t worker) {
    scratch[worker].place(row);
    for (int face = 0; face < 6; ++face) {
      scratch[worker].reduce(chain.face(level - 1, face), chain.face(level, face) + static_cast<std::size_t>(3 * size) *
                                                                                        static_cast<std::size_t>(row));
    }
  });
}

void copy_source(const CubemapView& source, Cubemap& chain, const Control& control) {
  const int size = source.size;
  const jobs::Placement placement = placement_of(std::int64_t{6} * size * size);
  const std::size_t workers = jobs::worker_count(placement);
  jobs::run_rows(6 * size, tile_rows(6 * size, size), placement, workers, control, [&](int row, std::size_t) {
    image::decode_texels(
        source.format, image::row_of(source, row / size, row % size), size,
        chain.face(0, row / size) + static_cast<std::size_t>(3 * size) * static_cast<std::size_t>(row % size));
  });
}

double texels_of_level(const Cubemap& chain, int level) {
  return 1.0 * chain.level_size(level) * chain.level_size(level);
}

}  // namespace

void fill_mips(Cubemap& chain, MipFilter filter, const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (chain.levels() == 0) throw Error(ErrorCode::invalid_argument, "the chain has no levels; pass one with a size");
  double total = 0.0;
  for (int level = 0; level + 1 < chain.levels(); ++level) total += texels_of_level(chain, level);
  double done = 0.0;
  for (int level = 1; level < chain.levels(); ++level) {
    const double next = done + texels_of_level(chain, level - 1);
    fill_level(chain, level, filter, jobs::part_of(control, done / total, next / total));
    done = next;
  }
  if (chain.levels() == 1 && control.progress) control.progress(1.0);
}

Cubemap build_mips(const CubemapView& source, MipFilter filter, std::optional<int> levels, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  const int most = full_chain_levels(source.size);
  if (levels && (*levels < 1 || *levels > most)) {
    throw Error(ErrorCode::invalid_argument, "levels is " + std::to_string(*levels) + "; a cubemap of " +
                                                 std::to_string(source.size) + " texels has 1 to " +
                                                 std::to_string(most));
  }
  Cubemap chain(source.size, levels.value_or(most), control.memory);
  constexpr double kShareOfCopy = 0.5;
  copy_source(source, chain, jobs::part_of(control, 0.0, kShareOfCopy));
  fill_mips(chain, filter, jobs::part_of(control, kShareOfCopy, 1.0));
  return chain;
}

}  // namespace welkin
