#include <benchmark/benchmark.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks.h"
#include "subjects.h"
#include "welkin/projection.h"
#include "worker_subjects.h"

namespace welkin::perf {
namespace {

using std::chrono::milliseconds;

struct ReadClock {
  Clock::time_point operator()(const Control& /*control*/) const { return Clock::now(); }
};

void post_to_start(benchmark::State& state, const WorkerOptions& options, milliseconds pause) {
  Worker worker(options);
  (void)worker.post(ReadClock{}).get();
  Samples latency;
  for (auto _ : state) {
    if (pause.count() > 0) stay_busy(pause);
    const Clock::time_point posted = Clock::now();
    const Clock::time_point started = worker.post(ReadClock{}).get();
    latency.add(started - posted);
    state.SetIterationTime(seconds(started - posted));
  }
  latency.report(state);
}

void add_post_to_start(int threads) {
  struct Variant {
    const char* name;
    ThreadPriority priority;
    milliseconds pause;
    int times;
  };
  constexpr Variant variants[] = {{"warm", ThreadPriority::normal, milliseconds(0), 20'000},
                                  {"asleep-2ms", ThreadPriority::normal, milliseconds(2), 500},
                                  {"asleep-20ms", ThreadPriority::normal, milliseconds(20), 100},
                                  {"asleep-2ms-idle-priority", ThreadPriority::idle, milliseconds(2), 500}};
  for (const Variant& variant : variants) {
    WorkerOptions options = worker_options(threads);
    options.thread_priority = variant.priority;
    const std::string name = std::string("PostToStart/") + variant.name + "/empty/" + std::to_string(threads);
    benchmark::RegisterBenchmark(
        name.c_str(), [=, pause = variant.pause](benchmark::State& state) { post_to_start(state, options, pause); })
        ->UseManualTime()
        ->Iterations(variant.times);
  }
}

/// Project, and when it began and ended.
struct TimedProjection {
  struct Moments {
    Clock::time_point started;
    Clock::time_point ended;
  };

  Project request;
  Moments* moments;

  Projection operator()(const Control& control) const {
    moments->started = Clock::now();
    Projection projection = request(control);
    moments->ended = Clock::now();
    return projection;
  }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return request.bytes(); }
};

enum class Waiting { future, polling };

class ResultLatency {
 public:
  ResultLatency(int size, int threads, Waiting waiting, milliseconds pause)
      : view_(noise_cubemap(PixelFormat::rgb32f, size)),
        request_{{EnvironmentSource(view_, nullptr)}, &moments_},
        threads_(threads),
        waiting_(waiting),
        pause_(pause),
        worker_(worker_options(threads)) {}

  /// Some calls the one way, then as many the other, so that neither finds the other's threads still spinning: the
  /// first two do not count.
  Clock::duration measure(int times) {
    run_with_threads(threads_, [&] {
      for (int i = -2; i < times; ++i) call(i >= 0);
    });
    Clock::duration sum{};
    for (int i = -2; i < times; ++i) {
      const Clock::duration time = post(i >= 0);
      if (i >= 0) sum += time;
    }
    return sum / times;
  }

  void report(benchmark::State& state) const {
    posted_.report(state);
    state.counters["sync_us"] = synchronous_.microseconds(0.5);
    state.counters["overhead_us"] = posted_.microseconds(0.5) - synchronous_.microseconds(0.5);
    state.counters["fastest_overhead_us"] = posted_.microseconds(0.0) - synchronous_.microseconds(0.0);
    state.counters["outside_us"] = outside_.microseconds(0.5);
    state.counters["to_start_us"] = to_start_.microseconds(0.5);
    state.counters["to_caller_us"] = to_caller_.microseconds(0.5);
  }

 private:
  void call(bool counts) {
    if (pause_.count() > 0) stay_busy(pause_);
    const Clock::time_point start = Clock::now();
    benchmark::DoNotOptimize(project(view_));
    if (counts) synchronous_.add(Clock::now() - start);
  }

  Clock::duration post(bool counts) {
    if (pause_.count() > 0) stay_busy(pause_);
    const Clock::time_point posted = Clock::now();
    Job<Projection> job = worker_.post(request_);
    while (waiting_ == Waiting::polling && !job.ready()) std::this_thread::yield();
    benchmark::DoNotOptimize(job.get());
    const Clock::time_point ended = Clock::now();
    if (counts) {
      posted_.add(ended - posted);
      to_start_.add(moments_.started - posted);
      to_caller_.add(ended - moments_.ended);
      outside_.add((moments_.started - posted) + (ended - moments_.ended));
    }
    return ended - posted;
  }

  CubemapView view_;
  TimedProjection::Moments moments_{};
  TimedProjection request_;
  int threads_;
  Waiting waiting_;
  milliseconds pause_;
  Worker worker_;
  Samples synchronous_;
  Samples posted_;
  Samples to_start_;
  Samples to_caller_;
  Samples outside_;
};

void add_post_to_result(int size, int threads) {
  struct Variant {
    const char* name;
    Waiting waiting;
    milliseconds pause;
    int rounds;
    int times;
  };
  constexpr Variant variants[] = {{"wait", Waiting::future, milliseconds(0), 20, 20},
                                  {"poll", Waiting::polling, milliseconds(0), 20, 20},
                                  {"wait-asleep-2ms", Waiting::future, milliseconds(2), 10, 20}};
  for (const Variant& variant : variants) {
    const std::string name =
        std::string("PostToResult/") + variant.name + "/" + std::to_string(size) + "/" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) {
                                   ResultLatency latency(size, threads, variant.waiting, variant.pause);
                                   for (auto _ : state) state.SetIterationTime(seconds(latency.measure(variant.times)));
                                   latency.report(state);
                                 })
        ->UseManualTime()
        ->Iterations(variant.rounds);
  }
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

}  // namespace

void add_worker_latency(const std::vector<int>& thread_counts) {
  for (const int threads : thread_counts) add_post_to_start(threads);
  for (const int size : {64, 1024}) {
    for (const int threads : thread_counts) add_post_to_result(size, threads);
  }
  benchmark::RegisterBenchmark("Post/beside-busy-processors/empty-idle-priority/1", post_beside_busy_processors)
      ->UseManualTime()
      ->Iterations(20'000);
}

}  // namespace welkin::perf
