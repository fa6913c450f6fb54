// Memory for kernels.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

#include "tables/huge_pages.h"

namespace welkin::tables {

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

}  // namespace welkin::tables
