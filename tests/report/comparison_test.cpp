// Two reports: what has become worse is named, what noise does is not.
#include "report/comparison.h"

#include <cmath>
#include <limits>

#include "report/made_up_report.h"
#include "support/catch.h"
#include "welkin/error.h"

using namespace welkin;
using namespace welkin::report;
using welkin::test::made_up_report;

TEST_CASE("report: a report against itself has nothing to say", "[report]") {
  const Comparison same = compare(made_up_report(), made_up_report());
  CHECK_FALSE(same.regressed());
  CHECK(same.compared == 5);
  CHECK((same.better_error.empty() && same.faster.empty() && same.gone.empty() && same.added.empty()));
  CHECK(to_text(same).find("none is worse") != std::string::npos);
}

TEST_CASE("report: an error that grew is a regression, either of the two", "[report]") {
  Report after = made_up_report();
  after.measurements[0].error_rms *= 1.04;
  CHECK_FALSE(compare(made_up_report(), after).regressed());
  after.measurements[0].error_rms = made_up_report().measurements[0].error_rms * 1.06;
  after.measurements[1].error_maximum *= 2.0;
  after.measurements[2].error_rms /= 2.0;
  const Comparison found = compare(made_up_report(), after);
  REQUIRE(found.worse_error.size() == 2);
  CHECK(found.worse_error[0].after.setting == "fine");  // the largest first
  CHECK(found.worse_error[1].after.setting == "coarse");
  REQUIRE(found.better_error.size() == 1);
  CHECK(found.better_error[0].after.setting == "bad");
  CHECK(found.slower.empty());
  CHECK(to_text(found).find("some are worse") != std::string::npos);
  CHECK_FALSE(compare(made_up_report(), after, {.error_factor = 3.0}).regressed());
}

TEST_CASE("report: what one error gained does not hide what the other lost", "[report]") {
  Report after = made_up_report();
  after.measurements[0].error_rms *= 1.5;
  after.measurements[0].error_maximum /= 3.0;
  after.measurements[1].error_rms /= 3.0;
  after.measurements[1].error_maximum *= 1.5;
  const Comparison found = compare(made_up_report(), after);
  CHECK(found.regressed());
  CHECK(found.worse_error.size() == 2);
  CHECK(found.better_error.empty());
}

TEST_CASE("report: rounding is not compared, what became no number is", "[report]") {
  Report before = made_up_report();
  before.measurements[0].error_rms = before.measurements[0].error_maximum = 1e-9;
  Report after = before;
  after.measurements[0].error_rms = after.measurements[0].error_maximum = 9e-7;
  CHECK_FALSE(compare(before, after).regressed());
  after.measurements[1].error_rms = std::numeric_limits<double>::quiet_NaN();
  const Comparison found = compare(before, after);
  REQUIRE(found.worse_error.size() == 1);
  CHECK(found.worse_error[0].after.setting == "fine");
}

TEST_CASE("report: times are compared on the same machine alone", "[report]") {
  Report after = made_up_report();
  after.measurements[0].seconds *= 1.6;
  after.measurements[1].seconds *= 1.4;
  after.measurements[2].seconds /= 1.6;
  const Comparison found = compare(made_up_report(), after);
  REQUIRE(found.slower.size() == 1);
  CHECK(found.slower[0].after.setting == "coarse");
  CHECK(found.slower[0].time_ratio == Approx(1.6));
  REQUIRE(found.faster.size() == 1);
  CHECK(found.faster[0].after.setting == "bad");
  for (const int change : {0, 1, 2, 3}) {
    Report elsewhere = after;
    if (change == 0) elsewhere.machine.processor = "another";
    if (change == 1) elsewhere.machine.instruction_set = "sse2";
    if (change == 2) elsewhere.machine.threads = 2;
    if (change == 3) elsewhere.machine.clock = "wall time";
    const Comparison refused = compare(made_up_report(), elsewhere);
    CHECK_FALSE(refused.regressed());
    CHECK_FALSE(refused.times_refused.empty());
    CHECK(to_text(refused).find("Times are not compared") != std::string::npos);
  }
}

TEST_CASE("report: peers do not regress, and a newer one is still the same", "[report]") {
  Report after = made_up_report();
  after.measurements[3].peer = "Another 1.3";
  after.measurements[3].seconds *= 10.0;
  after.measurements[3].error_rms *= 10.0;
  const Comparison found = compare(made_up_report(), after);
  CHECK_FALSE(found.regressed());
  CHECK(found.compared == 5);
}

TEST_CASE("report: settings that are gone or new are named, within passes that both have", "[report]") {
  Report after = made_up_report();
  after.measurements.erase(after.measurements.begin() + 1);
  after.measurements.push_back(test::point("another", 1e-3, 1e-3));
  const Comparison found = compare(made_up_report(), after);
  REQUIRE(found.gone.size() == 1);
  CHECK(found.gone[0].setting == "fine");
  REQUIRE(found.added.size() == 1);
  CHECK(found.added[0].setting == "another");
  after.measurements.erase(after.measurements.begin() + 3);  // all of the second pass
  CHECK(compare(made_up_report(), after).gone.size() == 1);
}

TEST_CASE("report: only reports of one scale and light are compared", "[report]") {
  Report other = made_up_report();
  other.scale = "full";
  CHECK_THROWS_AS(compare(made_up_report(), other), Error);
  other = made_up_report();
  other.environment = "another light";
  CHECK_THROWS_AS(compare(made_up_report(), other), Error);
  CHECK_THROWS_AS(compare(made_up_report(), made_up_report(), {.error_factor = 0.5}), Error);
}
