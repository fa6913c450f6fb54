// Promises: overscan is cut off and a crop is put back in its place where the display window has a layout's shape;
// otherwise the data window is the picture.
#include <ImfHeader.h>

#include <algorithm>
#include <random>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"

namespace welkin {
namespace {

struct Window {
  int left, top, width, height;
};

test::ExrRecipe recipe_of(const Window& data, const Window& display) {
  test::ExrRecipe recipe{data.width,        data.height,  data.left,    data.top, Imf::ZIP_COMPRESSION,
                         Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  recipe.adjust = [display](Imf::Header& header) {
    header.displayWindow() = Imath::Box2i(
        {display.left, display.top},
        {static_cast<int>(std::int64_t{display.left} + display.width - 1), display.top + display.height - 1});
  };
  return recipe;
}

// What is inside of both windows, on black.
std::vector<float> framed(const std::vector<float>& stored, const Window& data, const Window& display) {
  std::vector<float> picture;
  for (int y = display.top; y < display.top + display.height; ++y) {
    for (int x = display.left; x < display.left + display.width; ++x) {
      const bool inside = x >= data.left && x < data.left + data.width && y >= data.top && y < data.top + data.height;
      for (int i = 0; i < 3; ++i) {
        picture.push_back(
            inside ? stored[static_cast<std::size_t>(3 * ((y - data.top) * data.width + x - data.left) + i)] : 0.0F);
      }
    }
  }
  return picture;
}

bool says(const EnvironmentInfo& info, const std::string& words) {
  return std::any_of(info.notes.begin(), info.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("overscan is cut off and crops are put back, in any rows", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("window.exr");
  std::mt19937 random(5);
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low));
  };
  for (int round = 0; round < 60; ++round) {
    const Window display{between(-50, 50), between(-50, 50), 80, 40};
    const Window data{display.left + between(-30, 70), display.top + between(-25, 35), between(25, 120),
                      between(25, 70)};
    if ((data.width == 80 && data.height == 40) || data.left + data.width <= display.left ||
        data.top + data.height <= display.top || 3 * data.width == 4 * data.height ||
        4 * data.width == 3 * data.height) {
      continue;
    }
    CAPTURE(round, display.left, display.top, data.left, data.top, data.width, data.height);
    test::ExrRecipe recipe = recipe_of(data, display);
    if (round % 2 == 0) {
      recipe.tiles = Imf::TileDescription(16, 9);
    }
    const std::vector<float> stored = test::some_pixels(data.width, data.height);
    test::write_exr(path, recipe, stored);
    const std::vector<float> wanted = framed(stored, data, display);
    const Environment read = read_environment(path);
    REQUIRE(read.info.width == 80);
    REQUIRE(read.info.height == 40);
    REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
    const bool cut = data.left < display.left || data.top < display.top || data.left + data.width > display.left + 80 ||
                     data.top + data.height > display.top + 40;
    const bool lacking = data.left > display.left || data.top > display.top ||
                         data.left + data.width < display.left + 80 || data.top + data.height < display.top + 40;
    REQUIRE(says(read.info, "overscan cut off") == cut);
    REQUIRE(says(read.info, "black where nothing is stored") == lacking);
    const int first = between(0, 40);
    const int count = between(1, 41 - first);
    std::vector<float> rows(static_cast<std::size_t>(count) * 240);
    const auto source = codec::open_row_source(path, {});
    source->open_reader()->read(first, count, rows.data());
    REQUIRE(std::equal(rows.begin(), rows.end(), wanted.begin() + first * 240));
  }
}

TEST_CASE("the data window is the picture where the display window is no frame", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("window.exr");
  const auto size_read = [&](const test::ExrRecipe& recipe, const ReadOptions& options = {}) {
    test::write_exr(path, recipe, test::some_pixels(recipe.width, recipe.height));
    const EnvironmentInfo info = inspect_environment(path, options);
    return std::pair{info.width, info.height};
  };
  using Size = std::pair<int, int>;
  const Window data{0, 0, 64, 32};
  CHECK(size_read(recipe_of(data, {0, 0, 100, 70})) == Size{64, 32});   // of no layout's shape
  CHECK(size_read(recipe_of(data, {100, 0, 80, 40})) == Size{64, 32});  // elsewhere
  CHECK(size_read(recipe_of(data, {20, 5, 64, 32})) == Size{64, 32});   // moved, but of the same size
  CHECK(size_read(recipe_of(data, {0, 0, 80, 60})) == Size{64, 32});    // of another layout than the data has
  CHECK(size_read(recipe_of({0, 0, 8, 48}, {0, 0, 80, 40})) == Size{8, 48});
  CHECK(size_read(recipe_of(data, {0, 0, 80, 40})) == Size{80, 40});
  test::ExrRecipe stated = recipe_of(data, {0, 0, 80, 40});
  stated.envmap = Imf::ENVMAP_LATLONG;
  CHECK(size_read(stated) == Size{64, 32});
  test::ExrRecipe mipped = recipe_of(data, {0, 0, 80, 40});
  mipped.tiles = Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS);
  CHECK(size_read(mipped) == Size{64, 32});
  CHECK(says(inspect_environment(path), "") == false);
  ReadOptions as_lat_long;
  as_lat_long.layout = Layout::lat_long;
  CHECK(size_read(recipe_of({-5, 0, 60, 45}, {0, 0, 80, 40}), as_lat_long) == Size{80, 40});
  CHECK(size_read(recipe_of({-5, 0, 61, 45}, {0, 0, 80, 60}), as_lat_long) == Size{61, 45});
  CHECK(says(inspect_environment(path, as_lat_long), "the data window of 61 x 45 is the picture"));
}

TEST_CASE("a few texels in a vast display window are refused", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("window.exr");
  const auto message = [&](const Window& display) {
    test::write_exr(path, recipe_of({5, 5, 30, 20}, display), test::some_pixels(30, 20));
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  CHECK(message({0, 0, 65536, 32768}) == path.string() +
                                             ": stores 30 x 20 texels of a display window of 65536 x 32768, less than "
                                             "a 64th; save it with the display window that is meant");
  CHECK(message({0, 0, 200000, 100000}).find("its display window of 200000 x 100000 is larger than any layout holds") !=
        std::string::npos);
}

}  // namespace welkin
