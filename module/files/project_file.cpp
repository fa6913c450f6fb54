#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "files/environment.h"
#include "files/layout.h"
#include "files/row_source.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "projection/lat_long_projection.h"
#include "projection/projection_error.h"
#include "projection/sanitizer.h"

namespace welkin {
namespace files {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

std::string storage_text(const EnvironmentInfo& info) {
  return info.format_description() + ", " + info.storage + ", " + info.compression;
}

// Puts the passes of reading the file before those of the projection.
void put_first(Projection& projection, std::vector<PassRecord> passes) {
  std::vector<PassRecord>& all = projection.diagnostics.passes;
  all.insert(all.begin(), passes.begin(), passes.end());
}

Projection project_cube(const RowSource& source, const ReadOptions& read_options, const ProjectionOptions& options,
                        const Control& control) {
  constexpr double kReadingShare = 0.8;  // decoding is most of the work, whatever the compression
  const Clock::time_point start = Clock::now();
  const Environment environment = read_whole(source, read_options, jobs::part_of(control, 0.0, kReadingShare));
  const double reading = milliseconds(Clock::now() - start);
  Projection projection = naming_file(source.info().path, [&] {
    return project(environment.cubemap(), options, jobs::part_of(control, kReadingShare, 1.0));
  });
  put_first(projection,
            {{"read", PassAction::run, storage_text(source.info()) + "; a cubemap is held whole", reading}});
  return projection;
}

// Returns the rows to decode and project together: whole blocks of the projector, at least as many rows as decode
// together. A multiple of both is used if it is at most a few times as large, so that no row is decoded twice.
int group_rows(int block_rows, int natural_rows) {
  constexpr int kMaxTimes = 4;
  const int minimum = (natural_rows + block_rows - 1) / block_rows * block_rows;
  const std::int64_t common = std::lcm(std::int64_t{block_rows}, std::int64_t{natural_rows});
  return common <= std::int64_t{kMaxTimes} * minimum ? static_cast<int>(common) : minimum;
}

void project_rows(projection::LatLongProjector& projector, const RowGroup& group, int width) {
  const int block_rows = projector.rows_per_block();
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(width);
  for (int row = 0; row < group.row_count; row += block_rows) {
    const LatLongView rows{group.rgb + static_cast<std::size_t>(row) * row_floats, width,
                           std::min(block_rows, group.row_count - row), 0, PixelFormat::rgb32f};
    projector.project_block((group.first_row + row) / block_rows, rows, group.worker);
  }
}

Projection project_lat_long(const RowSource& source, const ReadOptions& read_options, const ProjectionOptions& options,
                            const Control& control) {
  const EnvironmentInfo& info = source.info();
  projection::LatLongProjector projector(info.width, info.height, options, jobs::worker_count(jobs::Placement::arena));
  const RowGroups groups{group_rows(projector.rows_per_block(), source.traits().natural_rows),
                         read_options.memory_limit_bytes};
  std::atomic<Clock::rep> projecting{0};
  const std::chrono::nanoseconds decoding = for_each_row_group(source, groups, control, [&](const RowGroup& group) {
    const Clock::time_point start = Clock::now();
    project_rows(projector, group, info.width);
    projecting += (Clock::now() - start).count();
  });
  Projection projection = naming_file(info.path, [&] { return projector.finish(); });
  const std::string overlapped = "overlapped, time summed over threads";
  put_first(projection, {{"read", PassAction::run,
                          storage_text(info) + "; " + std::to_string(groups.rows) + " rows at a time, " + overlapped,
                          milliseconds(decoding)},
                         {"cubemap", PassAction::skip, "a lat-long is projected directly", 0.0},
                         {"project", PassAction::run, "rows as they are decoded, " + overlapped,
                          milliseconds(Clock::duration(projecting.load()))}});
  return projection;
}

// Returns the size to compare with a target: a face's edge, or a lat-long's width; 0 if a level does not have its
// layout's shape (three texels by eighteen become one by nine).
int size_of(const EnvironmentInfo& info, const LevelInfo& level) {
  return info.layout == Layout::lat_long ? level.width : face_size(info.layout, level.width, level.height);
}

// Returns the error of a level's projection against the full size, combined with the projection's estimate.
double level_error(const Projection& projection, const EnvironmentInfo& level) {
  const double size = level.layout == Layout::lat_long ? std::min(level.width / 4.0, level.height / 2.0)
                                                       : face_size(level.layout, level.width, level.height);
  const double of_projection = projection.diagnostics.error_estimate;
  const double of_mip = projection::mip_error(projection.radiance.coefficients(), size);
  return std::sqrt(of_projection * of_projection + of_mip * of_mip);
}

Projection project_level(const FileInput& input, const EnvironmentInfo& full, int level, ReadOptions read_options,
                         ProjectionOptions options, const Control& control) {
  read_options.level = level;
  read_options.layout = full.layout;  // a small level's shape may suggest another
  options.target_size.reset();
  const auto source = open_row_source(input, read_options);
  const EnvironmentInfo& info = source->info();
  Projection projection = project_source(*source, read_options, options, control);
  if (level > 0) projection.diagnostics.error_estimate = level_error(projection, info);
  put_first(projection,
            {{"reduce", PassAction::reuse,
              "level " + std::to_string(level) + " of the file's mip chain, " + std::to_string(info.width) + " x " +
                  std::to_string(info.height) + ", is the nearest of " + std::to_string(full.levels.size()),
              0.0}});
  return projection;
}

/// Returns the light that the file stores, if it has all the requested bands.
std::optional<SphericalHarmonics> reusable_radiance(const RowSource& source, const ProjectionOptions& options) {
  const std::optional<SphericalHarmonics>& stored = source.traits().stored_radiance;
  return stored && options.bands <= stored->bands() ? stored : std::nullopt;
}

Projection reused(const RowSource& source, const SphericalHarmonics& radiance, const ProjectionOptions& options,
                  const Control& control) {
  jobs::throw_if_cancelled(control);
  constexpr double six_digits = 1e-5;  // of the constants that such a polynomial is made with
  Projection projection;
  projection.radiance = SphericalHarmonics(options.bands);
  for (int l = 0; l < options.bands; ++l) {
    for (int m = -l; m <= l; ++m) projection.radiance.at(l, m) = radiance.at(l, m);
  }
  projection.diagnostics.total_radiance = radiance.at(0, 0) * std::sqrt(4.0 * std::numbers::pi);
  projection.diagnostics.total_radiance_before_clamp = projection.diagnostics.total_radiance;
  projection.diagnostics.error_estimate = six_digits;
  put_first(projection,
            {{"read", PassAction::run, storage_text(source.info()) + "; the manifest alone", 0.0},
             {"project", PassAction::reuse,
              "the polynomial that the file stores, in full where its pixels are clipped; no clamp, gamma or policy "
              "applies to it",
              0.0}});
  if (control.progress) control.progress(1.0);
  return projection;
}

}  // namespace

std::optional<int> level_for_target(const EnvironmentInfo& info, const ProjectionOptions& options) {
  std::vector<int> sizes;
  for (const LevelInfo& level : info.levels) {
    const int size = size_of(info, level);
    if (size == 0) break;
    sizes.push_back(size);
  }
  if (sizes.size() < 2) return std::nullopt;
  const bool lat_long = info.layout == Layout::lat_long;
  // A lat-long's target is 4 x target wide, and taken as it is by both quadratures.
  std::optional<int> target;
  if (!lat_long)
    target = projection::effective_target(sizes.front(), options);
  else if (options.target_size && *options.target_size <= (sizes[0] - 1) / 4)
    target = 4 * *options.target_size;
  if (!target) return std::nullopt;
  return static_cast<int>(projection::nearest_level(sizes, *target));
}

Projection project_source(const RowSource& source, const ReadOptions& read_options, const ProjectionOptions& options,
                          const Control& control) {
  return source.info().layout == Layout::lat_long ? project_lat_long(source, read_options, options, control)
                                                  : project_cube(source, read_options, options, control);
}

}  // namespace files

Projection project_file(const FileInput& input, const ReadOptions& read_options, const ProjectionOptions& options,
                        const Control& control) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  const auto source = files::open_row_source(input, read_options);
  if (std::optional<SphericalHarmonics> radiance = files::reusable_radiance(*source, options)) {
    return files::reused(*source, *std::move(radiance), options, control);
  }
  if (read_options.level == 0 && !source->traits().prefiltered_levels) {
    if (const std::optional<int> level = files::level_for_target(source->info(), options)) {
      return files::project_level(input, source->info(), *level, read_options, options, control);
    }
  }
  return files::project_source(*source, read_options, options, control);
}

}  // namespace welkin
