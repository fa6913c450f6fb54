#include "platform/thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace welkin::detail {

void name_current_thread(const char* name) noexcept { pthread_setname_np(pthread_self(), name); }

void rank_current_thread(ThreadPriority priority) noexcept {
  constexpr int kNicer = 10;
  constexpr int kNicest = 19;
  const sched_param none{};
  if (priority == ThreadPriority::normal) return;
  if (priority == ThreadPriority::idle && pthread_setschedparam(pthread_self(), SCHED_IDLE, &none) == 0) return;
  // A thread made by a real-time one is one too, and has no nice value.
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_OTHER, &none));
  // On Linux a thread has a nice value of its own, its maker's at first, and its number stands for a process's here.
  const auto thread = static_cast<id_t>(::syscall(SYS_gettid));
  static_cast<void>(setpriority(PRIO_PROCESS, thread, std::min(kNicest, getpriority(PRIO_PROCESS, thread) + kNicer)));
}

}  // namespace welkin::detail
