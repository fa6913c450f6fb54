// OpenEXR files of every kind, made on the spot with the OpenEXR library, and read back by it alone.
#pragma once

#include <ImfCompression.h>
#include <ImfEnvmap.h>
#include <ImfForward.h>
#include <ImfLineOrder.h>
#include <ImfPixelType.h>
#include <ImfTileDescription.h>

#include <filesystem>
#include <functional>
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

/// R, G and B of one type.
std::vector<ExrChannel> rgb_channels(Imf::PixelType type);

struct ExrRecipe {
  int width = 0;
  int height = 0;
  int first_column = 0;  ///< of the data window
  int first_row = 0;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  Imf::LineOrder line_order = Imf::INCREASING_Y;
  std::optional<Imf::TileDescription> tiles{};
  std::optional<Imf::Envmap> envmap{};
  std::vector<ExrChannel> channels = rgb_channels(Imf::HALF);
  std::function<void(Imf::Header&)> adjust{};  ///< does what is left to do to the header
};

/// One part of a multi-part file. Of a deep one only the header is written.
struct ExrPartRecipe {
  std::string name;
  ExrRecipe recipe;
  std::vector<float> rgb;
  bool deep = false;
};

/// Writes `rgb` (width x height x 3, row 0 on top). Smaller levels of mip and rip maps are filled with -99.
void write_exr(const std::filesystem::path& path, const ExrRecipe& recipe, const std::vector<float>& rgb);

void write_exr_parts(const std::filesystem::path& path, const std::vector<ExrPartRecipe>& parts);

/// Luminance and chroma by OpenEXR's own RgbaOutputFile: size, window, compression and `adjust` are the recipe's.
void write_luminance_chroma_exr(const std::filesystem::path& path, const ExrRecipe& recipe,
                                const std::vector<float>& rgb);

/// The data window as OpenEXR's RgbaInputFile gives it, halves as floats.
std::vector<float> read_rgba_with_library(const std::filesystem::path& path);

/// R, G, B as the library's plainest way of reading gives them.
std::vector<float> read_exr_with_library(const std::filesystem::path& path);

/// A smooth bright image with noise, below the largest half: the same for the same arguments.
std::vector<float> some_pixels(int width, int height, unsigned seed = 1);

/// What remains of a value in a half.
float as_half(float value);

}  // namespace welkin::test
