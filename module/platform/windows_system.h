// Windows' header and what its sources here share. Included only by sources of Windows (*_windows*.cpp).
#pragma once

#ifndef NOMINMAX
#define NOMINMAX
#endif
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#include <windows.h>

#include <string>
#include <string_view>

#include "platform/file.h"
#include "platform/text.h"

namespace welkin::platform {

[[nodiscard]] inline HANDLE handle_of(SystemFile file) noexcept { return reinterpret_cast<HANDLE>(file); }
[[nodiscard]] inline SystemFile file_of(HANDLE handle) noexcept { return reinterpret_cast<SystemFile>(handle); }

/// Converts UTF-16 to UTF-8; invalid characters become U+FFFD.
[[nodiscard]] std::string utf8(std::wstring_view text);

/// Returns Windows' message for an error number, in UTF-8 and without a full stop.
[[nodiscard]] std::string system_message(DWORD number);

/// Lets others read, write, rename and remove an open file, as on POSIX.
inline constexpr DWORD kSharedByAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

}  // namespace welkin::platform
