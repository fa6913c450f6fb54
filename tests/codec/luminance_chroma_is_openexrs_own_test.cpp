// Promises: luminance and chroma come out as the very values that OpenEXR's RgbaInputFile gives, whichever rows are
// asked for, in whatever order, window, compression, part and layer.
#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <random>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"

namespace welkin {
namespace {

const Imf::Chromaticities kWide({0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F});

ReadOptions as_stored_lat_long() {
  ReadOptions options;
  options.layout = Layout::lat_long;
  options.primaries = Primaries::as_stored;
  return options;
}

test::ExrRecipe recipe_of(int width, int height, Imf::Compression compression = Imf::PIZ_COMPRESSION) {
  return {width, height, 0, 0, compression, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
}

void check_equal_to_library(const std::filesystem::path& path) {
  const std::vector<float> wanted = test::read_rgba_with_library(path);
  const Environment read = read_environment(path, as_stored_lat_long());
  REQUIRE(codec::rgb_bytes(read.info.width, read.info.height) == wanted.size() * sizeof(float));
  REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
}

}  // namespace

TEST_CASE("luminance and chroma become what OpenEXR makes of them", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("yc.exr");
  for (const auto& [width, height] : {std::pair{2, 2}, {4, 2}, {2, 40}, {64, 32}, {258, 130}}) {
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::DWAB_COMPRESSION}) {
      test::ExrRecipe recipe = recipe_of(width, height, compression);
      recipe.first_column = -6;
      recipe.first_row = height == 40 ? 1000 : -34;
      recipe.line_order = width == 64 ? Imf::DECREASING_Y : Imf::INCREASING_Y;
      if (width == 258) {
        recipe.adjust = [](Imf::Header& header) { Imf::addChromaticities(header, kWide); };
      }
      CAPTURE(width, height, compression);
      test::write_luminance_chroma_exr(path, recipe, test::some_pixels(width, height));
      check_equal_to_library(path);
    }
  }
}

TEST_CASE("any rows of luminance and chroma are those of the whole", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("yc.exr");
  test::write_luminance_chroma_exr(path, recipe_of(32, 200), test::some_pixels(32, 200));
  const std::vector<float> wanted = test::read_rgba_with_library(path);
  const auto source = codec::open_row_source(path, as_stored_lat_long());
  const auto reader = source->open_reader();
  std::mt19937 random(3);
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::size_t first = random() % 200;
    const std::size_t count = 1 + random() % std::min<std::size_t>(200 - first, attempt % 2 == 0 ? 5 : 200);
    std::vector<float> rows(count * 96 + 1, -7.0F);
    reader->read(static_cast<int>(first), static_cast<int>(count), rows.data());
    REQUIRE(rows.back() == -7.0F);
    REQUIRE(std::equal(rows.begin(), rows.end() - 1, wanted.begin() + static_cast<std::ptrdiff_t>(first * 96)));
  }
}

TEST_CASE("luminance and chroma are read in layers and parts", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path plain = directory.file("plain.exr");
  const std::filesystem::path path = directory.file("parts.exr");
  const std::vector<float> pixels = test::some_pixels(64, 32);
  test::ExrRecipe recipe = recipe_of(64, 32);
  const auto channels = [](const std::string& prefix) {
    return std::vector<test::ExrChannel>{
        {prefix + "Y", Imf::HALF, 1, 1}, {prefix + "RY", Imf::HALF, 2, 0}, {prefix + "BY", Imf::HALF, 2, 2}};
  };
  recipe.channels = channels("");
  test::write_exr(plain, recipe, pixels);
  const std::vector<float> wanted = test::read_rgba_with_library(plain);
  test::ExrRecipe layered = recipe;
  layered.channels = channels("env.");
  test::ExrRecipe mask = recipe;
  mask.channels = {{"Y"}};
  test::write_exr_parts(path, {{"mask", mask, pixels}, {"light", layered, pixels}});
  const Environment read = read_environment(path);
  CHECK(read.info.layers == std::vector<std::string>{"env"});
  CHECK(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
}

}  // namespace welkin
