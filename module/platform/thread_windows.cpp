#include <atomic>
#include <cstdint>
#include <new>
#include <vector>

#include "platform/thread.h"
#include "platform/wait.h"
#include "platform/windows_system.h"

namespace welkin::detail {

void name_current_thread(const char* name) noexcept {
  // Windows 10, version 1607 and later; older ones do not name threads.
  using SetDescription = HRESULT(WINAPI*)(HANDLE thread, PCWSTR name);
  const HMODULE library = GetModuleHandleW(L"kernel32.dll");
  if (library == nullptr) return;
  // Cast through void*, because the compiler warns of casts between function types.
  const auto set_description =
      reinterpret_cast<SetDescription>(reinterpret_cast<void*>(GetProcAddress(library, "SetThreadDescription")));
  if (set_description == nullptr) return;
  wchar_t wide[kMaxNameCharacters + 1] = {};
  // A name that was cut within a UTF-8 character ends in U+FFFD.
  if (MultiByteToWideChar(CP_UTF8, 0, name, -1, wide, static_cast<int>(kMaxNameCharacters + 1)) == 0) return;
  static_cast<void>(set_description(GetCurrentThread(), wide));
}

void rank_current_thread(ThreadPriority priority) noexcept {
  if (priority == ThreadPriority::normal) return;
  const bool idle = priority == ThreadPriority::idle;
  SetThreadPriority(GetCurrentThread(), idle ? THREAD_PRIORITY_IDLE : THREAD_PRIORITY_LOWEST);
}

// Threads end by returning: ExitThread does not unwind, so there is nothing to mend.
bool returns_from(void (*function)(void* argument), void* argument) {
  function(argument);
  return true;
}

AddressReserve::AddressReserve(std::size_t bytes) noexcept
    : block_(VirtualAlloc(nullptr, bytes, MEM_RESERVE, PAGE_NOACCESS)), bytes_(bytes) {}

AddressReserve::~AddressReserve() {
  if (block_ != nullptr) VirtualFree(block_, 0, MEM_RELEASE);
}

namespace {

/// Runs a thread of `can_make_threads`, which stays until all threads exist.
DWORD WINAPI stay(void* over) {
  platform::wait_while(*static_cast<std::atomic<bool>*>(over), false);
  return 0;
}

}  // namespace

bool can_make_threads(int count) noexcept {
  constexpr std::size_t kLargestStack = std::size_t{8} << 20U;  // oneTBB's have 4 MiB
  const std::size_t wanted = count > 0 ? static_cast<std::size_t>(count) : 0;
  std::atomic<bool> over{false};
  std::size_t made = 0;
  try {
    std::vector<HANDLE> threads(wanted);
    const auto make = [&] {
      return CreateThread(nullptr, kLargestStack, stay, &over, STACK_SIZE_PARAM_IS_A_RESERVATION, nullptr);
    };
    while (made < wanted && (threads[made] = make()) != nullptr) ++made;
    over = true;
    platform::wake_all(over);
    for (std::size_t i = 0; i < made; ++i) {
      WaitForSingleObject(threads[i], INFINITE);
      CloseHandle(threads[i]);
    }
  } catch (const std::bad_alloc&) {  // from the vector, before there are threads
  }
  return made == wanted;
}

}  // namespace welkin::detail
