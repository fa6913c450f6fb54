// Memory for large work: fewer page faults, blocks that are kept between calls, and buffers made of them.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace welkin::platform {

/// Advises the system to back large memory that is about to be filled by large pages: with pages of 4 KB the first
/// touch of a bake's results costs more than filling them. Does nothing below 2 MiB, or where the system has no such
/// call; the contents are unchanged.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;

// Large blocks of working memory that stay with the process between calls, so that pages are cleared once and not in
// every call. The public functions are `keep_working_memory` and `release_working_memory` (welkin/core.h).

/// A block of memory. `bytes` may exceed the requested size.
struct WorkingMemory {
  void* data = nullptr;
  std::size_t bytes = 0;
  std::size_t alignment = 0;
  int page = -1;  ///< index in `shared_pages`; below 0: not in a shared page
};

inline constexpr std::size_t kCacheLine = 64;
#ifdef __linux__
inline constexpr std::size_t kHugePage = std::size_t{2} << 20U;  // of x86-64, and of ARM with pages of 4 KiB
#else
inline constexpr std::size_t kHugePage = kCacheLine;  // no call requests large pages
#endif
/// Smaller blocks come from the heap and return to it: malloc keeps them for reuse.
inline constexpr std::size_t kMinKeptBlock = std::size_t{64} << 10U;
/// Smaller blocks share huge pages.
inline constexpr std::size_t kMinOwnBlock = std::size_t{1} << 20U;

/// Returns at least `bytes` uninitialized bytes that start on a cache line: a kept block of at most twice the size, or
/// a new one. Throws std::bad_alloc.
[[nodiscard]] WorkingMemory take_working_memory(std::size_t bytes);

/// Takes back a block that `take_working_memory` returned: keeps it for later calls, or frees it.
void give_working_memory(const WorkingMemory& block) noexcept;

/// Returns the bytes of all blocks that are kept and not in use.
[[nodiscard]] std::size_t kept_working_memory() noexcept;

/// Fills every block that is taken from now on with this byte; -1 fills none. For tests that detect reads of memory
/// that was never written.
void fill_taken_memory(int byte) noexcept;

// Memory for kernels.

/// A buffer of `size` uninitialized values that starts on a cache line, so that kernels may use aligned loads. Large
/// buffers come from working memory that is kept between calls.
template <class Value>
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::size_t size) : AlignedBuffer(take_working_memory(size * sizeof(Value)), size) {}

  [[nodiscard]] Value* data() noexcept { return values_.get(); }
  [[nodiscard]] const Value* data() const noexcept { return values_.get(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return size_ * sizeof(Value); }

 private:
  struct Free {
    void operator()(Value* /*values*/) const noexcept { give_working_memory(block); }

    WorkingMemory block;
  };

  AlignedBuffer(const WorkingMemory& block, std::size_t size)
      : values_(static_cast<Value*>(block.data), Free{block}), size_(size) {}

  std::unique_ptr<Value, Free> values_;
  std::size_t size_ = 0;
};

/// An allocator for vectors that grow or are filled in turn and are large in every call: their memory, too, is kept
/// between calls. A cache line before the values records their block.
template <class Value>
class WorkingAllocator {
 public:
  using value_type = Value;

  WorkingAllocator() = default;
  template <class Other>
  explicit WorkingAllocator(const WorkingAllocator<Other>& /*other*/) noexcept {}

  [[nodiscard]] Value* allocate(std::size_t size) {
    const WorkingMemory block = take_working_memory(kCacheLine + size * sizeof(Value));
    ::new (block.data) WorkingMemory(block);
    return reinterpret_cast<Value*>(static_cast<std::byte*>(block.data) + kCacheLine);
  }
  void deallocate(Value* values, std::size_t /*size*/) noexcept {
    const WorkingMemory block = *reinterpret_cast<WorkingMemory*>(reinterpret_cast<std::byte*>(values) - kCacheLine);
    give_working_memory(block);
  }
  bool operator==(const WorkingAllocator& /*other*/) const noexcept { return true; }
};
static_assert(sizeof(WorkingMemory) <= kCacheLine);

}  // namespace welkin::platform
