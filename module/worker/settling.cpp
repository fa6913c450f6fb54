// Cancelling jobs, what follows when they are done, and where their memory goes.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>

#include "jobs/control.h"
#include "platform/compiler.h"
#include "worker/scheduler.h"
#include "worker/thread_executor.h"

namespace welkin::detail {
namespace {

const char* what_happened(ErrorCode reason) noexcept {
  switch (reason) {
    case ErrorCode::cancelled: return jobs::kCancelled;
    case ErrorCode::replaced: return "a newer request with the same key took its place";
    case ErrorCode::queue_full: return "the worker is at its limit of jobs or bytes in flight (WorkerOptions)";
    case ErrorCode::stopped: return "the worker was terminated";
    case ErrorCode::limit_exceeded: return "the request alone takes more than the worker's max_bytes (WorkerOptions)";
    default: return "given up";
  }
}

/// Why a job that is ready has no result, or that there was no memory to say it; null if it has one. Who gives jobs up
/// by the hundred does not make errors that nobody may want: they are made here.
std::exception_ptr error_of(const JobRecord& job) noexcept {
  if (!job.withdrawn) return job.error;
  try {
    const std::string key = job.key.empty() ? "" : " (" + std::string(job.key) + ")";
    return std::make_exception_ptr(
        Error(*job.withdrawn, "job " + std::to_string(job.id) + key + ": " + what_happened(*job.withdrawn)));
  } catch (...) {
    return std::current_exception();
  }
}

}  // namespace

bool Scheduler::withdraw(std::shared_ptr<JobRecord> job, ErrorCode reason, DeferredWork& work) {
  if (job->settled || job->withdrawn) return false;
  // A continuation that has not started cancels the job that it follows, which nobody else hears of.
  while (job && !job->settled && !job->withdrawn) {
    job->withdrawn = reason;
    const std::shared_ptr<Computation> computation = job->computation;
    std::shared_ptr<JobRecord> next;
    if (computation->list == &running_) {
      stop(computation, work);
    } else {
      next = computation->parent;
      settle(*job);
      work.ended.splice(work.ended.end(), take_out(computation));
    }
    job = next;
  }
  return true;
}

void Scheduler::stop(const std::shared_ptr<Computation>& computation, DeferredWork& work) {
  computation->stopping = true;
  computation->next_to_stop = std::move(work.stopping);
  work.stopping = computation;
}

/// The job is ready.
void Scheduler::hand_on(JobRecord& job, DeferredWork& work) {
  job.done = true;
  news_ = true;
  hand_on(job, job.followers, work);
}

void Scheduler::hand_on(const JobRecord& job, ComputationList& followers, DeferredWork& work) {
  while (!followers.empty()) {
    const std::shared_ptr<Computation> next = followers.front();
    ComputationList node;
    node.splice(node.begin(), followers, followers.begin());
    next->parent = nullptr;
    next->list = nullptr;
    next->failure = error_of(job);
    if (next->where == Place::at_once) {
      work.at_once.splice(work.at_once.end(), node);
    } else if (next->where == Place::drain) {
      ComputationList& list = abandoned_ ? work.ended : drained_;
      list.splice(list.end(), node);
      undrained_.store(drained_.size(), std::memory_order_release);
    } else {
      enqueue(next, node, true);
      if (closed_) {
        end(next, nullptr, work);
      } else {
        ++work.startable;
      }
    }
  }
}

/// Of a computation that waits, and that no thread will start: because of the error, or as the worker has ended.
void Scheduler::end(const std::shared_ptr<Computation>& computation, std::exception_ptr error, DeferredWork& work) {
  if (JobRecord* const job = computation->record.get()) {
    job->error = error;
    if (!error) job->withdrawn = ErrorCode::stopped;
    settle(*job);
  }
  work.ended.splice(work.ended.end(), take_out(computation));
}

/// Makes the jobs of computations that will not start ready. `hand_on` adds to the list: a chain of followers may be
/// long, and none ends inside the end of the one that it follows.
void Scheduler::tell_jobs_of(DeferredWork& work) {
  for (const std::shared_ptr<Computation>& computation : work.ended) {
    if (!computation->record) continue;
    computation->record->ready.store(true, std::memory_order_release);
    hand_on(*computation->record, work);
  }
}

/// Without the mutex. All jobs have got their errors before any coroutine goes on, because it may wait for one of them.
void Scheduler::carry_out(DeferredWork& work) {
  // Code of the user's may throw out of a coroutine, a destructor or a stop callback, and there is nobody to throw to,
  // as on a thread of the worker.
  const auto go_on = [](const auto& call) {
    try {
      call();
    } catch (...) {  // NOLINT(bugprone-empty-catch)
    }
  };
  if (work.news) signal();
  call_for_hands(work);
  while (work.stopping) {
    // Whatever the request hung on its stop token runs here, and could not wait for the request's end.
    const ThreadRole role(*this, ThreadRole::bystander);
    const std::shared_ptr<Computation> computation = std::move(work.stopping);
    work.stopping = std::move(computation->next_to_stop);
    computation->stop.request_stop();
  }
  for (const std::shared_ptr<Computation>& computation : work.at_once) {
    try {
      computation->run({});
    } catch (...) {
      computation->failure = std::current_exception();
      go_on([&] { computation->run({}); });
    }
  }
  for (const std::shared_ptr<Computation>& computation : work.ended) computation->release();
  for (const std::shared_ptr<Computation>& computation : work.ended) go_on([&] { computation->abandon(); });
  for (const std::shared_ptr<Computation>& computation : work.ended) computation->record = nullptr;
  work = {};
}

bool Scheduler::cancel(const std::shared_ptr<JobRecord>& job) {
  if (is_forked()) return false;  // destructors call this
  Books books(*this);
  return withdraw(job, ErrorCode::cancelled, books.work);
}

bool Scheduler::attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
                       const std::shared_ptr<JobRecord>& job) {
  require_own_process();
  if (job) {
    job->scheduler = parent->scheduler;
    job->id = next_id();
  }
  auto arrival = std::make_unique<Arrival>(child, job, parent);
  if (!closed_) {
    put_in_inbox(std::move(arrival));
    return true;
  }
  Books books(*this);
  const bool too_late = parent->done && (child->where == Place::drain ? abandoned_ : child->where == Place::worker);
  if (too_late && !job) return false;
  follow(*arrival, books.work);
  return !too_late;
}

