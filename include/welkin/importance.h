// Tables by which a path tracer picks directions of an environment in proportion to the light that comes from there.
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

/// What of a texel counts. A negative weight counts as 0.
enum class ImportanceWeight {
  luminance,  ///< Rec. 709: 0.2126, 0.7152, 0.0722
  mean,       ///< of the three channels
  largest,    ///< of the three channels: for saturated lights, whose luminance is low
};

/// How a table is made.
struct ImportanceOptions {
  /// Texels of the table, 1 to the source's; 0: as many as the source has. A coarser table's texel has the mean of the
  /// source over its own area, texels that are cut counted by the part.
  int width = 0;
  int height = 0;  ///< the same

  ImportanceWeight weight = ImportanceWeight::luminance;  ///< what of a texel counts

  /// What lies below the mean weight counts as 0, what lies above by how much it does (Karlik et al. 2019, "MIS
  /// compensation", section 5.2): for estimators that combine the table with samples of the material by the balance
  /// heuristic, which find dim light themselves. Alone, such a table would leave light out.
  bool mis_compensation = false;

  PixelPolicy pixels{};  ///< what becomes of the source's values first

  friend bool operator==(const ImportanceOptions&, const ImportanceOptions&) = default;
};

/// A direction that was picked.
struct ImportanceSample {
  dvec3 direction{};     ///< unit; the frame of `LatLongView`
  double density = 0.0;  ///< probability for each steradian about it, above 0
  int column = 0;        ///< the table's texel that it lies in
  int row = 0;           ///< the same
};

/// Where the parts of a table are written, in memory of the caller's.
struct ImportanceTargets {
  std::span<float> function;    ///< width x height; see `ImportanceTable`
  std::span<float> row_cdf;     ///< height + 1
  std::span<float> column_cdf;  ///< height x (width + 1)
};

/// A piecewise constant density over the sphere: constant by solid angle within each texel of a lat-long.
///
/// The arrays are those of pbrt's PiecewiseConstant2D (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th
/// edition, A.4.5 and A.5.2): `column_cdf` is that of its conditional densities, row by row, and `row_cdf` that of the
/// marginal one. Both begin with 0, never fall, and end with 1 exactly; a row without light has an even one.
struct ImportanceTable {
  int width = 0;   ///< texels
  int height = 0;  ///< texels

  /// [height][width]: the integral of the weight over each texel, in its own unit times steradians. Divided by
  /// `integral` it is the texel's probability. (pbrt calls its values func; any scale does.) Where no texel has a
  /// weight above 0, the texels' solid angles: the density is that of the whole sphere then.
  std::vector<float> function;
  std::vector<float> row_cdf;     ///< [height + 1]: probability of the rows above each
  std::vector<float> column_cdf;  ///< [height][width + 1]: within a row, of the columns before each
  double integral = 0.0;          ///< sum of `function`

  /// The direction that two numbers from 0 to 1, 1 excluded, stand for (others are moved there): `down` picks the row
  /// and the height within it, `across` the column and the longitude. Evenly distributed numbers give directions by the
  /// density. The density is by `function`; the
  /// cumulative distributions, being floats, hold steps of 6e-8 of a row, which pass over some texels that are dimmer
  /// beside a bright one and pick others for them. Cost: two binary searches.
  [[nodiscard]] ImportanceSample sample(double across, double down) const;

  /// Returns the density per steradian at a direction, as `sample` gives it: 0 where nothing is sampled. Throws `Error`
  /// (invalid_argument) for a direction that is zero or not finite.
  [[nodiscard]] double density(const dvec3& direction) const;
};

/// Makes a table. Sums are of doubles in one fixed order: the same bits on any number of threads and every instruction
/// set. Cost: reading the source once and writing the table once, or twice with `mis_compensation`.
/// Throws `Error`: invalid_argument (view, options), rejected_pixel, cancelled.
[[nodiscard]] ImportanceTable importance_table(const LatLongView& source, const ImportanceOptions& options = {},
                                               const Control& control = {});

/// The same into memory of the caller's; returns the integral. Throws `Error` (invalid_argument), too, where a span has
/// another length than it must.
double importance_table(const LatLongView& source, const ImportanceTargets& targets,
                        const ImportanceOptions& options = {}, const Control& control = {});

// ---- Other ways of picking by the same probabilities

/// An entry of an alias table (Walker 1977, Vose 1991).
struct AliasEntry {
  float own = 1.0F;         ///< share of the entry that stands for its own index
  std::uint32_t other = 0;  ///< the index that the rest stands for
};

/// Picks in constant time: an entry of `rows` by one number in [0, 1), then one of that row's `columns`.
struct AliasTable {
  std::vector<AliasEntry> rows;     ///< [height]
  std::vector<AliasEntry> columns;  ///< [height][width]
};

/// Of the table's probabilities, each off by no more than a rounding of floats. The same bits everywhere. Cost: some 10
/// ns a texel and thread.
[[nodiscard]] AliasTable alias_table(const ImportanceTable& table, const Control& control = {});

/// Probabilities of ever larger blocks of texels, for hierarchical warping (Clarberg et al. 2005) and for looking up a
/// direction's density at a level of detail.
struct ImportancePyramid {
  /// A level.
  struct Level {
    int width = 0;                     ///< half that of the level before, rounded up
    int height = 0;                    ///< the same
    std::vector<float> probabilities;  ///< [height][width], whose sum is 1
  };
  std::vector<Level> levels;  ///< from the table's own texels down to a single block
};

/// Each level's blocks are 2 x 2 of the one before; at an edge of odd length what is there. The same bits everywhere.
[[nodiscard]] ImportancePyramid importance_pyramid(const ImportanceTable& table, const Control& control = {});

// ---- What it gains

/// Variance of estimates of the sphere's total weight by one sample, relative to the total's square.
struct ImportanceVariance {
  double uniform = 0.0;  ///< directions all alike
  double table = 0.0;    ///< by the table; infinite where its function leaves out what has a weight
};

/// Exactly, by sums over the source's texels, whose value is even over each. `weight` and `pixels` as the table was
/// made with. Throws `Error`: invalid_argument (view, a table larger than the source), rejected_pixel, cancelled.
[[nodiscard]] ImportanceVariance importance_variance(const LatLongView& source, const ImportanceTable& table,
                                                     ImportanceWeight weight = ImportanceWeight::luminance,
                                                     const PixelPolicy& pixels = {}, const Control& control = {});

}  // namespace welkin
