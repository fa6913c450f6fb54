#include "image/tile_images.h"

namespace welkin::image {
namespace {

constexpr std::array<TileImage, 16> kSideImages = [] {
  // x = M - p where u > 0, M + p where u < 0, M being the middle of the face; -Z has the seam in its middle.
  constexpr int faces[] = {4, 0, 1, 5};
  constexpr int left[] = {2, 1, 3, 0};
  constexpr int right[] = {2, 1, 3, 4};
  std::array<TileImage, 16> images{};
  std::size_t next = 0;
  for (int k = 0; k < 4; ++k) {
    for (const bool below : {false, true}) {
      images[next++] = {faces[k], left[k], false, below, false, below, false};
      images[next++] = {faces[k], right[k], true, below, true, below, false};
    }
  }
  return images;
}();

constexpr std::array<TileImage, 16> kPolarImages = [] {
  // On +Y: {quarter, mirrored, u > 0, v > 0, swapped}. On -Y the same with v turned over.
  struct Place {
    int quarter;
    bool mirrored, right, lower, swapped;
  };
  constexpr Place places[] = {{2, true, true, true, false},   {2, false, false, true, false},
                              {0, false, true, false, false}, {4, true, false, false, false},
                              {1, false, true, true, true},   {1, true, true, false, true},
                              {3, true, false, true, true},   {3, false, false, false, true}};
  std::array<TileImage, 16> images{};
  std::size_t next = 0;
  for (const Place& p : places) {
    images[next++] = {2, p.quarter, p.mirrored, false, p.right, p.lower, p.swapped};
    images[next++] = {3, p.quarter, p.mirrored, true, p.right, !p.lower, p.swapped};
  }
  return images;
}();

constexpr std::array<TileImage, 2> kPoleImages{
    {{2, 0, false, false, true, true, false}, {3, 0, false, true, true, true, false}}};

}  // namespace

int rest_of(const TileImage& image, int width) noexcept {
  const int rest = image.quarter * (width % 4) % 4;
  return image.mirrored ? (4 - rest) % 4 : rest;
}

std::span<const TileImage> images_of(TileKind kind) noexcept {
  switch (kind) {
    case TileKind::side: return kSideImages;
    case TileKind::polar: return kPolarImages;
    default: return kPoleImages;
  }
}

bool place_image(const TileImage& image, const WeighedRun& run, int size, int width, PlacedRun& placed) {
  if (rest_of(image, width) != run.rest) return false;
  const bool odd = size % 2 != 0;
  if (run.kind == TileKind::side && odd && run.line == 0 && image.below) return false;  // both are the middle line
  simd::PatchRun patches = run.patches;
  const double* areas = run.areas;
  int first = run.first;
  // On the diagonal a texel is its own image with u and v exchanged.
  if (image.swapped && first + patches.count > run.line) patches.count = run.line - first;
  const bool rising = image.swapped ? image.lower : image.right;
  if (!rising && first == 0 && odd) {  // the middle texel of an odd number is its own image too
    ++first;
    ++patches.rows;
    ++patches.columns;
    patches.weights += 4 * patches.patch_groups * (patches.row_weights != nullptr ? 1 : patches.patch_rows);
    if (patches.row_weights != nullptr) patches.row_weights += patches.patch_rows;
    if (areas != nullptr) ++areas;
    --patches.count;
  }
  if (patches.count <= 0) return false;
  const int half = (size + 1) / 2;
  const auto place = [&](int index, bool positive) { return positive ? size - half + index : half - 1 - index; };
  const int along = place(first, rising);
  const int fixed = place(run.line, image.swapped ? image.right : image.lower);
  const std::ptrdiff_t step = image.swapped ? size : 1;
  patches.rgb_step = std::ptrdiff_t{3} * (rising ? step : -step);
  patches.base = static_cast<int>((std::ptrdiff_t{image.quarter} * width + (image.mirrored ? 3 : 0)) / 4);
  patches.mirrored = image.mirrored;
  const std::ptrdiff_t column = image.swapped ? fixed : along;
  const std::ptrdiff_t row = image.swapped ? along : fixed;
  placed = {patches, areas, std::ptrdiff_t{3} * (row * size + column)};
  return true;
}

}  // namespace welkin::image
