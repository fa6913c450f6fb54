// Promises: every OpenEXR compression is read, half and float, scanline and tiled, to the values that the OpenEXR
// library itself gives; lossless ones to the very values that were written.
#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

struct Compression {
  Imf::Compression id;
  const char* name;
  bool lossless_for_half;
  bool lossless_for_float;
};

const Compression kCompressions[] = {
    {Imf::NO_COMPRESSION, "none", true, true},     {Imf::RLE_COMPRESSION, "rle", true, true},
    {Imf::ZIPS_COMPRESSION, "zips", true, true},   {Imf::ZIP_COMPRESSION, "zip", true, true},
    {Imf::PIZ_COMPRESSION, "piz", true, true},     {Imf::PXR24_COMPRESSION, "pxr24", true, false},
    {Imf::B44_COMPRESSION, "b44", false, true},    {Imf::B44A_COMPRESSION, "b44a", false, true},
    {Imf::DWAA_COMPRESSION, "dwaa", false, false}, {Imf::DWAB_COMPRESSION, "dwab", false, false},
};

const std::optional<Imf::TileDescription> kTilings[] = {
    std::nullopt,
    Imf::TileDescription(16, 16, Imf::ONE_LEVEL),
    Imf::TileDescription(48, 40, Imf::ONE_LEVEL),
    Imf::TileDescription(300, 200, Imf::ONE_LEVEL),
    Imf::TileDescription(16, 32, Imf::MIPMAP_LEVELS, Imf::ROUND_UP),
    Imf::TileDescription(32, 16, Imf::RIPMAP_LEVELS),
};

std::string storage(const std::optional<Imf::TileDescription>& tiles) {
  if (!tiles) {
    return "scanline";
  }
  const std::string kind = tiles->mode == Imf::MIPMAP_LEVELS   ? "mip-mapped tiles "
                           : tiles->mode == Imf::RIPMAP_LEVELS ? "rip-mapped tiles "
                                                               : "tiled ";
  return kind + std::to_string(tiles->xSize) + " x " + std::to_string(tiles->ySize);
}

void check_values(const Environment& read, const std::filesystem::path& path, const test::ExrRecipe& recipe,
                  const std::vector<float>& written, bool lossless) {
  const std::vector<float> by_library = test::read_exr_with_library(path);
  REQUIRE(std::equal(by_library.begin(), by_library.end(), read.pixels.get()));
  double worst = 0.0;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const float wanted = recipe.channels[0].type == Imf::HALF ? test::as_half(written[i]) : written[i];
    if (lossless) {
      REQUIRE(read.pixels[i] == wanted);
    }
    worst = std::max(worst, static_cast<double>(std::abs(read.pixels[i] - wanted) / wanted));
  }
  CHECK(worst < 0.35);
}

}  // namespace

TEST_CASE("every OpenEXR compression is read, half and float, scanline and tiled", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  const int width = 130;
  const int height = 65;
  const std::vector<float> pixels = test::some_pixels(width, height);
  for (const Compression& compression : kCompressions) {
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
      for (const auto& tiles : kTilings) {
        CAPTURE(compression.name, type, tiles.has_value());
        test::ExrRecipe recipe{width, height, 0, 0, compression.id, Imf::INCREASING_Y, tiles, std::nullopt, {}};
        recipe.channels = test::rgb_channels(type);
        test::write_exr(path, recipe, pixels);
        const Environment read = read_environment(path);
        CHECK(read.info.compression == compression.name);
        CHECK(read.info.storage == storage(tiles));
        REQUIRE(read.info.width == width);
        REQUIRE(read.info.height == height);
        check_values(read, path, recipe, pixels,
                     type == Imf::HALF ? compression.lossless_for_half : compression.lossless_for_float);
      }
    }
  }
}

}  // namespace welkin
