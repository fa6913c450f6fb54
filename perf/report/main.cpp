// The program welkin-report, which `welkin report` runs: error and time of each setting.

#include "embedded_texts.h"
#include "perf/report/passes.h"
#include "tools/arguments.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr const char* kDefaultPage = "report.html";

struct ReportCommandOptions {
  report::ReportOptions run;
  report::ComparisonOptions factors;
  std::string page;
  std::string json;
  std::string csv;
  std::string against;
  std::string environment;
  std::string node_modules;
  bool quick = false;
  bool no_peers = false;
};

/// Throws if a folder is missing: before minutes of work, not after them.
void require_folder(const std::string& path) {
  if (path.empty()) return;
  if (path == "-") throw Error(ErrorCode::invalid_argument, "'-' is no file; a report writes files alone");
  if (std::filesystem::is_directory(path))
    throw Error(ErrorCode::file_access, path + ": is a directory; name a file in it");
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (std::filesystem::is_directory(folder)) return;
  throw Error(ErrorCode::file_access, path + ": there is no folder " + folder.string() + "; make it first");
}

void settle(ReportCommandOptions& options) {
  if (options.quick) options.run.scale = "quick";
  options.run.peers = !options.no_peers;
  options.run.environment = options.environment;
  options.run.node_modules = options.node_modules;
  // If only raw figures are selected, there is no page.
  const bool raw = !options.json.empty() || !options.csv.empty();
  if (options.page.empty() && !raw) options.page = kDefaultPage;
  for (const std::string* path : {&options.page, &options.json, &options.csv}) require_folder(*path);
}

/// Refuses an older report of another scale or light before minutes of work, not after.
void require_comparable(const report::Report& older, const ReportCommandOptions& options) {
  if (older.scale != options.run.scale) {
    throw Error(ErrorCode::invalid_argument,
                options.against + ": is a report of scale '" + older.scale + "'; compare with --scale " + older.scale);
  }
  const std::string light = report::environment_name(options.run);
  if (older.environment != light) {
    throw Error(ErrorCode::invalid_argument,
                options.against + ": is a report on " + older.environment + ", this would be one on " + light);
  }
}

/// Writes the files. Returns one line per file.
std::string write(const ReportCommandOptions& options, const report::Report& measured,
                  const std::optional<report::Comparison>& comparison) {
  std::string said;
  const auto file = [&](const std::filesystem::path& path, const std::string& text) {
    write_text_file(path, text);
    said += path.string() + '\n';
  };
  if (!options.page.empty()) file(options.page, report::to_html(measured, comparison));
  if (!options.json.empty()) file(options.json, report::to_json(measured));
  if (!options.csv.empty()) file(options.csv, report::to_csv(measured));
  return said;
}

/// Returns text for a terminal: pass, target, recommended setting.
std::string recommended(const report::Report& measured) {
  std::string text = "Which setting to take, by rms error:\n";
  std::string last;
  for (const report::Recommendation& one : report::recommendations(measured)) {
    if (one.pass != last) text += "  " + one.pass + '\n';
    last = one.pass;
    text += "    " + pad_left(report::percent(one.target), 6) + "  ";
    if (!one.setting) {
      text += "none reaches it\n";
      continue;
    }
    text += report::label(*one.setting) + " (" + report::percent(one.setting->error_rms) + ", " +
            report::duration(one.setting->seconds) + ")\n";
  }
  return text;
}

std::string answer(ReportCommandOptions& options) {
  settle(options);
  std::optional<report::Report> older;
  if (!options.against.empty()) {
    older = report::read_report(options.against);
    require_comparable(*older, options);
  }
  report::Report measured;
  {
    ProgressBar bar;
    const Control control = bar.control();
    options.run.begins = begin_stage;
    measured = report::run_report(options.run, control);
  }
  std::optional<report::Comparison> comparison;
  if (older) comparison = report::compare(*older, measured, options.factors);
  std::string text = recommended(measured);
  for (const std::string& note : measured.notes) text += note + '\n';
  if (comparison) text += "\nAgainst " + options.against + ":\n" + report::to_text(*comparison);
  return text + "\nWritten:\n" + write(options, measured, comparison);
}

