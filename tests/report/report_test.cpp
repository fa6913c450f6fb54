#include "perf/report/report.h"

#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/core.h"

using namespace welkin::report;
using namespace welkin;

// The front is what nothing beats; a recommendation is on it and meets its target.

namespace {

/// A small report whose figures are chosen, not measured.
Measurement point(const std::string& setting, double error, double seconds, const std::string& peer = "",
                  const std::string& pass = "one") {
  return {pass, "method", setting, error, 3.0 * error, seconds, "the truth", peer};
}

Report made_up_report() {
  Report report;
  report.machine = {"a processor", "a compiler", "avx2", "0.1.0", "CPU time", "2026-11-22T00:00:00Z", 1};
  report.scale = "quick";
  report.environment = "a light";
  report.passes = {{"one", "The first", "What is done.", "What rms is."}, {"two", "The second", "Else.", "Else."}};
  report.measurements = {point("coarse", 2e-2, 1e-6), point("fine", 5e-4, 1e-4), point("bad", 3e-2, 1e-3),
                         point("theirs", 1e-5, 1e-7, "Another 1.2"), point("only", 4e-3, 2.0, "", "two")};
  report.notes = {"A note."};
  return report;
}

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

TEST_CASE("report: each pass has a recommendation for each target", "[report]") {
  const auto all = recommendations(made_up_report());
  REQUIRE(all.size() == 8);
  CHECK(all[0].setting->setting == "fine");    // 0.1 %
  CHECK(all[3].setting->setting == "coarse");  // 5 %
  CHECK_FALSE(all[4].setting.has_value());     // the second's 0.1 %
  CHECK(all[5].setting->setting == "only");
}

// Two reports: what has become worse is named, what noise does is not.

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

// Raw figures: what is written can be read again, and what is no report is refused.

namespace {

ErrorCode refusal(const std::string& text) {
  INFO(text.substr(0, 200));
  const test::ThrownError error = test::thrown_by([&] { (void)from_json(text, "old.json"); });
  CHECK(error.says("old.json"));
  return error.code;
}

}  // namespace

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
  after.measurements.push_back(point("another", 1e-3, 1e-3));
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

TEST_CASE("report: JSON keeps every digit and what is no number", "[report]") {
  Report report = made_up_report();
  report.measurements[0].error_rms = 0.1 + 0.2;
  report.measurements[1].seconds = std::numeric_limits<double>::quiet_NaN();
  report.measurements[2].error_maximum = HUGE_VAL;
  const Report read = from_json(to_json(report), "a file");
  CHECK(read.measurements[0].error_rms == 0.1 + 0.2);
  CHECK(std::isnan(read.measurements[1].seconds));
  CHECK(std::isnan(read.measurements[2].error_maximum));
}

TEST_CASE("report: what is no report is refused by name", "[report]") {
  const std::string whole = to_json(made_up_report());
  CHECK(refusal("") == ErrorCode::corrupt_file);
  CHECK(refusal("[]") == ErrorCode::unsupported_file);
  CHECK(refusal("{}") == ErrorCode::unsupported_file);
  CHECK(refusal("{\"format\": \"welkin report\", \"version\": 2}") == ErrorCode::unsupported_file);
  CHECK(refusal("{\"format\": 5, \"version\": 1}") == ErrorCode::corrupt_file);
  for (std::size_t length = 1; length + 2 < whole.size(); length += 97) {
    CHECK(refusal(whole.substr(0, length)) == ErrorCode::corrupt_file);
  }
}

TEST_CASE("report: members that are missing or of another type are refused", "[report]") {
  const auto whole = nlohmann::json::parse(to_json(made_up_report()));
  const auto check = [&](const std::string& parent, const char* member, const nlohmann::json& other) {
    INFO(parent << '/' << member);
    const nlohmann::json::json_pointer at(parent);
    auto without = whole;
    without[at].erase(member);
    CHECK(refusal(without.dump()) == ErrorCode::corrupt_file);
    auto changed = whole;
    changed[at][member] = other;
    CHECK(refusal(changed.dump()) == ErrorCode::corrupt_file);
  };
  for (const char* member : {"machine", "scale", "environment", "notes", "passes", "measurements"})
    check("", member, 7);
  for (const char* member : {"pass", "method", "setting", "error_rms", "seconds", "truth", "peer"})
    check("/measurements/1", member, nlohmann::json::array());
}

TEST_CASE("report: a file that is not there is refused", "[report]") {
  const test::TemporaryDirectory folder;
  CHECK(test::thrown_by([&] { (void)read_report(folder.file("none.json")); }).code == ErrorCode::file_access);
}

// The page stands alone, and nothing in it is taken for markup. What a browser makes of it: page_live.sh.

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("report: the page needs nothing else", "[report]") {
  const std::string page = to_html(made_up_report(), compare(made_up_report(), made_up_report()));
  for (const char* part : {"https:", "src=", "<link", "@import", "url(", "fetch(", "XMLHttp", "import("}) {
    INFO(part);
    CHECK_FALSE(has(page, part));
  }
  CHECK(has(page, "@media print"));
  CHECK(has(page, "function plotSvg("));
  for (const char* placeholder : {"REPORT", "PLOT"}) CHECK_FALSE(has(page, placeholder));
}

TEST_CASE("report: the page has the report's JSON, in which nothing ends the script", "[report]") {
  Report report = made_up_report();
  const std::string evil = "</script><script>alert(1)</script>";
  report.measurements[0].method = report.passes[0].title = report.environment = report.notes[0] = evil;
  const std::string page = to_html(report);
  CHECK_FALSE(has(page, "alert(1)</script>"));
  const std::string start = "<script type=\"application/json\">";
  const std::size_t from = page.find(start) + start.size();
  const nlohmann::json found = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  CHECK(found == nlohmann::json::parse(to_json(report)));
}

TEST_CASE("report: the page has what has become worse", "[report]") {
  Report after = made_up_report();
  after.measurements[1].error_rms *= 4.0;
  after.measurements[0].seconds *= 3.0;
  const std::string page = to_html(after, compare(made_up_report(), after));
  for (const char* part : {R"("regressed":true)", R"("what":"larger error")", R"("what":"slower")"})
    CHECK(has(page, part));
}
