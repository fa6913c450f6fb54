// The store of results: looked up in memory, then on disk.
#pragma once

#include <atomic>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/artefacts.h"
#include "cache/entry_store.h"
#include "cache/recipe.h"
#include "jobs/stopwatch.h"
#include "welkin/result_cache.h"

namespace welkin::cache {

class ResultStore {
 public:
  explicit ResultStore(const CacheOptions& options) : memory_(options.memory_bytes) {
    if (!options.folder.empty()) folder_.emplace(options.folder, options.disk_bytes);
  }

  /// Returns what `decode` makes of the entry, whose payload has at most `most_bytes`; an entry that it cannot decode
  /// is removed. Without enough memory the entry counts as not found.
  template <class Decode>
  auto find(const EntryName& name, std::uint64_t most_bytes, const Decode& decode)
      -> std::optional<baking::Found<typename decltype(decode(ByteSpan{}))::value_type>> {
    using Found = baking::Found<typename decltype(decode(ByteSpan{}))::value_type>;
    const jobs::Stopwatch watch;
    bool on_disk = false;
    Payload payload = memory_.find(name);
    decltype(decode(ByteSpan{})) result;
    try {
      if (!payload && folder_) {
        on_disk = true;
        if (auto bytes = folder_->find(name, most_bytes)) payload = std::make_shared<const Bytes>(std::move(*bytes));
      }
      if (payload) result = decode(*payload);
      if (payload && !result) remove(name);
    } catch (const std::bad_alloc&) {
      result.reset();
    }
    if (!result) {
      ++misses_;
      return std::nullopt;
    }
    if (on_disk) memory_.store(name, payload);
    ++(on_disk ? disk_hits_ : memory_hits_);
    return Found{std::move(*result), on_disk ? "found on disk" : "found in memory", watch.milliseconds()};
  }

  /// Keeps what `encode` returns, if there is enough memory for it.
  template <class Encode>
  void store(const EntryName& name, const Encode& encode) {
    try {
      const auto payload = std::make_shared<const Bytes>(encode());
      if (folder_) folder_->store(name, *payload);
      memory_.store(name, payload);
    } catch (const std::bad_alloc&) {
      if (folder_) folder_->note_failure("no memory for a result's bytes");
    }
  }

  [[nodiscard]] CacheStatistics statistics() const {
    CacheStatistics statistics{memory_hits_, disk_hits_, misses_, 0, 0, {}, memory_.bytes()};
    if (!folder_) return statistics;
    const EntryFolder::Counts counts = folder_->counts();
    statistics.damaged = counts.damaged;
    statistics.write_failures = counts.write_failures;
    statistics.last_failure = counts.last_failure;
    return statistics;
  }

 private:
  void remove(const EntryName& name) {
    memory_.remove(name);
    if (folder_) folder_->remove_damaged(name);
  }

  EntryMemory memory_;
  std::optional<EntryFolder> folder_;
  std::atomic<std::uint64_t> memory_hits_{0};
  std::atomic<std::uint64_t> disk_hits_{0};
  std::atomic<std::uint64_t> misses_{0};
};

inline constexpr double kHashing = 0.1;  ///< of the progress

/// Marks the passes of a result that was found: those that had been run are reused.
inline void mark_reused(std::vector<PassRecord>& passes, const std::string& where, double milliseconds) {
  for (PassRecord& pass : passes) {
    if (pass.action == PassAction::run) pass.action = PassAction::reuse;
    pass.milliseconds = 0.0;
  }
  passes.insert(passes.begin(), {"cache", PassAction::reuse, where, milliseconds});
}

/// Returns the name of the entry of `project`, and of a bake's projection.
[[nodiscard]] inline EntryName projection_name(const ContentHash& pixels, const ProjectionOptions& options) {
  return {EntryKind::projection, result_key("project", {pixels, hash_options(options)})};
}

/// Finds a projection, whose passes then say that it was found.
inline std::optional<Projection> find_projection(ResultStore& store, const EntryName& name, int bands) {
  auto found =
      store.find(name, projection_bytes(bands), [bands](ByteSpan bytes) { return decode_projection(bytes, bands); });
  if (!found) return std::nullopt;
  mark_reused(found->value.diagnostics.passes, found->where, found->milliseconds);
  return std::move(found->value);
}

}  // namespace welkin::cache

namespace welkin {

class ResultCache::Store : public cache::ResultStore {
 public:
  using ResultStore::ResultStore;
};

}  // namespace welkin
