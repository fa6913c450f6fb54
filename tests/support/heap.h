// Looking at the heap, making it fail, and how much working memory the process keeps.
#pragma once

#include <cstddef>

#include "welkin/core.h"

namespace welkin::test {

/// While it lives, `bytes` of working memory are kept: none of it is left from before, and none afterwards.
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

/// Whether allocations by malloc are seen as those by operator new are: it cannot be replaced in Windows.
#if defined(_WIN32)
inline constexpr bool kSeesMalloc = false;
#else
inline constexpr bool kSeesMalloc = true;
#endif

/// Allocations inside tiles since the last `forget_allocations_in_tiles()`, on all threads, by operator new or malloc.
/// Sanitizers bring a heap of their own: 0 under them.
[[nodiscard]] long allocations_in_tiles() noexcept;
void forget_allocations_in_tiles() noexcept;

/// Whose allocations.
enum class Heap {
  this_thread,
  other_threads,  ///< all but this one's
};

/// While it lives, the number-th (from 1) operator new of those fails with std::bad_alloc; if `for_good`, all later
/// ones too. One at a time in the program.
class FailingHeap {
 public:
  FailingHeap(Heap heap, long number, bool for_good) noexcept;
  ~FailingHeap();
  FailingHeap(const FailingHeap&) = delete;
  FailingHeap& operator=(const FailingHeap&) = delete;

  /// Whether it came to that.
  [[nodiscard]] bool failed() const noexcept;

 private:
  KeptMemory kept_{0};  ///< all memory is the heap's
  long number_;
};

/// While it lives, watches how much the program has from malloc beyond what it had before, on all threads. One at a
/// time.
class HeapWatch {
 public:
  HeapWatch() noexcept;
  ~HeapWatch();
  HeapWatch(const HeapWatch&) = delete;
  HeapWatch& operator=(const HeapWatch&) = delete;

  /// The most so far, bytes. Sanitizers bring a heap of their own: 0 under them.
  [[nodiscard]] long peak_bytes() const noexcept;

 private:
  KeptMemory kept_{0};  ///< all memory is the heap's
};

/// While it lives, watches blocks that this thread gets from malloc meanwhile, and counts those of them that other
/// threads free. One at a time. A block may be missed if another one takes its place in the table of those that are
/// watched; none is counted that this thread did not get. Sanitizers bring a heap of their own: 0 under them.
class ForeignFrees {
 public:
  ForeignFrees() noexcept;
  ~ForeignFrees();
  ForeignFrees(const ForeignFrees&) = delete;
  ForeignFrees& operator=(const ForeignFrees&) = delete;

  [[nodiscard]] long count() const noexcept;
};

}  // namespace welkin::test

// Between these counters and the functions of a system's heap that they count.
namespace welkin::test::heap {

/// Whether this operator new is the one that is to fail.
[[nodiscard]] bool must_fail() noexcept;

/// An allocation.
void count() noexcept;

/// A block that was given, or is about to be taken back; `usable_size`: how many bytes a block has.
void* given(void* block, std::size_t (*usable_size)(void*)) noexcept;
void taken(void* block, std::size_t (*usable_size)(void*)) noexcept;

}  // namespace welkin::test::heap
