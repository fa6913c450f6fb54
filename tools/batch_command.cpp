// `welkin batch`: many environments, on one machine or on many.
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
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
  if (slash == std::string::npos || shard.number < 1 || shard.number > shard.count || shard.count > kMostShards) {
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

void plan_action(const BatchCommandOptions& options) {
  if (options.output.empty()) refuse("plan: -o names the plan to write, such as -o jobs.json");
  const BatchPlan plan =
      plan_batch({options.inputs, options.list, words_for_jobs(command_words())}, platform::path_of(options.output));
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

void show_outcome(BatchOutcome& outcome, bool as_json) {
  constexpr std::array kStates{JobState::computed, JobState::present, JobState::failed, JobState::verified,
                               JobState::differs};
  Json json = {{"jobs", outcome.jobs}};
  for (const JobState state : kStates) json[name(state)] = outcome.counts[state];
  json["seconds"] = outcome.seconds;
  json["report"] = platform::utf8(outcome.report);
  if (as_json) return print_result(json_text(json));
  std::string text = counted(outcome.jobs, "job") + ':';
  const char* separator = " ";
  for (const JobState state : kStates) {
    if (outcome.counts[state] == 0 && (state == JobState::verified || state == JobState::differs)) continue;
    text += separator + std::to_string(outcome.counts[state]) + ' ' + name(state);
    separator = ", ";
  }
  text += "; " + significant(outcome.seconds, 3) + " s";
  if (outcome.counts[JobState::computed] > 0 && outcome.seconds > 0.0) {
    text +=
        ", " + significant(static_cast<double>(outcome.counts[JobState::computed]) / outcome.seconds, 3) + " a second";
  }
  print_summary(text + "\nreport: " + platform::utf8(outcome.report) + '\n');
}

void run_action(const BatchCommandOptions& options) {
  const BatchPlan plan = plan_named(options, "run");
  const BatchRun run{results_of(options, plan), shard_in(options.shard), thread_count(options.common), options.memory,
                     options.verify};
  BatchOutcome outcome = run_batch(plan, run);
  show_outcome(outcome, options.common.json);
  if (outcome.troubles.empty()) return;
  std::string message = counted(outcome.troubles.size(), "job") + " of " + std::to_string(outcome.jobs) +
                        (outcome.counts[JobState::failed] > 0 ? " failed" : " differ");
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < std::min(kShown, outcome.troubles.size()); ++i) {
    message += "\n" + outcome.troubles[i].name + ": " + outcome.troubles[i].error;
  }
  throw Error(ErrorCode::corrupt_file,
              message + (outcome.troubles.size() > kShown ? "\n... the report has all of them" : ""));
}

void status_action(const BatchCommandOptions& options) {
  const BatchPlan plan = plan_named(options, "status");
  show_status(plan, results_of(options, plan), options.common.json);
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
    const bool is_input = std::filesystem::exists(path, unknown) || is_pattern(word) || is_picture_name(path);
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
             "The I-th of N parts to run, with equal predicted times; default 1/1");
  add_option(table, "--verify", &options.verify, "SHARE",
             "The fraction of results that run computes twice and compares; default 0",
             {.bounds = finite_between(0.0, 1.0)});
  add_option(table, "--allow-missing", &options.allow_missing, "",
             "Merge existing results; the index and the page name missing ones");
  add_option(table, "--memory", ByteCount{&options.memory}, "SIZE",
             "Memory limit for concurrent bakes, by prediction (default 8GiB); a bake that "
             "needs more fails",
             {.group = kRunningGroup});
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
           (action == Action::run ? "; 'welkin batch plan' selects inputs and options" : ""));
  }
}

}  // namespace

