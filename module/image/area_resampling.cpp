// To the cube: each texel is a weighted mean of the lat-long's.
#include "image/area_resampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <vector>

#include "image/area_weights.h"
#include "image/geometry.h"
#include "image/image_kernels.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::image {
namespace {

constexpr int kTileTexels = 16384;
constexpr std::int64_t kInlineTexels = 8192;
constexpr double kShareOfCopy = 0.2;

/// Draws all images of a run of tiles.
class CubeMeans final : public RunSink {
 public:
  CubeMeans(const TileWeights& weights, const PaddedPicture& picture, const std::array<float*, 6>& faces)
      : weights_(weights), picture_(picture), faces_(faces) {}

  void take(const WeighedRun& run) override {
    for (const TileImage& image : images_of(run.kind)) {
      PlacedRun placed;
      if (!place_image(image, run, weights_.size(), weights_.width(), placed)) continue;
      placed.patches.origin = picture_.texel(0, image.below ? weights_.height() - 1 : 0);
      placed.patches.row_stride = image.below ? -picture_.stride() : picture_.stride();
      kernels_.sample_patches(placed.patches, faces_[static_cast<std::size_t>(image.face)] + placed.offset);
    }
  }

 private:
  const ImageKernels& kernels_ = image_kernels();
  const TileWeights& weights_;
  const PaddedPicture& picture_;
  std::array<float*, 6> faces_;
};

}  // namespace

void fill_cubemap_by_area(const LatLongView& source, int size, const std::array<float*, 6>& faces,
                          const Control& control) {
  const TileWeightKey key{source.width, source.height, size};
  const std::shared_ptr<const TileWeightTable> kept = TileWeightTable::find(key);
  const auto made = kept ? nullptr : std::make_shared<TileWeightTable>(key);
  const TileWeightTable& table = kept ? *kept : *made;
  const TileWeights& weights = table.weights();
  const PaddedPicture picture(source, weights.border(), jobs::part_of(control, 0.0, kShareOfCopy));
  const std::int64_t work = std::int64_t{6} * size * size + std::int64_t{source.width} * source.height;
  const jobs::Placement placement = work <= kInlineTexels ? jobs::Placement::calling_thread : jobs::Placement::arena;
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<TileScratch> scratch;
  if (!table.complete()) {
    scratch.reserve(workers);
    for (std::size_t k = 0; k < workers; ++k) scratch.emplace_back(weights);
  }
  const int lines = weights.lines();
  const int tile_lines = std::max(1, kTileTexels / (16 * lines));
  const auto tiles = static_cast<std::size_t>((lines + tile_lines - 1) / tile_lines);
  jobs::run_tiles(2 * tiles, placement, workers, jobs::part_of(control, kShareOfCopy, 1.0),
                  [&](std::size_t tile, std::size_t worker) {
                    CubeMeans means(weights, picture, faces);
                    const int first = static_cast<int>(tile % tiles) * tile_lines;
                    const bool polar = tile >= tiles;
                    for (int row = first; row < std::min(first + tile_lines, lines); ++row) {
                      if (made) {
                        made->fill(polar, row, scratch[worker], means);
                      } else {
                        kept->read(polar, row, scratch.empty() ? nullptr : &scratch[worker], means);
                      }
                    }
                  });
  if (made) TileWeightTable::keep(key, made);
}

namespace {

// To the lat-long: each of the cube's texels gives every texel that it overlaps its share.

constexpr double kPi = std::numbers::pi;

/// Which part of the sphere is at work.
enum class Part { all, north, south };

/// Adds all images of a run of tiles.
class RingSums final : public RunSink {
 public:
  RingSums(const TileWeights& weights, const std::array<const float*, 6>& faces, Part part, double* sums)
      : weights_(weights), faces_(faces), part_(part), sums_(sums) {}

  void take(const WeighedRun& run) override {
    for (const TileImage& image : images_of(run.kind)) {
      if (part_ != Part::all && image.below != (part_ == Part::south)) continue;
      PlacedRun placed;
      if (!place_image(image, run, weights_.size(), weights_.width(), placed)) continue;
      for (int k = 0; k < placed.patches.count; ++k) add_texel(image, placed, k);
    }
  }

