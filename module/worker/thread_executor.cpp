#include "worker/thread_executor.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

#include "jobs/activity.h"
#include "platform/thread.h"
#include "platform/wait.h"
#include "worker/scheduler.h"

namespace welkin::detail {
namespace {

/// Returns whether oneTBB can make the threads of the process's pool and leave memory for `threads` of ours and for
/// the work. Where it cannot, it would end the process.
bool can_make_pool_threads(int threads) {
  const AddressReserve reserve(kRoomForWork);
  return reserve.held() && can_make_threads(tbb::info::default_concurrency() - 1 + threads);
}

/// Has oneTBB make the threads of the process's pool now, and from here. It makes them when they are first wanted, and
/// a thread inherits its maker's rank: made from one of ours, by a request that opens an arena of its own, the engine's
/// pool would rank as low as we do, for good.
void make_pool_threads() {
  constexpr std::chrono::milliseconds kPatience{20};
  const int count = tbb::info::default_concurrency();
  if (count <= 1) return;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  std::atomic<int> there{0};
  tbb::task_arena arena(count);
  arena.execute([&] {
    tbb::parallel_for(
        0, count,
        [&](int) {
          // Each stays until all have come, or one thread would do the work of several.
          ++there;
          while (there < count && std::chrono::steady_clock::now() < until) std::this_thread::yield();
        },
        tbb::static_partitioner());
  });
}

}  // namespace

ThreadExecutor::ThreadExecutor(const WorkerOptions& options)
    : threads_(options.threads == 0 ? std::max(1, available_threads() - 1) : options.threads),
      priority_(options.thread_priority),
      name_(options.name),
      arena_(threads_, static_cast<unsigned>(threads_)),
      looks_(leaves_a_processor(threads_)),
      sleepers_(static_cast<std::size_t>(threads_)) {
  arena_.initialize();
}

void ThreadExecutor::set_up_thread(int number) const noexcept {
  char suffix[8] = {};
  std::snprintf(suffix, sizeof suffix, "%d", number);
  // The name is cut, not the suffix that distinguishes the threads.
  const int name_length = static_cast<int>(kMaxNameCharacters - std::strlen(suffix) - 1);
  char name[kMaxNameCharacters + 1] = {};
  std::snprintf(name, sizeof name, "%.*s %s", name_length, name_.c_str(), suffix);
  name_current_thread(name);
  rank_current_thread(priority_);
}

void ThreadExecutor::start(const std::shared_ptr<Scheduler>& scheduler) {
  if (priority_ != ThreadPriority::normal && can_make_pool_threads(threads_)) make_pool_threads();
  const std::lock_guard lock(threads_mutex_);
  own_threads_.reserve(static_cast<std::size_t>(threads_));
  for (int number = 0; number < threads_; ++number) {
    own_threads_.emplace_back([this, scheduler, number] { serve(*scheduler, number); });
  }
}

void ThreadExecutor::serve(Scheduler& scheduler, int number) {
  // Asleep too: oneTBB's list of sleeping threads leads to their stacks, which a fork gives to its own threads.
  const jobs::ActivityScope living;
  set_up_thread(number);
  const auto work = [&] {
    const ThreadRole role(scheduler);
    Sleeper& sleeper = sleepers_[static_cast<std::size_t>(number)];
    for (bool warm = false;;) {
      if (scheduler.run_next()) {
        warm = looks_;
        continue;
      }
      if (dismissed_) return;
      // Once only: who was called and found nothing takes part in what the others run.
      if (std::exchange(warm, false) && look_for_work(scheduler, sleeper)) continue;
      park(scheduler, sleeper);
    }
  };
  for (;;) {
    try {
      return arena_.execute(work);
    } catch (const std::bad_alloc&) {
      // oneTBB had no memory to enter the arena or to park with; others may give some back.
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

bool ThreadExecutor::look_for_work(Scheduler& scheduler, Sleeper& sleeper) {
  constexpr std::chrono::microseconds kTime{50};
  sleeper = &looking_;
  // Work that came before this thread could be seen to look.
  const WorkerLoad load = scheduler.load();
  if (!dismissed_ && load.waiting == 0 && load.running == 0) {
    spin_until([&] { return sleeper.load(std::memory_order_acquire) == nullptr; }, kTime);
  }
  return sleeper.exchange(nullptr) == nullptr || load.waiting > 0;
}

void ThreadExecutor::park(Scheduler& scheduler, Sleeper& sleeper) {
  Parking parking;
  parking.blocker = parking.group.defer([] {});
  sleeper = &parking.blocker;
  // Work that came after this thread looked for it, but before it could be seen to be free.
  if (dismissed_ || scheduler.load().waiting > 0) call(sleeper);
  parking.group.wait();
}

bool ThreadExecutor::call(Sleeper& sleeper) {
  // The blocker is moved out of the parking before it goes: the parking belongs to the waiting thread, and is gone as
  // soon as the wait ends.
  tbb::task_handle* const waiting = sleeper.load() != nullptr ? sleeper.exchange(nullptr) : nullptr;
  if (waiting == nullptr) return false;
  if (waiting == &looking_) return true;
  const tbb::task_handle blocker = std::move(*waiting);
  return true;
}

int ThreadExecutor::call_looking() {
  int called = 0;
  for (Sleeper& sleeper : sleepers_) {
    tbb::task_handle* looking = &looking_;
    if (sleeper.load() == looking && sleeper.compare_exchange_strong(looking, nullptr)) ++called;
  }
  return called;
}

void ThreadExecutor::call(int count) {
  if (count <= 0) return;
  // All of these, as they are awake: who finds nothing to start takes part in what is started.
  count -= call_looking();
  for (auto sleeper = sleepers_.begin(); count > 0 && sleeper != sleepers_.end(); ++sleeper) {
    if (call(*sleeper)) --count;
  }
}

void ThreadExecutor::dismiss() {
  dismissed_ = true;
  call(threads_);
}

void ThreadExecutor::join() {
  const std::lock_guard lock(threads_mutex_);
  for (std::thread& thread : own_threads_) {
    if (thread.joinable()) thread.join();
  }
}

void ThreadExecutor::detach() {
  const std::lock_guard lock(threads_mutex_);
  for (std::thread& thread : own_threads_) {
    if (thread.joinable()) thread.detach();
  }
}

}  // namespace welkin::detail
