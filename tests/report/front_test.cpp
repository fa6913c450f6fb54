// The front is what nothing beats; a recommendation is on it and meets its target.
#include "report/front.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "report/made_up_report.h"
#include "support/catch.h"

using namespace welkin::report;
using welkin::test::point;

namespace {

bool beats(const Measurement& a, const Measurement& b) {
  return a.error_rms <= b.error_rms && a.seconds <= b.seconds && (a.error_rms < b.error_rms || a.seconds < b.seconds);
}

/// 0 to below `count`.
int below(std::mt19937& random, unsigned count) { return static_cast<int>(random() % count); }

/// Coarse values, so that equal errors and times occur.
std::vector<Measurement> random_points(std::mt19937& random) {
  std::vector<Measurement> points;
  const int count = below(random, 12);
  for (int k = 0; k < count; ++k) {
    points.push_back(point(std::to_string(k), 1e-4 * (1 + below(random, 9)), 1e-3 * (1 + below(random, 9)),
                           below(random, 5) == 0 ? "a peer" : ""));
  }
  return points;
}

}  // namespace

TEST_CASE("report: nothing beats the front, and all else is beaten by it", "[report]") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const std::vector<Measurement> points = random_points(random);
    const std::vector<std::size_t> front = pareto_front(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool member = std::find(front.begin(), front.end(), k) != front.end();
      if (!points[k].peer.empty()) {
        CHECK_FALSE(member);
        continue;
      }
      const auto own_and_better = [&](const Measurement& other) {
        return other.peer.empty() && beats(other, points[k]);
      };
      if (member) CHECK(std::none_of(points.begin(), points.end(), own_and_better));
      const auto front_is_as_good = [&](std::size_t f) {
        return points[f].error_rms <= points[k].error_rms && points[f].seconds <= points[k].seconds;
      };
      CHECK(std::any_of(front.begin(), front.end(), front_is_as_good));
    }
    CHECK(std::is_sorted(front.begin(), front.end(),
                         [&](std::size_t a, std::size_t b) { return points[a].seconds < points[b].seconds; }));
  }
}

TEST_CASE("report: a recommendation meets its target and is on the front", "[report]") {
  std::mt19937 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const std::vector<Measurement> points = random_points(random);
    const std::vector<std::size_t> front = pareto_front(points);
    const double target = 1e-4 * below(random, 10);
    const auto chosen = recommend(points, target, 0.2);
    const auto meets = [&](const Measurement& one) { return one.peer.empty() && one.error_rms <= target; };
    REQUIRE(chosen.has_value() == std::any_of(points.begin(), points.end(), meets));
    if (!chosen) continue;
    CHECK(meets(points[*chosen]));
    CHECK(std::find(front.begin(), front.end(), *chosen) != front.end());
    for (const Measurement& one : points) {
      if (meets(one)) CHECK(points[*chosen].seconds <= 1.2 * one.seconds * (1.0 + 1e-12));
    }
  }
}

TEST_CASE("report: of settings that noise cannot tell apart the most exact one is taken", "[report]") {
  const std::vector<Measurement> points{point("a", 4e-3, 1.00e-3), point("b", 1e-3, 1.04e-3),
                                        point("c", 1e-5, 1.06e-3)};
  CHECK(recommend(points, 5e-3) == std::optional<std::size_t>(1));
  CHECK(recommend(points, 5e-3, 0.0) == std::optional<std::size_t>(0));
  CHECK(recommend(points, 5e-4) == std::optional<std::size_t>(2));
  CHECK(recommend(points, 1e-6) == std::nullopt);
  CHECK(recommend({}, 1.0) == std::nullopt);
}

TEST_CASE("report: what has no number is on no front", "[report]") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Measurement> points{point("a", none, 1e-9), point("b", 1e-9, none), point("c", 1e-2, 1e-2),
                                        point("d", HUGE_VAL, 1e-8)};
  CHECK(pareto_front(points) == std::vector<std::size_t>{2});
  CHECK(recommend(points, 1.0) == std::optional<std::size_t>(2));
}

TEST_CASE("report: each pass has a recommendation for each target", "[report]") {
  const auto all = recommendations(welkin::test::made_up_report());
  REQUIRE(all.size() == 8);
  CHECK(all[0].setting->setting == "fine");    // 0.1 %
  CHECK(all[3].setting->setting == "coarse");  // 5 %
  CHECK_FALSE(all[4].setting.has_value());     // the second's 0.1 %
  CHECK(all[5].setting->setting == "only");
}
