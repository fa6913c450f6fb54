// The settings that a report recommends stay good: by their errors, which are the same on every run. Times are those on
// record in tests/data/report_tiny.json, so that a setting leaves the front only by its error or another's.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "places.h"
#include "report/front.h"
#include "report/report_json.h"
#include "report/run_report.h"
#include "support/catch.h"
#include "welkin/error.h"

using namespace welkin::report;

namespace {

constexpr double kGrowth = 1.1;     // of an error, beyond which it fails
constexpr double kRounding = 1e-6;  // errors below it are not told apart

std::filesystem::path record() { return std::filesystem::path(WELKIN_TEST_DATA) / "report_tiny.json"; }

/// Today's errors with the times on record.
Report measured_again(const Report& recorded, const std::string& pass) {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {pass};
  options.peers = false;
  options.budget_seconds = 0.0;
  Report today = run_report(options);
  std::map<std::string, double> seconds;
  for (const Measurement& one : recorded.measurements) seconds[one.pass + label(one)] = one.seconds;
  for (Measurement& one : today.measurements) {
    INFO(one.pass << ": " << label(one));
    REQUIRE(seconds.count(one.pass + label(one)) == 1);
    one.seconds = seconds[one.pass + label(one)];
  }
  return today;
}

void check_errors(const std::vector<Measurement>& recorded, const std::vector<Measurement>& today) {
  REQUIRE(today.size() == recorded.size());
  for (std::size_t k = 0; k < today.size(); ++k) {
    INFO(today[k].pass << ": " << label(today[k]));
    CHECK(today[k].error_rms <= kGrowth * recorded[k].error_rms + kRounding);
    CHECK(today[k].error_maximum <= kGrowth * recorded[k].error_maximum + kRounding);
  }
}

/// What was recommended still meets its target, and nothing has overtaken it.
void check_recommendations(const std::vector<Measurement>& recorded, const std::vector<Measurement>& today) {
  const std::vector<std::size_t> front = pareto_front(today);
  for (const double target : kErrorTargets) {
    const auto chosen = recommend(recorded, target);
    if (!chosen) continue;
    INFO(today[*chosen].pass << " for " << target << ": " << label(today[*chosen]));
    CHECK(today[*chosen].error_rms <= kGrowth * target);
    CHECK(std::find(front.begin(), front.end(), *chosen) != front.end());
  }
}

void check_pass(const std::string& start) {
  const Report recorded = read_report(record());
  const Report today = measured_again(recorded, start);
  REQUIRE(today.environment == recorded.environment);
  for (const Pass& pass : today.passes) {
    check_errors(of_pass(recorded, pass.id), of_pass(today, pass.id));
    check_recommendations(of_pass(recorded, pass.id), of_pass(today, pass.id));
  }
}

}  // namespace

// WELKIN_RECORD_GOLDEN=1 welkin_tests "report: the record is whole" writes the record anew, times included: for a
// change that alters errors or settings and says why.
TEST_CASE("report: the record is whole", "[report]") {
  if (std::getenv("WELKIN_RECORD_GOLDEN") != nullptr) {
    ReportOptions options;
    options.scale = "tiny";
    options.peers = false;
    options.budget_seconds = 0.05;
    std::ofstream(record()) << to_json(run_report(options));
  }
  const Report recorded = read_report(record());
  std::vector<std::string> passes;
  for (const Pass& pass : recorded.passes) passes.push_back(pass.id);
  CHECK(passes == pass_ids());
}

TEST_CASE("report: recommended projections stay on the front", "[report]") { check_pass("project"); }
TEST_CASE("report: recommended prefilters stay on the front", "[report]") { check_pass("prefilter"); }
TEST_CASE("report: recommended bands stay on the front", "[report]") { check_pass("irradiance"); }
TEST_CASE("report: recommended BRDF tables stay on the front", "[report]") { check_pass("brdf"); }
TEST_CASE("report: recommended sky quadratures stay on the front", "[report]") { check_pass("sky-harmonics"); }
TEST_CASE("report: recommended sky tables stay on the front", "[report]") { check_pass("sky-tables"); }

TEST_CASE("report: errors are the same on every run and number of threads", "[report]") {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {"project-lat-long", "prefilter-0.30"};
  options.peers = false;
  options.budget_seconds = 0.0;
  const Report one = run_report(options);
  options.threads = 3;
  const Report three = run_report(options);
  REQUIRE(one.measurements.size() == three.measurements.size());
  for (std::size_t k = 0; k < one.measurements.size(); ++k) {
    CHECK(one.measurements[k].error_rms == three.measurements[k].error_rms);
    CHECK(one.measurements[k].error_maximum == three.measurements[k].error_maximum);
  }
  CHECK(three.machine.clock == "wall time");
}

TEST_CASE("report: what cannot be measured is refused", "[report]") {
  const auto refused = [](const ReportOptions& options) {
    try {
      (void)run_report(options);
    } catch (const welkin::Error& error) {
      return error.code() == welkin::ErrorCode::invalid_argument;
    }
    return false;
  };
  ReportOptions options;
  options.scale = "huge";
  CHECK(refused(options));
  options.scale = "tiny";
  options.passes = {"brdf", "nonsense"};
  CHECK(refused(options));
  options.passes = {"brdf"};
  options.threads = -1;
  CHECK(refused(options));
}

TEST_CASE("report: it can be cancelled, and tells how far it is", "[report]") {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {"irradiance", "brdf"};
  options.budget_seconds = 0.0;
  std::vector<double> shares;
  (void)run_report(options, {{}, [&](double share) { shares.push_back(share); }});
  CHECK(std::is_sorted(shares.begin(), shares.end()));
  REQUIRE_FALSE(shares.empty());
  CHECK(shares.back() == Approx(1.0));
  std::stop_source stop;
  stop.request_stop();
  try {
    (void)run_report(options, {stop.get_token(), {}});
    FAIL("it was not cancelled");
  } catch (const welkin::Error& error) {
    CHECK(error.code() == welkin::ErrorCode::cancelled);
  }
}
