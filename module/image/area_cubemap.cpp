// To the cube: each texel is a weighted mean of the lat-long's.
#include "image/area_cubemap.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "image/padded_picture.h"
#include "image/tile_weight_table.h"
#include "jobs/tiles.h"
#include "simd/kernels.h"

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
  const simd::Kernels& kernels_ = simd::active_kernels();
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

}  // namespace welkin::image
