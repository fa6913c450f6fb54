#include "welkin/sky.h"

#include <tbb/parallel_for.h>

#include "perf.h"
#include "perf/report/passes.h"
#include "reference/sky_reference.h"
#include "sky/table_sizes.h"
#include "welkin/bake.h"

namespace welkin::perf {

void add_sky_tables() {
  SkyTableOptions full;
  full.orders = 4;
  SkyTableOptions compact = full;
  compact.layout = ScatteringLayout::compact;
  compact.sun_zeniths = 32;
  for (const auto& [variant, options] : {std::pair{"full", full}, {"compact", compact}}) {
    add_benchmark(
        "SkyTables", variant, "4", kThreadCounts, static_cast<double>(sky::scattering_texels(options)), 0.0,
        [options = options] { return [=] { benchmark::DoNotOptimize(precompute_sky(earth_bruneton(), options)); }; });
  }
  // Alternates between more and less haze: the tables that it does not affect are kept.
  add_benchmark("SkyTables", "compact-haze", "4", kThreadCounts, 1.0, 0.0, [compact] {
    return [compact, more = false]() mutable {
      more = !more;
      Atmosphere air = earth_bruneton();
      for (double& value : air.aerosol.scattering_per_m) value *= more ? 1.5 : 1.0;
      benchmark::DoNotOptimize(precompute_sky(air, compact));
    };
  });
}

void add_sky_specular() {
  constexpr double texels = 6.0 * 32.0 * 32.0;
  add_benchmark("SkySpecular", "no_disc", "32", kThreadCounts, texels, 12.0 * texels, [] {
    const auto view = std::make_shared<const SkyView>(earth_tables(), 0.0);
    return [=] { benchmark::DoNotOptimize(sky_specular(*view, sun_direction(20.0, 30.0), {.size = 32})); };
  });
}

namespace {

using report::SkyMethod;

constexpr std::array<double, 12> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0, -9.0, -12.0};
constexpr double kLastPromised = -6.0;

struct Settings {
  int directions;
  double altitude;
};

struct Size {
  std::string name;
  SkyTableOptions options;
};

std::vector<Size> table_sizes() {
  const auto sized = [](int heights, int views, int suns, int angles) {
    SkyTableOptions options;
    options.heights = heights;
    options.view_zeniths = views;
    options.sun_zeniths = suns;
    options.sun_angles = angles;
    return options;
  };
  const SkyTableOptions usual;
  SkyTableOptions compact = sized(32, 64, 32, usual.sun_angles);
  compact.layout = ScatteringLayout::compact;
  std::vector<Size> sizes;
  for (const auto& [name, options] : {std::pair{"compact", compact},
                                      {"small", sized(16, 32, 32, 8)},
                                      {"default", usual},
                                      {"large", sized(32, 128, 128, 16)}}) {
    sizes.push_back({name + (' ' + report::size_words(options)), options});
  }
  return sizes;
}

/// Returns directions uniform over the upper hemisphere: a Fibonacci spiral.
std::vector<glm::dvec3> sky_directions(int count) {
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 360.0 * i * (std::numbers::phi - 1.0);
    directions.push_back(
        sun_direction(std::asin((i + 0.5) / count) * 180.0 / std::numbers::pi, std::fmod(azimuth, 360.0)));
  }
  return directions;
}

std::shared_ptr<const SkyTables> tables_of(const Atmosphere& air, SkyTableOptions options, int orders) {
  options.orders = orders;
  return std::make_shared<const SkyTables>(precompute_sky(air, options));
}

/// Returns the errors of singly scattered light of the whole upper hemisphere, table by table: the rms error relative
/// to the reference's rms, and the largest error of a direction relative to it.
std::string radiance_table(const Settings& settings) {
  const Atmosphere air = earth_bruneton();
  const std::vector<glm::dvec3> directions = sky_directions(settings.directions);
  std::vector<SkyView> views;
  std::vector<std::string> heads{"sun elevation"};
  for (const Size& size : table_sizes()) {
    views.emplace_back(tables_of(air, size.options, 1), settings.altitude);
    heads.push_back(size.name);
  }
  Table table(heads);
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    std::vector<glm::dvec3> truth(directions.size());
    tbb::parallel_for(std::size_t{0}, directions.size(), [&](std::size_t i) {
      const std::vector<double> light = reference_sky_radiance(air, settings.altitude, directions[i], sun);
      truth[i] = {light[0], light[1], light[2]};
    });
    std::vector<std::string> cells{number("%g", elevation)};
    for (const SkyView& view : views) {
      double wrong = 0.0;
      double all = 0.0;
      double largest = 0.0;
      for (std::size_t i = 0; i < directions.size(); ++i) {
        const double error = glm::length(view.radiance(directions[i], sun) - truth[i]);
        wrong += error * error;
        all += glm::dot(truth[i], truth[i]);
        largest = std::max(largest, error);
      }
      const double rms = std::sqrt(all / static_cast<double>(directions.size()));
      cells.push_back(number("%.1e", std::sqrt(wrong / all)) + " / " + number("%.0e", largest / rms));
    }
    table.add(cells);
  }
  return "Single scattering, " + air.name + ", " + std::to_string(directions.size()) +
         " directions of the upper hemisphere at " + number("%g", settings.altitude) +
         " m: rms error over rms radiance, and the largest error over it.\n\n" + table.text();
}

