// Spherical harmonics: the basis, evaluation, and what combining coefficients does to the functions.
#include "welkin/spherical_harmonics.h"

#include "math/basis.h"
#include "math/quadrature.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "welkin/core.h"

namespace welkin::test {

// Promises: the basis is orthonormal, of the stated order and signs, exact to the stated bound; the cosine lobe and
// irradiance are what their closed forms say.

namespace {

constexpr double kPi = std::numbers::pi;

/// A spiral over the sphere, both poles and all axes among it.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> list{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  constexpr int kCount = 200;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kCount;
    const double ring = std::sqrt(1.0 - z * z);
    list.emplace_back(ring * std::cos(2.4 * i), ring * std::sin(2.4 * i), z);
  }
  for (const double tilt : {1e-3, 1e-8, 1e-160}) list.emplace_back(tilt, -tilt, std::sqrt(1.0 - 2.0 * tilt * tilt));
  return list;
}

std::vector<double> basis(const glm::dvec3& direction, int bands) {
  std::vector<double> values(static_cast<std::size_t>(bands * bands));
  evaluate_basis(direction, bands, values);
  return values;
}

std::size_t index(int l, int m) { return SphericalHarmonics::index(l, m); }

/// Returns Y(l, m) by another route: in long double, unnormalized Legendre functions, factorials for the norm.
long double slow_basis(int l, int m, const glm::dvec3& direction) {
  const int order = m < 0 ? -m : m;
  const long double z = direction.z;
  long double before = 0.0L;
  long double here = 1.0L;  // P_m^m / sin^m = (2m - 1)!!
  for (int k = 1; k <= order; ++k) here *= 2 * k - 1;
  for (int k = order + 1; k <= l; ++k) {
    const long double next = ((2 * k - 1) * z * here - (k + order - 1) * before) / (k - order);
    before = here;
    here = next;
  }
  long double norm = (order == 0 ? 1.0L : 2.0L) * (2 * l + 1) / (4.0L * std::numbers::pi_v<long double>);
  for (int k = l - order + 1; k <= l + order; ++k) norm /= k;
  long double cosine = 1.0L;
  long double sine = 0.0L;
  for (int k = 0; k < order; ++k) {
    const long double next = direction.x * cosine - direction.y * sine;
    sine = direction.x * sine + direction.y * cosine;
    cosine = next;
  }
  return std::sqrt(norm) * here * (m < 0 ? sine : cosine);
}

}  // namespace

TEST_CASE("bands 0 to 3 are the polynomials of every textbook, in Welkin's order and signs", "[sh]") {
  const double k1 = std::sqrt(3.0 / (4.0 * kPi));
  for (const glm::dvec3& d : directions()) {
    const auto [x, y, z] = std::array{d.x, d.y, d.z};
    const std::array<double, 16> expected{
        std::sqrt(1.0 / (4.0 * kPi)),
        k1 * y,
        k1 * z,
        k1 * x,
        std::sqrt(15.0 / (4.0 * kPi)) * x * y,
        std::sqrt(15.0 / (4.0 * kPi)) * y * z,
        std::sqrt(5.0 / (16.0 * kPi)) * (3.0 * z * z - 1.0),
        std::sqrt(15.0 / (4.0 * kPi)) * z * x,
        std::sqrt(15.0 / (16.0 * kPi)) * (x * x - y * y),
        std::sqrt(35.0 / (32.0 * kPi)) * y * (3.0 * x * x - y * y),
        std::sqrt(105.0 / (4.0 * kPi)) * x * y * z,
        std::sqrt(21.0 / (32.0 * kPi)) * y * (5.0 * z * z - 1.0),
        std::sqrt(7.0 / (16.0 * kPi)) * z * (5.0 * z * z - 3.0),
        std::sqrt(21.0 / (32.0 * kPi)) * x * (5.0 * z * z - 1.0),
        std::sqrt(105.0 / (16.0 * kPi)) * z * (x * x - y * y),
        std::sqrt(35.0 / (32.0 * kPi)) * x * (x * x - 3.0 * y * y),
    };
    const std::vector<double> found = basis(d, 4);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      INFO("coefficient " << i << " at " << d.x << ", " << d.y << ", " << d.z);
      CHECK(std::abs(found[i] - expected[i]) <= 2e-15);
    }
  }
}

