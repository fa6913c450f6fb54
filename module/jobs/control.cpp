#include "jobs/control.h"

#include <atomic>
#include <cstdint>
#include <mutex>

#include "jobs/backend.h"
#include "welkin/core.h"

namespace welkin::jobs {

void throw_if_cancelled(const stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorCode::cancelled, kCancelled);
}

Control part_of(const Control& control, double from, double to) {
  Control part{control.stop, {}, control.memory};
  if (control.progress) {
    part.progress = [&control, from, to](double done) { control.progress(from + (to - from) * done); };
  }
  return part;
}

#if defined(__aarch64__)

constexpr std::memory_order kAdding = std::memory_order_acq_rel;

/// Whether something was added since the last report. Adds nothing, and so has its place among the additions.
bool Progress::is_behind() noexcept {
  return reported_.load(std::memory_order_relaxed) < done_.fetch_add(0, std::memory_order_acq_rel);
}

#else

constexpr std::memory_order kAdding = std::memory_order_relaxed;

bool Progress::is_behind() noexcept { return reported_.load(std::memory_order_relaxed) < done(); }

#endif

void Progress::add(std::uint64_t units) {
  done_.fetch_add(units, kAdding);
  if (!wanted()) return;
  // The thread that holds the lock reports for the others too, and checks once more after releasing it.
  while (is_behind()) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const std::uint64_t now = done();
    if (now <= reported_.load(std::memory_order_relaxed)) continue;
    reported_.store(now, std::memory_order_relaxed);
    // The callback may have tasks of its own: isolated, its waiting cannot begin one of our tasks, which would come
    // back here.
    backend::isolate([&] { control_.progress(static_cast<double>(now) / static_cast<double>(whole_)); });
  }
}

}  // namespace welkin::jobs
