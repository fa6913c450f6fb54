// The passes that a report measures, their extent, and their peers.
#pragma once

#include "perf/report/measuring.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {

/// Returns a measurement whose pass is still to be named.
[[nodiscard]] Measurement measurement(const std::string& method, const std::string& setting, const ErrorNorms& errors,
                                      double seconds, const std::string& truth, const std::string& peer = "");

/// Times `call`, and measures its result by `errors_of`.
template <typename Call, typename ErrorsOf>
[[nodiscard]] Measurement measured(const std::string& method, const std::string& setting, const Stopwatch& stopwatch,
                                   const std::string& truth, const Call& call, const ErrorsOf& errors_of) {
  std::invoke_result_t<Call> result;
  const double seconds = stopwatch.seconds([&] { result = call(); });
  return measurement(method, setting, errors_of(result), seconds, truth);
}

/// The result of another program.
template <typename Result>
struct PeerResult {
  std::string peer;    ///< name and version
  std::string method;  ///< the function that was called
  std::string setting;
  Result result;
  double seconds = 0.0;  ///< NaN: drawn without a GPU, so that its time means nothing
};

/// Adds the measurements of other programs' results.
template <typename Result, typename ErrorsOf>
void add_peers(std::vector<Measurement>& all, const std::vector<PeerResult<Result>>& peers, const std::string& truth,
               const ErrorsOf& errors_of) {
  for (const PeerResult<Result>& one : peers) {
    all.push_back(measurement(one.method, one.setting, errors_of(one.result), one.seconds, truth, one.peer));
  }
}

/// Coefficients of radiance in Welkin's convention, three bands.
using PeerProjections = std::vector<PeerResult<SphericalHarmonics>>;

struct PeerChain {
  Cubemap cubemap;             ///< in Welkin's axes
  RoughnessSchedule schedule;  ///< its roughness, and the formula of the peer's shaders
};
using PeerChains = std::vector<PeerResult<PeerChain>>;

struct PeerTable {
  int size = 0;
  std::vector<float> values;  ///< size x size x 3: along N.V, row 0 at the lowest roughness
};
using PeerTables = std::vector<PeerResult<PeerTable>>;

/// Returns a chain in Welkin's axes. `faces`: from a direction in these to that in the frames of `CubemapView`'s faces
/// at which `chain` holds it; a signed permutation.
[[nodiscard]] Cubemap from_axes(const Cubemap& chain, const dmat3& faces);

/// Filament's cmgen (Debian package libfilament-tools) on the PATH, and its libs/ibl in the program judge_filament_ibl
/// (judges/, Debian package libfilament-dev), next to welkin-report or on the PATH; Babylon.js and three.js in Node.js,
/// and in Chromium where they prefilter by WebGL. Missing ones are left out and listed in `notes`. A call that a peer
/// fails returns nothing for it.
///
/// judge_filament_ibl gets data in memory, with one thread, and times its own calls, best of several. It is left out
/// where Welkin has more threads. cmgen runs as a process, bound to as many processors as the stopwatch has threads,
/// and its whole life counts, start, reading and writing included. The others are called in a running Node.js with
/// their data in memory; they count like Welkin's calls, best of several, after a first one.
class Peers {
 public:
  /// No peers.
  Peers() = default;

  /// Finds the peers. `programs`: welkin-report's folder, or empty. `node_modules`: the folder that holds node_modules
  /// with @babylonjs/core and three; empty: they are left out. `folder`: for exchanged files.
  static Peers find(const std::filesystem::path& node_modules, const std::filesystem::path& programs,
                    const std::filesystem::path& folder, const Stopwatch& stopwatch);

  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  /// Runs Babylon.js and three.js on a cubemap reduced to each target (0: full size) where they can, and libs/ibl.
  [[nodiscard]] PeerProjections project(const Cubemap& cube, const std::vector<int>& targets) const;
  /// Runs cmgen.
  [[nodiscard]] PeerProjections project_file(const std::filesystem::path& file) const;
  /// Returns cmgen's specular chain from `size` down to 16, with roughness by `RoughnessSchedule::filament`. Also those
  /// that Babylon.js (from `size` down to 1) and three.js (from a quarter of the file's width, at least 256, down to 8)
  /// make by WebGL in Chromium, which draws in software: no GPU is needed. Cost of these: about a minute; a later call
  /// reads the files of the first one.
  [[nodiscard]] PeerChains prefilter_file(const std::filesystem::path& file, int size,
                                          std::span<const int> samples) const;
  /// Returns libs/ibl's chains of a cubemap of floats by `RoughnessSchedule::filament`.
  [[nodiscard]] PeerChains prefilter_cube(const CubemapView& cube, int mips, std::span<const int> samples) const;
  /// Returns the DFG table of `BrdfModel::multiple_scattering`, from cmgen and from libs/ibl.
  [[nodiscard]] PeerTables brdf_table(std::span<const int> sizes) const;

