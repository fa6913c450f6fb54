// What the system knows of a thread: its name and rank, and for how many threads it has time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "welkin/core.h"

namespace welkin::detail {

/// That the system keeps of a thread's name.
inline constexpr std::size_t kMaxNameCharacters = 15;

/// Names the calling thread, in no more characters than these.
void name_current_thread(const char* name) noexcept;

/// Lowers the calling thread's rank. It cannot be raised again without privileges, so this is for threads of our own.
/// Where the system does not let us, the thread stays as it is.
void rank_current_thread(ThreadPriority priority) noexcept;

/// Calls `function(argument)`. False if that called `pthread_exit`: the thread goes on here instead of ending, because
/// oneTBB's frames and `noexcept` ones below would end the process when they are unwound. Exceptions pass through.
[[nodiscard]] bool returns_from(void (*function)(void* argument), void* argument);

/// Address space that others cannot take while this object lives: threads that are made meanwhile leave so much for the
/// work. Costs no memory.
class AddressReserve {
 public:
  explicit AddressReserve(std::size_t bytes) noexcept;
  ~AddressReserve();
  AddressReserve(const AddressReserve&) = delete;
  AddressReserve& operator=(const AddressReserve&) = delete;

  /// False if there was less.
  [[nodiscard]] bool held() const noexcept { return block_ != nullptr; }

 private:
  void* block_ = nullptr;
  std::size_t bytes_;
};

/// That threads should leave for the work, as a limit on the process's address space (ulimit -v) counts it: stacks of 8
/// MiB and the heaps that the C library keeps for each thread would take all.
inline constexpr std::size_t kRoomForWork = std::size_t{256} << 20U;

/// Whether the system lets so many more threads be there at once: they are made, and are gone when this returns. For
/// who makes threads and does not live on where it cannot, as oneTBB does.
[[nodiscard]] bool can_make_threads(int count) noexcept;

/// How many processors the control groups of this process grant it, rounded up, at least 1; 0 where no quota is set.
/// The least of all groups from the process's own up to the topmost that can be seen counts, by version 2 (`cpu.max`)
/// and by version 1 (`cpu.cfs_quota_us`, `cpu.cfs_period_us`), of which hybrid systems have both. oneTBB counts
/// processors by affinity and knows nothing of quotas. `root`: where /proc and the mount points are looked for.
/// Linux: cgroups(7), and Documentation/scheduler/sched-bwc.rst of the kernel's sources.
[[nodiscard]] int quota_processors(const std::filesystem::path& root = "/");

}  // namespace welkin::detail
