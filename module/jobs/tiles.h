// Work in tiles, run by any free thread.
//
// A job is `count` tiles. Their number and extent follow from the problem's shape alone, never from the number of
// threads. Each tile writes to its own slot, and slots are reduced in one fixed order. This makes results
// deterministic under any schedule.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "jobs/control.h"

namespace welkin::jobs {

/// Where a job runs.
enum class Placement {
  calling_thread,  ///< small work: waking a pool would cost more
  arena,           ///< as tasks in the caller's arena
};

/// The arena from some 100 000 texels on, which take about 30 microseconds in one thread.
[[nodiscard]] Placement placement_for(std::int64_t texels) noexcept;

/// How many workers may be inside a job at once: the length of an array of scratch space, one entry each.
[[nodiscard]] std::size_t worker_count(Placement placement);

/// Calls `tile(index, worker)` once for every index in [0, count); `worker` is below `workers`, the value that
/// `worker_count` returned when the scratch memory was made, and no other running tile has the same `worker`.
///
/// Tiles run, and progress is reported, with the default floating-point environment (round to nearest, denormals kept)
/// whatever the thread has set, and leave that as it was. Before each tile the stop token is checked; after each one
/// progress is reported. The first exception that a tile throws ends the job and comes out here.
/// Throws `Error` (cancelled). Allocates nothing of its own between the first tile's start and the last
/// one's end. Tiles run whatever becomes of the caller's own group of tasks: a result is whole or there is none.
void run_tiles(std::size_t count, Placement placement, std::size_t workers, const Control& control,
               const std::function<void(std::size_t tile, std::size_t worker)>& tile);

/// Calls `use(row, worker)` for each of so many rows, in tiles of `tile_rows` that are run in the same way.
template <class Use>
void run_rows(int rows, int tile_rows, Placement placement, std::size_t workers, const Control& control,
              const Use& use) {
  run_tiles(static_cast<std::size_t>((rows + tile_rows - 1) / tile_rows), placement, workers, control,
            [&](std::size_t tile, std::size_t worker) {
              const int first = static_cast<int>(tile) * tile_rows;
              for (int row = first; row < std::min(rows, first + tile_rows); ++row) use(row, worker);
            });
}

/// As long as it lives, jobs and graphs of the calling thread run on this thread alone: where many calls run side by
/// side, sharing the work of one would only cost time.
class OneThread {
 public:
  OneThread() noexcept;
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

  /// Whether one lives in the calling thread.
  [[nodiscard]] static bool here() noexcept;
};

/// Throws `Error` (invalid_argument) unless `run_with_threads` takes that many.
void require_thread_count(int threads);

/// Whether the calling thread is inside a tile: for tests that watch what tiles do to the heap.
[[nodiscard]] bool inside_tile() noexcept;

}  // namespace welkin::jobs
