// Wall time, for the records of passes.
#pragma once

#include <chrono>

namespace welkin::jobs {

class Stopwatch {
 public:
  /// Returns milliseconds since it was made.
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace welkin::jobs
