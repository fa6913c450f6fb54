#include "tools/lines.h"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "platform/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = std::size_t{1} << 20U;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30U;
constexpr std::size_t kBlock = std::size_t{1} << 16U;

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
    fail(ErrorCode::file_access, "is neither a regular file nor a pipe");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(ErrorCode::file_access, "cannot be read (" + system_reason() + ")");
  std::uintmax_t bytes = 0;
  std::string line;
  for (std::vector<char> block(kBlock); stream;) {
    errno = 0;
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    if (stream.bad()) fail_here(ErrorCode::file_access, "cannot be read (" + system_reason() + ")");
    std::string_view left(block.data(), static_cast<std::size_t>(stream.gcount()));
    bytes += left.size();
    if (bytes > kMostBytes) fail_here(ErrorCode::limit_exceeded, "there is more than a gigabyte");
    while (!left.empty()) {
      const std::size_t end = left.find('\n');
      line += left.substr(0, end);
      if (line.size() > kLongestLine) fail_here(ErrorCode::limit_exceeded, "has more than a megabyte");
      if (end == std::string_view::npos) break;
      use(number++, line);
      line.clear();
      left.remove_prefix(end + 1);
    }
  }
  if (!line.empty()) use(number, line);
}

}  // namespace welkin::tool
