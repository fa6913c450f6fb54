#include "jobs/tiles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <mutex>

#include "jobs/floating_point_scope.h"
#include "welkin/error.h"

namespace welkin::jobs {
namespace {

thread_local int tiles_on_this_thread = 0;

/// Surrounds a tile's work.
class TileScope {
 public:
  TileScope() noexcept { ++tiles_on_this_thread; }
  ~TileScope() { --tiles_on_this_thread; }
  TileScope(const TileScope&) = delete;
  TileScope& operator=(const TileScope&) = delete;

 private:
  FloatingPointScope environment_;
};

void throw_if_stopped(const Control& control) {
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
}

/// Counts finished tiles and tells the caller, one call at a time and never backwards.
class Progress {
 public:
  Progress(const Control& control, std::size_t total) : control_(control), total_(total) {
    done_.store(0, std::memory_order_release);
  }

  /// oneTBB orders a tile after its spawn and its end before the join. Saying so through `done_` as well lets
  /// the thread sanitizer see it, which knows nothing of the inside of an uninstrumented library.
  void synchronize() const { static_cast<void>(done_.load(std::memory_order_acquire)); }

  void tile_done() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_acq_rel) + 1;
    if (!control_.progress) return;
    const std::scoped_lock lock(mutex_);
    if (done <= reported_) return;
    reported_ = done;
    control_.progress(static_cast<double>(done) / static_cast<double>(total_));
  }

 private:
  const Control& control_;
  std::size_t total_;
  std::atomic<std::size_t> done_;
  std::mutex mutex_;
  std::size_t reported_ = 0;
};

}  // namespace

bool inside_tile() noexcept { return tiles_on_this_thread > 0; }

std::size_t worker_count(Placement placement) {
  if (placement == Placement::calling_thread) return 1;
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

void run_tiles(std::size_t count, Placement placement, const Control& control,
               const std::function<void(std::size_t, std::size_t)>& tile) {
  throw_if_stopped(control);
  Progress progress(control, count);
  const auto run_one = [&](std::size_t index, std::size_t worker) {
    throw_if_stopped(control);
    progress.synchronize();
    {
      const TileScope scope;
      tile(index, worker);
    }
    progress.tile_done();
  };
  if (placement == Placement::calling_thread || count <= 1) {
    for (std::size_t index = 0; index < count; ++index) run_one(index, 0);
    return;
  }
  // An engine's arena may have a worker that waits for something else inside one of our tiles' callers;
  // isolation keeps that worker from starting a second tile on the same scratch space.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const tbb::blocked_range<std::size_t>& range) {
      const auto worker = static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
      for (std::size_t index = range.begin(); index != range.end(); ++index) run_one(index, worker);
    });
  });
  progress.synchronize();
}

}  // namespace welkin::jobs
