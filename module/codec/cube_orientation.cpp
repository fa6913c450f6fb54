#include "codec/cube_orientation.h"

#include <algorithm>
#include <utility>

namespace welkin::codec {
namespace {

class ReframingReader final : public RowReader {
 public:
  ReframingReader(std::unique_ptr<RowReader> reader, int size)
      : reader_(std::move(reader)), size_(size), row_floats_(std::size_t{3} * static_cast<std::size_t>(size)) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int end = first_row + row_count;
    for (int row = first_row; row < end;) {
      const int face = row / size_;
      const int part_end = std::min(end, (face + 1) * size_);
      float* place = rgb + static_cast<std::size_t>(row - first_row) * row_floats_;
      if (face == 2 || face == 3) {
        read_upside_down(face, row, part_end, place);
      } else {
        read_mirrored(row, part_end, place);
      }
      row = part_end;
    }
  }

 private:
  void read_mirrored(int first_row, int end_row, float* rgb) {
    reader_->read(first_row, end_row - first_row, rgb);
    for (int row = first_row; row < end_row; ++row, rgb += row_floats_) {
      for (std::size_t left = 0, right = row_floats_ - 3; left < right; left += 3, right -= 3) {
        std::swap_ranges(rgb + left, rgb + left + 3, rgb + right);
      }
    }
  }

  // Row r of the face is row size - 1 - r of the stored one.
  void read_upside_down(int face, int first_row, int end_row, float* rgb) {
    const int row_count = end_row - first_row;
    const int stored_first = (2 * face + 1) * size_ - end_row;
    reader_->read(stored_first, row_count, rgb);
    float* top = rgb;
    float* bottom = rgb + static_cast<std::size_t>(row_count - 1) * row_floats_;
    for (; top < bottom; top += row_floats_, bottom -= row_floats_) {
      std::swap_ranges(top, top + row_floats_, bottom);
    }
  }

  std::unique_ptr<RowReader> reader_;
  int size_;
  std::size_t row_floats_;
};

}  // namespace

std::unique_ptr<RowReader> reframe_openexr_cube(std::unique_ptr<RowReader> reader, int size) {
  return std::make_unique<ReframingReader>(std::move(reader), size);
}

}  // namespace welkin::codec
