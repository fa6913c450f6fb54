// Promises: colours in other primaries become the Rec. 709 colours that look the same, grey stays grey, and primaries
// that make no colours are told apart.
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "codec/primaries.h"
#include "support/catch.h"

namespace welkin::codec {
namespace {

constexpr Chromaticities kRec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
constexpr Chromaticities kAp0{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};

void check_close(const glm::dvec3& found, const glm::dvec3& wanted, double tolerance) {
  CAPTURE(found.x, found.y, found.z, wanted.x, wanted.y, wanted.z);
  for (int i = 0; i < 3; ++i) {
    CHECK(std::abs(found[i] - wanted[i]) <= tolerance);
  }
}

}  // namespace

TEST_CASE("Rec. 709's own matrix is the published one", "[codec]") {
  const glm::dmat3 matrix = rgb_to_xyz(kRec709).value();
  // IEC 61966-2-1, to its four digits.
  check_close(matrix[0], {0.4124, 0.2126, 0.0193}, 6e-5);
  check_close(matrix[1], {0.3576, 0.7152, 0.1192}, 6e-5);
  check_close(matrix[2], {0.1805, 0.0722, 0.9505}, 6e-5);
  const glm::dmat3 nothing = to_rec709(kRec709).value();
  for (int i = 0; i < 3; ++i) {
    check_close(nothing[i], glm::dmat3(1.0)[i], 1e-14);
  }
}

TEST_CASE("Rec. 2020 becomes Rec. 709 as ITU-R BT.2407 says", "[codec]") {
  const glm::dmat3 matrix = to_rec709(kRec2020).value();
  check_close(matrix[0], {1.6605, -0.1246, -0.0182}, 6e-5);
  check_close(matrix[1], {-0.5876, 1.1329, -0.1006}, 6e-5);
  check_close(matrix[2], {-0.0728, -0.0083, 1.1187}, 6e-5);
}

TEST_CASE("grey stays grey whatever the white", "[codec]") {
  for (const Chromaticities& primaries :
       {kRec2020, kAp0, Chromaticities{kRec709.red, kRec709.green, kRec709.blue, {0.3457, 0.3585}}}) {
    check_close(to_rec709(primaries).value() * glm::dvec3(1.0), glm::dvec3(1.0), 1e-12);
  }
}

TEST_CASE("the neutral that is stated becomes grey instead of the white", "[codec]") {
  const glm::dvec2 neutral(0.3457, 0.3585);
  const glm::dmat3 xyz_to_rgb = glm::inverse(rgb_to_xyz(kRec2020).value());
  const glm::dvec3 colour = xyz_to_rgb * (glm::dvec3(neutral, 1.0 - neutral.x - neutral.y) / neutral.y);
  check_close(to_rec709(kRec2020, neutral).value() * colour, glm::dvec3(1.0), 1e-12);
}

TEST_CASE("X, Y, Z are colours themselves and are not adapted", "[codec]") {
  const glm::dvec3 colour(0.2, 3.0, 0.7);
  check_close(to_rec709(kCieXyz).value() * (rgb_to_xyz(kRec709).value() * colour), colour, 1e-12);
  check_close(to_rec709(kCieXyz, kCieXyz.white).value() * glm::dvec3(1.0), glm::dvec3(1.0), 1e-12);
}

TEST_CASE("primaries that make no colours are none", "[codec]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_FALSE(to_rec709({}));
  CHECK_FALSE(to_rec709({{0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}, {0.3127, 0.3290}}));
  CHECK_FALSE(to_rec709({kRec709.red, kRec709.green, kRec709.blue, {0.3, 0.0}}));
  CHECK_FALSE(to_rec709({kRec709.red, kRec709.green, kRec709.blue, kRec709.red}));
  for (const double bad : {nan, infinity, -infinity, 1e300, std::numeric_limits<double>::denorm_min()}) {
    CHECK_FALSE(to_rec709({{bad, 0.33}, kRec709.green, {bad, 0.06}, {0.3127, bad}}));
    CHECK_FALSE(to_rec709(kRec2020, glm::dvec2(0.3, bad)));
  }
}

TEST_CASE("what differs by a rounding is the same", "[codec]") {
  CHECK(nearly_same(kRec709, {{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.313, 0.329}}));
  CHECK_FALSE(nearly_same(kRec709, {{0.64, 0.33}, {0.29, 0.6}, {0.15, 0.06}, {0.3333, 0.3333}}));
  CHECK(describe(kCieXyz) == "CIE XYZ");
  CHECK(describe({{0.64, 0.33}, {0.29, 0.6}, {0.15, 0.06}, {0.3333, 0.3333}}) ==
        "red (0.64 0.33) green (0.29 0.6) blue (0.15 0.06) white (0.3333 0.3333)");
}

TEST_CASE("a matrix is applied to every texel", "[codec]") {
  std::vector<float> rgb{1, 2, 3, 4, 5, 6, 7, 8, 9};
  apply(glm::dmat3({0, 0, 1}, {2, 0, 0}, {0, 4, 0}), rgb.data(), 2);
  CHECK(rgb == std::vector<float>{4, 12, 1, 10, 24, 4, 7, 8, 9});
}

}  // namespace welkin::codec
