// Noticing that all threads sleep while computations wait.
//
// A request or a continuation may wait on the future of another job. If all of a worker's threads do that, nobody is
// left to run what they wait for; a plain std::future gives no hint of it. So one thread looks, every few milliseconds
// and only while computations wait: if none has started or ended and all threads sleep, it has one run outside the
// arena. Threads that are merely kept off the processor by more important ones do not sleep.
#include <algorithm>
#include <chrono>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "worker/crew.h"
#include "worker/scheduler.h"
#include "worker/system_thread.h"

namespace welkin::detail {
namespace {

// The first look is early: a thread that was called may be kept by another job's task while a free one sleeps on.
constexpr std::chrono::milliseconds kFirstLook{1};
constexpr std::chrono::milliseconds kLook{10};
constexpr int kLooksBeforeRescue = 2;
// A lent arena in which nothing of ours runs may simply be busy: that cannot be told from being stuck.
constexpr int kLooksBeforeRescueFromLent = 10;

}  // namespace

bool Scheduler::nobody_moves() const {
  std::vector<long> threads;
  {
    const Lock lock(mutex_);
    for (const std::shared_ptr<Computation>& computation : running_) threads.push_back(computation->thread);
  }
  return crew_->all_asleep() && std::all_of(threads.begin(), threads.end(), asleep);
}

void Scheduler::watch() {
  Lock lock(mutex_);
  while (!closed_) {
    watch_.wait(lock, [&] { return closed_ || any_waiting(); });
    watching_ = true;
    int still = 0;
    std::chrono::milliseconds pause = kFirstLook;
    while (!closed_ && any_waiting()) {
      const std::uint64_t before = events_;
      const bool runs = !running_.empty();
      watch_.wait_for(lock, std::exchange(pause, kLook), [&] { return closed_; });
      if (closed_) break;
      const bool moved = events_ != before;
      lock.unlock();
      try {
        still = !moved && nobody_moves() ? still + 1 : 0;
        crew_->call_all();
        if (still >= (crew_->lent() && !runs ? kLooksBeforeRescueFromLent : kLooksBeforeRescue)) {
          still = 0;
          crew_->rescue(shared_from_this());
        }
      } catch (const std::bad_alloc&) {
        // The next look may do better.
      } catch (const std::system_error&) {
      }
      lock.lock();
    }
    watching_ = false;
  }
}

}  // namespace welkin::detail