TEST_CASE("the basis is orthonormal through 16 bands", "[sh]") {
  // Products have degree up to 30 in z and order up to 30 about it: 16 Gauss nodes and 32 equal steps are exact.
  const math::GaussRule rule = math::gauss_legendre(kMaximumBands);
  constexpr int kSteps = 2 * kMaximumBands;
  constexpr std::size_t kCount = static_cast<std::size_t>(kMaximumBands) * kMaximumBands;
  std::vector<double> gram(kCount * kCount, 0.0);
  std::array<double, kCount> values{};
  for (int node = 0; node < rule.order; ++node) {
    const double z = rule.nodes[node];
    const double ring = std::sqrt(1.0 - z * z);
    for (int step = 0; step < kSteps; ++step) {
      const double phi = 2.0 * kPi * step / kSteps;
      math::evaluate_basis(ring * std::cos(phi), ring * std::sin(phi), z, kMaximumBands, values.data());
      const double weight = rule.weights[node] * 2.0 * kPi / kSteps;
      for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t j = 0; j <= i; ++j) gram[i * kCount + j] += weight * values[i] * values[j];
      }
    }
  }
  double worst = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      worst = std::max(worst, std::abs(gram[i * kCount + j] - (i == j ? 1.0 : 0.0)));
    }
  }
  CHECK(worst <= 1e-13);
}

TEST_CASE("the basis keeps its stated error, the poles included", "[sh]") {
  double worst_of_8 = 0.0;
  double worst = 0.0;
  for (const glm::dvec3& direction : directions()) {
    const std::vector<double> found = basis(direction, kMaximumBands);
    for (int l = 0; l < kMaximumBands; ++l) {
      for (int m = -l; m <= l; ++m) {
        const auto error = static_cast<double>(std::abs(slow_basis(l, m, direction) - found[index(l, m)]));
        worst = std::max(worst, error);
        if (l < 8) worst_of_8 = std::max(worst_of_8, error);
      }
    }
  }
  CHECK(worst_of_8 <= 5e-15);
  CHECK(worst <= 2e-14);
}

TEST_CASE("band counts and spans out of range are refused", "[sh]") {
  std::vector<double> values(400);
  const glm::dvec3 up{0, 1, 0};
  const auto refused = [](const auto& call) { return thrown_by(call).code == ErrorCode::invalid_argument; };
  for (const int bands : {-1, 0, kMaximumBands + 1}) {
    CHECK(refused([&] { evaluate_basis(up, bands, values); }));
    CHECK(refused([&] { SphericalHarmonics harmonics(bands); }));
  }
  CHECK(refused([&] { evaluate_basis(up, 3, std::span(values).first(8)); }));
  CHECK_NOTHROW(evaluate_basis(up, 3, std::span(values).first(9)));
}

TEST_CASE("the cosine lobe's factors are the integrals that they stand for", "[sh]") {
  CHECK(cosine_lobe(0) == kPi);
  CHECK(cosine_lobe(1) == 2.0 * kPi / 3.0);
  CHECK(std::abs(cosine_lobe(2) - kPi / 4.0) <= 1e-16);
  CHECK(cosine_lobe(3) == 0.0);
  CHECK(std::abs(cosine_lobe(4) + kPi / 24.0) <= 1e-16);
  CHECK(std::abs(cosine_lobe(6) - kPi / 64.0) <= 1e-16);
  // A_l = 2 pi Int_0^1 t P_l(t) dt, a polynomial of degree l + 1.
  const math::GaussRule rule = math::gauss_legendre(16);
  for (int l = 0; l <= 30; ++l) {
    double integral = 0.0;
    for (int i = 0; i < rule.order; ++i) {
      const double t = 0.5 * (1.0 + rule.nodes[i]);
      integral += 0.5 * rule.weights[i] * t * std::legendre(static_cast<unsigned>(l), t);
    }
    INFO("band " << l);
    CHECK(std::abs(cosine_lobe(l) - 2.0 * kPi * integral) <= 2e-14);
  }
}

