// The passes that a report measures, how much of each, and with what.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "perf/report/environment.h"
#include "perf/report/measurement.h"
#include "perf/report/peers.h"
#include "perf/report/stopwatch.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/sky.h"

namespace welkin::report {

/// Sizes and budgets. Errors depend on the sizes, so reports are compared within a scale.
struct Scale {
  std::string name;
  double budget_seconds = 0.0;  ///< of repeats, a measurement
  int lat_long_width = 0;       ///< of the environment, twice its height
  int cube_size = 0;            ///< of the cubemap that is projected
  int chain_size = 0;           ///< of the specular chain from a file
  int probes = 0;               ///< places at which a prefiltered mip is compared with the truth, an error estimate's n
  int most_samples = 0;         ///< of importance sampling
  int most_bands = 0;           ///< of the irradiance
  int largest_table = 0;        ///< edge of the largest BRDF table
  int table_truth = 0;          ///< edge of the BRDF table that others are compared with
  std::vector<double> sun_elevations{};  ///< degrees
  int sky_zeniths = 0;                   ///< of the truth's quadrature, on either side of the horizon
  int sky_azimuths = 0;                  ///< over half the circle
  std::vector<SkyTableOptions>
      sky_tables{};   ///< from coarse to fine; the last one is the view whose harmonics are taken
  bool peers = true;  ///< other programs, and encoders of other libraries
};

/// tiny: seconds, for tests. quick: under a minute on two cores. full: minutes.
/// Throws `Error` (invalid_argument) for other names.
[[nodiscard]] const Scale& scale(const std::string& name);

/// "tiny", "quick", "full"
[[nodiscard]] std::vector<std::string> scale_names();

struct PassContext {
  const Scale& scale;
  Stopwatch stopwatch;
  const ReportEnvironment& environment;
  std::filesystem::path file;    ///< the environment as Radiance .hdr
  std::filesystem::path folder;  ///< for what passes and peers write
  const Peers& peers;
  Control control;                  ///< progress of this pass
  std::filesystem::path program{};  ///< welkin-report, which first calls start; empty: without them
};

/// What a pass is and how it is measured.
struct PassRunner {
  Pass pass;
  double cost = 1.0;  ///< share of the report's time, for the progress bar alone
  std::function<std::vector<Measurement>(const PassContext& context)> measure;
};

/// Tells the context how far the pass has come. Throws `Error` (cancelled).
void progress(const PassContext& context, std::size_t done, std::size_t of);

/// One way to a smaller size.
struct ProjectionWay {
  const char* name;
  Quadrature quadrature;
  bool from_chain;  ///< of plain boxes of four, as engines make them
};

[[nodiscard]] std::span<const ProjectionWay> projection_ways() noexcept;

/// Three bands of `chain`'s level 0 by each way at each target (0: full size), way after way: `method` is the way's
/// name, `setting` "target 64" or "full size". Peers are not among them.
[[nodiscard]] std::vector<Measurement> projections_by_target(const Cubemap& chain, std::span<const int> targets,
                                                             const SphericalHarmonics& truth,
                                                             const Stopwatch& stopwatch);

[[nodiscard]] std::vector<PassRunner> projection_passes();

[[nodiscard]] std::vector<PassRunner> irradiance_passes();

[[nodiscard]] std::vector<PassRunner> prefilter_passes();

/// The argument by which welkin-report is a process of one first call: it prints `first_call_seconds` of the rest.
inline constexpr const char* kFirstCall = "--first-call";

/// Seconds of a prefilter as a pass times it, in a process that has done nothing yet. Arguments: pass, file, size,
/// bound, threads. Throws `Error` as reading and prefiltering do.
[[nodiscard]] double first_call_seconds(std::span<const std::string> arguments);

[[nodiscard]] std::vector<PassRunner> lookup_passes();

[[nodiscard]] std::vector<PassRunner> brdf_passes();

/// One way to a cubemap in blocks.
struct BlockWay {
  const char* format;
  const char* effort;
  TextureOptions options;
};

/// BC6H and ASTC with each effort.
[[nodiscard]] std::vector<BlockWay> block_ways();

/// A KTX2 in memory; nothing in a build without the codec.
[[nodiscard]] std::optional<std::vector<std::byte>> texture_bytes(const Cubemap& chain, const TextureOptions& options);

[[nodiscard]] std::vector<PassRunner> block_passes();

/// A quadrature at some size.
struct SkySetting {
  std::string name;        ///< of the quadrature
  std::string setting;     ///< zeniths x azimuths
  std::string directions;  ///< that it stands for: both sides of the sun
  SkyHarmonicsOptions options;
};

/// From coarse to fine.
[[nodiscard]] std::vector<SkySetting> sky_settings();

/// Writes the nine coefficients for a sun.
using ProjectSky = std::function<void(const glm::dvec3& sun, SphericalHarmonics& light)>;

struct SkyMethod {
  std::string name, setting, directions;
  ProjectSky project;
};

/// The settings and the curves of 64, 256 and 1024 elevations, of a view.
[[nodiscard]] std::vector<SkyMethod> sky_methods(const SkyView& view);

/// Seconds of an update by a method, over suns that climb.
[[nodiscard]] double seconds_of(const ProjectSky& project, const Stopwatch& stopwatch);

/// Singly scattered light of the Earth on black ground at sea level by each method: over the elevations, against
/// `truths`.
[[nodiscard]] std::vector<Measurement> sky_by_method(const std::vector<SkyMethod>& methods,
                                                     const std::vector<double>& elevations,
                                                     const std::vector<SphericalHarmonics>& truths,
                                                     const Stopwatch& stopwatch);

[[nodiscard]] std::vector<PassRunner> sky_passes();

}  // namespace welkin::report
