#include "worker/scheduler.h"

#include <atomic>
#include <string>
#include <utility>

#include "worker/crew.h"

namespace welkin::detail {
namespace {

constexpr int kMostThreads = 1024;

const WorkerOptions& checked(const WorkerOptions& options) {
  if (options.threads < 0 || options.threads > kMostThreads) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: threads is " + std::to_string(options.threads) +
                                                 "; it must be from 0 to " + std::to_string(kMostThreads));
  }
  if (options.most_jobs == 0) {
    throw Error(ErrorCode::invalid_argument, "WorkerOptions: most_jobs is 0; it must be at least 1");
  }
  return options;
}

}  // namespace

Scheduler::Scheduler(WorkerOptions options)
    : options_(std::move(options)), crew_(std::make_unique<Crew>(checked(options_))) {}

Scheduler::~Scheduler() = default;

void Scheduler::start() { crew_->start(shared_from_this()); }

WorkerLoad Scheduler::load() const {
  const Lock lock(mutex_);
  return {.waiting = waiting_[0].size() + waiting_[1].size() + waiting_[2].size(),
          .running = running_.size(),
          .undrained = drained_.size(),
          .jobs = jobs_,
          .bytes = bytes_};
}

std::uint64_t Scheduler::next_id() noexcept {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

int Scheduler::threads() const noexcept { return crew_->threads(); }

}  // namespace welkin::detail
