#include <ImfRgbaFile.h>

#include "perf.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::perf {
namespace {

/// The time of an engine's frame: the caller's core stays awake, the worker's threads do not.
void stay_busy(std::chrono::nanoseconds time) {
  const Clock::time_point end = Clock::now() + time;
  while (Clock::now() < end) {
  }
}

/// Threads of normal priority: this measures the plumbing, not the load of other programs.
WorkerOptions worker_options(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.thread_priority = ThreadPriority::normal;
  return options;
}

/// A request that does nothing. (It has no ==, so that none replaces another.)
struct Nothing {
  void operator()(const Control& /*control*/) const {}
};

/// Registers a benchmark that times its iterations itself.
void add_timed(const std::string& name, const std::string& size, int threads, int iterations,
               const std::function<void(benchmark::State&)>& run) {
  const std::string full_name = name + "/" + size + "/" + std::to_string(threads);
  benchmark::RegisterBenchmark(full_name.c_str(), run)->UseManualTime()->Iterations(iterations);
}

using std::chrono::milliseconds;

struct ReadClock {
  Clock::time_point operator()(const Control& /*control*/) const { return Clock::now(); }
};

void post_to_start(benchmark::State& state, int threads, milliseconds pause) {
  Worker worker(worker_options(threads));
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
    milliseconds pause;
    int times;
  };
  constexpr Variant variants[] = {
      {"warm", milliseconds(0), 20'000}, {"asleep-2ms", milliseconds(2), 500}, {"asleep-20ms", milliseconds(20), 100}};
  for (const Variant& variant : variants) {
    add_timed(std::string("PostToStart/") + variant.name, "empty", threads, variant.times,
              [=](benchmark::State& state) { post_to_start(state, threads, variant.pause); });
  }
}

/// A projection, and the times of its start and end.
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

  /// Makes direct calls, then as many posts, so that neither finds the other's threads still spinning: the first two of
  /// each do not count.
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
    state.counters["outside_us"] = outside_.microseconds(0.5);
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
    add_timed(std::string("PostToResult/") + variant.name, std::to_string(size), threads, variant.rounds,
              [=](benchmark::State& state) {
                ResultLatency latency(size, threads, variant.waiting, variant.pause);
                for (auto _ : state) state.SetIterationTime(seconds(latency.measure(variant.times)));
                latency.report(state);
              });
  }
}

/// Two threads per core, of normal priority, that rest for one millisecond of twenty, all at the same time. Threads of
/// the idle class run then, and are suspended in the middle of their work.
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

/// A post needs only this thread's time on a core, not that of the worker's threads, which the system may keep from
/// running for seconds at any point: also inside its allocator.
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
    worker.post(Nothing{}, {.key = "sky"});  // replaces the one that waits
    const Clock::duration time = Clock::now() - start;
    samples.add(time);
    state.SetIterationTime(seconds(time));
  }
  samples.report(state);
}

}  // namespace