/// Returns a projector with enough directions for a negligible error of the integral.
SkyProjector converged(const SkyView& view) { return SkyProjector(view, {3, SkyQuadrature::gauss_split, 128, 128}); }

std::string errors_by_elevation(const std::vector<SkyMethod>& methods, const std::vector<SphericalHarmonics>& truths) {
  std::vector<std::string> heads{"sun elevation"};
  for (const SkyMethod& method : methods) heads.push_back(method.name + ' ' + method.setting);
  Table table(heads);
  for (std::size_t k = 0; k < kElevations.size(); ++k) {
    std::vector<std::string> cells{number("%g", kElevations[k])};
    for (const SkyMethod& method : methods) {
      SphericalHarmonics light(3);
      method.project(sun_direction(kElevations[k], 0.0), light);
      cells.push_back(number("%.1e", report::worst_channel_error(light, truths[k])));
    }
    table.add(cells);
  }
  return table.text();
}

std::string lines_of_tabs(const std::vector<SkyMethod>& methods, const std::vector<SphericalHarmonics>& truths) {
  std::vector<double> elevations(kElevations.begin(), kElevations.end());
  std::erase_if(elevations, [](double elevation) { return elevation < kLastPromised; });
  const auto found = report::sky_by_method(methods, elevations, truths, report::Stopwatch());
  std::string text = "# method\tsetting\tdirections\tmicroseconds\trms\tworst, from 90 to -6 degrees\n";
  for (std::size_t k = 0; k < methods.size(); ++k) {
    text += methods[k].name + '\t' + methods[k].setting + '\t' + methods[k].directions +
            number("\t%.3g", 1e6 * found[k].seconds) + number("\t%.2e", found[k].error_rms) +
            number("\t%.2e\n", found[k].error_maximum);
  }
  return text;
}

std::string methods_table(const Settings& settings) {
  const Atmosphere air = with_ground_albedo(earth_bruneton(), 0.0);
  const SkyView view(tables_of(air, {}, 1), settings.altitude);
  const SkyProjector exact = converged(view);
  std::vector<SphericalHarmonics> truths;
  std::vector<SphericalHarmonics> integrals;
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    truths.push_back(reference_sky_harmonics(air, settings.altitude, sun));
    integrals.push_back(exact.project(sun));
  }
  const std::vector<SkyMethod> methods = report::sky_methods(view);
  return "Nine coefficients of singly scattered light, " + air.name + ", black ground, at " +
         number("%g", settings.altitude) +
         " m: |c - c*| / |c*|, the worst channel, against the truth (the tables' error is in it).\n\n" +
         errors_by_elevation(methods, truths) + "\nThe same against the converged integral of the same view.\n\n" +
         errors_by_elevation(methods, integrals) + '\n' + lines_of_tabs(methods, truths);
}

}  // namespace

std::string sky_error_tables(const Paths& words) {
  const Arguments arguments(words, {"--radiance", "--methods", "--directions", "--altitude"});
  const Settings settings{arguments.count("--directions", 400), arguments.value("--altitude", 0.0)};
  const std::pair<const char*, std::string (*)(const Settings&)> sections[] = {{"--radiance", radiance_table},
                                                                               {"--methods", methods_table}};
  const bool all = std::none_of(std::begin(sections), std::end(sections),
                                [&](const auto& section) { return arguments.has(section.first); });
  std::string text;
  for (const auto& [option, table] : sections) {
    if (all || arguments.has(option)) text += (text.empty() ? "" : "\n") + table(settings);
  }
  return text;
}

}  // namespace welkin::perf
