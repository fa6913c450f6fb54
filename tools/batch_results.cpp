#include "tools/batch_results.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "cache/recipe.h"
#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "welkin batch result";
constexpr int kVersion = 1;
constexpr const char* kPartial = "partial";
constexpr const char* kByName = "by-name";

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& reason) {
  throw Error(ErrorCode::file_access, platform::utf8(path) + ": " + what + " (" + reason + ")");
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

/// This machine's name as part of a file's, which no other machine has: "node-1" is "node_2d1".
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

/// Throws `Flaw`.
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

std::string result_text(const ResultFiles& files) {
  Json list = Json::array();
  for (const ResultFile& file : files) {
    list.push_back({{"name", file.name}, {"bytes", file.bytes}, {"hash", file.hash.text()}});
  }
  return json_text({{"schema", kSchema}, {"version", kVersion}, {"hash", hash_of(files).text()}, {"files", list}});
}

}  // namespace

ContentHash hash_of(const ResultFiles& files) {
  std::string all;
  for (const ResultFile& file : files) all += file.name + ' ' + file.hash.text() + '\n';
  return hash_bytes(all.data(), all.size());
}

ContentHash result_key_of(const BakeCommandOptions& options, const std::vector<std::string>& words) {
  const EnvironmentInfo info = inspect_environment(platform::path_of(*options.input), options.common.read);
  std::vector<ContentHash> files;
  for (const fs::path& file : input_files(options, info)) files.push_back(hash_file(file));
  std::string asked;
  for (const std::string& word : words) asked.append(word).push_back('\0');
  // A file's name may tell its layout.
  const std::string understood = std::string(name(info.layout)) + '\n' + info.format_words();
  return cache::result_key("batch result",
                           {cache::hash_of(asked, scene_text(options.scene), understood), combine(files)});
}

ContentHash result_key_of(const BatchPlan& plan, const BatchJob& job) {
  BakeCommandOptions options = bake_options_of(plan, job.options);
  options.input = platform::utf8(plan.place(job.input));
  return result_key_of(options, job.options);
}

std::optional<ResultFiles> listed_in(const fs::path& result) {
  try {
    return files_in(read_json_file(result / kResultName, ""));
  } catch (const Flaw&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool has_files(const fs::path& result, const ResultFiles& files) {
  return std::ranges::all_of(files, [&](const ResultFile& file) {
    std::error_code unknown;
    const auto bytes = fs::file_size(result / file.name, unknown);
    return !unknown && static_cast<std::uint64_t>(bytes) == file.bytes;
  });
}

std::vector<std::string> damaged_files(const fs::path& result, const ResultFiles& files) {
  std::vector<std::string> damaged;
  for (const ResultFile& file : files) {
    try {
      if (hash_file(result / file.name) == file.hash) continue;
    } catch (const Error&) {  // it is not there
    }
    damaged.push_back(file.name);
  }
  return damaged;
}

ResultFiles hash_files_in(const fs::path& folder) {
  ResultFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = platform::utf8(entry.path().filename());
    if (name == kResultName || !entry.is_regular_file()) continue;
    files.push_back({name, static_cast<std::uint64_t>(entry.file_size()), hash_file(entry.path())});
  }
  std::ranges::sort(files, {}, &ResultFile::name);
  return files;
}

ResultStore::ResultStore(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_ / kPartial);
  const std::string reason = reason_not_to_write_in(folder_);
  if (!reason.empty()) fail(folder_, "cannot be written to", reason);
  clean();
  begin_own_folder();
}

ResultStore::~ResultStore() {
  lock_.reset();
  remove_quietly(own_);
}

/// Whose process is not there and whose lock can be had is dead: numbers are used again, and not every network file
/// system has locks. Other machines' stay.
void ResultStore::clean() const {
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

bool ResultStore::is_whole(const ContentHash& key) const {
  const std::optional<ResultFiles> files = listed_in(place(key));
  return files && has_files(place(key), *files);
}

bool ResultStore::add(const ContentHash& key, const std::function<void(const fs::path& folder)>& make) {
  const fs::path made = own_ / key.text();
  struct Removal {
    const fs::path& path;
    ~Removal() { remove_quietly(path); }
  } removal{made};
  fill(made, [&](const fs::path& folder) {
    make(folder);
    write_text_file(folder / kResultName, result_text(hash_files_in(folder)));
  });
  return publish(made, key);
}

void ResultStore::fill(const fs::path& folder, const std::function<void(const fs::path&)>& make) const {
  try {
    make_folder(folder);
    make(folder);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::file_access) check_that_it_takes_files(error);
    throw;
  }
}

/// While what was made is still there, and with as much as a result may have: what the failed file had is free again.
void ResultStore::check_that_it_takes_files(const Error& reason) const {
  constexpr std::size_t kMebibytes = 64;
  static std::atomic<std::uint64_t> number{0};
  const fs::path file = own_ / ("test-" + std::to_string(number.fetch_add(1)));
  const std::string mebibyte(std::size_t{1} << 20U, '\0');
  std::ofstream stream(file, std::ios::binary);
  for (std::size_t i = 0; i < kMebibytes && stream; ++i) {
    stream.write(mebibyte.data(), static_cast<std::streamsize>(mebibyte.size()));
  }
  stream.close();
  remove_quietly(file);
  if (stream) return;
  throw ResultStoreError(platform::utf8(folder_) + ": takes no more results; is it full? (" + reason.what() + ")");
}

bool ResultStore::publish(const fs::path& made, const ContentHash& key) {
  constexpr int kAttempts = 3;
  const fs::path target = place(key);
  std::error_code trouble;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    fs::rename(made, target, trouble);
    if (!trouble) return true;
    if (is_whole(key)) return false;
    // What is there is damaged. It leaves in one step, too.
    const fs::path aside = own_ / (key.text() + "-damaged");
    std::error_code ignored;
    fs::rename(target, aside, ignored);
    remove_quietly(aside);
  }
  fail(target, "cannot get its name", trouble.message());
}

void ResultStore::add_name(const ContentHash& key, const std::string& name) const noexcept {
  std::error_code trouble;
  const fs::path link = folder_ / kByName / platform::path_of(name);
  const fs::path target = fs::path("..") / key.text();
  if (fs::is_symlink(link, trouble) ? fs::read_symlink(link, trouble) == target : fs::exists(link, trouble)) return;
  fs::create_directory(link.parent_path(), trouble);
  const fs::path made = own_ / (key.text() + "-link");  // a rename replaces a link in one step
  fs::create_directory_symlink(target, made, trouble);
  if (!trouble) fs::rename(made, link, trouble);
  if (trouble) remove_quietly(made);
}

void ResultStore::remove_name(const std::string& name) const noexcept {
  std::error_code trouble;
  const fs::path link = folder_ / kByName / platform::path_of(name);
  if (fs::is_symlink(link, trouble)) fs::remove(link, trouble);
}

ResultFiles ResultStore::trial(const ContentHash& key, const std::function<void(const fs::path& folder)>& make) {
  const fs::path made = own_ / (key.text() + "-trial");
  struct Removal {
    const fs::path& path;
    ~Removal() { remove_quietly(path); }
  } removal{made};
  fill(made, make);
  return hash_files_in(made);
}

}  // namespace welkin::tool
