// Promise: turned coefficients are those of the turned function; turns compose, undo and keep power, also 10 000 of
// them.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <vector>

#include "sh/band_rotation.h"
#include "sh/frame_transform.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::test {
namespace {

/// Largest difference between `turned` at map * d and `original` at d.
double worst_difference(const SphericalHarmonics& turned, const SphericalHarmonics& original, const glm::dmat3& map) {
  RandomLight light(7);
  double worst = 0.0;
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 d = light.direction();
    const glm::dvec3 off = evaluate(turned, glm::normalize(map * d)) - evaluate(original, d);
    worst = std::max(worst, glm::length(off));
  }
  return worst;
}

double band_power(const SphericalHarmonics& harmonics, int l) {
  double sum = 0.0;
  for (int m = -l; m <= l; ++m) sum += glm::dot(harmonics.at(l, m), harmonics.at(l, m));
  return sum;
}

/// All 48 signed permutations of the axes.
std::vector<glm::dmat3> cube_symmetries() {
  std::vector<glm::dmat3> all;
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 map(0.0);
      for (int k = 0; k < 3; ++k) map[k][order[k]] = (signs >> k & 1) != 0 ? -1.0 : 1.0;
      all.push_back(map);
    }
  } while (std::next_permutation(order, order + 3));
  return all;
}

}  // namespace

TEST_CASE("Turned coefficients are those of the turned function, in every number of bands", "[sh][turn]") {
  RandomLight light(1);
  for (int bands = 1; bands <= kMaximumBands; ++bands) {
    for (int k = 0; k < 10; ++k) {
      const SphericalHarmonics original = light.harmonics(bands);
      const glm::dquat turn = light.turn();
      CAPTURE(bands, k);
      CHECK(worst_difference(rotate(original, turn), original, glm::mat3_cast(turn)) < 1e-12 * norm(original));
    }
  }
}

TEST_CASE("A light is where it was turned to, to 1e-13", "[sh][turn]") {
  RandomLight light(2);
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 direction = light.direction();
    const glm::dquat turn = light.turn();
    const SphericalHarmonics found = rotate(point_light(direction, {1, 2, 3}, kMaximumBands), turn);
    CHECK(relative_error(found, point_light(glm::normalize(turn * direction), {1, 2, 3}, kMaximumBands)) < 1e-13);
  }
}

TEST_CASE("One turn after another is their product, and the inverse undoes", "[sh][turn]") {
  RandomLight light(3);
  for (const int bands : {1, 2, 3, 5, 9, 16}) {
    const SphericalHarmonics original = light.harmonics(bands);
    const glm::dquat first = light.turn();
    const glm::dquat second = light.turn();
    CHECK(relative_error(rotate(rotate(original, first), second), rotate(original, second * first)) < 1e-13);
    CHECK(relative_error(rotate(rotate(original, first), glm::conjugate(first)), original) < 1e-13);
    CHECK(relative_error(rotate(original, -first), rotate(original, first)) < 1e-15);
    CHECK(same_bits(rotate(original, glm::dquat(1, 0, 0, 0)), rotate(original, glm::dquat(-3, 0, 0, 0))));
    CHECK(relative_error(rotate(original, glm::dquat(1, 0, 0, 0)), original) < 1e-15);
  }
}

TEST_CASE("Ten thousand small steps end where one turn does, with all their power", "[sh][turn]") {
  for (const int bands : {3, 16}) {
    RandomLight light(4);
    const SphericalHarmonics original = light.harmonics(bands);
    SphericalHarmonics walked = original;
    glm::dquat total(1, 0, 0, 0);
    for (int step = 0; step < 10000; ++step) {
      const glm::dvec3 axis = light.direction();
      const glm::dquat small = glm::angleAxis(0.01 * (1.5 + light.number()), axis);
      walked = rotate(walked, small);
      total = glm::normalize(small * total);
    }
    CAPTURE(bands);
    CHECK(relative_error(walked, rotate(original, total)) < 1e-11);
    for (int l = 0; l < bands; ++l) {
      CHECK(band_power(walked, l) == Approx(band_power(original, l)).epsilon(1e-12));
    }
  }
}

TEST_CASE("The same small step ten thousand times keeps power: no drift one way", "[sh][turn]") {
  RandomLight light(5);
  const SphericalHarmonics original = light.harmonics(3);
  const glm::dquat step = glm::angleAxis(2.0 * 3.14159265358979323846 / 10000.0, light.direction());
  SphericalHarmonics walked = original;
  for (int k = 0; k < 10000; ++k) walked = rotate(walked, step);
  CHECK(relative_error(walked, original) < 1e-10);
  for (int l = 0; l < 3; ++l) CHECK(band_power(walked, l) == Approx(band_power(original, l)).epsilon(1e-12));
}

TEST_CASE("The 48 symmetries of the cube permute bands 0 and 1 with signs", "[sh][turn]") {
  RandomLight light(6);
  const SphericalHarmonics original = light.harmonics(kMaximumBands);
  for (const glm::dmat3& map : cube_symmetries()) {
    const SphericalHarmonics found = transform(original, map);
    CHECK(found.at(0, 0) == original.at(0, 0));
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 before(original.at(1, 1)[c], original.at(1, -1)[c], original.at(1, 0)[c]);
      const glm::dvec3 after(found.at(1, 1)[c], found.at(1, -1)[c], found.at(1, 0)[c]);
      CHECK(after == map * before);
    }
    CHECK(worst_difference(found, original, map) < 1e-12 * norm(original));
  }
}

