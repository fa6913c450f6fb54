#include "real_time.h"

#include <pthread.h>
#include <sched.h>

namespace engine_loop {

void RealTime::on_scheduler_entry(bool) {
  sched_param rank{};
  rank.sched_priority = 1;
  if (pthread_setschedparam(pthread_self(), SCHED_RR, &rank) != 0) refused_ = true;
}

void RealTime::on_scheduler_exit(bool) {
  const sched_param none{};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_OTHER, &none));
}

}  // namespace engine_loop
