#include "cache/entry_store.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "platform/file.h"
#include "platform/text.h"
#include "welkin/core.h"

namespace welkin::cache {
namespace {

constexpr const char* kExtension = ".welkin-entry";

/// Returns the payload of a regular file if its length is possible and as stated, and its name and sum are right.
std::optional<std::vector<std::uint8_t>> sound_payload(platform::SharedFile& file, const EntryName& name,
                                                       std::uint64_t most_bytes) {
  const std::optional<std::uint64_t> size = file.size();
  std::array<std::uint8_t, kEntryHeaderBytes> start{};
  if (!size || *size < kEntryHeaderBytes || *size - kEntryHeaderBytes > most_bytes) return std::nullopt;
  if (!file.read(start.data(), start.size())) return std::nullopt;
  const std::optional<EntryHeader> header = read_entry_header(start);
  const std::uint64_t payload_bytes = *size - kEntryHeaderBytes;
  if (!header || !(header->name() == name) || header->payload_bytes != payload_bytes) return std::nullopt;
  std::vector<std::uint8_t> payload(payload_bytes);
  if (!file.read(payload.data(), payload.size()) || !is_payload_of(*header, payload)) return std::nullopt;
  return payload;
}

struct Found {
  std::filesystem::path path;
  std::filesystem::file_time_type used;
  std::uint64_t bytes;
};

bool has_only(std::string_view text, std::string_view letters) {
  return !text.empty() && text.find_first_not_of(letters) == std::string_view::npos;
}

/// Returns whether a name is of the form of `EntryFolder::path_of`: a hash and a kind.
bool is_entry(const std::filesystem::path& path) {
  constexpr std::size_t hash_letters = 32;
  const std::string name = platform::utf8(path.stem());
  return path.extension() == kExtension && name.size() > hash_letters && name[hash_letters] == '-' &&
         has_only(std::string_view(name).substr(0, hash_letters), "0123456789abcdef") &&
         has_only(std::string_view(name).substr(hash_letters + 1), "0123456789");
}

/// Returns all entries. Links do not count.
std::vector<Found> entries_in(const std::filesystem::path& folder) {
  std::vector<Found> entries;
  std::error_code failure;
  std::filesystem::directory_iterator at(folder, failure);
  for (; !failure && at != std::filesystem::directory_iterator(); at.increment(failure)) {
    std::error_code gone;  // another process may have removed the entry
    const std::filesystem::path& path = at->path();
    if (!is_entry(path) || !std::filesystem::is_regular_file(at->symlink_status(gone))) continue;
    const auto used = std::filesystem::last_write_time(path, gone);
    if (gone) continue;
    const std::uint64_t bytes = std::filesystem::file_size(path, gone);
    if (!gone) entries.push_back({path, used, bytes});
  }
  return entries;
}

}  // namespace

EntryFolder::EntryFolder(const std::filesystem::path& folder, std::uint64_t bound_bytes)
    : folder_(platform::reachable(folder)), bound_bytes_(bound_bytes) {
  std::error_code failure;
  std::filesystem::create_directories(folder_, failure);
  platform::remove_left_behind(folder_);
  if (failure) note_failure(platform::utf8(folder_) + ": " + failure.message());
  tidy();
}

std::filesystem::path EntryFolder::path_of(const EntryName& name) const {
  return folder_ /
         (name.key.text() + '-' + std::to_string(static_cast<std::uint32_t>(name.kind)) + std::string(kExtension));
}

std::optional<std::vector<std::uint8_t>> EntryFolder::find(const EntryName& name, std::uint64_t most_bytes) {
  platform::SharedFile file(path_of(name));
  if (!file.is_open()) return std::nullopt;
  std::optional<std::vector<std::uint8_t>> payload = sound_payload(file, name, most_bytes);
  if (!payload) {
    remove_damaged(name);
    return std::nullopt;
  }
  file.touch();  // used now
  return payload;
}

void EntryFolder::store(const EntryName& name, std::span<const std::uint8_t> payload) {
  if (payload.size() + kEntryHeaderBytes > bound_bytes_) return;
  try {
    platform::WholeFile file(path_of(name), nullptr, platform::WholeFile::Link::replaced);
    const EntryHeader header = entry_header(name, payload);
    file.write(&header, sizeof header);
    file.write(payload.data(), payload.size());
    constexpr bool to_disk = true;
    file.finish(to_disk);
    file.commit();
  } catch (const Error& error) {
    note_failure(error.what());
    return;
  }
  bool full = false;
  {
    const std::scoped_lock lock(mutex_);
    bytes_ += payload.size() + kEntryHeaderBytes;
    full = bytes_ > bound_bytes_;
  }
  if (full) tidy();
}

void EntryFolder::remove_damaged(const EntryName& name) {
  std::error_code ignored;
  std::filesystem::remove(path_of(name), ignored);
  const std::scoped_lock lock(mutex_);
  ++counts_.damaged;
}

void EntryFolder::tidy() {
  std::vector<Found> entries = entries_in(folder_);
  std::sort(entries.begin(), entries.end(), [](const Found& a, const Found& b) { return a.used < b.used; });
  std::uint64_t bytes = 0;
  for (const Found& entry : entries) bytes += entry.bytes;
  // Where listing takes long, extra space is freed, so that the next entry need not list again.
  constexpr std::size_t many = 1000;
  const bool frees_extra = bytes > bound_bytes_ && entries.size() > many;
  const std::uint64_t rest = frees_extra ? bound_bytes_ - bound_bytes_ / 10 : bound_bytes_;
  for (const Found& entry : entries) {
    if (bytes <= rest) break;
    std::error_code ignored;
    std::filesystem::remove(entry.path, ignored);
    bytes -= entry.bytes;
  }
  const std::scoped_lock lock(mutex_);
  bytes_ = bytes;
}

EntryFolder::Counts EntryFolder::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

void EntryFolder::note_failure(const std::string& what) {
  const std::scoped_lock lock(mutex_);
  ++counts_.write_failures;
  counts_.last_failure = what;
}

namespace {

std::uint64_t sum_of(const EntryHeader& header) { return hash_bytes(&header, offsetof(EntryHeader, sum)).low; }

}  // namespace

EntryHeader entry_header(const EntryName& name, std::span<const std::uint8_t> payload) {
  EntryHeader header{.kind = name.kind,
                     .key = name.key,
                     .payload_bytes = payload.size(),
                     .checksum = hash_bytes(payload.data(), payload.size())};
  header.sum = sum_of(header);
  return header;
}

std::optional<EntryHeader> read_entry_header(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kEntryHeaderBytes) return std::nullopt;
  EntryHeader header;
  std::memcpy(&header, bytes.data(), kEntryHeaderBytes);
  const EntryHeader known;
  const bool sound = header.magic == known.magic && header.version == known.version && header.sum == sum_of(header);
  return sound ? std::optional(header) : std::nullopt;
}

