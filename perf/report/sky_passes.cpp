#include "perf/report/passes.h"
#include "reference/sky_reference.h"
#include "welkin/sky.h"

namespace welkin::report {
namespace {

constexpr const char* kTruth = "single scattering ray by ray in double";
constexpr const char* kErrors =
    "|c - c*| / |c*| of the nine coefficients, the worst channel: root mean square over the sun's elevations, and the "
    "largest.";

Atmosphere air() { return with_ground_albedo(earth_bruneton(), 0.0); }

std::vector<SphericalHarmonics> truths_of(const PassContext& context) {
  const Scale& scale = context.scale;
  ReferenceHarmonicsOptions options;
  options.zeniths = scale.sky_zeniths;
  options.azimuths = scale.sky_azimuths;
  std::vector<SphericalHarmonics> truths;
  for (const double elevation : scale.sun_elevations) {
    truths.push_back(reference_sky_harmonics(air(), 0.0, sun_direction(elevation, 0.0), options));
    progress(context, truths.size(), 2 * scale.sun_elevations.size());
  }
  return truths;
}

ErrorNorms errors_of(const ProjectSky& project, const std::vector<double>& elevations,
                     const std::vector<SphericalHarmonics>& truths) {
  std::vector<ErrorNorms> cases;
  for (std::size_t k = 0; k < elevations.size(); ++k) {
    SphericalHarmonics light(3);
    project(sun_direction(elevations[k], 0.0), light);
    const double error = worst_channel_error(light, truths[k]);
    cases.push_back({error, error});
  }
  return together(cases);
}

/// Returns the seconds of an update, over rising suns.
double seconds_of(const ProjectSky& project, const Stopwatch& stopwatch) {
  constexpr int calls = 64;
  SphericalHarmonics light(3);
  return stopwatch.seconds([&] {
    for (int k = 0; k < calls; ++k) project({0.3, 0.2 + 0.01 * k, 0.8}, light);
  }) / calls;
}

std::vector<Measurement> by_method(const PassContext& context) {
  const std::vector<SphericalHarmonics> truths = truths_of(context);
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(air(), context.scale.sky_tables.back())), 0.0);
  return sky_by_method(sky_methods(view), context.scale.sun_elevations, truths, context.stopwatch);
}

std::vector<Measurement> by_table_size(const PassContext& context) {
  const std::vector<SphericalHarmonics> truths = truths_of(context);
  const std::vector<SkyTableOptions>& sizes = context.scale.sky_tables;
  std::vector<Measurement> all;
  for (const SkyTableOptions& options : sizes) {
    auto tables = std::make_shared<SkyTables>();
    const double seconds = context.stopwatch.seconds([&] { *tables = precompute_sky(air(), options); });
    const SkyProjector projector(SkyView(tables, 0.0), {3, SkyQuadrature::gauss_split, 32, 32});
    const ErrorNorms errors = errors_of(
        [&](const glm::dvec3& sun, SphericalHarmonics& light) { projector.project(sun, light.coefficients()); },
        context.scale.sun_elevations, truths);
    all.push_back(measurement(options.layout == ScatteringLayout::full ? "full" : "compact", size_words(options),
                              errors, seconds, kTruth));
    progress(context, sizes.size() + all.size(), 2 * sizes.size());
  }
  return all;
}

}  // namespace

std::string size_words(const SkyTableOptions& options) {
  const bool full = options.layout == ScatteringLayout::full;
  std::string text = std::to_string(options.heights) + " x " + std::to_string(options.view_zeniths);
  if (full) text += " x " + std::to_string(options.sun_angles);
  return text + " x " + std::to_string(options.sun_zeniths);
}

std::vector<SkyMethod> sky_methods(const SkyView& view) {
  std::vector<SkyMethod> methods;
  const auto add = [&](SkyQuadrature quadrature, int size) {
    const SkyProjector projector(view, {.bands = 3, .quadrature = quadrature, .zeniths = size, .azimuths = size});
    const int rings = quadrature == SkyQuadrature::uniform ? size : 2 * size;
    methods.push_back(
        {welkin::name(quadrature), std::to_string(size) + "x" + std::to_string(size), std::to_string(rings * size * 2),
         [=](const glm::dvec3& sun, SphericalHarmonics& light) { projector.project(sun, light.coefficients()); }});
  };
  for (const int size : {16, 64}) add(SkyQuadrature::uniform, size);
  for (const int size : {8, 16, 32}) add(SkyQuadrature::gauss, size);
  for (const int size : {8, 12, 16, 32}) add(SkyQuadrature::gauss_split, size);
  for (const int nodes : {64, 256, 1024}) {
    const SkyCurve curve(view, {.nodes = nodes});
    methods.push_back({"curve", std::to_string(nodes), "0",
                       [=](const glm::dvec3& sun, SphericalHarmonics& light) { curve.at(sun, light.coefficients()); }});
  }
  return methods;
}

std::vector<Measurement> sky_by_method(const std::vector<SkyMethod>& methods, const std::vector<double>& elevations,
                                       const std::vector<SphericalHarmonics>& truths, const Stopwatch& stopwatch) {
  std::vector<Measurement> all;
  for (const SkyMethod& method : methods) {
    const std::string setting = method.setting + (method.name == "curve" ? " elevations" : " directions");
    all.push_back(measurement(method.name, setting, errors_of(method.project, elevations, truths),
                              seconds_of(method.project, stopwatch), kTruth));
  }
  return all;
}

std::vector<PassRunner> sky_passes() {
  return {{{"sky-harmonics", "Sky to harmonics, by directions",
            "Nine coefficients of a clear sky for a moved sun, from tables at hand: an update. Singly scattered light "
            "of the Earth, black ground, seen from sea level.",
            kErrors},
           5.0,
           by_method},
          {{"sky-tables", "Sky tables by size",
            "Precomputing the tables for one order of scattering. What is measured of them is their nine coefficients "
            "by a fine quadrature (32 x 32).",
            kErrors},
           6.0,
           by_table_size}};
}

}  // namespace welkin::report