 private:
  /// Times cmgen with these arguments, and adds the result of `read`, which reads its files and may throw `Error`.
  template <typename Result>
  void ask_cmgen(const std::vector<std::string>& words, const char* method, const std::string& setting,
                 const std::function<Result()>& read, std::vector<PeerResult<Result>>& found) const;
  /// Returns the output of judge_filament_ibl; nothing where it is missing or fails.
  [[nodiscard]] std::vector<double> ask_filament(std::vector<std::string> words) const;
  void add_webgl(const std::filesystem::path& file, int size, PeerChains& found) const;

  std::filesystem::path folder_;
  Stopwatch stopwatch_;
  std::optional<std::string> filament_;  ///< the program
  std::optional<std::string> cmgen_;     ///< "cmgen 1.9.25", with the package's version
  std::optional<std::string> node_;      ///< the program
  std::optional<std::string> browser_;   ///< Chromium's program
  std::filesystem::path node_modules_;
  std::vector<std::string> notes_;
};

/// The name of its measurements as a peer.
inline constexpr const char* kSamplingPeer = "plain C++";

/// Prefilters a chain: mip 0 has `size` texels along an edge, mip k the perceptual roughness `roughness[k]`; at
/// roughness 0 the mip is the source's. Each texel reads one list of `samples` directions in the source's own mips,
/// trilinearly and without seams. Plain C++ on all threads that Welkin uses.
[[nodiscard]] Cubemap importance_sampled(const LatLongView& source, int size, const std::vector<double>& roughness,
                                         int samples);

struct BrdfTruth {
  double scale;
  double bias;
};

/// Returns Int D V (n.l) {1 - F, F} dl, F = (1 - v.h)^5: GGX with height-correlated Smith visibility. To 1e-8.
BrdfTruth ggx_truth(double normal_view, double alpha);

/// Returns Int D V (n.l) dl of Charlie sheen with Neubelt's visibility. To 1e-8, relative for values above 1.
double sheen_truth(double normal_view, double alpha);

/// Returns the value that a graphics API reads from a level: bilinear within a face, across its edges from the
/// neighbouring face, and at a corner the mean of the three texels there.
[[nodiscard]] glm::dvec3 lookup(const Cubemap& chain, int level, const glm::dvec3& direction);

/// Interpolates between the two levels around `level`.
[[nodiscard]] glm::dvec3 lookup(const Cubemap& chain, double level, const glm::dvec3& direction);

/// The integral at all roughnesses, in directions that the light determines: half of them uniform over the sphere, half
/// in proportion to the reflection there, so that they include the surroundings of a sun.
class LookupTruth {
 public:
  /// `directions`: the number for each of `kRoughnesses`. Cost: that of `reference_specular` in all of them.
  LookupTruth(const LatLongView& source, int directions);

  /// Returns the error of a chain that is read by a schedule's formula. rms: of the difference over that of the
  /// reference, over all roughnesses. Maximum: the rms error of the worst roughness.
  [[nodiscard]] ErrorNorms errors(const Cubemap& chain, RoughnessSchedule schedule) const;

 private:
  /// Roughnesses (k + 1/2) / kRoughnesses.
  static constexpr int kRoughnesses = 16;

  struct Sample {
    glm::dvec3 direction;
    glm::dvec3 truth;
    double weight = 0.0;  ///< of its square: 1 / density
  };

  std::vector<std::vector<Sample>> samples_;  ///< by roughness
};

