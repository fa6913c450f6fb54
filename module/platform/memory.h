// Fewer page faults for large memory.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

#include "platform/working_memory.h"

namespace welkin::platform {

/// Asks the system to back large memory that is about to be filled by large pages: with pages of 4 KB the first touch
/// of a bake's results costs more than filling them. Does nothing below 2 MiB, or where the system has no such call;
/// the contents stay as they are.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;

// Memory for kernels.

/// `size` values that start on a cache line, so that kernels may use aligned loads; not initialised. Large buffers come
/// from working memory that is kept between calls.
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

/// For vectors that grow or are filled in turn and are large in every call: their memory, too, is kept between calls. A
/// cache line before the values says which block they lie in.
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
