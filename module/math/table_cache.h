// Tables that depend on a size alone, computed once and shared.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "platform/float_environment.h"

namespace welkin::math {

/// Keeps the tables that were used last, within a bound on their bytes; thread-safe.
///
/// Key: compared with ==. Table: has `std::size_t bytes() const`. Users hold shared ownership, so a table may leave the
/// cache at any time. If two threads need the same missing table, the second waits for the first to build it. There are
/// few tables, so a list in order of use is searched.
///
/// The library's own caches are never destroyed (`static auto& cache = *new TableCache<...>(bytes);`): a worker that is
/// a global object has its threads still compute while the program exits, when the function-local statics that came
/// after it are gone. Leak checkers find them by the reference.
template <class Key, class Table>
class TableCache {
 public:
  explicit TableCache(std::size_t bound_bytes) : bound_bytes_(bound_bytes) {}

  /// The table for `key`, from `build()` (which returns a std::shared_ptr<const Table>) if it is not here.
  /// Throws what `build` throws; the next call then tries again. A table outlives the call that it was built for, so
  /// `build` runs with the default floating-point environment, whatever the caller's is.
  template <class Build>
  std::shared_ptr<const Table> get(const Key& key, const Build& build) {
    const std::shared_ptr<Entry> entry = find_or_add(key);
    const std::scoped_lock building(entry->building);
    if (!entry->table) {
      const platform::FloatingPointScope floating_point;
      entry->table = build();
      const std::scoped_lock lock(mutex_);
      entry->bytes = entry->table->bytes();
      bytes_ += entry->bytes;
      drop_oldest_beyond_bound();
    }
    return entry->table;
  }

  /// The table for `key` if it is here, null otherwise; never waits for one that is being built.
  [[nodiscard]] std::shared_ptr<const Table> find(const Key& key) {
    const std::scoped_lock lock(mutex_);
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (!((*it)->key == key)) continue;
      if ((*it)->bytes == 0) return nullptr;  // only once that is set may the table be looked at
      entries_.splice(entries_.begin(), entries_, it);
      return entries_.front()->table;
    }
    return nullptr;
  }

  /// Bytes of all tables held.
  [[nodiscard]] std::size_t bytes() const {
    const std::scoped_lock lock(mutex_);
    return bytes_;
  }

 private:
  struct Entry {
    explicit Entry(Key its_key) : key(std::move(its_key)) {}
    Key key;
    std::mutex building{};  ///< not a std::once_flag: under the thread sanitizer that hangs after an exception
    std::shared_ptr<const Table> table{};
    std::size_t bytes = 0;  ///< 0 while it is being built
  };

  std::shared_ptr<Entry> find_or_add(const Key& key) {
    const std::scoped_lock lock(mutex_);
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (!((*it)->key == key)) continue;
      entries_.splice(entries_.begin(), entries_, it);  // most recently used first
      return entries_.front();
    }
    entries_.push_front(std::make_shared<Entry>(key));
    return entries_.front();
  }

  void drop_oldest_beyond_bound() {
    for (auto it = entries_.end(); bytes_ > bound_bytes_ && it != entries_.begin();) {
      --it;
      if ((*it)->bytes == 0) continue;
      bytes_ -= (*it)->bytes;
      it = entries_.erase(it);
    }
  }

  std::size_t bound_bytes_;
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;
  std::size_t bytes_ = 0;
};

/// A table that is a list of numbers.
struct NumberTable {
  std::vector<double> values;
  [[nodiscard]] std::size_t bytes() const noexcept { return values.size() * sizeof(double); }
};

[[nodiscard]] inline std::shared_ptr<const NumberTable> number_table(std::vector<double> values) {
  return std::make_shared<const NumberTable>(NumberTable{std::move(values)});
}

}  // namespace welkin::math
