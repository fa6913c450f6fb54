#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>

#include "platform/compiler.h"
#include "platform/memory.h"
#include "platform/wait.h"
#include "welkin/core.h"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace welkin::platform {

void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::size_t minimum = std::size_t{2} << 20U;
  if (memory == nullptr || bytes < minimum) return;
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));  // 4 KiB; on ARM also 16 or 64
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (address + page - 1) / page * page;  // madvise takes whole pages only
  const std::uintptr_t last = (address + bytes) / page * page;
  // A hint only: where it is refused, small pages are used.
  static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE));
#endif
}

namespace {

// Blocks below 1 MiB, cut from huge pages that several of them share.
//
// The first touch of a huge page takes as long as that of 25 to 50 small ones (84 us against 1.7 to 3.4 us, on a
// virtual machine with a Zen 5), and the small buffers of a first call span more than a thousand small pages.
namespace shared_pages {

constexpr std::size_t kBytes = std::size_t{2} << 20U;  ///< of a page
constexpr std::size_t kMaxPages = 64;                  ///< including those in use

constexpr std::size_t kUnit = kBytes / 64;
constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::align_val_t kAlignment{kHugePage};

/// A page in 64 units. The thread that clears bits of `free` owns these units; one that clears all of them owns the
/// page.
struct Page {
  std::atomic<std::uint64_t> free{0};  ///< one bit per unit; 0 without memory
  std::atomic<bool> taken{false};      ///< has memory, or is about to
  char* data = nullptr;
};

std::array<Page, kMaxPages>& pages() {
  static auto& all = *new std::array<Page, kMaxPages>;  // never destroyed: threads may compute while the program exits
  return all;
}

/// Returns the bits of the lowest run of that many free units; 0 if there is none.
std::uint64_t run_of(std::uint64_t free, unsigned units) noexcept {
  for (unsigned length = 1; length < units;) {  // a bit stays set where a run of `length` starts
    const unsigned more = std::min(length, units - length);
    free &= free >> more;
    length += more;
  }
  return free == 0 ? 0 : (kAll >> (64 - units)) << static_cast<unsigned>(std::countr_zero(free));
}

WorkingMemory block_of(std::size_t index, std::uint64_t run) noexcept {
  const auto first = static_cast<std::size_t>(std::countr_zero(run));
  const auto units = static_cast<std::size_t>(std::popcount(run));
  return {.data = pages()[index].data + first * kUnit,
          .bytes = units * kUnit,
          .alignment = kUnit,
          .page = static_cast<int>(index)};
}

/// Returns a block of at least `bytes` bytes, at most half a page, from a page with enough free units or from a new
/// one. Its data is null where there are `kMaxPages` pages already or there is no memory for one more. Takes no lock.
WorkingMemory take(std::size_t bytes) noexcept {
  const auto units = static_cast<unsigned>((bytes + kUnit - 1) / kUnit);
  for (std::size_t index = 0; index < kMaxPages; ++index) {
    std::atomic<std::uint64_t>& free = pages()[index].free;
    std::uint64_t now = free.load(std::memory_order_relaxed);
    for (std::uint64_t run = run_of(now, units); run != 0; run = run_of(now, units)) {
      if (free.compare_exchange_weak(now, now & ~run, std::memory_order_acquire)) return block_of(index, run);
    }
  }
  for (std::size_t index = 0; index < kMaxPages; ++index) {
    Page& page = pages()[index];
    if (page.taken.exchange(true, std::memory_order_acquire)) continue;
    page.data = static_cast<char*>(::operator new(kBytes, kAlignment, std::nothrow));
    if (page.data == nullptr) {
      page.taken.store(false, std::memory_order_release);
      return {};
    }
    advise_huge_pages(page.data, kBytes);
    const std::uint64_t run = run_of(kAll, units);
    page.free.store(kAll & ~run, std::memory_order_release);
    return block_of(index, run);
  }
  return {};
}

/// Takes a block back. Returns whether its page has no block in use; such a page stays until `free_one`.
bool give(const WorkingMemory& block) noexcept {
  Page& page = pages()[static_cast<std::size_t>(block.page)];
  const auto first = static_cast<std::size_t>(static_cast<char*>(block.data) - page.data) / kUnit;
  const std::uint64_t run = (kAll >> (64 - block.bytes / kUnit)) << first;
  return (page.free.fetch_or(run, std::memory_order_acq_rel) | run) == kAll;
}

/// Returns the bytes of all pages that have no block in use.
std::size_t unused_bytes() noexcept {
  std::size_t bytes = 0;
  for (const Page& page : pages()) {
    if (page.free.load(std::memory_order_relaxed) == kAll) bytes += kBytes;
  }
  return bytes;
}

/// Frees a page that has no block in use. Returns whether there was one.
bool free_one() noexcept {
  for (Page& page : pages()) {
    std::uint64_t unused = kAll;
    if (!page.free.compare_exchange_strong(unused, 0, std::memory_order_acquire)) continue;
    ::operator delete(page.data, kAlignment);
    page.data = nullptr;
    page.taken.store(false, std::memory_order_release);
    return true;
  }
  return false;
}

}  // namespace shared_pages

constexpr std::size_t kMaxBlocks = 256;

/// Address sanitizers detect uses of freed memory, and WebAssembly's memory is never returned to its host: both leave
/// blocks to the heap.
#if WELKIN_ADDRESS_SANITIZER || defined(__wasm__)
constexpr std::size_t kDefaultLimit = 0;
#else
constexpr std::size_t kDefaultLimit = std::size_t{128} << 20U;
#endif

/// Rounds the size of a request up: sizes are few, so that a block serves requests that differ little. At most an
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

/// Blocks that are not in use. No call waits for its lock: where another thread has it, or had it when this process was
/// forked, blocks come from the heap and return to it.
class Pool {
 public:
  [[nodiscard]] std::size_t limit() const noexcept { return limit_.load(std::memory_order_relaxed); }
  /// Counts all kept bytes, those in shared pages too.
  [[nodiscard]] std::size_t bytes() const noexcept {
    return bytes_.load(std::memory_order_relaxed) + shared_pages::unused_bytes();
  }

  void set_limit(std::size_t limit) noexcept {
    limit_.store(limit, std::memory_order_relaxed);
    shrink_to(limit);
  }

  /// Returns the smallest block that serves, and the newest of equal ones; a null block if there is none.
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

  /// Keeps a block, freeing the oldest ones for it, or frees it.
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

  /// Frees the oldest blocks, and then shared pages, until at most `bytes` are kept. Returns whether any was freed.
  /// Retries for a while if another thread has the lock, which is held no longer than a list of 256 numbers takes.
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
