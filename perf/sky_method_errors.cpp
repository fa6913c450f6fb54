#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>
#include <vector>

#include "benchmarks.h"
#include "perf/report/error_norms.h"
#include "perf/report/passes.h"
#include "perf/report/stopwatch.h"
#include "reference/sky_reference.h"

namespace welkin::perf {
namespace {

constexpr std::array<double, 12> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0, -9.0, -12.0};
constexpr double kLastPromised = -6.0;

using report::SkyMethod;

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string errors_by_elevation(const std::vector<SkyMethod>& methods, const std::vector<SphericalHarmonics>& truths) {
  std::ostringstream text;
  text << "| sun elevation |";
  for (const SkyMethod& method : methods) text << ' ' << method.name << ' ' << method.setting << " |";
  text << "\n|---|";
  for (std::size_t k = 0; k < methods.size(); ++k) text << "---|";
  text << '\n';
  for (std::size_t k = 0; k < kElevations.size(); ++k) {
    text << "| " << kElevations[k] << " |";
    for (const SkyMethod& method : methods) {
      SphericalHarmonics light(3);
      method.project(sun_direction(kElevations[k], 0.0), light);
      text << ' ' << number("%.1e", report::worst_channel_error(light, truths[k])) << " |";
    }
    text << '\n';
  }
  return text.str();
}

std::string lines_of_tabs(const std::vector<SkyMethod>& methods, const std::vector<SphericalHarmonics>& truths) {
  const report::Stopwatch stopwatch;
  std::ostringstream text;
  text << "# method\tsetting\tdirections\tmicroseconds\trms\tworst\tworst elevation, from 90 to -6 degrees\n";
  for (const SkyMethod& method : methods) {
    double squares = 0.0;
    double worst = 0.0;
    double where = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < kElevations.size() && kElevations[k] >= kLastPromised; ++k, ++count) {
      SphericalHarmonics light(3);
      method.project(sun_direction(kElevations[k], 0.0), light);
      const double error = report::worst_channel_error(light, truths[k]);
      squares += error * error;
      if (error > worst) where = kElevations[k];
      worst = std::max(worst, error);
    }
    text << method.name << '\t' << method.setting << '\t' << method.directions << '\t'
         << number("%.3g", 1e6 * report::seconds_of(method.project, stopwatch)) << '\t'
         << number("%.2e", std::sqrt(squares / count)) << '\t' << number("%.2e", worst) << '\t' << where << '\n';
  }
  return text.str();
}

}  // namespace

std::string sky_method_table(double altitude_m) {
  const Atmosphere air = with_ground_albedo(earth_bruneton(), 0.0);
  SkyTableOptions options;
  options.orders = 1;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, options)), altitude_m);
  const SkyProjector converged(view, {3, SkyQuadrature::gauss_split, 128, 128});
  std::vector<SphericalHarmonics> truths;
  std::vector<SphericalHarmonics> integrals;
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    truths.push_back(reference_sky_harmonics(air, altitude_m, sun));
    integrals.push_back(converged.project(sun));
  }
  const std::vector<SkyMethod> methods = report::sky_methods(view);
  std::ostringstream text;
  text << "Nine coefficients of singly scattered light, " << air.name << ", black ground, at " << altitude_m
       << " m: |c - c*| / |c*|, the worst channel, against the truth (the tables' error is in it).\n\n"
       << errors_by_elevation(methods, truths) << "\nThe same against the converged integral of the same view.\n\n"
       << errors_by_elevation(methods, integrals) << '\n'
       << lines_of_tabs(methods, truths);
  return text.str();
}

}  // namespace welkin::perf
