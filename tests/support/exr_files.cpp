#include "support/exr_files.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <cmath>
#include <cstring>
#include <random>

namespace welkin::test {
namespace {

Imf::Header make_header(const ExrRecipe& recipe) {
  const Imath::Box2i window({recipe.first_column, recipe.first_row},
                            {recipe.first_column + recipe.width - 1, recipe.first_row + recipe.height - 1});
  Imf::Header header(window, window);
  header.compression() = recipe.compression;
  header.lineOrder() = recipe.line_order;
  for (const ExrChannel& channel : recipe.channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type, channel.sampling, channel.sampling));
  }
  if (recipe.tiles) {
    header.setTileDescription(*recipe.tiles);
  }
  if (recipe.envmap) {
    Imf::addEnvmap(header, *recipe.envmap);
  }
  if (recipe.adjust) {
    recipe.adjust(header);
  }
  return header;
}

// One plane per channel, in its type, over the data window.
class Planes {
 public:
  Planes(const ExrRecipe& recipe, const std::vector<float>& rgb) : recipe_(recipe) {
    for (const ExrChannel& channel : recipe.channels) {
      add(channel, rgb);
    }
  }

  [[nodiscard]] Imf::FrameBuffer frame_buffer() {
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const ExrChannel& channel = recipe_.channels[i];
      const Imath::V2i origin(recipe_.first_column, recipe_.first_row);
      const std::int64_t columns = recipe_.width / channel.sampling;
      const std::int64_t rows = recipe_.height / channel.sampling;
      const std::size_t bytes = channel.type == Imf::HALF ? 2 : 4;
      buffer.insert(channel.name,
                    Imf::Slice::Make(channel.type, static_cast<const void*>(planes_[i].data()), origin, columns, rows,
                                     bytes, std::size_t{0}, channel.sampling, channel.sampling));
    }
    return buffer;
  }

 private:
  void add(const ExrChannel& channel, const std::vector<float>& rgb) {
    const std::size_t bytes = channel.type == Imf::HALF ? 2 : 4;
    std::vector<char> plane;
    for (int row = 0; row < recipe_.height; row += channel.sampling) {
      for (int column = 0; column < recipe_.width; column += channel.sampling) {
        const auto texel =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(recipe_.width) + static_cast<std::size_t>(column);
        const float value = rgb[3 * texel + static_cast<std::size_t>(channel.component)];
        const half narrow(value);
        // An integer may be -99 too, which marks pixels that are not read: converted through a signed number it wraps.
        const auto whole = channel.type == Imf::UINT ? static_cast<unsigned>(static_cast<std::int64_t>(value)) : 0U;
        const void* source = channel.type == Imf::HALF    ? static_cast<const void*>(&narrow)
                             : channel.type == Imf::FLOAT ? static_cast<const void*>(&value)
                                                          : static_cast<const void*>(&whole);
        plane.insert(plane.end(), static_cast<const char*>(source), static_cast<const char*>(source) + bytes);
      }
    }
    planes_.push_back(std::move(plane));
  }

  const ExrRecipe& recipe_;
  std::vector<std::vector<char>> planes_;
};

// Writes to a TiledOutputFile or TiledOutputPart.
template <typename TiledOutput>
void write_tiles(TiledOutput& file, const ExrRecipe& recipe, const std::vector<float>& rgb) {
  const std::vector<float> marker(rgb.size(), -99.0F);
  Planes full(recipe, rgb);
  Planes smaller(recipe, marker);
  for (int ly = 0; ly < file.numYLevels(); ++ly) {
    for (int lx = 0; lx < file.numXLevels(); ++lx) {
      if (file.isValidLevel(lx, ly)) {
        file.setFrameBuffer(lx == 0 && ly == 0 ? full.frame_buffer() : smaller.frame_buffer());
        file.writeTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
      }
    }
  }
}

}  // namespace

std::vector<ExrChannel> rgb_channels(Imf::PixelType type) {
  return {{"R", type, 1, 0}, {"G", type, 1, 1}, {"B", type, 1, 2}};
}

