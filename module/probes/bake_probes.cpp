// A grid of captured cubemaps and depths to light, validity, distances and visibility of the sky.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/many.h"
#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "probes/depth_maps.h"
#include "probes/probe_arrays.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace {

using probes::check_depths;
using probes::DepthMaps;
using probes::DepthRules;
using probes::refuse;
using probes::require_count;

/// Bytes of masks by which visibility is projected at a time; at least a probe's.
constexpr std::size_t kMaskBytes = std::size_t{16} << 20U;

constexpr int kDepthsPerTile = 8;

double smallest_spacing(const ProbeGrid& grid) { return std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z}); }

double limit_of(const ProbeGrid& grid, const ProbeOptions& options) {
  if (options.distance_limit > 0.0) return options.distance_limit;
  const dvec3& s = grid.spacing;
  return 1.5 * std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
}

/// Everything but the dilation, of some probes one after the other.
class Capture {
 public:
  Capture(std::span<const CubemapView> cubes, std::span<const DepthView> depths, const ProbeOptions& options,
          BakedProbes& into)
      : cubes_(cubes), depths_(depths), options_(options), into_(into) {
    const std::size_t count = cubes.size();
    into.coefficients.resize(count * probes::squared(into.bands));
    into.validity.assign(count, 1.0F);
    into.passes.assign(count, 0);
    into.distances.resize(count * probes::distance_floats(into));
    into.sky.resize(count * probes::squared(into.sky_bands));
  }

  void run(const Control& control) {
    const double lit = depths_.empty() ? 1.0 : into_.sky_bands > 0 ? 0.5 : 0.7;
    const double measured = into_.sky_bands > 0 ? 0.7 : 1.0;
    into_.diagnostics = project_many(cubes_, into_.coefficients, options_.projection, jobs::part_of(control, 0.0, lit));
    if (depths_.empty()) return;
    timed("distances", [&] { read_depths(jobs::part_of(control, lit, measured)); });
    if (into_.sky_bands > 0) timed("sky", [&] { project_sky(jobs::part_of(control, measured, 1.0)); });
  }

 private:
  template <class Work>
  void timed(const char* name, const Work& work) {
    const jobs::Stopwatch watch;
    work();
    into_.diagnostics.passes.push_back(
        {name, PassAction::run, std::to_string(depths_.size()) + " depths", watch.milliseconds()});
  }

  void read_depths(const Control& control) {
    const int size = depths_[0].size;
    const DepthMaps maps(size, {options_.near_share * smallest_spacing(into_.grid), into_.distance_limit,
                                into_.distance_size, options_.distance_power});
    const auto placement = jobs::placement_for(static_cast<std::int64_t>(6 * probes::squared(size) * depths_.size()));
    const std::size_t workers = jobs::worker_count(placement);
    std::vector<DepthMaps::Scratch> scratches(workers, DepthMaps::Scratch(maps));
    const std::size_t floats = probes::distance_floats(into_);
    jobs::run_rows(static_cast<int>(depths_.size()), kDepthsPerTile, placement, workers, control,
                   [&](int probe, std::size_t worker) {
                     const auto k = static_cast<std::size_t>(probe);
                     into_.validity[k] = maps.read(depths_[k], scratches[worker],
                                                   std::span(into_.distances).subspan(k * floats, floats));
                   });
    for (std::size_t k = 0; k < depths_.size(); ++k) {
      if (into_.validity[k] < 0.0F) probes::refuse_nan_depth(k);
      into_.passes[k] = static_cast<double>(into_.validity[k]) < options_.valid_share ? probes::kUnfilled : 0;
    }
  }

  /// The function that is 1 where nothing is, projected as a grey image.
  void project_sky(const Control& control) {
    const int size = depths_[0].size;
    const std::size_t face = probes::squared(size);
    const std::size_t together = std::clamp<std::size_t>(kMaskBytes / (18 * face), 1, depths_.size());
    std::vector<std::uint8_t> masks(together * 6 * face * 3);
    const std::size_t functions = probes::squared(into_.sky_bands);
    std::vector<dvec3> grey(together * functions);
    std::vector<CubemapView> views(together);
    const ProjectionOptions projection{.bands = into_.sky_bands};
    for (std::size_t first = 0; first < depths_.size(); first += together) {
      const std::size_t count = std::min(together, depths_.size() - first);
      const auto share = [&](std::size_t done) {
        return static_cast<double>(done) / static_cast<double>(depths_.size());
      };
      for (std::size_t k = 0; k < count; ++k) {
        std::uint8_t* texels = masks.data() + k * 6 * face * 3;
        views[k] = CubemapView{{}, size, 0, PixelFormat::rgb8};
        for (std::size_t f = 0; f < 6; ++f) views[k].faces[f] = texels + f * face * 3;
      }
      const auto placement = jobs::placement_for(static_cast<std::int64_t>(count * 6 * face));
      jobs::run_tiles(count, placement, jobs::worker_count(placement), {control.stop},
                      [&](std::size_t k, std::size_t /*worker*/) {
                        write_mask(depths_[first + k], masks.data() + k * 6 * face * 3);
                      });
      project_many(std::span(views).first(count), grey, projection,
                   jobs::part_of(control, share(first), share(first + count)));
      // All three channels are alike.
      for (std::size_t k = 0; k < count * functions; ++k) into_.sky[first * functions + k] = grey[k].x;
    }
  }

