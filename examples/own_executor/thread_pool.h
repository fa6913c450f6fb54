// A thread pool as engines have one: a queue of functions, and threads that call them. It knows nothing of Welkin.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace own_executor {

class ThreadPool {
 public:
  explicit ThreadPool(std::size_t threads) {
    for (std::size_t k = 0; k < threads; ++k) threads_.emplace_back([this] { serve(); });
  }

  /// Calls what is left in the queue, then ends the threads.
  ~ThreadPool() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  void push(std::function<void()> function) {
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(function));
    }
    changed_.notify_one();
  }

  [[nodiscard]] std::size_t size() const noexcept { return threads_.size(); }

 private:
  void serve() {
    for (;;) {
      std::function<void()> function;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return closed_ || !queue_.empty(); });
        if (queue_.empty()) return;
        function = std::move(queue_.front());
        queue_.pop_front();
      }
      function();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace own_executor
