// What runs record of a batch's jobs, and how far the batch is by that.
#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <unordered_map>

#include "cache/recipe.h"
#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/batch.h"
#include "tools/lines.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReports = "reports";
constexpr std::array kStates{"computed", "present", "failed", "verified", "differs"};

JobRecord record_in(const std::string& line) {
  JobRecord record;
  int index = -1;
  double process = 0.0;
  std::string state;
  read_object(
      parse_json(line), "the record",
      {text("job", record.job), whole_number("index", index), text("name", record.name), text("state", state),
       text("result", record.result), number("seconds", record.seconds), whole_number("threads", record.threads),
       text("host", record.host), number("process", process), text("start", record.start), text("end", record.end),
       text("error_code", record.error_code), text("error", record.error)});
  const auto* const found = std::ranges::find(kStates, state);
  if (index < 0 || found == kStates.end()) throw Flaw{"is no record of a job"};
  record.index = static_cast<std::size_t>(index);
  record.process = static_cast<std::int64_t>(process);
  record.state = static_cast<JobState>(found - kStates.begin());
  return record;
}

/// Returns the shard of a report by its name, shard-I-of-N-HOST-PROCESS.jsonl. Nothing for other names, and numbers
/// that no run takes.
std::optional<Shard> shard_of_report(const fs::path& file) {
  const std::string name = platform::utf8(file.filename());
  std::array<std::string, 4> parts;  // "shard", I, "of", N
  std::size_t at = 0;
  for (std::string& part : parts) {
    const std::size_t end = name.find('-', at);
    if (end == std::string::npos) return std::nullopt;
    part = name.substr(at, end - at);
    at = end + 1;
  }
  if (parts[0] != "shard" || parts[2] != "of" || !name.ends_with(".jsonl")) return std::nullopt;
  const Shard shard{whole_number_in(parts[1]).value_or(0), whole_number_in(parts[3]).value_or(0)};
  if (shard.number < 1 || shard.count < shard.number || shard.count > kMostShards) return std::nullopt;
  return shard;
}

/// Of some of the jobs.
struct Counts {
  std::size_t done = 0;    ///< their results are there
  std::size_t failed = 0;  ///< the last time; there is no result
  std::size_t left = 0;
  double seconds_left = 0.0;  ///< of one core, for those that are left
};

struct Status {
  Counts all;
  int shards = 0;                           ///< of the newest report; 0: there is none
  std::map<std::size_t, Counts> of_shards;  ///< by their numbers from 1; those that have jobs
  std::vector<JobRecord> troubles;          ///< failed jobs and results that differed, in the order of the plan
  std::vector<std::string> notes;           ///< reports that cannot be read
};

/// What reports say of a job. Later records count, by the clocks of their machines.
struct Known {
  std::optional<JobRecord> last;     ///< that is no verification
  std::optional<JobRecord> differs;  ///< or the last verification, whatever it found
};

class Reports {
 public:
  Reports(const BatchPlan& plan, const fs::path& results, Status& status) : plan_(plan), jobs_(plan.jobs.size()) {
    for (std::size_t job = 0; job < plan.jobs.size(); ++job) by_hash_[hash_of_job(plan.jobs[job]).text()] = job;
    std::error_code none;
    std::vector<fs::path> files;
    for (fs::directory_iterator at(results / kReports, none), end; !none && at != end; at.increment(none)) {
      if (shard_of_report(at->path())) files.push_back(at->path());
    }
    std::ranges::sort(files);
    std::string newest;
    for (const fs::path& file : files) {
      try {
        if (!fs::is_regular_file(file, none)) {
          throw Error(ErrorCode::file_access,
                      platform::utf8(file) + ": is not a regular file; remove it from the reports");
        }
        for_each_line(file, [&](std::size_t, const std::string& line) {
          try {
            const JobRecord record = record_in(line);
            add(record);
            if (record.end <= newest) return;
            newest = record.end;
            status.shards = shard_of_report(file)->count;
          } catch (const Flaw&) {  // the last line of a process that was killed in the middle of it
          }
        });
      } catch (const Error& error) {
        status.notes.emplace_back(error.what());
      }
    }
  }

  [[nodiscard]] const Known& of(std::size_t job) const { return jobs_[job]; }

  /// Returns a difference that a verification found, for as long as the result is that one: until it is computed again,
  /// or the job has another.
  [[nodiscard]] const JobRecord* difference_of(std::size_t job) const {
    const Known& known = jobs_[job];
    if (!known.differs || known.differs->state != JobState::differs) return nullptr;
    const JobRecord& differs = *known.differs;
    const auto computed = computed_.find(differs.result);
    if (computed != computed_.end() && computed->second > differs.end) return nullptr;
    const bool is_replaced = known.last && known.last->state != JobState::failed &&
                             known.last->result != differs.result && known.last->end > differs.end;
    return is_replaced ? nullptr : &differs;
  }

  /// Returns how much longer jobs have taken than was predicted.
  [[nodiscard]] double correction() const { return predicted_ > 0.0 && measured_ > 0.0 ? measured_ / predicted_ : 1.0; }

 private:
  void add(const JobRecord& record) {
    const bool is_computed = record.state == JobState::computed;
    // Another job may have the same result.
    if (is_computed) computed_[record.result] = std::max(computed_[record.result], record.end);
    // A plan that was made anew has other jobs, and so has another plan with the same results.
    const auto found = by_hash_.find(record.job);
    if (found == by_hash_.end()) return;
    Known& known = jobs_[found->second];
    const bool is_verification = record.state == JobState::verified || record.state == JobState::differs;
    std::optional<JobRecord>& kept = is_verification ? known.differs : known.last;
    if (!kept || kept->end <= record.end) kept = record;
    if (!is_computed) return;
    measured_ += record.seconds;
    predicted_ += plan_.jobs[found->second].seconds;
  }

