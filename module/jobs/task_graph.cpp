#include "jobs/task_graph.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <utility>

#include "jobs/activity.h"
#include "jobs/backend.h"
#include "jobs/control.h"
#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/core.h"

namespace welkin::jobs {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

bool only_cancelled(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return error.code() == ErrorCode::cancelled;
  } catch (...) {
    return false;
  }
}

/// The share of the graph's progress that one pass has, in units of the whole.
class PassProgress {
 public:
  void set_units(std::uint64_t units) { units_ = units; }
  [[nodiscard]] std::uint64_t units() const { return units_; }

  /// The pass has done this share of its work. Its last unit is added when it ends, so that 1 is only told then.
  void report(double share, Progress& whole) {
    const double counted = std::clamp(share, 0.0, 1.0) * static_cast<double>(units_ - 1);
    rise_to(static_cast<std::uint64_t>(counted), whole);
  }
  void end(Progress& whole) { rise_to(units_, whole); }

 private:
  void rise_to(std::uint64_t units, Progress& whole) {
    std::uint64_t before = done_.load(std::memory_order_relaxed);
    while (before < units && !done_.compare_exchange_weak(before, units, std::memory_order_relaxed)) {
    }
    if (before < units) whole.add(units - before);
  }

  std::uint64_t units_ = 1;
  std::atomic<std::uint64_t> done_{0};
};

}  // namespace

std::size_t TaskGraph::add(double cost, Work work, const std::vector<std::size_t>& after) {
  const std::size_t pass = passes_.size();
  passes_.push_back({cost, std::move(work), after.size(), {}});
  for (const std::size_t earlier : after) passes_[earlier].next.push_back(pass);
  return pass;
}

/// State that exists while passes run.
class TaskGraph::Run {
 public:
  Run(std::vector<Pass>& passes, const Control& control)
      : passes_(passes),
        stopper_(control.stop, [this] { stop_.request_stop(); }),
        pass_progress_(std::make_unique<PassProgress[]>(passes.size())),
        progress_(control, divide_progress()),
        waits_for_(std::make_unique<std::atomic<std::size_t>[]>(passes.size())),
        failures_(passes.size() + 1),
        memory_(control.memory) {
    for (std::size_t pass = 0; pass < passes.size(); ++pass) waits_for_[pass] = passes[pass].waits_for;
  }

  /// On the calling thread, in the order in which passes were added.
  void all_alone() {
    const platform::FloatingPointScope floating_point;
    for (std::size_t pass = 0; pass < passes_.size(); ++pass) run_pass(pass);
  }

  void all() {
    // Isolated: while it waits, this thread does not pick up a stranger's task.
    backend::isolate([&] {
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
    if (ended_ != passes_.size()) throw Error(ErrorCode::cancelled, "the scheduler dropped some of the passes");
  }

 private:
  /// Gives every pass its units, by cost and at least one; returns their sum.
  std::uint64_t divide_progress() {
    constexpr double kUnits = 1e9;  // finer than anybody looks, and sums of it are exact
    double total = 0.0;
    for (const Pass& pass : passes_) total += pass.cost;
    std::uint64_t sum = 0;
    for (std::size_t pass = 0; pass < passes_.size(); ++pass) {
      const double units = std::floor(kUnits * (passes_[pass].cost / total));
      pass_progress_[pass].set_units(1 + static_cast<std::uint64_t>(units));
      sum += pass_progress_[pass].units();
    }
    return sum;
  }

  /// Runs a pass and, one after the other, what its end lets begin.
  void go_on(std::size_t pass) noexcept {
    const platform::FloatingPointScope floating_point;
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
    throw_if_cancelled(stop_.get_token());
    const Stopwatch watch;
    Control control{stop_.get_token(), {}, memory_};
    if (progress_.wanted()) {
      control.progress = [this, pass](double done) { pass_progress_[pass].report(done, progress_); };
    }
    passes_[pass].work(control);
    passes_[pass].milliseconds = watch.milliseconds();
    pass_progress_[pass].end(progress_);
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
  stop_source stop_;  ///< of the passes: the caller's, or a failure
  stop_callback<std::function<void()>> stopper_;
  std::unique_ptr<PassProgress[]> pass_progress_;
  Progress progress_;
  std::unique_ptr<std::atomic<std::size_t>[]> waits_for_;
  std::vector<std::exception_ptr> failures_;  ///< of each pass, set by the thread that runs it; of none in particular
  std::atomic<std::size_t> ended_{0};
  backend::TaskGroup group_;
  memory_resource* memory_;  ///< the caller's, for chains that passes return
};

void TaskGraph::run(const Control& control) {
  throw_if_cancelled(control);
  if (passes_.empty()) {
    if (control.progress) control.progress(1.0);
    return;
  }
  for (auto pass = passes_.rbegin(); pass != passes_.rend(); ++pass) {
    pass->way = pass->cost;
    for (const std::size_t next : pass->next) pass->way = std::max(pass->way, pass->cost + passes_[next].way);
  }
  const ActivityScope at_work;
  Run run(passes_, control);
  if (OneThread::here()) {
    run.all_alone();
  } else {
    run.all();
  }
}

}  // namespace welkin::jobs
