// Promises: where the data window lies, how lines and tiles are ordered and which rows are asked for change no
// pixel.
#include <algorithm>
#include <random>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"

namespace welkin {
namespace {

test::ExrRecipe random_recipe(std::mt19937& random, int round) {
  const Imf::Compression compressions[] = {Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                                           Imf::PIZ_COMPRESSION};
  test::ExrRecipe recipe;
  recipe.height = 1 + static_cast<int>(random() % 90);
  recipe.width = 2 * recipe.height;
  recipe.first_column = static_cast<int>(random() % 4000) - 2000;
  recipe.first_row = static_cast<int>(random() % 4000) - 2000;
  if (round % 5 == 4) {  // nearly as far out as the format allows
    recipe.first_column = 1000000000;
    recipe.first_row = -1000000000;
  }
  recipe.compression = compressions[random() % 4];
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  if (round % 2 == 0) {
    recipe.line_order = random() % 2 == 0 ? Imf::INCREASING_Y : Imf::DECREASING_Y;
  } else {
    recipe.tiles =
        Imf::TileDescription(1 + static_cast<unsigned>(random() % 60), 1 + static_cast<unsigned>(random() % 60));
    recipe.line_order = static_cast<Imf::LineOrder>(random() % 3);
  }
  return recipe;
}

void check_any_rows(const codec::RowSource& source, const std::vector<float>& pixels, std::mt19937& random) {
  const auto reader = source.open_reader();
  const auto height = static_cast<unsigned>(source.info().height);
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(source.info().width);
  for (int attempt = 0; attempt < 8; ++attempt) {
    const auto first = random() % height;
    const auto count = 1 + random() % (height - first);
    std::vector<float> rows(count * row_floats + 1, -7.0F);
    reader->read(static_cast<int>(first), static_cast<int>(count), rows.data());
    REQUIRE(rows.back() == -7.0F);
    REQUIRE(std::equal(rows.begin(), rows.end() - 1, pixels.begin() + static_cast<std::ptrdiff_t>(first * row_floats)));
  }
}

}  // namespace

TEST_CASE("data windows, line orders and the rows that are asked for change no pixel", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("window.exr");
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    const test::ExrRecipe recipe = random_recipe(random, round);
    CAPTURE(round, recipe.width, recipe.first_column, recipe.first_row, recipe.line_order, recipe.compression);
    const std::vector<float> pixels = test::some_pixels(recipe.width, recipe.height, static_cast<unsigned>(round));
    test::write_exr(path, recipe, pixels);
    const Environment read = read_environment(path);
    REQUIRE(read.info.width == recipe.width);
    REQUIRE(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
    check_any_rows(*codec::open_row_source(path, {}), pixels, random);
  }
}

}  // namespace welkin
