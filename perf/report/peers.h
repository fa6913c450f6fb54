// Other programs that do the same work, where the machine has them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "perf/report/stopwatch.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
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
  std::string setting;
  CubemapChain cubemap;
  double seconds = 0.0;
};

struct PeerTable {
  std::string peer;
  int size = 0;
  std::vector<float> values;  ///< size x size x 3: along N.V, row 0 at the lowest roughness
  double seconds = 0.0;
};

/// Filament's cmgen (Debian package libfilament-tools) on the PATH; Babylon.js and three.js in Node.js. What is not
/// there is left out and said in `notes`. Every call that a peer fails gives nothing for it.
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

  [[nodiscard]] std::vector<PeerProjection> project(const CubemapImage& cube, const std::vector<int>& targets,
                                                    const std::filesystem::path& folder,
                                                    const Stopwatch& stopwatch) const;
  [[nodiscard]] std::vector<PeerProjection> project_file(const std::filesystem::path& file,
                                                         const std::filesystem::path& folder,
                                                         const Stopwatch& stopwatch) const;
  /// A specular chain from `size` down to 16, its roughness spread as `RoughnessSchedule::filament`, Welkin's axes.
  [[nodiscard]] std::vector<PeerChain> prefilter_file(const std::filesystem::path& file, int size,
                                                      std::span<const int> samples, const std::filesystem::path& folder,
                                                      const Stopwatch& stopwatch) const;
  /// The DFG table of `BrdfModel::multiple_scattering`.
  [[nodiscard]] std::vector<PeerTable> brdf_table(std::span<const int> sizes, const std::filesystem::path& folder,
                                                  const Stopwatch& stopwatch) const;

 private:
  std::optional<std::string> cmgen_;  ///< "cmgen 1.9.25" or as the package has it
  std::optional<std::string> node_;   ///< the program
  std::filesystem::path node_modules_;
  std::vector<std::string> notes_;
};

}  // namespace welkin::report
