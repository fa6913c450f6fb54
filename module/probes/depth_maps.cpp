#include "probes/depth_maps.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "harmonics/octahedral_border.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/many.h"
#include "probes/probe_arrays.h"
#include "welkin/resampling.h"

namespace welkin::probes {
namespace {

/// Blocks along an edge of a face: 5.6 degrees each, a third of the width of a lobe of power 50.
/// (90 / 16 degrees; cos^50 is exp(-1/2) at 8.1 degrees from the axis, so the lobe is 16 degrees wide.)
constexpr int kMaxBlocks = 16;

/// The largest power whose lobes are wider than the blocks of kMaxBlocks.
/// Along a great circle cos^p bends from concave to convex where (p - 1) tan^2 = 1: at tan = 1/8 for p = 65, and 1/8 is
/// a block's edge on a face of edge 2 with 16 of them. Across narrower lobes a second-order correction means nothing.
constexpr int kWideLobe = 65;

/// Blocks of less weight relative to the nearest one are left out: they change a mean by less than a float's last bit.
/// Beyond the angle where c^power = 1e-9 the lobe has the share Int from 0 to c of x^power dx / Int from 0 to 1 =
/// c^(power + 1), less than 1e-9 of the weights.
constexpr double kMinWeight = 1e-9;

double power_of(double base, int power) noexcept {
  double result = 1.0;
  for (; power > 0; power /= 2) {
    if (power % 2 == 1) result *= base;
    base *= base;
  }
  return result;
}

/// Returns the weight of the mean of distances over a block, relative to cosine^power at the block's middle. Both vary
/// over a block. Where distances are smooth, subtracting (area / 24) of the lobe's Laplacian corrects for that
/// (integration by parts). The sum over the block's texels, `texels` along an edge, misses a share of 1 / texels^2 of
/// the correction.
/// Derivation, for a lobe f, distances g and blocks of edge a and area A = a^2, with all values at a block's middle:
///   Int f g over a block = A (f g + a^2 / 24 Lap(f g)) + O(a^6),
///   mean of g over t x t texels = g + k Lap g,   k = a^2 / 24 (1 - 1 / t^2).
/// Summed over the sphere, Int Lap(f g) = 0 and Int f Lap g = Int g Lap f, so the sum of A f (mean of g) is Int f g + k
/// Int g Lap f: f - k Lap f in place of f takes the second term away. On the sphere
///   Lap cos^p = p cos^p ((p - 1) tan^2 - 2).
/// For smooth g and 12 random axes the correction takes the rms error to a fifth or less (computed for powers 20 and
/// 50, 2 and 4 texels per block edge).
double lobe_correction(double cosine, int power, double steradians, double texels) noexcept {
  if (power > kWideLobe) return 1.0;
  const double tangent_square = 1.0 / (cosine * cosine) - 1.0;
  const double laplacian = power * ((power - 1.0) * tangent_square - 2.0);
  return std::max(0.0, 1.0 - (1.0 - 1.0 / (texels * texels)) * steradians / 24.0 * laplacian);
}

constexpr int kLargestDepth = 1024;

}  // namespace

void check_depths(std::span<const DepthView> depths) {
  for (std::size_t k = 0; k < depths.size(); ++k) {
    jobs::naming_probe(k, [&] {
      image::require_range("size of a depth cubemap", depths[k].size, 1, kLargestDepth);
      if (depths[k].size != depths[0].size) {
        refuse("its depths have " + std::to_string(depths[k].size) + " texels along an edge, those of probe 0 have " +
               std::to_string(depths[0].size) + "; all must have as many");
      }
      for (std::size_t face = 0; face < 6; ++face) {
        if (depths[k].faces[face] == nullptr)
          refuse("face " + std::to_string(face) + " of its depths is null; pass the address of its first texel");
      }
      const std::ptrdiff_t stride = std::abs(depths[k].row_stride_bytes);
      const auto row = static_cast<std::ptrdiff_t>(sizeof(float)) * depths[k].size;
      if (stride != 0 && (stride < row || stride % static_cast<std::ptrdiff_t>(sizeof(float)) != 0)) {
        refuse("a row of its depths takes " + std::to_string(row) + " bytes, and row_stride_bytes is " +
               std::to_string(depths[k].row_stride_bytes) + "; it must be no less, in whole floats");
      }
    });
  }
}

void require_count(const char* name, std::size_t is, std::size_t must_be) {
  if (is == must_be) return;
  refuse(std::string(name) + ": there are " + std::to_string(is) + " for " + std::to_string(must_be) +
         " probes; pass one per probe");
}

void refuse_nan_depth(std::size_t probe) {
  throw Error(ErrorCode::rejected_pixel, "probe " + std::to_string(probe) +
                                             ": a depth is NaN; pass infinity where only the environment is visible");
}

const float* row_of(const DepthView& view, int face, int row) noexcept {
  const float* first = view.faces[static_cast<std::size_t>(face)];
  const std::ptrdiff_t stride = view.row_stride_bytes != 0
                                    ? view.row_stride_bytes
                                    : static_cast<std::ptrdiff_t>(sizeof(float)) * std::ptrdiff_t{view.size};
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(first) + stride * row);
}

