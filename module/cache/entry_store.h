// The format of an entry's file, and the folder of entries.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "welkin/result_cache.h"

namespace welkin::cache {

/// The kind of a payload. The numbers are stored on disk and never change.
enum class EntryKind : std::uint32_t {
  projection = 1,
  specular_mip = 2,
  cubemap = 3,
  face_sums = 4,
  sky_tables = 5,
  bytes = 6,
  octahedral = 7
};

struct EntryName {
  EntryKind kind{};
  ContentHash key;
  friend bool operator==(const EntryName&, const EntryName&) = default;
};

inline constexpr std::size_t kEntryHeaderBytes = 64;

/// The bytes before the payload, all little-endian.
struct EntryHeader {
  std::array<char, 8> magic{'W', 'L', 'K', 'N', 'E', 'N', 'T', '\n'};
  std::uint32_t version = 1;  ///< of this format
  EntryKind kind{};
  ContentHash key;
  std::uint64_t payload_bytes = 0;
  ContentHash checksum;   ///< XXH3-128 of the payload
  std::uint64_t sum = 0;  ///< XXH3 (low half) of all preceding bytes

  [[nodiscard]] EntryName name() const noexcept { return {kind, key}; }
};
static_assert(sizeof(EntryHeader) == kEntryHeaderBytes && std::has_unique_object_representations_v<EntryHeader> &&
              std::endian::native == std::endian::little);

[[nodiscard]] EntryHeader entry_header(const EntryName& name, std::span<const std::uint8_t> payload);

/// Reads a header; empty if the bytes do not begin with one of this version.
[[nodiscard]] std::optional<EntryHeader> read_entry_header(std::span<const std::uint8_t> bytes);

/// Returns whether a payload matches the header.
[[nodiscard]] bool is_payload_of(const EntryHeader& header, std::span<const std::uint8_t> payload);

// Entries in a folder that any number of processes share.

/// A folder of one file per entry, "<32 digits>-<kind>.welkin-entry". No other file is touched, except what our writers
/// left behind when they were killed. Thread-safe. Only std::bad_alloc is thrown: other failures are counted.
class EntryFolder {
 public:
  static constexpr std::uint64_t kAnySize = ~std::uint64_t{0};

  /// Creates the folder.
  EntryFolder(const std::filesystem::path& folder, std::uint64_t bound_bytes);

  /// Returns the payload and marks the entry as used now. Empty if there is no sound one; a damaged one is removed. A
  /// sound one has at most `most_bytes`: no memory is allocated for more. Links do not count as entries.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> find(const EntryName& name,
                                                              std::uint64_t most_bytes = kAnySize);

  /// Writes a file without a name, and names it when it is on the disk. Then removes the least recently used entries
  /// until the folder is within its bound.
  void store(const EntryName& name, std::span<const std::uint8_t> payload);

  /// Counts a payload that was not kept, for the reason `what`.
  void note_failure(const std::string& what);

  /// Removes an entry whose content is not what it should be.
  void remove_damaged(const EntryName& name);

  struct Counts {
    std::uint64_t damaged = 0;
    std::uint64_t write_failures = 0;
    std::string last_failure;
  };
  [[nodiscard]] Counts counts() const;

 private:
  [[nodiscard]] std::filesystem::path path_of(const EntryName& name) const;
  void tidy();

  std::filesystem::path folder_;
  std::uint64_t bound_bytes_;
  mutable std::mutex mutex_;
  std::uint64_t bytes_ = 0;  ///< as known: other processes may have added to it
  Counts counts_;
};

// Entries in this process.

using Payload = std::shared_ptr<const std::vector<std::uint8_t>>;

/// The most recently used payloads, within a bound on their bytes. Thread-safe.
class EntryMemory {
 public:
  explicit EntryMemory(std::uint64_t bound_bytes) : bound_bytes_(bound_bytes) {}

  /// Returns null if the entry is not here.
  [[nodiscard]] Payload find(const EntryName& name);
  /// Keeps a payload unless it is larger than the bound.
  void store(const EntryName& name, Payload payload);
  void remove(const EntryName& name);
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  struct Entry {
    EntryName name;
    Payload payload;
  };
  /// Mixes half of the key, which is a hash already, with the kind.
  struct Hash {
    std::size_t operator()(const EntryName& name) const noexcept {
      return static_cast<std::size_t>(name.key.low ^ static_cast<std::uint64_t>(name.kind));
    }
  };

  void erase(std::list<Entry>::iterator entry);

  std::uint64_t bound_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<EntryName, std::list<Entry>::iterator, Hash> index_;
  std::uint64_t bytes_ = 0;
};

}  // namespace welkin::cache
