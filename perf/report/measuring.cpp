#include "perf/report/measuring.h"

#include "image/geometry.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::report {
namespace {

constexpr double kShortestSample = 2e-4;  // a hundred times the cost of reading the clock, and above its resolution

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double now(Clock clock) {
  if (clock == Clock::wall) return wall_seconds();
  return processor_seconds();
}

}  // namespace

const char* name(Clock clock) noexcept { return clock == Clock::processor ? "CPU time" : "wall time"; }

double Stopwatch::seconds(const std::function<void()>& work) const {
  double fastest = 0.0;
  run_with_threads(threads, [&] {
    const Clock by = clock();
    const auto sample = [&](int calls) {
      const double start = now(by);
      for (int call = 0; call < calls; ++call) work();
      return (now(by) - start) / calls;
    };
    const double end = wall_seconds() + budget_seconds;
    fastest = sample(1);
    const int calls = static_cast<int>(std::clamp(std::ceil(kShortestSample / std::max(fastest, 1e-9)), 1.0, 1e5));
    double warm = HUGE_VAL;
    // The second run is independent of the wall clock: a busy machine may have used up the budget.
    for (int run = 1; run < most_runs && (wall_seconds() < end || (run == 1 && fastest < budget_seconds)); ++run) {
      warm = std::min(warm, sample(calls));
    }
    if (warm < HUGE_VAL) fastest = warm;
  });
  return fastest;
}

std::optional<double> process_seconds(const std::vector<std::string>& arguments, const Stopwatch& stopwatch) {
  using Steady = std::chrono::steady_clock;
  const Steady::time_point begin = Steady::now();
  double fastest = 0.0;
  for (int run = 0; run < stopwatch.most_runs; ++run) {
    const ProcessResult result = run_process(arguments, stopwatch.threads, stopwatch.clock());
    if (result.exit_code != 0) return std::nullopt;
    fastest = run == 0 ? result.seconds : std::min(fastest, result.seconds);
    if (std::chrono::duration<double>(Steady::now() - begin).count() >= stopwatch.budget_seconds) break;
  }
  return fastest;
}

namespace {

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#elif defined(__GNUC__)
  return "GCC " __VERSION__;
#else
  return "a compiler of no name";
#endif
}

/// Returns the current time in UTC: "2026-11-25T03:00:00Z".
std::string date() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto day = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(now - day);
  const auto two = [](auto number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  return std::to_string(static_cast<int>(date.year())) + '-' + two(static_cast<unsigned>(date.month())) + '-' +
         two(static_cast<unsigned>(date.day())) + 'T' + two(time.hours().count()) + ':' + two(time.minutes().count()) +
         ':' + two(time.seconds().count()) + 'Z';
}

}  // namespace

Machine this_machine(const Stopwatch& stopwatch) {
  return {processor_name(),
          compiler(),
          welkin::name(active_instruction_set()),
          WELKIN_VERSION_STRING,
          name(stopwatch.clock()),
          date(),
          stopwatch.threads};
}

std::string number(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string percent(double share) {
  if (std::isnan(share)) return "no number";
  const double value = 100.0 * share;
  const double size = std::abs(value);
  if (size == 0.0) return "0 %";
  if (size < 1e-3) return number("%.1e %%", value);
  return number(size < 9.95 ? "%.2g %%" : "%.0f %%", value);
}

std::string duration(double seconds) {
  if (std::isnan(seconds)) return "no number";
  if (seconds < 0.9995e-6) return number("%.3g ns", 1e9 * seconds);
  if (seconds < 0.9995e-3) return number("%.3g us", 1e6 * seconds);
  if (seconds < 0.9995) return number("%.3g ms", 1e3 * seconds);
  return number("%.3g s", seconds);
}

namespace {

constexpr int kNormals = 256;

/// Returns one of `kNormals` normals, uniform over the sphere: a Fibonacci spiral.
glm::dvec3 normal(int index) {
  const double y = 1.0 - (2.0 * index + 1.0) / kNormals;
  const double azimuth = 2.0 * std::numbers::pi * index * (std::numbers::phi - 1.0);
  const double level = std::sqrt(1.0 - y * y);
  return {level * std::sin(azimuth), y, level * std::cos(azimuth)};
}

}  // namespace

double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double difference = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
    const glm::dvec3 d = found.coefficients()[k] - truth.coefficients()[k];
    difference += glm::dot(d, d);
    total += glm::dot(truth.coefficients()[k], truth.coefficients()[k]);
  }
  return std::sqrt(difference / total);
}

double worst_channel_error(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    double difference = 0.0;
    double total = 0.0;
    for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
      const double expected = truth.coefficients()[k][channel];
      const double off = found.coefficients()[k][channel] - expected;
      difference += off * off;
      total += expected * expected;
    }
    worst = std::max(worst, std::sqrt(difference / total));
  }
  return worst;
}

