// An arena for programs that have none, as wide as the process may really run.
#include "jobs/tiles.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "jobs/activity.h"
#include "jobs/trace.h"
#include "platform/float_environment.h"
#include "platform/thread.h"
#include "platform/wait.h"
#include "welkin/core.h"

namespace welkin::jobs {
namespace {

constexpr std::int64_t kInlineTexels = 100'000;

thread_local int tiles_on_this_thread = 0;
thread_local int alone_on_this_thread = 0;

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

OneThread::OneThread() noexcept { ++alone_on_this_thread; }
OneThread::~OneThread() { --alone_on_this_thread; }
bool OneThread::here() noexcept { return alone_on_this_thread > 0; }

bool inside_tile() noexcept { return tiles_on_this_thread > 0; }

Placement placement_for(std::int64_t texels) noexcept {
  return texels <= kInlineTexels ? Placement::calling_thread : Placement::arena;
}

std::size_t worker_count(Placement placement) {
  if (placement == Placement::calling_thread || OneThread::here()) return 1;
  return static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

void run_tiles(std::size_t count, Placement placement, std::size_t workers, const Control& control,
               const std::function<void(std::size_t, std::size_t)>& tile) {
  throw_if_cancelled(control);
  Progress progress(control, count);
  const TracedRegionScope region(&tile.target_type(), count);
  const auto run_as = [&](std::size_t index, std::size_t worker) {
    const TileScope scope;
    const TracedPartScope part(index);
    tile(index, worker);
  };
  if (placement == Placement::calling_thread || count <= 1 || OneThread::here()) {
    for (std::size_t index = 0; index < count; ++index) {
      throw_if_cancelled(control);
      const platform::FloatingPointScope floating_point;
      run_as(index, 0);
      progress.add(1);
    }
    return;
  }
  WorkerNumbers numbers(workers);
  const auto run_one = [&](std::size_t index) {
    throw_if_cancelled(control);
    const platform::FloatingPointScope floating_point;
    {
      const WorkerScope worker(numbers);
      run_as(index, worker.number());
    }
    progress.add(1);
  };
  const ActivityScope at_work;
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

constexpr int kMostThreads = 1024;  // the arena makes room for each

/// Threads of our own that take part in the parallel work of an arena until this object goes. oneTBB's own would end
/// the process where the system refuses to make one; of ours there are fewer then.
class Helpers {
 public:
  Helpers(tbb::task_arena& arena, int wanted) {
    const detail::AddressReserve reserve(detail::kRoomForWork);
    if (!reserve.held()) return;
    helpers_.reserve(static_cast<std::size_t>(wanted));
    try {
      while (static_cast<int>(helpers_.size()) < wanted) make_one(arena);
    } catch (const std::system_error&) {  // no thread
    } catch (const std::bad_alloc&) {     // no memory for one
    }
    // What each takes to enter the arena it takes while the reserve is held.
    for (const std::unique_ptr<Helper>& helper : helpers_) platform::wait_while(helper->settled, false);
  }
  ~Helpers() {
    for (const std::unique_ptr<Helper>& helper : helpers_) helper->blocker = tbb::task_handle();
    for (const std::unique_ptr<Helper>& helper : helpers_) helper->thread.join();
  }
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

 private:
  struct Helper {
    tbb::task_group group;
    tbb::task_handle blocker;  ///< the group's wait ends when this goes
    std::atomic<bool> settled{false};
    std::thread thread;

    void settle() {
      settled = true;
      platform::wake_all(settled);
    }
    ~Helper() {
      blocker = tbb::task_handle();
      group.wait();  // which a group that no thread has waited for wants
    }
    Helper() : blocker(group.defer([] {})) {}
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;
  };

  void make_one(tbb::task_arena& arena) {
    auto helper = std::make_unique<Helper>();
    helper->thread = std::thread([&arena, &one = *helper] { help(arena, one); });
    helpers_.push_back(std::move(helper));  // for which there is room
  }

  /// Waiting in the arena, a thread runs the tasks that others spawn there, and sleeps while there are none.
  static void help(tbb::task_arena& arena, Helper& helper) noexcept {
    try {
      arena.execute([&helper] {
        helper.settle();
        helper.group.wait();
      });
    } catch (const std::exception&) {  // no memory to enter the arena with: one thread fewer
      helper.settle();
    }
  }

  std::vector<std::unique_ptr<Helper>> helpers_;
};

}  // namespace

int available_threads() {
  const int processors = std::max(1, tbb::info::default_concurrency());
  const int quota = detail::quota_processors();
  return quota > 0 ? std::min(processors, quota) : processors;
}

void run_with_threads(int threads, const std::function<void()>& work) {
  if (threads < 0 || threads > kMostThreads) {
    throw Error(ErrorCode::invalid_argument,
                "threads is " + std::to_string(threads) + "; it must be from 0 to " + std::to_string(kMostThreads));
  }
  const int count = threads == 0 ? available_threads() : threads;
  // All places are kept for threads that enter by themselves: oneTBB sends none of its own, which it would make first.
  tbb::task_arena arena(count, static_cast<unsigned>(count));
  arena.initialize();
  const Helpers helpers(arena, count - 1);
  arena.execute(work);
}

}  // namespace welkin
