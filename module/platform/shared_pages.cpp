#include "platform/shared_pages.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <new>

#include "platform/memory.h"

namespace welkin::platform::shared_pages {
namespace {

constexpr std::size_t kUnit = kBytes / 64;
constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::align_val_t kAlignment{kHugePage};

/// A page in 64 units. The thread that clears bits of `free` owns these units; the one that clears all of them owns the
/// page.
struct Page {
  std::atomic<std::uint64_t> free{0};  ///< a bit for each unit; 0 without memory
  std::atomic<bool> taken{false};      ///< has memory, or is about to
  char* data = nullptr;
};

std::array<Page, kMaxPages>& pages() {
  static auto& all = *new std::array<Page, kMaxPages>;  // never destroyed: threads may compute while the program exits
  return all;
}

/// Returns the bits of the lowest run of that many free units; 0 where there is none.
std::uint64_t run_of(std::uint64_t free, unsigned units) noexcept {
  for (unsigned length = 1; length < units;) {  // a bit stays where so many follow
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

}  // namespace

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

bool give(const WorkingMemory& block) noexcept {
  Page& page = pages()[static_cast<std::size_t>(block.page)];
  const auto first = static_cast<std::size_t>(static_cast<char*>(block.data) - page.data) / kUnit;
  const std::uint64_t run = (kAll >> (64 - block.bytes / kUnit)) << first;
  return (page.free.fetch_or(run, std::memory_order_acq_rel) | run) == kAll;
}

std::size_t unused_bytes() noexcept {
  std::size_t bytes = 0;
  for (const Page& page : pages()) {
    if (page.free.load(std::memory_order_relaxed) == kAll) bytes += kBytes;
  }
  return bytes;
}

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

}  // namespace welkin::platform::shared_pages
