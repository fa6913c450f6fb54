// Memory of jobs.
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <new>
#include <utility>

#include "platform/compiler.h"
#include "worker/scheduler.h"

namespace welkin::detail {
namespace {

constexpr std::size_t kSmallestBlock = 64;
constexpr std::size_t kLargestBlock = WELKIN_ADDRESS_SANITIZER ? 0 : 4096;

struct FreeBlock {
  FreeBlock* next;
};

/// A stack of blocks of one size that are not in use. No thread waits for another here: a thread that takes a block
/// takes the whole stack and puts the rest back. A thread that finds it empty meanwhile allocates from the system.
class FreeBlocks {
 public:
  void* take() noexcept {
    FreeBlock* const first = top_.exchange(nullptr, std::memory_order_acquire);
    if (first == nullptr) return nullptr;
    kept_.fetch_sub(1, std::memory_order_relaxed);
    FreeBlock* rest = first->next;
    FreeBlock* surplus = nullptr;  // of takers that met each other, and each made a block
    if (rest != nullptr && kept_.load(std::memory_order_relaxed) > kMaxKept) {
      surplus = std::exchange(rest, rest->next);
      kept_.fetch_sub(1, std::memory_order_relaxed);
    }
    if (rest != nullptr) put_back(rest);
    ::operator delete(surplus);
    return first;
  }

  void put(FreeBlock* block) noexcept {
    kept_.fetch_add(1, std::memory_order_relaxed);
    block->next = top_.load(std::memory_order_relaxed);
    while (!top_.compare_exchange_weak(block->next, block, std::memory_order_release, std::memory_order_relaxed)) {
    }
  }

  void give_back() noexcept {
    FreeBlock* block = top_.exchange(nullptr, std::memory_order_acquire);
    while (block != nullptr) {
      ::operator delete(std::exchange(block, block->next));
      kept_.fetch_sub(1, std::memory_order_relaxed);
    }
  }

 private:
  /// Twice as many as the jobs that a worker takes by default. What is above goes back to the system, block by block,
  /// where one is taken: by threads that post, so that a worker's thread does not free what they allocated.
  static constexpr std::ptrdiff_t kMaxKept = 8192;

  /// All the stack, which others have found empty since. What they have put there goes on top, as it is the shorter
  /// list.
  void put_back(FreeBlock* rest) noexcept {
    for (FreeBlock* none = nullptr; !top_.compare_exchange_strong(none, rest); none = nullptr) {
      FreeBlock* const newer = top_.exchange(nullptr);
      if (newer == nullptr) continue;
      FreeBlock* last = newer;
      while (last->next != nullptr) last = last->next;
      last->next = std::exchange(rest, newer);
    }
  }

  std::atomic<FreeBlock*> top_{nullptr};
  std::atomic<std::ptrdiff_t> kept_{0};  ///< in the stack, and below that while blocks are on their way
};

constexpr std::size_t size_class(std::size_t bytes) {
  return bytes <= kSmallestBlock ? 0 : std::bit_width((bytes - 1) / kSmallestBlock);
}

constinit std::array<FreeBlocks, size_class(kLargestBlock) + 1> free_blocks;  ///< of 64 bytes, of 128, and so on

}  // namespace

void* allocate_job_memory(std::size_t bytes) {
  if (bytes > kLargestBlock) return ::operator new(bytes);
  const std::size_t index = size_class(bytes);
  void* const block = free_blocks[index].take();
  return block != nullptr ? block : ::operator new(kSmallestBlock << index);
}

void free_job_memory(void* block, std::size_t bytes) noexcept {
  if (bytes > kLargestBlock) return ::operator delete(block);
  free_blocks[size_class(bytes)].put(::new (block) FreeBlock{nullptr});
}

void give_back_job_memory() noexcept {
  for (FreeBlocks& blocks : free_blocks) blocks.give_back();
}

}  // namespace welkin::detail