Command batch_command() {
  const auto options = std::make_shared<BatchCommandOptions>();
  Command command{"batch", "Bake many environments, on one machine or on many", embedded_text("help/batch.txt")};
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

namespace {

namespace fs = std::filesystem;

bool is_hidden(const fs::path& path) { return platform::utf8(path.filename()).starts_with('.'); }

/// What is in a folder, in the order of names, but for what is hidden.
std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code trouble;
  for (fs::directory_iterator at(folder, trouble), end; !trouble && at != end; at.increment(trouble)) {
    entries.push_back(*at);
  }
  if (trouble) {
    throw Error(ErrorCode::file_access,
                platform::utf8(folder) + ": cannot be listed (" + trouble.message() + "); check its permissions");
  }
  std::ranges::sort(entries, {}, [](const fs::directory_entry& entry) { return entry.path(); });
  return entries;
}

/// Its pictures were made by Welkin.
bool is_baked(const fs::path& folder) { return begins_with(folder / kManifestName, "\"welkin\""); }

void add_pictures(const fs::path& folder, std::vector<fs::path>& found) {
  std::error_code unknown;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    if (is_hidden(entry.path())) continue;
    // A link to a folder is not followed: it might lead back.
    if (entry.is_directory(unknown) && !entry.is_symlink(unknown)) {
      if (!is_baked(entry.path())) add_pictures(entry.path(), found);
    } else if (is_picture_name(entry.path()) && entry.is_regular_file(unknown)) {
      found.push_back(entry.path());
    }
  }
}

using Parts = std::vector<std::string>;

void add_fitting(const fs::path& folder, const Parts& parts, std::size_t at, std::vector<fs::path>& found) {
  std::error_code unknown;
  const bool is_last = at + 1 == parts.size();
  const std::string& part = parts[at];
  const auto go_on = [&](const fs::path& path) {
    if (!is_last) return add_fitting(path, parts, at + 1, found);
    if (fs::is_regular_file(path, unknown)) found.push_back(path);
  };
  if (!is_pattern(part)) return go_on(folder / platform::path_of(part));
  const fs::path listed = folder.empty() ? fs::path(".") : folder;
  if (!fs::is_directory(listed, unknown)) return;
  const bool any_depth = part == "**" && !is_last;
  if (any_depth) add_fitting(folder, parts, at + 1, found);
  for (const fs::directory_entry& entry : entries_of(listed)) {
    if (is_hidden(entry.path()) && !part.starts_with('.')) continue;
    const fs::path path = folder / entry.path().filename();
    if (any_depth) {
      const bool is_folder = entry.is_directory(unknown) && !entry.is_symlink(unknown);
      if (is_folder && !is_baked(entry.path())) add_fitting(path, parts, at, found);
    } else if (fits(platform::utf8(entry.path().filename()), part) && (!is_last || is_picture_name(path))) {
      go_on(path);
    }
  }
}

}  // namespace

bool is_picture_name(const fs::path& path) {
  constexpr std::array<const char*, 8> kEndings = {".exr", ".hdr", ".pfm", ".png", ".ktx2", ".ktx", ".dds", ".env"};
  const std::string ending = platform::utf8(path.extension());
  return std::ranges::any_of(kEndings, [&](const char* known) { return same_word(ending, known); });
}

std::vector<fs::path> pictures_below(const fs::path& folder) {
  std::vector<fs::path> found;
  add_pictures(folder, found);
  return found;
}

bool is_pattern(const std::string& text) noexcept { return text.find_first_of("*?") != std::string::npos; }

bool fits(const std::string& name, const std::string& pattern) noexcept {
  std::size_t at = 0;
  std::size_t wanted = 0;
  std::size_t star = std::string::npos;  // the last one in the pattern,
  std::size_t behind = 0;                // and what of the name follows what it stands for
  while (at < name.size()) {
    if (wanted < pattern.size() && pattern[wanted] == '*') {
      star = wanted++;
      behind = at;
    } else if (wanted < pattern.size() && (pattern[wanted] == '?' || pattern[wanted] == name[at])) {
      ++wanted;
      ++at;
    } else if (star != std::string::npos) {
      wanted = star + 1;
      at = ++behind;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', wanted) == std::string::npos;
}

std::vector<fs::path> files_that_fit(const std::string& pattern) {
  const fs::path whole = platform::path_of(pattern);
  Parts parts;
  for (const fs::path& part : whole.relative_path()) {
    if (!part.empty()) parts.push_back(platform::utf8(part));
  }
  std::vector<fs::path> found;
  if (!parts.empty()) add_fitting(whole.root_path(), parts, 0, found);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace welkin::tool
