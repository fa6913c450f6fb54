#include "worker_subjects.h"

#include <cstddef>
#include <memory>

#include "subjects.h"

namespace welkin::perf {

WorkerOptions worker_options(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.thread_priority = ThreadPriority::normal;
  return options;
}

CubemapSource numbered_source(int size, int number) {
  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, size);
  // An owner that frees nothing and is told from others by its address.
  const auto* const address = static_cast<const std::byte*>(view.faces[0]) + number;
  return {view, std::shared_ptr<const void>(std::shared_ptr<const void>(), address)};
}

void stay_busy(std::chrono::nanoseconds time) {
  const Clock::time_point end = Clock::now() + time;
  while (Clock::now() < end) {
  }
}

}  // namespace welkin::perf
