#include "support/heap.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "jobs/tiles.h"

namespace {

std::atomic<long> allocated_in_tiles{0};

enum class Failing { nowhere, this_thread, other_threads };
std::atomic<Failing> failing{Failing::nowhere};
std::atomic<bool> fails_for_good{false};
std::atomic<long> failing_number{0};
std::atomic<long> allocations{0};
thread_local bool asked_for_failures = false;

std::atomic<bool> watching{false};
std::atomic<long> held_bytes{0};
std::atomic<long> most_bytes{0};

thread_local bool blocks_are_watched = false;  ///< blocks that this thread gets
std::array<std::atomic<void*>, 16384> watched_blocks;
std::atomic<long> foreign_frees{0};

std::atomic<void*>& watched_place(void* block) noexcept {
  return watched_blocks[reinterpret_cast<std::uintptr_t>(block) / 16 % watched_blocks.size()];
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

namespace welkin::test::heap {

bool must_fail() noexcept {
  const Failing where = failing.load(std::memory_order_acquire);
  if (where == Failing::nowhere || asked_for_failures != (where == Failing::this_thread)) return false;
  const long number = allocations.fetch_add(1, std::memory_order_relaxed) + 1;
  const long first = failing_number.load(std::memory_order_relaxed);
  return number == first || (number > first && fails_for_good.load(std::memory_order_relaxed));
}

void count() noexcept {
  if (jobs::inside_tile()) allocated_in_tiles.fetch_add(1, std::memory_order_relaxed);
}

void* given(void* block, std::size_t (*usable_size)(void*)) noexcept {
  if (block != nullptr && blocks_are_watched) watched_place(block) = block;
  if (block == nullptr || !watching.load(std::memory_order_relaxed)) return block;
  const auto bytes = static_cast<long>(usable_size(block));
  const long held = held_bytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  long most = most_bytes.load(std::memory_order_relaxed);
  while (held > most && !most_bytes.compare_exchange_weak(most, held, std::memory_order_relaxed)) {
  }
  return block;
}

void taken(void* block, std::size_t (*usable_size)(void*)) noexcept {
  void* watched = block;
  const bool was_watched = block != nullptr && watched_place(block).compare_exchange_strong(watched, nullptr);
  if (was_watched && !blocks_are_watched) ++foreign_frees;
  if (block == nullptr || !watching.load(std::memory_order_relaxed)) return;
  held_bytes.fetch_sub(static_cast<long>(usable_size(block)), std::memory_order_relaxed);
}

}  // namespace welkin::test::heap