TEST_CASE("A cube face's transform is the turn from its frame, for all bands", "[sh][turn]") {
  RandomLight light(8);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    const SphericalHarmonics local = light.harmonics(kMaximumBands);
    const std::size_t count = local.coefficients().size();
    std::vector<double> planes(3 * count);
    std::vector<double> canonical(3 * count);
    std::vector<int> place(count);
    for (std::size_t k = 0; k < count; ++k) {
      place[k] = static_cast<int>(k);
      for (std::size_t c = 0; c < 3; ++c) planes[c * count + k] = local.coefficients()[k][static_cast<int>(c)];
    }
    sh::face_transform(face, kMaximumBands).add(planes.data(), place.data(), canonical.data());
    SphericalHarmonics expected(kMaximumBands);
    for (std::size_t k = 0; k < count; ++k) {
      expected.coefficients()[k] = {canonical[k], canonical[count + k], canonical[2 * count + k]};
    }
    CHECK(relative_error(transform(local, glm::dmat3(frame.u, frame.v, frame.normal)), expected) < 1e-12);
  }
}

TEST_CASE("A mirror is the turn by its negative with every odd band's sign changed", "[sh][turn]") {
  RandomLight light(9);
  for (const int bands : {2, 3, 8, 16}) {
    const SphericalHarmonics original = light.harmonics(bands);
    const glm::dmat3 map = glm::mat3_cast(light.turn());
    const SphericalHarmonics mirrored = transform(original, -map);
    SphericalHarmonics expected = transform(original, map);
    for (int l = 1; l < bands; l += 2) {
      for (int m = -l; m <= l; ++m) expected.at(l, m) = -expected.at(l, m);
    }
    CHECK(relative_error(mirrored, expected) < 1e-13);
    CHECK(worst_difference(mirrored, original, -map) < 1e-12 * norm(original));
  }
}

TEST_CASE("Every band's matrix is orthogonal to 1e-13", "[sh][turn]") {
  RandomLight light(10);
  sh::BandRotation matrix(glm::mat3_cast(light.turn()));
  for (int l = 1; l < kMaximumBands; ++l) {
    matrix.advance();
    double worst = 0.0;
    for (int a = -l; a <= l; ++a) {
      for (int b = -l; b <= l; ++b) {
        double sum = a == b ? -1.0 : 0.0;
        for (int n = -l; n <= l; ++n) sum += matrix.at(a, n) * matrix.at(b, n);
        worst = std::max(worst, std::abs(sum));
      }
    }
    CAPTURE(l);
    CHECK(worst < 1e-13);
  }
}

TEST_CASE("A quaternion's length does not matter, however small or large", "[sh][turn]") {
  RandomLight light(11);
  const SphericalHarmonics original = light.harmonics(4);
  const glm::dquat turn = light.turn();
  const SphericalHarmonics expected = rotate(original, turn);
  for (const double length : {0.5, 3.0, 1e-200, 1e-300, 1e200, 1e300}) {
    const glm::dquat stretched(turn.w * length, turn.x * length, turn.y * length, turn.z * length);
    CHECK(relative_error(rotate(original, stretched), expected) < 1e-14);
  }
}

TEST_CASE("Coefficients of any size turn alike", "[sh][turn]") {
  RandomLight light(12);
  const SphericalHarmonics original = light.harmonics(kMaximumBands);
  const glm::dquat turn = light.turn();
  const SphericalHarmonics expected = rotate(original, turn);
  for (const double size : {0x1p100, 0x1p-100}) {
    CHECK(same_bits(rotate(scale(original, glm::dvec3(size)), turn), scale(expected, glm::dvec3(size))));
  }
  CHECK(norm(rotate(SphericalHarmonics(5), turn)) == 0.0);
}

TEST_CASE("A matrix slightly off is taken for the nearest turn; one far off is refused", "[sh][turn]") {
  RandomLight light(13);
  const SphericalHarmonics original = light.harmonics(kMaximumBands);
  const glm::dmat3 map = glm::mat3_cast(light.turn());
  glm::dmat3 off = map;
  for (int k = 0; k < 3; ++k) off[k] += 2e-7 * light.colour();
  const SphericalHarmonics found = transform(original, off);
  CHECK(norm(found) == Approx(norm(original)).epsilon(1e-12));
  CHECK(relative_error(found, transform(original, map)) < 2e-5);

  for (const glm::dmat3& bad : {glm::dmat3(0.0), 1.001 * map, glm::dmat3(std::numeric_limits<double>::quiet_NaN()),
                                glm::dmat3({1, 0, 0}, {0.01, 1, 0}, {0, 0, 1})}) {
    const ThrownError error = thrown_by([&] { (void)transform(original, bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("not orthogonal"));
    CHECK(error.says("1e-6"));
  }
}

TEST_CASE("A quaternion without length is refused", "[sh][turn]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const glm::dquat& bad : {glm::dquat(0, 0, 0, 0), glm::dquat(nan, 0, 0, 1), glm::dquat(1, 0, nan, 0),
                                glm::dquat(infinity, 0, 0, 0), glm::dquat(1, 0, 0, -infinity)}) {
    const ThrownError error = thrown_by([&] { (void)rotate(SphericalHarmonics(3), bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("quaternion"));
    CHECK(error.says("(1 0 0 0) turns nothing"));
  }
}

}  // namespace welkin::test
