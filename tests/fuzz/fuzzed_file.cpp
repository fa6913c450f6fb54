#include "fuzzed_file.h"

#include <span>

#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::fuzz {
namespace {

constexpr std::uint64_t kMemoryLimit = std::uint64_t{8} << 20U;

// A few bytes of run-length codes may stand for thousands of millions of texels. To stream them takes no memory, but
// the time that it takes is theirs, and no hang.
constexpr std::int64_t kTexelsToStream = std::int64_t{1} << 20U;

template <typename Call>
void expect_result_or_error(const Call& call) {
  try {
    call();
  } catch (const Error&) {
  }
}

}  // namespace

void use_as_file(const std::uint8_t* bytes, std::size_t count) {
  const FileInput file(std::as_bytes(std::span(bytes, count)), "fuzzed");
  expect_result_or_error([&] { (void)read_texture(file, kMemoryLimit); });
  expect_result_or_error([&] { (void)read_babylon_environment(file, kMemoryLimit); });
  for (const Layout layout : {Layout::automatic, Layout::lat_long}) {
    ReadOptions options{
        .layout = layout, .element = count > 0 ? bytes[count - 1] % 2 : 0, .memory_limit_bytes = kMemoryLimit};
    EnvironmentInfo info;
    const auto inspect = [&] { info = inspect_environment(file, options); };
    expect_result_or_error(inspect);
    if (options.element != 0 && info.width == 0) {  // what is no array has element 0 alone
      options.element = 0;
      expect_result_or_error(inspect);
    }
    expect_result_or_error([&] { (void)read_environment(file, options); });
    if (std::int64_t{info.width} * info.height <= kTexelsToStream) {
      expect_result_or_error([&] { (void)measure_environment(file, options); });
      expect_result_or_error([&] { (void)project_file(file, options); });
    }
  }
}

}  // namespace welkin::fuzz
