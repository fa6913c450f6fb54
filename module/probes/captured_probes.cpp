// Probes that were captured: the light of valid ones for their invalid neighbours, another environment's, windows; and
// where those that stand in walls, or too close to one, are better captured.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/many.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "probes/depth_maps.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace {

using probes::kLastPass;
using probes::kUnfilled;

/// A neighbour on the grid and what it counts.
struct Neighbour {
  std::array<int, 3> step;
  double weight;
};

std::vector<Neighbour> neighbours_of(const ProbeGrid& grid) {
  std::vector<Neighbour> neighbours;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (x == 0 && y == 0 && z == 0) continue;
        const dvec3 way{x * grid.spacing.x, y * grid.spacing.y, z * grid.spacing.z};
        neighbours.push_back({{x, y, z}, 1.0 / (way.x * way.x + way.y * way.y + way.z * way.z)});
      }
    }
  }
  return neighbours;
}

/// Calls take(neighbour's number, weight) for those that lie in the grid.
template <class Take>
void for_each_neighbour(const ProbeGrid& grid, const std::vector<Neighbour>& neighbours, std::size_t probe,
                        const Take& take) {
  const auto columns = static_cast<std::size_t>(grid.counts[0]);
  const auto rows = static_cast<std::size_t>(grid.counts[1]);
  const std::array<int, 3> position{static_cast<int>(probe % columns), static_cast<int>(probe / columns % rows),
                                    static_cast<int>(probe / columns / rows)};
  for (const Neighbour& neighbour : neighbours) {
    std::array<std::size_t, 3> at{};
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int there = position[axis] + neighbour.step[axis];
      inside = inside && there >= 0 && there < grid.counts[axis];
      at[axis] = static_cast<std::size_t>(inside ? there : 0);
    }
    if (inside) take(at[0] + columns * (at[1] + rows * at[2]), neighbour.weight);
  }
}

/// The mean of the neighbours that have light, to the probe; false if none has.
bool fill(BakedProbes& probes, const std::vector<Neighbour>& neighbours, std::size_t probe) {
  const std::size_t functions = probes::squared(probes.bands);
  std::array<dvec3, probes::kMaxBands * probes::kMaxBands> sums{};
  double whole = 0.0;
  for_each_neighbour(probes.grid, neighbours, probe, [&](std::size_t neighbour, double weight) {
    if (probes.passes[neighbour] == kUnfilled) return;
    whole += weight;
    const dvec3* light = probes.coefficients.data() + neighbour * functions;
    for (std::size_t k = 0; k < functions; ++k) sums[k] += weight * light[k];
  });
  if (!(whole > 0.0)) return false;
  for (std::size_t k = 0; k < functions; ++k) probes.coefficients[probe * functions + k] = sums[k] / whole;
  return true;
}

/// Fills what has a neighbour with light. Returns what is left.
std::vector<std::size_t> run_pass(BakedProbes& probes, const std::vector<Neighbour>& neighbours,
                                  const std::vector<std::size_t>& open, std::uint8_t pass, const Control& control) {
  std::vector<std::uint8_t> filled(open.size());
  probes::for_each_probe(open.size(), std::int64_t{26} * 16, {control.stop},
                         [&](std::size_t k) { filled[k] = fill(probes, neighbours, open[k]) ? 1 : 0; });
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (filled[k] == 0) {
      left.push_back(open[k]);
    } else {
      probes.passes[open[k]] = pass;
    }
  }
  return left;
}

}  // namespace

void dilate(BakedProbes& probes, int most_passes, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  image::require_range("passes of a dilation", most_passes, 0, 1024);
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < probes.passes.size(); ++k) {
    if (probes.passes[k] == 0) continue;
    probes.passes[k] = kUnfilled;
    open.push_back(k);
  }
  probes.invalid = open.size();
  const std::vector<Neighbour> neighbours = neighbours_of(probes.grid);
  for (int pass = 1; pass <= most_passes && !open.empty(); ++pass) {
    const std::size_t before = open.size();
    open = run_pass(probes, neighbours, open, static_cast<std::uint8_t>(std::min<int>(pass, kLastPass)), control);
    if (open.size() == before) break;  // none has a neighbour with light
  }
  probes.unfilled = open.size();
  // Coefficients that were captured there mean nothing, and may have been filled before.
  const std::size_t functions = probes::squared(probes.bands);
  for (const std::size_t probe : open) {
    if (most_passes > 0) std::fill_n(probes.coefficients.data() + probe * functions, functions, dvec3(0.0));
  }
  if (control.progress) control.progress(1.0);
}

