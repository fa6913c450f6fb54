// Raw figures: what is written can be read again, and what is no report is refused.
#include "report/report_json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "report/made_up_report.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/error.h"

using namespace welkin;
using namespace welkin::report;
using welkin::test::made_up_report;

namespace {

ErrorCode refusal(const std::string& text) {
  try {
    (void)from_json(text, "old.json");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("old.json") != std::string::npos);
    return error.code();
  }
  FAIL("it was taken: " << text.substr(0, 200));
  return {};
}

}  // namespace

TEST_CASE("report: JSON is read back as it was", "[report]") {
  const Report report = made_up_report();
  CHECK(from_json(to_json(report), "a file") == report);
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

TEST_CASE("report: JSON says what is on the front and what to take", "[report]") {
  const auto document = nlohmann::json::parse(to_json(made_up_report()));
  const auto& measurements = document.at("measurements");
  REQUIRE(measurements.size() == 5);
  CHECK(measurements[0].at("on_front") == true);
  CHECK(measurements[2].at("on_front") == false);
  CHECK(measurements[3].at("on_front") == false);
  CHECK(measurements[3].at("peer") == "Another 1.2");
  CHECK(measurements[0].at("peer").is_null());
  CHECK(document.at("recommendations")[0].at("setting") == "fine");
  CHECK(document.at("recommendations")[4].at("setting").is_null());
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
  for (const char* member : {"machine", "scale", "environment", "notes", "passes", "measurements"}) {
    INFO(member);
    auto without = whole;
    without.erase(member);
    CHECK(refusal(without.dump()) == ErrorCode::corrupt_file);
    auto other = whole;
    other[member] = 7;
    CHECK(refusal(other.dump()) == ErrorCode::corrupt_file);
  }
  for (const char* member : {"pass", "method", "setting", "error_rms", "seconds", "truth", "peer"}) {
    INFO(member);
    auto without = whole;
    without["measurements"][1].erase(member);
    CHECK(refusal(without.dump()) == ErrorCode::corrupt_file);
    auto other = whole;
    other["measurements"][1][member] = nlohmann::json::array();
    CHECK(refusal(other.dump()) == ErrorCode::corrupt_file);
  }
}

TEST_CASE("report: a file that is not there is refused", "[report]") {
  const test::TemporaryDirectory folder;
  try {
    (void)read_report(folder.file("none.json"));
    FAIL("it was read");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::file_access);
  }
}

TEST_CASE("report: CSV has a line a measurement, quoted where it must be", "[report]") {
  Report report = made_up_report();
  report.measurements[0].method = "a, \"b\"";
  report.measurements[1].error_rms = std::numeric_limits<double>::quiet_NaN();
  const std::string csv = to_csv(report);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 6);
  CHECK(csv.find("one,\"a, \"\"b\"\"\",coarse,,0.02,0.06,1e-06,1,the truth\r\n") != std::string::npos);
  CHECK(csv.find("one,method,fine,,,0.0015,0.0001,0,the truth\r\n") != std::string::npos);
}
