// A line on the terminal: how many files are done and left, how fast, and how long the rest takes.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace welkin::tool {

/// Shown on standard error if that is a terminal, and wiped at the end. Thread-safe.
class BatchProgress {
 public:
  /// `seconds`: predicted, of all.
  BatchProgress(std::size_t jobs, double seconds);
  ~BatchProgress();
  BatchProgress(const BatchProgress&) = delete;
  BatchProgress& operator=(const BatchProgress&) = delete;

  /// One more is over. `seconds`: that were predicted for it, or 0 if nothing had to be done.
  void add(double seconds, bool failed);

  /// "12 of 2000 files, 3 failed, 45 a second, 44 s left"
  [[nodiscard]] std::string line() const;

 private:
  using Clock = std::chrono::steady_clock;

  void draw();

  bool terminal_;
  std::size_t jobs_;
  double seconds_;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  double seconds_done_ = 0.0;
  Clock::time_point start_;
  Clock::time_point next_drawing_;
  bool drawn_ = false;
  mutable std::mutex mutex_;
};

/// "41 s", "3 min 5 s", "2 h 10 min"
[[nodiscard]] std::string long_duration(double seconds);

}  // namespace welkin::tool
