#include "tools/batch_report.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "platform/file.h"
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

Json record_json(const JobRecord& record) {
  Json json = {{"index", record.index},   {"name", record.name},       {"state", name(record.state)},
               {"result", record.result}, {"seconds", record.seconds}, {"threads", record.threads},
               {"host", record.host},     {"process", record.process}, {"start", record.start},
               {"end", record.end}};
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
      {whole_number("index", index), text("name", record.name), text("state", state), text("result", record.result),
       number("seconds", record.seconds), whole_number("threads", record.threads), text("host", record.host),
       number("process", process), text("start", record.start), text("end", record.end),
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

/// What was computed stays on record; of what was merely found, or failed, the last time counts.
void add_record(std::vector<JobRecord>& records, JobRecord record) {
  std::erase_if(records, [&](const JobRecord& old) {
    return old.index == record.index && (old.state == JobState::present || old.state == JobState::failed);
  });
  records.push_back(std::move(record));
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

const char* name(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument: return "invalid_argument";
    case ErrorCode::rejected_pixel: return "rejected_pixel";
    case ErrorCode::file_access: return "file_access";
    case ErrorCode::corrupt_file: return "corrupt_file";
    case ErrorCode::unsupported_file: return "unsupported_file";
    case ErrorCode::limit_exceeded: return "limit_exceeded";
    default: break;  // a bake ends with no other
  }
  return "cancelled";
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

ShardReport::ShardReport(const fs::path& results, const Shard& shard)
    : file_(results / "reports" /
            ("shard-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count) + ".json")),
      shard_(shard) {
  std::error_code trouble;
  fs::create_directories(file_.parent_path(), trouble);
  if (!trouble) return;
  throw Error(ErrorCode::file_access,
              platform::utf8(file_.parent_path()) + ": cannot be made (" + trouble.message() + ")");
}

void ShardReport::add(JobRecord record) {
  constexpr std::chrono::seconds kPause{1};
  const std::scoped_lock lock(mutex_);
  unwritten_.push_back(std::move(record));
  const auto now = std::chrono::steady_clock::now();
  if (!written_) written_ = now;
  if (now - *written_ >= kPause) write_locked();
}

void ShardReport::write() {
  const std::scoped_lock lock(mutex_);
  write_locked();
}

void ShardReport::write_locked() {
  constexpr std::chrono::milliseconds kPause{5};
  platform::FolderLock folder(file_.parent_path());  // another process may report the same shard
  while (!folder.take()) std::this_thread::sleep_for(kPause);
  std::error_code unknown;
  std::vector<JobRecord> records;
  if (fs::exists(file_, unknown)) {
    try {
      records = read_report(file_);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::file_access) throw;  // a damaged one is begun anew
    }
  }
  for (JobRecord& record : unwritten_) add_record(records, std::move(record));
  unwritten_.clear();
  write_text_file(file_, report_text(records, shard_));
  written_ = std::chrono::steady_clock::now();
}

std::vector<JobRecord> read_report(const fs::path& file) {
  try {
    return records_in(read_json_file(file, "'welkin batch run' writes one", kMostReportBytes));
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, platform::utf8(file) + ": " + flaw.message);
  }
}

std::vector<fs::path> reports_in(const fs::path& results) {
  std::vector<fs::path> files;
  std::error_code none;
  for (fs::directory_iterator at(results / "reports", none), end; !none && at != end; at.increment(none)) {
    const std::string name = platform::utf8(at->path().filename());
    if (name.starts_with("shard-") && name.ends_with(".json")) files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace welkin::tool
