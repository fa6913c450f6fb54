#include "worker_subjects.h"

namespace welkin::perf {

WorkerOptions worker_options(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.thread_priority = ThreadPriority::normal;
  return options;
}

void stay_busy(std::chrono::nanoseconds time) {
  const Clock::time_point end = Clock::now() + time;
  while (Clock::now() < end) {
  }
}

}  // namespace welkin::perf
