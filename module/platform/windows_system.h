// Windows' own header and what its sources here share. Included by sources named *_windows.cpp alone.
#pragma once

#ifndef NOMINMAX
#define NOMINMAX
#endif
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#include <windows.h>
// After it, because it needs that one's types.
#include <string>
#include <string_view>

#include "platform/file.h"
#include "platform/text.h"

namespace welkin::platform {

[[nodiscard]] inline HANDLE handle_of(SystemFile file) noexcept { return reinterpret_cast<HANDLE>(file); }
[[nodiscard]] inline SystemFile file_of(HANDLE handle) noexcept { return reinterpret_cast<SystemFile>(handle); }

/// UTF-16 as UTF-8; what is no character becomes U+FFFD.
[[nodiscard]] std::string utf8(std::wstring_view text);

/// Windows' words for one of its error numbers, in UTF-8 and without a full stop.
[[nodiscard]] std::string system_message(DWORD number);

/// Others may read, write, rename and remove what is open, as on POSIX.
inline constexpr DWORD kSharedByAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

}  // namespace welkin::platform
