// The process and its terminal on Windows.
#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "platform/text.h"
#include "platform/windows_system.h"
#include "tools/terminal.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

std::atomic<int> caught{0};
stop_source* asked = nullptr;  // never destroyed: the handler's thread outlives main

HANDLE stream_handle(Stream stream) {
  return GetStdHandle(stream == Stream::output ? STD_OUTPUT_HANDLE : STD_ERROR_HANDLE);
}

/// Called in its own thread. A second event does not wait: one that is not handled ends the process.
BOOL WINAPI note_event(DWORD event) {
  const bool key = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
  int none = 0;
  if (!caught.compare_exchange_strong(none, key ? SIGINT : SIGTERM)) return FALSE;
  asked->request_stop();
  // A closed window's process ends when this function returns: the work gets the time that the system allows.
  if (!key) Sleep(INFINITE);
  return TRUE;
}

[[noreturn]] void fail_reading(const std::optional<std::string>& pipe) {
  throw Error(ErrorCode::file_access,
              pipe.value_or("standard input") + ": cannot be read (" + platform::system_message(GetLastError()) + ")");
}

/// Returns the number of bytes that can be read without waiting; no limit unless it is a pipe. Nothing: the end.
std::optional<DWORD> wait_for_bytes(HANDLE file) {
  constexpr auto kPause = std::chrono::milliseconds(10);
  if (GetFileType(file) != FILE_TYPE_PIPE) return MAXDWORD;
  for (;;) {
    if (stop_on_signals().stop_requested()) throw Error(ErrorCode::cancelled, "stopped by a signal");
    DWORD there = 0;
    if (!PeekNamedPipe(file, nullptr, 0, nullptr, &there, nullptr)) return std::nullopt;
    if (there > 0) return there;
    std::this_thread::sleep_for(kPause);
  }
}

/// Splits a command line into words as the C library does: backslashes are literal, but before a quotation mark two of
/// them are one, and another one makes the mark literal; a doubled mark within quotation is literal too.
/// (CommandLineToArgvW would load the system's windows and desktop, which a command does without.)
std::vector<std::wstring> words_of(std::wstring_view line) {
  std::vector<std::wstring> words;
  bool quoted = false;
  bool inside = false;  // inside a word
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t backslashes = std::min(line.find_first_not_of(L'\\', i), line.size()) - i;
    i += backslashes;
    const bool mark = i < line.size() && line[i] == L'"';
    const bool space = i < line.size() && (line[i] == L' ' || line[i] == L'\t') && !quoted;
    if (!inside && (backslashes > 0 || !space)) words.emplace_back();
    inside = inside || backslashes > 0 || !space;
    if (backslashes > 0) words.back().append(mark ? backslashes / 2 : backslashes, L'\\');
    if (i == line.size()) break;
    if (space) {
      inside = false;
    } else if (mark && backslashes % 2 == 0 && quoted && i + 1 < line.size() && line[i + 1] == L'"') {
      words.back() += line[i++];
    } else if (mark && backslashes % 2 == 0) {
      quoted = !quoted;
    } else {
      words.back() += line[i];
    }
    ++i;
  }
  return words;
}

/// Returns one word of a command line for the C library: in quotation marks; backslashes before one are doubled.
std::wstring quoted(const std::wstring& word) {
  std::wstring result = L"\"";
  std::size_t backslashes = 0;
  for (const wchar_t c : word) {
    if (c == L'"') result.append(backslashes + 1, L'\\');
    backslashes = c == L'\\' ? backslashes + 1 : 0;
    result += c;
  }
  return result.append(backslashes, L'\\') + L'"';
}

}  // namespace

std::filesystem::path own_folder() {
  std::wstring name(MAX_PATH, L'\0');
  for (;;) {
    const DWORD length = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
    if (length < name.size()) return std::filesystem::path(name.substr(0, length)).parent_path();
    name.resize(2 * name.size());
  }
}

