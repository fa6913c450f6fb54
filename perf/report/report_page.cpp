#include "perf/report/report_page.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "embedded_texts.h"
#include "perf/report/report_json.h"

namespace welkin::report {
namespace {

using Json = nlohmann::ordered_json;

/// One list of all that has changed, in the order of its weight.
Json json_of(const Comparison& comparison) {
  Json changes = Json::array();
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  const auto add = [&](const std::vector<Change>& all, const char* what, const char* kind, double Measurement::*value) {
    for (const Change& change : all) {
      changes.push_back({{"what", what},
                         {"kind", kind},
                         {"pass", change.after.pass},
                         {"label", label(change.after)},
                         {"before", number(change.before.*value)},
                         {"after", number(change.after.*value)},
                         {"is_time", value == &Measurement::seconds}});
    }
  };
  add(comparison.worse_error, "larger error", "worse", &Measurement::error_rms);
  add(comparison.slower, "slower", "worse", &Measurement::seconds);
  add(comparison.better_error, "smaller error", "better", &Measurement::error_rms);
  add(comparison.faster, "faster", "better", &Measurement::seconds);
  for (const auto& [all, what] :
       {std::pair(&comparison.gone, "no longer measured"), std::pair(&comparison.added, "new")}) {
    for (const Measurement& one : *all) {
      changes.push_back({{"what", what}, {"kind", ""}, {"pass", one.pass}, {"label", label(one)}});
    }
  }
  return {{"compared", comparison.compared},
          {"times_refused", comparison.times_refused},
          {"regressed", comparison.regressed()},
          {"changes", changes}};
}

void put(std::string& page, std::string_view place, const std::string& text) {
  page.replace(page.find(place), place.size(), text);
}

}  // namespace

std::string to_html(const Report& report, const std::optional<Comparison>& comparison) {
  Json document = Json::parse(to_json(report));
  if (comparison) document["comparison"] = json_of(*comparison);
  std::string safe;  // in a script nothing may look like its end
  for (const char c : document.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    safe += c == '<' ? "\\u003c" : std::string(1, c);
  }
  std::string page = tool::embedded_text("page.html");
  put(page, "\nPLOT\n", '\n' + std::string(tool::embedded_text("plot.js")) + '\n');
  put(page, "REPORT", safe);
  return page;
}

}  // namespace welkin::report