void add_worker_latency() {
  for (const int threads : kThreadCounts) add_post_to_start(threads);
  for (const int size : {64, 1024}) {
    for (const int threads : kThreadCounts) add_post_to_result(size, threads);
  }
  add_timed("Post/beside-busy-processors", "empty-idle-priority", 1, 20'000, post_beside_busy_processors);
}

namespace {

constexpr int kWidth = 4096;
constexpr int kHeight = 2048;

/// The course of a call alone on one thread: the times of its tiles' ends.
struct Course {
  std::vector<Clock::duration> stretches;  ///< to the first tile's end, then from each to the next
  Clock::duration last{};                  ///< from the last tile's end to the call's
  Clock::duration whole{};
};

template <class Request>
Course course_of(const Request& request) {
  Course course;
  run_with_threads(1, [&] {
    const Clock::time_point start = Clock::now();
    Clock::time_point before = start;
    Control control;
    control.progress = [&](double /*done*/) {
      const Clock::time_point now = Clock::now();
      course.stretches.push_back(now - before);
      before = now;
    };
    benchmark::DoNotOptimize(request(control));
    const Clock::time_point end = Clock::now();
    course.last = end - before;
    course.whole = end - start;
  });
  return course;
}

/// Returns the shortest of each stretch over several runs of one course, which excludes other programs.
template <class Request>
Course quiet_course_of(const Request& request) {
  static_cast<void>(course_of(request));  // tables and pages are warm
  Course quiet = course_of(request);
  for (int run = 0; run < 2; ++run) {
    const Course course = course_of(request);
    const std::size_t count = std::min(course.stretches.size(), quiet.stretches.size());
    for (std::size_t i = 0; i < count; ++i) quiet.stretches[i] = std::min(quiet.stretches[i], course.stretches[i]);
    quiet.last = std::min(quiet.last, course.last);
    quiet.whole = std::min(quiet.whole, course.whole);
  }
  return quiet;
}

void report(benchmark::State& state, const Course& course) {
  Samples tiles;
  for (std::size_t i = 1; i < course.stretches.size(); ++i) tiles.add(course.stretches[i]);
  if (!tiles.empty()) {
    state.counters["tile_us"] = tiles.microseconds(0.5);
    state.counters["longest_tile_us"] = tiles.microseconds(1.0);
  }
  state.counters["first_tile_us"] = 1e6 * seconds(course.stretches.front());
  state.counters["last_us"] = 1e6 * seconds(course.last);
  state.counters["whole_ms"] = 1e3 * seconds(course.whole);
}

/// Posts and cancels after `delay`. Returns the time of cancelling, or nothing if the job ended before it.
template <class Request>
std::optional<Clock::duration> cancel_after(Worker& worker, const Request& request, Clock::duration delay) {
  auto job = worker.post(request);
  while (worker.load().waiting > 0) std::this_thread::yield();
  std::this_thread::sleep_for(delay);
  const Clock::time_point asked = Clock::now();
  const bool cancelled = job.cancel();
  while (!job.ready()) std::this_thread::yield();
  const Clock::time_point ready = Clock::now();
  worker.wait_until_idle();
  return cancelled ? std::optional(ready - asked) : std::nullopt;
}

template <class Request>
void cancel_at_random_moments(benchmark::State& state, const Request& request, int threads) {
  const Course course = quiet_course_of(request);
  Worker worker(worker_options(threads));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shares(0.0, 1.0 / threads);
  Samples latency;
  for (auto _ : state) {
    std::optional<Clock::duration> time;
    while (!time) {
      time = cancel_after(worker, request, std::chrono::duration_cast<Clock::duration>(shares(random) * course.whole));
    }
    latency.add(*time);
    state.SetIterationTime(seconds(*time));
  }
  latency.report(state);
  report(state, course);
}

/// `make()`: makes the request when the benchmark runs.
template <class Make>
void add(const std::string& kind, const std::string& size, int times, const Make& make) {
  for (const int threads : kThreadCounts) {
    add_timed("CancelRunning/" + kind, size, threads, times,
              [=](benchmark::State& state) { cancel_at_random_moments(state, make(), threads); });
  }
}

void write_half_exr(const std::filesystem::path& path, Imf::Compression compression) {
  const LatLongView noise = noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight);
  const auto* rgb = static_cast<const float*>(noise.pixels);
  std::vector<Imf::Rgba> pixels(std::size_t{kWidth} * kHeight);
  for (Imf::Rgba& pixel : pixels) {
    pixel = Imf::Rgba(rgb[0], rgb[1], rgb[2]);
    rgb += 3;
  }
  Imf::Header header(kWidth, kHeight);
  header.compression() = compression;
  Imf::RgbaOutputFile file(path.c_str(), header, Imf::WRITE_RGB);
  file.setFrameBuffer(pixels.data(), 1, kWidth);
  file.writePixels(kHeight);
}

using Write = std::function<void(const std::filesystem::path&)>;

Write exr(Imf::Compression compression) {
  return [=](const std::filesystem::path& path) { write_half_exr(path, compression); };
}

void write_noise(const std::filesystem::path& path) {
  (void)write_environment(path, noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight));
}

void add_files() {
  struct File {
    const char* variant;
    const char* name;
    Write write;
    int times;
  };
  const File files[] = {{"exr-zip", "cancel-zip.exr", exr(Imf::ZIP_COMPRESSION), 60},
                        {"exr-piz", "cancel-piz.exr", exr(Imf::PIZ_COMPRESSION), 30},
                        {"exr-dwab", "cancel-dwab.exr", exr(Imf::DWAB_COMPRESSION), 30},
                        {"hdr", "cancel.hdr", write_noise, 60},
                        {"png", "cancel.png", write_noise, 30}};
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  const auto path_of = [](const File& file) { return scratch_file(file.name, file.write); };
  for (const File& file : files) {
    add(std::string("ProjectFile-") + file.variant, size, file.times, [=] { return ProjectFile{path_of(file)}; });
  }
  add("ReadFile-exr-zip", size, 60, [=, file = files[0]] { return ReadFile{path_of(file)}; });
}

}  // namespace

void add_cancel_latency() {
  add("ProjectCubemap", "2048", 200,
      [] { return Project{EnvironmentSource(noise_cubemap(PixelFormat::rgb32f, 2048), nullptr)}; });
  add("ProjectLatLong", "8192x4096", 200,
      [] { return Project{EnvironmentSource(noise_lat_long(PixelFormat::rgb32f, 8192, 4096), nullptr)}; });
  add("LatLongToCubemap", "4096x2048-to-512", 30, [] {
    return ToCubemap{EnvironmentSource(noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight), nullptr), 512};
  });
  add_files();
}

}  // namespace welkin::perf
