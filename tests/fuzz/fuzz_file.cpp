// Files of any format, in memory: makes every call of `environment_file.h` that takes them, in both layouts, and reads
// them as textures and as .env. An exception other than `Error` ends the process.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace {

using namespace welkin;

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

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

/// Corrects the checksums of a PNG's chunks: nearly every change to a chunk breaks its own, and nothing is read after a
/// wrong one.
void mend_png_checksums(std::uint8_t* bytes, std::size_t count) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kAroundData = 12;  // length, type, checksum
  for (std::size_t index = kSignature; count >= kAroundData && index <= count - kAroundData;) {
    const std::size_t length = big_endian(bytes + index);
    if (length > count - index - kAroundData) return;
    const auto sum = static_cast<std::uint32_t>(crc32_z(0, bytes + index + 4, 4 + length));
    for (unsigned i = 0; i < 4; ++i) {
      bytes[index + 8 + length + i] = static_cast<std::uint8_t>(sum >> (24U - 8U * i));
    }
    index += length + kAroundData;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t count, std::size_t most);

// PNGs begin where their signature stands: at a file's first byte, or, as an .env's images, further on. What follows
// an image is no chunk of it, so mending ends there by itself.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t count, std::size_t most,
                                               unsigned seed) {
  constexpr std::array<std::uint8_t, 4> signature{0x89, 'P', 'N', 'G'};
  const std::size_t changed = LLVMFuzzerMutate(bytes, count, most);
  if (seed % 8 == 0) return changed;
  for (std::uint8_t* index = bytes; index != bytes + changed;) {
    index = std::search(index, bytes + changed, signature.begin(), signature.end());
    if (index == bytes + changed) break;
    mend_png_checksums(index, static_cast<std::size_t>(bytes + changed - index));
    ++index;
  }
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  const FileInput file(std::as_bytes(std::span(bytes, count)), "fuzzed");
  expect_result_or_error([&] { (void)read_texture(file, kMemoryLimit); });
  expect_result_or_error([&] { (void)read_babylon_environment(file, kMemoryLimit); });
  for (const Layout layout : {Layout::automatic, Layout::lat_long}) {
    ReadOptions options{
        .layout = layout, .element = count > 0 ? bytes[count - 1] % 2 : 0, .memory_limit_bytes = kMemoryLimit};
    EnvironmentInfo info;
    const auto inspect = [&] { info = inspect_environment(file, options); };
    expect_result_or_error(inspect);
    if (options.element != 0 && info.width == 0) {  // a texture that is no array has element 0 alone
      options.element = 0;
      expect_result_or_error(inspect);
    }
    expect_result_or_error([&] { (void)read_environment(file, options); });
    if (std::int64_t{info.width} * info.height <= kTexelsToStream) {
      expect_result_or_error([&] { (void)measure_environment(file, options); });
      expect_result_or_error([&] { (void)project_file(file, options); });
    }
  }
  return 0;
}
