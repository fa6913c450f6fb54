#include "codec/row_groups.h"

#include <algorithm>

#include "codec/byte_file.h"
#include "jobs/tiles.h"

namespace welkin::codec {
namespace {

// Texels from which a task is worth its start, and from which waking the pool is.
constexpr std::int64_t kTexelsPerTask = 32 * 1024;
constexpr std::int64_t kTexelsForPool = 64 * 1024;

std::uint64_t worker_bytes(const RowSource& source, const RowGroups& groups) {
  return source.reader_bytes() + (groups.buffered ? rgb_bytes(source.info().width, groups.rows) : 0);
}

jobs::Placement placement(const RowSource& source, const RowGroups& groups) {
  const EnvironmentInfo& info = source.info();
  const std::uint64_t one = worker_bytes(source, groups);
  if (one > groups.memory_limit_bytes) {
    throw file_error(ErrorCode::limit_exceeded, info.path,
                     "decoding " + std::to_string(groups.rows) + " rows at once (" + info.storage + ", " +
                         info.compression + ") takes " + std::to_string(one) + " bytes, above the limit of " +
                         std::to_string(groups.memory_limit_bytes) +
                         "; raise the limit, or save it with smaller blocks");
  }
  const bool small = std::int64_t{info.width} * info.height < kTexelsForPool;
  const std::uint64_t threads = jobs::worker_count(jobs::Placement::arena);
  return small || one > groups.memory_limit_bytes / threads ? jobs::Placement::calling_thread : jobs::Placement::arena;
}

}  // namespace

int comfortable_group_rows(const RowSource& source) {
  const std::int64_t natural = source.natural_rows();
  const std::int64_t texels = natural * source.info().width;
  const std::int64_t rows = natural * ((kTexelsPerTask + texels - 1) / texels);
  return static_cast<int>(std::min<std::int64_t>(rows, source.info().height));
}

void for_each_row_group(const RowSource& source, const RowGroups& groups, const Control& control,
                        const std::function<void(RowWorker&, int, int)>& work) {
  const int height = source.info().height;
  RowGroups fitting = groups;
  fitting.rows = std::min(groups.rows, height);
  const int count = (height + fitting.rows - 1) / fitting.rows;
  const std::uint64_t floats = fitting.buffered ? rgb_bytes(source.info().width, fitting.rows) / sizeof(float) : 0;
  const jobs::Placement where = placement(source, fitting);
  std::vector<RowWorker> workers(jobs::worker_count(where));
  jobs::run_tiles(static_cast<std::size_t>(count), where, workers.size(), control,
                  [&](std::size_t group, std::size_t index) {
                    RowWorker& worker = workers[index];
                    if (!worker.reader) {
                      worker.index = index;
                      worker.reader = source.open_reader();
                      worker.rows.resize(floats);
                    }
                    const int first_row = static_cast<int>(group) * fitting.rows;
                    work(worker, first_row, std::min(fitting.rows, height - first_row));
                  });
}

}  // namespace welkin::codec
