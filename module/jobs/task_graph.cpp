#include "jobs/task_graph.h"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <stop_token>
#include <utility>

#include "platform/float_environment.h"
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

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// One number over all passes, one call at a time and never falling.
class Progress {
 public:
  Progress(const Control& control, std::size_t passes)
      : control_(control), done_(std::make_unique<std::atomic<double>[]>(passes)), costs_(passes, 0.0) {}

  void set_cost(std::size_t pass, double share) { costs_[pass] = share; }

  [[nodiscard]] bool wanted() const { return static_cast<bool>(control_.progress); }

  void report(std::size_t pass, double done) {
    if (!wanted()) return;
    done_[pass].store(done, std::memory_order_relaxed);
    changes_.fetch_add(1);
    for (;;) {  // whoever holds the lock reports for the others too, and looks once more after letting go of it
      const std::unique_lock lock(mutex_, std::try_to_lock);
      if (!lock) return;
      const unsigned seen = changes_.load();
      const double now = sum();
      if (now > reported_ && now < 1.0) {
        reported_ = now;
        // The callback may use TBB: isolated, its waiting cannot begin another pass, which would come back here.
        tbb::this_task_arena::isolate([&] { control_.progress(now); });
      }
      if (changes_.load() == seen) return;
    }
  }

  void finished() {
    if (wanted()) control_.progress(1.0);
  }

 private:
  [[nodiscard]] double sum() const {
    double all = 0.0;
    for (std::size_t pass = 0; pass < costs_.size(); ++pass) {
      all += costs_[pass] * done_[pass].load(std::memory_order_relaxed);
    }
    return all;
  }

  const Control& control_;
  std::unique_ptr<std::atomic<double>[]> done_;
  std::vector<double> costs_;
  std::atomic<unsigned> changes_{0};
  std::mutex mutex_;
  double reported_ = -1.0;
};

bool only_cancelled(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return error.code() == ErrorCode::cancelled;
  } catch (...) {
    return false;
  }
}

}  // namespace

std::size_t PassGraph::add(double cost, Work work, const std::vector<std::size_t>& after) {
  const std::size_t pass = passes_.size();
  passes_.push_back({cost, std::move(work), after.size(), {}});
  for (const std::size_t earlier : after) passes_[earlier].next.push_back(pass);
  return pass;
}

/// What lives while passes run.
class PassGraph::Run {
 public:
  Run(std::vector<Pass>& passes, const Control& control)
      : passes_(passes),
        stopper_(control.stop, [this] { stop_.request_stop(); }),
        progress_(control, passes.size()),
        waits_for_(std::make_unique<std::atomic<std::size_t>[]>(passes.size())),
        failures_(passes.size() + 1),
        group_(own_context_) {
    double total = 0.0;
    for (const Pass& pass : passes) total += pass.cost;
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
      progress_.set_cost(pass, passes[pass].cost / total);
      waits_for_[pass] = passes[pass].waits_for;
    }
  }

  void all() {
    // Isolated: while it waits, this thread does not pick up a stranger's task.
    tbb::this_task_arena::isolate([&] {
      try {
        std::vector<std::size_t> first;
        for (std::size_t pass = 0; pass < passes_.size(); ++pass) {
          if (passes_[pass].waits_for == 0) first.push_back(pass);
        }
        go_on(begin(std::move(first)));
      } catch (...) {
        fail(passes_.size());
      }
      group_.wait();
    });
    for (const bool cancelled_too : {false, true}) {
      for (const std::exception_ptr& failure : failures_) {
        if (failure && (cancelled_too || !only_cancelled(failure))) std::rethrow_exception(failure);
      }
    }
    if (ended_ != passes_.size()) throw Error(ErrorCode::cancelled, "oneTBB dropped some of the passes");
    progress_.finished();
  }

 private:
  /// Runs a pass and, one after the other, what its end lets begin.
  void go_on(std::size_t pass) noexcept {
    while (pass != kNone) {
      try {
        run_pass(pass);
        pass = begin(begun_by(pass));
      } catch (...) {
        fail(pass);
        return;
      }
    }
  }

  /// Makes tasks of all of `ready` but the costliest, which is returned.
  std::size_t begin(std::vector<std::size_t> ready) {
    if (ready.empty()) return kNone;
    std::sort(ready.begin(), ready.end(),
              [&](std::size_t a, std::size_t b) { return passes_[a].way > passes_[b].way; });
    for (std::size_t k = 1; k < ready.size(); ++k) {
      group_.run([this, pass = ready[k]] { go_on(pass); });
    }
    return ready.front();
  }

  void run_pass(std::size_t pass) {
    if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
    const auto begin = std::chrono::steady_clock::now();
    Control control{stop_.get_token(), {}};
    if (progress_.wanted()) control.progress = [this, pass](double done) { progress_.report(pass, done); };
    {
      const platform::FloatingPointScope environment;
      passes_[pass].work(control);
    }
    passes_[pass].milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    progress_.report(pass, 1.0);
    ++ended_;
  }

  std::vector<std::size_t> begun_by(std::size_t ended) {
    std::vector<std::size_t> ready;
    for (const std::size_t next : passes_[ended].next) {
      if (--waits_for_[next] == 0) ready.push_back(next);
    }
    return ready;
  }

  void fail(std::size_t pass) noexcept {
    failures_[pass] = std::current_exception();
    stop_.request_stop();
  }

  std::vector<Pass>& passes_;
  std::stop_source stop_;  ///< of the passes: the caller's, or a failure
  std::stop_callback<std::function<void()>> stopper_;
  Progress progress_;
  std::unique_ptr<std::atomic<std::size_t>[]> waits_for_;
  std::vector<std::exception_ptr> failures_;  ///< of each pass, set by the thread that runs it; of none in particular
  std::atomic<std::size_t> ended_{0};
  /// Of our own: if the caller's group is cancelled, its tasks are dropped and ours are not.
  tbb::task_group_context own_context_{tbb::task_group_context::isolated};
  tbb::task_group group_;
};

void PassGraph::run(const Control& control) {
  if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled by the caller");
  for (auto pass = passes_.rbegin(); pass != passes_.rend(); ++pass) {
    pass->way = pass->cost;
    for (const std::size_t next : pass->next) pass->way = std::max(pass->way, pass->cost + passes_[next].way);
  }
  Run(passes_, control).all();
}

}  // namespace welkin::jobs
