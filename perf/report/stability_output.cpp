#include "perf/report/stability_output.h"

#include <algorithm>
#include <cmath>

#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

using report::StabilityResult;

constexpr std::size_t kNameWidth = 38;
constexpr std::size_t kNumberWidth = 9;
constexpr std::size_t kUnitWidth = 9;

std::size_t holding(const std::vector<StabilityResult>& results) {
  return static_cast<std::size_t>(
      std::count_if(results.begin(), results.end(), [](const StabilityResult& result) { return result.holds; }));
}

std::string amount(double value) { return std::isinf(value) ? "infinite" : significant(value, 2); }

std::string line(const StabilityResult& result) {
  const std::string name = result.name.substr(result.subject.size() + 1);
  return "  " + pad_right(name, kNameWidth) + pad_left(amount(result.measured), kNumberWidth) +
         pad_left(amount(result.bound), kNumberWidth) + "  " + pad_right(report::name(result.unit), kUnitWidth) +
         (result.holds ? "holds" : "DOES NOT HOLD") + "\n";
}

Json json_case(const StabilityResult& result) {
  Json one;
  one["name"] = result.name;
  one["subject"] = result.subject;
  one["promise"] = result.promise;
  one["truth"] = result.truth;
  one["measured"] = std::isfinite(result.measured) ? Json(result.measured) : Json(nullptr);
  one["unit"] = report::name(result.unit);
  one["bound"] = result.bound;
  one["holds"] = result.holds;
  if (!result.advice.empty()) one["advice"] = result.advice;
  if (!result.failure.empty()) one["failure"] = result.failure;
  return one;
}

/// Of those that do not hold: what was promised, and what to do.
std::string remarks(const std::vector<StabilityResult>& results) {
  std::string text;
  for (const StabilityResult& result : results) {
    if (result.holds) continue;
    text += "\n  " + result.name + ": " + result.promise + " (against: " + result.truth + ")\n";
    if (!result.failure.empty()) text += "    failed: " + result.failure + "\n";
    if (!result.advice.empty()) text += "    " + result.advice + "\n";
  }
  return text;
}

/// Plain ASCII, a line a case, subject after subject; then what to do about those that do not hold.
std::string stability_table(const std::vector<StabilityResult>& results) {
  std::string text;
  std::string subject;
  for (const StabilityResult& result : results) {
    if (result.subject != subject) {
      subject = result.subject;
      text += "\n" + pad_right(subject, kNameWidth + 2) + pad_left("measured", kNumberWidth) +
              pad_left("bound", kNumberWidth) + "\n";
    }
    text += line(result);
  }
  text += "\n" + std::to_string(holding(results)) + " of " + counted(results.size(), "promise") + " hold.\n";
  return text + remarks(results);
}

/// {"date", "machine", "holding", "cases": [{"name", "subject", "promise", "truth", "measured", "unit", "bound",
/// "holds", "advice", "failure"}]}. An infinite error is null; advice and failure are there where there is one.
std::string stability_json(const std::vector<StabilityResult>& results, const report::StabilityOrigin& origin) {
  Json object;
  object["date"] = origin.date;
  object["machine"] = origin.machine;
  object["holding"] = holding(results);
  object["cases"] = Json::array();
  for (const StabilityResult& result : results) object["cases"].push_back(json_case(result));
  return json_text(object);
}

}  // namespace

std::string stability_text(const StabilityRequest& request) {
  ProgressBar bar;
  begin_stage("stability");
  const std::vector<StabilityResult> results = report::run_stability(request.suite, bar.control());
  switch (request.format) {
    case StabilityFormat::json: return stability_json(results, request.origin);
    case StabilityFormat::markdown: return report::stability_markdown(results, request.origin);
    case StabilityFormat::table: break;
  }
  return stability_table(results);
}

}  // namespace welkin::tool
