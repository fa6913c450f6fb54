// Large blocks of working memory that stay with the process between calls, so that pages are cleared once and not in
// every call. The public functions are `keep_working_memory` and `release_working_memory` (welkin/core.h).
#pragma once

#include <cstddef>

namespace welkin::platform {

/// A block of memory. `bytes` may be more than was asked for.
struct WorkingMemory {
  void* data = nullptr;
  std::size_t bytes = 0;
  std::size_t alignment = 0;
  int page = -1;  ///< of `shared_pages`; below 0: it is no part of one
};

inline constexpr std::size_t kCacheLine = 64;
#ifdef __linux__
inline constexpr std::size_t kHugePage = std::size_t{2} << 20U;  // of x86-64, and of ARM with pages of 4 KiB
#else
inline constexpr std::size_t kHugePage = kCacheLine;  // no call asks for large pages
#endif
/// Smaller blocks come from the heap and return to it: malloc keeps them itself.
inline constexpr std::size_t kMinKeptBlock = std::size_t{64} << 10U;
/// Smaller blocks share huge pages.
inline constexpr std::size_t kMinOwnBlock = std::size_t{1} << 20U;

/// Returns at least `bytes` bytes that start on a cache line and are not initialised: a block that was kept, of at most
/// twice the size, or a new one. Throws std::bad_alloc.
[[nodiscard]] WorkingMemory take_working_memory(std::size_t bytes);

/// Takes back a block that `take_working_memory` returned: keeps it for later calls, or frees it.
void give_working_memory(const WorkingMemory& block) noexcept;

/// Returns the bytes of all blocks that are kept and not in use.
[[nodiscard]] std::size_t kept_working_memory() noexcept;

/// Fills every block that is taken from now on with this byte; -1 fills none. For tests that look for reads of memory
/// that nobody wrote.
void fill_taken_memory(int byte) noexcept;

}  // namespace welkin::platform
