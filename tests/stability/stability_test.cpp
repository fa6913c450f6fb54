// Promise: every case of the stability suite is as exact as it is on record (tests/data/stability.json): no error grew,
// no promise broke, no case is gone. After a change that alters errors and says why, WELKIN_RECORD_GOLDEN=1 writes the
// file anew: `welkin_tests "[stability]"`, all in one process.
#include "stability/stability.h"

#include <nlohmann/json.hpp>

#include "perf/report/measuring.h"
#include "places.h"
#include "standard_headers.h"
#include "support/trials.h"

namespace welkin::test {
namespace {

/// How much larger than recorded an error may be. The library's bits are the same everywhere; those of the truths
/// depend on the machine's mathematical library, in their last places.
constexpr double kMaxGrowth = 2.0;

/// Errors of so little are the truths' own rounding and may become each other.
double negligible(StabilityUnit unit) { return unit == StabilityUnit::relative ? 3e-14 : 0.0; }

std::string path() { return std::string(WELKIN_TEST_DATA) + "/stability.json"; }

nlohmann::json recorded() {
  std::ifstream in(path());
  return in ? nlohmann::json::parse(in) : nlohmann::json::object();
}

/// Infinity is null in JSON.
nlohmann::json entry(const StabilityResult& result) {
  return {{"measured", std::isfinite(result.measured) ? nlohmann::json(result.measured) : nlohmann::json(nullptr)},
          {"holds", result.holds}};
}

void record(const std::string& subject, const std::vector<StabilityResult>& results) {
  nlohmann::json all = recorded();
  std::vector<std::string> old;
  for (const auto& [name, value] : all.items()) {
    if (name.rfind(subject + "/", 0) == 0) old.push_back(name);
  }
  for (const std::string& name : old) all.erase(name);
  for (const StabilityResult& result : results) all[result.name] = entry(result);
  std::ofstream(path()) << all.dump(1) << '\n';
}

void check_case(const StabilityResult& result, const nlohmann::json& golden) {
  CAPTURE(result.name, result.promise, result.measured, result.bound, result.failure, golden.dump());
  const double before =
      golden["measured"].is_null() ? std::numeric_limits<double>::infinity() : golden["measured"].get<double>();
  CHECK(result.measured <= std::max(kMaxGrowth * before, negligible(result.unit)));
  if (golden["holds"].get<bool>()) CHECK(result.holds);
  if (!result.holds) CHECK_FALSE(result.advice.empty());
}

/// Measures a subject's quick cases and compares each with what is on record.
void require_recorded(const std::string& subject) {
  const std::vector<StabilityResult> results = run_stability(subject, true);
  REQUIRE_FALSE(results.empty());
  if (std::getenv("WELKIN_RECORD_GOLDEN") != nullptr) return record(subject, results);
  const nlohmann::json golden = recorded();
  std::set<std::string> found;
  for (const StabilityResult& result : results) {
    found.insert(result.name);
    CAPTURE(result.name);
    REQUIRE(golden.contains(result.name));
    check_case(result, golden[result.name]);
  }
  for (const auto& [name, value] : golden.items()) {
    CAPTURE(name);
    if (name.rfind(subject + "/", 0) == 0) CHECK(found.count(name) == 1);
  }
}

/// The same for subjects that take many seconds. Sanitizers make minutes of them; what they call has tests of its own
/// there.
void require_recorded_if_fast(const std::string& subject) {
  if (!kSanitized) require_recorded(subject);
}

}  // namespace

TEST_CASE("Stability: dynamic range of projections", "[stability]") { require_recorded("range"); }
TEST_CASE("Stability: dynamic range of images", "[stability][truth]") { require_recorded_if_fast("image-range"); }
TEST_CASE("Stability: cancellation", "[stability]") { require_recorded("cancellation"); }
TEST_CASE("Stability: sums of any length", "[stability]") { require_recorded("accumulation"); }
TEST_CASE("Stability: values that are no numbers", "[stability]") { require_recorded("policies"); }
TEST_CASE("Stability: sizes of 1 and 2", "[stability][truth]") { require_recorded("sizes"); }
TEST_CASE("Stability: lobes of any width", "[stability][truth]") { require_recorded_if_fast("roughness"); }
TEST_CASE("Stability: kernels at grazing angles", "[stability]") { require_recorded("grazing"); }
TEST_CASE("Stability: BRDF tables at their ends", "[stability][truth]") { require_recorded("brdf"); }
TEST_CASE("Stability: windows", "[stability][truth]") { require_recorded("windows"); }
TEST_CASE("Stability: turns", "[stability]") { require_recorded("rotation"); }
TEST_CASE("Stability: rays through a planet's air", "[stability][truth]") { require_recorded("sky-rays"); }
TEST_CASE("Stability: suns of any elevation", "[stability][truth]") { require_recorded_if_fast("sky-sun"); }
TEST_CASE("Stability: air of any density", "[stability][truth]") { require_recorded_if_fast("sky-air"); }
TEST_CASE("Stability: planets of any size", "[stability][truth]") { require_recorded_if_fast("sky-planet"); }

TEST_CASE("Every subject of the record is one of the suite", "[stability]") {
  std::set<std::string> subjects;
  for (const StabilitySubject& subject : stability_subjects()) subjects.insert(subject.name);
  const nlohmann::json golden = recorded();
  for (const auto& [name, value] : golden.items()) {
    CAPTURE(name);
    CHECK(subjects.contains(name.substr(0, name.find('/'))));
  }
}

TEST_CASE("The table of docs/notes/stability_table.md", "[.stability-table]") {
  std::vector<StabilityResult> results;
  for (const StabilitySubject& subject : stability_subjects()) {
    for (StabilityResult& result : run_stability(subject.name, false)) results.push_back(std::move(result));
  }
  const report::Machine machine = report::this_machine(report::Stopwatch{});
  std::ofstream("stability_table.md") << stability_markdown(
      results,
      {machine.date.substr(0, 10), machine.processor + ", " + machine.instruction_set + ", " + machine.compiler,
       "welkin_tests \"[.stability-table]\""});
}

TEST_CASE("The page has every case, the date, the machine and each advice once", "[stability]") {
  const std::vector<StabilityResult> results{
      {"range/a", "range", "promise a", "truth a", 2.5e-8, StabilityUnit::relative, 5e-7, true, "", ""},
      {"range/b", "range", "promise b", "truth b", 0.5, StabilityUnit::ulps, 0.0, false, "do this", ""},
      {"brdf/c", "brdf", "promise c", "truth c", std::numeric_limits<double>::infinity(), StabilityUnit::count, 0.0,
       false, "do this", "it threw"}};
  const std::string page = stability_markdown(results, {"2026-11-22", "a machine"});
  const auto says = [&](const std::string& text) { return page.find(text) != std::string::npos; };
  CHECK(says("2026-11-22"));
  CHECK(says("a machine"));
  CHECK(says("3, of which 1 hold"));
  CHECK(says("| a | promise a | truth a | 2.5e-08 | 5e-07 | yes |"));
  CHECK(says("| b | promise b | truth b | 0.5 ulp | 0 ulp | **no** |"));
  CHECK(says("infinite wrong"));
  CHECK(says("**range/b, brdf/c**: do this"));
  CHECK(page.find("do this") == page.rfind("do this"));
  CHECK(says("- brdf/c: it threw"));
}

}  // namespace welkin::test
