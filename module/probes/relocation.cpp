// Where probes that stand in walls, or too close to one, are better captured.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "probes/depth_maps.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Directions and solid angles of the texels of depth cubemaps of one size.
struct Rays {
  explicit Rays(int texels) : size(texels), solid_angles(probes::face_solid_angles(texels)) {
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          directions.push_back(image::face_direction(size, face, column + 0.5, row + 0.5));
        }
      }
    }
  }

  int size;
  std::vector<double> solid_angles;
  std::vector<dvec3> directions;
};

/// Calls visit(ray, depth) for all texels.
template <class Visit>
void for_each_ray(const Rays& rays, const DepthView& depths, const Visit& visit) {
  std::size_t ray = 0;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < rays.size; ++row) {
      const float* depth = probes::row_of(depths, face, row);
      for (int column = 0; column < rays.size; ++column) visit(ray++, static_cast<double>(depth[column]));
    }
  }
}

/// How a probe moves. What two ways have in common is decided by the order of the texels.
class Mover {
 public:
  Mover(const ProbeGrid& grid, const RelocationOptions& options, const Rays& rays)
      : rays_(rays),
        back_share_(options.back_share),
        farthest_(options.farthest * grid.spacing),
        clearance_(options.clearance * std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z})) {}

  /// The new offset. `is_number` becomes false if a depth is none.
  [[nodiscard]] dvec3 operator()(const DepthView& depths, const dvec3& offset, bool& is_number) const {
    double backs = 0.0;
    double whole = 0.0;
    for_each_ray(rays_, depths, [&](std::size_t ray, double depth) {
      const double angle = rays_.solid_angles[ray % rays_.solid_angles.size()];
      whole += angle;
      if (depth < 0.0) backs += angle;
      is_number = is_number && !std::isnan(depth);
    });
    return backs > back_share_ * whole ? out_of_geometry(depths, offset) : away_from_surfaces(depths, offset);
  }

 private:
  [[nodiscard]] bool is_near_enough(const dvec3& offset) const {
    return std::abs(offset.x) <= farthest_.x && std::abs(offset.y) <= farthest_.y && std::abs(offset.z) <= farthest_.z;
  }

  [[nodiscard]] dvec3 out_of_geometry(const DepthView& depths, const dvec3& offset) const {
    double shortest = kNone;
    dvec3 best = offset;
    for_each_ray(rays_, depths, [&](std::size_t ray, double depth) {
      if (!(depth < 0.0 && -depth < shortest)) return;
      const dvec3 moved = offset + (clearance_ - depth) * rays_.directions[ray];
      if (!is_near_enough(moved)) return;
      shortest = -depth;
      best = moved;
    });
    return best;
  }

  [[nodiscard]] dvec3 away_from_surfaces(const DepthView& depths, const dvec3& offset) const {
    double nearest = clearance_;
    std::size_t towards = rays_.directions.size();
    for_each_ray(rays_, depths, [&](std::size_t ray, double depth) {
      if (!(depth >= 0.0 && depth < nearest)) return;
      nearest = depth;
      towards = ray;
    });
    if (towards == rays_.directions.size()) return offset;
    const dvec3 away = -rays_.directions[towards];
    // The free way behind: no farther than its middle, so that the wall there is not the next that is too near.
    double free_way = 2.0 * clearance_;
    for_each_ray(rays_, depths, [&](std::size_t ray, double depth) {
      constexpr double kAround = 0.98;  // cosine of 11 degrees: walls beside the way do not count
      const double cosine = glm::dot(rays_.directions[ray], away);
      if (cosine > kAround) free_way = std::min(free_way, std::abs(depth) * cosine);
    });
    const double step = std::min(clearance_ - nearest, std::max(0.0, 0.5 * (free_way - nearest)));
    const dvec3 moved = offset + step * away;
    return is_near_enough(moved) ? moved : offset;
  }

  const Rays& rays_;
  double back_share_;
  dvec3 farthest_;
  double clearance_;
};

}  // namespace

std::vector<dvec3> relocate_probes(const ProbeGrid& grid, std::span<const DepthView> depths,
                                   const RelocationOptions& options, std::span<const dvec3> offsets,
                                   const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_grid(grid);
  platform::require_between("RelocationOptions: back_share", options.back_share, 0.0, 1.0);
  platform::require_between("RelocationOptions: clearance", options.clearance, 0.0, 0.5);
  platform::require_between("RelocationOptions: farthest", options.farthest, 0.0, 0.5);
  probes::require_count("depths", depths.size(), grid.size());
  if (!offsets.empty()) probes::require_count("offsets", offsets.size(), grid.size());
  probes::check_depths(depths);
  const Rays rays(depths[0].size);
  const Mover moved(grid, options, rays);
  std::vector<dvec3> result(grid.size());
  std::vector<std::uint8_t> has_nan(grid.size());
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(rays.directions.size() * grid.size()));
  jobs::run_tiles(grid.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t probe, std::size_t /*worker*/) {
                    bool is_number = true;
                    result[probe] = moved(depths[probe], offsets.empty() ? dvec3(0.0) : offsets[probe], is_number);
                    has_nan[probe] = is_number ? 0 : 1;
                  });
  const auto bad = std::find(has_nan.begin(), has_nan.end(), 1);
  if (bad != has_nan.end()) probes::refuse_nan_depth(static_cast<std::size_t>(bad - has_nan.begin()));
  return result;
}

}  // namespace welkin
