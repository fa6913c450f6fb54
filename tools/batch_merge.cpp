#include "tools/batch_merge.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/batch_page.h"
#include "tools/json.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndexName = "index.json";
constexpr const char* kPageName = "index.html";
constexpr const char* kIndexSchema = "welkin batch index";

MergedResult check_job(const BatchPlan& plan, const BatchJob& job, const fs::path& results) {
  MergedResult merged;
  try {
    const ContentHash key = result_key_of(plan, job);
    merged.folder = results / key.text();
    const std::optional<ResultFiles> files = listed_in(merged.folder);
    std::error_code unknown;
    if (!files) {
      merged.is_missing = !fs::exists(merged.folder, unknown);
      merged.problem =
          merged.is_missing ? "there is no result " + key.text() : key.text() + ": its result.json is damaged";
      return merged;
    }
    merged.files = *files;
    std::string names;
    for (const std::string& name : damaged_files(merged.folder, *files)) names += ' ' + name;
    if (!names.empty()) merged.problem = key.text() + ": damaged:" + names + "; remove the folder, and run again";
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    merged.is_missing = true;
    merged.problem = error.what();
  }
  return merged;
}

Json files_json(const ResultFiles& files) {
  Json list = Json::array();
  for (const ResultFile& file : files) {
    list.push_back({{"name", file.name}, {"bytes", file.bytes}, {"hash", file.hash.text()}});
  }
  return list;
}

}  // namespace

ContentHash MergedBatch::hash() const {
  std::vector<ContentHash> all;
  all.reserve(results.size());
  for (const MergedResult& result : results) all.push_back(hash_of(result.files));
  return combine(all);
}

MergedBatch check_batch(const BatchPlan& plan, const fs::path& results, int threads, const Control& control) {
  MergedBatch merged;
  merged.results.resize(plan.jobs.size());
  run_with_threads(threads, [&] {
    const jobs::Placement where = jobs::Placement::arena;
    jobs::run_tiles(plan.jobs.size(), where, jobs::worker_count(where), control, [&](std::size_t job, std::size_t) {
      merged.results[job] = check_job(plan, plan.jobs[job], results);
    });
  });
  for (const MergedResult& result : merged.results) {
    if (!result.problem.empty()) ++(result.is_missing ? merged.missing : merged.damaged);
  }
  return merged;
}

void require_index_place(const fs::path& folder) {
  require_own(folder / kIndexName, kIndexSchema, "batch merge");
  require_own(folder / kPageName, kPageTitle, "batch merge");
}

void write_batch_index(const BatchPlan& plan, const MergedBatch& merged, const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) {
    throw Error(ErrorCode::file_access, platform::utf8(folder) + ": cannot be made (" + trouble.message() + ")");
  }
  Json jobs = Json::array();
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const BatchJob& job = plan.jobs[i];
    const MergedResult& result = merged.results[i];
    if (result.is_missing) {
      jobs.push_back({{"name", job.name}, {"input", job.input}, {"missing", result.problem}});
      continue;
    }
    jobs.push_back({{"name", job.name},
                    {"input", job.input},
                    {"result", link_from(folder, result.folder)},
                    {"hash", hash_of(result.files).text()},
                    {"files", files_json(result.files)}});
  }
  const Json index = {{"schema", kIndexSchema},          {"version", 1},
                      {"welkin", WELKIN_VERSION_STRING}, {"hash", merged.hash().text()},
                      {"missing", merged.missing},       {"jobs", jobs}};
  write_text_file(folder / kPageName, batch_page(plan, merged, folder));
  write_text_file(folder / kIndexName, json_text(index));
}

}  // namespace welkin::tool
