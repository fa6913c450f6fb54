// Promises: readers open a file anew; one that has become another picture meanwhile is refused, not read into memory
// that was made for the first.
#include <ImfTileDescription.h>

#include <vector>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

void write_png(const std::filesystem::path& path, const test::PngRecipe& recipe) {
  test::write_bytes(path, test::png_bytes(recipe, test::some_samples(recipe)));
}

void check_changed(const std::filesystem::path& path, const codec::RowSource& source) {
  const test::ThrownError error = test::thrown_by([&] { (void)source.open_reader(); });
  INFO(error.message);
  CHECK(error.code == ErrorCode::file_access);
  CHECK(error.says(path.string() + ": has changed while it was read; read it again"));
}

}  // namespace

TEST_CASE("a PNG that has become another one is not read", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  const test::PngRecipe first{8, 4};
  test::PngRecipe interlaced = first;
  interlaced.interlaced = true;
  const std::vector<test::PngRecipe> others{{64, 4}, {8, 32}, {8, 4, 16}, interlaced};
  for (const test::PngRecipe& other : others) {
    CAPTURE(other.width, other.height, other.bits, other.interlaced);
    write_png(path, first);
    const auto source = codec::open_row_source(path, {Layout::lat_long});
    write_png(path, other);
    check_changed(path, *source);
    write_png(path, first);
    (void)source->open_reader();
  }
}

TEST_CASE("a PNG that changes before a reader turns back is not read", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  write_png(path, {8, 4});
  const auto source = codec::open_row_source(path, {Layout::lat_long});
  const auto reader = source->open_reader();
  std::vector<float> rgb(std::size_t{3} * 8 * 4);
  reader->read(0, 4, rgb.data());
  write_png(path, {64, 4});
  CHECK(test::thrown_by([&] { reader->read(0, 4, rgb.data()); }).code == ErrorCode::file_access);
}

TEST_CASE("an OpenEXR file that has got other tiles is not read", "[codec][exr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  const auto write = [&](const Imf::TileDescription& tiles) {
    test::ExrRecipe recipe;
    recipe.width = 64;
    recipe.height = 32;
    recipe.tiles = tiles;
    recipe.channels = test::rgb_channels(Imf::HALF);
    test::write_exr(path, recipe, test::some_pixels(64, 32));
  };
  const Imf::TileDescription first(16, 16, Imf::MIPMAP_LEVELS);
  for (const Imf::TileDescription& other :
       {Imf::TileDescription(16, 32, Imf::MIPMAP_LEVELS), Imf::TileDescription(16, 8, Imf::MIPMAP_LEVELS),
        Imf::TileDescription(16, 16, Imf::ONE_LEVEL)}) {
    CAPTURE(other.ySize, other.mode);
    write(first);
    const auto source = codec::open_row_source(path, {});
    write(other);
    check_changed(path, *source);
    write(first);
    (void)source->open_reader();
  }
}

}  // namespace welkin
