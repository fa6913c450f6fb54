#include "worker_throughput.h"

#include <benchmark/benchmark.h>

#include <barrier>
#include <cstddef>
#include <string>
#include <thread>

#include "subjects.h"
#include "welkin/projection.h"
#include "worker_subjects.h"

namespace welkin::perf {
namespace {

constexpr int kSize = 64;

void report_jobs(benchmark::State& state) {
  state.counters["jobs/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// Collects the older half of what is in flight when all of it is ready, and posts as many again: the worker never runs
/// out of work, and the caller is woken once a half.
void keep_in_flight(benchmark::State& state, int count, int threads) {
  Worker worker(worker_options(threads));
  std::vector<ProjectCubemap> requests;
  std::vector<Job<Projection>> jobs;
  for (int number = 0; number < count; ++number) {
    requests.push_back({numbered_source(kSize, number)});
    jobs.push_back(worker.post(requests.back()));
  }
  const std::size_t half = (jobs.size() + 1) / 2;
  std::size_t oldest = 0;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(half))) {
    for (std::size_t i = half; i-- > 0;) benchmark::DoNotOptimize(jobs[(oldest + i) % jobs.size()].get());
    for (std::size_t i = 0; i < half; ++i) {
      jobs[oldest] = worker.post(requests[oldest]);
      oldest = (oldest + 1) % jobs.size();
    }
  }
  report_jobs(state);
}

void one_after_another(benchmark::State& state, int threads) {
  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, kSize);
  run_with_threads(threads, [&] {
    for (auto _ : state) benchmark::DoNotOptimize(project(view));
  });
  report_jobs(state);
}

void side_by_side(benchmark::State& state, int threads) {
  constexpr int calls = 256;  // a thread, between two meetings
  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, kSize);
  std::barrier meeting(threads + 1);
  bool ended = false;
  std::vector<std::jthread> callers;
  for (int thread = 0; thread < threads; ++thread) {
    callers.emplace_back([&] {
      for (meeting.arrive_and_wait(); !ended; meeting.arrive_and_wait()) {
        for (int call = 0; call < calls; ++call) benchmark::DoNotOptimize(project(view));
        meeting.arrive_and_wait();
      }
    });
  }
  while (state.KeepRunningBatch(benchmark::IterationCount{calls} * threads)) {
    meeting.arrive_and_wait();
    meeting.arrive_and_wait();
  }
  ended = true;
  meeting.arrive_and_wait();
  report_jobs(state);
}

}  // namespace

void add_worker_throughput(const std::vector<int>& thread_counts) {
  const auto add = [](const std::string& how, int threads, auto run) {
    const std::string name = "JobThroughput/" + how + "/" + std::to_string(kSize) + "/" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(), run)->UseRealTime();
  };
  for (const int threads : thread_counts) {
    add("one-after-another", threads, [=](benchmark::State& state) { one_after_another(state, threads); });
    add("side-by-side", threads, [=](benchmark::State& state) { side_by_side(state, threads); });
    for (const int count : {1, 16, 256}) {
      add("in-flight-" + std::to_string(count), threads,
          [=](benchmark::State& state) { keep_in_flight(state, count, threads); });
    }
  }
}

}  // namespace welkin::perf
