// Promises: what a header claims costs no memory; a streamed picture needs a few blocks a thread.
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"

// The sanitizers need far more address space than they are asked for.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WELKIN_UNLIMITED_ADDRESS_SPACE
#endif

namespace welkin {
namespace {

#ifndef WELKIN_UNLIMITED_ADDRESS_SPACE

std::uint64_t address_space_in_use() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu", &pages) != 1) {
      pages = 0;
    }
    std::fclose(file);
  }
  return std::uint64_t{pages} * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// Runs `work` in a child process that may take `bytes` more of address space than now. True if it returns true.
bool succeeds_within(std::uint64_t bytes, const std::function<bool()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{address_space_in_use() + bytes, RLIM_INFINITY};
    const bool limited = setrlimit(RLIMIT_AS, &limit) == 0;
    bool success = false;
    try {
      success = limited && work();
    } catch (...) {
    }
    _exit(success ? 0 : 1);
  }
  int status = 1;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// "VmRSS:" or "VmHWM:" of this process, in bytes.
std::uint64_t memory_by_status(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == key && status >> kibibytes) return kibibytes << 10U;
  }
  return 0;
}

// By how much `work` raised the memory that is in use at its highest; nothing if the system does not tell.
std::optional<std::uint64_t> peak_growth(const std::function<void()>& work) {
  malloc_trim(0);
  const std::uint64_t before = memory_by_status("VmRSS:");
  {
    std::ofstream reset("/proc/self/clear_refs");
    reset << "5";  // proc(5): the peak begins anew from what is in use now
    if (!reset.flush()) return std::nullopt;
  }
  if (before == 0 || memory_by_status("VmHWM:") > before + (before >> 6U)) return std::nullopt;
  work();
  const std::uint64_t peak = memory_by_status("VmHWM:");
  return peak > before ? peak - before : 0;
}

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20U;

// Refused for what the file says, not because memory ran out on the way.
bool is_refused_for_itself(const std::filesystem::path& path) {
  try {
    (void)inspect_environment(path);
    (void)measure_environment(path);
  } catch (const Error& error) {
    return std::strstr(error.what(), "more memory than there is") == nullptr;
  }
  return false;
}

// Puts a 32-bit value behind the first place where `name` and a type stand as attribute.
void patch_attribute(std::vector<char>& bytes, const std::string& name_and_type, std::size_t offset,
                     std::uint32_t value) {
  const auto found = std::search(bytes.begin(), bytes.end(), name_and_type.begin(), name_and_type.end());
  REQUIRE(found != bytes.end());
  const auto place = found - bytes.begin() + static_cast<std::ptrdiff_t>(name_and_type.size() + offset);
  std::memcpy(bytes.data() + place, &value, sizeof(value));
}

std::vector<char> tiled_exr(const std::filesystem::path& path) {
  test::ExrRecipe recipe{64, 32, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, Imf::TileDescription(16, 16), {}, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, test::some_pixels(64, 32));
  return test::read_bytes(path);
}

// What the first call of a process sets up (oneTBB, kernels, OpenEXR) is no matter of the picture's size.
void call_once_before(const test::TemporaryDirectory& directory) {
  const std::filesystem::path path = directory.file("small.exr");
  static_cast<void>(tiled_exr(path));
  run_with_threads(1, [&] { static_cast<void>(project_file(path)); });
}

using namespace std::string_literals;
const std::string kTiles = "tiles\0tiledesc\0"s;
const std::string kDataWindow = "dataWindow\0box2i\0"s;

#endif

}  // namespace

TEST_CASE("what an OpenEXR header claims costs no memory", "[codec]") {
#ifdef WELKIN_UNLIMITED_ADDRESS_SPACE
  WARN("left out: address space cannot be limited under a sanitizer");
#else
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("claims.exr");
  const std::vector<char> sound = tiled_exr(path);
  const auto check = [&](const std::function<void(std::vector<char>&)>& damage) {
    std::vector<char> bytes = sound;
    damage(bytes);
    test::write_bytes(path, bytes);
    CHECK(succeeds_within(64 * kMebibyte, [&] { return is_refused_for_itself(path); }));
  };
  check([](auto& bytes) {  // tiles of two gigatexels
    patch_attribute(bytes, kTiles, 4, 0x7fffffff);
    patch_attribute(bytes, kTiles, 8, 1);
  });
  check([](auto& bytes) {  // two thousand million tiles of one texel
    patch_attribute(bytes, kTiles, 4, 1);
    patch_attribute(bytes, kTiles, 8, 1);
    patch_attribute(bytes, kDataWindow, 12, 65535);
    patch_attribute(bytes, kDataWindow, 16, 32767);
  });
  check([](auto& bytes) {  // a picture as large as integers go
    patch_attribute(bytes, kDataWindow, 4, 0xc0000002);
    patch_attribute(bytes, kDataWindow, 12, 0x3ffffffe);
  });
  check([](auto& bytes) { patch_attribute(bytes, "lineOrder\0lineOrder\0"s, 0, 0x7fffffff); });
  check([](auto& bytes) { patch_attribute(bytes, "channels\0chlist\0"s, 0, 0x7fffffff); });
  check([](auto& bytes) {  // a long opaque attribute where a short one was
    const std::string name = "lineOrder\0lineOrder\0"s;
    const auto place = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
    std::copy_n("lineOrder\0something\0", name.size(), place);
    patch_attribute(bytes, "lineOrder\0something\0"s, 0, 0x7ffffff0);
  });
#endif
}

