// `welkin batch`: many environments, on one machine or on many.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "embedded_texts.h"
#include "platform/text.h"
#include "tools/arguments.h"
#include "tools/bake_manifest.h"
#include "tools/batch.h"
#include "tools/commands.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {

namespace {

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
  if (slash == std::string::npos || shard.number < 1 || shard.number > shard.count || shard.count > kMaxShards) {
    throw Error(ErrorCode::invalid_argument,
                "--shard: " + text + " is out of range; pass I/N with I from 1 to N, such as 3/16 for the third of 16");
  }
  return shard;
}

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, "batch " + what); }

/// The one plan that is named.
BatchPlan plan_named(const BatchCommandOptions& options, const std::string& action) {
  if (options.inputs.size() != 1) refuse(action + ": pass one plan of 'welkin batch plan'");
  return read_batch_plan(platform::path_of(options.inputs.front()));
}

std::filesystem::path results_of(const BatchCommandOptions& options, const BatchPlan& plan) {
  return options.results.empty() ? plan.default_results() : platform::path_of(options.results);
}

void plan_action(const BatchCommandOptions& options, const Given& given) {
  if (options.output.empty()) refuse("plan: -o names the plan to write, such as -o jobs.json");
  BakeCommandOptions unused;
  const BatchPlan plan =
      plan_batch({options.inputs, options.list, given.of(job_options(unused))}, platform::path_of(options.output));
  write_batch_plan(plan);
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
  print_summary(platform::utf8(plan.file) + ": " + counted(plan.jobs.size(), "job") + ", predicted to take " +
                long_duration(plan.seconds()) + " of one core, the largest " + std::to_string(memory >> kMebi) +
                " MiB\n" + errors + (count > 0 ? "note: " + counted(count, "input") + " cannot be read now\n" : ""));
}

void run_action(const BatchCommandOptions& options) {
  constexpr std::array kStates{JobState::computed, JobState::present, JobState::failed, JobState::verified,
                               JobState::differs};
  const BatchPlan plan = plan_named(options, "run");
  BatchOutcome outcome = run_batch(plan, {results_of(options, plan), options.common.cache, shard_in(options.shard),
                                          thread_count(options.common), options.memory, options.verify});
  Json json = {{"jobs", outcome.jobs}};
  std::string text = counted(outcome.jobs, "job") + ':';
  const char* separator = " ";
  for (const JobState state : kStates) {
    json[name(state)] = outcome.counts[state];
    if (outcome.counts[state] == 0 && (state == JobState::verified || state == JobState::differs)) continue;
    text += separator + std::to_string(outcome.counts[state]) + ' ' + name(state);
    separator = ", ";
  }
  json["seconds"] = outcome.seconds;
  text += "; " + significant(outcome.seconds, 3) + " s\n";
  options.common.json ? print_result(json_text(json)) : print_summary(text);
  if (outcome.troubles.empty()) return;
  std::string message = counted(outcome.troubles.size(), "job") + " of " + std::to_string(outcome.jobs) +
                        (outcome.counts[JobState::failed] > 0 ? " failed" : " differ");
  std::size_t shown = 10;
  for (const auto& [job, error] : outcome.troubles) {
    if (shown-- == 0) {
      message += "\n... 'welkin batch status' lists all of them";
      break;
    }
    message += '\n' + plan.jobs[job].name + ": " + error;
  }
  throw Error(ErrorCode::corrupt_file, message);
}

void status_action(const BatchCommandOptions& options) {
  const BatchPlan plan = plan_named(options, "status");
  show_status(plan, results_of(options, plan), shard_in(options.shard), options.common.json);
}

void merge_action(const BatchCommandOptions& options) {
  if (options.output.empty()) refuse("merge: -o names the folder to write, such as -o index");
  const BatchPlan plan = plan_named(options, "merge");
  merge_batch(plan, results_of(options, plan), platform::path_of(options.output), thread_count(options.common),
              options.allow_missing, options.common.json);
}

