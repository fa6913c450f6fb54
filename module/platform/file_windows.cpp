// Files by Windows' calls.
#include <fcntl.h>
#include <io.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/pending_file.h"
#include "platform/windows_system.h"

namespace welkin::platform {

std::string utf8(std::wstring_view text) {
  const int length = static_cast<int>(text.size());
  const int bytes = WideCharToMultiByte(CP_UTF8, 0, text.data(), length, nullptr, 0, nullptr, nullptr);
  std::string result(static_cast<std::size_t>(bytes), '\0');
  WideCharToMultiByte(CP_UTF8, 0, text.data(), length, result.data(), bytes, nullptr, nullptr);
  return result;
}

std::string system_message(DWORD number) {
  if (number == ERROR_SUCCESS) return "the system does not say why";
  std::array<wchar_t, 512> text{};
  const DWORD length = FormatMessageW(FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS, nullptr, number, 0,
                                      text.data(), static_cast<DWORD>(text.size()), nullptr);
  std::string message = utf8(std::wstring_view(text.data(), length));
  while (!message.empty() &&
         (message.back() == '.' || message.back() == ' ' || message.back() == '\r' || message.back() == '\n')) {
    message.pop_back();
  }
  return message.empty() ? "error " + std::to_string(number) + " of Windows" : message;
}

std::int64_t process_number() noexcept { return static_cast<std::int64_t>(GetCurrentProcessId()); }

std::filesystem::path reachable(const std::filesystem::path& path) {
  constexpr std::size_t kLongest = 248;  // folder path for CreateDirectory: MAX_PATH less an 8.3 name
  constexpr std::wstring_view kUnbounded = L"\\\\?\\";
  if (path.empty() || path.native().starts_with(kUnbounded)) return path;
  std::wstring whole(GetFullPathNameW(path.c_str(), 0, nullptr, nullptr), L'\0');
  whole.resize(GetFullPathNameW(path.c_str(), static_cast<DWORD>(whole.size()), whole.data(), nullptr));
  if (whole.size() < kLongest) return path;
  if (whole.starts_with(L"\\\\")) return std::wstring(kUnbounded) + L"UNC" + whole.substr(1);
  return std::wstring(kUnbounded) + whole;
}

SharedFile::SharedFile(const std::filesystem::path& path) noexcept : file_(kNoFile) {
  try {
    const std::filesystem::path name = reachable(path);
    // A reparse point (a link) is opened itself, and then does not count as a regular file.
    const auto open = [&](DWORD access) {
      return file_of(CreateFileW(name.c_str(), access, kSharedByAll, nullptr, OPEN_EXISTING,
                                 FILE_FLAG_OPEN_REPARSE_POINT, nullptr));
    };
    file_ = open(GENERIC_READ | FILE_WRITE_ATTRIBUTES);
    if (!is_open()) file_ = open(GENERIC_READ);
  } catch (const std::bad_alloc&) {  // no memory for the name: not open
  }
}

SharedFile::~SharedFile() {
  if (is_open()) CloseHandle(handle_of(file_));
}

std::optional<std::uint64_t> SharedFile::size() const noexcept {
  BY_HANDLE_FILE_INFORMATION status{};
  constexpr DWORD kNotRegular = FILE_ATTRIBUTE_DIRECTORY | FILE_ATTRIBUTE_REPARSE_POINT | FILE_ATTRIBUTE_DEVICE;
  if (GetFileType(handle_of(file_)) != FILE_TYPE_DISK || !GetFileInformationByHandle(handle_of(file_), &status) ||
      (status.dwFileAttributes & kNotRegular) != 0) {
    return std::nullopt;
  }
  return (std::uint64_t{status.nFileSizeHigh} << 32U) | status.nFileSizeLow;
}

bool SharedFile::read(void* bytes, std::size_t count) const noexcept {
  constexpr std::size_t kMax = std::size_t{1} << 30U;  // a call's count has 32 bits
  auto* to = static_cast<std::uint8_t*>(bytes);
  while (count > 0) {
    DWORD got = 0;
    const auto wanted = static_cast<DWORD>(count < kMax ? count : kMax);
    if (!ReadFile(handle_of(file_), to, wanted, &got, nullptr) || got == 0) return false;
    to += got;
    count -= got;
  }
  return true;
}

void SharedFile::touch() const noexcept {
  FILETIME now{};
  GetSystemTimeAsFileTime(&now);
  SetFileTime(handle_of(file_), nullptr, nullptr, &now);
}

// Windows locks no folders. An event named after the folder's number serves as the lock: it exists as long as a handle
// to it is open, and its creator holds the folder.
FolderLock::FolderLock(const std::filesystem::path& folder) noexcept : file_(kNoFile) {
  try {
    file_ = file_of(CreateFileW(reachable(folder).c_str(), FILE_READ_ATTRIBUTES, kSharedByAll, nullptr, OPEN_EXISTING,
                                FILE_FLAG_BACKUP_SEMANTICS, nullptr));
  } catch (const std::bad_alloc&) {  // no memory for the name: cannot be locked
  }
}

FolderLock::~FolderLock() {
  if (file_ != kNoFile) CloseHandle(handle_of(file_));
}

bool FolderLock::take() noexcept {
  BY_HANDLE_FILE_INFORMATION folder{};
  if (!GetFileInformationByHandle(handle_of(file_), &folder)) return true;  // no folder, or taken before
  std::array<wchar_t, 80> name{};
  swprintf(name.data(), name.size(), L"Global\\welkin-folder-%08lx-%08lx%08lx", folder.dwVolumeSerialNumber,
           folder.nFileIndexHigh, folder.nFileIndexLow);
  const HANDLE event = CreateEventW(nullptr, TRUE, FALSE, name.data());
  const DWORD reason = GetLastError();
  if (event == nullptr) return reason != ERROR_ACCESS_DENIED;  // denied: another user's; else: no events here
  if (reason == ERROR_ALREADY_EXISTS) {
    CloseHandle(event);
    return false;
  }
  CloseHandle(handle_of(std::exchange(file_, file_of(event))));
  return true;
}

void remove_if_left_behind(const std::filesystem::path& path) noexcept {
  // Opened without sharing, which fails while a living writer has it open.
  const HANDLE file = CreateFileW(path.c_str(), DELETE, 0, nullptr, OPEN_EXISTING,
                                  FILE_FLAG_DELETE_ON_CLOSE | FILE_FLAG_OPEN_REPARSE_POINT, nullptr);
  if (file != INVALID_HANDLE_VALUE) CloseHandle(file);
}

bool PendingFile::note_failure() {
  why_ = system_message(GetLastError());
  return false;
}

void PendingFile::discard() noexcept {
  if (file_ == kNoFile) return;
  FILE_DISPOSITION_INFO removed{TRUE};
  SetFileInformationByHandle(handle_of(file_), FileDispositionInfo, &removed, sizeof removed);
  CloseHandle(handle_of(std::exchange(file_, kNoFile)));
}

bool PendingFile::make() {
  for (int tried = 0; tried < kMaxNamesTried; ++tried) {
    beside_ = name_beside(target_);
    const HANDLE file = CreateFileW(beside_.c_str(), GENERIC_WRITE | DELETE, kSharedByAll, nullptr, CREATE_NEW,
                                    FILE_ATTRIBUTE_NORMAL, nullptr);
    if (file != INVALID_HANDLE_VALUE) {
      file_ = file_of(file);
      return true;
    }
    if (GetLastError() != ERROR_FILE_EXISTS) break;
  }
  return note_failure();
}

bool PendingFile::open_stream() {
  HANDLE copy = INVALID_HANDLE_VALUE;  // for the stream, which closes its handle
  const HANDLE process = GetCurrentProcess();
  if (!DuplicateHandle(process, handle_of(file_), process, &copy, 0, FALSE, DUPLICATE_SAME_ACCESS)) {
    return note_failure();
  }
  const int descriptor = _open_osfhandle(file_of(copy), _O_BINARY | _O_NOINHERIT);
  if (descriptor < 0) {
    CloseHandle(copy);
  } else {
    stream_ = _fdopen(descriptor, "wb");
    if (stream_ == nullptr) _close(descriptor);
  }
  if (stream_ == nullptr) why_ = std::generic_category().message(errno);
  return stream_ != nullptr;
}

void PendingFile::set_permissions(std::filesystem::perms /*permissions*/) noexcept {}  // a file takes its folder's

bool PendingFile::seek(std::uint64_t position) {
  errno = 0;
  return note_unless(_fseeki64(stream_, static_cast<std::int64_t>(position), SEEK_SET) == 0);
}

bool PendingFile::flush_to_disk() { return FlushFileBuffers(handle_of(file_)) || note_failure(); }

namespace {

/// Renames as POSIX does, also over an open file, if its handles share deletion. Needs Windows 10, version 1709, and
/// NTFS; fails elsewhere.
bool rename_as_posix(HANDLE file, const std::filesystem::path& target) {
  const std::wstring name = std::filesystem::absolute(target).native();
  const std::size_t bytes = name.size() * sizeof(wchar_t);
  std::vector<std::uint64_t> memory((sizeof(FILE_RENAME_INFO) + bytes) / sizeof(std::uint64_t) + 1);
  auto* const wanted = reinterpret_cast<FILE_RENAME_INFO*>(memory.data());
  constexpr DWORD kReplaces = 0x1;        // FILE_RENAME_FLAG_REPLACE_IF_EXISTS
  constexpr DWORD kPosixSemantics = 0x2;  // FILE_RENAME_FLAG_POSIX_SEMANTICS
  constexpr auto kRenameInfoEx = static_cast<FILE_INFO_BY_HANDLE_CLASS>(22);
  *reinterpret_cast<DWORD*>(wanted) = kReplaces | kPosixSemantics;
  wanted->FileNameLength = static_cast<DWORD>(bytes);
  name.copy(wanted->FileName, name.size());
  const auto size = static_cast<DWORD>(sizeof(FILE_RENAME_INFO) + bytes);
  return SetFileInformationByHandle(file, kRenameInfoEx, wanted, size) != 0;
}

}  // namespace

bool PendingFile::put_in_place() {
  // Programs that scan new files (virus scanners, indexers) have them open for a moment.
  constexpr int kTries = 10;
  constexpr DWORD kPauseMilliseconds = 20;
  bool placed = rename_as_posix(handle_of(file_), target_);
  DWORD reason = ERROR_SUCCESS;
  for (int tried = 0; !placed && tried < kTries; ++tried) {
    if (tried > 0) Sleep(kPauseMilliseconds);
    placed = MoveFileExW(beside_.c_str(), target_.c_str(), MOVEFILE_REPLACE_EXISTING) != 0;
    reason = placed ? ERROR_SUCCESS : GetLastError();
    if (reason != ERROR_ACCESS_DENIED && reason != ERROR_SHARING_VIOLATION) break;
  }
  if (placed) {
    CloseHandle(handle_of(std::exchange(file_, kNoFile)));
    beside_.clear();
    return true;
  }
  why_ = system_message(reason);
  if (reason == ERROR_ACCESS_DENIED || reason == ERROR_SHARING_VIOLATION) {
    why_ += " (another program has the file that is there open, or it may only be read; close it there)";
  }
  return false;
}

}  // namespace welkin::platform