/// Sizes and budgets. Errors depend on the sizes, so reports are compared within a scale.
struct Scale {
  std::string name;
  double budget_seconds = 0.0;  ///< for the repeats of a measurement
  int lat_long_width = 0;       ///< of the environment, twice its height
  int cube_size = 0;            ///< of the cubemap that is projected
  int chain_size = 0;           ///< of the specular chain from a file
  int probes = 0;               ///< points where a prefiltered mip is compared with the reference, an estimate's n
  int most_samples = 0;         ///< of importance sampling
  int most_bands = 0;           ///< of the irradiance
  int largest_table = 0;        ///< edge of the largest BRDF table
  int table_truth = 0;          ///< edge of the BRDF table with which others are compared
  std::vector<double> sun_elevations{};       ///< degrees
  int sky_zeniths = 0;                        ///< of the reference's quadrature, on either side of the horizon
  int sky_azimuths = 0;                       ///< over half the circle
  std::vector<SkyTableOptions> sky_tables{};  ///< from coarse to fine; the last one makes the view of the harmonics
  bool peers = true;                          ///< other programs, and encoders of other libraries
};

/// tiny: seconds, for tests. quick: under a minute on two cores. full: minutes.
/// Throws `Error` (invalid_argument) for other names.
[[nodiscard]] const Scale& scale(const std::string& name);

/// Returns "tiny", "quick", "full".
[[nodiscard]] std::vector<std::string> scale_names();

struct PassContext {
  const Scale& scale;
  Stopwatch stopwatch;
  const ReportEnvironment& environment;
  std::filesystem::path file;    ///< the environment as Radiance .hdr
  std::filesystem::path folder;  ///< for files of passes and peers
  const Peers& peers;
  Control control;                  ///< progress of this pass
  std::filesystem::path program{};  ///< welkin-report, which first calls start; empty: no first calls
};

/// A pass and its measurement.
struct PassRunner {
  Pass pass;
  double cost = 1.0;  ///< fraction of the report's time, only for the progress bar
  std::function<std::vector<Measurement>(const PassContext& context)> measure;
};

/// Reports the progress of the pass. Throws `Error` (cancelled).
void progress(const PassContext& context, std::size_t done, std::size_t of);

/// Returns "target 64"; "full size" for 0.
[[nodiscard]] std::string target_words(int target);

/// Returns "64 x 64".
[[nodiscard]] std::string square_words(int size);

[[nodiscard]] std::vector<PassRunner> projection_passes();

[[nodiscard]] std::vector<PassRunner> irradiance_passes();

[[nodiscard]] std::vector<PassRunner> prefilter_passes();

/// The argument that makes welkin-report a process of one first call: it prints `first_call_seconds` of the others.
inline constexpr const char* kFirstCall = "--first-call";

/// Returns the seconds of a prefilter as a pass times it, in a process without earlier calls. Arguments: pass, file,
/// size, bound, threads. Throws the errors of reading and prefiltering.
[[nodiscard]] double first_call_seconds(std::span<const std::string> arguments);

[[nodiscard]] std::vector<PassRunner> lookup_passes();

[[nodiscard]] std::vector<PassRunner> brdf_passes();

/// A way to encode a cubemap in blocks.
struct BlockWay {
  const char* format;
  const char* effort;
  TextureOptions options;
};

/// Returns BC6H and ASTC with each effort.
[[nodiscard]] std::vector<BlockWay> block_ways();

/// Returns a KTX2 in memory; nothing in a build without the codec.
[[nodiscard]] std::optional<std::vector<std::byte>> texture_bytes(const Cubemap& chain, const TextureOptions& options);

[[nodiscard]] std::vector<PassRunner> block_passes();

/// Returns "32 x 64 x 8 x 32": heights, views, full tables' angles, suns.
[[nodiscard]] std::string size_words(const SkyTableOptions& options);

/// Writes the nine coefficients for a sun.
using ProjectSky = std::function<void(const glm::dvec3& sun, SphericalHarmonics& light)>;

struct SkyMethod {
  std::string name;        ///< the quadrature's, or "curve"
  std::string setting;     ///< zeniths x azimuths, or elevations
  std::string directions;  ///< number that a quadrature represents: both sides of the sun
  ProjectSky project;
};

/// Returns the quadratures of a view from coarse to fine, and its curves of 64, 256 and 1024 elevations.
[[nodiscard]] std::vector<SkyMethod> sky_methods(const SkyView& view);

/// Measures singly scattered light of the Earth on black ground by each method: over the elevations, against `truths`.
[[nodiscard]] std::vector<Measurement> sky_by_method(const std::vector<SkyMethod>& methods,
                                                     const std::vector<double>& elevations,
                                                     const std::vector<SphericalHarmonics>& truths,
                                                     const Stopwatch& stopwatch);

[[nodiscard]] std::vector<PassRunner> sky_passes();

}  // namespace welkin::report
