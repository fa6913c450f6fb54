// Whether any thread of the process is at work for us, or waits for work: a fork of the process has the locks of such
// threads, and not the threads.
#pragma once

#include <atomic>

namespace welkin::jobs {

/// How many `ActivityScope`s there are; in a fork, how many there were when it was made.
inline std::atomic<int> activities{0};

/// While one lives, a thread may hold locks of ours and of oneTBB's, or be in oneTBB's list of sleeping threads.
class ActivityScope {
 public:
  ActivityScope() noexcept { ++activities; }
  ~ActivityScope() { --activities; }
  ActivityScope(const ActivityScope&) = delete;
  ActivityScope& operator=(const ActivityScope&) = delete;
};

}  // namespace welkin::jobs
