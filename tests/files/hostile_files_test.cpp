// Files that are damaged or lie do no harm and cost no memory.
#include <malloc.h>

#include "support/catch.h"
#include "support/chains.h"
#include "support/damaged_files.h"
#include "support/exr_files.h"
#include "support/heap.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "support/webp_env.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: an image, texture or .env that is cut off anywhere, has any byte changed, or any field of its header set
// to an extreme, is either read or refused with an Error that names it. Nothing else happens.

namespace {

constexpr std::uint64_t kLimit = std::uint64_t{16} << 20U;

using Calls = std::vector<std::function<void(const std::filesystem::path&)>>;

/// Returns the calls that read a file of an extension.
Calls calls_for(const std::string& extension) {
  const auto read = [](const auto& path) { (void)read_environment(path, {.memory_limit_bytes = kLimit}); };
  if (extension == ".env") return {[](const auto& path) { (void)read_babylon_environment(path, kLimit); }, read};
  if (extension == ".ktx2" || extension == ".dds") {
    return {[](const auto& path) { (void)read_texture(path, kLimit); }, read};
  }
  return {[read](const auto& path) {
    read(path);
    (void)measure_environment(path, {.memory_limit_bytes = kLimit});
  }};
}

using Damage = void (*)(const SoundFile&, const Use&);

/// Checks that calls on damaged files succeed or throw an Error that names the file.
void check_damage(const std::vector<SoundFile>& files, Damage damage, bool may_load) {
  const TemporaryDirectory directory;
  for (const SoundFile& sound : files) {
    CAPTURE(sound.name);
    const std::filesystem::path path = directory.file(sound.name);
    const Calls calls = calls_for(path.extension().string());
    std::size_t loaded = 0;
    std::size_t refused = 0;
    const auto try_to_read = [&](const std::vector<char>& bytes) {
      std::filesystem::remove(path);  // ext4 waits for the disk when a file is overwritten, not when it is new
      write_bytes(path, bytes);
      for (const auto& call : calls) {
        try {
          call(path);
          ++loaded;
        } catch (const Error& error) {
          if (std::string(error.what()).find(path.string()) != 0) FAIL("no file is named in: " << error.what());
          ++refused;
        }
      }
    };
    try_to_read(sound.bytes);
    REQUIRE(loaded == calls.size());
    damage(sound, try_to_read);
    if (!may_load && sound.all_is_read) CHECK(loaded == calls.size());
    CHECK(refused > 0);
  }
}

/// Damaged up to `header_bytes`; its fields are words.
SoundFile texture(const std::string& name, std::size_t header_bytes, const TextureOptions& options) {
  const TemporaryDirectory directory;
  write_texture(directory.file(name), noisy_chain(3, 2).views(), options);
  SoundFile file{name, read_bytes(directory.file(name))};
  file.header_bytes = std::min(file.bytes.size(), header_bytes);
  file.fields_changed.step = 4;
  return file;
}

/// Its manifest is damaged, a text without fields, and the first of its images, which are all alike.
SoundFile env_of(const std::string& name, const std::vector<char>& bytes) {
  const auto payload = static_cast<std::size_t>(std::find(bytes.begin() + 8, bytes.end(), '\0') - bytes.begin()) + 1;
  SoundFile file{name, bytes};
  file.header_bytes = std::min(bytes.size(), payload + 200);
  file.bytes_changed.step = 6;
  file.fields_changed.first = payload;
  return file;
}

std::vector<char> env_bytes() {
  BabylonEnvironment environment;
  environment.specular = noisy_chain(2, 2);
  environment.polynomial = BabylonPolynomial{};
  environment.irradiance = {1, std::vector<float>(18, 0.5F)};
  const TemporaryDirectory directory;
  write_babylon_environment(directory.file("sky.env"), environment);
  return read_bytes(directory.file("sky.env"));
}

std::vector<SoundFile> sound_textures() {
  return {texture("sky.ktx2", 500, {}),
          texture("zlib.ktx2", 500, {TexelFormat::b10g11r11, Supercompression::zlib, {{"key", "value"}}}),
          texture("zstd.ktx2", 500, {TexelFormat::e5b9g9r9, Supercompression::zstd, {}}),
          texture("sky.dds", 500, {}),
          env_of("sky.env", env_bytes()),
          env_of("webp.env", with_webp_images(env_bytes()))};
}

/// Small images of all formats, or of those whose extensions `wanted` holds for.
std::vector<SoundFile> sound_images(const std::function<bool(const std::string& extension)>& wanted = {}) {
  const TemporaryDirectory directory;
  std::vector<SoundFile> files = sound_files(directory.path());
  std::erase_if(files, [&](const SoundFile& file) {
    return wanted && !wanted(std::filesystem::path(file.name).extension().string());
  });
  return files;
}

}  // namespace

