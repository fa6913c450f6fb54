// Pictures for people: light to what a screen can show, cubemaps unfolded, balls lit by what was baked.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "welkin/bake.h"
#include "welkin/image.h"

namespace welkin::tool {

/// An exposure and a curve. The result is linear, in [0, 1]; the sRGB curve comes when it is written.
struct ToneMap {
  double exposure = 1.0;  ///< radiance is multiplied by it first

  /// Narkowicz's fit of the ACES curve (2015), without its 0.6: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14).
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& radiance) const noexcept;
};

/// What puts the environment's mean luminance at 0.18, middle grey. The mean leaves out what is four times brighter
/// than itself, so that a sun does not leave the rest in the dark. 1 if there is no light. `level` is packed rgb_f32; a
/// small one will do.
[[nodiscard]] ToneMap tone_map_of(const CubemapView& level);

/// Looks a direction up in a cubemap as a graphics card does: bilinear, seamless across edges, linear between mips.
class CubeLookup {
 public:
  /// Levels of packed rgb_f32, largest first, at least one; they are not copied.
  explicit CubeLookup(std::vector<CubemapView> levels) : levels_(std::move(levels)) {}
  explicit CubeLookup(const CubemapChain& chain) : CubeLookup(chain.views()) {}

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int size(int level) const noexcept { return levels_[static_cast<std::size_t>(level)].size; }

  /// `direction` need not be of unit length, but must not be 0; a level beyond the last one is the last one.
  [[nodiscard]] glm::dvec3 at(const glm::dvec3& direction, int level) const;

  /// The same between two levels, `level` being a fraction.
  [[nodiscard]] glm::dvec3 at(const glm::dvec3& direction, double level) const;

 private:
  std::vector<CubemapView> levels_;
};

/// Linear light from 0 to 1, already tone mapped.
class PreviewPicture {
 public:
  PreviewPicture(int width, int height, const glm::dvec3& background);

  [[nodiscard]] int width() const noexcept { return image_.width; }
  [[nodiscard]] int height() const noexcept { return image_.height; }
  void set(int column, int row, const glm::dvec3& rgb);

  /// For the writer, which takes a picture of any shape.
  [[nodiscard]] LatLongView view() const noexcept { return image_.view(); }

 private:
  LatLongImage image_;
};

/// The mean of `shade(x, y)` over a pixel, at n x n points of it; x and y are in pixels from the picture's top left.
template <typename Shade>
glm::dvec3 supersampled(int column, int row, int n, const Shade& shade) {
  glm::dvec3 sum(0.0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) sum += shade(column + (i + 0.5) / n, row + (j + 0.5) / n);
  }
  return sum / (static_cast<double>(n) * n);
}

/// A cross as seen from inside, facing +z: left (+x), front (+z), right (-x) and back (-z) in a row, up above the front
/// and down below it. What is written there reads as it should. (A cubemap's own faces look mirrored:
/// docs/orientation.md says why.) `cell`: pixels along a face's edge.
[[nodiscard]] PreviewPicture preview_cross(const CubeLookup& environment, const ToneMap& tone_map, int cell = 256);

/// Every mip as a cross of its own, all of one size, in rows of four from the sharpest to the roughest; a texel is
/// spread over many pixels as a graphics card spreads it, so that seams would show.
[[nodiscard]] PreviewPicture preview_mips(const CubeLookup& specular, const ToneMap& tone_map, int cell = 64);

/// What the balls of a row are made of.
struct PreviewMaterial {
  const char* name;
  glm::dvec3 f0;              ///< reflectance at normal incidence, linear Rec. 709
  glm::dvec3 diffuse_albedo;  ///< 0 for a metal

  [[nodiscard]] bool is_metal() const noexcept { return diffuse_albedo == glm::dvec3(0.0); }
};

/// Rows of the picture of balls, from top to bottom. f0 of the metals: Lagarde, "Feeding a physically based shading
/// model" (2011).
[[nodiscard]] std::span<const PreviewMaterial> preview_materials() noexcept;

/// Roughness of the balls of each row, from left to right.
[[nodiscard]] const std::vector<double>& preview_roughness();

/// Rows of balls before the environment: a material a row, a roughness a column. The viewer looks along -z from far
/// away: +x is to the right, and the balls mirror what is behind the viewer, the lat-long's centre.
///
/// A ball shows specular(reflection, mip of its roughness) times A = f0 scale + bias from the BRDF table (f0 alone
/// without a table), and if it is no metal also (1 - A) albedo irradiance(normal) / pi. Without an irradiance cubemap
/// there are metals alone. `light` must have its specular chain. `ball`: pixels across one; they lie 9/8 of that apart.
[[nodiscard]] PreviewPicture preview_spheres(const BakeResult& light, const ToneMap& tone_map, int ball);

}  // namespace welkin::tool