  const BatchPlan& plan_;
  std::vector<Known> jobs_;
  std::unordered_map<std::string, std::size_t> by_hash_;   ///< the plan's jobs
  std::unordered_map<std::string, std::string> computed_;  ///< when each result was computed last
  double measured_ = 0.0;
  double predicted_ = 0.0;
};

std::size_t Counts::*standing_of(const Known& known, const fs::path& results) {
  if (!known.last) return &Counts::left;
  if (known.last->state == JobState::failed) return &Counts::failed;
  return hash_in(known.last->result) && is_whole(results / known.last->result) ? &Counts::done : &Counts::left;
}

Status status_of(const BatchPlan& plan, const fs::path& results) {
  Status status;
  const Reports reports(plan, results, status);
  std::vector<std::size_t Counts::*> standings;
  const auto count = [&](std::size_t job, Counts& counts) {
    ++(counts.*standings[job]);
    if (standings[job] == &Counts::left) counts.seconds_left += reports.correction() * plan.jobs[job].seconds;
  };
  for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
    const Known& known = reports.of(job);
    standings.push_back(standing_of(known, results));
    count(job, status.all);
    if (standings.back() == &Counts::failed) status.troubles.push_back(*known.last);
    if (const JobRecord* difference = reports.difference_of(job)) status.troubles.push_back(*difference);
  }
  if (status.shards == 0) return status;
  const std::vector<std::vector<std::size_t>> cut = cut_batch(plan, status.shards);
  for (std::size_t shard = 0; shard < cut.size(); ++shard) {
    for (const std::size_t job : cut[shard]) count(job, status.of_shards[shard + 1]);
  }
  return status;
}

Json json_of(const Counts& counts) {
  return {
      {"done", counts.done}, {"failed", counts.failed}, {"left", counts.left}, {"seconds_left", counts.seconds_left}};
}

Json json_of(const Status& status, std::size_t jobs) {
  Json json = json_of(status.all);
  Json shards = Json::array();
  for (const auto& [number, counts] : status.of_shards) {
    Json shard = json_of(counts);
    shard["shard"] = number;
    shards.push_back(shard);
  }
  Json troubles = Json::array();
  for (const JobRecord& record : status.troubles) {
    troubles.push_back({{"name", record.name},
                        {"state", name(record.state)},
                        {"error_code", record.error_code},
                        {"error", record.error}});
  }
  json["jobs"] = jobs;
  json["shards"] = shards;
  json["troubles"] = troubles;
  json["notes"] = Json(status.notes);
  return json;
}

std::string text_of(const Counts& counts) {
  std::string text = std::to_string(counts.done) + " done, " + std::to_string(counts.left) + " left, " +
                     std::to_string(counts.failed) + " failed";
  if (counts.left > 0) text += "; about " + long_duration(counts.seconds_left) + " of one core left";
  return text + '\n';
}

std::string text_of(const Status& status, std::size_t jobs) {
  std::string text = counted(jobs, "job") + ": " + text_of(status.all);
  for (const auto& [number, counts] : status.of_shards) {
    if (status.shards == 1) break;
    text += "  shard " + std::to_string(number) + '/' + std::to_string(status.shards) + ": " + text_of(counts);
  }
  for (const JobRecord& record : status.troubles) {
    text += std::string(name(record.state)) + ": " + printable(record.name) + ": " + printable(record.error) + '\n';
  }
  for (const std::string& note : status.notes) text += "note: " + printable(note) + '\n';
  return text;
}

}  // namespace

const char* name(JobState state) noexcept { return kStates.at(static_cast<std::size_t>(state)); }

ContentHash hash_of_job(const BatchJob& job) { return cache::hash_of(job.name, job.input, job.options); }

RunReport::RunReport(const fs::path& results, const Shard& shard)
    : file_(results / kReports /
            ("shard-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count) + '-' +
             printable(host_name()) + '-' + std::to_string(platform::process_number()) + ".jsonl")) {
  std::error_code trouble;
  fs::create_directories(file_.parent_path(), trouble);
  stream_.open(file_, std::ios::app | std::ios::binary);
  if (trouble || !stream_)
    throw Error(ErrorCode::file_access,
                platform::utf8(file_) + ": cannot be written; check permissions and free space");
}

void RunReport::add(const JobRecord& record) {
  Json json = {{"job", record.job},           {"index", record.index},   {"name", record.name},
               {"state", name(record.state)}, {"result", record.result}, {"seconds", record.seconds},
               {"threads", record.threads},   {"host", record.host},     {"process", record.process},
               {"start", record.start},       {"end", record.end}};
  if (!record.error_code.empty()) json["error_code"] = record.error_code;
  if (!record.error.empty()) json["error"] = record.error;
  const std::scoped_lock lock(mutex_);
  stream_ << json.one_line() + '\n' << std::flush;
  if (!stream_) throw ResultStoreError(platform::utf8(file_) + ": cannot be written; is the disk full?");
}

void show_status(const BatchPlan& plan, const fs::path& results, bool as_json) {
  const Status status = status_of(plan, results);
  const std::size_t jobs = plan.jobs.size();
  print_result(as_json ? json_text(json_of(status, jobs)) : text_of(status, jobs));
  if (status.troubles.empty()) return;
  throw Error(ErrorCode::corrupt_file,
              counted(status.troubles.size(), "job") + " of " + std::to_string(jobs) + " failed or differ");
}

}  // namespace welkin::tool
