#include "math/quadrature.h"
#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::report {
namespace {

constexpr int kOrder = 12;
constexpr double kRightAngle = std::numbers::pi / 2.0;

/// Adds cuts of [from, to] that get finer towards `centre`, down to `width`: 0, 1, 2, 4 ... widths from it.
void cut_towards(double centre, double width, double from, double to, std::vector<double>& cuts) {
  for (double distance = width; distance < 4.0; distance *= 2.0) {
    for (const double cut : {centre - distance, centre, centre + distance}) {
      if (cut > from && cut < to) cuts.push_back(cut);
    }
  }
}

std::vector<double> sorted(std::vector<double> cuts, double from, double to) {
  cuts.push_back(from);
  cuts.push_back(to);
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

template <class Function>
void integrate(const std::vector<double>& cuts, const Function& function) {
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  for (std::size_t panel = 0; panel + 1 < cuts.size(); ++panel) {
    const double half = 0.5 * (cuts[panel + 1] - cuts[panel]);
    for (int i = 0; i < kOrder; ++i) {
      function(cuts[panel] + half * (1.0 + rule.nodes[i]), half * rule.weights[i]);
    }
  }
}

struct Geometry {
  double normal_light;
  double view_half;
  double slope2;  ///< of the half vector, squared
};

/// Angles are elevations above the horizon, so that small ones keep their precision.
Geometry geometry(double view_elevation, double light_elevation, double azimuth) {
  const double x = std::cos(view_elevation) + std::cos(light_elevation) * std::cos(azimuth);
  // cos a - cos b as a product keeps precision in the mirror direction.
  const double across = std::cos(light_elevation) * std::sin(azimuth);
  const double z = std::sin(view_elevation) + std::sin(light_elevation);
  const double length2 = x * x + across * across + z * z;
  return {std::sin(light_elevation), 0.5 * std::sqrt(length2), (x * x + across * across) / (z * z)};
}

/// Here azimuth 0 is the mirror direction.
Geometry mirrored_geometry(double view_elevation, double light_elevation, double azimuth) {
  const double half_azimuth = std::sin(0.5 * azimuth);
  const double x =
      -2.0 * std::sin(0.5 * (view_elevation + light_elevation)) * std::sin(0.5 * (view_elevation - light_elevation)) +
      2.0 * std::cos(light_elevation) * half_azimuth * half_azimuth;
  const double across = std::cos(light_elevation) * std::sin(azimuth);
  const double z = std::sin(view_elevation) + std::sin(light_elevation);
  const double length2 = x * x + across * across + z * z;
  return {std::sin(light_elevation), 0.5 * std::sqrt(length2), (x * x + across * across) / (z * z)};
}

}  // namespace

BrdfTruth ggx_truth(double normal_view, double alpha) {
  const double view = std::asin(normal_view);
  const double alpha2 = alpha * alpha;
  const double narrow = 0.25 * alpha * std::min(1.0, normal_view + alpha);  // the lobe's width at grazing angles
  std::vector<double> elevations;
  cut_towards(view, narrow, 0.0, kRightAngle, elevations);
  cut_towards(0.0, 0.25 * std::min(alpha, normal_view), 0.0, kRightAngle, elevations);
  std::vector<double> azimuths;
  cut_towards(0.0, narrow, 0.0, std::numbers::pi, azimuths);
  elevations = sorted(elevations, 0.0, kRightAngle);
  azimuths = sorted(azimuths, 0.0, std::numbers::pi);
  BrdfTruth sum{0.0, 0.0};
  integrate(elevations, [&](double light, double light_weight) {
    integrate(azimuths, [&](double azimuth, double azimuth_weight) {
      const Geometry g = mirrored_geometry(view, light, azimuth);
      const double bracket = (alpha2 + g.slope2) / (1.0 + g.slope2);
      const double density = alpha2 / (std::numbers::pi * bracket * bracket);
      const double smith = g.normal_light * std::sqrt(normal_view * normal_view * (1.0 - alpha2) + alpha2) +
                           normal_view * std::sqrt(g.normal_light * g.normal_light * (1.0 - alpha2) + alpha2);
      const double fresnel = std::pow(1.0 - g.view_half, 5.0);
      const double value =
          2.0 * azimuth_weight * light_weight * std::cos(light) * density * (0.5 / smith) * g.normal_light;
      sum.scale += value * (1.0 - fresnel);
      sum.bias += value * fresnel;
    });
  });
  return sum;
}

double sheen_truth(double normal_view, double alpha) {
  const double view = std::asin(normal_view);
  const double power = 1.0 / alpha;
  const double fine = 0.02 * std::min(normal_view, std::sqrt(alpha));
  std::vector<double> elevations;
  cut_towards(0.0, fine, 0.0, kRightAngle, elevations);
  std::vector<double> azimuths;
  cut_towards(std::numbers::pi, 0.1 * fine, 0.0, std::numbers::pi, azimuths);  // where view and light oppose
  elevations = sorted(elevations, 0.0, kRightAngle);
  azimuths = sorted(azimuths, 0.0, std::numbers::pi);
  double sum = 0.0;
  integrate(elevations, [&](double light, double light_weight) {
    integrate(azimuths, [&](double azimuth, double azimuth_weight) {
      const Geometry g = geometry(view, light, azimuth);
      // sin^2 = slope^2 / (1 + slope^2)
      const double density =
          (2.0 + power) / (2.0 * std::numbers::pi) * std::exp(-0.5 * power * std::log1p(1.0 / g.slope2));
      const double visibility = 0.25 / (g.normal_light + normal_view - g.normal_light * normal_view);
      sum += 2.0 * azimuth_weight * light_weight * std::cos(light) * density * visibility * g.normal_light;
    });
  });
  return sum;
}

namespace {

constexpr const char* kTableTruth = "a finer table's texels, each within 1e-5";
constexpr int kRuns = 3;

/// Two channels of a table, for lookups as a shader makes them.
struct Lookup {
  const float* values;
  int width, height, channels;

