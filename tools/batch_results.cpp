// The folder of a batch's results.
#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>
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
    throw Flaw{"is no list of a result's files"};
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
    throw ResultStoreError(platform::utf8(folder_) + ": takes no more results; is it full? (" + error.what() + ")");
  }
}

}  // namespace welkin::tool
