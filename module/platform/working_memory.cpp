#include "platform/working_memory.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>

#include "platform/compiler.h"
#include "platform/memory.h"
#include "platform/shared_pages.h"
#include "platform/wait.h"
#include "welkin/core.h"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace welkin::platform {

void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::size_t least = std::size_t{2} << 20U;
  if (memory == nullptr || bytes < least) return;
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));  // 4 KiB; on ARM also 16 or 64
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (address + page - 1) / page * page;  // madvise takes whole pages only
  const std::uintptr_t last = (address + bytes) / page * page;
  // It is advice: where it is refused, small pages do.
  static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE));
#endif
}

namespace {

constexpr std::size_t kMaxBlocks = 256;

/// Address sanitizers find uses of memory that was freed, and memory of WebAssembly is never returned to its host: both
/// leave blocks to the heap.
#if WELKIN_ADDRESS_SANITIZER || defined(__wasm__)
constexpr std::size_t kDefaultLimit = 0;
#else
constexpr std::size_t kDefaultLimit = std::size_t{128} << 20U;
#endif

/// Bytes to allocate for a request: sizes are few, so that a block serves requests that differ little, and at most an
/// eighth is lost, or a part of the last huge page.
std::size_t rounded_up(std::size_t bytes) noexcept {
  std::size_t step = std::max(kMinOwnBlock / 8, kHugePage);
  while (step <= bytes / 16) step *= 2;
  return (bytes + step - 1) / step * step;
}

WorkingMemory allocate(std::size_t bytes, std::size_t alignment) {
  void* const data = ::operator new (bytes, std::align_val_t{alignment});
  advise_huge_pages(data, bytes);
  return {.data = data, .bytes = bytes, .alignment = alignment};
}

void free_block(const WorkingMemory& block) noexcept {
  ::operator delete (block.data, std::align_val_t{block.alignment});
}

/// Blocks that nobody uses. No call waits for its lock: where another thread has it, or had it when this process was
/// forked, blocks come from the heap and return to it.
class Pool {
 public:
  [[nodiscard]] std::size_t limit() const noexcept { return limit_.load(std::memory_order_relaxed); }
  /// Counts all that is kept, in shared pages too.
  [[nodiscard]] std::size_t bytes() const noexcept {
    return bytes_.load(std::memory_order_relaxed) + shared_pages::unused_bytes();
  }

  void set_limit(std::size_t limit) noexcept {
    limit_.store(limit, std::memory_order_relaxed);
    shrink_to(limit);
  }

  /// The smallest block that serves, the newest of those; none: a null pointer.
  [[nodiscard]] WorkingMemory take(std::size_t bytes) noexcept {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return {};
    std::size_t best = count_;
    for (std::size_t k = 0; k < count_; ++k) {
      const std::size_t size = blocks_[k].bytes;
      if (size >= bytes && size / 2 <= bytes && (best == count_ || size <= blocks_[best].bytes)) best = k;
    }
    return best == count_ ? WorkingMemory{} : remove(best);
  }

  /// Keeps a block in place of the oldest ones, or frees it.
  void give(const WorkingMemory& block) noexcept {
    for (bool done = false; !done;) {
      WorkingMemory goes = block;
      {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        done = !lock || block.bytes > limit();
        if (!done && count_ < kMaxBlocks && block.bytes <= limit() - std::min(limit(), bytes())) {
          blocks_[count_++] = block;
          bytes_ += block.bytes;
          return;
        }
        if (!done && count_ == 0) {  // shared pages leave no room
          done = !shared_pages::free_one();
          if (!done) continue;
        } else if (!done) {
          goes = remove(0);
        }
      }
      free_block(goes);
    }
  }

  /// Frees the oldest blocks, and then shared pages, until at most `bytes` are kept. Returns whether any was freed. It
  /// looks again for a while where another thread has the lock, which that holds for as long as a list of 256 numbers
  /// takes.
  bool shrink_to(std::size_t bytes) noexcept {
    constexpr int kLooks = 1000;
    bool freed = false;
    for (int look = 0; look<kLooks&& this->bytes()> bytes; ++look) {
      WorkingMemory oldest;
      if (const std::unique_lock lock(mutex_, std::try_to_lock); lock) {
        if (count_ == 0) {
          if (!shared_pages::free_one()) break;
          freed = true;
          continue;
        }
        oldest = remove(0);
      }
      if (oldest.data == nullptr) {
        detail::pause_processor();
        continue;
      }
      free_block(oldest);
      freed = true;
      look = 0;
    }
    return freed;
  }

 private:
  WorkingMemory remove(std::size_t index) noexcept {
    const WorkingMemory block = blocks_[index];
    std::move(blocks_.begin() + static_cast<std::ptrdiff_t>(index) + 1,
              blocks_.begin() + static_cast<std::ptrdiff_t>(count_),
              blocks_.begin() + static_cast<std::ptrdiff_t>(index));
    --count_;
    bytes_ -= block.bytes;
    return block;
  }

  std::mutex mutex_;
  std::array<WorkingMemory, kMaxBlocks> blocks_{};  ///< the oldest first
  std::size_t count_ = 0;
  std::atomic<std::size_t> bytes_{0};  ///< of all blocks
  std::atomic<std::size_t> limit_{kDefaultLimit};
};

Pool& pool() {
  static auto& blocks = *new Pool;  // never destroyed: threads may compute while the program exits
  return blocks;
}

std::atomic<int> filling{-1};

WorkingMemory take_block(std::size_t bytes) {
  if (bytes < kMinKeptBlock || bytes > std::numeric_limits<std::size_t>::max() / 2 || pool().limit() == 0)
    return allocate(bytes, kCacheLine);
  if (bytes < kMinOwnBlock) {
    const WorkingMemory part = shared_pages::take(bytes);
    return part.data != nullptr ? part : allocate(bytes, kCacheLine);
  }
  const std::size_t whole = rounded_up(bytes);
  const WorkingMemory kept = pool().take(whole);
  return kept.data != nullptr ? kept : allocate(whole, kHugePage);
}

}  // namespace

WorkingMemory take_working_memory(std::size_t bytes) {
  const WorkingMemory block = [bytes] {
    try {
      return take_block(bytes);
    } catch (const std::bad_alloc&) {
      if (!pool().shrink_to(0)) throw;
      return take_block(bytes);
    }
  }();
  if (const int byte = filling.load(std::memory_order_relaxed); byte >= 0) std::memset(block.data, byte, block.bytes);
  return block;
}

void give_working_memory(const WorkingMemory& block) noexcept {
  if (block.page >= 0) {
    if (shared_pages::give(block)) pool().shrink_to(pool().limit());
  } else if (block.bytes < kMinOwnBlock) {
    free_block(block);
  } else {
    pool().give(block);
  }
}

std::size_t kept_working_memory() noexcept { return pool().bytes(); }

void fill_taken_memory(int byte) noexcept { filling.store(byte, std::memory_order_relaxed); }

}  // namespace welkin::platform

namespace welkin {

void keep_working_memory(std::size_t bytes) noexcept { platform::pool().set_limit(bytes); }

void release_working_memory() noexcept { platform::pool().shrink_to(0); }

}  // namespace welkin
