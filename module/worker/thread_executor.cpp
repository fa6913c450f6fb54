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

#include "platform/thread.h"
#include "worker/scheduler.h"

namespace welkin::detail {
namespace {

thread_local const ThreadExecutor::Service* innermost_service = nullptr;

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

ThreadExecutor::Service::Service(const Scheduler& scheduler, Role role) noexcept
    : scheduler_(&scheduler), role_(role), outer_(innermost_service) {
  innermost_service = this;
}
ThreadExecutor::Service::~Service() { innermost_service = outer_; }

bool ThreadExecutor::serves(const Scheduler& scheduler) noexcept {
  for (const Service* service = innermost_service; service != nullptr; service = service->outer_) {
    if (service->scheduler_ == &scheduler) return true;
  }
  return false;
}

bool ThreadExecutor::runs_for(const Scheduler& scheduler) noexcept {
  for (const Service* service = innermost_service; service != nullptr; service = service->outer_) {
    if (service->scheduler_ == &scheduler && service->role_ == Role::worker) return true;
  }
  return false;
}

ThreadExecutor::ThreadExecutor(const WorkerOptions& options)
    : threads_(options.lent_arena ? 0
                                  : (options.threads == 0 ? std::max(1, available_threads() - 1) : options.threads)),
      priority_(options.thread_priority),
      name_(options.name),
      lent_arena_(options.lent_arena),
      numbers_(static_cast<std::size_t>(threads_)) {
  if (threads_ > 0) {
    arena_ = std::make_unique<tbb::task_arena>(threads_, static_cast<unsigned>(threads_));
    arena_->initialize();
  }
  parked_.reserve(static_cast<std::size_t>(threads_));
}

ThreadExecutor::~ThreadExecutor() = default;

void ThreadExecutor::set_up_thread(const char* suffix) const noexcept {
  // What is cut is the name, not what tells the threads apart.
  const int room = static_cast<int>(kMostNameCharacters - std::strlen(suffix) - 1);
  char name[kMostNameCharacters + 1] = {};
  std::snprintf(name, sizeof name, "%.*s %s", room, name_.c_str(), suffix);
  name_current_thread(name);
  rank_current_thread(priority_);
}

void ThreadExecutor::start(const std::shared_ptr<Scheduler>& scheduler) {
  if (!lent() && priority_ != ThreadPriority::normal) make_pool_threads();
  const std::lock_guard lock(threads_mutex_);
  own_threads_.reserve(static_cast<std::size_t>(threads_) + 1);
  for (int number = 0; number < threads_; ++number) {
    own_threads_.emplace_back([this, scheduler, number] { serve(*scheduler, number); });
  }
  own_threads_.emplace_back([this, scheduler] {
    set_up_thread("watch");
    scheduler->watch();
  });
}

void ThreadExecutor::serve(Scheduler& scheduler, int number) {
  char suffix[8] = {};
  std::snprintf(suffix, sizeof suffix, "%d", number);
  set_up_thread(suffix);
  numbers_[static_cast<std::size_t>(number)] = current_thread_number();
  const auto work = [&] {
    const Service service(scheduler);
    for (;;) {
      if (scheduler.run_next()) continue;
      {
        const std::lock_guard lock(mutex_);
        if (dismissed_) return;
      }
      park(scheduler);
    }
  };
  for (;;) {
    try {
      return arena_->execute(work);
    } catch (const std::bad_alloc&) {
      // oneTBB had no memory to enter the arena or to park with; others may give some back.
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

void ThreadExecutor::park(const Scheduler& scheduler) {
  Parking parking;
  parking.blocker = parking.group.defer([] {});
  {
    const std::lock_guard lock(mutex_);
    if (dismissed_) return;
    parked_.push_back(&parking);
  }
  // What came after this thread looked for work, but before it could be seen to be free.
  if (scheduler.has_waiting()) {
    tbb::task_handle blocker;
    const std::lock_guard lock(mutex_);
    if (std::erase(parked_, &parking) > 0) blocker = std::move(parking.blocker);
  }
  parking.group.wait();
}

bool ThreadExecutor::call_one(const std::shared_ptr<Scheduler>& scheduler) {
  if (lent()) {
    try {
      lent_arena_([scheduler] {
        const Service service(*scheduler);
        scheduler->run_next();
      });
    } catch (...) {
      // The job stays where it is; the watching thread will see to it.
      return false;
    }
    return true;
  }
  // Taken out of the parking place before it goes: that is the waiting thread's, and gone as soon as the wait ends.
  tbb::task_handle blocker;
  const std::lock_guard lock(mutex_);
  if (parked_.empty()) return false;
  blocker = std::move(parked_.back()->blocker);
  parked_.pop_back();
  return true;
}

void ThreadExecutor::call_all() {
  for (;;) {
    tbb::task_handle blocker;
    const std::lock_guard lock(mutex_);
    if (parked_.empty()) return;
    blocker = std::move(parked_.back()->blocker);
    parked_.pop_back();
  }
}

void ThreadExecutor::rescue(const std::shared_ptr<Scheduler>& scheduler) {
  const std::lock_guard lock(threads_mutex_);
  if (leaving_) return;
  rescuers_.remove_if([](Rescuer& rescuer) {
    if (!rescuer.finished) return false;
    rescuer.thread.join();
    return true;
  });
  Rescuer& rescuer = rescuers_.emplace_back();
  try {
    rescuer.thread = std::thread([this, scheduler, &rescuer] {
      set_up_thread("rescue");
      try {
        tbb::task_arena(1).execute([&] {
          const Service service(*scheduler);
          scheduler->run_next();
        });
      } catch (const std::bad_alloc&) {
        // oneTBB had no memory for the arena; the job still waits, and the watch goes on.
      }
      rescuer.finished = true;
    });
  } catch (...) {
    rescuers_.pop_back();
    throw;
  }
}

bool ThreadExecutor::all_asleep() const {
  return std::all_of(numbers_.begin(), numbers_.end(),
                     [](const std::atomic<long>& number) { return number != 0 && asleep(number); });
}

void ThreadExecutor::dismiss() {
  {
    const std::lock_guard lock(mutex_);
    dismissed_ = true;
  }
  {
    const std::lock_guard lock(threads_mutex_);
    leaving_ = true;
  }
  call_all();
}

void ThreadExecutor::join() {
  // No thread is added any more, so the lists need no guard; but only one may join, and all wait for that.
  const std::lock_guard lock(join_mutex_);
  for (std::thread& thread : own_threads_) {
    if (thread.joinable()) thread.join();
  }
  for (Rescuer& rescuer : rescuers_) {
    if (rescuer.thread.joinable()) rescuer.thread.join();
  }
}

void ThreadExecutor::detach() {
  const std::lock_guard lock(join_mutex_);
  for (std::thread& thread : own_threads_) {
    if (thread.joinable()) thread.detach();
  }
  for (Rescuer& rescuer : rescuers_) {
    if (rescuer.thread.joinable()) rescuer.thread.detach();
  }
}

}  // namespace welkin::detail
