// OpenEXR files of every kind, written with the OpenEXR library and read back by it alone.
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
  int component = 0;  ///< component of the source pixels: 0 red, 1 green, 2 blue
};

/// Returns R, G and B of one type.
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
  std::function<void(Imf::Header&)> adjust{};  ///< sets everything else in the header
};

/// One part of a multi-part file. Only the header of a deep part is written.
struct ExrPartRecipe {
  std::string name;
  ExrRecipe recipe;
  std::vector<float> rgb;
  bool deep = false;
};

/// Writes `rgb` (width x height x 3, row 0 on top). Smaller levels of mip and rip maps are filled with -99.
void write_exr(const std::filesystem::path& path, const ExrRecipe& recipe, const std::vector<float>& rgb);

void write_exr_parts(const std::filesystem::path& path, const std::vector<ExrPartRecipe>& parts);

/// Writes luminance and chroma with OpenEXR's RgbaOutputFile: size, window, compression and `adjust` are the recipe's.
void write_luminance_chroma_exr(const std::filesystem::path& path, const ExrRecipe& recipe,
                                const std::vector<float>& rgb);

/// Returns the data window as OpenEXR's RgbaInputFile gives it, half floats as floats.
std::vector<float> read_rgba_with_library(const std::filesystem::path& path);

/// Returns R, G, B as the library's simplest interface reads them.
std::vector<float> read_exr_with_library(const std::filesystem::path& path);

/// Returns a smooth bright image with noise, below the largest half float: equal for equal arguments.
std::vector<float> some_pixels(int width, int height, unsigned seed = 1);

/// Returns the value rounded to a half float.
float as_half(float value);

}  // namespace welkin::test
