#include "tools/text_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "welkin/error.h"

namespace welkin::tool {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what, int reason) {
  throw Error(ErrorCode::file_access, path.string() + ": " + what + " (" + std::strerror(reason) +
                                          "); write to a folder that has room and lets this user write");
}

}  // namespace

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path beside = path;
  beside += ".welkin-" + std::to_string(getpid());
  errno = 0;
  // Not one that is there already: x.
  std::FILE* const stream = std::fopen(beside.c_str(), "wxb");
  if (stream == nullptr) fail(path, "cannot be written", errno);
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  int reason = written ? 0 : errno;
  if (std::fclose(stream) != 0 && reason == 0) reason = errno;
  std::error_code trouble;
  if (reason == 0) std::filesystem::rename(beside, path, trouble);
  if (reason == 0 && !trouble) return;
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  fail(path, "cannot be written", reason != 0 ? reason : trouble.value());
}

}  // namespace welkin::tool
