// The shapes of tiles, and where their images lie.
#include <cmath>
#include <numbers>
#include <utility>

#include "image/area_weights.h"
#include "math/elementary.h"

namespace welkin::image {
namespace {

double arc(double y, double x) noexcept { return math::turns_of(y, x) * (2.0 * std::numbers::pi); }

double length(double u, double v) noexcept { return std::sqrt(1.0 + u * u + v * v); }

}  // namespace

CubeTiling::CubeTiling(int size) : size_(size), half_((size + 1) / 2) {
  for (int index = 0; index <= half_; ++index) longitudes_.push_back(arc(edge(index), 1.0));
}

// Along v = constant, y = v / sqrt(1 + u^2 + v^2) and d(longitude) = du / (1 + u^2): the integral of y over longitude
// is atan(u v / sqrt(1 + u^2 + v^2)).
void CubeTiling::side_heights(int line, double* heights) const noexcept {
  const double v = static_cast<double>(size_ - 2 * line) / size_;
  const auto integral = [&](int index) {
    const double u = edge(index);
    return arc(u * v, length(u, v));
  };
  double before = integral(0);
  for (int column = 0; column < half_; ++column) {
    const double after = integral(column + 1);
    heights[column] = -(after - before) / (longitude(column + 1) - longitude(column));
    before = after;
  }
}

CubeTiling::Border CubeTiling::border(int column) const noexcept {
  const auto integral = [](double u) { return arc(u, length(u, 1.0)); };
  const double u = 0.5 * (edge(column) + edge(column + 1));
  const double middle = arc(u, 1.0);
  const double at_middle = integral(u);
  return {middle, -(at_middle - integral(edge(column))) / (middle - longitude(column)),
          -(integral(edge(column + 1)) - at_middle) / (longitude(column + 1) - middle)};
}

PolarRow::PolarRow(const CubeTiling& tiling) : tiling_(tiling) {
  const auto count = static_cast<std::size_t>(tiling.half() + 2);
  for (Line* line : {&inner_, &outer_}) {
    for (auto* values :
         {&line->longitudes, &line->point_heights, &line->middles, &line->first_heights, &line->second_heights}) {
      values->resize(count);
    }
  }
  uprights_.resize(count);
  outer_ends_.resize(count);
}

// Along v = constant, y = 1 / sqrt(1 + u^2 + v^2) and d(longitude) = v du / (u^2 + v^2): the integral of y over
// longitude is atan(u / (v sqrt(1 + u^2 + v^2))).
void PolarRow::fill_line(int index, Line& line) const noexcept {
  const double v = tiling_.edge(index);
  struct Point {
    double longitude;
    double integral;
  };
  const auto point = [&](double u) { return Point{arc(u, v), arc(u, v * length(u, v))}; };
  const auto mean = [](const Point& a, const Point& b) {
    return -(b.integral - a.integral) / (b.longitude - a.longitude);
  };
  Point before{};
  for (int column = 0; column <= index; ++column) {
    const auto k = static_cast<std::size_t>(column);
    const double u = tiling_.edge(column);
    const Point here = point(u);
    line.longitudes[k] = here.longitude;
    line.point_heights[k] = -1.0 / length(u, v);
    if (column > 0) {
      const Point middle = point(0.5 * (u + tiling_.edge(column - 1)));
      line.middles[k - 1] = middle.longitude;
      line.first_heights[k - 1] = mean(before, middle);
      line.second_heights[k - 1] = mean(middle, here);
    }
    before = here;
  }
}

// Along u = constant, the integral of longitude over y is, by parts, [longitude y] less that of y over longitude, which
// is -atan(v / (u sqrt(1 + u^2 + v^2))).
void PolarRow::place(int row) {
  const bool pole = row == 0 && tiling_.size() % 2 != 0;
  if (row == row_ + 1) {
    std::swap(inner_, outer_);
  } else if (!pole) {
    fill_line(row, inner_);
  }
  fill_line(row + 1, outer_);
  const bool follows = row == row_ + 1 && row > 1;  // then all ends but the last are known
  row_ = row;
  if (pole) return;
  for (int column = 0; column <= row; ++column) {
    const auto k = static_cast<std::size_t>(column);
    const double u = tiling_.edge(column);
    const auto end_at = [&](double v) {
      const double r = length(u, v);
      return End{1.0 / r, arc(u, v) / r + arc(v, u * r)};
    };
    const auto mean = [&](const End& a, const End& b) {
      return u == 0.0 ? 0.0 : (b.integral - a.integral) / (b.y - a.y);
    };
    const End inner = follows && column < row ? outer_ends_[k] : end_at(tiling_.edge(row));
    const End middle = end_at(0.5 * (tiling_.edge(row) + tiling_.edge(row + 1)));
    const End outer = end_at(tiling_.edge(row + 1));
    uprights_[k] = {mean(inner, middle), mean(middle, outer), -middle.y};
    outer_ends_[k] = outer;
  }
}

int PolarRow::sides(int column, TileSide* sides) const noexcept {
  const auto left = static_cast<std::size_t>(column);
  const auto right = left + 1;
  TileSide* side = sides;
  const Upright& start = uprights_[left];
  if (column < row_) {
    const Upright& end = uprights_[right];
    const double outer_right = outer_.point_heights[right];
    *side++ = {inner_.longitudes[left], inner_.point_heights[left], inner_.first_heights[left]};
    *side++ = {inner_.middles[left], inner_.first_heights[left], inner_.second_heights[left]};
    *side++ = {inner_.longitudes[right], inner_.second_heights[left], inner_.point_heights[right]};
    *side++ = {end.inner_longitude, inner_.point_heights[right], end.middle_height};
    *side++ = {end.outer_longitude, end.middle_height, outer_right};
    *side++ = {outer_.longitudes[right], outer_right, outer_.second_heights[left]};
  } else {
    // On the diagonal: the lower and the right edge are the left and the upper one's mirror images; at the corner both
    // edges have the same height, and their ends cancel.
    const double quarter = 0.5 * std::numbers::pi;
    const double corner = outer_.point_heights[left];
    *side++ = {quarter - start.inner_longitude, inner_.point_heights[left], start.middle_height};
    *side++ = {quarter - start.outer_longitude, start.middle_height, corner};
    *side++ = {quarter - outer_.longitudes[left], corner, outer_.first_heights[left]};
    *side++ = {quarter - outer_.middles[left], outer_.first_heights[left], outer_.second_heights[left]};
  }
  *side++ = {outer_.middles[left], outer_.second_heights[left], outer_.first_heights[left]};
  *side++ = {outer_.longitudes[left], outer_.first_heights[left], outer_.point_heights[left]};
  *side++ = {start.outer_longitude, outer_.point_heights[left], start.middle_height};
  *side++ = {start.inner_longitude, start.middle_height, inner_.point_heights[left]};
  return static_cast<int>(side - sides);
}

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
  struct TileImageKind {
    int quarter;
    bool mirrored, right, lower, swapped;
  };
  constexpr TileImageKind kinds[] = {{2, true, true, true, false},   {2, false, false, true, false},
                                     {0, false, true, false, false}, {4, true, false, false, false},
                                     {1, false, true, true, true},   {1, true, true, false, true},
                                     {3, true, false, true, true},   {3, false, false, false, true}};
  std::array<TileImage, 16> images{};
  std::size_t next = 0;
  for (const TileImageKind& p : kinds) {
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

PatchRun part_of(const PatchRun& run, int first, int count) {
  PatchRun part = run;
  const std::ptrdiff_t texels =
      std::ptrdiff_t{4} * run.patch_groups * (run.row_weights != nullptr ? 1 : run.patch_rows);
  part.rows += first;
  part.columns += first;
  part.weights += first * texels;
  if (run.row_weights != nullptr) part.row_weights += std::ptrdiff_t{first} * run.patch_rows;
  part.count = count;
  return part;
}

bool place_image(const TileImage& image, const WeighedRun& run, int size, int width, PlacedRun& placed) {
  if (rest_of(image, width) != run.rest) return false;
  const bool odd = size % 2 != 0;
  if (run.kind == TileKind::side && odd && run.line == 0 && image.below) return false;  // both are the middle line
  PatchRun patches = run.patches;
  const double* areas = run.areas;
  int first = run.first;
  // On the diagonal a texel is its own image with u and v exchanged.
  if (image.swapped && first + patches.count > run.line) patches.count = run.line - first;
  const bool rising = image.swapped ? image.lower : image.right;
  if (!rising && first == 0 && odd) {  // the middle texel of an odd number is its own image too
    ++first;
    if (areas != nullptr) ++areas;
    patches = part_of(patches, 1, patches.count - 1);
  }
  if (patches.count <= 0) return false;
  const int half = (size + 1) / 2;
  const auto position = [&](int index, bool positive) { return positive ? size - half + index : half - 1 - index; };
  const int along = position(first, rising);
  const int fixed = position(run.line, image.swapped ? image.right : image.lower);
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