void Scheduler::follow(Arrival& arrival, DeferredWork& work) {
  const std::shared_ptr<Computation> child = arrival.node.front();
  child->priority = arrival.parent->computation->priority;
  child->record = arrival.job;
  if (arrival.parent->done) return hand_on(*arrival.parent, arrival.node, work);
  hang(arrival.node, arrival.parent);
}

/// On a job that is not done.
void Scheduler::hang(ComputationList& node, const std::shared_ptr<JobRecord>& parent) {
  Computation& child = *node.front();
  child.parent = parent;
  child.list = &parent->followers;
  child.place = node.begin();
  parent->followers.splice(parent->followers.end(), node);
}

std::size_t Scheduler::drain(std::chrono::nanoseconds budget) {
  constexpr std::chrono::microseconds kPause{20};
  constexpr std::chrono::nanoseconds kLeast = std::chrono::microseconds(100);
  require_own_process();
  const auto start = Clock::now();
  const auto spent = [&](std::chrono::nanoseconds allowed) { return Clock::now() - start >= allowed; };
  std::size_t there = 0;
  for (std::size_t called = 0;; ++called) {
    // Without the mutex: most frames have nothing to drain.
    const bool nothing = undrained_.load(std::memory_order_acquire) == 0 && inbox_.load() == nullptr;
    if (nothing || (called > 0 && (called >= there || spent(budget)))) return called;
    ComputationList one;
    {
      // The mutex may be held by a thread of ours that more important ones keep off the processor: the budget is for
      // that too. Sleeping, and not spinning, gives it this one. A thread that merely looks for work lets go of the
      // mutex in less than `kLeast`, and then the first callback runs whatever the budget is.
      Lock lock(mutex_, std::try_to_lock);
      while (!lock) {
        if (spent(called == 0 ? std::max(budget, kLeast) : budget)) return called;
        std::this_thread::sleep_for(kPause);
        static_cast<void>(lock.try_lock());
      }
      const Books books(*this, std::move(lock));
      if (called == 0) there = drained_.size();
      if (drained_.empty()) return called;
      one.splice(one.begin(), drained_, drained_.begin());
      undrained_.store(drained_.size(), std::memory_order_release);
    }
    one.front()->run({});
  }
}