TEST_CASE("a file that is cut off is refused, wherever the cut is", "[codec][textures][damage][slow]") {
  const auto is_png = [](const std::string& extension) { return extension == ".png"; };
  check_damage(sound_images(std::not_fn(is_png)), for_each_truncation, false);
  check_damage(sound_images(is_png), for_each_truncation, true);  // nothing that is needed follows the last row
  check_damage(sound_textures(), for_each_truncation, false);
}

TEST_CASE("no changed byte does harm", "[codec][textures][damage][slow]") {
  check_damage(sound_images(), for_each_changed_byte, true);
  check_damage(sound_textures(), for_each_changed_byte, true);
}

TEST_CASE("no extreme number in a header of text does harm", "[codec][env][damage][slow]") {
  const auto is_text = [](const std::string& extension) { return extension == ".pfm" || extension == ".hdr"; };
  check_damage(sound_images(is_text), for_each_extreme_number, true);
  check_damage({env_of("sky.env", env_bytes())}, for_each_extreme_number, true);
}

TEST_CASE("no extreme field of a file does harm", "[codec][textures][damage][slow]") {
  check_damage(sound_images(), for_each_extreme_field, true);
  check_damage(sound_textures(), for_each_extreme_field, true);
}

// Promises: what a header claims costs no memory; a streamed image needs a few blocks a thread.

// A sanitizer's memory would distort the memory that a process takes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WELKIN_SANITIZED
#endif

namespace {

using namespace std::string_literals;
const std::string kTiles = "tiles\0tiledesc\0"s;
const std::string kDataWindow = "dataWindow\0box2i\0"s;

// Puts a 32-bit value behind the first place where `name` and a type stand as attribute.
void patch_attribute(std::vector<char>& bytes, const std::string& name_and_type, std::size_t offset,
                     std::uint32_t value) {
  const auto found = std::search(bytes.begin(), bytes.end(), name_and_type.begin(), name_and_type.end());
  REQUIRE(found != bytes.end());
  const auto index = found - bytes.begin() + static_cast<std::ptrdiff_t>(name_and_type.size() + offset);
  std::memcpy(bytes.data() + index, &value, sizeof(value));
}

std::vector<char> tiled_exr(const std::filesystem::path& path, Imf::LevelMode mode = Imf::ONE_LEVEL) {
  write_exr(path, {.width = 64, .height = 32, .tiles = Imf::TileDescription(16, 16, mode)}, some_pixels(64, 32));
  return read_bytes(path);
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

#ifndef WELKIN_SANITIZED

// "VmRSS:" or "VmHWM:" of this process, in bytes.
std::uint64_t memory_by_status(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == key && status >> kibibytes) return kibibytes << 10U;
  }
  return 0;
}

// Returns the growth of the peak memory in use during `work`, or nothing if the system does not report it.
std::optional<std::uint64_t> peak_growth(const std::function<void()>& work) {
  malloc_trim(0);
  const std::uint64_t before = memory_by_status("VmRSS:");
  {
    std::ofstream reset("/proc/self/clear_refs");
    reset << "5";  // proc(5): resets the peak to the memory in use now
    if (!reset.flush()) return std::nullopt;
  }
  if (before == 0 || memory_by_status("VmHWM:") > before + (before >> 6U)) return std::nullopt;
  work();
  const std::uint64_t peak = memory_by_status("VmHWM:");
  return peak > before ? peak - before : 0;
}

// Makes the first call of a process, whose setup (oneTBB, kernels, OpenEXR, code) does not depend on the image's size.
void call_once_before(const TemporaryDirectory& directory) {
  const std::filesystem::path exr = directory.file("small.exr");
  static_cast<void>(tiled_exr(exr));
  const std::filesystem::path pfm = directory.file("small.pfm");
  const std::string header = "PF\n64 32\n-1\n";
  write_bytes(pfm, {header.begin(), header.end()});
  std::filesystem::resize_file(pfm, header.size() + std::size_t{64} * 32 * 12);
  for (const auto& path : {exr, pfm}) {
    run_with_threads(1, [&] { static_cast<void>(project_file(path)); });
  }
}

