// Promises: the levels of a mip or rip map are listed as the library has them, and the one that is asked for is read.
#include <ImfFrameBuffer.h>
#include <ImfTiledInputFile.h>

#include <algorithm>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"

namespace welkin {
namespace {

ReadOptions at_level(int level) {
  ReadOptions options;
  options.level = level;
  options.layout = Layout::lat_long;
  return options;
}

test::ExrRecipe recipe_of(int width, int height, const Imf::TileDescription& tiles) {
  test::ExrRecipe recipe{width, height, -3, 11, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, tiles, std::nullopt, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  return recipe;
}

std::vector<float> level_by_library(Imf::TiledInputFile& file, int level) {
  const Imath::Box2i window = file.dataWindowForLevel(level, level);
  const std::int64_t columns = file.levelWidth(level);
  const std::int64_t rows = file.levelHeight(level);
  std::vector<float> rgb(static_cast<std::size_t>(3 * columns * rows));
  Imf::FrameBuffer buffer;
  std::size_t component = 0;
  for (const char* name : {"R", "G", "B"}) {
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, static_cast<const void*>(rgb.data() + component++), window.min,
                                         columns, rows, 3 * sizeof(float)));
  }
  file.setFrameBuffer(buffer);
  file.readTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  return rgb;
}

}  // namespace

TEST_CASE("every level is read as the library reads it", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("levels.exr");
  for (const auto& [width, height] : {std::pair{64, 32}, {77, 35}, {3, 50}, {1, 1}}) {
    for (const Imf::LevelMode mode : {Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
      for (const Imf::LevelRoundingMode rounding : {Imf::ROUND_DOWN, Imf::ROUND_UP}) {
        CAPTURE(width, height, mode, rounding);
        const Imf::TileDescription tiles(13, 8, mode, rounding);
        test::write_exr(path, recipe_of(width, height, tiles), test::some_pixels(width, height));
        Imf::TiledInputFile file(path.c_str(), 0);
        const int count = std::min(file.numXLevels(), file.numYLevels());
        const EnvironmentInfo info = inspect_environment(path, at_level(0));
        REQUIRE(info.levels.size() == static_cast<std::size_t>(count));
        CHECK(info.storage == (mode == Imf::MIPMAP_LEVELS ? "mip-mapped tiles 13 x 8" : "rip-mapped tiles 13 x 8"));
        for (int level = 0; level < count; ++level) {
          const Environment read = read_environment(path, at_level(level));
          REQUIRE(info.levels[static_cast<std::size_t>(level)].width == file.levelWidth(level));
          REQUIRE(info.levels[static_cast<std::size_t>(level)].height == file.levelHeight(level));
          REQUIRE(read.info.width == file.levelWidth(level));
          REQUIRE(read.info.height == file.levelHeight(level));
          const std::vector<float> wanted = level_by_library(file, level);
          REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
          REQUIRE((wanted[0] == -99.0F) == (level > 0));
        }
      }
    }
  }
}

TEST_CASE("a file without a chain has one level", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("levels.exr");
  test::write_exr(path, recipe_of(64, 32, Imf::TileDescription(8, 8)), test::some_pixels(64, 32));
  const EnvironmentInfo info = inspect_environment(path);
  REQUIRE(info.levels.size() == 1);
  CHECK(info.levels[0].width == 64);
  CHECK(info.storage == "tiled 8 x 8");
}

TEST_CASE("a level that is not there is an error that says how many there are", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("levels.exr");
  const auto message = [&](int level) {
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, at_level(level)); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  test::write_exr(path, recipe_of(64, 32, Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS)), test::some_pixels(64, 32));
  CHECK(message(7) == path.string() + ": has no level 7; it has 7: pass --level 0 to 6");
  CHECK(message(-1) == path.string() + ": has no level -1; it has 7: pass --level 0 to 6");
  test::write_exr(path, recipe_of(64, 32, Imf::TileDescription(8, 8)), test::some_pixels(64, 32));
  CHECK(message(1) == path.string() + ": has no level 1; it has one, level 0: leave --level out");
}

TEST_CASE("the levels of a cube are cubes, down to faces of one texel", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("levels.exr");
  test::ExrRecipe recipe = recipe_of(8, 48, Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
  recipe.envmap = Imf::ENVMAP_CUBE;
  test::write_exr(path, recipe, test::some_pixels(8, 48));
  ReadOptions options;
  for (options.level = 0; options.level < 4; ++options.level) {
    const Environment cube = read_environment(path, options);
    CHECK(cube.info.width == 8 >> options.level);
    CHECK(cube.info.layout_reason == "the header's envmap attribute says cube");
    CHECK(codec::open_row_source(path, options)->has_openexr_cube_frames());
  }
  CHECK(test::thrown_by([&] { (void)inspect_environment(path, options); }).says("1 x 3 is not a 1:6 vertical strip"));
}

}  // namespace welkin