bool is_payload_of(const EntryHeader& header, std::span<const std::uint8_t> payload) {
  return payload.size() == header.payload_bytes && hash_bytes(payload.data(), payload.size()) == header.checksum;
}

Payload EntryMemory::find(const EntryName& name) {
  const std::scoped_lock lock(mutex_);
  const auto found = index_.find(name);
  if (found == index_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->payload;
}

void EntryMemory::store(const EntryName& name, Payload payload) {
  if (payload->size() > bound_bytes_) return;
  const std::scoped_lock lock(mutex_);
  if (const auto found = index_.find(name); found != index_.end()) erase(found->second);
  bytes_ += payload->size();
  entries_.push_front({name, std::move(payload)});
  index_[name] = entries_.begin();
  while (bytes_ > bound_bytes_) erase(std::prev(entries_.end()));
}

void EntryMemory::remove(const EntryName& name) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = index_.find(name); found != index_.end()) erase(found->second);
}

std::uint64_t EntryMemory::bytes() const {
  const std::scoped_lock lock(mutex_);
  return bytes_;
}

void EntryMemory::erase(std::list<Entry>::iterator entry) {
  bytes_ -= entry->payload->size();
  index_.erase(entry->name);
  entries_.erase(entry);
}

}  // namespace welkin::cache
