// Parts of a bake that the command makes itself: its lat-long, options of chains by other lobes than GGX, and how much
// of the light is outside of the range of a file's format.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <type_traits>

#include "image/geometry.h"
#include "projection/sanitized_pixels.h"
#include "tools/baked.h"
#include "welkin/resampling.h"

namespace welkin::tool {

std::string what_of(LobeFamily lobe) {
  if (lobe == LobeFamily::charlie) return "prefiltered for sheen by Charlie's lobe, one roughness per mip";
  if (lobe == LobeFamily::lambert) return "prefiltered by the cosine lobe: irradiance over pi";
  return "prefiltered by Phong's lobe, a power a mip";
}

PrefilterOptions lobe_options(LobeFamily lobe, const BakeCommandOptions& options, const PrefilterOptions& specular) {
  PrefilterOptions chain = specular;
  chain.lobe = lobe;
  chain.lobe_roughness.clear();
  if (lobe == LobeFamily::phong) return chain;
  // glTF's viewer uses the same number of mips for its GGX and its sheen.
  if (lobe == LobeFamily::lambert || !is_engine_folder(options)) chain.mips.reset();
  chain.roughness.clear();
  if (lobe == LobeFamily::lambert)
    chain.size = options.irradiance_size > 0 ? options.irradiance_size : IrradianceOptions().size;
  return chain;
}

namespace {

struct Size {
  int width = 0;
  int height = 0;
};

Size size_of(const SourceShape& source, const BakeCommandOptions& options, const BakeOptions& whole) {
  constexpr int kLargestBackground = 2048;  // 8192 x 4096 pixels
  if (!contains(options.files, Content::lat_long)) return {};
  const SceneNeeds scene = options.scene.needs();
  const bool alone = is_lat_long_folder(options);
  const bool is_used = scene.background || (alone && (scene.glossy || scene.diffuse_bands > 0));
  if (!is_used) return {};
  int face = whole.background->size.value_or(whole.specular->size);
  if (alone && options.background_size == 0) {
    if (!source.cubemap) return {source.columns, source.rows};
    face = std::min(source.columns, kLargestBackground);
  }
  return {4 * face, 2 * face};
}

}  // namespace

std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options, const BakeOptions& whole) {
  const Size size = size_of(source, options, whole);
  return 3 * sizeof(float) * static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

LatLongImage lat_long_of(const EnvironmentView& source, const BakeCommandOptions& options, const BakeOptions& whole,
                         const Control& control) {
  const Size size = size_of(shape_of(source), options, whole);
  if (size.width == 0) return {};
  const projection::SanitizedSource clean(source, whole.pixels, control);
  return to_lat_long(clean.view(), size.width, size.height, dmat3(1.0), ResampleFilter::bilinear, control);
}

namespace {

/// Sums of luminance.
struct Light {
  double all = 0.0;
  double beyond = 0.0;

  void add(const float* rgb, double solid_angle, const glm::dvec3& largest) {
    constexpr glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);
    const glm::dvec3 radiance = glm::max(glm::dvec3(rgb[0], rgb[1], rgb[2]), 0.0);
    all += solid_angle * glm::dot(radiance, kLuminance);
    beyond += solid_angle * glm::dot(glm::max(radiance - largest, 0.0), kLuminance);
  }
  [[nodiscard]] double share() const { return all > 0.0 ? beyond / all : 0.0; }
};

}  // namespace

double share_beyond(const LatLongView& image, const glm::dvec3& largest) {
  Light light;
  const auto* rgb = static_cast<const float*>(image.pixels);
  for (int row = 0; row < image.height; ++row) {
    const double solid_angle = image::lat_long_texel_solid_angle(image.width, image.height, row);
    for (int column = 0; column < image.width; ++column, rgb += 3) light.add(rgb, solid_angle, largest);
  }
  return light.share();
}

double share_beyond(const CubemapView& cubemap, const glm::dvec3& largest) {
  Light light;
  const double edge = 2.0 / cubemap.size;
  for (const void* const face : cubemap.faces) {
    const auto* rgb = static_cast<const float*>(face);
    for (int row = 0; row < cubemap.size; ++row) {
      const double v = (row + 0.5) * edge - 1.0;
      for (int column = 0; column < cubemap.size; ++column, rgb += 3) {
        const double u = (column + 0.5) * edge - 1.0;
        const double squared = 1.0 + u * u + v * v;
        light.add(rgb, 1.0 / (squared * std::sqrt(squared)), largest);  // up to a constant factor
      }
    }
  }
  return light.share();
}

}  // namespace welkin::tool