TEST_CASE("a streamed picture needs a few blocks of memory", "[codec]") {
#ifdef WELKIN_UNLIMITED_ADDRESS_SPACE
  WARN("left out: address space cannot be limited under a sanitizer");
#else
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("long.exr");
  const int width = 4096;
  const int height = 2048;  // 96 MiB as floats
  test::ExrRecipe recipe{width, height, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, {}, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, std::vector<float>(std::size_t{3} * width * height, 0.5F));
  ReadOptions options;
  options.memory_limit_bytes = 8 * kMebibyte;
  const auto stream = [&] {
    bool success = false;
    run_with_threads(1, [&] {  // a pool's threads do not live on in a child process
      success = measure_environment(path, options).texels == std::uint64_t{width} * height &&
                project_file(path, options).radiance.bands() == 3;
    });
    return success;
  };
  CHECK(succeeds_within(24 * kMebibyte, stream));
#endif
}

TEST_CASE("a 16384 x 8192 lat-long is projected in 4 MiB", "[codec][streaming]") {
#ifdef WELKIN_UNLIMITED_ADDRESS_SPACE
  WARN("left out: address space cannot be limited under a sanitizer");
#else
  // 1.5 GiB of zeros that take no room on the disk, and one row of ones.
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("vast.pfm");
  const std::string header = "PF\n16384 8192\n-1\n";
  const std::uint64_t row_bytes = 16384 * 12;
  test::write_bytes(path, {header.begin(), header.end()});
  std::filesystem::resize_file(path, header.size() + 8192 * row_bytes);
  {
    const std::vector<float> ones(row_bytes / 4, 1.0F);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(header.size() + 4096 * row_bytes));
    file.write(reinterpret_cast<const char*>(ones.data()), static_cast<std::streamsize>(row_bytes));
    REQUIRE(file.good());
  }
  const auto stream = [&] {
    bool success = false;
    run_with_threads(1, [&] {
      const Projection light = project_file(path);
      const double row = 2.0 * 3.14159265358979 * 3.14159265358979 / 8192.0;  // steradians of one row at the horizon
      success = light.diagnostics.texels == std::uint64_t{16384} * 8192 &&
                std::abs(light.diagnostics.flux.g / row - 1.0) < 1e-6;
    });
    return success;
  };
  call_once_before(directory);
  CHECK(succeeds_within(4 * kMebibyte, stream));
#endif
}

TEST_CASE("rows of 16384 texels in compressed blocks take 10 MiB for each thread", "[codec][streaming]") {
#ifdef WELKIN_UNLIMITED_ADDRESS_SPACE
  WARN("left out: a sanitizer's own memory is in the way");
#else
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("wide.exr");
  test::ExrRecipe recipe{16384, 512, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, {}, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, std::vector<float>(std::size_t{3} * 16384 * 512, 0.5F));
  ReadOptions options;
  options.layout = Layout::lat_long;
  const auto stream = [&] { return project_file(path, options).diagnostics.texels == 16384 * 512; };
  const auto stream_alone = [&] {
    bool success = false;
    run_with_threads(1, [&] { success = stream(); });
    return success;
  };
  call_once_before(directory);
  CHECK(succeeds_within(10 * kMebibyte, stream_alone));
  for (const int threads : {2, 4}) {
    std::optional<std::uint64_t> growth;
    run_with_threads(threads, [&] { growth = peak_growth([&] { CHECK(stream()); }); });
    if (!growth) {
      WARN("left out: the system does not tell a process its peak of memory");
      return;
    }
    CHECK(*growth < static_cast<std::uint64_t>(threads) * 10 * kMebibyte);  // the picture has 96 MiB as floats
  }
#endif
}

}  // namespace welkin
