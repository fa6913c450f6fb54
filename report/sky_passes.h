// Computed skies: harmonics by method and setting, tables by size.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "report/pass_context.h"
#include "welkin/sky_harmonics.h"

namespace welkin::report {

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
