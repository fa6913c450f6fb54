// An arena for programs that have none, as wide as the process may really run.
#include "jobs/tiles.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "platform/float_environment.h"
#include "welkin/core.h"

namespace welkin::jobs {
namespace {

constexpr std::int64_t kInlineTexels = 100'000;

thread_local int tiles_on_this_thread = 0;

/// Surrounds a tile's work.
class TileScope {
 public:
  TileScope() noexcept { ++tiles_on_this_thread; }
  ~TileScope() { --tiles_on_this_thread; }
  TileScope(const TileScope&) = delete;
  TileScope& operator=(const TileScope&) = delete;
};

/// Numbers for the threads inside a job, each held by one at a time. (TBB's own thread index does not do:
/// two threads that enter an arena for one have indices 0 and 1.)
class WorkerNumbers {
 public:
  explicit WorkerNumbers(std::size_t count) : count_(count), taken_(std::make_unique<std::atomic<bool>[]>(count)) {}

  /// A number that is free; waits if more threads came than there are numbers, which other threads give back.
  [[nodiscard]] std::size_t take() noexcept {
    for (;; std::this_thread::yield()) {
      for (std::size_t number = 0; number < count_; ++number) {
        // One that is taken is passed over without an exchange, which would order us after its last owner.
        if (taken_[number].load(std::memory_order_relaxed)) continue;
        if (!taken_[number].exchange(true, std::memory_order_acquire)) return number;
      }
    }
  }
  void give_back(std::size_t number) noexcept { taken_[number].store(false, std::memory_order_release); }

 private:
  std::size_t count_;
  std::unique_ptr<std::atomic<bool>[]> taken_;
};

class WorkerScope {
 public:
  explicit WorkerScope(WorkerNumbers& numbers) noexcept : numbers_(numbers), number_(numbers.take()) {}
  ~WorkerScope() { numbers_.give_back(number_); }
  WorkerScope(const WorkerScope&) = delete;
  WorkerScope& operator=(const WorkerScope&) = delete;

  [[nodiscard]] std::size_t number() const noexcept { return number_; }

 private:
  WorkerNumbers& numbers_;
  std::size_t number_;
};

}  // namespace

bool inside_tile() noexcept { return tiles_on_this_thread > 0; }

Placement placement_for(std::int64_t texels) noexcept {
  return texels <= kInlineTexels ? Placement::calling_thread : Placement::arena;
}

std::size_t worker_count(Placement placement) {
  if (placement == Placement::calling_thread) return 1;
  return static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

void run_tiles(std::size_t count, Placement placement, std::size_t workers, const Control& control,
               const std::function<void(std::size_t, std::size_t)>& tile) {
  throw_if_cancelled(control);
  Progress progress(control, count);
  WorkerNumbers numbers(workers);
  const auto run_one = [&](std::size_t index) {
    throw_if_cancelled(control);
    const platform::FloatingPointScope floating_point;
    {
      const WorkerScope worker(numbers);
      const TileScope scope;
      tile(index, worker.number());
    }
    progress.add(1);
  };
  if (placement == Placement::calling_thread || count <= 1) {
    for (std::size_t index = 0; index < count; ++index) run_one(index);
    return;
  }
  // A group of our own: if the caller's is cancelled, its tasks are dropped and ours are not. Isolated: a
  // thread that waits here does not pick up a stranger's task and keep us waiting for it.
  tbb::task_group_context own_group(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t index = range.begin(); index != range.end(); ++index) run_one(index);
        },
        own_group);
  });
  if (progress.done() != count) throw Error(ErrorCode::cancelled, "oneTBB dropped some of the work");
}

}  // namespace welkin::jobs

namespace welkin {
namespace {

constexpr int kMostThreads = 1024;  // oneTBB makes room for each, and has no bound of its own

/// Processors that the control group's quota grants (cgroup v2: "QUOTA PERIOD" in microseconds, or "max"),
/// or 0 where there is none. oneTBB counts processors by affinity and knows nothing of quotas.
int quota_processors() {
  const platform::FloatingPointScope floating_point;
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  std::string quota;
  double period = 0.0;
  if (!(file >> quota >> period) || quota == "max" || period <= 0.0) return 0;
  try {
    return std::max(1, static_cast<int>(std::ceil(std::stod(quota) / period)));
  } catch (const std::exception&) {
    return 0;
  }
}

}  // namespace

int available_threads() {
  const int processors = std::max(1, tbb::info::default_concurrency());
  const int quota = quota_processors();
  return quota > 0 ? std::min(processors, quota) : processors;
}

void run_with_threads(int threads, const std::function<void()>& work) {
  if (threads < 0 || threads > kMostThreads) {
    throw Error(ErrorCode::invalid_argument,
                "threads is " + std::to_string(threads) + "; it must be from 0 to " + std::to_string(kMostThreads));
  }
  const int count = threads == 0 ? available_threads() : threads;
  // Without this, oneTBB never runs more threads than there are processors, and a test on a small machine
  // could not ask for sixteen.
  const tbb::global_control allowance(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(count, available_threads())));
  tbb::task_arena arena(count);
  arena.execute(work);
}

}  // namespace welkin
