// The counted heap functions on Windows, where a DLL's malloc cannot be replaced: the operators new and delete of the
// program and of the code linked into it. Blocks of greater alignment are not watched.
#include <malloc.h>

#include "support/catch.h"
#include "support/heap.h"

using welkin::test::heap::count, welkin::test::heap::must_fail;

namespace {

void* made(std::size_t size) {
  count();
  void* const block = must_fail() ? nullptr : std::malloc(size == 0 ? 1 : size);
  if (block == nullptr) throw std::bad_alloc();
  return welkin::test::heap::given(block, _msize);
}

void* made(std::size_t size, std::align_val_t alignment) {
  count();
  void* const block =
      must_fail() ? nullptr : _aligned_malloc(size == 0 ? 1 : size, static_cast<std::size_t>(alignment));
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

void unmade(void* block) noexcept {
  welkin::test::heap::taken(block, _msize);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t size) { return made(size); }
void* operator new[](std::size_t size) { return made(size); }
void* operator new(std::size_t size, std::align_val_t alignment) { return made(size, alignment); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return made(size, alignment); }
void operator delete(void* block) noexcept { unmade(block); }
void operator delete[](void* block) noexcept { unmade(block); }
void operator delete(void* block, std::size_t /*size*/) noexcept { unmade(block); }
void operator delete[](void* block, std::size_t /*size*/) noexcept { unmade(block); }
void operator delete(void* block, std::align_val_t /*alignment*/) noexcept { _aligned_free(block); }
void operator delete[](void* block, std::align_val_t /*alignment*/) noexcept { _aligned_free(block); }
void operator delete(void* block, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  _aligned_free(block);
}
void operator delete[](void* block, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  _aligned_free(block);
}
