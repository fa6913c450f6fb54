// Blocks below a mebibyte, cut from huge pages that several of them share.
//
// The first touch of a huge page takes as long as that of 25 to 50 small ones (84 us against 1.7 to 3.4 us, on a
// virtual machine with a Zen 5), and the small buffers of a first call have more than a thousand small pages.
#pragma once

#include <cstddef>

#include "platform/working_memory.h"

namespace welkin::platform::shared_pages {

inline constexpr std::size_t kBytes = std::size_t{2} << 20U;  ///< of a page
inline constexpr std::size_t kMaxPages = 64;                  ///< pages, those in use among them

/// Returns a block of at least `bytes` bytes, at most half a page: from a page with room for it, or from a new one. Its
/// data is null where there are `kMaxPages` pages already or there is no memory for one more. Takes no lock.
[[nodiscard]] WorkingMemory take(std::size_t bytes) noexcept;

/// Takes a block back. Returns whether its page has no block in use; such a page stays until `free_one`.
bool give(const WorkingMemory& block) noexcept;

/// Returns the bytes of all pages that have no block in use.
[[nodiscard]] std::size_t unused_bytes() noexcept;

/// Frees a page that has no block in use. Returns whether there was one.
bool free_one() noexcept;

}  // namespace welkin::platform::shared_pages
