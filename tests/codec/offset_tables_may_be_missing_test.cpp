// Promise: an OpenEXR file whose tables of offsets are all zero is read: some programs write such files
// (OpenImageIO 2.4 does with "textureformat"), and where the blocks are can be found without them.
#include <algorithm>
#include <cstring>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {

TEST_CASE("an OpenEXR file without its tables of offsets is read", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("no-table.exr");
  const std::vector<float> pixels = test::some_pixels(64, 32);
  test::ExrRecipe sky{64, 32, 0, 0, Imf::ZIPS_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  sky.channels = test::rgb_channels(Imf::FLOAT);
  test::ExrRecipe tiles = sky;
  const auto check = [&](std::size_t entries, const ReadOptions& options) {
    std::vector<char> bytes = test::read_bytes(path);
    // Tables lie before the first block, of which the lowest offset tells.
    std::size_t table = 0;
    for (std::size_t place = 8; place + 8 * entries <= bytes.size() && table == 0; ++place) {
      std::uint64_t offset = 0;
      std::memcpy(&offset, bytes.data() + place, sizeof(offset));
      table = offset == place + 8 * entries ? place : 0;
    }
    REQUIRE(table != 0);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table), 8 * entries, '\0');
    test::write_bytes(path, bytes);
    const Environment read = read_environment(path, options);
    CHECK(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
  };
  test::write_exr(path, sky, pixels);
  check(32, {});
  tiles.tiles = Imf::TileDescription(16, 16);
  test::write_exr(path, tiles, pixels);
  check(8, {});
  tiles.tiles = Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS);
  test::write_exr(path, tiles, pixels);
  check(8 + 2 + 1 + 1 + 1 + 1 + 1, {});
  test::write_exr_parts(path, {{"sky", sky, pixels}, {"tiles", tiles, pixels}});
  const std::vector<char> sound = test::read_bytes(path);
  for (const char* part : {"sky", "tiles"}) {
    test::write_bytes(path, sound);
    ReadOptions options;
    options.part = part;
    check(32 + 15, options);
  }
}

}  // namespace welkin
