// Promise: the angle of a point, in turns, is right to 1.2e-16, and exact where a person would notice.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "support/catch.h"
#include "tables/trigonometry.h"

namespace welkin::test {

TEST_CASE("Turns of a point agree with long double arctangents", "[tables][turns]") {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  long double worst = 0.0L;
  const auto check = [&](double y, double x) {
    const long double wanted =
        std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / (2.0L * std::numbers::pi_v<long double>);
    worst = std::max(worst, std::abs(static_cast<long double>(tables::turns_of(y, x)) - wanted));
  };
  for (int i = 0; i < 200000; ++i) {
    const double y = component(generator);
    const double x = component(generator);
    check(y, x);
    check(y * 1e-9, x);
    check(y, x * 1e-30);
  }
  for (int k = 0; k <= 4096; ++k) check(k / 4096.0, 1.0);  // through all the places where the reduction changes
  CHECK(static_cast<double>(worst) < 1.2e-16);
}

TEST_CASE("Turns of axes and diagonals are exact, and zero keeps its sign", "[tables][turns]") {
  CHECK(tables::turns_of(0.0, 2.0) == 0.0);
  CHECK(tables::turns_of(3.0, 3.0) == 0.125);
  CHECK(tables::turns_of(3.0, 0.0) == 0.25);
  CHECK(tables::turns_of(3.0, -3.0) == 0.375);
  CHECK(tables::turns_of(0.0, -1.0) == 0.5);
  CHECK(tables::turns_of(-0.0, -1.0) == -0.5);
  CHECK(tables::turns_of(-1.0, 0.0) == -0.25);
  CHECK(tables::turns_of(0.0, 0.0) == 0.0);
}

}  // namespace welkin::test
