#include <nlohmann/json.hpp>

#include "embedded_texts.h"
#include "perf/report/report.h"
#include "welkin/core.h"

namespace welkin::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "welkin report";
constexpr int kVersion = 1;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{64} << 20U;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Json machine_json(const Machine& machine) {
  return {
      {"processor", machine.processor}, {"compiler", machine.compiler}, {"instruction_set", machine.instruction_set},
      {"welkin", machine.welkin},       {"clock", machine.clock},       {"date", machine.date},
      {"threads", machine.threads}};
}

Machine machine_from(const Json& json) {
  Machine machine;
  machine.processor = json.at("processor");
  machine.compiler = json.at("compiler");
  machine.instruction_set = json.at("instruction_set");
  machine.welkin = json.at("welkin");
  machine.clock = json.at("clock");
  machine.date = json.at("date");
  machine.threads = json.at("threads");
  return machine;
}

Json measurement_json(const Measurement& one, bool on_front) {
  return {{"pass", one.pass},
          {"method", one.method},
          {"setting", one.setting},
          {"error_rms", number(one.error_rms)},
          {"error_maximum", number(one.error_maximum)},
          {"seconds", number(one.seconds)},
          {"truth", one.truth},
          {"peer", one.peer.empty() ? Json(nullptr) : Json(one.peer)},
          {"on_front", on_front}};
}

Measurement measurement_from(const Json& json) {
  Measurement one;
  one.pass = json.at("pass");
  one.method = json.at("method");
  one.setting = json.at("setting");
  one.error_rms = number(json.at("error_rms"));
  one.error_maximum = number(json.at("error_maximum"));
  one.seconds = number(json.at("seconds"));
  one.truth = json.at("truth");
  if (!json.at("peer").is_null()) one.peer = json.at("peer");
  return one;
}

Json recommendation_json(const Recommendation& one) {
  Json json{{"pass", one.pass}, {"target", one.target}, {"method", nullptr}, {"setting", nullptr}};
  if (one.setting) {
    json["method"] = one.setting->method;
    json["setting"] = one.setting->setting;
  }
  return json;
}

/// Calls `visit(measurement, on_front)`, pass after pass.
template <typename Visit>
void each_measurement(const Report& report, const Visit& visit) {
  for (const Pass& pass : report.passes) {
    const std::vector<Measurement> measurements = of_pass(report, pass.id);
    const std::vector<std::size_t> front = pareto_front(measurements);
    for (std::size_t k = 0; k < measurements.size(); ++k) {
      visit(measurements[k], std::find(front.begin(), front.end(), k) != front.end());
    }
  }
}

/// Returns JSON with one line per element of arrays, for readers and diffs.
std::string lines_of(const Json& document) {
  std::string text = "{";
  const char* comma = "\n";
  const auto dump = [](const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); };
  for (const auto& [key, value] : document.items()) {
    text += comma + dump(Json(key)) + ": ";
    comma = ",\n";
    if (!value.is_array()) {
      text += dump(value);
      continue;
    }
    const char* between = "\n  ";
    text += "[";
    for (const Json& element : value) {
      text += between + dump(element);
      between = ",\n  ";
    }
    text += "]";
  }
  return text + "\n}\n";
}

/// Returns the text, quoted where RFC 4180 requires it.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string to_json(const Report& report) {
  Json document{{"format", kFormat},
                {"version", kVersion},
                {"machine", machine_json(report.machine)},
                {"scale", report.scale},
                {"environment", report.environment},
                {"notes", report.notes}};
  document["passes"] = Json::array();
  for (const Pass& pass : report.passes) {
    document["passes"].push_back(
        {{"id", pass.id}, {"title", pass.title}, {"task", pass.task}, {"error_meaning", pass.error_meaning}});
  }
  document["measurements"] = Json::array();
  each_measurement(report, [&](const Measurement& one, bool on_front) {
    document["measurements"].push_back(measurement_json(one, on_front));
  });
  document["recommendations"] = Json::array();
  for (const Recommendation& one : recommendations(report)) {
    document["recommendations"].push_back(recommendation_json(one));
  }
  return lines_of(document);
}

Report from_json(const std::string& text, const std::string& name) {
  try {
    const Json document = Json::parse(text);
    if (!document.is_object() || document.value("format", "") != kFormat || document.value("version", 0) != kVersion) {
      throw Error(ErrorCode::unsupported_file, name + ": is no report of version " + std::to_string(kVersion) +
                                                   "; 'welkin report --json FILE' writes one");
    }
    Report report;
    report.machine = machine_from(document.at("machine"));
    report.scale = document.at("scale");
    report.environment = document.at("environment");
    report.notes = document.at("notes").get<std::vector<std::string>>();
    for (const Json& pass : document.at("passes")) {
      report.passes.push_back({pass.at("id"), pass.at("title"), pass.at("task"), pass.at("error_meaning")});
    }
    for (const Json& one : document.at("measurements")) report.measurements.push_back(measurement_from(one));
    return report;
  } catch (const nlohmann::json::exception& trouble) {
    throw Error(ErrorCode::corrupt_file, name + ": is no whole report (" + trouble.what() + ")");
  }
}

Report read_report(const std::filesystem::path& path) {
  std::error_code trouble;
  const std::uintmax_t bytes = std::filesystem::file_size(path, trouble);
  std::ifstream stream(path, std::ios::binary);
  if (trouble || !stream) {
    throw Error(ErrorCode::file_access,
                path.string() + ": cannot be read; pass a file that 'welkin report --json FILE' wrote");
  }
  if (bytes > kLargestFile)
    throw Error(ErrorCode::limit_exceeded, path.string() + ": is above 64 MiB, which no report is");
  return from_json({std::istreambuf_iterator<char>(stream), {}}, path.string());
}

std::string to_csv(const Report& report) {
  std::string text = "pass,method,setting,peer,error_rms,error_maximum,seconds,on_front,truth\r\n";
  const auto digits = [](double value) { return std::isfinite(value) ? Json(value).dump() : std::string(); };
  each_measurement(report, [&](const Measurement& one, bool on_front) {
    text += csv_cell(one.pass) + ',' + csv_cell(one.method) + ',' + csv_cell(one.setting) + ',' + csv_cell(one.peer) +
            ',' + digits(one.error_rms) + ',' + digits(one.error_maximum) + ',' + digits(one.seconds) + ',' +
            (on_front ? "1," : "0,") + csv_cell(one.truth) + "\r\n";
  });
  return text;
}

namespace {

/// Returns one list of all changes, in the order of their importance.
Json json_of(const Comparison& comparison) {
  Json changes = Json::array();
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

void put(std::string& page, std::string_view marker, const std::string& text) {
  page.replace(page.find(marker), marker.size(), text);
}

}  // namespace

std::string to_html(const Report& report, const std::optional<Comparison>& comparison) {
  Json document = Json::parse(to_json(report));
  if (comparison) document["comparison"] = json_of(*comparison);
  std::string safe;  // a script must not contain what looks like its end
  for (const char c : document.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    safe += c == '<' ? "\\u003c" : std::string(1, c);
  }
  std::string page = tool::embedded_text("page.html");
  put(page, "\nPLOT\n", '\n' + std::string(tool::embedded_text("plot.js")) + '\n');
  put(page, "REPORT", safe);
  return page;
}

}  // namespace welkin::report
