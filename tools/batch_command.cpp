// `welkin batch`: many environments, on one machine or on many.
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "platform/text.h"
#include "tools/batch_inputs.h"
#include "tools/batch_merge.h"
#include "tools/batch_plan.h"
#include "tools/batch_progress.h"
#include "tools/batch_run.h"
#include "tools/batch_status.h"
#include "tools/batch_words.h"
#include "tools/commands.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr const char* kBatchFooter =
    R"(What it does:
  plan     looks at the headers of all inputs, predicts what their bakes cost,
           and writes a plan, jobs.json
  run      bakes what the plan names and is not there yet; with --shard the I-th
           of N parts, which take about equally long
  status   says what is done, left and failed
  merge    checks every file of every result, and writes an index and a page of
           pictures; with --allow-missing of those that are there

Examples:
  welkin batch plan hdr/ -o jobs.json --size 256 --for three
  welkin batch plan 'hdr/**/*.exr' --list more.jsonl -o jobs.json
  welkin batch run jobs.json
  welkin batch run jobs.json --shard 3/16 --results /farm/results
  welkin batch status jobs.json
  welkin batch merge jobs.json -o index

Plan: inputs are files, folders (all pictures below them) and patterns that the
  shell did not expand. Options of 'welkin bake' hold for all; each line of a
  --list is {"input": PATH, "name": NAME, "options": ["--size", "128"]}, and its
  options take the place of those; files are beside the list. An input that is
  named here and not there is an error; of a list it is told, and stays in the
  plan.

Run: a result is a folder, named by the hash of its input's bytes, its options
  and the version of results. It is written beside and then gets its name, so it
  is whole or absent. What is there is not made again: a run that was killed goes
  on, and several share. An input that fails stands in the report, which is in
  RESULTS/reports, and stops no other. RESULTS/by-name has a link to each result
  by its job's name, where the system has links.

Exit codes: 1 if an input failed, a result is missing or damaged, or differs.
docs/batches.md has the files' formats, clusters, and figures.)";

enum class Action { plan, run, status, merge };

struct BatchCommandOptions {
  Action action = Action::plan;
  std::vector<std::string> inputs;
  std::string output;
  std::optional<std::string> list;
  std::string shard = "1/1";
  std::string results;
  std::uint64_t memory = std::uint64_t{8} << 30U;
  double verify = 0.0;
  bool allow_missing = false;
  CommonOptions common;
  BakeCommandOptions bake;  ///< of all jobs: read to be checked
};

Shard shard_in(const std::string& text) {
  const std::size_t slash = text.find('/');
  Shard shard;
  if (slash != std::string::npos) {
    shard.number = whole_number_in(text.substr(0, slash)).value_or(0);
    shard.count = whole_number_in(text.substr(slash + 1)).value_or(0);
  }
  if (slash == std::string::npos || shard.number < 1 || shard.number > shard.count || shard.count > kMostShards) {
    throw Error(ErrorCode::invalid_argument,
                "--shard: " + text + " is not I/N with I from 1 to N, such as 3/16 for the third of 16");
  }
  return shard;
}

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, "batch " + what); }

/// The one plan that is named.
BatchPlan plan_named(const BatchCommandOptions& options, const std::string& action) {
  if (options.inputs.size() != 1) refuse(action + ": name one plan, which 'welkin batch plan' has written");
  return read_batch_plan(platform::path_of(options.inputs.front()));
}

std::filesystem::path results_of(const BatchCommandOptions& options, const BatchPlan& plan) {
  return options.results.empty() ? plan.default_results() : platform::path_of(options.results);
}

// ---- plan

std::string plan_summary(const BatchPlan& plan) {
  std::uint64_t memory = 0;
  std::string errors;
  std::size_t count = 0;
  for (const BatchJob& job : plan.jobs) {
    memory = std::max(memory, job.memory);
    if (job.error.empty()) continue;
    ++count;
    errors += "error: " + printable(job.error) + '\n';
  }
  constexpr unsigned kMebi = 20;
  return platform::utf8(plan.file) + ": " + counted(plan.jobs.size(), "job") + ", predicted to take " +
         long_duration(plan.seconds()) + " of one core, the largest " + std::to_string(memory >> kMebi) + " MiB\n" +
         errors + (count > 0 ? "note: " + counted(count, "input") + " cannot be read now\n" : "");
}

