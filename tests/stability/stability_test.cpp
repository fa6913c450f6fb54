// Promise: every case of the stability suite is as exact as it is on record (tests/data/stability.json): no error grew,
// no promise broke, no case is gone. After a change that alters errors for a stated reason, WELKIN_RECORD_GOLDEN=1
// writes the file again: `welkin_tests "[stability]"`, all in one process.
#include <nlohmann/json.hpp>

#include "perf/report/measuring.h"
#include "places.h"
#include "stability/cases.h"
#include "standard_headers.h"
#include "support/trials.h"

namespace welkin::test {
namespace {

using stability::StabilityUnit;

// The suite: all cases in order, each measured or caught.

/// A measured case.
struct StabilityResult {
  std::string name;       ///< subject/case, unique
  std::string subject;    ///< one of `kSubjects`
  std::string promise;    ///< what is promised there
  std::string truth;      ///< what it is measured against
  double measured = 0.0;  ///< infinity: an answer was not finite, or none came (`failure` says why)
  StabilityUnit unit = StabilityUnit::relative;
  double bound = 0.0;
  bool holds = false;   ///< measured <= bound
  std::string advice;   ///< where the promise cannot hold in float: what to do instead; else empty
  std::string failure;  ///< what was thrown, if the case did not end
};

/// A group of cases.
struct Subject {
  const char* name;
  const char* sentence;  ///< for the page
  void (*add)(stability::StabilityCases&);
};

constexpr Subject kSubjects[] = {
    {"range", "Projection to spherical harmonics of maps with extreme values.", stability::add_range_cases},
    {"image-range",
     "Mips, resampled and prefiltered maps with extreme values. \"Each texel\" is the largest error over "
     "the truth at that texel; rms is the error of a mip as a whole.",
     stability::add_image_range_cases},
    {"cancellation", "Sums whose terms are large and whose result is small.", stability::add_cancellation_cases},
    {"accumulation", "Sums over 256 to 400 million texels: errors must not grow with their number.",
     stability::add_accumulation_cases},
    {"policies", "NaN, infinities and negatives: each policy does what it says, in every pass that reads pixels.",
     stability::add_policy_cases},
    {"sizes", "Maps, tables and chains of 1 and 2 texels.", stability::add_size_cases},
    {"roughness", "Lobes from a point to the whole hemisphere.", stability::add_roughness_cases},
    {"grazing", "Cosine and GGX kernels over a sphere that is lit above the horizon only.",
     stability::add_grazing_cases},
    {"brdf", "The split sum's table at grazing views (DFG).", stability::add_brdf_cases},
    {"windows", "Least windows that are hard to find, by light that is hardly or nearly all negative.",
     stability::add_window_cases},
    {"rotation", "Turns of coefficients.", stability::add_rotation_cases},
    {"sky-rays", "Rays that graze a planet; the horizon from both sides.", stability::add_sky_ray_cases},
    {"sky-sun", "Suns from the zenith to the nadir. Tables of single scattering with 8 heights, unless stated.",
     stability::add_sky_sun_cases},
    {"sky-air", "Air of any density and height, lobes of any sharpness, many orders.", stability::add_sky_air_cases},
    {"sky-planet", "Planets of any size, seen from the ground to far away.", stability::add_sky_planet_cases}};

StabilityResult measured(const std::string& subject, const stability::StabilityCase& one) {
  StabilityResult result{one.name,       subject,         one.promise, one.truth,        0.0,
                         one.terms.unit, one.terms.bound, false,       one.terms.advice, {}};
  try {
    result.measured = one.measure();
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  if (std::isnan(result.measured) || !result.failure.empty()) {
    result.measured = std::numeric_limits<double>::infinity();
  }
  result.holds = result.measured <= result.bound;
  return result;
}

/// Runs a subject's cases in order; `quick` leaves out those that take long or much memory (faces of 2048 to 8192). An
/// exception in a case is its result (`failure`) and does not end the run.
std::vector<StabilityResult> run_stability(const std::string& subject, bool quick) {
  stability::StabilityCases cases(subject);
  for (const Subject& known : kSubjects) {
    if (subject == known.name) known.add(cases);
  }
  std::vector<StabilityResult> results;
  for (const stability::StabilityCase& one : cases.all()) {
    if (!quick || one.terms.effort != stability::Effort::full) results.push_back(measured(subject, one));
  }
  return results;
}

// docs/notes/stability_table.md: a table per subject, then what does not hold and what to do. Paragraphs are wrapped at
// 120 columns.

/// Where and when something was measured, for the page.
struct StabilityOrigin {
  std::string date;       ///< 2026-11-22
  std::string machine;    ///< processor, instruction set, compiler
  std::string command{};  ///< that made the page
};

/// Returns two significant digits in any locale.
std::string number(double value) {
  if (std::isinf(value)) return "infinite";
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 2);
  return {text, end.ptr};
}

/// Wraps text to lines of at most 120 columns.
std::string wrapped(const std::string& text) {
  constexpr std::size_t width = 120;
  std::string lines;
  std::size_t column = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::size_t length = end - start;
    if (column > 0) lines += column + 1 + length > width ? '\n' : ' ';
    column = column == 0 || column + 1 + length > width ? length : column + 1 + length;
    lines += text.substr(start, length);
    start = end + 1;
  }
  return lines + '\n';
}

std::string amount(double value, StabilityUnit unit) {
  switch (unit) {
    case StabilityUnit::relative: return number(value);
    case StabilityUnit::ulps: return number(value) + " ulp";
    case StabilityUnit::count: return number(value) + " wrong";
    case StabilityUnit::ratio: return number(value) + " x";
  }
  return number(value);
}

std::string row(const StabilityResult& result) {
  const std::string name = result.name.substr(result.subject.size() + 1);
  return "| " + name + " | " + result.promise + " | " + result.truth + " | " + amount(result.measured, result.unit) +
         " | " + amount(result.bound, result.unit) + " | " + (result.holds ? "yes" : "**no**") + " |\n";
}

std::string table(const std::vector<StabilityResult>& results, const Subject& subject) {
  std::string text;
  for (const StabilityResult& result : results) {
    if (result.subject == subject.name) text += row(result);
  }
  if (text.empty()) return text;
  return std::string("\n## ") + subject.name + "\n\n" + wrapped(subject.sentence) +
         "\n| case | promise | against | measured | bound | holds |\n|---|---|---|---|---|---|\n" + text;
}

/// Returns each advice once, with all of its cases that do not hold.
std::string advice(const std::vector<StabilityResult>& results) {
  std::vector<std::string> seen;
  std::string text;
  for (const StabilityResult& result : results) {
    if (result.holds || result.advice.empty() || std::find(seen.begin(), seen.end(), result.advice) != seen.end())
      continue;
    seen.push_back(result.advice);
    std::string names;
    for (const StabilityResult& other : results) {
      if (!other.holds && other.advice == result.advice) names += (names.empty() ? "" : ", ") + other.name;
    }
    text += '\n' + wrapped("**" + names + "**: " + result.advice);
  }
  return text.empty() ? text : "\n## What does not hold, and what to do\n" + text;
}

std::string failures(const std::vector<StabilityResult>& results) {
  std::string text;
  for (const StabilityResult& result : results) {
    if (!result.failure.empty()) text += "- " + result.name + ": " + result.failure + "\n";
  }
  return text.empty() ? text : "\n## Cases that did not end\n\n" + text;
}

std::string stability_markdown(const std::vector<StabilityResult>& results, const StabilityOrigin& origin) {
  const auto held =
      std::count_if(results.begin(), results.end(), [](const StabilityResult& result) { return result.holds; });
  std::string text = "# Stability: the table\n\n" +
                     wrapped(
                         "This page lists what Welkin promises for extreme numbers, the truth that each promise was "
                         "held against, and the error that was measured. A command writes the page. The summary for "
                         "people is [stability.md](../reference/stability.md).") +
                     "\n- Command: `" + origin.command + "`\n- Date: " + origin.date +
                     "\n- Machine: " + origin.machine + "\n- Cases: " + std::to_string(results.size()) + ", of which " +
                     std::to_string(held) + " hold; the end of the page says what to do about the others\n\n" +
                     wrapped(
                         "A number without a unit is a relative error. \"ulp\" is a unit in the last place of a float. "
                         "\"wrong\" counts answers that are wrong. \"x\" says how many times an error grew. The "
                         "library gives the same bits on every machine. The figures therefore depend on the machine "
                         "above only in the last bits of truths that use its mathematical library. `tests/stability` "
                         "holds the quick cases: a test fails if an error doubles, a promise breaks or a case "
                         "disappears.");
  for (const Subject& subject : kSubjects) text += table(results, subject);
  return text + advice(results) + failures(results);
}

// Errors against those on record.

/// Maximum ratio of an error to the recorded one. The library's bits are the same everywhere; the last bits of the
/// references depend on the machine's mathematical library.
constexpr double kMaxGrowth = 2.0;

/// Returns the error below which the references' rounding dominates; smaller errors count as equal.
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

/// Measures subjects that take many seconds, unless sanitizers make minutes of them; other tests there call the same
/// code.
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
  for (const Subject& subject : kSubjects) subjects.insert(subject.name);
  const nlohmann::json golden = recorded();
  for (const auto& [name, value] : golden.items()) {
    CAPTURE(name);
    CHECK(subjects.contains(name.substr(0, name.find('/'))));
  }
}

TEST_CASE("The table of docs/notes/stability_table.md", "[.stability-table]") {
  std::vector<StabilityResult> results;
  for (const Subject& subject : kSubjects) {
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
