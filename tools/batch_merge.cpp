// A finished batch: every byte checked, an index for programs and a page for people.
#include <algorithm>
#include <string_view>
#include <system_error>

#include "embedded_texts.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/batch.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndexName = "index.json";
constexpr const char* kPageName = "index.html";
constexpr const char* kIndexSchema = "welkin batch index";

struct Merged {
  fs::path folder;
  ResultFiles files;
  std::string problem;      ///< why the result is not in order; empty: it is
  bool is_missing = false;  ///< it is not there, or its input cannot be read; else a problem is that it is damaged
};

Merged check_job(const BatchPlan& plan, const BatchJob& job, const fs::path& results) {
  Merged merged;
  try {
    const std::string key = result_key_of(plan, job).text();
    merged.folder = results / key;
    std::error_code unknown;
    merged.is_missing = !fs::exists(merged.folder, unknown);
    const std::optional<ResultFiles> files = listed_in(merged.folder);
    if (files) {
      merged.files = *files;
      const std::string names = damaged_files(merged.folder, *files);
      if (!names.empty()) merged.problem = key + ": damaged: " + names + "; remove the folder, and run again";
    } else {
      merged.problem = merged.is_missing ? "missing result " + key : key + ": its result.json is damaged";
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    merged.is_missing = true;
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
  std::string link = platform::utf8(target.lexically_proximate(from));
  if constexpr (fs::path::preferred_separator != '/') {
    std::ranges::replace(link, static_cast<char>(fs::path::preferred_separator), '/');
  }
  return link;
}

/// Adds what the page says of a bake: its source and its mips, as its manifest has them.
void add_figures(const fs::path& result, Json& job) {
  try {
    const Json manifest = read_json_file(result / kManifestName, "");
    if (!manifest.is_object()) return;
    for (const auto& [name, value] : manifest.members()) {
      if (name == "source" || name == "specular") job[name] = value;
    }
  } catch (const Error&) {  // the page does without
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
  std::string safe;  // in a script nothing may look like its end
  for (const char c : index.one_line()) safe += c == '<' ? "\\u003c" : std::string(1, c);
  constexpr std::string_view kPlace = "INDEX";
  std::string page = embedded_text("batch.html");
  write_text_file(folder / kPageName, page.replace(page.find(kPlace), kPlace.size(), safe));
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
  std::vector<ContentHash> hashes;  // of all results in the order of the plan; a missing one has no files
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
