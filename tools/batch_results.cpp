// The folder of a batch's results.
#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "cache/recipe.h"
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
constexpr int kVersion = 1;
constexpr const char* kListName = "result.json";  // lists all other files with their hashes
constexpr const char* kPartial = "partial";

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& reason) {
  throw Error(ErrorCode::file_access,
              platform::utf8(path) + ": " + what + " (" + reason + "); check its permissions and the free space");
}

void make_folder(const fs::path& path) {
  std::error_code trouble;
  fs::create_directories(path, trouble);
  if (trouble) fail(path, "cannot be made", trouble.message());
}

void remove_quietly(const fs::path& path) noexcept {
  std::error_code trouble;
  fs::remove_all(path, trouble);
}

struct Removal {
  const fs::path& path;
  ~Removal() { remove_quietly(path); }
};

/// Returns this machine's name as part of a file's, which no other machine has: "node-1" is "node_2d1".
std::string host_in_names() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name;
  for (const char c : host_name()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      name += c;
    } else {
      name += {'_', kDigits[byte / 16], kDigits[byte % 16]};
    }
  }
  return name.empty() ? "_" : name;
}

ResultFile file_in(const Json& value, const std::string& where) {
  constexpr double kMost = 1e15;
  ResultFile file;
  std::string hash;
  double bytes = -1.0;
  read_object(value, where, {text("name", file.name), number("bytes", bytes), text("hash", hash)});
  const std::optional<ContentHash> found = hash_in(hash);
  const bool is_ours = file.name == kManifestName || is_plain_name(file.name);
  if (!is_ours || !found || !(bytes >= 0.0 && bytes <= kMost)) throw Flaw{where};
  file.bytes = static_cast<std::uint64_t>(bytes);
  file.hash = *found;
  return file;
}

ResultFiles files_in(const Json& json) {
  std::string schema;
  std::string hash;
  int version = 0;
  ResultFiles files;
  const auto add = [&](const Json& value, const std::string& where) { files.push_back(file_in(value, where)); };
  read_object(json, "result",
              {text("schema", schema),
               whole_number("version", version),
               text("hash", hash),
               {"files", [&](const Json& value, const std::string& where) { read_list(value, where, add); }}});
  if (schema != kSchema || version != kVersion || files.empty() || hash != hash_of(files).text()) {
    throw Flaw{"is not a list of a result's files"};
  }
  return files;
}

ResultFiles hash_files_in(const fs::path& folder) {
  ResultFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files.push_back({platform::utf8(entry.path().filename()), static_cast<std::uint64_t>(entry.file_size()),
                     hash_file(entry.path())});
  }
  std::ranges::sort(files, {}, &ResultFile::name);
  return files;
}

}  // namespace

ContentHash hash_of(const ResultFiles& files) {
  std::string all;
  for (const ResultFile& file : files) all += file.name + ' ' + file.hash.text() + '\n';
  return hash_bytes(all.data(), all.size());
}

Json json_of(const ResultFiles& files) {
  Json list = Json::array();
  for (const ResultFile& file : files) {
    list.push_back({{"name", file.name}, {"bytes", file.bytes}, {"hash", file.hash.text()}});
  }
  return list;
}

ContentHash result_key_of(const BakeCommandOptions& options, const BatchJob& job) {
  const EnvironmentInfo info = inspect_environment(platform::path_of(*options.input), options.common.read);
  std::vector<ContentHash> files;
  for (const fs::path& file : input_files(options, info)) files.push_back(hash_file(file));
  std::string asked;
  for (const std::string& word : job.options) asked.append(word).push_back('\0');
  // A file's name may tell its layout.
  const std::string understood = std::string(name(info.layout)) + '\n' + info.format_words();
  return cache::result_key("batch result",
                           {cache::hash_of(asked, scene_text(options.scene), understood), combine(files)});
}

ContentHash result_key_of(const BatchPlan& plan, const BatchJob& job) {
  BakeCommandOptions options = bake_options_of(plan, job.options);
  options.input = platform::utf8(plan.place(job.input));
  return result_key_of(options, job);
}

