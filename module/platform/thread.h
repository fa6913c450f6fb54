// What the system knows of a thread: its name and rank.
#pragma once

#include <cstddef>

#include "welkin/core.h"

namespace welkin::detail {

/// That the system keeps of a thread's name.
inline constexpr std::size_t kMostNameCharacters = 15;

/// Names the calling thread, in no more characters than these.
void name_current_thread(const char* name) noexcept;

/// Lowers the calling thread's rank. It cannot be raised again without privileges, so this is for threads of our own.
/// Where the system does not let us, the thread stays as it is.
void rank_current_thread(ThreadPriority priority) noexcept;

}  // namespace welkin::detail
