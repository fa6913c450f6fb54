#include "platform/memory.h"

#include <cstdint>

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

}  // namespace welkin::platform
