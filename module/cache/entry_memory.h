// Entries in this process.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "cache/entry_format.h"

namespace welkin::cache {

using Payload = std::shared_ptr<const std::vector<std::uint8_t>>;

/// Payloads within a bound on their bytes: those that were used last. Thread-safe.
class EntryMemory {
 public:
  explicit EntryMemory(std::uint64_t bound_bytes) : bound_bytes_(bound_bytes) {}

  /// Null if it is not here.
  [[nodiscard]] Payload find(const EntryName& name);
  /// One that is larger than the bound is not kept.
  void store(const EntryName& name, Payload payload);
  void remove(const EntryName& name);
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  struct Entry {
    EntryName name;
    Payload payload;
  };
  /// Keys are hashes already.
  struct Hash {
    std::size_t operator()(const EntryName& name) const noexcept {
      return static_cast<std::size_t>(name.key.low ^ static_cast<std::uint64_t>(name.kind));
    }
  };

  void erase(std::list<Entry>::iterator entry);

  std::uint64_t bound_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<EntryName, std::list<Entry>::iterator, Hash> places_;
  std::uint64_t bytes_ = 0;
};

}  // namespace welkin::cache
