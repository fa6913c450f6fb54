#include "image/padded_picture.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "image/float_plane.h"
#include "image/formats.h"
#include "jobs/tiles.h"

namespace welkin::image {
namespace {

constexpr int kTileTexels = 32768;
constexpr int kBlock = 256;  ///< texels that are decoded at a time

}  // namespace

PaddedPicture::PaddedPicture(const LatLongView& source, int border, const Control& control)
    : width_(source.width),
      border_(border),
      values_(static_cast<std::size_t>(stride()) * static_cast<std::size_t>(source.height)) {
  const std::size_t texel_bytes = bytes_per_texel(source.format);
  const int tile_rows = std::max(1, kTileTexels / width_);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{width_} * source.height);
  jobs::run_tiles(static_cast<std::size_t>((source.height + tile_rows - 1) / tile_rows), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t) {
                    const int first_row = static_cast<int>(tile) * tile_rows;
                    for (int row = first_row; row < std::min(source.height, first_row + tile_rows); ++row) {
                      const auto* const from = static_cast<const std::byte*>(row_of(source, row));
                      float* const line = values_.data() + row * stride();
                      float* const inside = line + std::ptrdiff_t{4} * border_;
                      float rgb[3 * kBlock];
                      for (int first = 0; first < width_; first += kBlock) {
                        const int count = std::min(kBlock, width_ - first);
                        decode_texels(source.format, from + static_cast<std::size_t>(first) * texel_bytes, count, rgb);
                        for (int i = 0; i < count; ++i) {
                          float* const texel = inside + std::ptrdiff_t{4} * (first + i);
                          texel[0] = rgb[3 * i];
                          texel[1] = rgb[3 * i + 1];
                          texel[2] = rgb[3 * i + 2];
                          texel[3] = 0.0F;
                        }
                      }
                      for (int k = 0; k < border_; ++k) {  // one by one: the border may be wider than the picture
                        const int left = width_ - 1 - k % width_;
                        std::memcpy(inside - std::ptrdiff_t{4} * (k + 1), inside + std::ptrdiff_t{4} * left,
                                    4 * sizeof(float));
                        std::memcpy(inside + std::ptrdiff_t{4} * (width_ + k),
                                    inside + std::ptrdiff_t{4} * (k % width_), 4 * sizeof(float));
                      }
                    }
                  });
}

}  // namespace welkin::image
