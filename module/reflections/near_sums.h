// The near part of lobes, summed over the texels of a cubemap or a lat-long: what a far part of few harmonics leaves.
//
// The far part is a polynomial near the direction (`kFarPart`) and all of the lobe beyond. Texels count as areas, so
// the sums are exact but for their weights' quadrature, whatever the light in the texels.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "reflections/near_weights.h"
#include "reflections/source_rows.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Data for a mip's near sums that depend on its split alone: the far part's spectrum, and weights, which images of a
/// direction share: 48 of a cube, 16 of a lat-long.
class NearTable {
 public:
  [[nodiscard]] static std::shared_ptr<const NearTable> get(const NearSplit& split);
  explicit NearTable(const NearSplit& split);

  [[nodiscard]] const NearSplit& split() const noexcept { return split_; }
  /// Returns the far part's spectrum over k_0 of the whole lobe, half as many degrees again as its bands.
  [[nodiscard]] const std::vector<double>& far() const noexcept { return far_; }
  [[nodiscard]] const NearWeights& weights() const noexcept { return weights_; }
  /// Returns a tile of weights; made in `scratch` where all of them are too many to be kept.
  [[nodiscard]] const NearTile& tile(std::size_t index, NearTile& made, NearWeights::Scratch& scratch) const;

  /// Returns the columns of each row of the source's parts that any weight is of; of a lat-long they go on beyond the
  /// ends of the image's rows.
  [[nodiscard]] const std::vector<ColumnRange>& rows() const noexcept { return rows_; }

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns a bound on the bytes of all tiles, or of those that are held at once.
  [[nodiscard]] static std::size_t most_bytes(const NearSplit& split) noexcept;

 private:
  NearSplit split_;
  std::vector<double> far_;
  NearWeights weights_;
  std::vector<ColumnRange> rows_;
  std::vector<NearTile> tiles_;  ///< none: they are made again and again
};

/// Six packed RGB faces of a mip.
struct NearMip {
  std::shared_ptr<const NearTable> table;
  std::array<float*, 6> faces{};
};

/// Adds the near parts to mips that hold the far parts. `rows`: the source's, packed RGB, of a cubemap face after face,
/// cut as the tables' splits have them. The same bits on any number of threads and instruction set. Throws `Error`
/// (cancelled).
void add_near_sums(const std::vector<const float*>& rows, const std::vector<NearMip>& mips, const Control& control);
/// Returns a bound on what that takes, without tables.
[[nodiscard]] std::size_t near_sums_bytes(const NearSplit& split) noexcept;

/// Returns rows of `columns`, their texels cut as a split has them. `source` is to outlive them.
[[nodiscard]] SourceRows cut_rows(std::vector<const float*> source, int columns, const NearSplit& split);

/// Returns where the lobe of a mip is split, from faces of `face`, to take the least time if the far part takes
/// `bands_of_reach` over `reach` bands; none if the faces are too coarse for that.
[[nodiscard]] NearSplit cheapest_split(int face, int size, double alpha, double bands_of_reach) noexcept;
/// Returns the split for a lobe that is narrower than that: sums over many texels' windows and harmonics of many bands
/// take about as long. `rows`: of a lat-long; 0: a cubemap. Texels that are large relative to the near part count as
/// several, so the split has more of them, and a lat-long's columns divide by four.
[[nodiscard]] NearSplit near_far_split(int columns, int rows, int size, double alpha);
/// Returns about the milliseconds of one thread: for a mip by that split, or for any by harmonics of `bands` alone.
[[nodiscard]] double milliseconds_of(const NearSplit& split) noexcept;
[[nodiscard]] double milliseconds_of_harmonics(int bands) noexcept;

}  // namespace welkin::reflections
