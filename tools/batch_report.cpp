#include "tools/batch_report.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "cache/recipe.h"
#include "platform/text.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "welkin batch report";
constexpr int kVersion = 1;
constexpr std::size_t kMostRecords = 100'000'000;
constexpr std::uintmax_t kMostReportBytes = std::uintmax_t{1} << 32U;

using Clock = std::chrono::steady_clock;
constexpr Clock::duration kPause = std::chrono::seconds{1};  // at least, between two times of writing a report
constexpr int kShareOfWriting = 10;                          // and at least as many times what the last one took

Json record_json(const JobRecord& record) {
  Json json = {{"job", record.job},           {"index", record.index},   {"name", record.name},
               {"state", name(record.state)}, {"result", record.result}, {"seconds", record.seconds},
               {"threads", record.threads},   {"host", record.host},     {"process", record.process},
               {"start", record.start},       {"end", record.end}};
  if (record.error.empty()) return json;
  json["error_code"] = record.error_code;
  json["error"] = record.error;
  return json;
}

JobState state_in(const std::string& word, const std::string& where) {
  for (const JobState state :
       {JobState::computed, JobState::present, JobState::failed, JobState::verified, JobState::differs}) {
    if (word == name(state)) return state;
  }
  throw Flaw{where + ".state is no state of a job"};
}

JobRecord record_in(const Json& value, const std::string& where) {
  JobRecord record;
  int index = -1;
  double process = 0.0;
  std::string state;
  read_object(
      value, where,
      {text("job", record.job), whole_number("index", index), text("name", record.name), text("state", state),
       text("result", record.result), number("seconds", record.seconds), whole_number("threads", record.threads),
       text("host", record.host), number("process", process), text("start", record.start), text("end", record.end),
       text("error_code", record.error_code), text("error", record.error)});
  if (index < 0) throw Flaw{where + ".index is no job's"};
  record.index = static_cast<std::size_t>(index);
  record.process = static_cast<std::int64_t>(process);
  record.state = state_in(state, where);
  return record;
}

void ignore(const Json& /*value*/, const std::string& /*where*/) {}

std::vector<JobRecord> records_in(const Json& json) {
  std::vector<JobRecord> records;
  std::string schema;
  int version = 0;
  const auto add = [&](const Json& value, const std::string& where) { records.push_back(record_in(value, where)); };
  read_object(
      json, "the report",
      {text("schema", schema),
       whole_number("version", version),
       {"shard", ignore},
       {"shards", ignore},
       {"counts", ignore},
       {"jobs", [&](const Json& list, const std::string& where) { read_list(list, where, add, kMostRecords); }}});
  if (schema != kSchema || version != kVersion) throw Flaw{"is no report that this version of Welkin has written"};
  return records;
}

std::string report_text(const std::vector<JobRecord>& records, const Shard& shard) {
  Json counts = Json::object();
  for (const JobState state :
       {JobState::computed, JobState::present, JobState::failed, JobState::verified, JobState::differs}) {
    counts[name(state)] = std::ranges::count(records, state, &JobRecord::state);
  }
  Json jobs = Json::array();
  for (const JobRecord& record : records) jobs.push_back(record_json(record));
  return json_text({{"schema", kSchema},
                    {"version", kVersion},
                    {"shard", shard.number},
                    {"shards", shard.count},
                    {"counts", counts},
                    {"jobs", jobs}});
}

std::string two_digits(long number) { return pad_left(std::to_string(number), 2); }

std::string with_zeros(std::string text) {
  std::ranges::replace(text, ' ', '0');
  return text;
}

}  // namespace

const char* name(JobState state) noexcept {
  switch (state) {
    case JobState::computed: return "computed";
    case JobState::present: return "present";
    case JobState::failed: return "failed";
    case JobState::verified: return "verified";
    case JobState::differs: break;
  }
  return "differs";
}

std::string time_now() {
  namespace chrono = std::chrono;
  const auto now = chrono::floor<chrono::milliseconds>(chrono::system_clock::now());
  const auto today = chrono::floor<chrono::days>(now);
  const chrono::year_month_day date(today);
  const chrono::hh_mm_ss time(now - today);
  const std::string day = std::to_string(static_cast<int>(date.year())) + '-' +
                          two_digits(static_cast<long>(static_cast<unsigned>(date.month()))) + '-' +
                          two_digits(static_cast<long>(static_cast<unsigned>(date.day())));
  return with_zeros(day + 'T' + two_digits(time.hours().count()) + ':' + two_digits(time.minutes().count()) + ':' +
                    two_digits(time.seconds().count()) + '.' + pad_left(std::to_string(time.subseconds().count()), 3) +
                    'Z');
}

ContentHash hash_of_job(const BatchJob& job) { return cache::hash_of(job.name, job.input, job.options); }

