#include "tools/report_command.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report/comparison.h"
#include "report/front.h"
#include "report/machine.h"
#include "report/number_words.h"
#include "report/plot_svg.h"
#include "report/report_json.h"
#include "report/report_page.h"
#include "report/run_report.h"
#include "report/stability.h"
#include "report/stopwatch.h"
#include "tools/help_text.h"
#include "tools/number_text.h"
#include "tools/options.h"
#include "tools/output.h"
#include "tools/progress_bar.h"
#include "tools/report_calibrate.h"
#include "tools/report_stability.h"
#include "tools/text_file.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr const char* kDefaultPage = "report.html";

struct ReportCommandOptions {
  report::ReportOptions run;
  report::ComparisonOptions factors;
  std::string page;
  std::string json;
  std::string csv;
  std::string plots;
  std::string against;
  std::string environment;
  std::string node_modules;
  bool quick = false;
  bool no_peers = false;
  bool stability = false;
  bool calibrate = false;
  std::string stability_subject;
};

/// The folders must be there before minutes of work, not after.
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
  // Raw figures that were asked for alone need no page beside them.
  const bool raw = !options.json.empty() || !options.csv.empty() || !options.plots.empty();
  if (options.page.empty() && !raw) options.page = kDefaultPage;
  for (const std::string* path : {&options.page, &options.json, &options.csv}) require_folder(*path);
  if (options.plots.empty()) return;
  std::error_code failure;
  std::filesystem::create_directories(options.plots, failure);
  if (failure)
    throw Error(ErrorCode::file_access, options.plots + ": no folder can be made (" + failure.message() + ")");
}

/// An older report of another scale or light is refused before minutes of work, not after.
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

/// What was written, a line each.
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
  if (options.plots.empty()) return said;
  for (const report::Pass& pass : measured.passes) {
    const std::vector<report::Measurement> members = report::of_pass(measured, pass.id);
    const std::string plot = report::plot_svg(pass, members, measured.machine, report::PlotUse::file);
    if (!plot.empty()) file(std::filesystem::path(options.plots) / (pass.id + ".svg"), plot);
  }
  return said;
}

/// For a terminal: pass, target, what to take.
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

/// Of what writes one file.
const std::string& one_output(const ReportCommandOptions& options) {
  if (!options.json.empty() && !options.page.empty())
    throw Error(ErrorCode::invalid_argument, "one file is written: pass -o or --json, not both");
  return options.json.empty() ? options.page : options.json;
}

/// The stability suite instead of a report: a table for a person, or JSON into the file that --json names.
std::string stability(const ReportCommandOptions& options) {
  const report::Machine machine = report::this_machine(report::Stopwatch{});
  StabilityRequest request;
  request.suite = {options.quick || options.run.scale != "full", options.stability_subject};
  request.origin = {machine.date.substr(0, 10),
                    machine.processor + ", " + machine.instruction_set + ", " + machine.compiler,
                    std::string("welkin report --stability") + (request.suite.quick ? " --quick" : "") +
                        (options.stability_subject.empty() ? "" : " --stability-subject " + options.stability_subject) +
                        (options.page.empty() ? "" : " -o " + options.page)};
  const std::string& file = one_output(options);
  if (!options.json.empty()) request.format = StabilityFormat::json;
  if (options.json.empty() && !options.page.empty()) request.format = StabilityFormat::markdown;
  require_folder(file);
  const std::string text = report_stability(request);
  if (file.empty()) return text;
  write_text_file(file, text);
  return file + '\n';
}

/// What work costs here, into the file that -o or --json names.
std::string calibration(const ReportCommandOptions& options) {
  const std::string& file = one_output(options);
  require_folder(file);
  return report_costs(file);
}

std::string answer(ReportCommandOptions& options) {
  if (options.stability) return stability(options);
  if (options.calibrate) return calibration(options);
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
    measured = report::run_report(options.run, control);
  }
  std::optional<report::Comparison> comparison;
  if (older) comparison = report::compare(*older, measured, options.factors);
  std::string text = recommended(measured);
  for (const std::string& note : measured.notes) text += note + '\n';
  if (comparison) text += "\nAgainst " + options.against + ":\n" + report::to_text(*comparison);
  return text + "\nWritten:\n" + write(options, measured, comparison);
}

