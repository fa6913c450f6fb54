// Helpers of measurements: clocks, timed runs of other programs, the light, errors as two numbers, and words.
#pragma once

#include "perf/report/report.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {

enum class Clock {
  processor,  ///< CPU time of the calling thread, on which other programs have little effect
  wall,
};

/// Returns "CPU time" or "wall time".
[[nodiscard]] const char* name(Clock clock) noexcept;

/// Runs work repeatedly, in its own arena.
struct Stopwatch {
  int threads = 1;              ///< of that arena
  double budget_seconds = 0.1;  ///< wall time for the repeats of one measurement; the first run is always made
  int most_runs = 1000;

  /// Returns the clock: CPU time for one thread, which then does all the work; else wall time.
  [[nodiscard]] Clock clock() const noexcept { return threads == 1 ? Clock::processor : Clock::wall; }

  /// Returns the seconds of a call of `work`: the minimum of the runs, because other load can only add time. The first
  /// run fills caches and counts only where the budget allows no other. Calls shorter than 0.2 ms are timed several at
  /// a time. Rethrows the errors of `work`.
  [[nodiscard]] double seconds(const std::function<void()>& work) const;
};

/// Returns the CPU time of the calling thread.
[[nodiscard]] double processor_seconds();

/// Makes a new folder for temporary files. Throws `Error` (file_access).
[[nodiscard]] std::filesystem::path make_temporary_folder();

/// A temporary folder, which is removed with its content by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(make_temporary_folder()) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

struct ProcessResult {
  int exit_code = -1;    ///< -1: not started, or ended by a signal
  double seconds = 0.0;  ///< from start to end, by the clock: CPU time includes all of its threads
};

/// Runs `arguments[0]`, found on the PATH, bound to at most `threads` of the processors that this thread may use (0:
/// all of them), with its output discarded or written to `output`; its standard error is discarded.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& arguments, int threads, Clock clock,
                                        const std::optional<std::filesystem::path>& output = std::nullopt);

/// Returns the minimum time of several runs within the stopwatch's budget, at least one; none if one of them fails.
[[nodiscard]] std::optional<double> process_seconds(const std::vector<std::string>& arguments,
                                                    const Stopwatch& stopwatch);

/// Returns whether a program is on the PATH.
[[nodiscard]] bool on_path(const std::string& program);

/// Returns the number and name of the processors.
[[nodiscard]] std::string processor_name();

/// Returns processor, compiler, instruction set in use, Welkin's version, clock, date, threads.
[[nodiscard]] Machine this_machine(const Stopwatch& stopwatch);

/// Formats the value by printf's format for one double.
[[nodiscard]] std::string number(const char* format, double value);

/// Returns two significant digits of a percentage: 0.0123 is "1.2 %"; below 0.001 % scientific; "no number" for a NaN.
[[nodiscard]] std::string percent(double share);

/// Returns three significant digits in ns, us, ms or s; "no number" for a NaN.
[[nodiscard]] std::string duration(double seconds);

struct ReportEnvironment {
  std::string name;
  LatLongImage image;  ///< twice as wide as high
};

/// Returns a synthetic place with the difficulties of real ones: a sun 1.2 degrees across that is 40 000 times the mean
/// of the sky and most of the light, two bright windows with sharp edges, a smooth sky, a dark ground with grain.
/// Nearly the same light at any width: from 512 on within a tenth, an effect of the sun's few texels.
[[nodiscard]] ReportEnvironment built_in_environment(int width);

/// Returns a file's lat-long, resampled to `width` x width / 2 by area; a cubemap is converted to one. Throws the
/// errors of `read_environment`.
[[nodiscard]] ReportEnvironment environment_from(const std::filesystem::path& path, int width);

/// Returns "rgb32f", "rgba32f", "rgba16f", "rgb16f", "rgb8", "rgb8srgb", ...
[[nodiscard]] std::string name(PixelFormat format);

/// A cubemap's pixels in another format: half floats by GLM, at most 65504; bytes rounded to nearest from values
/// clamped to 0 to 1; alpha is 1.
class FormattedCubemap {
 public:
  FormattedCubemap(const Cubemap& image, PixelFormat format);
  [[nodiscard]] CubemapView view() const noexcept;

 private:
  int size_;
  PixelFormat format_;
  std::vector<std::byte> bytes_;
};

struct ErrorNorms {
  double rms = 0.0;      ///< relative: 0.01 is 1 %
  double maximum = 0.0;  ///< relative
};

/// Returns |c - c*| / |c*| over all coefficients and channels: the relative rms error of the function on the sphere.
/// `found` has at least as many bands as `truth`; further ones are ignored.
[[nodiscard]] double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// Returns |c - c*| / |c*| of the worst channel.
[[nodiscard]] double worst_channel_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// Returns rms: `relative_error` of the radiance's coefficients; maximum: the largest difference of the irradiance over
/// 256 normals, over the exact irradiance's root mean square. Differences are lengths over the three channels.
[[nodiscard]] ErrorNorms harmonic_errors(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// Returns the root mean square over all normals of the irradiance of this radiance, as the length over three channels.
[[nodiscard]] double rms_of_irradiance(const SphericalHarmonics& radiance);

/// Returns the root mean square and the largest of the differences, each over the given value, or over 2^-14 where it
/// is less: half floats hold no smaller ones precisely. Both have the same length.
[[nodiscard]] ErrorNorms relative_errors(std::span<const float> found, std::span<const float> given);

/// Combines several cases: the root mean square of their rms errors, and the largest maximum.
[[nodiscard]] ErrorNorms together(std::span<const ErrorNorms> cases);

/// A texel of a level, indexed by faces, rows, columns.
struct Probe {
  std::int64_t texel = 0;
  double weight = 0.0;  ///< of its square in the rms: proportional to the solid angle that it represents
};

/// Returns all texels of a level, or one of each of `count` equal runs and also the eight brightest and darkest, which
/// have no weight in the rms.
[[nodiscard]] std::vector<Probe> probes_of(const Cubemap& chain, int level, int count, std::mt19937& random);

/// Returns unit directions of the probes' centres on a level of `size` texels per edge.
[[nodiscard]] std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size);

struct ProbeErrors {
  ErrorNorms norms;          ///< rms by solid angle over the reference's; largest `|value - truth| / truth`
  double truth_there = 0.0;  ///< at the largest: reference over the mean
};

/// Returns the errors at the probes. `truth`: at the probes; `mean`: of the whole. A reference below a millionth of the
/// mean counts as that much, so that black is not measured against 0.
[[nodiscard]] ProbeErrors errors_at(const Cubemap& chain, int level, const std::vector<Probe>& probes,
                                    const std::vector<glm::dvec3>& truth, const glm::dvec3& mean);

}  // namespace welkin::report