Options batch_options(BatchCommandOptions& options) {
  Options table;
  Option action = choice<Action>(
      "ACTION", options.action,
      {{"plan", Action::plan}, {"run", Action::run}, {"status", Action::status}, {"merge", Action::merge}},
      "The action");
  action.required = true;
  action.hint = [](const std::string& word) {
    std::error_code unknown;
    const std::filesystem::path path = platform::path_of(word);
    const bool is_input = std::filesystem::exists(path, unknown) || is_pattern(word) || is_image_name(path);
    return is_input ? "; did you mean 'welkin batch plan " + word + "'?" : std::string();
  };
  table.push_back(std::move(action));
  add_option(table, "INPUT", &options.inputs, "", "Images, folders and patterns to plan; for other actions the plan",
             {.list = List::commas_or_spaces});
  add_option(table, "-o,--output", &options.output, "PATH", "The plan to write, or the folder that merge writes to");
  add_option(table, "--list", &options.list, "FILE",
             "A file of JSON lines to plan, each with an input and its options");
  add_option(table, "--results", &options.results, "DIR",
             "The folder of results; default next to the plan, jobs.results for jobs.json");
  add_option(table, "--shard", &options.shard, "I/N",
             "The I-th of N parts, with equal predicted times, to run or to print the status of; default 1/1");
  add_option(table, "--verify", &options.verify, "SHARE",
             "The fraction of results that run computes twice and compares; default 0",
             {.bounds = number_between(0.0, 1.0)});
  add_option(table, "--allow-missing", &options.allow_missing, "",
             "Merge existing results; the index and the page name missing ones");
  add_option(table, "--memory", ByteCount{&options.memory}, "SIZE",
             "Memory limit for concurrent bakes, by prediction (default 8GiB); a bake that "
             "needs more fails",
             {.group = kRunningGroup});
  add_cache_option(table, options.common);
  add_json_option(table, options.common);
  in_group(table, "The batch");
  add_threads_option(table, options.common);
  for (Option& option : job_options(options.bake)) table.push_back(std::move(option));
  return table;
}

/// Refuses options that the action would ignore, so that they are not thought to have an effect.
void refuse_others(Action action, const Given& given) {
  const std::string name = std::array{"plan", "run", "status", "merge"}.at(static_cast<std::size_t>(action));
  static const std::map<std::string, std::string> takers = {
      {"--output", "plan merge"},     {"--list", "plan"},  {"--results", "run status merge"},
      {"--shard", "run status"},      {"--verify", "run"}, {"--memory", "run"},
      {"--json", "run status merge"}, {"--cache", "run"},  {"--allow-missing", "merge"}};
  const auto refuse_one = [&](const std::string& option) {
    refuse(name + " does not take " + option +
           (action == Action::run ? "; 'welkin batch plan' selects inputs and options" : ""));
  };
  for (const auto& [option, actions] : takers) {
    if (given(option) && actions.find(name) == std::string::npos) refuse_one(option);
  }
  BakeCommandOptions unused;
  const GivenOptions others = given.of(job_options(unused));
  if (action != Action::plan && !others.empty()) refuse_one(others.front().first);
}

}  // namespace

Command batch_command() {
  const auto options = std::make_shared<BatchCommandOptions>();
  options->bake.scene.folder = ".";  // files of options are read more than once: no pipes
  Command command{"batch", "Bake many environments, on one machine or on many", embedded_text("help/batch.txt")};
  command.options = batch_options(*options);
  command.everyday = {"ACTION",  "INPUT",     "--output",        "--list",    "--results",
                      "--shard", "--verify",  "--allow-missing", "--memory",  "--json",
                      "--size",  "--formats", "--for",           "--threads", "--quiet"};
  command.run = [options](const Given& given) {
    refuse_others(options->action, given);
    switch (options->action) {
      case Action::plan: plan_action(*options, given); break;
      case Action::run: run_action(*options); break;
      case Action::status: status_action(*options); break;
      case Action::merge: merge_action(*options); break;
    }
  };
  return command;
}

}  // namespace welkin::tool
