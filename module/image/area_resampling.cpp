// Light moved from a lat-long's texels to a cube's, and back, by the area that they have in common.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "image/area_weights.h"
#include "image/geometry.h"
#include "image/image_kernels.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "platform/memory.h"
#include "platform/standard_library.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::image {
namespace {

constexpr int kTileTexels = 16384;
constexpr std::int64_t kInlineTexels = 8192;
constexpr double kShareOfCopy = 0.2;
constexpr int kReadBeyond = 2;  ///< texels that kernels read right of a patch

// To the cube: each texel is a weighted mean of the lat-long's.

/// Draws all images of a run of tiles.
class CubeMeans {
 public:
  /// `patch`: memory for the RGB of the largest patch, and of what is read beyond it.
  CubeMeans(const TileWeights& weights, const FloatPlane& image, const std::array<float*, 6>& faces, float* patch)
      : weights_(weights), image_(image), faces_(faces), patch_(patch) {}

  void operator()(const WeighedRun& run) {
    const std::span<const std::int32_t> columns(run.patches.columns, static_cast<std::size_t>(run.patches.count));
    const auto [lowest, highest] = platform::ranges::minmax(columns);
    for (const TileImage& image : images_of(run.kind)) {
      PlacedRun placed;
      if (!place_image(image, run, weights_.size(), weights_.width(), placed)) continue;
      PatchRun& patches = placed.patches;
      patches.origin = image_.texel(0, image.below ? weights_.height() - 1 : 0);
      patches.row_stride = image.below ? -image_.row_floats() : image_.row_floats();
      float* const rgb = faces_[static_cast<std::size_t>(image.face)] + placed.offset;
      if (is_inside(patches, lowest) && is_inside(patches, highest)) {
        kernels_.sample_patches(patches, rgb);
      } else {
        draw_at_seam(patches, rgb);
      }
    }
  }

 private:
  /// The image's column where a patch begins whose first column is `column`, or whose last one where it is mirrored.
  static int left_of(const PatchRun& run, int column) noexcept {
    return run.mirrored ? run.base - column - 4 * run.patch_groups : run.base + column;
  }

  [[nodiscard]] bool is_inside(const PatchRun& run, int column) const noexcept {
    const int left = left_of(run, column);
    return left >= 0 && left + 4 * run.patch_groups + kReadBeyond <= weights_.width();
  }

  /// Draws patches that lie across the image's seam from copies of their texels, and the others between them as
  /// usual.
  void draw_at_seam(const PatchRun& run, float* rgb) {
    for (int first = 0; first < run.count;) {
      int end = first;
      while (end < run.count && is_inside(run, run.columns[end])) ++end;
      if (end > first) {
        kernels_.sample_patches(part_of(run, first, end - first), rgb + first * run.rgb_step);
      } else {
        kernels_.sample_patches(copied(part_of(run, first, 1)), rgb + first * run.rgb_step);
        ++end;
      }
      first = end;
    }
  }

  /// A run of one patch, from a copy of its texels.
  [[nodiscard]] PatchRun copied(PatchRun run) {
    static constexpr std::int32_t kFirst = 0;
    const int across = 4 * run.patch_groups;
    const int width = weights_.width();
    const int left = (left_of(run, *run.columns) % width + width) % width;
    for (int row = 0; row < run.patch_rows; ++row) {
      const float* const from = run.origin + (*run.rows + row) * run.row_stride;
      float* const to = patch_ + std::ptrdiff_t{3} * across * row;
      for (int k = 0; k < across; ++k) std::copy_n(from + std::ptrdiff_t{3} * ((left + k) % width), 3, to + 3 * k);
    }
    run.origin = patch_;
    run.row_stride = std::ptrdiff_t{3} * across;
    run.rows = run.columns = &kFirst;
    run.base = run.mirrored ? across : 0;
    return run;
  }

  const ImageKernels& kernels_ = image_kernels();
  const TileWeights& weights_;
  const FloatPlane& image_;
  std::array<float*, 6> faces_;
  float* patch_;
};

/// The first call for sizes costs a few times as much as those that follow, for which weights are kept
/// (TileWeightTable).
void fill_by_area(const LatLongView& source, int size, const std::array<float*, 6>& faces, const Control& control) {
  const TileWeightKey key{source.width, source.height, size};
  const std::shared_ptr<const TileWeightTable> kept = TileWeightTable::find(key);
  const auto made = kept ? nullptr : std::make_shared<TileWeightTable>(key);
  const TileWeightTable& table = kept ? *kept : *made;
  const TileWeights& weights = table.weights();
  const FloatPlane image(source, jobs::part_of(control, 0.0, kShareOfCopy));
  const std::int64_t work = std::int64_t{6} * size * size + std::int64_t{source.width} * source.height;
  const jobs::Placement placement = work <= kInlineTexels ? jobs::Placement::calling_thread : jobs::Placement::arena;
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<platform::AlignedBuffer<float>> patches;
  for (std::size_t k = 0; k < workers; ++k) patches.emplace_back(3 * (weights.largest_patch() + kReadBeyond));
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
                    CubeMeans means(weights, image, faces, patches[worker].data());
                    const int first = static_cast<int>(tile % tiles) * tile_lines;
                    const bool polar = tile >= tiles;
                    for (int row = first; row < std::min(first + tile_lines, lines); ++row) {
                      if (made) {
                        made->fill(polar, row, scratch[worker], std::ref(means));
                      } else {
                        kept->read(polar, row, scratch.empty() ? nullptr : &scratch[worker], std::ref(means));
                      }
                    }
                  });
  if (made) TileWeightTable::keep(key, made);
}

