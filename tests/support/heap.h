// Heap allocations: counting them, making them fail, and how much working memory the process keeps.
#pragma once

#include <cstddef>

#include "welkin/core.h"

namespace welkin::test {

/// Keeps `bytes` of working memory while it lives: none of it remains from before, and none afterwards.
class KeptMemory {
 public:
  explicit KeptMemory(std::size_t bytes) noexcept {
    release_working_memory();
    keep_working_memory(bytes);
  }
  ~KeptMemory() {
    release_working_memory();
    keep_working_memory(kDefault);
  }
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;

 private:
#if defined(__SANITIZE_ADDRESS__)
  static constexpr std::size_t kDefault = 0;
#else
  static constexpr std::size_t kDefault = std::size_t{128} << 20U;
#endif
};

/// Whether allocations by malloc are seen as those by operator new are: malloc cannot be replaced on Windows.
#if defined(_WIN32)
inline constexpr bool kSeesMalloc = false;
#else
inline constexpr bool kSeesMalloc = true;
#endif

/// Allocations inside tiles since the last `forget_allocations_in_tiles()`, on all threads, by operator new or malloc.
/// 0 under sanitizers, which replace the heap.
[[nodiscard]] long allocations_in_tiles() noexcept;
void forget_allocations_in_tiles() noexcept;

/// The threads whose allocations count.
enum class Heap {
  this_thread,
  other_threads,  ///< all threads but this one
};

/// While it lives, the number-th (from 1) operator new of those threads fails with std::bad_alloc; if `for_good`, all
/// later ones too. At most one in the program at a time.
class FailingHeap {
 public:
  FailingHeap(Heap heap, long number, bool for_good) noexcept;
  ~FailingHeap();
  FailingHeap(const FailingHeap&) = delete;
  FailingHeap& operator=(const FailingHeap&) = delete;

  /// Whether an allocation failed.
  [[nodiscard]] bool failed() const noexcept;

 private:
  KeptMemory kept_{0};  ///< all memory comes from the heap
  long number_;
};

/// While it lives, measures how much more memory the program has from malloc than before, on all threads. At most one
/// at a time.
class HeapWatch {
 public:
  HeapWatch() noexcept;
  ~HeapWatch();
  HeapWatch(const HeapWatch&) = delete;
  HeapWatch& operator=(const HeapWatch&) = delete;

  /// The peak so far, bytes. 0 under sanitizers, which replace the heap.
  [[nodiscard]] long peak_bytes() const noexcept;

 private:
  KeptMemory kept_{0};  ///< all memory comes from the heap
};

/// While it lives, watches the blocks that this thread gets from malloc, and counts those that other threads free. At
/// most one at a time. A block may be missed if another takes its slot in the table of watched blocks; blocks of other
/// threads are never counted. 0 under sanitizers, which replace the heap.
class ForeignFrees {
 public:
  ForeignFrees() noexcept;
  ~ForeignFrees();
  ForeignFrees(const ForeignFrees&) = delete;
  ForeignFrees& operator=(const ForeignFrees&) = delete;

  [[nodiscard]] long count() const noexcept;
};

}  // namespace welkin::test

// The interface between these counters and the system heap's functions that they count.
namespace welkin::test::heap {

/// Whether this operator new is the one that must fail.
[[nodiscard]] bool must_fail() noexcept;

/// Counts an allocation.
void count() noexcept;

/// Records a block that was allocated or is about to be freed; `usable_size` returns a block's size in bytes.
void* given(void* block, std::size_t (*usable_size)(void*)) noexcept;
void taken(void* block, std::size_t (*usable_size)(void*)) noexcept;

}  // namespace welkin::test::heap
