#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <sstream>

#include "benchmarks.h"
#include "reference/path_tracer.h"
#include "reference/sky_reference.h"
#include "welkin/core.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

constexpr std::array<double, 11> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0, -12.0};
constexpr std::size_t kCoefficients = 9;

struct Settings {
  std::int64_t directions = 400;
  std::int64_t paths = 4'000'000;
  double altitude = 0.0;
  std::vector<std::string> sections;
};

struct Section {
  std::string name;
  std::function<std::string(const Settings&)> make;
};

struct Size {
  std::string name;
  SkyTableOptions options;
};

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

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
  const auto words = [](const std::string& what, const SkyTableOptions& o) {
    std::string text = what + " " + std::to_string(o.heights) + " x " + std::to_string(o.view_zeniths);
    if (o.layout == ScatteringLayout::full) text += " x " + std::to_string(o.sun_angles);
    return text + " x " + std::to_string(o.sun_zeniths);
  };
  std::vector<Size> sizes;
  sizes.push_back({words("compact", compact), compact});
  sizes.push_back({words("small", sized(16, 32, 32, 8)), sized(16, 32, 32, 8)});
  sizes.push_back({words("default", usual), usual});
  sizes.push_back({words("large", sized(32, 128, 128, 16)), sized(32, 128, 128, 16)});
  return sizes;
}

/// Evenly over the upper hemisphere: a Fibonacci spiral.
std::vector<glm::dvec3> sky_directions(std::int64_t count) {
  std::vector<glm::dvec3> directions;
  for (std::int64_t i = 0; i < count; ++i) {
    const double y = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double azimuth = 360.0 * static_cast<double>(i) * (std::numbers::phi - 1.0);
    directions.push_back(sun_direction(std::asin(y) * 180.0 / std::numbers::pi, std::fmod(azimuth, 360.0)));
  }
  return directions;
}

glm::dvec3 rgb(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

std::shared_ptr<const SkyTables> tables_of(const Atmosphere& air, SkyTableOptions options, int orders) {
  options.orders = orders;
  return std::make_shared<const SkyTables>(precompute_sky(air, options));
}

/// Singly scattered light of the whole upper hemisphere, table by table: the rms of what is wrong over the rms of the
/// truth, and the largest error of a direction over it.
std::string radiance_table(const Settings& settings) {
  const Atmosphere air = earth_bruneton();
  const std::vector<glm::dvec3> directions = sky_directions(settings.directions);
  std::vector<SkyView> views;
  std::ostringstream text;
  text << "Single scattering, " << air.name << ", " << directions.size() << " directions of the upper hemisphere at "
       << settings.altitude << " m: rms error over rms radiance, and the largest error over it.\n\n"
       << "| sun elevation |";
  std::string rule = "|---|";
  for (const Size& size : table_sizes()) {
    views.emplace_back(tables_of(air, size.options, 1), settings.altitude);
    text << ' ' << size.name << " |";
    rule += "---|";
  }
  text << '\n' << rule << '\n';
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    std::vector<glm::dvec3> truth(directions.size());
    tbb::parallel_for(std::size_t{0}, directions.size(), [&](std::size_t i) {
      truth[i] = rgb(reference_sky_radiance(air, settings.altitude, directions[i], sun));
    });
    text << "| " << elevation << " |";
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
      text << ' ' << number("%.1e", std::sqrt(wrong / all)) << " / " << number("%.0e", largest / rms) << " |";
    }
    text << '\n';
  }
  return text.str();
}

using Harmonics = std::array<glm::dvec3, kCoefficients>;

/// What a view shows, by many places: no slope is left at the horizon and the zenith.
Harmonics project(const SkyView& view, const glm::dvec3& sun) {
  constexpr int zeniths = 96;
  constexpr int azimuths = 128;
  Harmonics result{};
  for (int i = 0; i < 2 * zeniths; ++i) {
    const double u = (i % zeniths + 0.5) / zeniths;
    const double sine = std::sin(0.5 * std::numbers::pi * u);
    const double y = (i < zeniths ? 1.0 : -1.0) * sine * sine;
    const double dy = 0.5 * std::numbers::pi * std::sin(std::numbers::pi * u) / zeniths;
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2.0 * std::numbers::pi * (k + 0.5) / azimuths;
      const double level = std::sqrt((1.0 - y) * (1.0 + y));
      const glm::dvec3 direction(level * std::sin(azimuth), y, level * std::cos(azimuth));
      std::array<double, kCoefficients> basis{};
      evaluate_basis(direction, 3, basis);
      const glm::dvec3 light = view.radiance(direction, sun) * (dy * 2.0 * std::numbers::pi / azimuths);
      for (std::size_t c = 0; c < kCoefficients; ++c) result[c] += basis[c] * light;
    }
  }
  return result;
}

