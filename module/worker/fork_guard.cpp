#include "worker/fork_guard.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

#include "jobs/activity.h"
#include "platform/file.h"
#include "platform/thread.h"
#include "welkin/core.h"

namespace welkin::detail {
namespace {

// A fork has copies of these, as they were when it was made.
std::atomic<std::int64_t> sound_process{platform::process_number()};
std::atomic<std::int64_t> silent_process{0};  ///< where oneTBB did not answer

/// Whether a loop in an arena of its own comes to its end. It takes oneTBB's locks of arenas and of the pool's threads;
/// where one is locked for good, the thread that tries is left behind.
bool one_tbb_answers() {
  constexpr std::chrono::seconds kPatience{5};
  const auto done = std::make_shared<std::promise<void>>();
  const std::future<void> answer = done->get_future();
  std::thread([done] {
    try {
      tbb::task_arena arena(2);
      arena.execute([] { tbb::parallel_for(0, 64, [](int) {}); });
    } catch (...) {  // no memory: that is an answer too, and whoever works next will see it
    }
    done->set_value();
  }).detach();
  return answer.wait_for(kPatience) == std::future_status::ready;
}

}  // namespace

void require_no_lost_locks() {
  if (sound_process == platform::process_number()) return;
  // A thread of the parent's may have been anywhere: in our caches, in oneTBB's heap, which forks leave as it was in
  // the middle of an allocation, or asleep on a stack that a thread of this process has now. Nothing of that can be
  // known here, but that it was there.
  if (jobs::activities != 0) {
    throw Error(
        ErrorCode::stopped,
        "this process was forked while its parent had a worker or a call of it computed, whose locks nobody opens "
        "here; fork before workers are made or after they are gone, or run another program (exec)");
  }
  if (silent_process == platform::process_number() || !one_tbb_answers()) {
    silent_process = platform::process_number();
    throw Error(
        ErrorCode::stopped,
        "oneTBB does not answer in this process, which was forked while a thread of its parent's was inside it; "
        "fork while no thread is, or run another program (exec)");
  }
  sound_process = platform::process_number();
}

}  // namespace welkin::detail
