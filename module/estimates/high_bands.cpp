#include "estimates/high_bands.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <vector>

#include "image/map_flux.h"
#include "image/texel_grid.h"
#include "jobs/tiles.h"
#include "specular/clean_source.h"

namespace welkin::estimates {
namespace {

image::TexelGrid grid_of(const CubemapView& view) { return image::TexelGrid::cubemap(view.size); }
image::TexelGrid grid_of(const LatLongView& view) { return image::TexelGrid::lat_long(view.width, view.height); }

/// One class of rows: Int |L - mean|^2 and Int |L - mean|.
HighBands sum_rows(const specular::CleanSource& source, const image::TexelGrid& grid, int row_class,
                   const glm::dvec3& mean, std::span<double> steradians) {
  HighBands sums;
  grid.solid_angles(row_class, steradians);
  for (const int row : grid.rows_of(row_class)) {
    const float* rgb = source.row(row);
    for (std::size_t column = 0; column < steradians.size(); ++column, rgb += 3) {
      const glm::dvec3 off = image::radiance_of(rgb) - mean;
      const double square = glm::dot(off, off);
      sums.energy += steradians[column] * square;
      sums.absolute += steradians[column] * std::sqrt(square);
    }
  }
  return sums;
}

template <class View>
HighBands measure(const View& view, const SphericalHarmonics& radiance, const ProjectionOptions& options,
                  const Control& control) {
  const specular::CleanSource source(view, options, {control.stop, {}});
  const image::TexelGrid grid = grid_of(view);
  const glm::dvec3 mean = average_radiance(radiance);
  const auto classes = static_cast<std::size_t>(grid.row_classes());
  const auto columns = static_cast<std::size_t>(grid.columns());
  const jobs::Placement placement = jobs::placement_for(grid.texels());
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<double> steradians(workers * columns);
  std::vector<HighBands> slots(classes);
  jobs::run_tiles(classes, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    slots[tile] =
        sum_rows(source, grid, static_cast<int>(tile), mean, std::span(steradians).subspan(worker * columns, columns));
  });
  HighBands sums;
  for (const HighBands& slot : slots) {
    sums.energy += slot.energy;
    sums.absolute += slot.absolute;
  }
  // Parseval: what the first bands hold of it is their coefficients' squares, band 0 being the mean.
  for (std::size_t k = 1; k < radiance.coefficients().size(); ++k)
    sums.energy -= glm::dot(radiance.coefficients()[k], radiance.coefficients()[k]);
  sums.energy = std::max(0.0, sums.energy);
  return sums;
}

}  // namespace

HighBands high_bands(const CubemapView& view, const SphericalHarmonics& radiance, const ProjectionOptions& options,
                     const Control& control) {
  return measure(view, radiance, options, control);
}

HighBands high_bands(const LatLongView& view, const SphericalHarmonics& radiance, const ProjectionOptions& options,
                     const Control& control) {
  return measure(view, radiance, options, control);
}

}  // namespace welkin::estimates
