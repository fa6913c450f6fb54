#include "platform/windows_system.h"
#include "support/process_threads.h"
// After Windows' main header.
#include <psapi.h>
#include <tlhelp32.h>

#include <array>

namespace welkin::test {

std::set<int> process_threads() {
  std::set<int> threads;
  const HANDLE all = CreateToolhelp32Snapshot(TH32CS_SNAPTHREAD, 0);
  THREADENTRY32 thread{};
  thread.dwSize = sizeof thread;
  for (BOOL more = Thread32First(all, &thread); more; more = Thread32Next(all, &thread)) {
    if (thread.th32OwnerProcessID == GetCurrentProcessId()) threads.insert(static_cast<int>(thread.th32ThreadID));
  }
  CloseHandle(all);
  return threads;
}

std::string thread_name(int thread) {
  using GetDescription = HRESULT(WINAPI*)(HANDLE thread, PWSTR * name);
  const auto get_description = reinterpret_cast<GetDescription>(
      reinterpret_cast<void*>(GetProcAddress(GetModuleHandleW(L"kernel32.dll"), "GetThreadDescription")));
  const HANDLE handle = OpenThread(THREAD_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(thread));
  if (handle == nullptr || get_description == nullptr) return "";
  PWSTR name = nullptr;
  const bool known = get_description(handle, &name) >= 0 && name != nullptr;
  CloseHandle(handle);
  const std::string text = known ? platform::utf8(std::wstring_view(name)) : "";
  LocalFree(name);
  return text;
}

std::string this_threads_name() { return thread_name(static_cast<int>(GetCurrentThreadId())); }

void* loaded_function(const char* name) {
  std::array<HMODULE, 256> modules{};
  DWORD bytes = 0;
  if (!K32EnumProcessModules(GetCurrentProcess(), modules.data(), sizeof modules, &bytes)) return nullptr;
  for (std::size_t i = 0; i < modules.size() && i < bytes / sizeof(HMODULE); ++i) {
    if (const auto found = GetProcAddress(modules[i], name)) return reinterpret_cast<void*>(found);
  }
  return nullptr;
}

}  // namespace welkin::test
