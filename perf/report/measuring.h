// What measurements need: clocks, other programs that are run and timed, the light, errors as two numbers, and words.
#pragma once

#include "perf/report/report.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {

enum class Clock {
  processor,  ///< time that the calling thread spent on a processor: what others do beside it hardly shows
  wall,
};

/// "CPU time", "wall time"
[[nodiscard]] const char* name(Clock clock) noexcept;

/// Runs work again and again, in an arena of its own.
struct Stopwatch {
  int threads = 1;              ///< of that arena
  double budget_seconds = 0.1;  ///< wall time for the repeats of one measurement; the first run is always made
  int most_runs = 1000;

  /// Processor time for one thread, which then does all the work; else wall time.
  [[nodiscard]] Clock clock() const noexcept { return threads == 1 ? Clock::processor : Clock::wall; }

  /// Seconds of a call of `work`: the least of the runs, as whatever else the machine does can only add to it. The
  /// first run fills caches and counts only where the budget allows no other. Calls shorter than 0.2 ms are timed
  /// several at a time. Passes on what `work` throws.
  [[nodiscard]] double seconds(const std::function<void()>& work) const;
};

/// Time that the calling thread has spent on processors.
[[nodiscard]] double processor_seconds();

/// A new folder of its own for temporary files. Throws `Error` (file_access).
[[nodiscard]] std::filesystem::path make_temporary_folder();

/// One that is gone, with what is in it, when this is.
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
  int exit_code = -1;    ///< -1: it could not be started or was ended by a signal
  double seconds = 0.0;  ///< from start to end, by the clock: of processor time all of its threads'
};

/// Runs `arguments[0]`, found on the PATH, bound to at most `threads` of the processors that this thread may use (0:
/// all of them), its output thrown away or written to `output`; its standard error is thrown away.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& arguments, int threads, Clock clock,
                                        const std::optional<std::filesystem::path>& output = std::nullopt);

/// The least time of several runs within the stopwatch's budget, once at least; none if one of them fails.
[[nodiscard]] std::optional<double> process_seconds(const std::vector<std::string>& arguments,
                                                    const Stopwatch& stopwatch);

/// Whether a program is on the PATH.
[[nodiscard]] bool on_path(const std::string& program);

/// How many processors of what name.
[[nodiscard]] std::string processor_name();

/// Processor, compiler, instruction set in use, Welkin's version, clock, date, threads.
[[nodiscard]] Machine this_machine(const Stopwatch& stopwatch);

/// By printf's format of one double.
[[nodiscard]] std::string number(const char* format, double value);

/// Two significant digits of a percentage: 0.0123 is "1.2 %"; below 0.001 % scientific; "no number" for a NaN.
[[nodiscard]] std::string percent(double share);

/// Three significant digits in ns, us, ms or s; "no number" for a NaN.
[[nodiscard]] std::string duration(double seconds);

struct ReportEnvironment {
  std::string name;
  LatLongImage image;  ///< twice as wide as high
};

/// A made-up place with what is hard in real ones: a sun 1.2 degrees across that is 40 000 times the mean of the sky
/// and most of the light, two bright windows with sharp edges, a smooth sky, a dark ground with grain. Nearly the same
/// light at any width: from 512 on within a tenth, which is what the sun's few texels make.
[[nodiscard]] ReportEnvironment built_in_environment(int width);

/// A file's lat-long, resampled to `width` x width / 2 by area; a cubemap is turned to one. Throws what
/// `read_environment` throws.
[[nodiscard]] ReportEnvironment environment_from(const std::filesystem::path& path, int width);

/// "rgb32f", "rgba32f", "rgba16f", "rgb16f", "rgb8", "rgb8srgb", ...
[[nodiscard]] std::string name(PixelFormat format);

/// A cubemap's pixels in another format: halves by GLM, at most 65504; bytes rounded to nearest from values clamped to
/// 0 to 1; alpha is 1.
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
  double maximum = 0.0;  ///< likewise
};

/// |c - c*| / |c*| over all coefficients and channels: the relative rms error of the function on the sphere.
/// `found` has at least as many bands as `truth`; what it has beyond is not looked at.
[[nodiscard]] double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// |c - c*| / |c*| of the worst channel.
[[nodiscard]] double worst_channel_error(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// rms: `relative_error` of the coefficients of radiance. Maximum: the largest difference of the irradiance over 256
/// normals, over the root mean square of the true irradiance; differences are lengths over the three channels.
[[nodiscard]] ErrorNorms harmonic_errors(const SphericalHarmonics& found, const SphericalHarmonics& truth);

/// Root mean square over all normals of the irradiance, as the length over three channels, that this radiance gives.
[[nodiscard]] double rms_of_irradiance(const SphericalHarmonics& radiance);

/// Of each value the difference over the given one, as far as halves hold that, or over 2^-14 where it is less: root
/// mean square and largest. Both have the same length.
[[nodiscard]] ErrorNorms relative_errors(std::span<const float> found, std::span<const float> given);

/// Several cases as one: the root mean square of their rms errors, and the largest maximum.
[[nodiscard]] ErrorNorms together(std::span<const ErrorNorms> cases);

/// A texel of a level, counted over faces, rows, columns.
struct Probe {
  std::int64_t texel = 0;
  double weight = 0.0;  ///< of its square in the rms: in proportion to the solid angle that it stands for
};

/// All texels of a level, or one of each of `count` equal runs and beside them the eight brightest and darkest, which
/// have no weight in the rms.
[[nodiscard]] std::vector<Probe> probes_of(const Cubemap& chain, int level, int count, std::mt19937& random);

/// Unit directions of the probes' centres on a level of `size` texels an edge.
[[nodiscard]] std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size);

struct ProbeErrors {
  ErrorNorms norms;          ///< rms by solid angle over that of the truth; largest |value - truth| / truth
  double truth_there = 0.0;  ///< at the largest: truth over the mean
};

/// `truth` and `mean`: at the probes, and of the whole. Truth below a millionth of the mean counts as that much: what
/// is black is not measured against 0.
[[nodiscard]] ProbeErrors errors_at(const Cubemap& chain, int level, const std::vector<Probe>& probes,
                                    const std::vector<glm::dvec3>& truth, const glm::dvec3& mean);

}  // namespace welkin::report