double norm(const Harmonics& values) {
  double sum = 0.0;
  for (const glm::dvec3& value : values) sum += glm::dot(value, value);
  return std::sqrt(sum);
}

struct Traced {
  Harmonics mean{};
  double error = 0.0;  ///< the norm of all standard errors
};

Traced traced(const Atmosphere& air, const Settings& settings, const glm::dvec3& sun, int lowest, int highest) {
  const TracedHarmonics light =
      trace_sky_harmonics(air, settings.altitude, sun, 3,
                          {.lowest_order = lowest, .highest_order = highest, .paths = settings.paths, .seed = 5});
  Traced result;
  double sum = 0.0;
  for (std::size_t c = 0; c < kCoefficients; ++c) {
    result.mean[c] = {light.radiance[0][c], light.radiance[1][c], light.radiance[2][c]};
    for (std::size_t w = 0; w < 3; ++w) sum += light.standard_error[w][c] * light.standard_error[w][c];
  }
  result.error = std::sqrt(sum);
  return result;
}

/// Orders 2 to 4 alone: tables of four orders less those of one. Black ground, so that an order is an order: what a
/// ray sees of lit ground counts one more.
std::string orders_table(const Settings& settings) {
  const Atmosphere air = with_ground_albedo(earth_bruneton(), 0.0);
  const SkyView single(tables_of(air, {}, 1), settings.altitude);
  const SkyView all(tables_of(air, {}, 4), settings.altitude);
  std::ostringstream text;
  text << "Nine coefficients of orders 2 to 4 of the default tables against path tracing (" << settings.paths
       << " paths), " << air.name << ", black ground, at " << settings.altitude
       << " m: |c - c*| / |c*|, the path tracer's own standard error likewise, and the orders' share of all light.\n\n"
       << "| sun elevation | error | standard error | error of all light | share |\n|---|---|---|---|---|\n";
  for (const double elevation : kElevations) {
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    const Harmonics first = project(single, sun);
    const Harmonics sum = project(all, sun);
    const Traced truth = traced(air, settings, sun, 2, 4);
    Harmonics wrong{};
    for (std::size_t c = 0; c < kCoefficients; ++c) wrong[c] = sum[c] - first[c] - truth.mean[c];
    text << "| " << elevation << " | " << number("%.1e", norm(wrong) / norm(truth.mean)) << " | "
         << number("%.1e", truth.error / norm(truth.mean)) << " | " << number("%.1e", norm(wrong) / norm(sum)) << " | "
         << number("%.2f", norm(truth.mean) / norm(sum)) << " |\n";
  }
  return text.str();
}

std::string methods_table(const Settings& settings) { return sky_method_table(settings.altitude); }

std::vector<Section> sections() {
  return {{"--radiance", radiance_table}, {"--orders", orders_table}, {"--methods", methods_table}};
}

[[noreturn]] void refuse(const std::string& option) {
  throw Error(ErrorCode::invalid_argument, "\"" + option + "\" is no option of --sky-errors");
}

Settings parse(const std::vector<std::filesystem::path>& options) {
  Settings settings;
  for (const std::filesystem::path& path : options) {
    const std::string option = path.string();
    const std::size_t equals = option.find('=');
    const std::string name = option.substr(0, equals);
    const auto value = [&] {
      try {
        return std::stod(option.substr(equals + 1));
      } catch (const std::exception&) {
        refuse(option);
      }
    };
    if (equals == std::string::npos) {
      settings.sections.push_back(option);
    } else if (name == "--directions") {
      settings.directions = static_cast<std::int64_t>(value());
    } else if (name == "--paths") {
      settings.paths = static_cast<std::int64_t>(value());
    } else if (name == "--altitude") {
      settings.altitude = value();
    } else {
      refuse(option);
    }
  }
  return settings;
}

}  // namespace

std::string sky_error_tables(const std::vector<std::filesystem::path>& options) {
  const Settings settings = parse(options);
  const std::vector<Section> known = sections();
  for (const std::string& wanted : settings.sections) {
    if (std::none_of(known.begin(), known.end(), [&](const Section& s) { return s.name == wanted; })) refuse(wanted);
  }
  std::string text;
  for (const Section& section : known) {
    const bool wanted = settings.sections.empty() || std::find(settings.sections.begin(), settings.sections.end(),
                                                               section.name) != settings.sections.end();
    if (wanted) text += (text.empty() ? "" : "\n") + section.make(settings);
  }
  return text;
}

}  // namespace welkin::perf
