// What benchmarks work on, and how they are named: Subject/variant/size/threads.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "perf/report/environment.h"
#include "welkin/image.h"
#include "welkin/sky.h"

namespace welkin::perf {

using report::name;

/// A cubemap of positive noise, kept until another format or size is asked for: the largest takes 400 MB.
[[nodiscard]] CubemapView noise_cubemap(PixelFormat format, int size);

/// A lat-long of positive noise, likewise.
[[nodiscard]] LatLongView noise_lat_long(PixelFormat format, int width, int height);

/// Registers a benchmark that runs `body` once an iteration in an arena of `threads` threads, by wall
/// time, and reports nanoseconds a texel and gigabytes a second.
void add_benchmark(const std::string& subject, const std::string& variant, const std::string& size, int threads,
                   double texels, double bytes, const std::function<std::function<void()>()>& prepare);

// A made-up sky that packers and encoders have as much to do with as with a photograph.

struct SkyPictureOptions {
  double grain = 0.1;    ///< noise from 0 to this, beside a sky of 1
  double ripples = 0.1;  ///< of fine clouds
  bool tinted = false;   ///< colours change from place to place, and grain is grey: else all has one colour
  double sun = 0.0;      ///< radiance of a disc of four texels; 0: none
};

/// A sky over ground with clouds, 1024 x 512.
[[nodiscard]] LatLongImage sky_picture(const SkyPictureOptions& options = {});

/// Default tables of Bruneton's Earth, two orders; made once.
[[nodiscard]] std::shared_ptr<const SkyTables> earth_tables();

/// The file of that name in a folder of this run's own, made by `write(path)` if it is not there. The folder is gone
/// when the program ends.
[[nodiscard]] std::filesystem::path scratch_file(const std::string& name,
                                                 const std::function<void(const std::filesystem::path&)>& write);

[[nodiscard]] inline double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

class Samples {
 public:
  void add(std::chrono::nanoseconds time) { times_.push_back(time); }

  [[nodiscard]] bool empty() const { return times_.empty(); }

  /// The time that `share` of the samples do not exceed: 0.5 is the median, 1 the maximum.
  [[nodiscard]] std::chrono::nanoseconds quantile(double share) const;
  [[nodiscard]] double microseconds(double share) const { return 1e6 * seconds(quantile(share)); }

  /// As the counters median_us, p99_us and max_us.
  void report(benchmark::State& state) const;

 private:
  std::vector<std::chrono::nanoseconds> times_;
};

}  // namespace welkin::perf
