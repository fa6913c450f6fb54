// Importance sampling of environments: directions in proportion to the light that arrives from them.
//
//   welkin::ImportanceTable table = welkin::importance_table(panorama);
//   welkin::ImportanceSample towards = table.sample(random(), random());
//   radiance_sum += radiance(towards.direction) * cosine / towards.density;
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

/// The scalar weight of a texel. Negative weights count as 0.
enum class ImportanceWeight {
  luminance,  ///< Rec. 709: 0.2126, 0.7152, 0.0722
  mean,       ///< mean of the three channels
  largest,    ///< maximum of the three channels: for saturated lights, whose luminance is low
};

/// Options of `importance_table`.
struct ImportanceOptions {
  /// Width of the table, 1 to the source's; 0 for the source's. A texel of a coarser table has the mean of the source
  /// over its area, with fractional texels at its edges.
  int width = 0;
  int height = 0;  ///< height of the table, 1 to the source's; 0 for the source's

  ImportanceWeight weight = ImportanceWeight::luminance;  ///< weight of a texel

  /// Subtracts the mean weight and clamps to 0 (Karlik et al. 2019, "MIS compensation", section 5.2). For estimators
  /// that combine the table with samples of the material by the balance heuristic; alone, such a table misses light.
  bool mis_compensation = false;

  PixelPolicy pixels{};  ///< treatment of source values

  friend bool operator==(const ImportanceOptions&, const ImportanceOptions&) = default;
};

/// A sampled direction.
struct ImportanceSample {
  dvec3 direction{};     ///< unit vector, in the axes of `LatLongView`
  double density = 0.0;  ///< probability density per steradian, above 0
  int column = 0;        ///< column of the table's texel that was sampled
  int row = 0;           ///< row of the table's texel that was sampled
};

/// The caller's memory for the arrays of a table.
struct ImportanceTargets {
  std::span<float> function;    ///< width x height; see `ImportanceTable`
  std::span<float> row_cdf;     ///< height + 1
  std::span<float> column_cdf;  ///< height x (width + 1)
};

/// A piecewise constant density over the sphere: constant per solid angle within each texel of a lat-long.
///
/// The arrays are those of pbrt's PiecewiseConstant2D (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th
/// edition, A.4.5 and A.5.2): `column_cdf` has the distributions within each row, and `row_cdf` that over the rows.
/// Each starts at 0, never decreases, and ends at exactly 1. A row without light has a uniform one.
struct ImportanceTable {
  int width = 0;   ///< texels per row
  int height = 0;  ///< number of rows

  /// [height][width]: integral of the weight over each texel, in its unit times steradians; divided by `integral`, the
  /// texel's probability. (pbrt calls these values func; any scale works.) If no texel has a weight above 0: the
  /// texels' solid angles, a uniform density over the sphere.
  std::vector<float> function;
  std::vector<float> row_cdf;     ///< [height + 1]: probability of the rows above each
  std::vector<float> column_cdf;  ///< [height][width + 1]: probability within a row of the columns before each
  double integral = 0.0;          ///< sum of `function`

  /// Returns the direction for two numbers, which are clamped to [0, 1): `down` selects the row and the height within
  /// it, `across` the column and the longitude. Uniform numbers give directions with the density of `function`. The
  /// cumulative distributions are floats with steps of 6e-8 of a row, so a texel next to a much brighter one may never
  /// be sampled. Cost: two binary searches.
  [[nodiscard]] ImportanceSample sample(double across, double down) const;

  /// Returns the density per steradian at a direction, consistent with `sample`; 0 where nothing is sampled. Throws
  /// `Error` (invalid_argument) for a direction that is zero or not finite.
  [[nodiscard]] double density(const dvec3& direction) const;
};

/// Computes a table. Cost: one pass over the source and one over the table, two with `mis_compensation`. Throws
/// `Error`: invalid_argument, rejected_pixel.
[[nodiscard]] ImportanceTable importance_table(const LatLongView& source, const ImportanceOptions& options = {},
                                               const Control& control = {});

/// Computes a table into the caller's memory and returns its `integral`. Throws `Error` (invalid_argument) also for
/// spans of another length.
double importance_table(const LatLongView& source, const ImportanceTargets& targets,
                        const ImportanceOptions& options = {}, const Control& control = {});

// ---- Other structures for sampling with the same probabilities

/// Entry of an alias table (Walker 1977, Vose 1991).
struct AliasEntry {
  float own = 1.0F;         ///< probability that the entry stands for its own index
  std::uint32_t other = 0;  ///< index that it stands for otherwise
};

/// A two-level alias table. Sampling takes constant time: an entry of `rows` by one number in [0, 1), then one of that
/// row's `columns`.
struct AliasTable {
  std::vector<AliasEntry> rows;     ///< [height]
  std::vector<AliasEntry> columns;  ///< [height][width]
};

/// Computes an alias table with the table's probabilities, each within a rounding error of float. Cost: 10 ns per texel
/// on one thread.
[[nodiscard]] AliasTable alias_table(const ImportanceTable& table, const Control& control = {});

/// Probabilities of blocks of texels by powers of two, for hierarchical warping (Clarberg et al. 2005) and for
/// densities at a level of detail.
struct ImportancePyramid {
  /// One level of the pyramid.
  struct Level {
    int width = 0;                     ///< half that of the level before, rounded up
    int height = 0;                    ///< half that of the level before, rounded up
    std::vector<float> probabilities;  ///< [height][width], with a sum of 1
  };
  std::vector<Level> levels;  ///< from the table's own texels down to a single block
};

/// Computes the pyramid. A block covers 2 x 2 blocks of the level before, or fewer at an edge of odd length.
[[nodiscard]] ImportancePyramid importance_pyramid(const ImportanceTable& table, const Control& control = {});

// ---- Gain of importance sampling

/// Variance of one-sample estimates of the sphere's total weight, relative to the square of the total.
struct ImportanceVariance {
  double uniform = 0.0;  ///< for uniform directions
  double table = 0.0;    ///< for the table; infinite if it never samples a texel that has a weight
};

/// Computes variances exactly, by sums over the source's texels as constant areas. `weight` and `pixels` must be those
/// of the table. Throws `Error`: invalid_argument (also for a table larger than the source), rejected_pixel.
[[nodiscard]] ImportanceVariance importance_variance(const LatLongView& source, const ImportanceTable& table,
                                                     ImportanceWeight weight = ImportanceWeight::luminance,
                                                     const PixelPolicy& pixels = {}, const Control& control = {});

}  // namespace welkin
