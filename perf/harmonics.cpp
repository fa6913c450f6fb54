// Small calls on coefficients, which engines make by the thousand.
#include "perf.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

SphericalHarmonics light_of(int bands, double turn) {
  SphericalHarmonics light(bands);
  double angle = turn;
  for (dvec3& value : light.coefficients()) {
    angle += 1.7;
    value = {std::cos(angle), std::cos(2.0 * angle), std::cos(3.0 * angle)};
  }
  return light;
}

std::vector<dvec3> directions(int count) {
  std::vector<dvec3> result;
  for (int k = 0; k < count; ++k) result.push_back(sun_direction(180.0 * (k + 0.5) / count - 90.0, 137.50776 * k));
  return result;
}

/// Calls of less than a microsecond run a thousand times an iteration, so that nothing but they is timed: then the
/// figure's milliseconds are their microseconds.
constexpr int kThousand = 1000;

void add(const std::string& variant, int bands, std::function<void()> body) {
  add_benchmark("Harmonics", variant, std::to_string(bands), 1, kThousand, 0.0,
                [body = std::move(body)]() -> std::function<void()> { return body; });
}

}  // namespace

void add_harmonics() {
  for (const int bands : {3, 4, 6, 10}) {
    const SphericalHarmonics a = light_of(bands, 0.1);
    const SphericalHarmonics b = light_of(bands, 0.2);
    const Quaternion turn{0.9, 0.1, -0.3, 0.2};
    add("product-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(product(a, b, a.bands()));
    });
    add("turned-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(turned(a, turn));
    });
    add("evaluate-1000", bands, [=, towards = directions(kThousand), values = std::vector<dvec3>(kThousand)]() mutable {
      evaluate(a, towards, values);
      benchmark::DoNotOptimize(values.data());
    });
    add("evaluate-one-by-one-1000", bands, [=, towards = directions(kThousand)] {
      for (const dvec3& direction : towards) benchmark::DoNotOptimize(evaluate(a, direction));
    });
  }
  add_benchmark("Harmonics", "sky-curve-1000", "3", 1, kThousand, 0.0, []() -> std::function<void()> {
    const auto curve = std::make_shared<const SkyCurve>(SkyView(earth_tables(), 0.0), SkyCurveOptions{});
    return [curve] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(curve->at(sun_direction(0.09 * k, 30.0)));
    };
  });
}

}  // namespace welkin::perf
