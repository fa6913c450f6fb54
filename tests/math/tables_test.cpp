// Welkin's elementary functions, quadratures, and the cache of tables that depend on a size alone.
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "support/catch.h"

namespace welkin::test {

// Promise: Welkin's exponential is accurate to four units in the last place, and ends in 0 and infinity.

TEST_CASE("Exponentials agree with long double ones", "[tables][exponential][slow]") {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> wide(-708.0, 709.0);
  std::uniform_real_distribution<double> narrow(-2.0, 2.0);
  long double worst = 0.0L;
  const auto check = [&](double x) {
    const long double wanted = std::exp(static_cast<long double>(x));
    worst = std::max(worst, std::abs(static_cast<long double>(math::exponential(x)) - wanted) / wanted);
  };
  for (int i = 0; i < 300000; ++i) {
    check(wide(generator));
    check(narrow(generator));
    check(narrow(generator) * 1e-8);
  }
  CHECK(static_cast<double>(worst) < 4e-16);
}

TEST_CASE("Four exponentials have the bits of one", "[tables][exponential]") {
  for (double x = -760.0; x < 720.0; x += 0.37) {
    const std::array<double, 4> from{x, 0.001 * x, -x, x - 300.0};
    std::array<double, 4> four = from;
    math::exponentials(four);
    for (std::size_t k = 0; k < 4; ++k) CHECK(four[k] == math::exponential(from[k]));
  }
}

TEST_CASE("Exponentials meet zero, one and infinity", "[tables][exponential]") {
  CHECK(math::exponential(0.0) == 1.0);
  CHECK(math::exponential(-0.0) == 1.0);
  CHECK(math::exponential(-1e300) == 0.0);
  CHECK(math::exponential(-std::numeric_limits<double>::infinity()) == 0.0);
  CHECK(math::exponential(1e300) == std::numeric_limits<double>::infinity());
  CHECK(math::exponential(-740.0) > 0.0);
  CHECK(math::exponential(-740.0) < 1e-320);
  CHECK(std::isfinite(math::exponential(709.0)));
}

// Promise: the angle of a point, in turns, is right to 1.2e-16, and exact where a person would notice.

TEST_CASE("Turns of a point agree with long double arctangents", "[tables][turns]") {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  long double worst = 0.0L;
  const auto check = [&](double y, double x) {
    const long double wanted =
        std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / (2.0L * std::numbers::pi_v<long double>);
    worst = std::max(worst, std::abs(static_cast<long double>(math::turns_of(y, x)) - wanted));
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
  CHECK(math::turns_of(0.0, 2.0) == 0.0);
  CHECK(math::turns_of(-1.0, 1.0) == -0.125);
  CHECK(math::turns_of(-1.0, -1.0) == -0.375);
  CHECK(math::turns_of(3.0, 3.0) == 0.125);
  CHECK(math::turns_of(3.0, 0.0) == 0.25);
  CHECK(math::turns_of(3.0, -3.0) == 0.375);
  CHECK(math::turns_of(0.0, -1.0) == 0.5);
  CHECK(math::turns_of(-0.0, -1.0) == -0.5);
  CHECK(math::turns_of(-1.0, 0.0) == -0.25);
  CHECK(math::turns_of(0.0, 0.0) == 0.0);
}

TEST_CASE("Sine and cosine of turns are right to a rounding", "[tables]") {
  for (int k = -4000; k <= 4000; ++k) {
    const double turns = k / 1000.0 + (k % 7) * 1e-5;
    const math::SineCosine found = math::sine_cosine_of_turns(turns);
    // The fraction is reduced exactly before libm sees it.
    const long double angle =
        2.0L * std::numbers::pi_v<long double> * (static_cast<long double>(turns) - std::floor(turns));
    CHECK(std::abs(static_cast<double>(found.sine - std::sin(angle))) < 4e-16);
    CHECK(std::abs(static_cast<double>(found.cosine - std::cos(angle))) < 4e-16);
  }
  CHECK(math::sine_cosine_of_turns(0.25).sine == 1.0);
  CHECK(math::sine_cosine_of_turns(0.5).sine == 0.0);
  CHECK(math::sine_cosine_of_turns(0.5).cosine == -1.0);
  CHECK(math::sine_cosine_of_turns(1e-9).sine == Approx(2e-9 * std::numbers::pi).epsilon(1e-15));
}

TEST_CASE("The arc sine is right to a few roundings", "[tables]") {
  for (int k = 0; k <= 40000; ++k) {
    const double x = k / 40000.0;
    CHECK(std::abs(static_cast<double>(math::arc_sine(x) - std::asin(static_cast<long double>(x)))) < 5e-16);
  }
  CHECK(math::arc_sine(1.0) == Approx(std::numbers::pi / 2.0).epsilon(1e-15));
  CHECK(math::arc_sine(1e-9) == Approx(1e-9).epsilon(1e-15));
}

TEST_CASE("A Gauss rule of n points is exact to degree 2n - 1", "[tables]") {
  for (int order = 1; order <= math::kMaximumGaussOrder; ++order) {
    const math::GaussRule rule = math::gauss_legendre(order);
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

TEST_CASE("A Gauss rule has the same bits whoever asks for it first", "[tables][threads]") {
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t k = 0; k < wrong.size(); ++k) {
    threads.emplace_back([k, &wrong] {
      for (int turn = 0; turn < math::kMaximumGaussOrder; ++turn) {
        const int order = 1 + (turn * 7 + static_cast<int>(k) * 11) % math::kMaximumGaussOrder;
        const math::GaussRule rule = math::gauss_legendre(order);
        const math::GaussNodes alone = math::gauss_nodes(order);
        if (!std::equal(alone.nodes.begin(), alone.nodes.end(), rule.nodes) ||
            !std::equal(alone.weights.begin(), alone.weights.end(), rule.weights))
          ++wrong[k];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == std::vector<int>(4, 0));
}

// The cache: one build for all requests of the same table, and a bound on what is kept.

namespace {

struct Table {
  std::size_t size;
  [[nodiscard]] std::size_t bytes() const { return size; }
};

std::shared_ptr<const Table> make(std::size_t size) { return std::make_shared<const Table>(Table{size}); }

}  // namespace

TEST_CASE("Threads that want the same table build it once", "[tables]") {
  math::TableCache<int, Table> cache(1000);
  std::atomic<int> built{0};
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back([&] {
      for (int key = 0; key < 5; ++key) {
        const auto table = cache.get(key, [&] {
          ++built;
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          return make(10);
        });
        if (table->size != 10) built = 1000;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(built == 5);
}

TEST_CASE("What is looked for is found if it is there, and counts as used", "[tables]") {
  math::TableCache<int, Table> cache(100);
  CHECK(cache.find(1) == nullptr);
  const auto first = cache.get(1, [&] {
    CHECK(cache.find(1) == nullptr);  // not yet, and without waiting
    return make(40);
  });
  cache.get(2, [] { return make(40); });
  CHECK(cache.find(1) == first);  // now 2 is the oldest
  cache.get(3, [] { return make(40); });
  CHECK(cache.find(2) == nullptr);
  CHECK(cache.find(1) == first);
}

TEST_CASE("The least recently used tables go when the bound is reached", "[tables]") {
  math::TableCache<int, Table> cache(100);
  int built = 0;
  const auto get = [&](int key) {
    return cache.get(key, [&] {
      ++built;
      return make(40);
    });
  };
  const auto held = get(1);
  get(2);
  CHECK(cache.bytes() == 80);
  get(1);  // now 2 is the oldest
  get(3);  // 120 bytes: 2 goes
  CHECK(cache.bytes() == 80);
  get(1);
  CHECK(built == 3);
  get(2);
  CHECK(built == 4);
  CHECK(held->size == 40);  // a held table stays alive
}

TEST_CASE("A table larger than the bound is handed out and not kept", "[tables]") {
  math::TableCache<int, Table> cache(100);
  CHECK(cache.get(1, [] { return make(500); })->size == 500);
  CHECK(cache.bytes() == 0);
}

TEST_CASE("A failed build is tried again", "[tables]") {
  math::TableCache<int, Table> cache(100);
  CHECK_THROWS_AS(cache.get(1, []() -> std::shared_ptr<const Table> { throw std::runtime_error("no memory"); }),
                  std::runtime_error);
  CHECK(cache.get(1, [] { return make(7); })->size == 7);
}

}  // namespace welkin::test
