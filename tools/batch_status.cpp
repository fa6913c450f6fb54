#include "tools/batch_status.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "tools/bake_cache.h"
#include "tools/batch_progress.h"
#include "tools/batch_results.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

/// What reports say of a job.
struct Known {
  std::optional<JobRecord> last;      ///< that is no verification
  bool is_made = false;               ///< some report has a result of it
  std::optional<JobRecord> verified;  ///< the last verification, whatever it found
};

class Reports {
 public:
  Reports(const BatchPlan& plan, const fs::path& results, BatchStatus& status) : plan_(plan), jobs_(plan.jobs.size()) {
    std::string newest;
    for (std::size_t job = 0; job < plan.jobs.size(); ++job) by_hash_[hash_of_job(plan.jobs[job]).text()] = job;
    for (const fs::path& file : reports_in(results)) {
      try {
        for (const JobRecord& record : read_report(file)) {
          add(record);
          if (record.end <= newest) continue;
          newest = record.end;
          status.shards = shard_of_report(file)->count;
        }
      } catch (const Error& error) {
        status.notes.emplace_back(error.what());
      }
    }
  }

  [[nodiscard]] const Known& of(std::size_t job) const { return jobs_[job]; }

  /// A difference that a verification found, for as long as the result is that one: until it is computed again, or the
  /// job has another.
  [[nodiscard]] const JobRecord* difference_of(std::size_t job) const {
    const Known& known = jobs_[job];
    if (!known.verified || known.verified->state != JobState::differs) return nullptr;
    const JobRecord& differs = *known.verified;
    const auto computed = computed_.find(differs.result);
    if (computed != computed_.end() && computed->second > differs.end) return nullptr;
    const bool is_replaced = known.last && known.last->state != JobState::failed &&
                             known.last->result != differs.result && known.last->end > differs.end;
    return is_replaced ? nullptr : &differs;
  }
  /// How much longer jobs have taken than was predicted.
  [[nodiscard]] double correction() const { return predicted_ > 0.0 && measured_ > 0.0 ? measured_ / predicted_ : 1.0; }

 private:
  /// Later ones count, by the clocks of their machines.
  static void keep_later(std::optional<JobRecord>& kept, const JobRecord& record) {
    if (!kept || kept->end <= record.end) kept = record;
  }

  void add(const JobRecord& record) {
    // Another job may have the same result.
    if (record.state == JobState::computed) {
      std::string& end = computed_[record.result];
      end = std::max(end, record.end);
    }
    // A plan that was made anew has other jobs, and so has another plan with the same results.
    const auto found = by_hash_.find(record.job);
    if (found == by_hash_.end()) return;
    Known& known = jobs_[found->second];
    switch (record.state) {
      case JobState::verified:
      case JobState::differs: keep_later(known.verified, record); break;
      case JobState::computed:
        measured_ += record.seconds;
        predicted_ += plan_.jobs[found->second].seconds;
        [[fallthrough]];
      case JobState::present: known.is_made = true; [[fallthrough]];
      case JobState::failed: keep_later(known.last, record); break;
    }
  }

  const BatchPlan& plan_;
  std::vector<Known> jobs_;
  std::unordered_map<std::string, std::size_t> by_hash_;   ///< the plan's jobs
  std::unordered_map<std::string, std::string> computed_;  ///< when each result was computed last
  double measured_ = 0.0;
  double predicted_ = 0.0;
};

enum class Standing { done, failed, left };

bool is_whole(const fs::path& result) {
  const std::optional<ResultFiles> files = listed_in(result);
  return files && has_files(result, *files);
}

/// Returns the result of the input as it is now.
bool has_result(const BatchPlan& plan, const BatchJob& job, const fs::path& results) {
  try {
    return is_whole(results / result_key_of(plan, job).text());
  } catch (const Error&) {
    return false;
  }
}

Standing standing_of(const BatchPlan& plan, std::size_t job, const Known& known, const fs::path& results) {
  if (!known.last) return Standing::left;
  if (known.last->state == JobState::failed) {
    // Clocks of several machines do not show which came last, as one may be ahead. The input decides.
    return known.is_made && has_result(plan, plan.jobs[job], results) ? Standing::done : Standing::failed;
  }
  if (!hash_in(known.last->result)) return Standing::left;
  return is_whole(results / known.last->result) ? Standing::done : Standing::left;
}

void count(Standing standing, double seconds, BatchCounts& counts) {
  switch (standing) {
    case Standing::done: ++counts.done; break;
    case Standing::failed: ++counts.failed; break;
    case Standing::left:
      ++counts.left;
      counts.seconds_left += seconds;
      break;
  }
}

Json counts_json(const BatchCounts& counts) {
  return {
      {"done", counts.done}, {"failed", counts.failed}, {"left", counts.left}, {"seconds_left", counts.seconds_left}};
}

std::string counts_text(const BatchCounts& counts) {
  std::string text = std::to_string(counts.done) + " done, " + std::to_string(counts.left) + " left, " +
                     std::to_string(counts.failed) + " failed";
  if (counts.left > 0) text += "; about " + long_duration(counts.seconds_left) + " of one core left";
  return text;
}

}  // namespace

BatchStatus status_of(const BatchPlan& plan, const fs::path& results) {
  BatchStatus status;
  status.jobs = plan.jobs.size();
  const Reports reports(plan, results, status);
  std::vector<Standing> standings;
  for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
    const Known& known = reports.of(job);
    standings.push_back(standing_of(plan, job, known, results));
    count(standings.back(), reports.correction() * plan.jobs[job].seconds, status.all);
    if (standings.back() == Standing::failed) status.troubles.push_back(*known.last);
    if (const JobRecord* difference = reports.difference_of(job)) status.troubles.push_back(*difference);
  }
  if (status.shards == 0) return status;
  const std::vector<std::vector<std::size_t>> cut = cut_batch(plan, status.shards);
  for (std::size_t shard = 0; shard < cut.size(); ++shard) {
    if (cut[shard].empty()) continue;
    BatchCounts& counts = status.of_shards[shard + 1];
    for (const std::size_t job : cut[shard]) {
      count(standings[job], reports.correction() * plan.jobs[job].seconds, counts);
    }
  }
  return status;
}

Json status_json(const BatchStatus& status) {
  Json json = counts_json(status.all);
  Json shards = Json::array();
  for (const auto& [number, counts] : status.of_shards) {
    Json shard = {{"shard", number}};
    const Json members = counts_json(counts);
    for (const auto& [key, value] : members.members()) shard[key] = value;
    shards.push_back(shard);
  }
  Json troubles = Json::array();
  for (const JobRecord& record : status.troubles) {
    troubles.push_back({{"name", record.name},
                        {"state", name(record.state)},
                        {"error_code", record.error_code},
                        {"error", record.error}});
  }
  json["jobs"] = status.jobs;
  json["shards"] = shards;
  json["troubles"] = troubles;
  json["notes"] = Json(status.notes);
  return json;
}

std::string status_text(const BatchStatus& status) {
  std::string text = counted(status.jobs, "job") + ": " + counts_text(status.all) + '\n';
  if (status.shards > 1) {
    for (const auto& [number, counts] : status.of_shards) {
      text +=
          "  shard " + std::to_string(number) + '/' + std::to_string(status.shards) + ": " + counts_text(counts) + '\n';
    }
  }
  for (const JobRecord& record : status.troubles) {
    text += std::string(name(record.state)) + ": " + printable(record.name) + ": " + printable(record.error) + '\n';
  }
  for (const std::string& note : status.notes) text += "note: " + printable(note) + '\n';
  return text;
}

}  // namespace welkin::tool