std::vector<double> face_solid_angles(int size) {
  const auto columns = static_cast<std::size_t>(size);
  std::vector<double> angles(squared(size));
  for (int row = 0; row < size; ++row) {
    image::cubemap_row_solid_angles(row, std::span(angles).subspan(static_cast<std::size_t>(row) * columns, columns));
  }
  return angles;
}

DepthMaps::DepthMaps(int size, const DepthRules& rules)
    : size_(size), edge_(std::min(size, kMaxBlocks)), rules_(rules), solid_angles_(face_solid_angles(size)) {
  const auto columns = static_cast<std::size_t>(size);
  if (rules.distance_size == 0) return;
  block_angles_.resize(squared(edge_));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const auto block = static_cast<std::size_t>(row * edge_ / size * edge_ + column * edge_ / size);
      block_angles_[block] += solid_angles_[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
    }
  }
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < edge_; ++row) {
      for (int column = 0; column < edge_; ++column) {
        directions_.push_back(image::face_direction(size, face, 0.5 * (first_of(column) + first_of(column + 1)),
                                                    0.5 * (first_of(row) + first_of(row + 1))));
      }
    }
  }
  for (int row = 0; row < rules.distance_size; ++row) {
    for (int column = 0; column < rules.distance_size; ++column) gather_shares(column, row);
  }
  first_share_.push_back(shares_.size());
}

void DepthMaps::gather_shares(int column, int row) {
  first_share_.push_back(shares_.size());
  const dvec3 axis = octahedral_decode((column + 0.5) / rules_.distance_size, (row + 0.5) / rules_.distance_size);
  // Cosines are divided by the largest, so that some weight is near 1 whatever the power.
  double nearest = 0.0;
  for (const dvec3& direction : directions_) nearest = std::max(nearest, glm::dot(axis, direction));
  const double texels = static_cast<double>(size_) / edge_;
  double sum = 0.0;
  const std::size_t first = shares_.size();
  for (std::size_t block = 0; block < directions_.size(); ++block) {
    const double cosine = glm::dot(axis, directions_[block]);
    // Weights are normalized below, so any common factor may be dropped. (cosine / nearest)^power does not underflow
    // for large powers.
    const double lobe = cosine > 0.0 ? power_of(cosine / nearest, rules_.distance_power) : 0.0;
    if (lobe < kMinWeight) continue;
    const double steradians = block_angles_[block % block_angles_.size()];
    const double weight = lobe * lobe_correction(cosine, rules_.distance_power, steradians, texels);
    if (weight == 0.0) continue;
    shares_.push_back({static_cast<std::uint32_t>(block), weight * steradians});
    sum += shares_.back().weight;
  }
  for (std::size_t k = first; k < shares_.size(); ++k) shares_[k].weight /= sum;
}

DepthMaps::Scratch::Scratch(const DepthMaps& maps)
    : columns_(3 * static_cast<std::size_t>(maps.size_)), blocks_(2 * maps.directions_.size()) {}

