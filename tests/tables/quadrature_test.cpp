#include <cmath>
#include <numbers>

#include "support/catch.h"
#include "tables/gauss_legendre.h"
#include "tables/trigonometry.h"

namespace welkin::test {

TEST_CASE("Sine and cosine of turns are right to a rounding", "[tables]") {
  for (int k = -4000; k <= 4000; ++k) {
    const double turns = k / 1000.0 + (k % 7) * 1e-5;
    const tables::SineCosine found = tables::sine_cosine_of_turns(turns);
    // The fraction is reduced exactly before libm sees it.
    const long double angle =
        2.0L * std::numbers::pi_v<long double> * (static_cast<long double>(turns) - std::floor(turns));
    CHECK(std::abs(static_cast<double>(found.sine - std::sin(angle))) < 4e-16);
    CHECK(std::abs(static_cast<double>(found.cosine - std::cos(angle))) < 4e-16);
  }
  CHECK(tables::sine_cosine_of_turns(0.25).sine == 1.0);
  CHECK(tables::sine_cosine_of_turns(0.5).sine == 0.0);
  CHECK(tables::sine_cosine_of_turns(0.5).cosine == -1.0);
  CHECK(tables::sine_cosine_of_turns(1e-9).sine == Approx(2e-9 * std::numbers::pi).epsilon(1e-15));
}

TEST_CASE("The angle of a point is right to a rounding of a turn", "[tables]") {
  const long double turn = 2.0L * std::numbers::pi_v<long double>;
  for (int k = -4000; k <= 4000; ++k) {
    const double y = k / 4000.0;
    for (const double x : {-1.0, -0.3, -1e-9, 1e-9, 0.017, 1.0, y, y + 1e-7}) {
      const long double expected = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / turn;
      CAPTURE(y, x);
      CHECK(std::abs(static_cast<double>(tables::turns_of(y, x) - expected)) < 1.2e-16);
    }
  }
  for (int eighth = -3; eighth <= 4; ++eighth) {
    const double y = (eighth > 0 ? 1.0 : -1.0) * (eighth % 4 == 0 ? 0.0 : 1.0);
    const double x = std::abs(eighth) < 2 ? 1.0 : (std::abs(eighth) == 2 ? 0.0 : -1.0);
    CHECK(tables::turns_of(eighth == 0 ? 0.0 : y, x) == eighth / 8.0);
  }
  CHECK(tables::turns_of(0.0, 0.0) == 0.0);
  CHECK(tables::turns_of(-0.0, -1.0) == -0.5);
}

TEST_CASE("The arc sine is right to a few roundings", "[tables]") {
  for (int k = 0; k <= 40000; ++k) {
    const double x = k / 40000.0;
    CHECK(std::abs(static_cast<double>(tables::arc_sine(x) - std::asin(static_cast<long double>(x)))) < 5e-16);
  }
  CHECK(tables::arc_sine(1.0) == Approx(std::numbers::pi / 2.0).epsilon(1e-15));
  CHECK(tables::arc_sine(1e-9) == Approx(1e-9).epsilon(1e-15));
}

TEST_CASE("A Gauss rule of n points is exact to degree 2n - 1", "[tables]") {
  for (int order = 1; order <= tables::kMaximumGaussOrder; ++order) {
    const simd::GaussRule rule = tables::gauss_legendre(order);
    REQUIRE(rule.order == order);
    for (int degree = 0; degree <= 2 * order - 1; ++degree) {
      double sum = 0.0;
      for (int i = 0; i < order; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], degree);
      const double expected = degree % 2 == 0 ? 2.0 / (degree + 1) : 0.0;
      CAPTURE(order, degree);
      CHECK(std::abs(sum - expected) < 1e-14);
    }
    for (int i = 1; i < order; ++i) CHECK(rule.nodes[i] > rule.nodes[i - 1]);
  }
}

}  // namespace welkin::test