void write_exr(const std::filesystem::path& path, const ExrRecipe& recipe, const std::vector<float>& rgb) {
  if (recipe.tiles) {
    Imf::TiledOutputFile file(path.string().c_str(), make_header(recipe), 0);
    write_tiles(file, recipe, rgb);
    return;
  }
  Imf::OutputFile file(path.string().c_str(), make_header(recipe), 0);
  Planes planes(recipe, rgb);
  file.setFrameBuffer(planes.frame_buffer());
  file.writePixels(recipe.height);
}

void write_exr_parts(const std::filesystem::path& path, const std::vector<ExrPartRecipe>& parts) {
  std::vector<Imf::Header> headers;
  for (const ExrPartRecipe& part : parts) {
    headers.push_back(make_header(part.recipe));
    headers.back().setName(part.name);
    headers.back().setType(part.deep ? Imf::DEEPSCANLINE : part.recipe.tiles ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  }
  Imf::MultiPartOutputFile file(path.string().c_str(), headers.data(), static_cast<int>(headers.size()), false, 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ExrPartRecipe& part = parts[i];
    if (part.deep) {
      continue;
    }
    if (part.recipe.tiles) {
      Imf::TiledOutputPart output(file, static_cast<int>(i));
      write_tiles(output, part.recipe, part.rgb);
    } else {
      Imf::OutputPart output(file, static_cast<int>(i));
      Planes planes(part.recipe, part.rgb);
      output.setFrameBuffer(planes.frame_buffer());
      output.writePixels(part.recipe.height);
    }
  }
}

void write_luminance_chroma_exr(const std::filesystem::path& path, const ExrRecipe& recipe,
                                const std::vector<float>& rgb) {
  std::vector<Imf::Rgba> pixels;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    pixels.emplace_back(rgb[i], rgb[i + 1], rgb[i + 2]);
  }
  Imf::RgbaOutputFile file(path.string().c_str(), make_header(recipe), Imf::WRITE_YC, 0);
  const std::ptrdiff_t origin = std::ptrdiff_t{recipe.first_row} * recipe.width + recipe.first_column;
  file.setFrameBuffer(pixels.data() - origin, 1, static_cast<std::size_t>(recipe.width));
  file.writePixels(recipe.height);
}

std::vector<float> read_rgba_with_library(const std::filesystem::path& path) {
  Imf::RgbaInputFile file(path.string().c_str(), 0);
  const Imath::Box2i window = file.dataWindow();
  const std::ptrdiff_t columns = window.max.x - window.min.x + 1;
  const std::ptrdiff_t rows = window.max.y - window.min.y + 1;
  std::vector<Imf::Rgba> pixels(static_cast<std::size_t>(columns * rows));
  file.setFrameBuffer(pixels.data() - (window.min.y * columns + window.min.x), 1, static_cast<std::size_t>(columns));
  file.readPixels(window.min.y, window.max.y);
  std::vector<float> rgb;
  for (const Imf::Rgba& texel : pixels) {
    rgb.insert(rgb.end(), {texel.r, texel.g, texel.b});
  }
  return rgb;
}

std::vector<float> read_exr_with_library(const std::filesystem::path& path) {
  Imf::InputFile file(path.string().c_str(), 0);
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t columns = window.max.x - window.min.x + 1;
  const std::int64_t rows = window.max.y - window.min.y + 1;
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  Imf::FrameBuffer buffer;
  std::size_t component = 0;
  for (const char* name : {"R", "G", "B"}) {
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, static_cast<const void*>(rgb.data() + component++), window.min,
                                         columns, rows, 3 * sizeof(float)));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return rgb;
}

std::vector<float> some_pixels(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> rgb;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      for (int component = 0; component < 3; ++component) {
        const auto noise = static_cast<float>(random() % 1024) / 1024.0F;
        const float wave = std::exp(
            3.0F * std::sin(0.07F * static_cast<float>(column + 3 * component) + 0.11F * static_cast<float>(row)));
        rgb.push_back(wave * (0.75F + 0.5F * noise));
      }
    }
  }
  return rgb;
}

float as_half(float value) { return half(value); }

}  // namespace welkin::test
