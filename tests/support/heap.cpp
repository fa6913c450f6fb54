#include "support/heap.h"

#include <dlfcn.h>
#include <malloc.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "jobs/tiles.h"

namespace {

std::atomic<long> allocated_in_tiles{0};

enum class Failing { nowhere, this_thread, other_threads };
std::atomic<Failing> failing{Failing::nowhere};
std::atomic<bool> fails_for_good{false};
std::atomic<long> failing_number{0};
std::atomic<long> allocations{0};
thread_local bool asked_for_failures = false;

[[maybe_unused]] std::atomic<bool> watching{false};
std::atomic<long> held_bytes{0};
std::atomic<long> most_bytes{0};

[[maybe_unused]] thread_local bool blocks_are_watched = false;  ///< those that this thread gets
std::array<std::atomic<void*>, 16384> watched_blocks;
std::atomic<long> foreign_frees{0};

[[maybe_unused]] std::atomic<void*>& watched_place(void* block) noexcept {
  return watched_blocks[reinterpret_cast<std::uintptr_t>(block) / 16 % watched_blocks.size()];
}

bool must_fail() noexcept {
  const Failing where = failing.load(std::memory_order_acquire);
  if (where == Failing::nowhere || asked_for_failures != (where == Failing::this_thread)) return false;
  const long number = allocations.fetch_add(1, std::memory_order_relaxed) + 1;
  const long first = failing_number.load(std::memory_order_relaxed);
  return number == first || (number > first && fails_for_good.load(std::memory_order_relaxed));
}

}  // namespace

namespace welkin::test {

long allocations_in_tiles() noexcept { return allocated_in_tiles; }
void forget_allocations_in_tiles() noexcept { allocated_in_tiles = 0; }

FailingHeap::FailingHeap(Heap heap, long number, bool for_good) noexcept : number_(number) {
  asked_for_failures = true;
  allocations = 0;
  failing_number = number;
  fails_for_good = for_good;
  failing.store(heap == Heap::this_thread ? Failing::this_thread : Failing::other_threads, std::memory_order_release);
}

FailingHeap::~FailingHeap() {
  failing = Failing::nowhere;
  asked_for_failures = false;
}

bool FailingHeap::failed() const noexcept { return allocations >= number_; }

HeapWatch::HeapWatch() noexcept {
  held_bytes = 0;
  most_bytes = 0;
  watching = true;
}

HeapWatch::~HeapWatch() { watching = false; }

long HeapWatch::peak_bytes() const noexcept { return most_bytes; }

ForeignFrees::ForeignFrees() noexcept {
  foreign_frees = 0;
  blocks_are_watched = true;
}

ForeignFrees::~ForeignFrees() {
  blocks_are_watched = false;
  for (std::atomic<void*>& block : watched_blocks) block = nullptr;
}

long ForeignFrees::count() const noexcept { return foreign_frees; }

}  // namespace welkin::test

// The program's operators new take the place of the library's for every library in the process. What they do not refuse
// goes on to the next ones, the standard library's or a sanitizer's, whose operators delete are still in place.
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
// With clang the sanitizer is part of the program, and what comes next after the operators above is libstdc++'s, which
// take from malloc what the sanitizer's operator delete is given.
extern "C" const char* __asan_default_options() { return "alloc_dealloc_mismatch=0"; }  // NOLINT: a name it looks for
#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// The same with malloc; glibc's own names still lead to the real one. libstdc++'s operator new comes through here too.
namespace {
void count() noexcept {
  if (welkin::jobs::inside_tile()) allocated_in_tiles.fetch_add(1, std::memory_order_relaxed);
}

void* given(void* block) noexcept {
  if (block != nullptr && blocks_are_watched) watched_place(block) = block;
  if (block == nullptr || !watching.load(std::memory_order_relaxed)) return block;
  const auto bytes = static_cast<long>(malloc_usable_size(block));
  const long held = held_bytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  long most = most_bytes.load(std::memory_order_relaxed);
  while (held > most && !most_bytes.compare_exchange_weak(most, held, std::memory_order_relaxed)) {
  }
  return block;
}

void taken(void* block) noexcept {
  void* watched = block;
  const bool was_watched = block != nullptr && watched_place(block).compare_exchange_strong(watched, nullptr);
  if (was_watched && !blocks_are_watched) ++foreign_frees;
  if (block == nullptr || !watching.load(std::memory_order_relaxed)) return;
  held_bytes.fetch_sub(static_cast<long>(malloc_usable_size(block)), std::memory_order_relaxed);
}
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
