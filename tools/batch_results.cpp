// The folder of a batch's results, its status, and the merged index.
#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "cache/recipe.h"
#include "embedded_texts.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/bake_manifest.h"
#include "tools/batch.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "welkin batch result";
constexpr int kVersion = 2;
constexpr const char* kResultName = "result.json";
constexpr std::array kStates{"computed", "present", "failed", "verified", "differs"};

ContentHash hash_of(const ResultFiles& files) {
  std::string all;
  for (const ResultFile& file : files) all += file.name + ' ' + file.hash.text() + '\n';
  return hash_bytes(all.data(), all.size());
}

Member result_file(const char* name, ResultFile& target) {
  return object(name, target, {text("name", target.name), bytes("bytes", target.bytes), hash("hash", target.hash)});
}

Json json_of(ResultFiles files) { return list("files", files, result_file).written(); }

JobResult result_in(const Json& json) {
  JobResult result;
  std::string schema;
  std::string state;
  int version = 0;
  read_object(json, "result",
              {text("schema", schema), whole_number("version", version), text("state", state), hash("key", result.key),
               list("files", result.files, result_file), text("error_code", result.error_code),
               text("error", result.error), number("seconds", result.seconds), whole_number("threads", result.threads),
               text("host", result.host), number("start", result.start)});
  const auto* const found = std::ranges::find(kStates, state);
  if (schema != kSchema || version != kVersion || found == kStates.end()) throw Flaw{"is no result"};
  const auto is_ours = [](const ResultFile& file) { return file.name == kManifestName || is_plain_name(file.name); };
  if (!std::ranges::all_of(result.files, is_ours)) throw Flaw{"lists other files than a bake's"};
  result.state = static_cast<JobState>(found - kStates.begin());
  return result;
}

}  // namespace

const char* name(JobState state) noexcept { return kStates.at(static_cast<std::size_t>(state)); }

ContentHash hash_of(const BatchJob& job) { return cache::hash_of(job.input, job.options); }