#endif

}  // namespace

TEST_CASE("what an OpenEXR header claims costs no memory", "[codec]") {
  const TemporaryFile path("claims.exr");
  const std::vector<char> sound = tiled_exr(path);
  const auto check = [&](const std::function<void(std::vector<char>&)>& damage) {
    std::vector<char> bytes = sound;
    damage(bytes);
    write_bytes(path, bytes);
    const HeapWatch watch;
    CHECK(is_refused_for_itself(path));
    CHECK(watch.peak_bytes() < static_cast<long>(64 * kMebibyte));
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
  check([](auto& bytes) {  // an image as large as integers go
    patch_attribute(bytes, kDataWindow, 4, 0xc0000002);
    patch_attribute(bytes, kDataWindow, 12, 0x3ffffffe);
  });
  check([](auto& bytes) { patch_attribute(bytes, "lineOrder\0lineOrder\0"s, 0, 0x7fffffff); });
  check([](auto& bytes) { patch_attribute(bytes, "channels\0chlist\0"s, 0, 0x7fffffff); });
  check([](auto& bytes) {  // a long opaque attribute where a short one was
    const std::string name = "lineOrder\0lineOrder\0"s;
    const auto index = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
    std::copy_n("lineOrder\0something\0", name.size(), index);
    patch_attribute(bytes, "lineOrder\0something\0"s, 0, 0x7ffffff0);
  });
}

TEST_CASE("a packed level that is none costs no memory", "[codec][textures]") {
  const TemporaryFile path("claims.ktx2");
  const auto refusal_of = [&](const std::vector<char>& sound, const std::vector<std::uint8_t>& begin,
                              std::size_t payload) {
    std::vector<char> bytes(sound.begin(), sound.begin() + 104);  // the header, and a level index of one level
    const auto set = [&bytes](std::size_t index, auto value) {
      std::memcpy(bytes.data() + index, &value, sizeof value);
    };
    constexpr std::uint32_t size = 2048;
    set(20, size);
    set(24, size);
    set(48, std::array<std::uint32_t, 4>{104, 0, 104, 0});  // neither descriptor nor key/value data
    set(80, std::array<std::uint64_t, 3>{104, payload, std::uint64_t{6} * size * size * 8});
    bytes.insert(bytes.end(), begin.begin(), begin.end());
    for (std::uint32_t state = 1; bytes.size() < 104 + payload; state = 1664525U * state + 1013904223U) {
      bytes.push_back(static_cast<char>(state >> 24U));
    }
    write_bytes(path, bytes);
    for (const auto& call :
         std::vector<std::function<void()>>{[&] { (void)inspect_environment(path); }, [&] { (void)read_texture(path); },
                                            [&] { (void)project_file(path); }}) {
      const HeapWatch watch;
      const ThrownError error = thrown_by(call);
      CHECK(error.says("has a level that does not unpack"));
      CHECK(error.code == ErrorCode::corrupt_file);
      CHECK(watch.peak_bytes() < long{2} << 20U);
    }
  };
  write_texture(path, noisy_chain(16, 1).views(), {.supercompression = Supercompression::zstd});
  const std::vector<char> zstd = read_bytes(path);
  refusal_of(zstd, {}, 24824);
  // A frame of the size that the index says, whose first block is noise.
  refusal_of(zstd, {0x28, 0xB5, 0x2F, 0xFD, 0xE0, 0, 0, 0, 12, 0, 0, 0, 0, 0x04, 0x80, 0x00}, 24824);
  // A frame of one byte more
  refusal_of(zstd, {0x28, 0xB5, 0x2F, 0xFD, 0xE0, 1, 0, 0, 12, 0, 0, 0, 0}, 24824);
  write_texture(path, noisy_chain(16, 1).views(), {.supercompression = Supercompression::zlib});
  const std::vector<char> zlib = read_bytes(path);
  refusal_of(zlib, {}, 400000);
  refusal_of(zlib, {0x78, 0x9C}, 400000);
}

TEST_CASE("sizes that multiply past 64 bits are refused", "[codec]") {
  const TemporaryFile path("product.exr");
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    for (const std::uint32_t corner : {0x3ffffffeU, 0x7ffffffeU, 0x7fffffffU}) {
      std::vector<char> bytes = tiled_exr(path, mode);
      for (const std::string& window : {kDataWindow, "displayWindow\0box2i\0"s}) {
        for (const std::size_t offset : {4U, 8U}) {
          patch_attribute(bytes, window, offset, 0U - corner);
          patch_attribute(bytes, window, offset + 8, corner);
        }
      }
      for (const std::uint32_t edge : {1U, 0x7fffffffU, 0xffffffffU}) {
        patch_attribute(bytes, kTiles, 4, edge);
        patch_attribute(bytes, kTiles, 8, edge);
        write_bytes(path, bytes);
        CHECK(thrown_by([&] { (void)inspect_environment(path); }).says(path.string()));
      }
    }
  }
}

