#include "tools/sky_measure.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "tools/baked.h"
#include "tools/progress_bar.h"
#include "tools/sh_measure.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/sky_harmonics.h"

namespace welkin::tool {
namespace {

constexpr int kMostZeniths = 128;
constexpr int kMostAzimuths = 256;

double relative_difference(const SphericalHarmonics& coarse, const SphericalHarmonics& fine) {
  double difference = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < fine.coefficients().size(); ++i) {
    const glm::dvec3 apart = coarse.coefficients()[i] - fine.coefficients()[i];
    difference += glm::dot(apart, apart);
    power += glm::dot(fine.coefficients()[i], fine.coefficients()[i]);
  }
  return power > 0.0 ? std::sqrt(difference / power) : 0.0;
}

/// What a quadrature of twice as many nodes each way says otherwise. Of the tables' own error it knows nothing.
double error_estimate(const Sky& sky, const SkyHarmonicsOptions& options, const SphericalHarmonics& radiance) {
  SkyHarmonicsOptions finer = options;
  finer.quadrature = SkyQuadrature::gauss_split;
  finer.zeniths = std::min(2 * options.zeniths, kMostZeniths);
  finer.azimuths = std::min(2 * options.azimuths, kMostAzimuths);
  return relative_difference(radiance, SkyProjector(sky.view, finer).project(sky.sun));
}

/// Of the sky, and of sky and sun together.
void describe_light(const Sky& sky, ShReport& report) {
  const double sphere = std::sqrt(4.0 * std::numbers::pi);  // band 0 is the mean radiance times that
  ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  diagnostics.flux = sphere * report.projection.radiance.coefficients().front();
  diagnostics.flux_before_clamp = diagnostics.flux;
  report.sun_wanted = true;
  report.sun = sky.view.sun(sky.sun);
  report.sun->flux_after = diagnostics.flux;
  report.sun->flux_before = diagnostics.flux + report.sun->irradiance;
}

}  // namespace

ShReport measure_sky(const SkyOptions& options) {
  ProgressBar bar;
  const Control control = bar.control();
  const Sky sky = make_sky(options.sky, control);
  ShReport report;
  report.source = {"computed sky", "directions", 0, 0, "computed", "from tables of the scattering", {}};
  report.options = options.sh.projection;
  report.sky = sky.report;
  report.sky->quadrature = options.quadrature;
  ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  diagnostics.passes = sky.passes;
  report.projection.radiance = timed(diagnostics.passes, "project", "the sky along the quadrature's directions", [&] {
    const SkyProjector projector(sky.view, options.quadrature);
    report.sky->directions = projector.directions();
    return projector.project(sky.sun);
  });
  diagnostics.texels = static_cast<std::uint64_t>(report.sky->directions);
  diagnostics.error_estimate = error_estimate(sky, options.quadrature, report.projection.radiance);
  describe_light(sky, report);
  const glm::dmat3 matrix = turn_of_light(options.sh.turn, false);
  if (matrix != glm::dmat3(1.0)) {
    report.projection.radiance = transform(report.projection.radiance, matrix);
    report.sun->direction = matrix * report.sun->direction;
  }
  complete(report, options.sh);
  return report;
}

}  // namespace welkin::tool
