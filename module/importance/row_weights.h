// Rows of a lat-long as weights, and how its texels overlap those of a coarser table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "projection/sanitizer.h"
#include "welkin/importance.h"

namespace welkin::importance {

/// The weights of an image's rows.
class RowWeights {
 public:
  RowWeights(const LatLongView& source, ImportanceWeight weight, const PixelPolicy& pixels);

  /// Room that `read` needs, for each thread.
  struct Scratch {
    explicit Scratch(const LatLongView& source)
        : rgb(3 * static_cast<std::size_t>(source.width)), weights(rgb.size() / 3) {}
    std::vector<float> rgb;
    std::vector<float> weights;           ///< of the row that was read last: [column], each finite and not negative
    projection::SanitizeRecord record{};  ///< of what has been read with it
  };

  /// Returns `scratch.weights` of a row.
  std::span<const float> read(int row, Scratch& scratch) const;

 private:
  const LatLongView& source_;
  ImportanceWeight weight_;
  projection::Sanitizer sanitizer_;
};

/// Part of a texel that lies in a cell of a table, along one axis.
struct Share {
  int texel;
  double part;  ///< of the texel's width; or of the sphere's height of 2, which a row's solid angle goes by
};

/// For each cell of an axis, the texels that it overlaps.
class Overlaps {
 public:
  /// Columns: even along the circle.
  static Overlaps of_columns(int texels, int cells);
  /// Rows, whose areas go by the cosine of the polar angle.
  static Overlaps of_rows(int texels, int cells);

  [[nodiscard]] std::span<const Share> of(int cell) const noexcept {
    const auto first = first_[static_cast<std::size_t>(cell)];
    return {shares_.data() + first, first_[static_cast<std::size_t>(cell) + 1] - first};
  }
  /// Whether each cell is a texel.
  [[nodiscard]] bool one_to_one() const noexcept { return shares_.size() + 1 == first_.size(); }

 private:
  /// Where an overlap begins or ends: a cell's edge or a texel's.
  struct Edge {
    std::int64_t place;
    bool of_cell;
    std::int64_t cell;
    std::int64_t texel;
  };
  /// `part(begin, end)`: of an overlap.
  template <class Part>
  static Overlaps of(int texels, int cells, const Part& part);

  std::vector<Share> shares_;
  std::vector<std::size_t> first_{0};
};

/// Throws `Error` (rejected_pixel) if what threads have read has pixels that its policy rejects.
template <class Scratches>
void throw_if_rejected(const Scratches& scratches) {
  projection::SanitizeRecord all{};
  for (const RowWeights::Scratch& one : scratches) all.add(one.record);
  projection::throw_if_rejected(all, false);
}

/// -cos of the polar angle at the upper edge of row `row` of `rows`: rises from -1 to 1.
[[nodiscard]] double height_of_edge(int row, int rows) noexcept;

/// Returns the solid angle of a texel of that row, by the same edges.
[[nodiscard]] double texel_solid_angle(int width, int height, int row) noexcept;

/// Throws `Error` (invalid_argument) unless the table has its arrays' lengths right.
void check_table(const ImportanceTable& table);

}  // namespace welkin::importance
