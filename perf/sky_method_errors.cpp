#include "sky_method_errors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <vector>

#include "sky/sky_geometry.h"
#include "sky/sky_quadrature.h"
#include "sky_subjects.h"
#include "welkin/sky_reference.h"

namespace welkin::perf {
namespace {

constexpr std::array<double, 12> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0, -9.0, -12.0};
constexpr double kLastPromised = -6.0;

using Project = std::function<void(const glm::dvec3& sun, SphericalHarmonics& light)>;

struct Method {
  std::string name, setting, directions;
  Project project;
};

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// The truth, ray by ray, by a quadrature of 40 x 32 on either side of the horizon.
SphericalHarmonics reference(const Atmosphere& air, double altitude_m, const glm::dvec3& sun) {
  const double horizon = sky::horizon_cosine(air.bottom_radius_m, altitude_m);
  const sky::SkyRule rule = sky::sky_rule({.zeniths = 40, .azimuths = 32}, horizon, 1.0, air.aerosol_asymmetry);
  std::vector<SphericalHarmonics> rings;
  std::vector<std::array<double, 3>> places;  // cosine, sine, weight
  for (const sky::RingRule* side : {&rule.above, &rule.below}) {
    for (std::size_t k = 0; k < side->cosines.size(); ++k) {
      places.push_back({side->cosines[k], side->sines[k], side->weights[k]});
      rings.emplace_back(3);
    }
  }
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t k) {
    std::array<double, 9> basis{};
    for (std::size_t i = 0; i < rule.azimuths.cosines.size(); ++i) {
      const double sine = std::sqrt(rule.azimuths.from_sun[i] * rule.azimuths.from_opposite[i]);
      const glm::dvec3 ahead(0.0, places[k][0], places[k][1] * rule.azimuths.cosines[i]);
      const glm::dvec3 aside(places[k][1] * sine, 0.0, 0.0);
      const std::vector<double> light = reference_sky_radiance(air, altitude_m, ahead + aside, sun);
      for (const glm::dvec3& direction : {ahead + aside, ahead - aside}) {
        evaluate_basis(direction, 3, basis);
        const double weight = 0.5 * places[k][2] * rule.azimuths.weights[i];
        for (std::size_t c = 0; c < 9; ++c) {
          rings[k].coefficients()[c] += weight * basis[c] * glm::dvec3(light[0], light[1], light[2]);
        }
      }
    }
  });
  SphericalHarmonics sum(3);
  for (const SphericalHarmonics& ring : rings) {
    for (std::size_t c = 0; c < 9; ++c) sum.coefficients()[c] += ring.coefficients()[c];
  }
  return sum;
}

/// |c - c*| / |c*|, the worst channel.
double error_of(const SphericalHarmonics& light, const SphericalHarmonics& truth) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t c = 0; c < 9; ++c) {
      const double expected = truth.coefficients()[c][channel];
      const double off = light.coefficients()[c][channel] - expected;
      difference += off * off;
      size += expected * expected;
    }
    worst = std::max(worst, std::sqrt(difference / size));
  }
  return worst;
}

/// The best of some runs, microseconds.
double time_of(const Project& project) {
  using Clock = std::chrono::steady_clock;
  SphericalHarmonics light(3);
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 30; ++run) {
    constexpr int calls = 64;
    const Clock::time_point start = Clock::now();
    for (int k = 0; k < calls; ++k) project({0.3, 0.2 + 0.01 * k, 0.8}, light);
    best = std::min(best, std::chrono::duration<double, std::micro>(Clock::now() - start).count() / calls);
  }
  return best;
}

std::vector<Method> methods_of(const SkyView& view) {
  std::vector<Method> methods;
  for (const SkyMethod& method : sky_methods()) {
    const SkyProjector projector(view, method.options);
    methods.push_back(
        {method.name, method.setting, method.directions,
         [=](const glm::dvec3& sun, SphericalHarmonics& light) { projector.project(sun, light.coefficients()); }});
  }
  for (const int nodes : {64, 256, 1024}) {
    const SkyCurve curve(view, {.nodes = nodes});
    methods.push_back({"curve", std::to_string(nodes), "0",
                       [=](const glm::dvec3& sun, SphericalHarmonics& light) { curve.at(sun, light.coefficients()); }});
  }
  return methods;
}

std::string errors_by_elevation(const std::vector<Method>& methods, const std::vector<SphericalHarmonics>& truths) {
  std::ostringstream text;
  text << "| sun elevation |";
  for (const Method& method : methods) text << ' ' << method.name << ' ' << method.setting << " |";
  text << "\n|---|";
  for (std::size_t k = 0; k < methods.size(); ++k) text << "---|";
  text << '\n';
  for (std::size_t k = 0; k < kElevations.size(); ++k) {
    text << "| " << kElevations[k] << " |";
    for (const Method& method : methods) {
      SphericalHarmonics light(3);
      method.project(sun_direction(kElevations[k], 0.0), light);
      text << ' ' << number("%.1e", error_of(light, truths[k])) << " |";
    }
    text << '\n';
  }
  return text.str();
}

std::string lines_of_tabs(const std::vector<Method>& methods, const std::vector<SphericalHarmonics>& truths) {
  std::ostringstream text;
  text << "# method\tsetting\tdirections\tmicroseconds\trms\tworst\tworst elevation, from 90 to -6 degrees\n";
  for (const Method& method : methods) {
    double squares = 0.0;
    double worst = 0.0;
    double where = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < kElevations.size() && kElevations[k] >= kLastPromised; ++k, ++count) {
      SphericalHarmonics light(3);
      method.project(sun_direction(kElevations[k], 0.0), light);
      const double error = error_of(light, truths[k]);
      squares += error * error;
      if (error > worst) where = kElevations[k];
      worst = std::max(worst, error);
    }
    text << method.name << '\t' << method.setting << '\t' << method.directions << '\t'
         << number("%.3g", time_of(method.project)) << '\t' << number("%.2e", std::sqrt(squares / count)) << '\t'
         << number("%.2e", worst) << '\t' << where << '\n';
  }
  return text.str();
}

}  // namespace

std::string sky_method_table(double altitude_m) {
  const Atmosphere air = with_ground_albedo(earth(), 0.0);
  SkyTableOptions options;
  options.orders = 1;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air, options)), altitude_m);
  const SkyProjector converged(view, {3, SkyQuadrature::gauss_split, 128, 128});
  std::vector<SphericalHarmonics> truths;
  std::vector<SphericalHarmonics> integrals;
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    truths.push_back(reference(air, altitude_m, sun));
    integrals.push_back(converged.project(sun));
  }
  const std::vector<Method> methods = methods_of(view);
  std::ostringstream text;
  text << "Nine coefficients of singly scattered light, " << air.name << ", black ground, at " << altitude_m
       << " m: |c - c*| / |c*|, the worst channel, against the truth (the tables' error is in it).\n\n"
       << errors_by_elevation(methods, truths) << "\nThe same against the converged integral of the same view.\n\n"
       << errors_by_elevation(methods, integrals) << '\n'
       << lines_of_tabs(methods, truths);
  return text.str();
}

}  // namespace welkin::perf
