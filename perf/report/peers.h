// Other programs that do the same work, where the machine has them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "perf/report/stopwatch.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::report {

/// Coefficients of radiance in Welkin's convention.
struct PeerProjection {
  std::string peer;    ///< name and version
  std::string method;  ///< what was called
  int target = 0;      ///< 0: full size
  SphericalHarmonics radiance{3};
  double seconds = 0.0;
};

struct PeerChain {
  std::string peer;
  std::string method;  ///< what was called
  std::string setting;
  Cubemap cubemap;             ///< in Welkin's axes
  RoughnessSchedule schedule;  ///< its roughness, and the formula that the peer's shaders read it by
  double seconds = 0.0;        ///< NaN: drawn by no graphics card, so that its time says nothing
};

/// Returns a chain in Welkin's axes. `faces`: takes a direction in these to the one in the frames of `CubemapView`'s
/// faces under which `chain` holds it; a signed permutation.
[[nodiscard]] Cubemap from_axes(const Cubemap& chain, const dmat3& faces);

struct PeerTable {
  std::string peer;
  int size = 0;
  std::vector<float> values;  ///< size x size x 3: along N.V, row 0 at the lowest roughness
  double seconds = 0.0;
};

/// Filament's cmgen (Debian package libfilament-tools) on the PATH; Babylon.js and three.js in Node.js, and in Chromium
/// where they prefilter by WebGL. What is not there is left out and said in `notes`. Every call that a peer fails gives
/// nothing for it.
///
/// cmgen runs as a process, bound to as many processors as the stopwatch has threads, and its whole life counts, start,
/// reading and writing included. The others are called in a running Node.js with their data in memory; they count like
/// Welkin's calls, best of several, after a first one.
class Peers {
 public:
  /// None at all.
  Peers() = default;

  /// `node_modules`: where @babylonjs/core and three are installed (the folder that holds node_modules); empty: they
  /// are left out.
  static Peers find(const std::filesystem::path& node_modules);

  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  [[nodiscard]] std::vector<PeerProjection> project(const Cubemap& cube, const std::vector<int>& targets,
                                                    const std::filesystem::path& folder,
                                                    const Stopwatch& stopwatch) const;
  [[nodiscard]] std::vector<PeerProjection> project_file(const std::filesystem::path& file,
                                                         const std::filesystem::path& folder,
                                                         const Stopwatch& stopwatch) const;
  /// cmgen's specular chain from `size` down to 16, its roughness spread as `RoughnessSchedule::filament`.
  [[nodiscard]] std::vector<PeerChain> prefilter_file(const std::filesystem::path& file, int size,
                                                      std::span<const int> samples, const std::filesystem::path& folder,
                                                      const Stopwatch& stopwatch) const;
  /// The specular chains that Babylon.js (from `size` down to 1) and three.js (from a quarter of the file's width, at
  /// least 256, down to 8) make by WebGL in Chromium, whose software draws: no graphics card is asked for. Cost: about
  /// a minute; a later call with the same folder reads what the first one made.
  [[nodiscard]] std::vector<PeerChain> prefilter_by_webgl(const std::filesystem::path& file, int size,
                                                          const std::filesystem::path& folder) const;
  /// The DFG table of `BrdfModel::multiple_scattering`.
  [[nodiscard]] std::vector<PeerTable> brdf_table(std::span<const int> sizes, const std::filesystem::path& folder,
                                                  const Stopwatch& stopwatch) const;

 private:
  std::optional<std::string> cmgen_;    ///< "cmgen 1.9.25" or as the package has it
  std::optional<std::string> node_;     ///< the program
  std::optional<std::string> browser_;  ///< Chromium's program
  std::filesystem::path node_modules_;
  std::vector<std::string> notes_;
};

}  // namespace welkin::report
