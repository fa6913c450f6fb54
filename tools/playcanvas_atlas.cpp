#include "tools/playcanvas_atlas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/json.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

// EnvLighting of PlayCanvas 2.23, for an atlas of 512 texels; all lengths grow with it.
constexpr int kUnit = 512;
constexpr int kSharpLevels = 6;

struct Rectangle {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// sqrt(radiance) = c (8 - 7 a), a as large as the largest channel lets it be.
class Rgbp {
 public:
  explicit Rgbp(PlayCanvasAtlas& atlas) : atlas_(atlas) {}

  void put(const float* radiance, int column, int row) {
    std::uint8_t* const texel = atlas_.rgba.data() + 4 * (static_cast<std::size_t>(row) * edge() + column_of(column));
    float root[3];
    float largest = 1.0F;
    for (int channel = 0; channel < 3; ++channel) {
      const float value = radiance[channel];
      const bool is_held = value >= 0.0F && value <= static_cast<float>(kLargestRgbp);
      if (!is_held) ++atlas_.values_clamped;
      root[channel] = std::sqrt(is_held ? value : value > 0.0F ? static_cast<float>(kLargestRgbp) : 0.0F);
      largest = std::max(largest, root[channel]);
    }
    const float steps = std::floor(255.0F * (8.0F - largest) / 7.0F);  // rounded down, so that no channel is above 1
    const float scale = 255.0F / (8.0F - 7.0F * steps / 255.0F);
    for (int channel = 0; channel < 3; ++channel) {
      texel[channel] = static_cast<std::uint8_t>(std::min(255.0F, std::floor(root[channel] * scale + 0.5F)));
    }
    texel[3] = static_cast<std::uint8_t>(steps);
  }

 private:
  [[nodiscard]] std::size_t edge() const noexcept { return static_cast<std::size_t>(atlas_.size); }
  [[nodiscard]] static std::size_t column_of(int column) noexcept { return static_cast<std::size_t>(column); }

  PlayCanvasAtlas& atlas_;
};

/// A lat-long inside a seam, in which it goes on: around, and over the poles.
void place(const CubemapView& source, ResampleFilter filter, const Rectangle& at, PlayCanvasAtlas& atlas,
           const Control& control) {
  const int seam = atlas.size / kUnit;
  const int width = at.width - 2 * seam;
  const int height = at.height - 2 * seam;
  // A result coarser than its source is averaged over its texels; between rough ones the shader interpolates, and so
  // they are to hold what lies at their centres: those of a finer result.
  int finer = 1;
  while (filter == ResampleFilter::bilinear && finer * width < 4 * source.size) finer += 2;
  const LatLongImage picture =
      to_lat_long(source, finer * width, finer * height, dmat3(1.0), filter, {control.stop, {}});
  Rgbp texels(atlas);
  for (int row = 0; row < at.height; ++row) {
    const int wanted = row - seam;
    const bool is_beyond_pole = wanted < 0 || wanted >= height;
    const int from = wanted < 0 ? -1 - wanted : wanted >= height ? 2 * height - 1 - wanted : wanted;
    for (int column = 0; column < at.width; ++column) {
      const int around = column - seam + width + (is_beyond_pole ? width / 2 : 0);
      const auto texel = static_cast<std::size_t>(finer * from + finer / 2) * static_cast<std::size_t>(finer * width) +
                         static_cast<std::size_t>(finer * (around % width) + finer / 2);
      texels.put(picture.pixels.data() + 3 * texel, at.left + column, at.top + row);
    }
  }
}

}  // namespace

int atlas_size(int specular_size) noexcept { return kUnit * std::max(1, 2 * specular_size / kUnit); }

PlayCanvasAtlas playcanvas_atlas(const Cubemap& specular, const CubemapView& diffuse, bool ends_in_diffuse,
                                 const Control& control) {
  PlayCanvasAtlas atlas{atlas_size(specular.size()), {}, 0};
  const auto edge = static_cast<std::size_t>(atlas.size);
  atlas.rgba.assign(4 * edge * edge, 0);
  const int scale = atlas.size / kUnit;
  Rectangle sharp{0, 0, atlas.size, atlas.size / 2};
  for (int level = 0; level < kSharpLevels; ++level) {
    place(specular.view(0), ResampleFilter::area, sharp, atlas, control);
    sharp = {sharp.left + sharp.height, sharp.top + sharp.height, sharp.width / 2, sharp.height / 2};
  }
  Rectangle rough{0, atlas.size / 2, atlas.size / 2, atlas.size / 4};
  for (int level = 1; level <= kAtlasMips; ++level) {  // of the last the shader takes nothing
    const int mip = std::min({level, kAtlasMips - 1, specular.levels() - 1});
    const bool is_diffuse = ends_in_diffuse && level >= kAtlasMips - 1;
    place(is_diffuse ? diffuse : specular.view(mip), ResampleFilter::bilinear, rough, atlas, control);
    rough = {0, rough.top + rough.height, rough.width / 2, rough.height / 2};
  }
  place(diffuse, ResampleFilter::bilinear, {128 * scale, 384 * scale, 64 * scale, 32 * scale}, atlas, control);
  return atlas;
}

std::string playcanvas_asset(const std::string& file) {
  const Json asset = {{"name", file.substr(0, file.rfind('.'))},
                      {"type", "texture"},
                      {"file", {{"filename", file}, {"url", file}}},
                      {"data",
                       {{"type", "rgbp"},
                        {"mipmaps", false},
                        {"minfilter", "linear"},
                        {"magfilter", "linear"},
                        {"addressu", "clamp"},
                        {"addressv", "clamp"}}}};
  return json_text(asset) + '\n';
}

}  // namespace welkin::tool
