#include "specular/lobe_integrals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "image/cube_texels.h"
#include "image/map_flux.h"
#include "image/texel_geometry.h"
#include "jobs/tiles.h"
#include "specular/lobe.h"
#include "specular/lobe_texels.h"
#include "tables/trigonometry.h"

namespace welkin::specular {
namespace {

constexpr std::size_t kBatch = 512;  ///< directions at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMostTiles = 1024;
constexpr std::size_t kLanes = 8;  ///< sums side by side, so that the processor need not wait for each

/// One worker's room.
struct Scratch {
  explicit Scratch(std::size_t columns) : integrals(columns), red(columns), green(columns), blue(columns) {
    for (auto* list : {&centres.x, &centres.y, &centres.z, &centres.solid_angle}) list->resize(columns);
  }
  TexelRow centres;
  std::vector<double> integrals;
  std::vector<double> red, green, blue;
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double lanes[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= a.size(); i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) lanes[k] += a[i + k] * b[i + k];
  }
  for (std::size_t k = 0; i < a.size(); ++i, ++k) lanes[k] += a[i] * b[i];
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

void integrate_batch(const CleanSource& source, const LobeTexels& texels, double alpha,
                     std::span<const glm::dvec3> directions, const Control& control, std::vector<glm::dvec3>& result) {
  const auto rows = static_cast<std::size_t>(source.rows());
  const auto columns = static_cast<std::size_t>(source.columns());
  const std::size_t rows_per_tile = (rows + kMostTiles - 1) / kMostTiles;
  const std::size_t tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(rows * columns * directions.size()));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch(workers, Scratch(columns));
  std::vector<glm::dvec3> slots(tiles * directions.size(), glm::dvec3(0.0));

  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    Scratch& room = scratch[worker];
    glm::dvec3* const slot = slots.data() + tile * directions.size();
    for (std::size_t row = tile * rows_per_tile; row < std::min(rows, (tile + 1) * rows_per_tile); ++row) {
      const float* const rgb = source.row(static_cast<int>(row));
      for (std::size_t i = 0; i < columns; ++i) {
        room.red[i] = static_cast<double>(rgb[3 * i]);
        room.green[i] = static_cast<double>(rgb[3 * i + 1]);
        room.blue[i] = static_cast<double>(rgb[3 * i + 2]);
      }
      texels.fill(static_cast<int>(row), room.centres);
      for (std::size_t n = 0; n < directions.size(); ++n) {
        if (!fill_lobe_integrals(texels, static_cast<int>(row), room.centres, directions[n], alpha, room.integrals))
          continue;
        slot[n] +=
            glm::dvec3(dot(room.integrals, room.red), dot(room.integrals, room.green), dot(room.integrals, room.blue));
      }
    }
  });

  const std::size_t first = result.size();
  result.resize(first + directions.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) result[first + k % directions.size()] += slots[k];
}

int clamped(double place, int count) noexcept { return std::clamp(static_cast<int>(std::floor(place)), 0, count - 1); }

}  // namespace

std::vector<glm::dvec3> integrate_lobes(const CleanSource& source, double alpha, std::span<const glm::dvec3> directions,
                                        const Control& control) {
  const auto texels = source.cubemap() ? lobe_texels_of_cubemap(source.columns())
                                       : lobe_texels_of_lat_long(source.columns(), source.rows());
  const auto share_done = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(directions.size());
  };
  std::vector<glm::dvec3> result;
  while (result.size() < directions.size()) {
    const std::size_t first = result.size();
    const std::size_t count = std::min(kBatch, directions.size() - first);
    const Control part = jobs::part_of(control, share_done(first), share_done(first + count));
    integrate_batch(source, *texels, alpha, directions.subspan(first, count), part, result);
  }
  const double whole = lobe_integral(alpha);
  for (glm::dvec3& value : result) value /= whole;
  return result;
}

glm::dvec3 radiance_towards(const CleanSource& source, const glm::dvec3& d) noexcept {
  const int columns = source.columns();
  if (!source.cubemap()) {
    const double longitude = tables::turns_of(d.x, d.z);
    const double latitude = tables::turns_of(d.y, std::sqrt(d.x * d.x + d.z * d.z));
    const int column = clamped((0.5 - longitude) * columns, columns);
    const int row = clamped((0.25 - latitude) * 2.0 * source.rows(), source.rows());
    return image::radiance_of(source.row(row) + std::ptrdiff_t{3} * column);
  }
  const int face = image::face_of(d);
  const image::Frame& frame = image::face_frame(face);
  const auto along = [&](const glm::dvec3& axis) { return d.x * axis.x + d.y * axis.y + d.z * axis.z; };
  const double normal = along(frame.normal);
  const int column = clamped(0.5 * (along(frame.u) / normal + 1.0) * columns, columns);
  const int row = clamped(0.5 * (along(frame.v) / normal + 1.0) * columns, columns);
  return image::radiance_of(source.row(face * columns + row) + std::ptrdiff_t{3} * column);
}

}  // namespace welkin::specular
