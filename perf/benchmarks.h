// What welkin_perf measures: benchmarks that are registered, named Subject/variant/size/threads, and tables of errors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// `[--runs=N] LATLONG`: a table of warm processor milliseconds on one thread, by subject and `rms_error`, each the
/// least of N calls (20): default and short chains of cubemaps and of the lat-long itself, sheen, irradiance, and 64
/// probes of halves in one call.
[[nodiscard]] std::string bounds_table(const std::vector<std::filesystem::path>& arguments);

/// EncodeBc6h/fast|normal|slow/<size>/<threads>: the prefiltered chain of a sky with a sun and noise.
/// DecodeBc6h/halves/<size>/<threads>.
void add_bc6h(const std::vector<int>& thread_counts);

/// The table of docs/notes/textures.md: for each lat-long of `files`, prefiltered to a chain of `--size=N` (256),
/// the error of each mip and of all, and the largest bias of a mip's mean, of BC6H and ASTC at each effort.
[[nodiscard]] std::string block_error_table(const std::vector<std::filesystem::path>& files);

/// CancelRunning/REQUEST/SIZE/THREADS: from `cancel()` of a running job, at moments spread over its whole length, to
/// its future being ready. Beside it, from calls alone on one thread, what bounds it: `tile_us` and `longest_tile_us`,
/// the median and the longest time between two tiles' ends; `first_tile_us`, from the call to the first tile's end
/// (opening a file, tables); `last_us`, from the last tile's end to the call's; and `whole_ms`. `worst_at` is the
/// moment of the cancel that took longest, as a share of the job's length.
void add_cancel_latency(const std::vector<int>& thread_counts);

/// Runs each operation in processes of its own and returns a Markdown table per number of threads: times of the first,
/// second and last call, the fastest one after the first, page faults, and resident memory; then whole processes of
/// `welkin bake`, if that program lies beside `program`, which is this one. Arguments: `--threads=1,2` (default 1),
/// `--runs=N` processes per row (default 3; each number is its least), `--only=WORD` for names that contain it,
/// `--processor` for processor time of the calling thread where other programs use the machine, and a lat-long file in
/// place of the built-in environment.
[[nodiscard]] std::string cold_tables(const std::filesystem::path& program,
                                      const std::vector<std::filesystem::path>& arguments);

/// The child process of a row. Arguments: operation, folder of pixels, threads, clock. Returns what it measured as one
/// line.
[[nodiscard]] std::string cold_calls(const std::vector<std::filesystem::path>& arguments);

/// Command/<bake or bake-again>/<size>/<threads>: `welkin bake` of a picture of 1024 x 512 with all its default files;
/// "again" finds them in a cache. A texel is one of the picture.
void add_command(const std::vector<int>& thread_counts);

/// `[COUNT] [--seed=N] [--rms-error=X] [PICTURE...]`: a table by kind of result, GGX mips within X (1e-3), over COUNT
/// random environments (10 000), of which a fifth are of the pictures if there are any. After each 500 the table so far
/// goes to standard error.
[[nodiscard]] std::string estimate_table(const std::vector<std::filesystem::path>& arguments);

/// Markdown tables for the environments in `files`: how far the irradiance cubemap of a bake is from direct cosine
/// integration, from three bands and by default, how far the irradiance of some bands is from direct cosine
/// integration, the least irradiance of three bands with each window, and for environments with a sun the first errors
/// beside those with the sun as a directional light. Every number is the same on every machine.
[[nodiscard]] std::string irradiance_error_tables(const std::vector<std::filesystem::path>& files);

/// Prefilter/METHOD/SIZE/THREADS: the whole chain of a cubemap, roughness k / (mips - 1), from a 1024 x 512 lat-long of
/// noise; and Prefilter/spectral-bright, the same with a sun of 1e6 in one texel. Sampled: importance sampling by 64
/// samples, which is not the library's. Sheen is a chain of five Charlie lobes. Octahedral/chain/SIZE/THREADS: five
/// levels of a map of so many texels.
void add_prefilter(const std::vector<int>& thread_counts);

/// The tables of docs/maths/reflections.md: for each lat-long of `files`, and each made-up one where an entry says
/// "--synthetic", the error and time of each method's mips against the integral in double, at `--texels=N` (256)
/// texels a mip, or all if there are fewer. "--size=N": texels along an edge of mip 0 (512). "--methods=A,B": which
/// (automatic).
[[nodiscard]] std::string prefilter_error_tables(const std::vector<std::filesystem::path>& files);

/// Previews/<spheres>/<size>/<threads>: drawn, packed and written. A texel is a pixel of the pictures.
void add_previews(const std::vector<int>& thread_counts);

/// Benchmarks Probes/VARIANT/64x10000/threads.
void add_probes(const std::vector<int>& thread_counts);

/// ProjectCubemap/FORMAT/SIZE/THREADS with default options; the same with other options, formats and
/// instruction sets at a few sizes; ProjectMany, in one call and in single ones; and ReferenceTwin, the readable scalar
/// version.
void add_project_cubemap(const std::vector<int>& sizes, const std::vector<int>& thread_counts);

