// The system's side of threads: their names and priorities, and the number of threads that it runs at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "welkin/core.h"

namespace welkin::detail {

/// The characters of a thread's name that the system keeps.
inline constexpr std::size_t kMaxNameCharacters = 15;

/// Names the calling thread. The name has at most `kMaxNameCharacters` characters.
void name_current_thread(const char* name) noexcept;

/// Lowers the calling thread's priority. It cannot be raised again without privileges, so this is for Welkin's threads
/// only. Where the system refuses, the priority is unchanged.
void rank_current_thread(ThreadPriority priority) noexcept;

/// Calls `function(argument)`. Returns false if it called `pthread_exit`: the thread continues here instead of ending,
/// because unwinding oneTBB's frames and `noexcept` ones below would end the process. Exceptions pass through.
[[nodiscard]] bool returns_from(void (*function)(void* argument), void* argument);

/// A reservation of address space, for as long as this object lives: threads made meanwhile leave this much for the
/// work. Costs no memory.
class AddressReserve {
 public:
  explicit AddressReserve(std::size_t bytes) noexcept;
  ~AddressReserve();
  AddressReserve(const AddressReserve&) = delete;
  AddressReserve& operator=(const AddressReserve&) = delete;

  /// Returns false if there was less.
  [[nodiscard]] bool held() const noexcept { return block_ != nullptr; }

 private:
  void* block_ = nullptr;
  std::size_t bytes_;
};

/// The bytes that threads should leave for the work, as a limit on the process's address space (ulimit -v) counts them:
/// stacks of 8 MiB and the heaps that the C library keeps per thread would use it all.
inline constexpr std::size_t kRoomForWork = std::size_t{256} << 20U;

/// Returns whether the system allows this many more threads at once: they are made, and have ended when this returns.
/// For callers that cannot survive a failure to make threads, as oneTBB cannot.
[[nodiscard]] bool can_make_threads(int count) noexcept;

/// Returns the number of processors that the process's control groups grant, rounded up, at least 1; 0 without a quota.
/// It is the minimum over all groups from the process's own up to the topmost visible one, by version 2 (`cpu.max`) and
/// by version 1 (`cpu.cfs_quota_us`, `cpu.cfs_period_us`); hybrid systems have both. oneTBB counts processors by
/// affinity and ignores quotas. `root`: the folder that holds /proc and the mount points.
/// Linux: cgroups(7), and Documentation/scheduler/sched-bwc.rst of the kernel's sources.
[[nodiscard]] int quota_processors(const std::filesystem::path& root = "/");

}  // namespace welkin::detail