// Another environment, and windows.

namespace {

using probes::for_each_probe;

constexpr const char* kChannels[] = {"red", "green", "blue"};

/// Returns what a coefficient of the visibility adds to those of the radiance: [sky_bands^2][bands^2], the products of
/// the environment with each basis function.
std::vector<dvec3> transfer_of(const SphericalHarmonics& environment, int sky_bands, int bands) {
  std::vector<dvec3> transfer;
  for (std::size_t k = 0; k < probes::squared(sky_bands); ++k) {
    SphericalHarmonics one(sky_bands);
    one.coefficients()[k] = dvec3(1.0);
    const SphericalHarmonics seen = resized(product(one, environment, bands), bands);
    transfer.insert(transfer.end(), seen.coefficients().begin(), seen.coefficients().end());
  }
  return transfer;
}

/// The bound on coefficients: no sum of their products overflows, and it is far above the largest float.
constexpr double kLargestCoefficient = 1e100;

/// Throws `Error` (invalid_argument) that names the first coefficient that is not finite or out of range.
void check_environment(const char* which, const SphericalHarmonics& environment) {
  for (int l = 0; l < environment.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      for (int c = 0; c < 3; ++c) {
        const double value = environment.at(l, m)[c];
        if (std::abs(value) <= kLargestCoefficient) continue;
        throw Error(ErrorCode::invalid_argument, std::string("relight: coefficient (") + std::to_string(l) + ", " +
                                                     std::to_string(m) + ") of `" + which + "` is " +
                                                     platform::number_text(value) + " in " + kChannels[c] +
                                                     "; it must be a number from -1e100 to 1e100");
      }
    }
  }
}

}  // namespace

void relight(BakedProbes& probes, const SphericalHarmonics& from, const SphericalHarmonics& to, int dilation_passes,
             const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  check_environment("from", from);
  check_environment("to", to);
  if (probes.sky_bands < probes.bands) {
    throw Error(ErrorCode::invalid_argument,
                "the probes do not know where they see the environment; bake them with depths and environment_bands "
                "of ProbeOptions");
  }
  const int environment_bands = probes.sky_bands - probes.bands + 1;
  const SphericalHarmonics change = resized(add(to, scale(from, dvec3(-1.0))), environment_bands);
  const std::size_t functions = probes::squared(probes.bands);
  const std::size_t sky = probes::squared(probes.sky_bands);
  const std::vector<dvec3> transfer = transfer_of(change, probes.sky_bands, probes.bands);
  BakedProbes relit = probes;
  for_each_probe(probes.grid.size(), static_cast<std::int64_t>(functions * sky), jobs::part_of(control, 0.0, 0.95),
                 [&](std::size_t probe) {
                   const double* seen = probes.sky.data() + probe * sky;
                   dvec3* light = relit.coefficients.data() + probe * functions;
                   for (std::size_t k = 0; k < sky; ++k) {
                     for (std::size_t f = 0; f < functions; ++f) light[f] += seen[k] * transfer[k * functions + f];
                   }
                 });
  dilate(relit, dilation_passes, jobs::part_of(control, 0.95, 1.0));
  probes = std::move(relit);
}

BakedProbes windowed(const BakedProbes& probes, Window window, double width, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  BakedProbes result = probes;
  const std::size_t functions = probes::squared(probes.bands);
  for_each_probe(probes.grid.size(), 100'000, control, [&](std::size_t probe) {
    SphericalHarmonics radiance(probes.bands);
    std::copy_n(probes.coefficients.data() + probe * functions, functions, radiance.coefficients().begin());
    const WindowResult done = jobs::naming_probe(probe, [&] { return apply_window(radiance, window, width); });
    platform::ranges::copy(done.radiance.coefficients(),
                           result.coefficients.begin() + static_cast<std::ptrdiff_t>(probe * functions));
  });
  return result;
}

// Where probes are better captured.

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
      constexpr double kAround = 0.98;  // cosine of 11 degrees: walls to the side of the way do not count
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