void Scheduler::terminate() {
  if (is_forked()) {
    kept_ = shared_from_this();
    return;
  }
  {
    Books books(*this);
    closed_ = true;
    for (ComputationList& list : waiting_) {
      while (!list.empty()) end(std::shared_ptr<Computation>(list.front()), nullptr, books.work);
    }
    for (const std::shared_ptr<Computation>& computation : running_) {
      JobRecord* const job = computation->record.get();
      if (job == nullptr || job->settled || computation->stopping) continue;
      job->withdrawn = ErrorCode::stopped;
      stop(computation, books.work);
    }
  }
  if (own_threads_) own_threads_->dismiss();
  if (ThreadRole::has_any(*this)) return;
  wait_for([&] {
    const Books books(*this);
    return running_.empty() && lending_ == 0;
  });
  if (own_threads_) own_threads_->join();
  std::shared_ptr<Executor> no_more_used;
  const Books books(*this);
  no_more_used.swap(options_.executor);
}

void Scheduler::abandon_rest() {
  if (is_forked()) return;
  {
    Books books(*this);
    abandoned_ = true;
    books.work.ended.splice(books.work.ended.end(), drained_);
    undrained_.store(0, std::memory_order_release);
  }
  if (own_threads_ && ThreadRole::has_any(*this)) own_threads_->detach();
}

}  // namespace welkin::detail

namespace welkin {

using detail::error_of;

std::optional<JobError> JobHandle::error() const {
  if (!ready() || !record_->failed()) return std::nullopt;
  try {
    std::rethrow_exception(error_of(*record_));
  } catch (const Error& error) {
    return JobError{error.code(), error.what()};
  } catch (const std::exception& exception) {
    return JobError{std::nullopt, exception.what()};
  } catch (...) {
    return JobError{std::nullopt, "an exception that is no std::exception"};
  }
}

bool JobHandle::cancel() const { return record_ && record_->scheduler->cancel(record_); }

TaskPriority JobHandle::priority() const {
  return record_ ? record_->scheduler->priority_of(*record_) : TaskPriority::normal;
}

void JobHandle::set_priority(TaskPriority priority) const {
  if (record_) record_->scheduler->set_priority(*record_, priority);
}

namespace detail {

bool attach(const std::shared_ptr<JobRecord>& parent, const std::shared_ptr<Computation>& child,
            const std::shared_ptr<JobRecord>& job) {
  return parent->scheduler->attach(parent, child, job);
}

void wait(const std::shared_ptr<JobRecord>& job) { job->scheduler->wait(*job); }

void wait_for(const std::shared_ptr<JobRecord>& job, std::chrono::nanoseconds time) {
  using std::chrono::nanoseconds;
  constexpr std::chrono::microseconds kShortest{20};
  constexpr std::chrono::milliseconds kLongest{1};
  const auto start = Scheduler::Clock::now();
  for (nanoseconds spent{0}; spent < time && !job->ready.load(std::memory_order_acquire);
       spent = Scheduler::Clock::now() - start) {
    const nanoseconds pause = std::clamp<nanoseconds>(spent / 8, kShortest, kLongest);
    std::this_thread::sleep_for(std::min(pause, time - spent));
  }
}

void throw_error_of(const JobRecord& job) {
  if (job.failed()) std::rethrow_exception(error_of(job));
}

void throw_taken() {
  throw Error(ErrorCode::invalid_argument, "the job's result was taken before, or there is no job");
}

// Memory of jobs.

namespace {

constexpr std::size_t kSmallestBlock = 64;
constexpr std::size_t kLargestBlock = WELKIN_ADDRESS_SANITIZER ? 0 : 4096;

struct FreeBlock {
  FreeBlock* next;
};

/// A stack of blocks of one size that are not in use. No thread waits for another one here: whoever takes a block takes
/// the whole stack and puts the rest back, and who finds nothing meanwhile asks the system.
class FreeBlocks {
 public:
  void* take() noexcept {
    FreeBlock* const first = top_.exchange(nullptr, std::memory_order_acquire);
    if (first == nullptr) return nullptr;
    kept_.fetch_sub(1, std::memory_order_relaxed);
    FreeBlock* rest = first->next;
    FreeBlock* surplus = nullptr;  // of takers that met each other, and each made a block
    if (rest != nullptr && kept_.load(std::memory_order_relaxed) > kMostKept) {
      surplus = std::exchange(rest, rest->next);
      kept_.fetch_sub(1, std::memory_order_relaxed);
    }
    if (rest != nullptr) put_back(rest);
    ::operator delete(surplus);
    return first;
  }