  [[nodiscard]] double at(int column, int row, int channel) const {
    const int x = std::clamp(column, 0, width - 1);
    const int y = std::clamp(row, 0, height - 1);
    return static_cast<double>(values[(static_cast<std::ptrdiff_t>(y) * width + x) * channels + channel]);
  }

  /// Returns the bilinear value, clamped to the edge; both coordinates are in [0, 1].
  [[nodiscard]] double linear(double across, double down, int channel) const {
    const double x = across * width - 0.5;
    const double y = down * height - 0.5;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    const double right = x - column;
    const double below = y - row;
    return (1.0 - below) * ((1.0 - right) * at(column, row, channel) + right * at(column + 1, row, channel)) +
           below * ((1.0 - right) * at(column, row + 1, channel) + right * at(column + 1, row + 1, channel));
  }
};

Lookup lookup(const BrdfTable& table) {
  return {table.values.data(), table.options.width, table.options.height, table.channels};
}

ErrorNorms errors_of(const Lookup& table, const BrdfTable& truth) {
  const Lookup exact = lookup(truth);
  double squares = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  for (int row = 0; row < exact.height; ++row) {
    for (int column = 0; column < exact.width; ++column) {
      for (int channel = 0; channel < 2; ++channel) {
        const double expected = exact.at(column, row, channel);
        const double error = table.linear((column + 0.5) / exact.width, (row + 0.5) / exact.height, channel) - expected;
        squares += error * error;
        whole += expected * expected;
        largest = std::max(largest, std::abs(error));
      }
    }
  }
  return {std::sqrt(squares / whole), largest};
}

/// Computed tables stay in memory, so repeats are of tables a column or two wider, their time in proportion.
double seconds_of(BrdfTableOptions options, const Stopwatch& stopwatch) {
  Stopwatch once = stopwatch;
  once.most_runs = 1;
  const int width = options.width;
  double fastest = HUGE_VAL;
  for (int run = 1; run <= kRuns; ++run) {
    options.width = width + run;
    fastest = std::min(fastest, once.seconds([&] { (void)brdf_table(options); }) * width / options.width);
  }
  return fastest;
}

std::vector<Measurement> by_size(const PassContext& context, BrdfModel model) {
  const int fine = context.scale.table_truth;
  std::vector<int> sizes;
  for (int size = 8; size <= context.scale.largest_table; size *= 2) sizes.push_back(size);
  const auto truth = brdf_table({fine, fine, model, false});
  std::vector<Measurement> all;
  for (const int size : sizes) {
    const BrdfTableOptions options{size, size, model, false};
    const ErrorNorms errors = errors_of(lookup(*brdf_table(options)), *truth);
    all.push_back(
        measurement("table", square_words(size), errors, seconds_of(options, context.stopwatch), kTableTruth));
    progress(context, all.size(), sizes.size() + 1);
  }
  if (model != BrdfModel::multiple_scattering) return all;
  add_peers(all, context.peers.brdf_table(sizes), kTableTruth, [&](const PeerTable& found) {
    return errors_of({found.values.data(), found.size, found.size, 3}, *truth);
  });
  return all;
}

PassRunner runner(const char* id, const char* title, const char* holds, BrdfModel model) {
  return {{id, title,
           std::string("A table of ") + holds +
               ", without sheen and without a cache. The error is that of linear lookups. For cmgen, the time is that "
               "of the "
               "whole process.",
           "rms: rms of the difference over that of the reference. Maximum: largest difference."},
          1.0,
          [model](const PassContext& context) { return by_size(context, model); }};
}

}  // namespace

std::string square_words(int size) { return std::to_string(size) + " x " + std::to_string(size); }

std::vector<PassRunner> brdf_passes() {
  return {runner("brdf-split-sum", "BRDF table, split sum", "scale and bias", BrdfModel::split_sum),
          runner("brdf-multiple", "BRDF table, multiple scattering", "bias and whole albedo",
                 BrdfModel::multiple_scattering)};
}

}  // namespace welkin::report