// To the lat-long: each of the cube's texels gives every texel that it overlaps its share.

constexpr double kPi = std::numbers::pi;

/// Which part of the sphere is at work.
enum class Part { all, north, south };

/// Adds all images of a run of tiles.
class RingSums {
 public:
  RingSums(const TileWeights& weights, const std::array<const float*, 6>& faces, Part part, double* sums)
      : weights_(weights), faces_(faces), part_(part), sums_(sums) {}

  void operator()(const WeighedRun& run) {
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
        const int index = (run.mirrored ? run.base - 1 - column : run.base + column) % weights_.width();
        double* const sum = line + std::ptrdiff_t{3} * (index < 0 ? index + weights_.width() : index);
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
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{12} * source.size;
  const bool is_packed =
      source.format == PixelFormat::rgb32f && (source.row_stride_bytes == 0 || source.row_stride_bytes == row_bytes);
  Cubemap copy;
  if (!is_packed) copy = build_mips(source, MipFilter::box, 1, jobs::part_of(control, 0.0, kShareOfCopy));
  std::array<const float*, 6> faces{};
  for (std::size_t face = 0; face < faces.size(); ++face)
    faces[face] = is_packed ? static_cast<const float*>(source.faces[face]) : copy.face(0, static_cast<int>(face));
  const std::size_t values = std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  platform::AlignedBuffer<double> sums(values);
  std::fill_n(sums.data(), values, 0.0);
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
                        weights.weigh(weights.kind_of(polar, row), row, scratch[tile], std::ref(ring_sums));
                      }
                    }
                  });
  for (int row = 0; row < height; ++row) {
    // A texel's height on the axis of y: its solid angle is that times 2 pi / width.
    const double area = lat_long_texel_solid_angle(width, height, row) * width / (2.0 * kPi);
    const std::size_t first = std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(row);
    for (std::size_t i = first; i < first + 3 * static_cast<std::size_t>(width); ++i) {
      rgb[i] = static_cast<float>(sums.data()[i] / area);
    }
  }
}

namespace {

// The faces of a cubemap from a lat-long: by area, or by samples of a grid on the sphere.

constexpr int kGridTileTexels = 32768;
constexpr int kBlock = 256;  ///< texels that are decoded at a time

SphereGrid grid_of(const LatLongView& source, const Control& control) {
  SphereGrid grid(source.height, source.width, GridContent::samples);
  const std::size_t texel_bytes = bytes_per_texel(source.format);
  const int tile_rows = std::max(1, kGridTileTexels / source.width);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{source.width} * source.height);
  jobs::run_rows(source.height, tile_rows, placement, jobs::worker_count(placement), control,
                 [&](int row, std::size_t) {
                   const auto* const from = static_cast<const std::byte*>(row_of(source, row));
                   float rgb[3 * kBlock];
                   for (int first = 0; first < source.width; first += kBlock) {
                     const int count = std::min(kBlock, source.width - first);
                     decode_texels(source.format, from + static_cast<std::size_t>(first) * texel_bytes, count, rgb);
                     float* texel = grid.texel(first, row);
                     for (int i = 0; i < count; ++i, texel += 4) {
                       std::copy_n(rgb + 3 * i, 3, texel);
                       texel[3] = 0.0F;
                     }
                   }
                   grid.fill_sides(row, 1);
                 });
  grid.fill_poles();
  return grid;
}

}  // namespace

void fill_cubemap(const LatLongView& source, Cubemap& cubemap, int level, ResampleFilter filter,
                  const Control& control) {
  const int size = cubemap.level_size(level);
  const std::array<float*, 6> faces = faces_of(cubemap, level);
  if (filter == ResampleFilter::area) return fill_by_area(source, size, faces, control);
  constexpr double kShareOfGrid = 0.3;
  const SphereGrid grid = grid_of(source, jobs::part_of(control, 0.0, kShareOfGrid));
  sample_faces(grid, size, faces, {}, jobs::part_of(control, kShareOfGrid, 1.0));
}

}  // namespace welkin::image