  void put(FreeBlock* block) noexcept {
    kept_.fetch_add(1, std::memory_order_relaxed);
    block->next = top_.load(std::memory_order_relaxed);
    while (!top_.compare_exchange_weak(block->next, block, std::memory_order_release, std::memory_order_relaxed)) {
    }
  }

  void give_back() noexcept {
    FreeBlock* block = top_.exchange(nullptr, std::memory_order_acquire);
    while (block != nullptr) {
      ::operator delete(std::exchange(block, block->next));
      kept_.fetch_sub(1, std::memory_order_relaxed);
    }
  }

 private:
  /// Twice as many as the jobs that a worker takes by default. What is above goes back to the system, block by block,
  /// where one is taken: by threads that post, so that a worker's thread does not free what they allocated.
  static constexpr std::ptrdiff_t kMostKept = 8192;

  /// All the stack, which others have found empty since. What they have put there goes on top, as it is the shorter
  /// list.
  void put_back(FreeBlock* rest) noexcept {
    for (FreeBlock* none = nullptr; !top_.compare_exchange_strong(none, rest); none = nullptr) {
      FreeBlock* const newer = top_.exchange(nullptr);
      if (newer == nullptr) continue;
      FreeBlock* last = newer;
      while (last->next != nullptr) last = last->next;
      last->next = std::exchange(rest, newer);
    }
  }

  std::atomic<FreeBlock*> top_{nullptr};
  std::atomic<std::ptrdiff_t> kept_{0};  ///< in the stack, and below that while blocks are on their way
};

constexpr std::size_t size_class(std::size_t bytes) {
  return bytes <= kSmallestBlock ? 0 : std::bit_width((bytes - 1) / kSmallestBlock);
}

constinit std::array<FreeBlocks, size_class(kLargestBlock) + 1> free_blocks;  ///< of 64 bytes, of 128, and so on

}  // namespace

void* allocate_job_memory(std::size_t bytes) {
  if (bytes > kLargestBlock) return ::operator new(bytes);
  const std::size_t index = size_class(bytes);
  void* const block = free_blocks[index].take();
  return block != nullptr ? block : ::operator new(kSmallestBlock << index);
}

void free_job_memory(void* block, std::size_t bytes) noexcept {
  if (bytes > kLargestBlock) return ::operator delete(block);
  free_blocks[size_class(bytes)].put(::new (block) FreeBlock{nullptr});
}

void give_back_job_memory() noexcept {
  for (FreeBlocks& blocks : free_blocks) blocks.give_back();
}

}  // namespace detail
}  // namespace welkin
