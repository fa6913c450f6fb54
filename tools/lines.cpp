#include "tools/lines.h"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "platform/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = std::size_t{1} << 20U;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30U;

std::string system_reason() { return errno != 0 ? std::generic_category().message(errno) : "unknown reason"; }

}  // namespace

void for_each_line(const fs::path& file, const std::function<void(std::size_t number, const std::string& line)>& use) {
  std::size_t number = 1;
  const auto fail = [&](ErrorCode code, const std::string& what) {
    throw Error(code, platform::utf8(file) + ": " + what);
  };
  const auto fail_here = [&](ErrorCode code, const std::string& what) {
    fail(code, "line " + std::to_string(number) + ": " + what);
  };
  std::error_code unknown;
  const fs::file_status status = fs::status(file, unknown);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_fifo(status)) {
    fail(ErrorCode::file_access, "is neither a regular file nor a pipe; pass one of those");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(ErrorCode::file_access, "cannot be read (" + system_reason() + "); check its permissions");
  std::uintmax_t bytes = 0;
  std::string line(kLongestLine + 1, '\0');
  while (stream.getline(line.data(), static_cast<std::streamsize>(line.size()))) {
    const auto read = static_cast<std::size_t>(stream.gcount());
    bytes += read;
    if (bytes > kMostBytes) fail_here(ErrorCode::limit_exceeded, "the file is larger than a gigabyte; split it");
    use(number++, line.substr(0, stream.eof() ? read : read - 1));
  }
  if (stream.bad())
    fail_here(ErrorCode::file_access, "cannot be read (" + system_reason() + "); check its permissions");
  if (!stream.eof()) fail_here(ErrorCode::limit_exceeded, "is longer than a megabyte; is this the right file?");
}

}  // namespace welkin::tool
