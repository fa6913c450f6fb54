// To the lat-long: each of the cube's texels gives every texel that it overlaps its share.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "image/area_cubemap.h"
#include "image/texel_geometry.h"
#include "image/tile_weights.h"
#include "jobs/tiles.h"
#include "welkin/cubemap_chain.h"
#include "welkin/error.h"
#include "welkin/mip_chain.h"

namespace welkin::image {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kInlineTexels = 8192;
constexpr double kShareOfCopy = 0.2;

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
    const simd::PatchRun& run = placed.patches;
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
                      if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
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

}  // namespace welkin::image