std::optional<JobResult> read_result(const fs::path& folder) {
  try {
    return result_in(read_json_file(folder / kResultName, ""));
  } catch (const Flaw&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool is_done(const fs::path& folder, const std::optional<JobResult>& result) {
  return result && result->state == JobState::computed && !result->files.empty() &&
         std::ranges::all_of(result->files, [&](const ResultFile& file) {
           std::error_code unknown;
           return fs::file_size(folder / file.name, unknown) == file.bytes && !unknown;
         });
}

ResultFiles hash_files_in(const fs::path& folder) {
  ResultFiles files;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const std::string name = platform::utf8(at->path().filename());
    if (name == kResultName || !at->is_regular_file(none)) continue;
    files.push_back({name, static_cast<std::uint64_t>(at->file_size()), hash_file(at->path())});
  }
  std::ranges::sort(files, {}, &ResultFile::name);
  return files;
}

std::string differing(const ResultFiles& listed, const ResultFiles& found) {
  std::set<std::string> names;
  for (const auto& [all, others] : {std::pair(&listed, &found), std::pair(&found, &listed)}) {
    for (const ResultFile& file : *all) {
      if (std::ranges::find(*others, file) == others->end()) names.insert(file.name);
    }
  }
  return joined({names.begin(), names.end()});
}

void write_result(const fs::path& folder, const JobResult& result) {
  Json json = {{"schema", kSchema}, {"version", kVersion}, {"state", name(result.state)}, {"key", result.key.text()}};
  if (!result.files.empty()) json["files"] = json_of(result.files);
  if (!result.error_code.empty()) json["error_code"] = result.error_code;
  if (!result.error.empty()) json["error"] = result.error;
  json["seconds"] = result.seconds;
  json["threads"] = result.threads;
  json["host"] = result.host;
  json["start"] = result.start;
  write_text_file(folder / kResultName, json_text(json));
}

void show_status(const BatchPlan& plan, const fs::path& results, const Shard& shard, bool as_json) {
  std::vector<std::size_t> jobs = cut_batch(plan, shard.count).at(static_cast<std::size_t>(shard.number - 1));
  std::ranges::sort(jobs);
  std::size_t done = 0;
  double predicted = 0.0;  // of computed results
  double measured = 0.0;   // their duration
  double seconds = 0.0;    // predicted for the missing results
  std::vector<std::pair<const BatchJob*, JobResult>> troubles;
  for (const std::size_t index : jobs) {
    const BatchJob& job = plan.jobs[index];
    const fs::path folder = results / hash_of(job).text();
    const std::optional<JobResult> result = read_result(folder);
    if (is_done(folder, result)) {
      ++done;
      predicted += job.seconds;
      measured += result->seconds;
    } else if (result && result->state != JobState::computed) {
      troubles.emplace_back(&job, *result);
    } else {
      seconds += job.seconds;
    }
  }
  if (predicted > 0.0 && measured > 0.0) seconds *= measured / predicted;
  const std::size_t left = jobs.size() - done - troubles.size();
  Json list = Json::array();
  std::string lines;
  for (const auto& [job, result] : troubles) {
    list.push_back({{"name", job->name},
                    {"state", name(result.state)},
                    {"error_code", result.error_code},
                    {"error", result.error}});
    lines += std::string(name(result.state)) + ": " + printable(job->name) + ": " + printable(result.error) + '\n';
  }
  const Json json = {{"jobs", jobs.size()},     {"done", done},    {"failed", troubles.size()}, {"left", left},
                     {"seconds_left", seconds}, {"troubles", list}};
  std::string text = counted(jobs.size(), "job") + ": " + std::to_string(done) + " done, " + std::to_string(left) +
                     " left, " + std::to_string(troubles.size()) + " failed";
  if (left > 0) text += "; about " + long_duration(seconds) + " of one core left";
  print_result(as_json ? json_text(json) : text + '\n' + lines);
  if (troubles.empty()) return;
  throw Error(ErrorCode::corrupt_file,
              counted(troubles.size(), "job") + " of " + std::to_string(jobs.size()) + " failed or differ");
}

namespace {

constexpr const char* kIndexName = "index.json";
constexpr const char* kPageName = "index.html";
constexpr const char* kIndexSchema = "welkin batch index";

struct Merged {
  fs::path folder;
  ResultFiles files;
  std::string problem;      ///< the fault of the result; empty: none
  bool is_missing = false;  ///< the result is missing, or its input cannot be read; any other problem: it is damaged
};

Merged check_job(const BatchPlan& plan, const BatchJob& job, const fs::path& results) {
  Merged merged{results / hash_of(job).text(), {}, {}, true};
  try {
    const std::string name = platform::utf8(merged.folder.filename());
    const std::optional<JobResult> result = read_result(merged.folder);
    const bool is_current = result && result->key == bake_key(bake_options_of(plan, job));
    if (!is_current || result->state != JobState::computed) {
      merged.problem = "missing result " + name +
                       (result ? ": " + std::string(tool::name(result->state)) + ' ' + result->error : "");
      return merged;
    }
    merged.files = result->files;
    merged.is_missing = false;
    const std::string names = differing(result->files, hash_files_in(merged.folder));
    if (!names.empty()) merged.problem = name + ": damaged: " + names + "; remove the folder, and run again";
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    merged.problem = error.what();
  }
  return merged;
}

std::vector<Merged> check_jobs(const BatchPlan& plan, const fs::path& results, int threads, const Control& control) {
  std::vector<Merged> merged(plan.jobs.size());
  run_with_threads(threads, [&] {
    const jobs::Placement where = jobs::Placement::arena;
    jobs::run_tiles(plan.jobs.size(), where, jobs::worker_count(where), control,
                    [&](std::size_t job, std::size_t) { merged[job] = check_job(plan, plan.jobs[job], results); });
  });
  return merged;
}

/// Returns a path as a link in a file of `folder`.
std::string link_from(const fs::path& folder, const fs::path& to) {
  std::error_code unknown;
  const fs::path from = fs::weakly_canonical(fs::absolute(folder, unknown), unknown);
  const fs::path target = fs::weakly_canonical(fs::absolute(to, unknown), unknown);
  return platform::generic_utf8(target.lexically_proximate(from));
}

/// Adds the page's description of a bake: its source and its mips, from its manifest.
void add_figures(const fs::path& result, Json& job) {
  try {
    const Json manifest = read_json_file(result / kManifestName, "");
    if (!manifest.is_object()) return;
    for (const auto& [name, value] : manifest.members()) {
      if (name == "source" || name == "specular") job[name] = value;
    }
  } catch (const Error&) {  // the page omits it
  } catch (const Flaw&) {
  }
}

void write_index(const BatchPlan& plan, const std::vector<Merged>& merged, const ContentHash& hash, std::size_t missing,
                 const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) {
    throw Error(ErrorCode::file_access, platform::utf8(folder) + ": cannot be created (" + trouble.message() +
                                            "); pass a folder that you may write to");
  }
  Json jobs = Json::array();
  Json figures = Json::array();
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    Json job = {{"name", plan.jobs[i].name}, {"input", plan.jobs[i].input}};
    if (merged[i].is_missing) {
      job["missing"] = merged[i].problem;
    } else {
      job["result"] = link_from(folder, merged[i].folder);
      job["hash"] = hash_of(merged[i].files).text();
      job["files"] = json_of(merged[i].files);
    }
    jobs.push_back(job);
    if (!merged[i].is_missing) add_figures(merged[i].folder, job);
    figures.push_back(job);
  }
  Json index = {{"schema", kIndexSchema}, {"version", 1},       {"welkin", WELKIN_VERSION_STRING},
                {"hash", hash.text()},    {"missing", missing}, {"jobs", jobs}};
  write_text_file(folder / kIndexName, json_text(index));
  index["plan"] = platform::utf8(plan.file.filename());
  index["jobs"] = figures;
  std::string safe;  // a script must not contain what looks like its end
  for (const char c : index.one_line()) safe += c == '<' ? "\\u003c" : std::string(1, c);
  constexpr std::string_view kMarker = "INDEX";
  std::string page = embedded_text("batch.html");
  write_text_file(folder / kPageName, page.replace(page.find(kMarker), kMarker.size(), safe));
}

}  // namespace

