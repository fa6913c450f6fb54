// The measurements of welkin_perf: registered benchmarks, named Subject/variant/size/threads, tables of errors, and
// their shared helpers.
#pragma once

#include <benchmark/benchmark.h>

#include "perf/report/measuring.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/requests.h"
#include "welkin/sky.h"
#include "welkin/worker.h"

namespace welkin::perf {

using report::name;
using report::number;

using Paths = std::vector<std::filesystem::path>;

/// Threads that benchmarks run on.
inline constexpr int kThreadCounts[] = {1, 2};
inline constexpr int kOneThread[] = {1};

/// The words after a mode: options, `--name` or `--name=value`, and files. Throws `Error` (invalid_argument) for an
/// option that is not among `known`.
class Arguments {
 public:
  Arguments(const Paths& words, const std::vector<std::string>& known);

  Paths files;

  [[nodiscard]] bool has(const std::string& option) const { return values_.contains(option); }
  [[nodiscard]] std::string text(const std::string& option, const std::string& otherwise = "") const;
  [[nodiscard]] double value(const std::string& option, double otherwise) const;
  [[nodiscard]] int count(const std::string& option, int otherwise) const;
  [[nodiscard]] std::vector<std::string> list(const std::string& option, const std::string& otherwise = "") const;

 private:
  std::map<std::string, std::string> values_;
};

/// A table as Markdown, row by row.
class Table {
 public:
  explicit Table(const std::vector<std::string>& heads);

  void add(const std::vector<std::string>& cells);
  [[nodiscard]] bool empty() const { return rows_ == 0; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  int rows_ = 0;
};

/// Memory for the chains of `count` probes of `size`, as half floats, mip after mip.
struct ProbeTargets {
  ProbeTargets(std::size_t count, int size, int mips);

  std::vector<std::byte> memory;
  std::vector<CubemapTarget> targets;
};

/// Returns a cubemap of positive noise, kept until a call with another format or size: the largest takes 400 MB.
[[nodiscard]] CubemapView noise_cubemap(PixelFormat format, int size);

/// Returns a lat-long of positive noise, kept until a call with another format or size.
[[nodiscard]] LatLongView noise_lat_long(PixelFormat format, int width, int height);

/// Returns `count` cubemaps of 64 with half floats and alpha, of positive noise: `different` distinct ones, repeated.
[[nodiscard]] std::vector<CubemapView> noise_probes(std::size_t count, std::size_t different);

/// Registers benchmarks that run the result of `prepare` once per iteration in an arena of that many threads, by wall
/// time, and report nanoseconds per texel and gigabytes per second.
void add_benchmark(const std::string& subject, const std::string& variant, const std::string& size,
                   std::span<const int> threads, double texels, double bytes,
                   const std::function<std::function<void()>()>& prepare);

struct SkyImageOptions {
  int width = 1024;
  double grain = 0.02;  ///< grey noise from 0 to this, added to a sky of 1
  double sun = 0.0;     ///< radiance of a disc of one degree; 0: none

  friend bool operator==(const SkyImageOptions&, const SkyImageOptions&) = default;
};

/// Returns a lat-long half as high as wide: a sky over ground with clouds of a few sizes, as smooth as photographs are
/// and no smoother, whose colours vary over the image. The last one is kept.
[[nodiscard]] std::shared_ptr<const LatLongImage> sky_image(const SkyImageOptions& options = {});

/// Returns default tables of Bruneton's Earth, two orders; computed once.
[[nodiscard]] std::shared_ptr<const SkyTables> earth_tables();

/// Returns the file of that name in a folder of this run, made by `write(path)` if it does not exist. The folder is
/// removed when the program ends.
[[nodiscard]] std::filesystem::path scratch_file(const std::string& name,
                                                 const std::function<void(const std::filesystem::path&)>& write);

[[nodiscard]] inline double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

class Samples {
 public:
  void add(std::chrono::nanoseconds time) { times_.push_back(time); }

  [[nodiscard]] bool empty() const { return times_.empty(); }