void RecordList::add(JobRecord record) {
  const bool is_outcome = record.state == JobState::present || record.state == JobState::failed;
  const bool is_verification = record.state == JobState::verified || record.state == JobState::differs;
  if (!record.job.empty()) {
    const auto found = replaceable_.find(record.job);
    if (found != replaceable_.end() && !(is_verification && records_[found->second]->state == JobState::present)) {
      records_[found->second].reset();
      replaceable_.erase(found);
    }
    if (is_outcome) replaceable_.emplace(record.job, records_.size());
  }
  records_.emplace_back(std::move(record));
}

std::vector<JobRecord> RecordList::all() const {
  std::vector<JobRecord> all;
  all.reserve(records_.size());
  for (const std::optional<JobRecord>& record : records_) {
    if (record) all.push_back(*record);
  }
  return all;
}

ShardReport::ShardReport(const fs::path& results, const Shard& shard, std::stop_token stop)
    : file_(results / "reports" /
            ("shard-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count) + ".json")),
      shard_(shard),
      stop_(std::move(stop)) {
  std::error_code trouble;
  fs::create_directories(file_.parent_path(), trouble);
  if (!trouble) return;
  throw Error(ErrorCode::file_access,
              platform::utf8(file_.parent_path()) + ": cannot be made (" + trouble.message() + ")");
}

void ShardReport::add(JobRecord record) {
  const std::scoped_lock lock(mutex_);
  unwritten_.push_back(std::move(record));
  if (!next_write_) next_write_ = Clock::now() + kPause;
  if (Clock::now() >= *next_write_) write_locked();
}

void ShardReport::write() {
  const std::scoped_lock lock(mutex_);
  write_locked();
}

void ShardReport::write_locked() {
  platform::FolderLock folder(file_.parent_path());  // another process may report the same shard
  lock(folder);
  const Clock::time_point start = Clock::now();
  read_what_others_wrote();
  for (JobRecord& record : unwritten_) records_.add(std::move(record));
  unwritten_.clear();
  write_text_file(file_, report_text(records_.all(), shard_));
  stamp_ = stamp();
  const Clock::time_point end = Clock::now();
  next_write_ = end + std::max<Clock::duration>(kPause, kShareOfWriting * (end - start));
}

/// A process that was stopped while it had the folder would keep it for ever.
void ShardReport::lock(platform::FolderLock& folder) {
  constexpr std::chrono::milliseconds kBetween{5};
  constexpr std::chrono::seconds kPatience{30};
  constexpr std::chrono::seconds kPatienceOfStopped{2};
  Clock::time_point last = Clock::now() + (gave_up_ ? Clock::duration{0} : kPatience);
  bool is_shortened = false;
  while (!folder.take()) {
    if (!is_shortened && stop_.stop_requested()) {
      is_shortened = true;
      last = std::min<Clock::time_point>(last, Clock::now() + kPatienceOfStopped);
    }
    if (Clock::now() >= last) {
      gave_up_ = true;
      throw Error(ErrorCode::file_access, platform::utf8(file_.parent_path()) +
                                              ": another process keeps it locked and does not go on; end that one, and "
                                              "run again");
    }
    std::this_thread::sleep_for(kBetween);
  }
  gave_up_ = false;
}

void ShardReport::read_what_others_wrote() {
  const std::optional<Stamp> now = stamp();
  if (now && now == stamp_) return;
  records_ = {};
  if (!now) return;
  try {
    for (JobRecord& record : read_report(file_)) records_.add(std::move(record));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::file_access) throw;  // a damaged one is begun anew
  }
}

std::optional<ShardReport::Stamp> ShardReport::stamp() const {
  std::error_code no_bytes;
  std::error_code no_time;
  const Stamp stamp{fs::file_size(file_, no_bytes), fs::last_write_time(file_, no_time)};
  if (no_bytes || no_time) return std::nullopt;
  return stamp;
}

std::vector<JobRecord> read_report(const fs::path& file) {
  try {
    return records_in(read_json_file(file, "'welkin batch run' writes one", kMostReportBytes));
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, platform::utf8(file) + ": " + flaw.message);
  }
}

std::optional<Shard> shard_of_report(const fs::path& file) {
  constexpr std::string_view kStart = "shard-";
  constexpr std::string_view kOf = "-of-";
  constexpr std::string_view kEnd = ".json";
  const std::string name = platform::utf8(file.filename());
  const std::size_t of = name.find(kOf);
  if (!name.starts_with(kStart) || !name.ends_with(kEnd) || of == std::string::npos) return std::nullopt;
  const auto number_between = [&](std::size_t begin, std::size_t end) {
    return end > begin ? whole_number_in(name.substr(begin, end - begin)).value_or(0) : 0;
  };
  const Shard shard{number_between(kStart.size(), of), number_between(of + kOf.size(), name.size() - kEnd.size())};
  if (shard.number < 1 || shard.count < shard.number || shard.count > kMostShards) return std::nullopt;
  return shard;
}

std::vector<fs::path> reports_in(const fs::path& results) {
  std::vector<fs::path> files;
  std::error_code none;
  for (fs::directory_iterator at(results / "reports", none), end; !none && at != end; at.increment(none)) {
    if (shard_of_report(at->path())) files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace welkin::tool
