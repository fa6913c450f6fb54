// Promises: R, G and B are found by name among whatever other channels there are; Y alone is grey.
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {

TEST_CASE("R, G and B are found among other channels, whatever those are", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("channels.exr");
  const std::vector<float> pixels = test::some_pixels(32, 16);
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = {{"R", Imf::FLOAT, 1, 0},    {"G", Imf::HALF, 1, 1},        {"B", Imf::FLOAT, 1, 2},
                     {"A", Imf::HALF, 1, 0},     {"Z", Imf::FLOAT, 1, 1},       {"id", Imf::UINT, 1, 2},
                     {"sky.R", Imf::HALF, 1, 2}, {"half.size", Imf::HALF, 2, 0}};
  test::write_exr(path, recipe, pixels);
  const Environment read = read_environment(path);
  REQUIRE(read.info.channels.size() == 8);
  CHECK(read.info.channels[0].name == "A");
  CHECK(read.info.channels[0].type == "half");
  CHECK(read.info.channels[5].name == "half.size");
  CHECK(read.info.channels[6].name == "id");
  CHECK(read.info.channels[6].type == "uint");
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    REQUIRE(read.pixels[i] == (i % 3 == 1 ? test::as_half(pixels[i]) : pixels[i]));
  }
}

TEST_CASE("Y alone becomes grey, scanline and tiled", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("grey.exr");
  const std::vector<float> pixels = test::some_pixels(32, 16);
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(8, 8)}}) {
    test::ExrRecipe recipe{32, 16, 5, -3, Imf::PIZ_COMPRESSION, Imf::INCREASING_Y, tiles, std::nullopt, {}};
    recipe.channels = {{"Y", Imf::FLOAT, 1, 1}};
    test::write_exr(path, recipe, pixels);
    const Environment read = read_environment(path);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      REQUIRE(read.pixels[i] == pixels[i / 3 * 3 + 1]);
    }
  }
}

}  // namespace welkin