void plan_action(const BatchCommandOptions& options) {
  if (options.output.empty()) refuse("plan: -o names the plan to write, such as -o jobs.json");
  const BatchPlan plan =
      plan_batch({options.inputs, options.list, words_for_jobs(command_words())}, platform::path_of(options.output));
  write_batch_plan(plan);
  print_summary(plan_summary(plan));
}

// ---- run

Json outcome_json(const BatchOutcome& outcome) {
  return {{"jobs", outcome.jobs},         {"computed", outcome.computed},
          {"present", outcome.present},   {"failed", outcome.failed},
          {"verified", outcome.verified}, {"differs", outcome.differs},
          {"seconds", outcome.seconds},   {"report", platform::utf8(outcome.report)}};
}

std::string outcome_text(const BatchOutcome& outcome) {
  std::string text = counted(outcome.jobs, "job") + ": " + std::to_string(outcome.computed) + " computed, " +
                     std::to_string(outcome.present) + " present, " + std::to_string(outcome.failed) + " failed";
  if (outcome.verified + outcome.differs > 0) {
    text += ", " + std::to_string(outcome.verified) + " verified, " + std::to_string(outcome.differs) + " differ";
  }
  text += "; " + significant(outcome.seconds, 3) + " s";
  if (outcome.computed > 0 && outcome.seconds > 0.0) {
    text += ", " + significant(static_cast<double>(outcome.computed) / outcome.seconds, 3) + " a second";
  }
  return text + "\nreport: " + platform::utf8(outcome.report) + '\n';
}

void run_action(const BatchCommandOptions& options) {
  const BatchPlan plan = plan_named(options, "run");
  const BatchRun run{results_of(options, plan), shard_in(options.shard), thread_count(options.common), options.memory,
                     options.verify};
  const BatchOutcome outcome = run_batch(plan, run);
  if (options.common.json) {
    print_result(json_text(outcome_json(outcome)));
  } else {
    print_summary(outcome_text(outcome));
  }
  if (outcome.well()) return;
  std::string message = counted(outcome.failed + outcome.differs, "job") + " of " + std::to_string(outcome.jobs) +
                        (outcome.failed > 0 ? " failed" : " differ");
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < std::min(kShown, outcome.troubles.size()); ++i) {
    const JobRecord& record = outcome.troubles[i];
    message += "\n" + record.name + ": " + record.error;
  }
  if (outcome.troubles.size() > kShown) message += "\n... the report has all of them";
  throw Error(ErrorCode::corrupt_file, message);
}

// ---- status and merge

void status_action(const BatchCommandOptions& options) {
  const BatchPlan plan = plan_named(options, "status");
  const BatchStatus status = status_of(plan, results_of(options, plan));
  print_result(options.common.json ? json_text(status_json(status)) : status_text(status));
  if (status.troubles.empty()) return;
  throw Error(ErrorCode::corrupt_file,
              counted(status.troubles.size(), "job") + " of " + std::to_string(status.jobs) + " failed or differ");
}

/// Returns a line for each result that is not in order.
std::string problems_text(const BatchPlan& plan, const MergedBatch& merged) {
  std::string text;
  for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
    const std::string& problem = merged.results[job].problem;
    if (!problem.empty()) text += '\n' + plan.jobs[job].name + ": " + problem;
  }
  return text;
}

void merge_action(const BatchCommandOptions& options) {
  if (options.output.empty()) refuse("merge: -o names the folder to write, such as -o index");
  const BatchPlan plan = plan_named(options, "merge");
  const std::filesystem::path folder = platform::path_of(options.output);
  require_index_place(folder);
  MergedBatch merged;
  {
    ProgressBar bar;
    merged = check_batch(plan, results_of(options, plan), thread_count(options.common), bar.control());
  }
  if (merged.damaged > 0 || (merged.missing > 0 && !options.allow_missing)) {
    const std::size_t problems = merged.damaged + merged.missing;
    throw Error(ErrorCode::corrupt_file, counted(problems, "result") + " of " + std::to_string(plan.jobs.size()) +
                                             (problems == 1 ? " is" : " are") + " missing or damaged" +
                                             (merged.damaged == 0 ? "; --allow-missing merges the others" : "") +
                                             problems_text(plan, merged));
  }
  write_batch_index(plan, merged, folder);
  if (options.common.json) {
    print_result(json_text({{"jobs", plan.jobs.size()}, {"missing", merged.missing}, {"hash", merged.hash().text()}}));
  } else {
    print_summary(counted(plan.jobs.size() - merged.missing, "result") + " in order; the batch's hash is " +
                  merged.hash().text() +
                  (merged.missing > 0 ? "\nnote: " + counted(merged.missing, "result") + " missing" +
                                            printable_lines(problems_text(plan, merged))
                                      : "") +
                  "\nindex: " + platform::utf8(folder / "index.json") + ", " + platform::utf8(folder / "index.html") +
                  '\n');
  }
}

