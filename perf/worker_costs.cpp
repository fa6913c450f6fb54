#include "worker_costs.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "samples.h"
#include "worker_subjects.h"

namespace welkin::perf {
namespace {

constexpr int kCounts[] = {1, 16, 256};
constexpr int kCalls = 8192;  // at least, in one benchmark

/// Of `count` calls that took `time` together.
void add_each(benchmark::State& state, Samples& samples, Clock::duration time, std::size_t count) {
  const auto each = time / static_cast<Clock::rep>(count);
  samples.add(each);
  state.SetIterationTime(seconds(each));
}

void report_each(benchmark::State& state, const Samples& samples) {
  state.counters["ns_each"] = 1e3 * samples.microseconds(0.5);
}

void drain(benchmark::State& state, int count) {
  Worker worker(worker_options(1));
  const auto finished = static_cast<std::size_t>(count);
  Samples samples;
  for (auto _ : state) {
    for (int i = 0; i < count; ++i) worker.post(Nothing{}).on_drain([](const Job<void>&) {});
    while (worker.load().undrained < finished) std::this_thread::yield();
    const Clock::time_point start = Clock::now();
    const std::size_t drained = worker.drain();
    add_each(state, samples, Clock::now() - start, finished);
    if (drained != finished) state.SkipWithError("not all callbacks were called");
  }
  report_each(state, samples);
}

/// A worker whose one thread is busy, and jobs that wait for it.
template <class Request>
class Queue {
 public:
  Queue() : worker_(worker_options(1)) {}

  /// Posts the requests, and returns how long that took.
  Clock::duration post(const std::vector<Request>& requests) {
    released_.store(false, std::memory_order_release);
    busy_ = worker_.post(BusyUntil{&released_});
    while (worker_.load().running == 0) std::this_thread::yield();
    jobs_.reserve(requests.size());
    std::vector<Request> copies = requests;
    const Clock::time_point start = Clock::now();
    for (Request& request : copies) jobs_.push_back(worker_.post(std::move(request)));
    return Clock::now() - start;
  }

  /// Cancels them, the oldest first, and returns how long that took.
  Clock::duration cancel() {
    const Clock::time_point start = Clock::now();
    for (const auto& job : jobs_) benchmark::DoNotOptimize(job.cancel());
    const Clock::duration time = Clock::now() - start;
    jobs_.clear();
    released_.store(true, std::memory_order_release);
    busy_.get();
    return time;
  }

 private:
  std::atomic<bool> released_{false};
  Worker worker_;
  Job<void> busy_;
  std::vector<Job<detail::ResultOf<Request>>> jobs_;
};

template <class Request>
void post(benchmark::State& state, const std::vector<Request>& requests) {
  Queue<Request> queue;
  Samples samples;
  for (auto _ : state) {
    add_each(state, samples, queue.post(requests), requests.size());
    static_cast<void>(queue.cancel());
  }
  report_each(state, samples);
}

void cancel_waiting(benchmark::State& state, int count) {
  Queue<Nothing> queue;
  const std::vector<Nothing> requests(static_cast<std::size_t>(count));
  Samples samples;
  for (auto _ : state) {
    static_cast<void>(queue.post(requests));
    add_each(state, samples, queue.cancel(), requests.size());
  }
  report_each(state, samples);
}

void post_to_asleep(benchmark::State& state) {
  Worker worker(worker_options(1));
  Samples samples;
  for (auto _ : state) {
    stay_busy(std::chrono::milliseconds(2));
    const Clock::time_point start = Clock::now();
    Job<void> job = worker.post(Nothing{});
    add_each(state, samples, Clock::now() - start, 1);
    job.get();
  }
  report_each(state, samples);
}

/// Two threads a processor, of normal priority, that rest for one millisecond of twenty, all at the same time. Threads
/// of the idle class run then, and are put aside in the middle of what they do.
class BusyProcessors {
 public:
  BusyProcessors() {
    for (int k = 0; k < 2 * available_threads(); ++k) threads_.emplace_back([this] { work(); });
  }
  ~BusyProcessors() {
    released_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  BusyProcessors(const BusyProcessors&) = delete;
  BusyProcessors& operator=(const BusyProcessors&) = delete;

 private:
  void work() {
    constexpr std::chrono::milliseconds kRest{1};
    while (!released_.load(std::memory_order_relaxed)) {
      const bool rests = Clock::now().time_since_epoch() % std::chrono::milliseconds(20) < kRest;
      if (rests) std::this_thread::sleep_for(kRest);
    }
  }

  std::atomic<bool> released_{false};
  std::vector<std::thread> threads_;
};

/// A request that posts itself again: its thread is always about to start a job or to end one.
struct Again {
  Worker* worker;

  void operator()(const Control& control) const {
    if (!control.stop.stop_requested()) worker->post(Again{worker}, {.priority = TaskPriority::low});
  }
};

/// A post takes what the system gives this thread of a processor, but nothing of what it gives those of the worker,
/// which it may keep from running for seconds, wherever they are: also inside the system's allocator.
void post_beside_busy_processors(benchmark::State& state) {
  WorkerOptions options = worker_options(1);
  options.thread_priority = ThreadPriority::idle;
  Worker worker(options);
  worker.post(Again{&worker});
  const BusyProcessors busy;
  Samples samples;
  for (auto _ : state) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    const Clock::time_point start = Clock::now();
    worker.post(Nothing{}, {.key = "sky"});  // the waiting one of before is replaced
    const Clock::duration time = Clock::now() - start;
    samples.add(time);
    state.SetIterationTime(seconds(time));
  }
  samples.report(state);
}

std::vector<ProjectCubemap> different_cubemaps(int count) {
  std::vector<ProjectCubemap> requests;
  for (int number = 0; number < count; ++number) requests.push_back({numbered_source(64, number)});
  return requests;
}

}  // namespace

void add_worker_costs() {
  const auto add = [](const std::string& name, int times, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime()->Iterations(times);
  };
  for (const int count : kCounts) {
    const std::string number = std::to_string(count);
    const int times = std::clamp(kCalls / count, 32, 1024);
    add("Drain/callback/" + number + "/1", times, [=](benchmark::State& state) { drain(state, count); });
    add("Post/in-a-row-" + number + "/empty/1", times,
        [=](benchmark::State& state) { post(state, std::vector<Nothing>(static_cast<std::size_t>(count))); });
    add("Post/in-a-row-" + number + "/cubemap/1", times,
        [=](benchmark::State& state) { post(state, different_cubemaps(count)); });
    add("CancelWaiting/in-a-row-" + number + "/empty/1", times,
        [=](benchmark::State& state) { cancel_waiting(state, count); });
  }
  add("Post/to-asleep/empty/1", 500, post_to_asleep);
  add("Post/beside-busy-processors/empty-idle-priority/1", 20'000, post_beside_busy_processors);
}

}  // namespace welkin::perf
