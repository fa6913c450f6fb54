// Letting jobs in: latest wins, equal ones share a run, limits hold.
#include <utility>

#include "worker/crew.h"
#include "worker/scheduler.h"

namespace welkin::detail {

void Scheduler::submit(const std::shared_ptr<JobRecord>& job, const PostOptions& options, std::uint64_t bytes) {
  const std::shared_ptr<Computation> posted = job->computation;
  job->id = next_id();
  job->key = options.key;
  job->scheduler = shared_from_this();
  job->priority = options.priority;
  posted->priority = options.priority;
  posted->bytes = options.bytes.value_or(bytes);

  // All that may run out of memory comes before the books change.
  Newcomer newcomer{job};
  Aftermath aftermath;
  Admission admission{};
  {
    Lock lock(mutex_);
    try {
      while ((admission = decide(newcomer, aftermath)) == Admission::wait) {
        if (aftermath.losers.empty() && !aftermath.stopping) {
          room_.wait(lock);
        } else {
          lock.unlock();
          carry_out(std::exchange(aftermath, {}));
          lock.lock();
        }
      }
    } catch (...) {
      forget(*job);
      throw;
    }
  }
  carry_out(std::move(aftermath));
  if (admission == Admission::refused) {
    posted->release();
    Leftovers none;  // nobody knows of the job yet
    fail(*job, *job->withdrawn, none);
  } else if (job->computation == posted) {
    call_for_hands();
  } else {
    posted->release();
  }
}

Scheduler::Admission Scheduler::decide(Newcomer& newcomer, Aftermath& aftermath) {
  const std::shared_ptr<JobRecord>& job = newcomer.job;
  const std::uint64_t bytes = job->computation->bytes;
  const auto refuse = [&](ErrorCode reason) {
    forget(*job);
    job->withdrawn = reason;
    job->settled = true;
    return Admission::refused;
  };
  if (closed_) return refuse(ErrorCode::stopped);
  if (job->withdrawn) return refuse(*job->withdrawn);  // a newer job of its key came while it waited for room
  if (bytes > options_.most_bytes) return refuse(ErrorCode::limit_exceeded);

  const std::shared_ptr<Computation> equal = find_equal(newcomer);
  std::shared_ptr<JobRecord> older;
  if (!job->key.empty()) {
    older = newest_.try_emplace(job->key).first->second;
    if (older == job) older = nullptr;
  }

  // What giving up the older job frees at once.
  const bool older_goes =
      older && !older->withdrawn && older->computation->jobs.size() == 1 && is_waiting(*older->computation);
  const std::size_t freed_jobs = older_goes ? 1 : 0;
  const std::uint64_t freed_bytes = older_goes ? older->computation->bytes : 0;
  const std::uint64_t more_bytes = equal ? 0 : bytes;
  if (!fits(freed_jobs, more_bytes, freed_bytes)) {
    switch (options_.when_full) {
      case WhenFull::wait:
        if (Crew::serves(*this)) break;
        if (!job->key.empty()) newest_[job->key] = job;
        if (older) withdraw(older, ErrorCode::replaced, aftermath);
        return Admission::wait;
      case WhenFull::refuse: return refuse(ErrorCode::queue_full);
      case WhenFull::drop_oldest: {
        const std::array<const Computation*, 2> spared{equal.get(), older_goes ? older->computation.get() : nullptr};
        if (!make_room(*job, freed_jobs, more_bytes, freed_bytes, spared, aftermath)) {
          return refuse(ErrorCode::queue_full);
        }
      }
    }
  }
  admit(newcomer, equal, older, aftermath);
  return Admission::admitted;
}

void Scheduler::admit(Newcomer& newcomer, const std::shared_ptr<Computation>& equal,
                      const std::shared_ptr<JobRecord>& older, Aftermath& aftermath) {
  const std::shared_ptr<JobRecord>& job = newcomer.job;
  if (equal) job->computation = equal;
  job->computation->jobs.splice(job->computation->jobs.end(), newcomer.job_node);
  job->counted = true;
  ++jobs_;
  if (equal) {
    if (job->priority > equal->priority) rank(equal, job->priority);
  } else {
    bytes_ += job->computation->bytes;
    enqueue(job->computation, newcomer.node, false);
    if (!newcomer.entry.empty()) {
      job->computation->entry = shareable_.insert(newcomer.entry.extract(newcomer.entry.begin()));
      job->computation->indexed = true;
    }
  }
  if (!job->key.empty()) newest_.find(job->key)->second = job;
  // Last: if it is the older job's run that this one shares, that must not stop.
  if (older) withdraw(older, ErrorCode::replaced, aftermath);
}

std::shared_ptr<Computation> Scheduler::find_equal(const Newcomer& newcomer) const {
  if (newcomer.entry.empty()) return nullptr;
  const auto [hash, computation] = *newcomer.entry.begin();
  const auto [first, last] = shareable_.equal_range(hash);
  for (auto candidate = first; candidate != last; ++candidate) {
    // One that was told to stop gives no result.
    if (candidate->second->jobs.front()->withdrawn) continue;
    if (candidate->second->list == &running_ && !computation->joinable_while_running()) continue;
    if (candidate->second->equals(*computation)) return candidate->second;
  }
  return nullptr;
}

void Scheduler::close(Computation& computation) {
  if (!computation.indexed) return;
  shareable_.erase(computation.entry);
  computation.indexed = false;
}

bool Scheduler::fits(std::size_t freed_jobs, std::uint64_t bytes, std::uint64_t freed_bytes) const noexcept {
  // What is there may be beyond the limits: posts from the worker's own threads are let in.
  const std::uint64_t rest = bytes_ - freed_bytes;
  return jobs_ - freed_jobs < options_.most_jobs && rest <= options_.most_bytes && bytes <= options_.most_bytes - rest;
}

bool Scheduler::make_room(const JobRecord& job, std::size_t freed_jobs, std::uint64_t bytes, std::uint64_t freed_bytes,
                          const std::array<const Computation*, 2>& spared, Aftermath& aftermath) {
  // Of those that may go, in the order in which they would: how many it takes.
  const auto each = [&](auto take) {
    for (int priority = 0; priority <= static_cast<int>(job.priority); ++priority) {
      ComputationList& list = waiting(static_cast<Priority>(priority));
      for (auto place = list.begin(); place != list.end();) {
        const std::shared_ptr<Computation> candidate = *place++;
        const bool counted = !candidate->jobs.empty() && candidate->jobs.front()->counted;
        const bool kept = candidate.get() == spared[0] || candidate.get() == spared[1];
        if (counted && !kept && !take(candidate)) return;
      }
    }
  };
  std::size_t number = 0;
  bool enough = false;
  each([&](const std::shared_ptr<Computation>& candidate) {
    freed_jobs += candidate->jobs.size();
    freed_bytes += candidate->bytes;
    enough = fits(freed_jobs, bytes, freed_bytes);
    ++number;
    return !enough;
  });
  if (!enough) return false;
  each([&](const std::shared_ptr<Computation>& candidate) {
    withdraw_all(candidate, ErrorCode::queue_full, aftermath);
    return --number > 0;
  });
  return true;
}

void Scheduler::forget(const JobRecord& job) {
  const auto entry = newest_.find(job.key);
  if (entry != newest_.end() && (entry->second == nullptr || entry->second.get() == &job)) newest_.erase(entry);
}

void Scheduler::count_out(JobRecord& job) {
  if (job.counted) {
    --jobs_;
    job.counted = false;
  }
  if (!job.key.empty()) forget(job);
  room_.notify_all();
}

}  // namespace welkin::detail
