// Processes on Windows.

#include "perf/report/measuring.h"
#include "platform/text.h"
#include "platform/windows_system.h"
#include "welkin/core.h"

namespace welkin::report {
namespace {

/// Windows counts these times in units of 100 ns.
double seconds(const FILETIME& time) {
  return 1e-7 * static_cast<double>((std::uint64_t{time.dwHighDateTime} << 32U) | time.dwLowDateTime);
}

/// Returns the lowest `count` bits of the mask.
DWORD_PTR lowest(DWORD_PTR mask, int count) {
  DWORD_PTR few = 0;
  for (DWORD_PTR rest = mask; rest != 0 && std::popcount(few) < count; rest &= rest - 1) few |= rest & (~rest + 1);
  return few;
}

/// A file that a started process may use; "NUL" is none.
class InheritedFile {
 public:
  InheritedFile(const std::wstring& name, DWORD access, DWORD disposition) {
    SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
    handle_ = CreateFileW(name.c_str(), access, platform::kSharedByAll, &inherited, disposition, 0, nullptr);
  }
  ~InheritedFile() {
    if (handle_ != INVALID_HANDLE_VALUE) CloseHandle(handle_);
  }
  InheritedFile(const InheritedFile&) = delete;
  InheritedFile& operator=(const InheritedFile&) = delete;

  [[nodiscard]] HANDLE handle() const noexcept { return handle_; }

 private:
  HANDLE handle_ = INVALID_HANDLE_VALUE;
};

/// Joins words that have no quotation marks and do not end in a backslash, as those of these programs.
std::wstring command_line(const std::vector<std::string>& arguments) {
  std::wstring line;
  for (const std::string& word : arguments) {
    line += (line.empty() ? L"\"" : L" \"") + platform::path_of(word).native() + L'"';
  }
  return line;
}

/// Starts a process suspended, so that it can be bound before it runs. Null: it could not be started.
PROCESS_INFORMATION start(const std::vector<std::string>& arguments, const std::wstring& output) {
  const InheritedFile in(L"NUL", GENERIC_READ, OPEN_EXISTING);
  const InheritedFile out(output, GENERIC_WRITE, output == L"NUL" ? OPEN_EXISTING : CREATE_ALWAYS);
  const InheritedFile error(L"NUL", GENERIC_WRITE, OPEN_EXISTING);
  STARTUPINFOW wanted{};
  wanted.cb = sizeof wanted;
  wanted.dwFlags = STARTF_USESTDHANDLES;
  wanted.hStdInput = in.handle();
  wanted.hStdOutput = out.handle();
  wanted.hStdError = error.handle();
  PROCESS_INFORMATION started{};
  std::wstring line = command_line(arguments);
  if (!CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE, CREATE_SUSPENDED, nullptr, nullptr, &wanted,
                      &started)) {
    return {};
  }
  return started;
}

}  // namespace

double processor_seconds() {
  FILETIME made{};
  FILETIME ended{};
  FILETIME kernel{};
  FILETIME user{};
  GetThreadTimes(GetCurrentThread(), &made, &ended, &kernel, &user);
  return seconds(kernel) + seconds(user);
}

std::filesystem::path make_temporary_folder() {
  const std::filesystem::path all = std::filesystem::temp_directory_path();
  for (int number = 0;; ++number) {
    const std::string name = "welkin-report-" + std::to_string(GetCurrentProcessId()) + '-' + std::to_string(number);
    const std::filesystem::path folder = all / name;
    if (CreateDirectoryW(folder.c_str(), nullptr)) return folder;
    const DWORD reason = GetLastError();
    if (reason == ERROR_ALREADY_EXISTS) continue;
    throw Error(ErrorCode::file_access,
                platform::utf8(folder) + ": cannot be made (" + platform::system_message(reason) + ")");
  }
}

ProcessResult run_process(const std::vector<std::string>& arguments, int threads, Clock clock,
                          const std::optional<std::filesystem::path>& output) {
  using Steady = std::chrono::steady_clock;
  const Steady::time_point begin = Steady::now();
  const PROCESS_INFORMATION child = start(arguments, output ? output->native() : L"NUL");
  if (child.hProcess == nullptr) return {};
  DWORD_PTR ours = 0;
  DWORD_PTR all = 0;
  if (threads > 0 && GetProcessAffinityMask(GetCurrentProcess(), &ours, &all)) {
    SetProcessAffinityMask(child.hProcess, lowest(ours, threads));
  }
  ResumeThread(child.hThread);
  WaitForSingleObject(child.hProcess, INFINITE);
  const double wall = std::chrono::duration<double>(Steady::now() - begin).count();
  DWORD code = 1;
  GetExitCodeProcess(child.hProcess, &code);
  FILETIME made{};
  FILETIME ended{};
  FILETIME kernel{};
  FILETIME user{};
  GetProcessTimes(child.hProcess, &made, &ended, &kernel, &user);
  CloseHandle(child.hThread);
  CloseHandle(child.hProcess);
  const double processor = seconds(kernel) + seconds(user);
  constexpr DWORD kException = 0xC0000000;  // codes from here on mean an exception
  return {code < kException ? static_cast<int>(code) : -1, clock == Clock::processor ? processor : wall};
}

bool on_path(const std::string& program) {
  return SearchPathW(nullptr, platform::path_of(program).c_str(), L".exe", 0, nullptr, nullptr) != 0;
}

std::string processor_name() {
  const std::string count = std::to_string(std::thread::hardware_concurrency()) + " x ";
  std::array<wchar_t, 256> name{};
  auto bytes = static_cast<DWORD>(sizeof name);
  constexpr const wchar_t* kProcessor = L"HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0";
  if (RegGetValueW(HKEY_LOCAL_MACHINE, kProcessor, L"ProcessorNameString", RRF_RT_REG_SZ, nullptr, name.data(),
                   &bytes) != ERROR_SUCCESS) {
    return count + "processor of no name";
  }
  return count + platform::utf8(std::wstring_view(name.data()));
}

}  // namespace welkin::report
