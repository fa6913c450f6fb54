// Loops on the standard library's threads, for builds without oneTBB. In WebAssembly these threads are workers of a
// page.
//
// `run_with_threads` creates the missing threads, which stay for later loops. One loop uses them at a time; a nested or
// concurrent loop runs on its calling thread alone. A graph's passes run one after another (tasks_in_order.cpp).
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "jobs/backend.h"
#include "jobs/tiles.h"
#include "welkin/core.h"

namespace welkin::jobs::backend {
namespace {

/// A loop's indices: each thread takes the next one until none is left.
class Loop {
 public:
  Loop(std::size_t count, const Call<std::size_t>& part, int helpers) : helpers_(helpers), count_(count), part_(part) {}

  /// Catches by `...` alone: code of LLVM 14 for WebAssembly cannot catch by type in two threads at a time.
  void work() noexcept {
    for (std::size_t index = next_++; index < count_; index = next_++) {
      try {
        part_(index);
      } catch (...) {
        if (!failed_.exchange(true)) failure_ = std::current_exception();
        next_ = count_;
      }
    }
  }

  /// Whether one more helper shall come; its caller holds the pool's mutex.
  [[nodiscard]] bool wants_help() const noexcept { return helpers_ > 0 && next_ < count_; }
  void take_place() noexcept { --helpers_; }

  void throw_failure() const {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
  }

 private:
  int helpers_;
  std::size_t count_;
  Call<std::size_t> part_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
};

thread_local bool inside_loop = false;
thread_local int width = 0;  ///< what `run_with_threads` said; 0 outside of it

/// Threads that sleep until there is a loop. Never destroyed: they may sleep while the program exits.
class Pool {
 public:
  static Pool& get() {
    static auto& pool = *new Pool;
    return pool;
  }

  [[nodiscard]] int threads() const noexcept { return threads_; }

  /// Makes so many threads in all; fewer where the system refuses one.
  void grow(int threads) noexcept {
    const std::lock_guard lock(mutex_);
    try {
      for (; threads_ < threads; ++threads_) std::thread([this] { help(); }).detach();
    } catch (...) {
    }
  }

  void share(Loop& loop) {
    std::unique_lock lock(mutex_);
    if (loop_ != nullptr) {
      lock.unlock();
      loop.work();
      return;
    }
    loop_ = &loop;
    lock.unlock();
    begun_.notify_all();
    loop.work();
    lock.lock();
    loop_ = nullptr;
    left_.wait(lock, [this] { return inside_ == 0; });
  }

 private:
  void help() {
    inside_loop = true;
    std::unique_lock lock(mutex_);
    for (;;) {
      begun_.wait(lock, [this] { return loop_ != nullptr && loop_->wants_help(); });
      Loop& loop = *loop_;
      loop.take_place();
      ++inside_;
      lock.unlock();
      loop.work();
      lock.lock();
      if (--inside_ == 0) left_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable begun_;
  std::condition_variable left_;
  Loop* loop_ = nullptr;
  int inside_ = 0;
  std::atomic<int> threads_{0};
};

}  // namespace

int concurrency() noexcept {
  if (inside_loop) return 1;
  const int most = Pool::get().threads() + 1;
  return width > 0 ? std::min(width, most) : most;
}

void loop(std::size_t count, Call<std::size_t> part) {
  const int helpers = concurrency() - 1;
  if (helpers == 0) {
    for (std::size_t index = 0; index < count; ++index) part(index);
    return;
  }
  Loop shared(count, part, helpers);
  inside_loop = true;
  Pool::get().share(shared);
  inside_loop = false;
  shared.throw_failure();
}

}  // namespace welkin::jobs::backend

namespace welkin {

int available_threads() {
  return std::max(jobs::backend::Pool::get().threads() + 1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_with_threads(int threads, const std::function<void()>& work) {
  jobs::require_thread_count(threads);
  const int count = threads == 0 ? available_threads() : threads;
  jobs::backend::Pool::get().grow(count - 1);
  struct Width {
    explicit Width(int count) : before(std::exchange(jobs::backend::width, count)) {}
    ~Width() { jobs::backend::width = before; }
    int before;
  } const scope(count);
  work();
}

}  // namespace welkin
