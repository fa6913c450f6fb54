#include "jobs/task_graph.h"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>

#include "welkin/error.h"

namespace welkin::jobs {
namespace {

/// Adds up what the passes have done and tells the caller, one call at a time and never backwards.
class Shares {
 public:
  Shares(const std::vector<Pass>& passes, const Control& control)
      : control_(control), done_(std::make_unique<std::atomic<double>[]>(passes.size())), count_(passes.size()) {
    for (const Pass& pass : passes) whole_ += pass.cost;
    for (std::size_t i = 0; i < count_; ++i) done_[i] = 0.0;
  }

  /// `control` of one pass.
  Control of(std::size_t index, double cost) {
    Control part{control_.stop, {}};
    if (control_.progress) {
      part.progress = [this, index, cost](double share) {
        done_[index].store(share * cost, std::memory_order_relaxed);
        tell(false);
      };
    }
    return part;
  }

  void end(std::size_t index, double cost) {
    if (!control_.progress) return;
    done_[index].store(cost, std::memory_order_relaxed);
    tell(false);
  }

  /// The last call, which says 1.
  void finish() {
    if (control_.progress) tell(true);
  }

 private:
  void tell(bool all) {
    std::unique_lock lock(mutex_, std::defer_lock);
    if (all) {
      lock.lock();
    } else if (!lock.try_lock()) {
      return;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < count_; ++i) sum += done_[i].load(std::memory_order_relaxed);
    const double share = all ? 1.0 : std::min(1.0, sum / whole_);
    if (!(share > told_)) return;
    told_ = share;
    tbb::this_task_arena::isolate([&] { control_.progress(share); });
  }

  const Control& control_;
  std::unique_ptr<std::atomic<double>[]> done_;
  std::size_t count_;
  double whole_ = 0.0;
  double told_ = 0.0;
  std::mutex mutex_;
};

/// The first exception of several threads.
class FirstFailure {
 public:
  template <class Work>
  void guard(const Work& work) noexcept {
    if (failed_.load(std::memory_order_relaxed)) return;
    try {
      work();
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      failed_.store(true, std::memory_order_relaxed);
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

void run_together(const std::vector<Pass>& passes, const Control& control) {
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
  Shares shares(passes, control);
  FirstFailure failure;
  std::atomic<std::size_t> ended{0};
  const auto run = [&](std::size_t index) {
    failure.guard([&] {
      const Control part = shares.of(index, passes[index].cost);
      passes[index].work(part);
      shares.end(index, passes[index].cost);
    });
    ended.fetch_add(1, std::memory_order_relaxed);
  };
  // As in run_tiles: a group of our own, and no stranger's task while we wait.
  tbb::task_group_context own_group(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::task_group group(own_group);
    for (std::size_t index = 1; index < passes.size(); ++index) group.run([&run, index] { run(index); });
    if (!passes.empty()) run(0);
    group.wait();
  });
  failure.rethrow();
  if (ended.load() != passes.size()) throw Error(ErrorCode::cancelled, "oneTBB dropped some of the work");
  shares.finish();
}

}  // namespace welkin::jobs
