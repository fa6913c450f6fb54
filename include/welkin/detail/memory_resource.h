// Memory that a caller lends, in the words of <memory_resource>, for standard libraries without that header.
#pragma once

#include <cstddef>
#include <new>

namespace welkin::detail::standard {

/// As std::pmr::memory_resource.
class memory_resource {
 public:
  memory_resource() = default;
  memory_resource(const memory_resource&) = default;
  memory_resource& operator=(const memory_resource&) = default;
  virtual ~memory_resource() = default;

  [[nodiscard]] void* allocate(std::size_t bytes, std::size_t alignment = alignof(std::max_align_t)) {
    return do_allocate(bytes, alignment);
  }
  void deallocate(void* block, std::size_t bytes, std::size_t alignment = alignof(std::max_align_t)) {
    do_deallocate(block, bytes, alignment);
  }
  [[nodiscard]] bool is_equal(const memory_resource& other) const noexcept { return do_is_equal(other); }

 private:
  virtual void* do_allocate(std::size_t bytes, std::size_t alignment) = 0;
  virtual void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) = 0;
  [[nodiscard]] virtual bool do_is_equal(const memory_resource& other) const noexcept = 0;
};

inline bool operator==(const memory_resource& a, const memory_resource& b) noexcept {
  return &a == &b || a.is_equal(b);
}

/// The heap.
class HeapResource final : public memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    return ::operator new (bytes, std::align_val_t{alignment});
  }
  void do_deallocate(void* block, std::size_t /*bytes*/, std::size_t alignment) override {
    ::operator delete (block, std::align_val_t{alignment});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

[[nodiscard]] inline memory_resource* new_delete_resource() noexcept {
  // Never destroyed: global objects may give memory back after it would be gone.
  // NOLINTNEXTLINE(bugprone-unhandled-exception-at-new): without memory at the start there is nothing to go on with
  static auto& heap = *new HeapResource;
  return &heap;
}

/// The heap: there is no other default.
[[nodiscard]] inline memory_resource* get_default_resource() noexcept { return new_delete_resource(); }

}  // namespace welkin::detail::standard
