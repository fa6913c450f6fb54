#include "tools/batch_schedule.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace welkin::tool {

BatchSchedule::BatchSchedule(std::vector<JobSize> jobs, int threads, std::uint64_t memory)
    : jobs_(std::move(jobs)), threads_(threads), memory_(memory) {
  for (const JobSize& job : jobs_) seconds_left_ += job.seconds;
}

int BatchSchedule::threads_wanted(const JobSize& job) const {
  // Its share of what is left to do, itself included.
  const double share = seconds_left_ > 0.0 ? job.seconds / seconds_left_ : 1.0;
  const auto by_share = static_cast<int>(std::lround(share * threads_));
  // Of jobs like this so many fit side by side.
  const std::uint64_t beside = job.memory > 0 ? std::max<std::uint64_t>(1, memory_ / job.memory) : ~std::uint64_t{0};
  const int by_memory = beside < static_cast<std::uint64_t>(threads_) ? threads_ / static_cast<int>(beside) : 1;
  return std::clamp(std::max(by_share, by_memory), 1, threads_);
}

std::optional<BatchSchedule::Turn> BatchSchedule::next() {
  std::unique_lock lock(mutex_);
  const auto over = [this] { return stopped_ || next_ == jobs_.size(); };
  const auto fits = [this] {
    const bool memory = memory_busy_ <= memory_ && jobs_[next_].memory <= memory_ - memory_busy_;
    return running_ == 0 || (threads_busy_ < threads_ && memory);
  };
  changed_.wait(lock, [&] { return over() || fits(); });
  if (over()) return std::nullopt;
  const JobSize& job = jobs_[next_];
  const Turn turn{next_, std::min(threads_wanted(job), std::max(1, threads_ - threads_busy_))};
  ++next_;
  ++running_;
  threads_busy_ += turn.threads;
  memory_busy_ += job.memory;
  seconds_left_ = std::max(0.0, seconds_left_ - job.seconds);
  lock.unlock();
  changed_.notify_all();  // the next one may fit, too
  return turn;
}

void BatchSchedule::finished(const Turn& turn) {
  {
    const std::scoped_lock lock(mutex_);
    --running_;
    threads_busy_ -= turn.threads;
    memory_busy_ -= jobs_[turn.job].memory;
  }
  changed_.notify_all();
}

void BatchSchedule::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

}  // namespace welkin::tool