void DepthMaps::add_row(const float* depths, int row, Scratch& scratch, bool& is_number) const noexcept {
  const auto size = static_cast<std::size_t>(size_);
  const double* angles = solid_angles_.data() + static_cast<std::size_t>(row) * size;
  double* means = scratch.columns_.data();
  double* squares = means + size;
  double* bad = squares + size;
  const double near_distance = rules_.near_distance;
  const double limit = rules_.distance_limit;
  int numbers = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const auto depth = static_cast<double>(depths[k]);
    const double length = std::abs(depth);
    const double counted = length < limit ? length : limit;
    // Mean and mean square give the variance, from which a shader bounds the share of distances beyond its own by
    // Chebyshev's inequality (Donnelly and Lauritzen, "Variance Shadow Maps", 2006). A limit keeps infinite distances
    // from ruling both.
    means[k] += angles[k] * counted;
    squares[k] += angles[k] * (counted * counted);
    // (A back is nearer than nothing.) NaN is never counted: the call that meets one has no result.
    bad[k] += (depth < near_distance) ? angles[k] : 0.0;
    numbers += length >= 0.0 ? 1 : 0;
  }
  is_number = is_number && numbers == size_;
}

float DepthMaps::read(const DepthView& depths, Scratch& scratch, std::span<float> distances) const noexcept {
  const auto size = static_cast<std::size_t>(size_);
  const auto edge = static_cast<std::size_t>(edge_);
  double bad = 0.0;
  double whole = 0.0;
  bool is_number = true;
  double* mean = scratch.blocks_.data();
  for (int face = 0; face < 6; ++face) {
    for (int block_row = 0; block_row < edge_; ++block_row) {
      std::fill(scratch.columns_.begin(), scratch.columns_.end(), 0.0);
      for (int row = first_of(block_row); row < first_of(block_row + 1); ++row) {
        add_row(row_of(depths, face, row), row, scratch, is_number);
      }
      for (std::size_t k = 0; k < size; ++k) bad += scratch.columns_[2 * size + k];
      if (rules_.distance_size == 0) continue;
      for (std::size_t column = 0; column < edge; ++column, mean += 2) {
        mean[0] = mean[1] = 0.0;
        const auto end = static_cast<std::size_t>(first_of(static_cast<int>(column) + 1));
        for (auto k = static_cast<std::size_t>(first_of(static_cast<int>(column))); k < end; ++k) {
          mean[0] += scratch.columns_[k];
          mean[1] += scratch.columns_[size + k];
        }
        const double angle = block_angles_[static_cast<std::size_t>(block_row) * edge + column];
        mean[0] /= angle;
        mean[1] /= angle;
      }
    }
  }
  if (!is_number) return -1.0F;
  if (rules_.distance_size > 0) write_map(scratch, distances);
  // 4 pi, but as the sum of the same numbers: a probe all of whose texels are bad has a quotient of 1 to rounding.
  for (const double angle : solid_angles_) whole += 6.0 * angle;
  return bad > 0.0 ? static_cast<float>(std::max(0.0, 1.0 - bad / whole)) : 1.0F;
}

void DepthMaps::write_map(const Scratch& scratch, std::span<float> distances) const noexcept {
  const int inner = rules_.distance_size;
  const auto at = [&](int column, int row) {
    return distances.data() + 2 * (static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(inner + 2) +
                                   static_cast<std::size_t>(column + 1));
  };
  for (int row = 0; row < inner; ++row) {
    for (int column = 0; column < inner; ++column) {
      const auto texel = static_cast<std::size_t>(row * inner + column);
      double mean = 0.0;
      double square = 0.0;
      for (std::size_t k = first_share_[texel]; k < first_share_[texel + 1]; ++k) {
        const double* block = scratch.blocks_.data() + 2 * std::size_t{shares_[k].block};
        mean += shares_[k].weight * block[0];
        square += shares_[k].weight * block[1];
      }
      at(column, row)[0] = static_cast<float>(mean);
      at(column, row)[1] = static_cast<float>(square);
    }
  }
  for (int row = -1; row <= inner; ++row) {
    for (int column = -1; column <= inner; ++column) {
      int from_column = column;
      int from_row = row;
      octahedral::move_inside(inner, from_column, from_row);
      if (from_column != column || from_row != row) std::copy_n(at(from_column, from_row), 2, at(column, row));
    }
  }
}

}  // namespace welkin::probes