TEST_CASE("a uniform environment: irradiance pi L, reflected L, average L, whichever way one looks", "[sh]") {
  const glm::dvec3 colour{0.25, 1.0, 4096.0};
  for (const int bands : {1, 2, 3, 10, kMaximumBands}) {
    const SphericalHarmonics radiance = constant_radiance(colour, bands);
    const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
    const SphericalHarmonics reflected = lambertian_from_irradiance(irradiance);
    CHECK(radiance.bands() == bands);
    CHECK(irradiance.bands() == bands);
    CHECK(reflected.bands() == bands);
    for (const glm::dvec3& direction : directions()) {
      for (int channel = 0; channel < 3; ++channel) {
        const double tolerance = 1e-15 * colour[channel];
        CHECK(std::abs(evaluate(radiance, direction)[channel] - colour[channel]) <= tolerance);
        CHECK(std::abs(evaluate(irradiance, direction)[channel] - kPi * colour[channel]) <= 4.0 * tolerance);
        CHECK(std::abs(evaluate(reflected, direction)[channel] - colour[channel]) <= tolerance);
        CHECK(std::abs(mean_radiance(radiance)[channel] - colour[channel]) <= tolerance);
      }
    }
  }
}

TEST_CASE("a distant point light: irradiance is the clamped cosine's series", "[sh]") {
  const glm::dvec3 light{2.0 / 7.0, 3.0 / 7.0, -6.0 / 7.0};
  const auto irradiance_of_light = [&light](int bands) {
    SphericalHarmonics radiance(bands);  // a delta of unit total radiance
    const std::vector<double> values = basis(light, bands);
    for (std::size_t i = 0; i < values.size(); ++i) radiance.coefficients()[i] = glm::dvec3(values[i]);
    return irradiance_from_radiance(radiance);
  };
  const SphericalHarmonics three = irradiance_of_light(3);
  const SphericalHarmonics sixteen = irradiance_of_light(kMaximumBands);
  for (const glm::dvec3& normal : directions()) {
    const double cosine = normal.x * light.x + normal.y * light.y + normal.z * light.z;
    // Sum of (2l + 1) / (4 pi) A_l P_l: 1/4 + cosine/2 + 5/32 (3 cosine^2 - 1).
    const double closed = 0.25 + 0.5 * cosine + 5.0 / 32.0 * (3.0 * cosine * cosine - 1.0);
    CHECK(std::abs(evaluate(three, normal).x - closed) <= 1e-15);
    // The series falls as 1/l^2: what bands 16 and up hold is largest at the kink, where the cosine is zero.
    CHECK(std::abs(evaluate(sixteen, normal).x - std::max(0.0, cosine)) <= 0.02);
  }
}

// Promise: sums, multiples, mixtures and products of coefficients are those of the functions, in any number of bands.

TEST_CASE("Sums, multiples and mixtures act on the functions, with missing bands as zero", "[sh][combine]") {
  RandomLight light(21);
  const SphericalHarmonics a = light.harmonics(3);
  const SphericalHarmonics b = light.harmonics(7);
  const glm::dvec3 factor(2.0, -0.5, 1e-3);
  CHECK(add(a, b).bands() == 7);
  CHECK(same_bits(add(a, b), add(b, a)));
  CHECK(lerp(a, b, 0.3).bands() == 7);
  CHECK(same_bits(lerp(a, b, 0.0), resized(a, 7)));
  CHECK(same_bits(lerp(a, b, 1.0), b));
  CHECK(relative_error(lerp(a, b, 2.0), add(scale(b, glm::dvec3(2.0)), scale(a, glm::dvec3(-1.0)))) < 1e-15);
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 d = light.direction();
    CHECK(glm::length(evaluate(add(a, b), d) - evaluate(a, d) - evaluate(b, d)) < 1e-14);
    CHECK(glm::length(evaluate(scale(b, factor), d) - factor * evaluate(b, d)) < 1e-14);
    CHECK(glm::length(evaluate(lerp(a, b, 0.3), d) - 0.7 * evaluate(a, d) - 0.3 * evaluate(b, d)) < 1e-14);
  }
}

