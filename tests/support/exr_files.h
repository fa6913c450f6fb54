// OpenEXR files of every kind, made on the spot with the OpenEXR library, and read back by it alone.
#pragma once

#include <ImfCompression.h>
#include <ImfEnvmap.h>
#include <ImfLineOrder.h>
#include <ImfPixelType.h>
#include <ImfTileDescription.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace welkin::test {

struct ExrChannel {
  std::string name;
  Imf::PixelType type = Imf::HALF;
  int sampling = 1;   ///< in both directions
  int component = 0;  ///< of the pixels that it is made from: 0 red, 1 green, 2 blue
};

struct ExrRecipe {
  int width = 0;
  int height = 0;
  int first_column = 0;  ///< of the data window
  int first_row = 0;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  Imf::LineOrder line_order = Imf::INCREASING_Y;
  std::optional<Imf::TileDescription> tiles;
  std::optional<Imf::Envmap> envmap;
  std::vector<ExrChannel> channels;
};

/// R, G and B of one type.
std::vector<ExrChannel> rgb_channels(Imf::PixelType type);

/// Writes `rgb` (width x height x 3, row 0 on top). Smaller levels of mip and rip maps are filled with -99.
void write_exr(const std::filesystem::path& path, const ExrRecipe& recipe, const std::vector<float>& rgb);

/// R, G, B as the library's plainest way of reading gives them.
std::vector<float> read_exr_with_library(const std::filesystem::path& path);

/// A smooth bright picture with noise, below the largest half: the same for the same arguments.
std::vector<float> some_pixels(int width, int height, unsigned seed = 1);

/// What remains of a value in a half.
float as_half(float value);

}  // namespace welkin::test
