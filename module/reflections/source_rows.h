// A source's rows, and how their texels get into records of a sixteenth's images.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "platform/memory.h"
#include "reflections/ring_kernels.h"

namespace welkin::reflections {

/// Rows of packed RGB floats, of a cubemap face after face.
struct SourceRows {
  /// Returns the texels along an edge of a cubemap's faces.
  [[nodiscard]] int face() const noexcept { return static_cast<int>(rows.size() / 6); }

  std::vector<const float*> rows;
  platform::AlignedBuffer<float> owned{};  ///< holds those that are not the caller's own
};

/// Texels of a source that go to one image of records that follow each other.
struct RecordCopy {
  const float* const* rows;  ///< of the source
  int row;
  int down;  ///< rows from each to the next
  int column;
  int across;
  int count;
  int columns;  ///< of a row

  void to(float* record, int image) const {
    int line = row;
    int offset = 3 * column;
    const int last = image + 1 < kRingImages ? 3 * (columns - 1) : 0;
    record += std::ptrdiff_t{3} * image;
    for (int k = 0; k < count; ++k, line += down, offset += 3 * across, record += kRecordFloats) {
      // a fourth float is overwritten by the next image
      if (offset < last)
        std::memcpy(record, rows[line] + offset, 4 * sizeof(float));
      else
        std::memcpy(record, rows[line] + offset, 3 * sizeof(float));
    }
  }
};

}  // namespace welkin::reflections
