// Promise: sums, multiples, mixtures and products of coefficients are those of the functions, in any number of bands.
#include <limits>
#include <numbers>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::test {

TEST_CASE("Sums, multiples and mixtures act on the functions, with missing bands as zero", "[sh][combine]") {
  RandomLight light(21);
  const SphericalHarmonics a = light.harmonics(3);
  const SphericalHarmonics b = light.harmonics(7);
  const glm::dvec3 factor(2.0, -0.5, 1e-3);
  CHECK(add(a, b).bands() == 7);
  CHECK(same_bits(add(a, b), add(b, a)));
  CHECK(lerp(a, b, 0.3).bands() == 7);
  CHECK(same_bits(lerp(a, b, 0.0), with_bands(a, 7)));
  CHECK(same_bits(lerp(a, b, 1.0), b));
  CHECK(relative_error(lerp(a, b, 2.0), add(scale(b, glm::dvec3(2.0)), scale(a, glm::dvec3(-1.0)))) < 1e-15);
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 d = light.direction();
    CHECK(glm::length(evaluate(add(a, b), d) - evaluate(a, d) - evaluate(b, d)) < 1e-14);
    CHECK(glm::length(evaluate(scale(b, factor), d) - factor * evaluate(b, d)) < 1e-14);
    CHECK(glm::length(evaluate(lerp(a, b, 0.3), d) - 0.7 * evaluate(a, d) - 0.3 * evaluate(b, d)) < 1e-14);
  }
}

TEST_CASE("Bands are cut off or added as zero", "[sh][combine]") {
  RandomLight light(22);
  const SphericalHarmonics a = light.harmonics(5);
  const SphericalHarmonics cut = with_bands(a, 2);
  CHECK(cut.bands() == 2);
  for (std::size_t k = 0; k < 4; ++k) CHECK(cut.coefficients()[k] == a.coefficients()[k]);
  const SphericalHarmonics grown = with_bands(a, 16);
  CHECK(same_bits(with_bands(grown, 5), a));
  CHECK(norm(grown) == norm(a));
  for (const int bands : {-1, 0, 17, 1 << 30}) {
    CHECK(thrown_by([&] { (void)with_bands(a, bands); }).says("1 to 16"));
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
    CHECK(relative_error(product(a, b, bands), with_bands(whole, bands)) < 1e-14 * norm(whole));
  }
  const SphericalHarmonics longer = product(a, b, 14);  // band limit 12: what lies above is zero
  CHECK(same_bits(with_bands(longer, 12), whole));
  CHECK(norm(longer) == norm(whole));
  // 16 bands times 16 bands have 31, of which 16 can be held; exact all the same.
  const SphericalHarmonics c = light.harmonics(16);
  const SphericalHarmonics first = product(c, c);
  CHECK(first.bands() == 16);
  double inner = 0.0;  // Int c^2 = |c|^2, and band 0 of the product holds it
  for (const glm::dvec3& value : c.coefficients()) inner += value.x * value.x;
  CHECK(first.at(0, 0).x == Approx(inner / std::sqrt(4.0 * std::numbers::pi)).epsilon(1e-13));
}

TEST_CASE("Products commute to the last bit, distribute, and a constant scales", "[sh][combine]") {
  RandomLight light(25);
  for (const int bands : {1, 3, 8}) {
    const SphericalHarmonics a = light.harmonics(bands);
    const SphericalHarmonics b = light.harmonics(4);
    const SphericalHarmonics c = light.harmonics(4);
    CHECK(same_bits(product(a, b), product(b, a)));
    CHECK(relative_error(product(a, add(b, c)), add(product(a, b), product(a, c))) < 1e-13);
    const glm::dvec3 colour(0.25, 3.0, 7.0);
    CHECK(relative_error(product(a, constant_radiance(colour)), scale(a, colour)) < 1e-13);
    const glm::dquat turn = light.turn();
    CHECK(relative_error(rotate(product(a, b), turn), product(rotate(a, turn), rotate(b, turn))) < 1e-13);
  }
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
