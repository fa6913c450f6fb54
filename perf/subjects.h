// What benchmarks work on, and how they are named: Subject/variant/size/threads.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <functional>
#include <string>

#include "perf/report/environment.h"
#include "welkin/image.h"

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

}  // namespace welkin::perf