Options batch_options(BatchCommandOptions& options) {
  Options table;
  Option action = choice<Action>(
      "ACTION", options.action,
      {{"plan", Action::plan}, {"run", Action::run}, {"status", Action::status}, {"merge", Action::merge}},
      "What is to be done");
  action.required = true;
  action.hint = [](const std::string& word) {
    std::error_code unknown;
    const std::filesystem::path path = platform::path_of(word);
    const bool is_input = std::filesystem::exists(path, unknown) || is_pattern(word) || is_picture_name(path);
    return is_input ? "; did you mean 'welkin batch plan " + word + "'?" : std::string();
  };
  table.push_back(std::move(action));
  table.push_back({.names = "INPUT",
                   .target = &options.inputs,
                   .text = "Pictures, folders of them and patterns to plan; for other actions the plan",
                   .list = List::commas_or_spaces});
  table.push_back({.names = "-o,--output",
                   .target = &options.output,
                   .text = "The plan to write, or the folder that merge writes to",
                   .type = "PATH"});
  table.push_back({.names = "--list",
                   .target = &options.list,
                   .text = "A file of JSON lines to plan, an input each with its options",
                   .type = "FILE"});
  table.push_back({.names = "--results",
                   .target = &options.results,
                   .text = "The folder of results; default: beside the plan, jobs.results for jobs.json",
                   .type = "DIR"});
  table.push_back({.names = "--shard",
                   .target = &options.shard,
                   .text = "The I-th of N parts to run, which are predicted to take equally long; default 1/1",
                   .type = "I/N"});
  table.push_back({.names = "--verify",
                   .target = &options.verify,
                   .text = "The share of results that run computes once more and compares; default 0",
                   .type = "SHARE",
                   .bounds = finite_between(0.0, 1.0)});
  table.push_back({.names = "--allow-missing",
                   .target = &options.allow_missing,
                   .text = "Merge the results that are there; the index and the page name those that are missing"});
  table.push_back({.names = "--memory",
                   .target = ByteCount{&options.memory},
                   .text = "The most memory that bakes may take at a time, by prediction (default 8GiB); one "
                           "that would need more by itself fails",
                   .type = "SIZE",
                   .group = kRunningGroup});
  add_json_option(table, options.common);
  in_group(table, "The batch");
  add_threads_option(table, options.common);
  for (Option& option : job_options(options.bake)) table.push_back(std::move(option));
  return table;
}

/// What the action would pass over is refused, so that nobody thinks that it was heeded.
void refuse_others(Action action, const Given& given) {
  std::vector<std::string> others;
  if (action == Action::plan) {
    others = {"--results", "--shard", "--verify", "--allow-missing", "--memory", "--json"};
  } else {
    BakeCommandOptions unused;
    for (const Option& option : job_options(unused)) others.push_back(option.names.substr(0, option.names.find(',')));
    others.emplace_back("--list");
    if (action != Action::merge) others.emplace_back("--output");
    if (action != Action::merge) others.emplace_back("--allow-missing");
    if (action != Action::run) others.insert(others.end(), {"--shard", "--verify", "--memory"});
  }
  constexpr std::array kActions{"plan", "run", "status", "merge"};
  for (const std::string& name : others) {
    if (!given(name)) continue;
    refuse(std::string(kActions.at(static_cast<std::size_t>(action))) + " does not take " + name +
           (action == Action::run ? "; 'welkin batch plan' says what is baked, and how" : ""));
  }
}

}  // namespace

Command batch_command() {
  const auto options = std::make_shared<BatchCommandOptions>();
  Command command{"batch", "Bake many environments, on one machine or on many", kBatchFooter};
  command.options = batch_options(*options);
  command.everyday = {"ACTION",  "INPUT",     "--output",        "--list",    "--results",
                      "--shard", "--verify",  "--allow-missing", "--memory",  "--json",
                      "--size",  "--formats", "--for",           "--threads", "--quiet"};
  command.run = [options](const Given& given) {
    refuse_others(options->action, given);
    switch (options->action) {
      case Action::plan: plan_action(*options); break;
      case Action::run: run_action(*options); break;
      case Action::status: status_action(*options); break;
      case Action::merge: merge_action(*options); break;
    }
  };
  return command;
}

}  // namespace welkin::tool
