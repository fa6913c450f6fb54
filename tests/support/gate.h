// Threads of a worker, held where a test wants them.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "support/outcome.h"
#include "welkin/worker.h"

namespace welkin::test {

/// A request that runs until it is told to stop, awake all the time.
inline void run_until_stopped(const Control& control) {
  while (!control.stop.stop_requested()) std::this_thread::yield();
}

/// Holds those who pass until it is open.
class Gate {
 public:
  void open() noexcept { open_.store(true, std::memory_order_release); }
  [[nodiscard]] bool is_open() const noexcept { return open_.load(std::memory_order_acquire); }

  void pass() noexcept {
    inside_.fetch_add(1, std::memory_order_acq_rel);
    while (!is_open()) std::this_thread::yield();
  }

  /// How many came to the gate so far.
  [[nodiscard]] int arrived() const noexcept { return inside_.load(std::memory_order_acquire); }

  void wait_for_arrivals(int count) const {
    if (!eventually([&] { return arrived() >= count; })) give_up("nobody came to the gate");
  }

 private:
  std::atomic<bool> open_{false};
  std::atomic<int> inside_{0};
};

/// Threads of its own, as strong as the test's: a machine that is busy elsewhere must not starve them.
inline WorkerOptions options_with(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.thread_priority = ThreadPriority::normal;
  return options;
}

/// Keeps all threads of a worker busy until it is let go.
class Hold {
 public:
  explicit Hold(Worker& worker, int threads = 1) : gate_(std::make_shared<Gate>()) {
    for (int k = 0; k < threads; ++k) {
      held_.push_back(worker.post([gate = gate_](const Control&) { gate->pass(); }, {.priority = TaskPriority::high}));
    }
    gate_->wait_for_arrivals(threads);
  }
  ~Hold() { gate_->open(); }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

  void let_go() {
    gate_->open();
    for (const Job<void>& job : held_) {
      if (!eventually([&] { return job.ready(); })) give_up("a thread that was let go");
    }
  }

 private:
  std::shared_ptr<Gate> gate_;
  std::vector<Job<void>> held_;
};

}  // namespace welkin::test