std::optional<ResultFiles> listed_in(const fs::path& result) {
  try {
    return files_in(read_json_file(result / kListName, ""));
  } catch (const Flaw&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool is_whole(const fs::path& result) {
  const std::optional<ResultFiles> files = listed_in(result);
  return files && std::ranges::all_of(*files, [&](const ResultFile& file) {
           std::error_code unknown;
           return fs::file_size(result / file.name, unknown) == file.bytes && !unknown;
         });
}

std::string damaged_files(const fs::path& result, const ResultFiles& files) {
  std::string damaged;
  for (const ResultFile& file : files) {
    try {
      if (hash_file(result / file.name) == file.hash) continue;
    } catch (const Error&) {  // it is not there
    }
    damaged += (damaged.empty() ? "" : ", ") + file.name;
  }
  return damaged;
}

ResultStore::ResultStore(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_ / kPartial);
  const std::string reason = reason_not_to_write_in(folder_);
  if (!reason.empty()) fail(folder_, "cannot be written to", reason);
  remove_what_dead_processes_left();
  begin_own_folder();
}

ResultStore::~ResultStore() {
  lock_.reset();
  remove_quietly(own_);
}

/// Whose process is not there and whose lock can be had is dead: numbers are used again, and not every network file
/// system has locks. Other machines' stay.
void ResultStore::remove_what_dead_processes_left() const {
  std::error_code trouble;
  std::vector<fs::path> left;
  const std::string own_machine = host_in_names() + '-';
  for (fs::directory_iterator at(folder_ / kPartial, trouble), end; !trouble && at != end; at.increment(trouble)) {
    const std::string name = platform::utf8(at->path().filename());
    if (!name.starts_with(own_machine)) continue;
    const std::string number = name.substr(own_machine.size(), name.rfind('-') - own_machine.size());
    const std::optional<int> process = whole_number_in(number);
    if (process && !is_running(*process)) left.push_back(at->path());
  }
  for (const fs::path& path : left) {
    platform::FolderLock lock(path);
    if (lock.take()) remove_quietly(path);
  }
}

void ResultStore::begin_own_folder() {
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    own_ = folder_ / kPartial /
           (host_in_names() + '-' + std::to_string(platform::process_number()) + '-' + std::to_string(attempt));
    std::error_code trouble;
    if (!fs::create_directory(own_, trouble)) {
      if (trouble) fail(own_, "cannot be made", trouble.message());
      continue;
    }
    lock_.emplace(own_);
    // Another process may have taken it for a dead one's before it was locked.
    if (lock_->take() && fs::exists(own_, trouble)) return;
  }
  fail(own_, "cannot be made", "others take it away");
}

fs::path ResultStore::fresh() { return own_ / std::to_string(made_.fetch_add(1)); }

bool ResultStore::add(const ContentHash& key, const Make& make) {
  constexpr int kAttempts = 3;
  const fs::path made = fresh();
  const Removal removal{made};
  fill(made, [&](const fs::path& folder) {
    make(folder);
    const ResultFiles files = hash_files_in(folder);
    write_text_file(
        folder / kListName,
        json_text(
            {{"schema", kSchema}, {"version", kVersion}, {"hash", hash_of(files).text()}, {"files", json_of(files)}}));
  });
  std::error_code trouble;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    fs::rename(made, place(key), trouble);
    if (!trouble) return true;
    if (is_whole(place(key))) return false;
    // What is there is damaged. It leaves in one step, too.
    const fs::path aside = fresh();
    std::error_code ignored;
    fs::rename(place(key), aside, ignored);
    remove_quietly(aside);
  }
  fail(place(key), "cannot get its name", trouble.message());
}

ResultFiles ResultStore::trial(const Make& make) {
  const fs::path made = fresh();
  const Removal removal{made};
  fill(made, make);
  return hash_files_in(made);
}

void ResultStore::fill(const fs::path& folder, const Make& make) const {
  try {
    make_folder(folder);
    make(folder);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::file_access) throw;
    // Whether the folder takes as much as a result may have: what the failed file had is free again.
    constexpr int kMebibytes = 64;
    const fs::path file = folder / "test";
    std::ofstream stream(file, std::ios::binary);
    const std::string mebibyte(std::size_t{1} << 20U, '\0');
    for (int i = 0; i < kMebibytes && stream; ++i) stream << mebibyte;
    stream.close();
    if (stream) throw;
    throw ResultStoreError(platform::utf8(folder_) + ": cannot be written to; is it full? (" + error.what() + ")");
  }
}

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
