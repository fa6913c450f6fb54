#include "fuzzed_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/texture_file.h"

namespace welkin::fuzz {
namespace {

constexpr std::uint64_t kMemoryLimit = std::uint64_t{8} << 20U;

// A few bytes of run-length codes may stand for thousands of millions of texels. To stream them takes no memory, but
// the time that it takes is theirs, and no hang.
constexpr std::int64_t kTexelsToStream = std::int64_t{1} << 20U;

// One file for the whole run: a new one for each input would be most of the time.
int file_in_memory() {
  static const int descriptor = memfd_create("fuzzed", 0);
  return descriptor;
}

void replace_content(int descriptor, const std::uint8_t* bytes, std::size_t count) {
  if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, bytes, count, 0) != static_cast<ssize_t>(count)) {
    std::abort();
  }
}

template <typename Call>
void expect_result_or_error(const Call& call) {
  try {
    call();
  } catch (const Error&) {
  }
}

}  // namespace

void use_as_file(const std::uint8_t* bytes, std::size_t count) {
  const int descriptor = file_in_memory();
  replace_content(descriptor, bytes, count);
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  expect_result_or_error([&] { (void)read_texture(path, kMemoryLimit); });
  expect_result_or_error([&] { (void)read_babylon_environment(path, kMemoryLimit); });
  for (const Layout layout : {Layout::automatic, Layout::lat_long}) {
    ReadOptions options;
    options.layout = layout;
    options.memory_limit_bytes = kMemoryLimit;
    EnvironmentInfo info;
    expect_result_or_error([&] { info = inspect_environment(path, options); });
    expect_result_or_error([&] { (void)read_environment(path, options); });
    if (std::int64_t{info.width} * info.height <= kTexelsToStream) {
      expect_result_or_error([&] { (void)measure_environment(path, options); });
      expect_result_or_error([&] { (void)project_file(path, options); });
    }
  }
}

}  // namespace welkin::fuzz
