// A source's texels, each with its images by the cube's symmetries beside it: one weight does for all of them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "image/cube_symmetry.h"
#include "platform/memory.h"
#include "projection/sanitized_pixels.h"
#include "reflections/narrow_kernels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// How a source is cut into texels that count as several, so that they are small beside the near part and a lat-long's
/// columns divide by four.
struct TexelParts {
  int columns = 1;
  int rows = 1;
};

/// Those texels that lobes reach whose directions have a longitude from 0 (+z) to an eighth of a turn (towards +x) and
/// a latitude of 0 or more. The other directions are images of those.
class TexelImages {
 public:
  /// `reach`: radians. Throws `Error` (cancelled).
  TexelImages(const projection::SanitizedSource& source, const TexelParts& parts, double reach, const Control& control);

  [[nodiscard]] bool cubemap() const noexcept { return cubemap_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }  ///< with parts; of a cubemap's face
  [[nodiscard]] int rows() const noexcept { return rows_; }
  /// A lat-long's one patch, or the faces +z, +x and +y of a cubemap.
  [[nodiscard]] static constexpr std::array<int, 3> faces() noexcept { return {4, 0, 2}; }
  [[nodiscard]] int patches() const noexcept { return static_cast<int>(patches_.size()); }

  struct Row {
    ColumnRange columns;  ///< that are there; of a lat-long they go on beyond the ends of the picture's rows
    float* texels;        ///< their images, [kImages][3] each: those of `image::cube_image_of`
  };
  [[nodiscard]] const Row& row(int patch, int row) const noexcept {
    const Patch& own = patches_[static_cast<std::size_t>(patch)];
    const auto index = static_cast<std::size_t>(row - own.first_row);  // far too large for rows before the first
    return index < own.rows.size() ? own.rows[index] : none_;
  }

  [[nodiscard]] std::size_t bytes() const noexcept { return floats_.bytes(); }
  /// Of such a source.
  [[nodiscard]] static std::size_t bytes_for(bool cubemap, int columns, int rows, double reach) noexcept;

 private:
  struct Patch {
    int first_row;
    std::vector<Row> rows;
  };

  static std::vector<Patch> patches_for(bool cubemap, int columns, int rows, double reach);
  void fill(const projection::SanitizedSource& source, const TexelParts& parts, int patch, int row);

  bool cubemap_;
  int columns_;
  int rows_;
  Row none_{};
  std::vector<Patch> patches_;
  platform::AlignedBuffer<float> floats_;
};

}  // namespace welkin::reflections
