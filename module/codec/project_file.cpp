#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>

#include "codec/byte_file.h"
#include "codec/read_environment.h"
#include "codec/row_groups.h"
#include "jobs/tiles.h"
#include "sh/lat_long_projector.h"

namespace welkin {
namespace codec {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

std::string kind_of(const EnvironmentInfo& info) { return info.format + ", " + info.storage + ", " + info.compression; }

// What the projection has to say comes behind what the file's side did.
void put_first(Projection& projection, std::vector<PassRecord> passes) {
  std::vector<PassRecord>& all = projection.diagnostics.passes;
  all.insert(all.begin(), passes.begin(), passes.end());
}

// A projection speaks of faces, rows and columns; the reader of the message wants the file as well.
template <typename Work>
Projection naming_file(const std::filesystem::path& path, const Work& work) {
  try {
    return work();
  } catch (const Error& failure) {
    if (failure.code() == ErrorCode::rejected_pixel) {
      throw file_error(failure.code(), path, failure.what());
    }
    throw;
  }
}

Projection project_strip(const RowSource& source, const ReadOptions& read_options, const ProjectionOptions& options,
                         const Control& control) {
  constexpr double kReadingShare = 0.8;  // decoding is most of the work, whatever the compression
  const Clock::time_point start = Clock::now();
  const Environment environment = read_whole(source, read_options, jobs::part_of(control, 0.0, kReadingShare));
  const double reading = milliseconds(Clock::now() - start);
  Projection projection = naming_file(source.info().path, [&] {
    return project(environment.cubemap(), options, jobs::part_of(control, kReadingShare, 1.0));
  });
  put_first(projection, {{"read", "run", kind_of(source.info()) + "; a cubemap is held whole", reading}});
  return projection;
}

// Rows that are decoded and projected together: whole blocks of the projector, at least as many rows as
// decode together, and if some multiple up to a few times as many suits both, that one, so that no row is
// decoded twice.
int group_rows(int block_rows, int natural_rows) {
  constexpr int kMostTimes = 4;
  const int least = (natural_rows + block_rows - 1) / block_rows * block_rows;
  const std::int64_t common = std::lcm(std::int64_t{block_rows}, std::int64_t{natural_rows});
  return common <= std::int64_t{kMostTimes} * least ? static_cast<int>(common) : least;
}

void project_rows(sh::LatLongProjector& projector, const RowWorker& worker, int width, int first_row, int row_count) {
  const int block_rows = projector.rows_per_block();
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(width);
  for (int row = 0; row < row_count; row += block_rows) {
    const LatLongView rows{worker.rows.data() + static_cast<std::size_t>(row) * row_floats, width,
                           std::min(block_rows, row_count - row), 0, PixelFormat::rgb_f32};
    projector.project_block((first_row + row) / block_rows, rows, worker.index);
  }
}

Projection project_lat_long(const RowSource& source, const ReadOptions& read_options, const ProjectionOptions& options,
                            const Control& control) {
  const EnvironmentInfo& info = source.info();
  sh::LatLongProjector projector(info.width, info.height, options, jobs::worker_count(jobs::Placement::arena));
  const RowGroups groups{group_rows(projector.rows_per_block(), source.natural_rows()), true,
                         read_options.memory_limit_bytes};
  std::atomic<Clock::rep> decoding{0};
  std::atomic<Clock::rep> projecting{0};
  for_each_row_group(source, groups, control, [&](RowWorker& worker, int first_row, int row_count) {
    const Clock::time_point start = Clock::now();
    worker.reader->read(first_row, row_count, worker.rows.data());
    const Clock::time_point decoded = Clock::now();
    project_rows(projector, worker, info.width, first_row, row_count);
    decoding += (decoded - start).count();
    projecting += (Clock::now() - decoded).count();
  });
  Projection projection = naming_file(info.path, [&] { return projector.finish(); });
  const std::string overlapped = "overlapped, time summed over threads";
  put_first(projection,
            {{"read", "run", kind_of(info) + "; " + std::to_string(groups.rows) + " rows at a time, " + overlapped,
              milliseconds(Clock::duration(decoding.load()))},
             {"cubemap", "skip", "a lat-long is projected directly", 0.0},
             {"project", "run", "rows as they are decoded, " + overlapped,
              milliseconds(Clock::duration(projecting.load()))}});
  return projection;
}

}  // namespace
}  // namespace codec

Projection project_file(const std::filesystem::path& path, const ReadOptions& read_options,
                        const ProjectionOptions& options, const Control& control) {
  const auto source = codec::open_row_source(path, read_options);
  return source->info().layout == Layout::lat_long ? codec::project_lat_long(*source, read_options, options, control)
                                                   : codec::project_strip(*source, read_options, options, control);
}

}  // namespace welkin