  static void write_mask(const DepthView& depths, std::uint8_t* texels) noexcept {
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < depths.size; ++row) {
        const float* depth = probes::row_of(depths, face, row);
        for (int column = 0; column < depths.size; ++column, texels += 3) {
          const bool open = depth[column] == std::numeric_limits<float>::infinity();
          texels[0] = texels[1] = texels[2] = open ? 255 : 0;
        }
      }
    }
  }

  std::span<const CubemapView> cubes_;
  std::span<const DepthView> depths_;
  const ProbeOptions& options_;
  BakedProbes& into_;
};

/// Returns an empty grid of the sizes in the options.
BakedProbes sizes_of(const ProbeGrid& grid, bool with_depths, const ProbeOptions& options) {
  BakedProbes probes;
  probes.grid = grid;
  probes.bands = options.projection.bands;
  probes.distance_size = with_depths ? options.distance_size : 0;
  probes.distance_limit = limit_of(grid, options);
  // The light of bands l < b through a visibility V from an environment of bands l' < e needs Int V Y(l) Y(l'), which
  // is 0 for degrees of V above l + l': b + e - 1 bands of V are all.
  probes.sky_bands = options.environment_bands > 0 ? options.projection.bands + options.environment_bands - 1 : 0;
  return probes;
}

/// Copies `from`'s values of a probe to its slot in `to`.
template <class Value>
void copy_probe(const std::vector<Value>& from, std::size_t of, std::vector<Value>& to, std::size_t at,
                std::size_t values) {
  std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(of * values), values,
              to.begin() + static_cast<std::ptrdiff_t>(at * values));
}

}  // namespace

BakedProbes bake_probes(const ProbeGrid& grid, std::span<const CubemapView> cubes, std::span<const DepthView> depths,
                        const ProbeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_grid(grid);
  probes::check_options(options, !depths.empty());
  require_count("cubes", cubes.size(), grid.size());
  if (!depths.empty()) require_count("depths", depths.size(), grid.size());
  check_depths(depths);
  BakedProbes probes = sizes_of(grid, !depths.empty(), options);
  Capture(cubes, depths, options, probes).run(jobs::part_of(control, 0.0, 0.98));
  dilate(probes, options.dilation_passes, jobs::part_of(control, 0.98, 1.0));
  return probes;
}

void update_probes(BakedProbes& probes, std::span<const std::size_t> changed, std::span<const CubemapView> cubes,
                   std::span<const DepthView> depths, const ProbeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  if (changed.empty() && cubes.empty() && depths.empty()) return;
  probes::check_options(options, !depths.empty());
  require_count("cubes", cubes.size(), changed.size());
  if (!depths.empty()) require_count("depths", depths.size(), changed.size());
  check_depths(depths);
  BakedProbes part = sizes_of(probes.grid, !depths.empty(), options);
  if (part.bands != probes.bands || part.distance_size != probes.distance_size || part.sky_bands != probes.sky_bands ||
      part.distance_limit != probes.distance_limit) {
    refuse("the probes were baked with other options, or with depths where there are none now; pass the same");
  }
  std::vector<std::uint8_t> named(probes.grid.size());
  for (const std::size_t probe : changed) {
    if (probe >= named.size() || named[probe]++ != 0) {
      refuse("probe " + std::to_string(probe) + " is named as changed; the grid has " + std::to_string(named.size()) +
             " probes, and each can be named once");
    }
  }
  Capture(cubes, depths, options, part).run(jobs::part_of(control, 0.0, 0.98));
  BakedProbes all = probes;
  all.diagnostics = part.diagnostics;
  for (std::size_t k = 0; k < changed.size(); ++k) {
    copy_probe(part.coefficients, k, all.coefficients, changed[k], probes::squared(all.bands));
    copy_probe(part.validity, k, all.validity, changed[k], 1);
    copy_probe(part.passes, k, all.passes, changed[k], 1);
    copy_probe(part.distances, k, all.distances, changed[k], probes::distance_floats(all));
    copy_probe(part.sky, k, all.sky, changed[k], probes::squared(all.sky_bands));
  }
  dilate(all, options.dilation_passes, jobs::part_of(control, 0.98, 1.0));
  probes = std::move(all);
}

}  // namespace welkin
