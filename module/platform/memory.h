// Fewer page faults for large memory.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace welkin::platform {

/// Asks the system to back large memory that is about to be filled by large pages: with pages of 4 KB the first touch
/// of a bake's results costs more than filling them. Does nothing below 4 MB, or where the system has no such call;
/// the contents stay as they are.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;

// Memory for kernels.

/// `size` values that start on a cache line, so that kernels may use aligned loads; not initialised.
template <class Value>
class AlignedBuffer {
 public:
  static constexpr std::size_t kAlignment = 64;

  AlignedBuffer() = default;
  explicit AlignedBuffer(std::size_t size)
      : values_(static_cast<Value*>(::operator new (size * sizeof(Value), std::align_val_t{kAlignment}))), size_(size) {
    advise_huge_pages(values_.get(), bytes());
  }

  [[nodiscard]] Value* data() noexcept { return values_.get(); }
  [[nodiscard]] const Value* data() const noexcept { return values_.get(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return size_ * sizeof(Value); }

 private:
  struct Free {
    void operator()(Value* values) const noexcept { ::operator delete (values, std::align_val_t{kAlignment}); }
  };

  std::unique_ptr<Value, Free> values_;
  std::size_t size_ = 0;
};

}  // namespace welkin::platform
