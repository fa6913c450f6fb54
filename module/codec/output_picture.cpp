#include "codec/output_picture.h"

#include <algorithm>

#include "image/float_plane.h"
#include "image/formats.h"
#include "welkin/error.h"

namespace welkin::codec {

OutputPicture::OutputPicture(const LatLongView& view)
    : width_(view.width), height_(view.height), read_row_([view](int row, float* rgb) {
        image::decode_texels(view.format, image::row_of(view, row), view.width, rgb);
      }) {}

OutputPicture::OutputPicture(const CubemapView& view, int face)
    : width_(view.size), height_(view.size), read_row_([view, face](int row, float* rgb) {
        image::decode_texels(view.format, image::row_of(view, face, row), view.size, rgb);
      }) {}

OutputPicture::OutputPicture(const CubemapView& view, const CubePlacement& placement)
    : width_(view.size * placement.columns), height_(view.size * placement.rows) {
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(width_);
  auto face_row = std::make_shared<std::vector<float>>(std::size_t{3} * static_cast<std::size_t>(view.size));
  read_row_ = [view, &placement, row_floats, face_row](int row, float* rgb) {
    std::fill_n(rgb, row_floats, 0.0F);
    for (const FaceSegment& segment : row_segments(placement, view.size, row)) {
      image::decode_texels(view.format, image::row_of(view, segment.face, segment.face_row), view.size,
                           face_row->data());
      copy_segment(face_row->data(), rgb + std::size_t{3} * static_cast<std::size_t>(segment.first_column), view.size,
                   segment.mirrored);
    }
  };
}

void report_rows(const WriteJob& job, int done, int height) {
  if (job.control.stop.stop_requested()) {
    throw Error(ErrorCode::cancelled, "cancelled by the caller");
  }
  if (job.control.progress && done > 0) {
    job.control.progress(static_cast<double>(done) / height);
  }
}

}  // namespace welkin::codec