void add_output_files(CLI::App& command, ReportCommandOptions& options) {
  command
      .add_option("-o,--output", options.page, "The page (default report.html; none if only raw figures are asked for)")
      ->type_name("FILE.html");
  command.add_option("--json", options.json, "Raw figures as JSON, which --against reads")->type_name("FILE");
  command.add_option("--csv", options.csv, "Raw figures as CSV")->type_name("FILE");
  command.add_option("--plots", options.plots, "Each plot as an SVG file, in this folder")->type_name("DIR");
}

void add_what_is_measured(CLI::App& command, ReportCommandOptions& options) {
  std::string ids;
  for (const std::string& id : report::pass_ids()) ids.append(ids.empty() ? "" : ", ").append(id);
  CLI::Option* const scale = add_choice<std::string>(
      command, "--scale", options.run.scale, {{"tiny", "tiny"}, {"quick", "quick"}, {"full", "full"}},
      "How much is measured: tiny in seconds (for tests), quick in under a minute, full (default) "
      "in minutes. Errors depend on it");
  command.add_flag("--quick", options.quick, "--scale quick")->excludes(scale);
  command.add_option("--passes", options.run.passes, "Measure only passes whose names begin with one of these: " + ids)
      ->delimiter(',')
      ->type_name("LIST");
  command.add_option("--environment", options.environment, "Measure on this picture instead of the built-in light")
      ->type_name("FILE");
  command
      .add_option(
          "--threads", options.run.threads,
          "Threads that timed calls work with (default 1, by processor time, which repeats best; else by wall time); "
          "0: all that this process may use")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N");
}

void add_stability(CLI::App& command, ReportCommandOptions& options) {
  CLI::Option* const suite = command.add_flag(
      "--stability", options.stability,
      "Extreme and stiff cases instead: what is promised, what was measured. A table; JSON with --json, "
      "Markdown with -o. --quick leaves out what takes long");
  for (const char* other : {"--csv", "--plots", "--passes", "--environment", "--threads", "--against"}) {
    suite->excludes(command.get_option(other));
  }
  command.add_option("--stability-subject", options.stability_subject, "Only this subject's cases")
      ->check(CLI::IsMember(report::stability_subjects()).description(""))
      ->needs(suite)
      ->type_name(CLI::detail::join(report::stability_subjects(), "|"));
}

void add_calibration(CLI::App& command, ReportCommandOptions& options) {
  CLI::Option* const calibrate = command.add_flag(
      "--calibrate", options.calibrate,
      "Measure what work costs on this machine instead, for the plans of 'welkin bake --costs': JSON, printed or with "
      "-o into a file; some four seconds on one thread");
  for (const char* other : {"--stability", "--scale", "--quick", "--csv", "--plots", "--passes", "--environment",
                            "--threads", "--against"}) {
    calibrate->excludes(command.get_option(other));
  }
}

void add_comparisons(CLI::App& command, ReportCommandOptions& options) {
  CLI::Option* const against = command.add_option("--against", options.against,
                                                  "An earlier report's JSON: what has become worse or better since");
  against->type_name("OLD.json");
  command
      .add_option("--error-factor", options.factors.error_factor,
                  "An error that grew by more than this is a regression (default 1.05)")
      ->check(finite_between(1.0, 1e6))
      ->needs(against)
      ->type_name("X");
  command
      .add_option("--time-factor", options.factors.time_factor,
                  "A time that grew by more than this is a regression (default 1.5)")
      ->check(finite_between(1.0, 1e6))
      ->needs(against)
      ->type_name("X");
  command
      .add_option("--node-modules", options.node_modules,
                  "The folder that holds node_modules with @babylonjs/core and three, to measure these too (Node.js)")
      ->envname("WELKIN_NODE_MODULES")
      ->type_name("DIR");
  command.add_flag("--no-peers", options.no_peers, "Measure Welkin alone");
}

}  // namespace

void add_report_command(CLI::App& program) {
  const auto options = std::make_shared<ReportCommandOptions>();
  CLI::App& command = *program.add_subcommand("report", "Error against run time of every method and setting");
  command.footer(std::string(kReportFooter));
  add_output_files(command, *options);
  add_what_is_measured(command, *options);
  add_comparisons(command, *options);
  add_stability(command, *options);
  add_calibration(command, *options);
  command.callback([options] { print_result(answer(*options)); });
}

}  // namespace welkin::tool