ErrorNorms harmonic_errors(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(found);
  const SphericalHarmonics expected = irradiance_from_radiance(truth);
  double largest = 0.0;
  double squares = 0.0;
  for (int k = 0; k < kNormals; ++k) {
    const glm::dvec3 true_value = evaluate(expected, normal(k));
    largest = std::max(largest, glm::length(evaluate(irradiance, normal(k)) - true_value));
    squares += glm::dot(true_value, true_value);
  }
  return {relative_error(found, truth), largest / std::sqrt(squares / kNormals)};
}

double rms_of_irradiance(const SphericalHarmonics& radiance) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  double squares = 0.0;
  for (const glm::dvec3& value : irradiance.coefficients()) squares += glm::dot(value, value);
  return std::sqrt(squares / (4.0 * std::numbers::pi));
}

ErrorNorms relative_errors(std::span<const float> found, std::span<const float> given) {
  constexpr double floor = 1.0 / 16384.0;
  constexpr double largest_half = 65504.0;
  double squares = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const double value = std::clamp(static_cast<double>(given[k]), 0.0, largest_half);
    const double error = std::abs(static_cast<double>(found[k]) - value) / std::max(value, floor);
    squares += error * error;
    largest = std::max(largest, error);
  }
  return {std::sqrt(squares / static_cast<double>(given.size())), largest};
}

ErrorNorms together(std::span<const ErrorNorms> cases) {
  ErrorNorms all;
  for (const ErrorNorms& one : cases) {
    all.rms += one.rms * one.rms / static_cast<double>(cases.size());
    all.maximum = std::max(all.maximum, one.maximum);
  }
  return {std::sqrt(all.rms), all.maximum};
}

namespace {

constexpr double kFloor = 1e-6;

/// Returns the solid angle up to a constant factor.
double solid_angle(std::int64_t texel, int size) {
  const double u = (2.0 * static_cast<double>(texel % size) + 1.0) / size - 1.0;
  const double v = (2.0 * static_cast<double>(texel / size % size) + 1.0) / size - 1.0;
  return std::pow(1.0 + u * u + v * v, -1.5);
}

}  // namespace

std::vector<Probe> probes_of(const Cubemap& chain, int level, int count, std::mt19937& random) {
  const int size = chain.level_size(level);
  const std::int64_t texels = std::int64_t{6} * size * size;
  std::vector<Probe> probes;
  if (texels <= count + 16) {
    for (std::int64_t k = 0; k < texels; ++k) probes.push_back({k, solid_angle(k, size)});
    return probes;
  }
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t first = texels * k / count;
    const std::int64_t length = texels * (k + 1) / count - first;
    const std::int64_t texel = first + static_cast<std::int64_t>(random()) % length;
    probes.push_back({texel, solid_angle(texel, size)});
  }
  const float* const rgb = chain.face(level, 0);
  std::vector<std::int64_t> order(static_cast<std::size_t>(texels));
  std::iota(order.begin(), order.end(), std::int64_t{0});
  const auto less = [&](std::int64_t a, std::int64_t b) { return rgb[3 * a + 1] < rgb[3 * b + 1]; };
  std::nth_element(order.begin(), order.begin() + 8, order.end(), less);
  for (int k = 0; k < 8; ++k) probes.push_back({order[static_cast<std::size_t>(k)], 0.0});
  std::nth_element(order.begin(), order.end() - 8, order.end(), less);
  for (int k = 1; k <= 8; ++k) probes.push_back({*(order.end() - k), 0.0});
  return probes;
}

std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size) {
  std::vector<glm::dvec3> directions;
  directions.reserve(probes.size());
  for (const Probe& probe : probes) {
    const auto face = static_cast<int>(probe.texel / (std::int64_t{size} * size));
    const auto column = static_cast<double>(probe.texel % size);
    const auto row = static_cast<double>(probe.texel / size % size);
    directions.push_back(image::face_direction(size, face, column + 0.5, row + 0.5));
  }
  return directions;
}

ProbeErrors errors_at(const Cubemap& chain, int level, const std::vector<Probe>& probes,
                      const std::vector<glm::dvec3>& truth, const glm::dvec3& mean) {
  const float* const rgb = chain.face(level, 0);
  double squares = 0.0;
  double whole = 0.0;
  ProbeErrors errors;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(static_cast<double>(rgb[3 * probes[k].texel + c]) - truth[k][c]);
      squares += probes[k].weight * error * error;
      whole += probes[k].weight * truth[k][c] * truth[k][c];
      const double relative = error / std::max(truth[k][c], kFloor * mean[c]);
      if (relative > errors.norms.maximum) {
        errors.norms.maximum = relative;
        errors.truth_there = truth[k][c] / mean[c];
      }
    }
  }
  errors.norms.rms = std::sqrt(squares / whole);
  return errors;
}

}  // namespace welkin::report