  /// Returns the time that a fraction `share` of the samples does not exceed: 0.5 is the median, 1 the maximum.
  [[nodiscard]] std::chrono::nanoseconds quantile(double share) const;
  [[nodiscard]] double microseconds(double share) const { return 1e6 * seconds(quantile(share)); }

  /// Reports the counters median_us, p99_us and max_us.
  void report(benchmark::State& state) const;

 private:
  std::vector<std::chrono::nanoseconds> times_;
};

using Clock = std::chrono::steady_clock;

/// `[--runs=N] LATLONG`: a table of warm CPU milliseconds on one thread, by subject and `rms_error`, each the minimum
/// of N calls (20): default and short chains of cubemaps and of the lat-long itself, sheen, irradiance, and 64 probes
/// of half floats in one call.
[[nodiscard]] std::string bounds_table(const Paths& arguments);

/// Registers EncodeBc6h/fast|normal|slow/<size>/<threads>: the prefiltered chain of a sky with a sun and noise.
void add_bc6h();

/// Returns the table of docs/notes/textures.md: for each lat-long of `files`, prefiltered to a chain of `--size=N`
/// (256), the error of each mip and of all, and the largest bias of a mip's mean, of BC6H and ASTC at each effort.
[[nodiscard]] std::string block_error_table(const Paths& files);

/// Registers CancelRunning/REQUEST/SIZE/THREADS: from `cancel()` of a running job, at moments spread over its whole
/// duration, until its future is ready. Also, from calls alone on one thread, the times that bound it: `tile_us` and
/// `longest_tile_us`, the median and the longest time between two tiles' ends; `first_tile_us`, from the call to the
/// first tile's end (opening a file, tables); `last_us`, from the last tile's end to the call's; and `whole_ms`.
void add_cancel_latency();

/// Runs each operation in its own processes and returns a Markdown table per number of threads: times of the first,
/// second and last call, the fastest one after the first, page faults, and resident memory; then whole processes of
/// `welkin bake`, if that program is in the folder of `program`, which is this one. Arguments: `--threads=1,2` (default
/// 1), `--runs=N` processes per row (default 3; each number is the minimum), `--only=WORD` for names that contain it,
/// `--processor` for CPU time of the calling thread on machines with other programs, and a lat-long file that replaces
/// the built-in environment.
[[nodiscard]] std::string cold_tables(const std::filesystem::path& program, const Paths& arguments);

/// Runs the child process of a row. Arguments: operation, folder of pixels, threads, clock. Returns its measurements as
/// one line.
[[nodiscard]] std::string cold_calls(const Paths& arguments);

/// `[COUNT] [--seed=N] [--rms-error=X] [IMAGE...]`: a table by kind of result, GGX mips within X (1e-3), over COUNT
/// random environments (10 000), a fifth of which come from the images, if any. After each 100 the current table goes
/// to standard error.
[[nodiscard]] std::string estimate_table(const Paths& arguments);

/// Returns Markdown tables for the environments in `files`: the error of the irradiance cubemap of a bake against
/// direct cosine integration, from three bands and by default, the error of the irradiance of several bands, the
/// minimum irradiance of three bands with each window, and for environments with a sun the first errors next to those
/// with the sun as a directional light. Every number is the same on every machine.
[[nodiscard]] std::string irradiance_error_tables(const Paths& files);

/// Returns the tables of docs/maths/reflections.md: for each lat-long of `files`, and each synthetic one with
/// "--synthetic", the error and time of each method's mips against the integral in double, at `--texels=N` (256) texels
/// per mip, or all if there are not as many. "--size=N": texels along an edge of mip 0 (512). "--methods=A,B": the
/// methods (automatic).
[[nodiscard]] std::string prefilter_error_tables(const Paths& files);

/// Registers Previews/<spheres>/<size>/<threads>: drawn, packed and written. A texel is a pixel of the images.
void add_previews();

/// Registers Probes/VARIANT/64x10000/threads.
void add_probes();

/// Registers ProjectCubemap/FORMAT/SIZE/THREADS with default options, with other formats and numbers of bands at a few
/// sizes, and ProjectMany, in one call and in single ones.
void add_project_cubemap();

/// Registers ProjectFile/FORMAT/2048x1024/THREADS: from a file in the page cache to coefficients, decoding overlapped.
/// And DecodeFile: the same file's decoder alone.
void add_project_file();

/// Registers ProjectLatLong/FORMAT/4096x2048/THREADS.
void add_project_lat_long();

/// Registers ReadBandwidth/FORMAT/SIZE/THREADS for the cubemaps of ProjectCubemap, and for a lat-long of 4096 x 2048.
void add_read_bandwidth();

/// Registers LatLongToCubemap/area/SHAPE/THREADS.
void add_resampling();

/// Registers benchmarks of what finding results again saves, on 2 threads: the tables of docs/notes/measurements.md.
/// - Cache/bake-...: a bake of a 1024 x 512 lat-long with a specular cubemap of 256, all else default: computed without
/// a cache; the first time, stored in memory or in a folder too; found in memory, on disk; with another last mip.
/// - Cache/hash: the lat-long's hash alone.
/// - Cache/cubemap-...: three bands of a cubemap of 1024: hashed, projected, one face of it, and the sum of all faces.
void add_result_cache();

/// Returns the tables of docs/maths/sky.md, as Markdown: errors of precomputed skies against the reference in double.
/// Options: "--radiance" (single scattering by table size and sun), "--methods" (nine coefficients of singly scattered
/// light by every method and sun, against the reference and the converged integral, and lines of tabs for
/// scripts/plot-sky-errors); none: both. "--directions=N" (400), "--altitude=METRES" (0).
[[nodiscard]] std::string sky_error_tables(const Paths& options);

/// Registers Harmonics/product-1000|rotate-1000|evaluate-1000|evaluate-one-by-one-1000|sky-curve-1000/<bands>/1.
void add_harmonics();

/// Registers SkyTables/LAYOUT/ORDERS/THREADS: all tables of an Earth of the usual sizes (compact: 32 x 64 x 32).
void add_sky_tables();

/// Registers SkySpecular/no_disc/32/THREADS.
void add_sky_specular();

struct PageOptions {
  bool processor = false;  ///< CPU time, for machines with other programs
  /// Other pages whose times become columns: their heads ("before", "SSE2") and files.
  std::vector<std::pair<std::string, std::filesystem::path>> others;
};

/// Runs the benchmarks of the page (registered; Google Benchmark is initialized) and returns the page as Markdown. Of
/// repetitions the fastest counts. Names of running benchmarks go to standard error.
[[nodiscard]] std::string speed_page(const PageOptions& options);

/// Registers the making of path tracers' importance tables, of an image of 4096 x 2048, in existing memory.
void add_importance();

/// Registers PostToStart/STATE/empty/THREADS: from the call of `post` to the request's first instruction on a worker's
/// thread; the worker has just finished a job (warm) or has slept for a while. Threads are of normal priority.
///
/// PostToResult/HOW/SIZE/THREADS: from the call of `post` with a cubemap of SIZE texels per edge until the caller,
/// which waits on the future or polls, has the result; back to back, or after a frame's pause. Also `sync_us`, the call
/// of `project` in an arena of as many threads, alternating with the posts, and `overhead_us`, the additional time of
/// posting: medians. Large cubemaps vary by more than that from call to call: `outside_us` is the part of each post
/// that is not in the request (median).
void add_worker_latency();

/// Registers bakes: the whole chain of a 512 cubemap from a 1024 x 512 lat-long, and others.
/// - Bake/512: cubemap (mip 0), prefiltered mips 1.., 64-texel irradiance, 64 x 64 BRDF table, into new memory; the
/// table from the cache. All others bake into the memory of the last. `-background`: also with its own background
/// cubemap and mips. `-sun`: of an image with a sun. Bake/N/WxH: a chain of N from W x H. Bake/cube-rgb32f/N: from a
/// cubemap of N.
/// - BakeMany: probes of 64, in one call and in single ones.
void add_bakes();

/// Registers Prefilter/spectral|narrow/SIZE/THREADS: the whole chain of a cubemap, by default or with no mip wider than
/// 0.054, from a 1024 x 512 lat-long of noise; `cubemap` and `cubemap-narrow`: from a cubemap.
void add_prefilter();

}  // namespace welkin::perf
