// What a face of a cubemap adds to a projection.
#pragma once

#include <cstddef>
#include <vector>

#include "sh/pixel_policy.h"

namespace welkin::sh {

/// In the face's own frame: the same for the same pixels on any face.
struct FaceSums {
  FaceSums(std::size_t tiles, int bands)
      : functions(static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands)),
        values(tiles * 3 * functions),
        records(tiles) {}

  std::size_t functions;
  std::vector<double> values;           ///< of each tile, [3][functions] in the order of the weights
  std::vector<CleaningRecord> records;  ///< of each tile

  [[nodiscard]] double* tile(std::size_t index) noexcept { return values.data() + index * 3 * functions; }
  [[nodiscard]] const double* tile(std::size_t index) const noexcept { return values.data() + index * 3 * functions; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof *this + values.size() * sizeof(double) + records.size() * sizeof(CleaningRecord);
  }
};

}  // namespace welkin::sh
