// What the system knows of a thread: its number, name, rank and whether it sleeps.
#pragma once

#include <cstddef>

#include "welkin/control.h"

namespace welkin::detail {

/// The calling thread's number, as in /proc/self/task.
[[nodiscard]] long current_thread_number() noexcept;

/// That the system keeps of a thread's name.
inline constexpr std::size_t kMostNameCharacters = 15;

/// Names the calling thread, in no more characters than these.
void name_current_thread(const char* name) noexcept;

/// Lowers the calling thread's rank. It cannot be raised again without privileges, so this is for threads of our own.
/// Where the system does not let us, the thread stays as it is.
void rank_current_thread(ThreadPriority priority) noexcept;

/// Whether a thread of this process sleeps: it neither runs, nor waits for a processor or a disk. True if there is none
/// of that number, or if the system does not say.
[[nodiscard]] bool asleep(long thread_number);

}  // namespace welkin::detail
