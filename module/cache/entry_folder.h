// Entries in a folder that any number of processes share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cache/entry_format.h"

namespace welkin::cache {

/// One file an entry, "<32 digits>-<kind>.welkin-entry"; no other file is ever touched, but for what our own writers
/// left behind when they were killed. Thread-safe. Nothing here throws but std::bad_alloc: what fails is counted.
class EntryFolder {
 public:
  /// Makes the folder.
  EntryFolder(std::filesystem::path folder, std::uint64_t bound_bytes);

  /// The payload, and the entry counts as used now. Nothing if there is none, or none that is sound; that is removed.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> find(const EntryName& name);

  /// Written beside and renamed. Then entries are removed, those used least recently first, until the folder is within
  /// its bound. Nobody waits for the disk: what the power's failure leaves of an entry is found out by its sums.
  void store(const EntryName& name, std::span<const std::uint8_t> payload);

  /// What was found is not what it should be.
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
  void note_failure(const std::string& what);

  std::filesystem::path folder_;
  std::uint64_t bound_bytes_;
  mutable std::mutex mutex_;
  std::uint64_t bytes_ = 0;  ///< known of: others may have added to it
  Counts counts_;
};

}  // namespace welkin::cache
