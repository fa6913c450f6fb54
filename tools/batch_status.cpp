#include "tools/batch_status.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/batch_progress.h"
#include "tools/batch_results.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

/// The N of shard-I-of-N.json; 0 if there is none.
int shards_in(const fs::path& report) {
  const std::string name = platform::utf8(report.stem());
  constexpr std::string_view kOf = "-of-";
  const std::size_t at = name.rfind(kOf);
  return at == std::string::npos ? 0 : std::max(0, whole_number_in(name.substr(at + kOf.size())).value_or(0));
}

/// What reports say of a job.
struct Known {
  std::optional<JobRecord> last;     ///< that is no verification
  std::optional<JobRecord> differs;  ///< the last verification, if it found a difference
};

class Reports {
 public:
  Reports(const BatchPlan& plan, const fs::path& results, BatchStatus& status) : plan_(plan), jobs_(plan.jobs.size()) {
    std::string newest;
    for (const fs::path& file : reports_in(results)) {
      try {
        for (const JobRecord& record : read_report(file)) {
          add(record);
          if (record.end <= newest) continue;
          newest = record.end;
          status.shards = shards_in(file);
        }
      } catch (const Error& error) {
        status.notes.emplace_back(error.what());
      }
    }
  }

  [[nodiscard]] const Known& of(std::size_t job) const { return jobs_[job]; }
  /// How much longer jobs have taken than was predicted.
  [[nodiscard]] double correction() const { return predicted_ > 0.0 && measured_ > 0.0 ? measured_ / predicted_ : 1.0; }

 private:
  /// Later ones count, by the clocks of their machines.
  static void keep_later(std::optional<JobRecord>& kept, const JobRecord& record) {
    if (!kept || kept->end <= record.end) kept = record;
  }

  void add(const JobRecord& record) {
    // A plan that was made anew has other jobs.
    if (record.index >= jobs_.size() || plan_.jobs[record.index].name != record.name) return;
    Known& known = jobs_[record.index];
    switch (record.state) {
      case JobState::verified:
      case JobState::differs: keep_later(known.differs, record); break;
      case JobState::computed:
        measured_ += record.seconds;
        predicted_ += plan_.jobs[record.index].seconds;
        [[fallthrough]];
      case JobState::present:
      case JobState::failed: keep_later(known.last, record); break;
    }
  }

  const BatchPlan& plan_;
  std::vector<Known> jobs_;
  double measured_ = 0.0;
  double predicted_ = 0.0;
};

enum class Standing { done, failed, left };

Standing standing_of(const Known& known, const fs::path& results) {
  if (!known.last) return Standing::left;
  if (known.last->state == JobState::failed) return Standing::failed;
  std::error_code unknown;
  const bool is_named = hash_in(known.last->result).has_value();
  return is_named && fs::exists(results / known.last->result / kResultName, unknown) ? Standing::done : Standing::left;
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
    standings.push_back(standing_of(known, results));
    count(standings.back(), reports.correction() * plan.jobs[job].seconds, status.all);
    if (standings.back() == Standing::failed) status.troubles.push_back(*known.last);
    if (known.differs && known.differs->state == JobState::differs) status.troubles.push_back(*known.differs);
  }
  if (status.shards == 0) return status;
  for (const std::vector<std::size_t>& shard : cut_batch(plan, status.shards)) {
    BatchCounts& counts = status.of_shards.emplace_back();
    for (const std::size_t job : shard) {
      count(standings[job], reports.correction() * plan.jobs[job].seconds, counts);
    }
  }
  return status;
}

Json status_json(const BatchStatus& status) {
  Json json = counts_json(status.all);
  Json shards = Json::array();
  for (const BatchCounts& counts : status.of_shards) {
    Json shard = {{"shard", shards.size() + 1}};
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
    for (std::size_t i = 0; i < status.of_shards.size(); ++i) {
      text += "  shard " + std::to_string(i + 1) + '/' + std::to_string(status.shards) + ": " +
              counts_text(status.of_shards[i]) + '\n';
    }
  }
  for (const JobRecord& record : status.troubles) {
    text += std::string(name(record.state)) + ": " + printable(record.name) + ": " + printable(record.error) + '\n';
  }
  for (const std::string& note : status.notes) text += "note: " + printable(note) + '\n';
  return text;
}

}  // namespace welkin::tool
