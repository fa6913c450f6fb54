// Promise: our own exponential is right to four units of the last place, and meets its ends.
#include "tables/exponential.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/catch.h"

namespace welkin::test {

TEST_CASE("Exponentials agree with long double ones", "[tables][exponential]") {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> wide(-708.0, 709.0);
  std::uniform_real_distribution<double> narrow(-2.0, 2.0);
  long double worst = 0.0L;
  const auto check = [&](double x) {
    const long double wanted = std::exp(static_cast<long double>(x));
    worst = std::max(worst, std::abs(static_cast<long double>(tables::exponential(x)) - wanted) / wanted);
  };
  for (int i = 0; i < 300000; ++i) {
    check(wide(generator));
    check(narrow(generator));
    check(narrow(generator) * 1e-8);
  }
  CHECK(static_cast<double>(worst) < 4e-16);
}

TEST_CASE("Exponentials meet zero, one and infinity", "[tables][exponential]") {
  CHECK(tables::exponential(0.0) == 1.0);
  CHECK(tables::exponential(-0.0) == 1.0);
  CHECK(tables::exponential(-1e300) == 0.0);
  CHECK(tables::exponential(-std::numeric_limits<double>::infinity()) == 0.0);
  CHECK(tables::exponential(1e300) == std::numeric_limits<double>::infinity());
  CHECK(tables::exponential(-740.0) > 0.0);
  CHECK(tables::exponential(-740.0) < 1e-320);
  CHECK(std::isfinite(tables::exponential(709.0)));
}

}  // namespace welkin::test
