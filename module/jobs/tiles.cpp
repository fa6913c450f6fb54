#include "jobs/tiles.h"

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "jobs/activity.h"
#include "jobs/backend.h"
#include "platform/float_environment.h"
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

void require_thread_count(int threads) {
  constexpr int kMaxThreads = 1024;  // an arena reserves memory for each
  if (threads >= 0 && threads <= kMaxThreads) return;
  throw Error(ErrorCode::invalid_argument,
              "threads is " + std::to_string(threads) + "; it must be from 0 to " + std::to_string(kMaxThreads));
}

bool inside_tile() noexcept { return tiles_on_this_thread > 0; }

Placement placement_for(std::int64_t texels) noexcept {
  return texels <= kInlineTexels ? Placement::calling_thread : Placement::arena;
}

std::size_t worker_count(Placement placement) {
  if (placement == Placement::calling_thread || OneThread::here()) return 1;
  return static_cast<std::size_t>(backend::concurrency());
}

void run_tiles(std::size_t count, Placement placement, std::size_t workers, const Control& control,
               const std::function<void(std::size_t, std::size_t)>& tile) {
  throw_if_cancelled(control);
  Progress progress(control, count);
  const auto run_as = [&](std::size_t index, std::size_t worker) {
    const TileScope scope;
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
  backend::loop(count, run_one);
  if (progress.done() != count) throw Error(ErrorCode::cancelled, "the scheduler dropped some of the work");
}

}  // namespace welkin::jobs
