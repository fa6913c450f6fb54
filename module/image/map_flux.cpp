#include "image/map_flux.h"

#include <algorithm>

#include "jobs/tiles.h"

namespace welkin::image {
namespace {

constexpr int kTexelsPerTile = 32768;  // some 50 microseconds

}  // namespace

MapFlux::MapFlux(const TexelGrid& grid, const float* pixels) : grid_(grid), pixels_(pixels) {
  const std::int64_t texels_per_class = std::int64_t{grid.columns()} * grid.rows_of(0).count;
  classes_per_tile_ = static_cast<int>(std::max<std::int64_t>(1, kTexelsPerTile / texels_per_class));
  tiles_.resize(static_cast<std::size_t>((grid.row_classes() + classes_per_tile_ - 1) / classes_per_tile_));

  const jobs::Placement placement = jobs::placement_for(grid.texels());
  const std::size_t workers = jobs::worker_count(placement);
  const auto columns = static_cast<std::size_t>(grid.columns());
  std::vector<double> steradians(workers * columns);
  jobs::run_tiles(tiles_.size(), placement, workers, {}, [&](std::size_t tile, std::size_t worker) {
    read_tile(tile, std::span(steradians).subspan(worker * columns, columns));
  });
}

void MapFlux::update(std::span<const std::int64_t> changed_texels) {
  std::vector<bool> stale(tiles_.size());
  for (const std::int64_t texel : changed_texels) {
    const int row_class = grid_.class_of(static_cast<int>(texel / grid_.columns()));
    stale[static_cast<std::size_t>(row_class / classes_per_tile_)] = true;
  }
  std::vector<double> steradians(static_cast<std::size_t>(grid_.columns()));
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    if (stale[tile]) read_tile(tile, steradians);
  }
}

void MapFlux::read_tile(std::size_t tile, std::span<double> steradians) {
  Tile sums;
  const int first = static_cast<int>(tile) * classes_per_tile_;
  const int last = std::min(first + classes_per_tile_, grid_.row_classes());
  for (int row_class = first; row_class < last; ++row_class) {
    grid_.solid_angles(row_class, steradians);
    for (const int row : grid_.rows_of(row_class)) read_row(row, steradians, sums);
  }
  tiles_[tile] = sums;
}

void MapFlux::read_row(int row, std::span<const double> steradians, Tile& sums) const {
  const std::int64_t first = std::int64_t{row} * grid_.columns();
  const float* rgb = pixels_ + 3 * first;
  for (std::size_t column = 0; column < steradians.size(); ++column, rgb += 3) {
    if (!is_finite(rgb)) continue;
    const glm::dvec3 radiance = radiance_of(rgb);
    sums.flux += steradians[column] * radiance;
    sums.solid_angle += steradians[column];
    const double brightness = luminance(radiance);
    const std::int64_t texel = first + static_cast<std::int64_t>(column);
    const bool first_of_equals = brightness == sums.brightest_luminance && texel < sums.brightest;
    if (sums.brightest < 0 || brightness > sums.brightest_luminance || first_of_equals) {
      sums.brightest_luminance = brightness;
      sums.brightest = texel;
    }
  }
}

glm::dvec3 MapFlux::flux() const noexcept {
  glm::dvec3 sum{};
  for (const Tile& tile : tiles_) sum += tile.flux;
  return sum;
}

double MapFlux::solid_angle() const noexcept {
  double sum = 0.0;
  for (const Tile& tile : tiles_) sum += tile.solid_angle;
  return sum;
}

std::int64_t MapFlux::brightest() const noexcept {
  const Tile* best = nullptr;
  for (const Tile& tile : tiles_) {
    if (tile.brightest < 0) continue;
    const bool better = best == nullptr || tile.brightest_luminance > best->brightest_luminance ||
                        (tile.brightest_luminance == best->brightest_luminance && tile.brightest < best->brightest);
    if (better) best = &tile;
  }
  return best == nullptr ? -1 : best->brightest;
}

}  // namespace welkin::image