bool is_terminal(Stream stream) {
  DWORD mode = 0;
  const HANDLE handle = stream_handle(stream);
  return GetConsoleMode(handle, &mode) && (mode & ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

stop_token stop_on_signals() {
  static const auto& source = *[] {
    asked = new stop_source;
    SetConsoleCtrlHandler(note_event, TRUE);
    return asked;
  }();
  return source.get_token();
}

int caught_signal() noexcept { return caught; }

std::string signal_words(int number) { return number == SIGINT ? "Interrupt" : "Terminated"; }

std::vector<std::string> program_arguments(int /*count*/, char** /*words*/) {
  std::vector<std::string> arguments;
  for (const std::wstring& word : words_of(GetCommandLineW()))
    arguments.push_back(platform::utf8(std::wstring_view(word)));
  return {arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end()};
}

void reserve_standard_streams() noexcept {
  // The terminal's own code page is restored when the program ends.
  static const UINT before = GetConsoleOutputCP();
  if (before != 0 && before != CP_UTF8 && SetConsoleOutputCP(CP_UTF8)) {
    static_cast<void>(std::atexit([] { SetConsoleOutputCP(before); }));
  }
  for (const Stream stream : {Stream::output, Stream::error}) {
    DWORD mode = 0;
    const HANDLE handle = stream_handle(stream);
    if (GetConsoleMode(handle, &mode)) SetConsoleMode(handle, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
  }
  for (const int descriptor : {0, 1, 2}) static_cast<void>(_setmode(descriptor, _O_BINARY));
}

PipeEnd::PipeEnd(const std::optional<std::string>& pipe) : pipe_(pipe) {
  const HANDLE handle = pipe ? CreateFileW(platform::path_of(*pipe).c_str(), GENERIC_READ, platform::kSharedByAll,
                                           nullptr, OPEN_EXISTING, 0, nullptr)
                             : GetStdHandle(STD_INPUT_HANDLE);
  if (handle == INVALID_HANDLE_VALUE || handle == nullptr) fail_reading(pipe_);
  file_ = reinterpret_cast<std::intptr_t>(handle);
}

PipeEnd::~PipeEnd() {
  if (pipe_) CloseHandle(reinterpret_cast<HANDLE>(file_));
}

std::size_t PipeEnd::read(std::span<std::byte> bytes) {
  const HANDLE handle = reinterpret_cast<HANDLE>(file_);
  const std::optional<DWORD> there = wait_for_bytes(handle);
  if (!there) return 0;
  DWORD count = 0;
  const auto wanted = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), *there));
  const bool read = ReadFile(handle, bytes.data(), wanted, &count, nullptr) != 0;
  if (!read && GetLastError() != ERROR_BROKEN_PIPE && GetLastError() != ERROR_HANDLE_EOF) fail_reading(pipe_);
  return count;
}

std::string host_name() {
  std::array<wchar_t, MAX_COMPUTERNAME_LENGTH + 1> name{};
  auto length = static_cast<DWORD>(name.size());
  return GetComputerNameW(name.data(), &length) != 0 ? platform::utf8(std::filesystem::path(name.data())) : "";
}

std::string reason_not_to_write_in(const std::filesystem::path& folder) {
  // Permissions say little here, so this makes a file that is deleted on closing.
  const std::filesystem::path tried = folder / (".welkin-" + std::to_string(GetCurrentProcessId()) + ".tried");
  const HANDLE file = CreateFileW(platform::reachable(tried).c_str(), GENERIC_WRITE | DELETE, platform::kSharedByAll,
                                  nullptr, CREATE_ALWAYS, FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (file == INVALID_HANDLE_VALUE) return platform::system_message(GetLastError());
  CloseHandle(file);
  return "";
}

void become(const std::string& program, const std::vector<std::string>& arguments) {
  // Windows cannot replace a process: this one waits, and returns the other's exit code. Ctrl-C goes to both.
  std::wstring line = quoted(platform::path_of(program));
  for (const std::string& word : arguments) line += L' ' + quoted(platform::path_of(word));
  const std::filesystem::path sibling = own_folder() / (program + ".exe");
  const bool is_there = GetFileAttributesW(sibling.c_str()) != INVALID_FILE_ATTRIBUTES;
  STARTUPINFOW start{};
  start.cb = sizeof start;
  PROCESS_INFORMATION started{};
  if (!CreateProcessW(is_there ? sibling.c_str() : nullptr, line.data(), nullptr, nullptr, TRUE, 0, nullptr, nullptr,
                      &start, &started)) {
    const DWORD reason = GetLastError();
    throw Error(ErrorCode::file_access, program + ": cannot be run (" + platform::system_message(reason) +
                                            "); it is a separate program, which belongs next to " +
                                            platform::utf8(own_folder() / "welkin.exe") +
                                            " or on the PATH: build the target welkin_report_command");
  }
  SetConsoleCtrlHandler(nullptr, TRUE);
  WaitForSingleObject(started.hProcess, INFINITE);
  DWORD code = 1;
  GetExitCodeProcess(started.hProcess, &code);
  std::exit(static_cast<int>(code));
}

}  // namespace welkin::tool
