// Small calls on coefficients, which engines make by the thousand.
#include "perf.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

SphericalHarmonics light_of(int bands, double rotation) {
  SphericalHarmonics light(bands);
  double angle = rotation;
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

/// A channel's nine coefficients rotated in float, by the matrix of each band with band 2's in closed form: what
/// DirectXMath's XMSHRotate does for three bands. Rebuilt from its method, as no package has it; only its time is
/// compared.
void rotate_as_directxmath(const std::array<std::array<float, 3>, 3>& r, const float* in, float* out) {
  const auto& [rx, ry, rz] = r;
  out[0] = in[0];
  out[1] = ry[1] * in[1] + ry[2] * in[2] + ry[0] * in[3];
  out[2] = rz[1] * in[1] + rz[2] * in[2] + rz[0] * in[3];
  out[3] = rx[1] * in[1] + rx[2] * in[2] + rx[0] * in[3];
  constexpr float root3 = 1.7320508F;
  constexpr float half = 0.5F;
  const auto squares = [](const auto& a) { return a[0] * a[0] - a[1] * a[1]; };
  const float matrix[5][5] = {
      {rx[0] * ry[1] + rx[1] * ry[0], rx[1] * ry[2] + rx[2] * ry[1], root3 * rx[2] * ry[2],
       rx[0] * ry[2] + rx[2] * ry[0], rx[0] * ry[0] - rx[1] * ry[1]},
      {ry[0] * rz[1] + ry[1] * rz[0], ry[1] * rz[2] + ry[2] * rz[1], root3 * ry[2] * rz[2],
       ry[0] * rz[2] + ry[2] * rz[0], ry[0] * rz[0] - ry[1] * rz[1]},
      {(2.0F * rz[0] * rz[1] - rx[0] * rx[1] - ry[0] * ry[1]) / root3,
       (2.0F * rz[1] * rz[2] - rx[1] * rx[2] - ry[1] * ry[2]) / root3,
       rz[2] * rz[2] - half * (rx[2] * rx[2] + ry[2] * ry[2]),
       (2.0F * rz[0] * rz[2] - rx[0] * rx[2] - ry[0] * ry[2]) / root3,
       (2.0F * squares(rz) - squares(rx) - squares(ry)) * half / root3},
      {rx[0] * rz[1] + rx[1] * rz[0], rx[1] * rz[2] + rx[2] * rz[1], root3 * rx[2] * rz[2],
       rx[0] * rz[2] + rx[2] * rz[0], rx[0] * rz[0] - rx[1] * rz[1]},
      {rx[0] * rx[1] - ry[0] * ry[1], rx[1] * rx[2] - ry[1] * ry[2], half * root3 * (rx[2] * rx[2] - ry[2] * ry[2]),
       rx[0] * rx[2] - ry[0] * ry[2], half * (squares(rx) - squares(ry))}};
  for (int i = 0; i < 5; ++i) {
    out[4 + i] = 0.0F;
    for (int k = 0; k < 5; ++k) out[4 + i] += matrix[i][k] * in[4 + k];
  }
}

void add(const std::string& variant, int bands, std::function<void()> body) {
  add_benchmark("Harmonics", variant, std::to_string(bands), kOneThread, kThousand, 0.0,
                [body = std::move(body)] { return body; });
}

}  // namespace

void add_harmonics() {
  for (const int bands : {3, 4, 6, 10}) {
    const SphericalHarmonics a = light_of(bands, 0.1);
    const SphericalHarmonics b = light_of(bands, 0.2);
    const Quaternion rotation{0.9, 0.1, -0.3, 0.2};
    add("product-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(product(a, b, a.bands()));
    });
    add("rotate-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(rotate(a, rotation));
    });
    add("evaluate-1000", bands, [=, towards = directions(kThousand), values = std::vector<dvec3>(kThousand)]() mutable {
      evaluate(a, towards, values);
      benchmark::DoNotOptimize(values.data());
    });
    add("evaluate-one-by-one-1000", bands, [=, towards = directions(kThousand)] {
      for (const dvec3& direction : towards) benchmark::DoNotOptimize(evaluate(a, direction));
    });
  }
  add("directxmath-method-rotate-1000", 3, [in = std::array<float, 27>{0.7F, 0.1F, 0.3F}]() mutable {
    std::array<float, 27> out{};
    std::array<std::array<float, 3>, 3> rotation{{{0.36F, 0.48F, -0.8F}, {-0.8F, 0.6F, 0.0F}, {0.48F, 0.64F, 0.6F}}};
    for (int k = 0; k < kThousand; ++k) {
      benchmark::DoNotOptimize(rotation);
      for (std::size_t c = 0; c < 27; c += 9) rotate_as_directxmath(rotation, &in[c], &out[c]);
      in[0] = out[0];
      benchmark::DoNotOptimize(out);
    }
  });
  add_benchmark("Harmonics", "sky-curve-1000", "3", kOneThread, kThousand, 0.0, [] {
    const auto curve = std::make_shared<const SkyCurve>(SkyView(earth_tables(), 0.0), SkyCurveOptions{});
    return [curve] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(curve->at(sun_direction(0.09 * k, 30.0)));
    };
  });
}

}  // namespace welkin::perf
