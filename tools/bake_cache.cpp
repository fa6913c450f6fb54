#include "tools/bake_cache.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "cache/recipe.h"
#include "platform/text.h"
#include "tools/arguments.h"
#include "tools/engine_folders.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr std::uint64_t kMaxIndexBytes = std::uint64_t{1} << 20U;
constexpr const char* kTimes = "\n  \"times\": ";  // the last member of a manifest: all that differs from run to run

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::optional<ContentHash> hash_in(std::string_view text) {
  constexpr std::size_t kDigits = 16;
  if (text.size() != 2 * kDigits) return std::nullopt;
  ContentHash hash;
  for (auto* const half : {&hash.high, &hash.low}) {
    const auto [end, failure] = std::from_chars(text.data(), text.data() + kDigits, *half, 16);
    if (failure != std::errc() || end != text.data() + kDigits) return std::nullopt;
    text.remove_prefix(kDigits);
  }
  return hash;
}

}  // namespace

Member hash(const char* name, ContentHash& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    const std::optional<ContentHash> found = hash_in(value.is_text() ? value.text() : "");
    if (!found) throw Flaw{where + " is no hash"};
    target = *found;
  };
  return {name, read, [&target] { return target.text(); }};
}

bool is_plain_name(std::string_view name) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789_.";
  if (name == kReadmeName) return true;
  return !name.empty() && name.front() != '.' && name != kManifestName &&
         name.find_first_not_of(kLetters) == std::string_view::npos;
}

namespace {

Member kept_file(const char* name, KeptBake::File& target) {
  return object(name, target,
                {text("name", target.about.name), text("format", target.about.format),
                 bytes("bytes", target.about.bytes), hash("hash", target.hash)});
}

/// Returns the members of a bake's index, which holds everything but the files' contents.
std::vector<Member> members_of(KeptBake& bake) {
  return {list("files", bake.files, kept_file), text("manifest", bake.manifest), text("source", bake.words.source),
          text("results", bake.words.results), texts("notes", bake.words.notes)};
}

/// Reads the bake without the files' contents. Throws `Flaw`.
KeptBake index_in(std::string_view text) {
  KeptBake index;
  read_object(parse_json(std::string(text)), "index", members_of(index));
  for (const KeptBake::File& file : index.files) {
    if (!is_plain_name(file.about.name)) throw Flaw{"the index names other files than a bake's"};
  }
  return index;
}

/// Replaces the times, if there are any, with the time of this run alone.
std::string with_own_times(const std::string& manifest, double milliseconds) {
  const std::size_t offset = manifest.rfind(kTimes);
  if (offset == std::string::npos) return manifest;
  const Json time = {{"name", "cache"},
                     {"action", name(PassAction::reuse)},
                     {"reason", "all files found on disk"},
                     {"ms", milliseconds}};
  return manifest.substr(0, offset) + kTimes + "[\n    " + time.one_line() + "]\n}\n";
}

}  // namespace

std::vector<std::filesystem::path> input_files(const BakeCommandOptions& options, const EnvironmentInfo& info) {
  if (info.layout == Layout::six_files) return {info.faces.begin(), info.faces.end()};
  return {platform::path_of(*options.input)};
}

ContentHash bake_key(const BakeCommandOptions& options) {
  std::vector<std::string> asked;
  for (const auto& [name, value] : options.asked) asked.insert(asked.end(), {name, value});
  std::string understood;  // a file's name may determine its layout
  std::vector<ContentHash> files;
  if (options.input) {
    const EnvironmentInfo info = inspect_environment(platform::path_of(*options.input), options.common.read);
    understood = std::string(name(info.layout)) + '\n' + info.format_description();
    for (const std::filesystem::path& file : input_files(options, info)) files.push_back(hash_file(file));
  }
  const std::string scene = needs_json(options.scene.needs()).one_line();
  return cache::result_key("bake", {cache::hash_of(asked, options.called, scene, understood), combine(files)});
}

BakeFolderCache::BakeFolderCache(const BakeCommandOptions& options) : options_(options) {
  if (options.common.cache.empty() || options.scene.explains() || options.compute) return;
  if (options.input && is_stream(*options.input)) return;  // a stream cannot be hashed before it is read
  cache_.emplace(CacheOptions{.folder = platform::path_of(options.common.cache), .memory_bytes = 0});
  key_ = bake_key(options);
}

std::optional<KeptBake> BakeFolderCache::find() {
  if (!cache_) return std::nullopt;
  const auto start = std::chrono::steady_clock::now();
  const auto bytes = cache_->find_bytes(key_, kMaxIndexBytes);
  if (!bytes) return std::nullopt;
  try {
    KeptBake kept = index_in({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    std::uint64_t all = 0;
    for (KeptBake::File& file : kept.files) {
      all += file.about.bytes;
      if (all > options_.common.read.memory_limit_bytes) return std::nullopt;
      auto contents = cache_->find_bytes(file.hash, file.about.bytes);
      if (!contents || hash_bytes(contents->data(), contents->size()) != file.hash) return std::nullopt;
      file.contents = std::move(*contents);
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    kept.manifest = with_own_times(kept.manifest, took.count());
    return kept;
  } catch (const Flaw&) {  // not an index of this version
    return std::nullopt;
  }
}

void BakeFolderCache::keep(const OutputFolder& folder, const std::string& manifest, const BakeWords& words,
                           std::vector<std::string>& notes) {
  if (!cache_) return;
  if (bake_key(options_) != key_) return;
  KeptBake index{{}, manifest, words};
  for (const WrittenFile& file : folder.files()) {
    const std::vector<std::byte> bytes = bytes_of(folder.place(file.name));
    const ContentHash hash = hash_bytes(bytes.data(), bytes.size());
    cache_->keep_bytes(hash, bytes);
    index.files.push_back({.about = file, .hash = hash});
    index.files.back().about.bytes = bytes.size();
  }
  const std::string text = json_object(members_of(index)).one_line();
  cache_->keep_bytes(key_, std::as_bytes(std::span(text)));
  const CacheStatistics statistics = cache_->statistics();
  if (statistics.write_failures > 0) notes.push_back("the cache could not keep all files: " + statistics.last_failure);
}

}  // namespace welkin::tool