TEST_CASE("Many directions at once have the bits of one after the other", "[sh][combine]") {
  RandomLight light(22);
  for (const int bands : {1, 3, 7, 16}) {
    const SphericalHarmonics harmonics = light.harmonics(bands);
    std::vector<dvec3> directions;
    for (int k = 0; k < 37; ++k) directions.push_back((k % 3 == 0 ? 1e-150 : 2.5) * light.direction());
    for (const std::size_t count : {0U, 1U, 8U, 9U, 37U}) {
      std::vector<dvec3> values(count);
      evaluate(harmonics, std::span(directions).first(count), values);
      for (std::size_t k = 0; k < count; ++k) CHECK(values[k] == evaluate(harmonics, directions[k]));
    }
    std::vector<dvec3> few(36);
    CHECK_THROWS_AS(evaluate(harmonics, directions, few), Error);
  }
}

TEST_CASE("A product is the pointwise product", "[sh][combine]") {
  RandomLight light(23);
  for (const auto& [bands_a, bands_b] : {std::pair{1, 1}, {2, 2}, {3, 3}, {1, 16}, {5, 9}, {8, 9}}) {
    const SphericalHarmonics a = light.harmonics(bands_a);
    const SphericalHarmonics b = light.harmonics(bands_b);
    const SphericalHarmonics both = product(a, b);
    CAPTURE(bands_a, bands_b);
    CHECK(both.bands() == bands_a + bands_b - 1);
    for (int k = 0; k < 50; ++k) {
      const glm::dvec3 d = light.direction();
      CHECK(glm::length(evaluate(both, d) - evaluate(a, d) * evaluate(b, d)) < 1e-13 * norm(a) * norm(b));
    }
  }
}

TEST_CASE("A product that is cut off has the first bands of the whole one", "[sh][combine]") {
  RandomLight light(24);
  const SphericalHarmonics a = light.harmonics(6);
  const SphericalHarmonics b = light.harmonics(7);
  const SphericalHarmonics whole = product(a, b);
  for (const int bands : {1, 2, 3, 8, 12}) {
    CHECK(relative_error(product(a, b, bands), resized(whole, bands)) < 1e-14 * norm(whole));
  }
  const SphericalHarmonics longer = product(a, b, 14);  // band limit 12: what lies above is zero
  CHECK(same_bits(resized(longer, 12), whole));
  CHECK(norm(longer) == norm(whole));
  // 16 bands times 16 bands have 31, of which 16 can be held; exact all the same.
  const SphericalHarmonics c = light.harmonics(16);
  const SphericalHarmonics first = product(c, c);
  CHECK(first.bands() == 16);
  double inner = 0.0;  // Int c^2 = |c|^2, and band 0 of the product holds it
  for (const glm::dvec3& value : c.coefficients()) inner += value.x * value.x;
  CHECK(first.at(0, 0).x == Approx(inner / std::sqrt(4.0 * std::numbers::pi)).epsilon(1e-13));
}

TEST_CASE("Products of very large and very small light stay in range", "[sh][combine]") {
  RandomLight light(26);
  const SphericalHarmonics a = light.harmonics(3);
  const SphericalHarmonics b = light.harmonics(3);
  const SphericalHarmonics expected = product(a, b);
  const SphericalHarmonics found = product(scale(a, glm::dvec3(0x1p100)), scale(b, glm::dvec3(0x1p-100)));
  CHECK(same_bits(found, expected));
  CHECK(relative_error(scale(product(scale(a, glm::dvec3(1e30)), scale(b, glm::dvec3(1e30))), glm::dvec3(1e-60)),
                       expected) < 1e-14);
  CHECK(norm(product(a, SphericalHarmonics(3))) == 0.0);
}

TEST_CASE("A product of too many bands is refused", "[sh][combine]") {
  for (const int bands : {-1, 17, std::numeric_limits<int>::max()}) {
    const ThrownError error = thrown_by([&] { (void)product(SphericalHarmonics(2), SphericalHarmonics(2), bands); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("1 to 16 are possible"));
  }
}

}  // namespace welkin::test
