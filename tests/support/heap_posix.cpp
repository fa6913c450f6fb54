// The counted heap functions on systems whose malloc a program may replace.
#include <dlfcn.h>
#include <malloc.h>

#include "support/catch.h"
#include "support/heap.h"

using welkin::test::heap::count, welkin::test::heap::must_fail;

// The program's operators new replace the library's for every library in the process. Requests that they do not refuse
// go on to the next ones, the standard library's or a sanitizer's, whose operators delete are still in place.
void* operator new(std::size_t size) {
  static const auto next = reinterpret_cast<void* (*)(std::size_t)>(dlsym(RTLD_NEXT, "_Znwm"));
  if (must_fail()) throw std::bad_alloc();
  return next(size);
}

void* operator new[](std::size_t size) {
  static const auto next = reinterpret_cast<void* (*)(std::size_t)>(dlsym(RTLD_NEXT, "_Znam"));
  if (must_fail()) throw std::bad_alloc();
  return next(size);
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  static const auto next =
      reinterpret_cast<void* (*)(std::size_t, std::align_val_t)>(dlsym(RTLD_NEXT, "_ZnwmSt11align_val_t"));
  if (must_fail()) throw std::bad_alloc();
  return next(size, alignment);
}

void* operator new[](std::size_t size, std::align_val_t alignment) {
  static const auto next =
      reinterpret_cast<void* (*)(std::size_t, std::align_val_t)>(dlsym(RTLD_NEXT, "_ZnamSt11align_val_t"));
  if (must_fail()) throw std::bad_alloc();
  return next(size, alignment);
}

#if defined(__SANITIZE_ADDRESS__) && defined(__clang__)
// With clang the sanitizer is part of the program, and the operators that follow the ones above are libstdc++'s. They
// take memory from malloc that is then passed to the sanitizer's operator delete.
extern "C" const char* __asan_default_options() { return "alloc_dealloc_mismatch=0"; }  // NOLINT: a name it looks for
#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// Replaces malloc, too; glibc's __libc_ names still reach the original. libstdc++'s operator new comes through here.
namespace {
void* given(void* block) noexcept { return welkin::test::heap::given(block, malloc_usable_size); }
void taken(void* block) noexcept { welkin::test::heap::taken(block, malloc_usable_size); }
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) noexcept {
  count();
  return given(__libc_malloc(size));
}
void* calloc(std::size_t number, std::size_t size) noexcept {
  count();
  return given(__libc_calloc(number, size));
}
void* realloc(void* old, std::size_t size) noexcept {
  count();
  taken(old);
  return given(__libc_realloc(old, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count();
  return given(__libc_memalign(alignment, size));
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count();
  return given(__libc_memalign(alignment, size));
}
int posix_memalign(void** to, std::size_t alignment, std::size_t size) noexcept {
  constexpr int out_of_memory = 12;  // ENOMEM
  count();
  *to = given(__libc_memalign(alignment, size));
  return *to == nullptr ? out_of_memory : 0;
}
void free(void* block) noexcept {
  taken(block);
  __libc_free(block);
}
}

#endif
