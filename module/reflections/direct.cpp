// The truth at chosen directions.
#include "reflections/direct.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <string>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/direction.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sun_detection.h"
#include "reflections/lobe.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kBatch = 512;  ///< directions at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMostTiles = 1024;
constexpr std::size_t kMostDirections = 10'000'000;

/// One worker's room.
struct Scratch {
  explicit Scratch(std::size_t columns) : integrals(columns), red(columns), green(columns), blue(columns) {
    for (auto* list : {&centres.x, &centres.y, &centres.z, &centres.solid_angle}) list->resize(columns);
  }
  TexelRow centres;
  std::vector<double> integrals;
  std::vector<double> red, green, blue;
};

void integrate_batch(const projection::SanitizedSource& source, const LobeTexels& texels, double alpha,
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
        slot[n] += glm::dvec3(math::dot(room.integrals, room.red), math::dot(room.integrals, room.green),
                              math::dot(room.integrals, room.blue));
      }
    }
  });

  const std::size_t first = result.size();
  result.resize(first + directions.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) result[first + k % directions.size()] += slots[k];
}

int clamped(double place, int count) noexcept { return std::clamp(static_cast<int>(std::floor(place)), 0, count - 1); }

}  // namespace

std::vector<glm::dvec3> integrate_lobes(const projection::SanitizedSource& source, double alpha,
                                        std::span<const glm::dvec3> directions, const Control& control) {
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

glm::dvec3 radiance_towards(const projection::SanitizedSource& source, const glm::dvec3& d) noexcept {
  const int columns = source.columns();
  if (!source.cubemap()) {
    const double longitude = math::turns_of(d.x, d.z);
    const double latitude = math::turns_of(d.y, std::sqrt(d.x * d.x + d.z * d.z));
    const int column = clamped((0.5 - longitude) * columns, columns);
    const int row = clamped((0.25 - latitude) * 2.0 * source.rows(), source.rows());
    return projection::radiance_of(source.row(row) + std::ptrdiff_t{3} * column);
  }
  const int face = image::face_of(d);
  const image::Frame& frame = image::face_frame(face);
  const auto along = [&](const glm::dvec3& axis) { return d.x * axis.x + d.y * axis.y + d.z * axis.z; };
  const double normal = along(frame.normal);
  const int column = clamped(0.5 * (along(frame.u) / normal + 1.0) * columns, columns);
  const int row = clamped(0.5 * (along(frame.v) / normal + 1.0) * columns, columns);
  return projection::radiance_of(source.row(face * columns + row) + std::ptrdiff_t{3} * column);
}

std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions) {
  if (directions.empty() || directions.size() > kMostDirections) {
    throw Error(ErrorCode::invalid_argument, std::to_string(directions.size()) + " directions; 1 to " +
                                                 std::to_string(kMostDirections) + " are possible");
  }
  return math::unit_directions(directions, "direction");
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr double kLeastAlpha = 1e-6;

template <class View>
std::vector<glm::dvec3> reference(const View& view, double roughness, const std::vector<glm::dvec3>& directions,
                                  const Control& control) {
  image::check_view(view);
  if (!(roughness >= 0.0 && roughness <= 1.0)) {
    throw Error(ErrorCode::invalid_argument, "roughness " + platform::number_text(roughness) + " is not from 0 to 1");
  }
  const std::vector<glm::dvec3> units = reflections::unit_directions(directions);
  const projection::SanitizedSource source(view, {}, {control.stop, {}});
  const double alpha = roughness * roughness;
  if (alpha >= kLeastAlpha) return reflections::integrate_lobes(source, alpha, units, control);
  std::vector<glm::dvec3> values;
  values.reserve(units.size());
  for (const glm::dvec3& unit : units) values.push_back(reflections::radiance_towards(source, unit));
  return values;
}

}  // namespace

std::vector<glm::dvec3> reference_specular(const LatLongView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reference(source, roughness, directions, control);
}

std::vector<glm::dvec3> reference_specular(const CubemapView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return reference(source, roughness, directions, control);
}

}  // namespace welkin
