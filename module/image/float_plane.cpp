#include "image/float_plane.h"

#include "image/formats.h"

namespace welkin::image {
namespace {

const void* row_at(const void* pixels, std::ptrdiff_t stride, PixelFormat format, int width, int row) noexcept {
  const std::ptrdiff_t packed = static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  return static_cast<const std::byte*>(pixels) + (stride != 0 ? stride : packed) * row;
}

}  // namespace

const void* row_of(const LatLongView& view, int row) noexcept {
  return row_at(view.pixels, view.row_stride_bytes, view.format, view.width, row);
}

const void* row_of(const CubemapView& view, int face, int row) noexcept {
  return row_at(view.faces[static_cast<std::size_t>(face)], view.row_stride_bytes, view.format, view.size, row);
}

template <typename RowOf>
FloatPlane::FloatPlane(PixelFormat format, int width, int height, const RowOf& address_of_row)
    : row_floats_(std::ptrdiff_t{3} * width) {
  if (format == PixelFormat::rgb_f32) {
    first_ = static_cast<const float*>(address_of_row(0));
    if (height > 1) row_floats_ = static_cast<const float*>(address_of_row(1)) - first_;
    return;
  }
  decoded_ = std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(row_floats_ * height));
  for (int row = 0; row < height; ++row) {
    decode_texels(format, address_of_row(row), width, decoded_.get() + row * row_floats_);
  }
  first_ = decoded_.get();
}

FloatPlane::FloatPlane(const LatLongView& view)
    : FloatPlane(view.format, view.width, view.height, [&](int row) { return row_of(view, row); }) {}

FloatPlane::FloatPlane(const CubemapView& view, int face)
    : FloatPlane(view.format, view.size, view.size, [&](int row) { return row_of(view, face, row); }) {}

}  // namespace welkin::image
