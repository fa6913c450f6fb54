// Promises: a file that is cut off anywhere, or has any byte of its header changed, is either read or refused with an
// Error. Nothing else happens.
#include <algorithm>
#include <cstring>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"

namespace welkin {
namespace {

struct Tally {
  int loaded = 0;
  int refused = 0;
};

// Whatever but an Error comes out of this fails the test.
void try_to_read(const std::filesystem::path& path, Tally& tally) {
  ReadOptions options;
  options.memory_limit_bytes = std::uint64_t{16} << 20U;
  try {
    (void)read_environment(path, options);
    (void)measure_environment(path, options);
    ++tally.loaded;
  } catch (const Error& error) {
    REQUIRE(std::string(error.what()).find(path.string()) == 0);
    ++tally.refused;
  }
}

void check_truncations(const std::filesystem::path& path, const std::vector<char>& sound) {
  Tally tally;
  for (std::size_t size = 0; size < sound.size(); ++size) {
    test::write_bytes(path, {sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size)});
    try_to_read(path, tally);
  }
  CHECK(tally.loaded == 0);
  test::write_bytes(path, sound);
  try_to_read(path, tally);
  CHECK(tally.loaded == 1);
}

void check_changed_bytes(const std::filesystem::path& path, const std::vector<char>& sound, std::size_t bytes) {
  Tally tally;
  for (std::size_t place = 0; place < std::min(bytes, sound.size()); ++place) {
    for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
      std::vector<char> damaged = sound;
      damaged[place] = static_cast<char>(value);
      test::write_bytes(path, damaged);
      try_to_read(path, tally);
    }
  }
  CHECK(tally.loaded > 0);
  CHECK(tally.refused > 0);
}

std::vector<char> small_exr(const std::filesystem::path& path, Imf::Compression compression,
                            const std::optional<Imf::TileDescription>& tiles) {
  test::ExrRecipe recipe{8, 4, 0, 0, compression, Imf::INCREASING_Y, tiles, Imf::ENVMAP_LATLONG, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, test::some_pixels(8, 4));
  return test::read_bytes(path);
}

}  // namespace

TEST_CASE("an OpenEXR file that is cut off is refused, wherever the cut is", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cut.exr");
  check_truncations(path, small_exr(path, Imf::ZIP_COMPRESSION, std::nullopt));
  check_truncations(path, small_exr(path, Imf::PIZ_COMPRESSION, Imf::TileDescription(4, 4)));
}

TEST_CASE("a PFM file that is cut off is refused, wherever the cut is", "[codec]") {
  const test::TemporaryDirectory directory;
  check_truncations(directory.file("cut.pfm"), test::pfm_bytes(8, 4, false, "-1", test::some_pixels(8, 4)));
  check_truncations(directory.file("cut.pfm"), test::pfm_bytes(8, 4, true, "1", test::some_pixels(8, 4)));
}

TEST_CASE("no changed byte of an OpenEXR file does harm", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("changed.exr");
  for (const Imf::Compression compression : {Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    const std::vector<char> scanline = small_exr(path, compression, std::nullopt);
    check_changed_bytes(path, scanline, scanline.size());
    const std::vector<char> tiled = small_exr(path, compression, Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
    check_changed_bytes(path, tiled, tiled.size());
  }
}

TEST_CASE("no changed byte of a PFM file does harm", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::vector<char> sound = test::pfm_bytes(8, 4, false, "-1", test::some_pixels(8, 4));
  check_changed_bytes(directory.file("changed.pfm"), sound, sound.size());
}

TEST_CASE("an OpenEXR file without its table of offsets is read", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("no-table.exr");
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(16, 16)}}) {
    test::ExrRecipe recipe{64, 32, 0, 0, Imf::ZIPS_COMPRESSION, Imf::INCREASING_Y, tiles, std::nullopt, {}};
    recipe.channels = test::rgb_channels(Imf::FLOAT);
    const std::vector<float> pixels = test::some_pixels(64, 32);
    test::write_exr(path, recipe, pixels);
    std::vector<char> bytes = test::read_bytes(path);
    // The first chunk's offset, as the table's first entry holds it, is where the table ends.
    const std::size_t entries = tiles ? 8 : 32;
    std::size_t table = 0;
    for (std::size_t place = 8; place + 8 * entries <= bytes.size() && table == 0; ++place) {
      std::uint64_t offset = 0;
      std::memcpy(&offset, bytes.data() + place, sizeof(offset));
      if (offset == place + 8 * entries) {
        table = place;
      }
    }
    REQUIRE(table != 0);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table), 8 * entries, '\0');
    test::write_bytes(path, bytes);
    const Environment read = read_environment(path);
    CHECK(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
  }
}

}  // namespace welkin
