#include "sky/ray_lengths.h"

#include <utility>

#include "jobs/tiles.h"
#include "math/table_cache.h"

namespace welkin::sky {
namespace {

constexpr std::size_t kKeptBytes = std::size_t{12} << 20U;  ///< full and compact tables
constexpr int kTileRays = 128;

/// All that lengths depend on.
struct Key {
  double bottom_radius;
  double thickness;
  std::vector<std::vector<DensityLayer>> densities;
  std::vector<double> shells;
  std::vector<Ray> rays;

  bool operator==(const Key&) const = default;
};

std::shared_ptr<const RayLengths> compute(const AirModel& air, const std::vector<Ray>& rays, const Control& control) {
  const auto lengths = std::make_shared<RayLengths>();
  lengths->amounts.resize(rays.size());
  const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
  std::vector<RayPanels> panels;
  for (std::size_t i = 0; i < workers; ++i) panels.emplace_back(air);
  jobs::run_rows(static_cast<int>(rays.size()), kTileRays, jobs::Placement::arena, workers, control,
                 [&](int row, std::size_t worker) {
                   const auto k = static_cast<std::size_t>(row);
                   lengths->amounts[k] = lengths_along(air, rays[k], panels[worker]);
                 });
  return lengths;
}

}  // namespace

std::shared_ptr<const RayLengths> lengths_of(const AirModel& air, std::vector<Ray> rays, const Control& control) {
  static auto& kept = *new math::TableCache<Key, RayLengths>(kKeptBytes);
  const Key key{air.bottom_radius(), air.thickness(), air.profiles(), air.length_shells(), std::move(rays)};
  if (std::shared_ptr<const RayLengths> found = kept.find(key)) return found;
  // Computed outside of the cache, whose lock a thread that waits for its tiles could come to again by other work.
  const std::shared_ptr<const RayLengths> computed = compute(air, key.rays, control);
  return kept.get(key, [&] { return computed; });
}

}  // namespace welkin::sky
