// Helpers for jobs of workers: threads held at a given point, outcomes of futures, bounded waits, threads lent by a
// test, and a coroutine that is never awaited.
#pragma once

#include <tbb/task_arena.h>

#include "support/catch.h"
#include "welkin/core.h"
#include "welkin/worker.h"

namespace welkin::test {

/// Far longer than any wait of a test, sanitizers and a busy machine included.
inline constexpr std::chrono::seconds kPatience{120};

/// Waits until `condition()` holds; returns false on timeout.
template <class Condition>
bool eventually(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return true;
}

/// A hang cannot be unwound: other threads use objects on this one's stack. Ends the program, and Catch2 says where.
[[noreturn]] inline void give_up(const char* what) {
  std::fprintf(stderr, "hangs: %s\n", what);
  std::abort();
}

/// Returns the future's result, or throws its exception.
template <class Result>
Result take(std::future<Result> future) {
  if (future.wait_for(kPatience) != std::future_status::ready) give_up("a future");
  return future.get();
}

/// Returns "result", the name of an Error's code, "bad_alloc", "broken promise", or another exception's message.
template <class Call>
std::string outcome_of(const Call& call) {
  try {
    call();
    return "result";
  } catch (const Error& error) {
    return name(error.code());
  } catch (const std::bad_alloc&) {
    return "bad_alloc";
  } catch (const std::future_error& error) {
    return error.code() == std::future_errc::broken_promise ? "broken promise" : error.what();
  } catch (const std::exception& exception) {
    return exception.what();
  } catch (...) {
    return "something";
  }
}

template <class Result>
std::string outcome(std::future<Result> future) {
  return outcome_of([&] { static_cast<void>(take(std::move(future))); });
}

/// Returns the job's result, or throws its exception.
template <class Result>
Result take(Job<Result>& job) {
  if (job.valid() && !eventually([&] { return job.ready(); })) give_up("a job");
  return job.get();
}
template <class Result>
Result take(Job<Result>&& job) {
  return take(job);
}

template <class Result>
std::string outcome(Job<Result>& job) {
  return outcome_of([&] { static_cast<void>(take(job)); });
}
template <class Result>
std::string outcome(Job<Result>&& job) {
  return outcome(job);
}

/// A request that spins until a stop is requested.
inline void run_until_stopped(const Control& control) {
  while (!control.stop.stop_requested()) std::this_thread::yield();
}

/// Holds arriving threads until it is open.
class Gate {
 public:
  void open() noexcept { open_.store(true, std::memory_order_release); }
  [[nodiscard]] bool is_open() const noexcept { return open_.load(std::memory_order_acquire); }

  void pass() noexcept {
    inside_.fetch_add(1, std::memory_order_acq_rel);
    while (!is_open()) std::this_thread::yield();
  }

  /// The number of arrivals so far.
  [[nodiscard]] int arrived() const noexcept { return inside_.load(std::memory_order_acquire); }

  void wait_for_arrivals(int count) const {
    if (!eventually([&] { return arrived() >= count; })) give_up("nobody came to the gate");
  }

 private:
  std::atomic<bool> open_{false};
  std::atomic<int> inside_{0};
};

/// Returns a job that has begun to run and continues until it is stopped.
inline Job<int> running_job(Worker& worker, const PostOptions& options = {}) {
  const auto gate = std::make_shared<Gate>();
  gate->open();
  Job<int> job = worker.post(
      [gate](const Control& control) {
        gate->pass();
        run_until_stopped(control);
        return 1;
      },
      options);
  gate->wait_for_arrivals(1);
  return job;
}

inline Job<int> post_value(Worker& worker, int value, const PostOptions& options = {}) {
  return worker.post([value](const Control&) { return value; }, options);
}

/// Options with own threads at the test's priority: a machine that is busy elsewhere must not starve them.
inline WorkerOptions options_with(int threads, WorkerOptions others = {}) {
  others.threads = threads;
  others.thread_priority = ThreadPriority::normal;
  return others;
}

/// Keeps all threads of a worker busy until it is released.
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

/// A TBB arena as an engine would lend it.
class ArenaExecutor final : public Executor {
 public:
  explicit ArenaExecutor(tbb::task_arena& arena) : arena_(arena) {}

  [[nodiscard]] int concurrency() const noexcept override { return arena_.max_concurrency(); }
  void enqueue(void (*run)(void* job), void* job) override {
    arena_.enqueue([run, job] { run(job); });
  }

 private:
  tbb::task_arena& arena_;
};

inline WorkerOptions lent(std::shared_ptr<Executor> executor) { return {.executor = std::move(executor)}; }

inline WorkerOptions lent(tbb::task_arena& arena) { return lent(std::make_shared<ArenaExecutor>(arena)); }

struct Detached {
  /// The number that have begun and not ended: it shows a test that leaks one.
  inline static std::atomic<int> alive{0};

  // NOLINTBEGIN(readability-convert-member-functions-to-static): the language defines the names
  struct promise_type {
    promise_type() { ++alive; }
    ~promise_type() { --alive; }
    promise_type(const promise_type&) = delete;
    promise_type& operator=(const promise_type&) = delete;

    Detached get_return_object() noexcept { return {}; }
    std::suspend_never initial_suspend() noexcept { return {}; }
    std::suspend_never final_suspend() noexcept { return {}; }
    void return_void() noexcept {}
    void unhandled_exception() noexcept { std::terminate(); }
  };
  // NOLINTEND(readability-convert-member-functions-to-static)
};

}  // namespace welkin::test