void merge_batch(const BatchPlan& plan, const fs::path& results, const fs::path& folder, int threads,
                 bool allow_missing, bool as_json) {
  require_own(folder / kIndexName, kIndexSchema, "batch merge");
  require_own(folder / kPageName, "<title>Welkin batch</title>", "batch merge");
  std::vector<Merged> merged;
  {
    ProgressBar bar;
    merged = check_jobs(plan, results, threads, bar.control());
  }
  std::vector<ContentHash> hashes;  // of all results in the plan's order; a missing one has no files
  std::string problems;
  std::size_t missing = 0;
  std::size_t damaged = 0;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    hashes.push_back(hash_of(merged[i].files));
    if (merged[i].problem.empty()) continue;
    ++(merged[i].is_missing ? missing : damaged);
    problems += '\n' + plan.jobs[i].name + ": " + merged[i].problem;
  }
  if (damaged > 0 || (missing > 0 && !allow_missing)) {
    throw Error(ErrorCode::corrupt_file, counted(damaged + missing, "result") + " of " + std::to_string(merged.size()) +
                                             (damaged + missing == 1 ? " is" : " are") + " missing or damaged" +
                                             (damaged == 0 ? "; --allow-missing merges the others" : "") + problems);
  }
  const ContentHash hash = combine(hashes);
  write_index(plan, merged, hash, missing, folder);
  if (as_json) return print_result(json_text({{"jobs", merged.size()}, {"missing", missing}, {"hash", hash.text()}}));
  print_summary(counted(merged.size() - missing, "result") + " in order; the batch's hash is " + hash.text() +
                (missing > 0 ? "\nnote: " + counted(missing, "result") + " missing" + printable_lines(problems) : "") +
                "\nindex: " + platform::utf8(folder / kIndexName) + ", " + platform::utf8(folder / kPageName) + '\n');
}

}  // namespace welkin::tool
