#include <ImfRgbaFile.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include "benchmarks.h"
#include "subjects.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "worker_subjects.h"

namespace welkin::perf {
namespace {

constexpr int kWidth = 4096;
constexpr int kHeight = 2048;

/// The course of a call alone on one thread: when its tiles ended.
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

/// Of several runs of the same course the shortest of each stretch: what others do on the machine is not in it.
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

/// Posts and cancels after `delay`. How long the cancel took, or nothing if the job was done before it.
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
  Clock::duration longest{};
  double worst_at = 0.0;
  for (auto _ : state) {
    std::optional<Clock::duration> time;
    double share = 0.0;
    while (!time) {
      share = shares(random);
      time = cancel_after(worker, request, std::chrono::duration_cast<Clock::duration>(share * course.whole));
    }
    if (*time > longest) worst_at = share;
    longest = std::max(longest, *time);
    latency.add(*time);
    state.SetIterationTime(seconds(*time));
  }
  latency.report(state);
  state.counters["worst_at"] = worst_at * threads;
  report(state, course);
}

/// `make()` makes the request when the benchmark runs.
template <class Make>
void add(const std::string& kind, const std::string& size, const std::vector<int>& thread_counts, int times,
         const Make& make) {
  for (const int threads : thread_counts) {
    const std::string name = "CancelRunning/" + kind + "/" + size + "/" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) { cancel_at_random_moments(state, make(), threads); })
        ->UseManualTime()
        ->Iterations(times);
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

void add_files(const std::vector<int>& thread_counts) {
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
    add(std::string("ProjectFile-") + file.variant, size, thread_counts, file.times,
        [=] { return ProjectFile{path_of(file)}; });
  }
  add("ReadFile-exr-zip", size, thread_counts, 60, [=, file = files[0]] { return ReadFile{path_of(file)}; });
}

}  // namespace

void add_cancel_latency(const std::vector<int>& thread_counts) {
  add("ProjectCubemap", "2048", thread_counts, 200,
      [] { return Project{EnvironmentSource(noise_cubemap(PixelFormat::rgb32f, 2048), nullptr)}; });
  add("ProjectLatLong", "8192x4096", thread_counts, 200,
      [] { return Project{EnvironmentSource(noise_lat_long(PixelFormat::rgb32f, 8192, 4096), nullptr)}; });
  add("LatLongToCubemap", "4096x2048-to-512", thread_counts, 30, [] {
    return ToCubemap{EnvironmentSource(noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight), nullptr), 512};
  });
  add_files(thread_counts);
}

}  // namespace welkin::perf