 private:
  void add_texel(const TileImage& image, const PlacedRun& placed, int k) {
    const PatchRun& run = placed.patches;
    const bool product = run.row_weights != nullptr;
    const int across = 4 * run.patch_groups;
    const float* const rgb = faces_[static_cast<std::size_t>(image.face)] + placed.offset + k * run.rgb_step;
    for (int i = 0; i < run.patch_rows; ++i) {
      const int row = run.rows[k] + i;
      double* const line =
          sums_ + std::ptrdiff_t{3} * weights_.width() * (image.below ? weights_.height() - 1 - row : row);
      const float* const weights = run.weights + std::ptrdiff_t{across} * (product ? k : k * run.patch_rows + i);
      const double scale =
          product ? placed.areas[k] * static_cast<double>(run.row_weights[k * run.patch_rows + i]) : placed.areas[k];
      for (int j = 0; j < across; ++j) {
        const double weight = scale * static_cast<double>(weights[j]);
        if (weight == 0.0) continue;
        const int column = run.columns[k] + j;
        const int place = (run.mirrored ? run.base - 1 - column : run.base + column) % weights_.width();
        double* const sum = line + std::ptrdiff_t{3} * (place < 0 ? place + weights_.width() : place);
        for (int c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(rgb[c]);
      }
    }
  }

  const TileWeights& weights_;
  std::array<const float*, 6> faces_;
  Part part_;
  double* sums_;
};

}  // namespace

void fill_lat_long_by_area(const CubemapView& source, int width, int height, float* rgb, const Control& control) {
  const CubemapChain packed = build_mips(source, MipFilter::box, 1, jobs::part_of(control, 0.0, kShareOfCopy));
  std::array<const float*, 6> faces{};
  for (std::size_t face = 0; face < faces.size(); ++face) faces[face] = packed.face(0, static_cast<int>(face));
  const std::size_t values = std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<double> sums(values, 0.0);
  // Tiles of the two hemispheres share no texel of the lat-long if the equator is an edge in both.
  const bool parted = source.size % 2 == 0 && height % 2 == 0;
  const std::vector<Part> parts = parted ? std::vector{Part::north, Part::south} : std::vector{Part::all};
  const std::int64_t work = std::int64_t{6} * source.size * source.size + std::int64_t{width} * height;
  const jobs::Placement placement = work <= kInlineTexels ? jobs::Placement::calling_thread : jobs::Placement::arena;
  const TileWeights weights(width, height, source.size, false);
  std::vector<TileScratch> scratch;
  scratch.reserve(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) scratch.emplace_back(weights);
  jobs::run_tiles(parts.size(), placement, jobs::worker_count(placement), jobs::part_of(control, kShareOfCopy, 1.0),
                  [&](std::size_t tile, std::size_t) {
                    RingSums ring_sums(weights, faces, parts[tile], sums.data());
                    for (int row = 0; row < weights.lines(); ++row) {
                      jobs::throw_if_cancelled(control);
                      for (const bool polar : {false, true}) {
                        weights.weigh(weights.kind_of(polar, row), row, scratch[tile], ring_sums);
                      }
                    }
                  });
  for (int row = 0; row < height; ++row) {
    // A texel's height on the axis of y: its solid angle is that times 2 pi / width.
    const double area = lat_long_texel_solid_angle(width, height, row) * width / (2.0 * kPi);
    const std::size_t first = std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(row);
    for (std::size_t i = first; i < first + 3 * static_cast<std::size_t>(width); ++i) {
      rgb[i] = static_cast<float>(sums[i] / area);
    }
  }
}

namespace {

constexpr int kPaddingTileTexels = 32768;
constexpr int kBlock = 256;  ///< texels that are decoded at a time

}  // namespace

PaddedPicture::PaddedPicture(const LatLongView& source, int border, const Control& control)
    : width_(source.width),
      border_(border),
      values_(static_cast<std::size_t>(stride()) * static_cast<std::size_t>(source.height)) {
  const std::size_t texel_bytes = bytes_per_texel(source.format);
  const int tile_rows = std::max(1, kPaddingTileTexels / width_);
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