/// ProjectFile/FORMAT/2048x1024/THREADS: from a file in the page cache to coefficients, decoding overlapped. And
/// ReadFile for the same file's bytes, read and looked at once: the floor.
void add_project_file(const std::vector<int>& thread_counts);

/// ProjectLatLong/FORMAT/4096x2048/THREADS.
void add_project_lat_long(const std::vector<int>& thread_counts);

/// ReadBandwidth/FORMAT/SIZE/THREADS for cubemaps of each size, and for a lat-long of 4096 x 2048.
void add_read_bandwidth(const std::vector<int>& sizes, const std::vector<int>& thread_counts);

void add_resampling(const std::vector<int>& thread_counts);

/// What is saved when results are found again, on 2 threads: the tables of docs/notes/measurements.md.
/// - Cache/bake-...: a bake of a 1024 x 512 lat-long with a specular cubemap of 256, all else default: computed without
///   a cache; the first time, stored in memory or in a folder too; found in memory, on disk; with another last mip.
/// - Cache/hash: the lat-long's hash alone.
/// - Cache/cubemap-...: three bands of a cubemap of 1024: hashed, projected, one face of it, and the sum of all faces.
void add_result_cache();

/// The tables of docs/maths/sky.md, as Markdown: errors of precomputed skies against the truth in double. Options
/// choose:
/// "--radiance" (single scattering by table size and sun), "--orders" (orders 2 to 4 as harmonics against path
/// tracing), "--methods" (ways to harmonics by sun and time); none: all. "--directions=N" (400), "--paths=N" (4000000),
/// "--altitude=METRES" (0).
[[nodiscard]] std::string sky_error_tables(const std::vector<std::filesystem::path>& options);

/// Nine coefficients of singly scattered light on the ground, black ground, by every method and sun elevation: Markdown
/// tables of errors against the truth in double (the tables' own included) and against the converged integral of the
/// same view, then lines of tabs: method, setting, directions, microseconds, rms and worst error against the truth over
/// elevations, the worst one's elevation.
[[nodiscard]] std::string sky_method_table(double altitude_m);

/// SkyTables/LAYOUT/ORDERS/THREADS: precomputing an Earth of the usual sizes (compact: 32 x 64 x 32), all tables.
/// SkyTransmittance/table/64x256/1: what one order of the smallest scattering table takes, nearly all of it lengths.
void add_sky_tables(const std::vector<int>& thread_counts);

/// SkyRadiance, SkyView, SkyCubemap, SkyLatLong, SkySpecular.
void add_sky_views(const std::vector<int>& thread_counts);

/// Runs the benchmarks that the page shows (they are registered, and Google Benchmark is initialised) and returns the
/// page as Markdown. Of repetitions the fastest counts. Names of running benchmarks go to standard error.
[[nodiscard]] std::string speed_page();

/// Tables by which path tracers pick directions, of a picture of 4096 x 2048, into memory that is there.
void add_importance(const std::vector<int>& thread_counts);

/// A Markdown table of error and time over target sizes for the lat-longs in `files`: each becomes a cubemap of
/// 1024 x 1024 faces by area and projected at every target, exact and midpoint, and from a mip chain. Errors are those
/// of the radiance coefficients against the double-precision projection of all texels, times the fastest of a few runs
/// on this machine, as multiples of reading the cubemap once.
[[nodiscard]] std::string target_size_table(const std::vector<std::filesystem::path>& files);

/// PostToStart/STATE/empty/THREADS: from the call of `post` to the request's first instruction on a worker's thread;
/// the worker has just finished a job (warm) or has been asleep for a while. Without a priority in the name, threads
/// are of normal priority.
///
/// PostToResult/HOW/SIZE/THREADS: from the call of `post` with a cubemap of SIZE texels an edge to its result in the
/// caller's hands, which waits on the future or polls; back to back, or after a frame's pause. Beside it `sync_us`, the
/// call of `project` in an arena of as many threads, in turn with the posts, and `overhead_us`, what posting takes
/// longer: medians, and the fastest of each. Large cubemaps vary by more than that from call to call: `outside_us` is
/// the part of each post that is not in the request, `to_start_us` before and `to_caller_us` after it (medians).
void add_worker_latency(const std::vector<int>& thread_counts);

/// The whole chain of a 512 cubemap from a 1024 x 512 lat-long, others, and BRDF tables.
/// - Bake/512: cubemap (mip 0), prefiltered mips 1.., 64-texel irradiance, 64 x 64 BRDF table, into new memory; the
///   table from the cache. `-again`: into the memory of the last. `-cold-brdf`: the table is made each time.
///   `-background`: with a background cubemap of its own and its mips as well. `-sun`: of a picture with a sun.
///   Bake/N/WxH: a chain of N from W x H, into the memory of the last.
/// - BrdfTable/split_sum/64: made, without the cache; `-sheen` with the third channel.
void add_bakes(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