void add_output_files(Options& table, ReportCommandOptions& options) {
  add_option(table, "-o,--output", &options.page, "FILE.html",
             "The page to write; default report.html, or no page if only raw figures are requested");
  add_option(table, "--json", &options.json, "FILE", "Write the raw figures as JSON, which --against reads");
  add_option(table, "--csv", &options.csv, "FILE", "Write the raw figures as CSV");
}

void add_what_is_measured(Options& table, ReportCommandOptions& options) {
  std::string ids;
  for (const std::string& id : report::pass_ids()) ids.append(ids.empty() ? "" : ", ").append(id);
  constexpr const char* kScale = "--scale";
  table.push_back(choice<std::string>(
      kScale, options.run.scale, {{"tiny", "tiny"}, {"quick", "quick"}, {"full", "full"}},
      "How much is measured: tiny in seconds (for tests), quick in under a minute, full in minutes; "
      "default full. Errors depend on it"));
  add_option(table, "--quick", &options.quick, "", "--scale quick", {.excludes = {kScale}});
  add_option(table, "--passes", &options.run.passes, "LIST",
             "Measure only passes whose names begin with one of these: " + ids, {.list = List::commas_or_spaces});
  add_option(table, "--environment", &options.environment, "FILE",
             "Measure on this image instead of the built-in light");
  add_option(table, "--threads", &options.run.threads, "N",
             "Threads of the timed calls, 0 for all that this process may use; default 1, which measures "
             "CPU time, the most repeatable; more threads measure wall time",
             {.bounds = whole_between(0, 1024)});
}

void add_comparisons(Options& table, ReportCommandOptions& options) {
  constexpr const char* kAgainst = "--against";
  add_option(table, kAgainst, &options.against, "OLD.json", "Compare with the JSON of an earlier report");
  add_option(table, "--error-factor", &options.factors.error_factor, "X",
             "An error that grew by more than this is a regression (default 1.05)",
             {.bounds = number_between(1.0, 1e6), .needs = {kAgainst}});
  add_option(table, "--time-factor", &options.factors.time_factor, "X",
             "A time that grew by more than this is a regression (default 1.5)",
             {.bounds = number_between(1.0, 1e6), .needs = {kAgainst}});
  add_option(table, "--node-modules", &options.node_modules, "DIR",
             "The folder that holds node_modules with @babylonjs/core and three, to measure these too (Node.js)",
             {.environment = "WELKIN_NODE_MODULES"});
  add_option(table, "--no-peers", &options.no_peers, "", "Measure Welkin alone");
}

Command report_command() {
  const auto options = std::make_shared<ReportCommandOptions>();
  options->run.program = own_folder() / "welkin-report";  // a name without a folder is searched on the PATH
  Command command{"report", "Error against run time of every method and setting", embedded_text("help.txt")};
  add_output_files(command.options, *options);
  in_group(command.options, "Output");
  add_what_is_measured(command.options, *options);
  in_group(command.options, "What is measured");
  add_comparisons(command.options, *options);
  in_group(command.options, "Comparisons");
  command.everyday = {"--output",      "--json",    "--quick",   "--passes",
                      "--environment", "--threads", "--against", "--quiet"};
  command.run = [options](const Given& /*given*/) { print_result(answer(*options)); };
  return command;
}

}  // namespace
}  // namespace welkin::tool

int main(int count, char** words) {
  using welkin::tool::report_command, welkin::tool::run_guarded, welkin::tool::run_program;
  std::vector<std::string> arguments = {"report"};  // for the user it is a command of welkin
  for (std::string& word : welkin::tool::program_arguments(count, words)) arguments.push_back(std::move(word));
  return run_guarded([&]() -> welkin::tool::ExitCode {
    if (arguments.size() > 1 && arguments[1] == welkin::report::kFirstCall) {
      std::printf("%.9g\n", welkin::report::first_call_seconds(std::span(arguments).subspan(2)));
      return welkin::tool::success;
    }
    return run_program({"", "", {report_command()}}, arguments);
  });
}