TEST_CASE("a 16384 x 8192 lat-long is projected in 4 MiB", "[codec][streaming][slow]") {
#ifdef WELKIN_SANITIZED
  WARN("left out: a sanitizer's own memory is in the way");
#else
  // 1.5 GiB of zeros that take no room on the disk, and one row of ones.
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("vast.pfm");
  const std::string header = "PF\n16384 8192\n-1\n";
  const std::uint64_t row_bytes = 16384 * 12;
  write_bytes(path, {header.begin(), header.end()});
  std::filesystem::resize_file(path, header.size() + 8192 * row_bytes);
  {
    const std::vector<float> ones(row_bytes / 4, 1.0F);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(header.size() + 4096 * row_bytes));
    file.write(reinterpret_cast<const char*>(ones.data()), static_cast<std::streamsize>(row_bytes));
    REQUIRE(file.good());
  }
  call_once_before(directory);
  // Measured is memory in use, not address space: a huge page's block reserves twice its size to begin at a multiple.
  std::optional<Projection> light;
  std::optional<std::uint64_t> growth;
  run_with_threads(1, [&] { growth = peak_growth([&] { light = project_file(path); }); });
  const double row = 2.0 * 3.14159265358979 * 3.14159265358979 / 8192.0;  // steradians of one row at the horizon
  CHECK(light->diagnostics.texels == std::uint64_t{16384} * 8192);
  CHECK(std::abs(light->diagnostics.total_radiance.g / row - 1.0) < 1e-6);
  if (!growth) {
    WARN("left out: the system does not tell a process its peak of memory");
    return;
  }
  constexpr std::uint64_t kLag = std::uint64_t{64} << 12U;  // Linux counts a thread's pages 64 at a time
  CHECK(*growth < 4 * kMebibyte + kLag);
#endif
}

TEST_CASE("rows of 16384 texels in compressed blocks take 10 MiB for each thread", "[codec][streaming][slow]") {
#ifdef WELKIN_SANITIZED
  WARN("left out: a sanitizer's own memory is in the way");
#else
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("wide.exr");
  write_exr(path, {.width = 16384, .height = 512}, std::vector<float>(std::size_t{3} * 16384 * 512, 0.5F));
  ReadOptions options{.layout = Layout::lat_long};
  const auto stream = [&] { return project_file(path, options).diagnostics.texels == 16384 * 512; };
  const auto measure = [&] { return measure_environment(path, options).texels == 16384 * 512; };
  call_once_before(directory);
  // In use, as above. The image has 96 MiB as floats.
  const auto takes_less_than = [](std::uint64_t bytes, int threads, const std::function<bool()>& work) {
    std::optional<std::uint64_t> growth;
    bool success = false;
    run_with_threads(threads, [&] { growth = peak_growth([&] { success = work(); }); });
    if (!growth) WARN("not measured: the system does not tell a process its peak of memory");
    return success && growth.value_or(0) < bytes;
  };
  CHECK(takes_less_than(12 * kMebibyte, 1, stream));  // with what the first one sets up, maybe a huge page of 2 MiB
  for (const int threads : {1, 2, 4}) {
    CHECK(takes_less_than(static_cast<std::uint64_t>(threads) * 10 * kMebibyte, threads, stream));
  }
  CHECK(takes_less_than(24 * kMebibyte, 1, measure));
#endif
}

}  // namespace welkin::test
