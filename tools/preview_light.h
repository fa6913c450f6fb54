// Images for screens: exposure, tone curve, lookups in cubemaps, images with labels; and previews of a bake: the
// surroundings, the mips, spheres in that light.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::tool {

/// An exposure and a curve. The result is linear, in [0, 1]; writing applies the sRGB curve.
struct ToneMap {
  double exposure = 1.0;  ///< radiance is multiplied by it first

  /// Narkowicz's fit of the ACES curve (2015), without its 0.6: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14).
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& radiance) const noexcept;
  /// Maps in floats, which suffice for 8 bits per channel.
  [[nodiscard]] glm::vec3 operator()(const glm::vec3& radiance) const noexcept;

  /// Returns the exposure in stops: its logarithm to base 2.
  [[nodiscard]] double stops() const noexcept;
};

inline glm::vec3 ToneMap::operator()(const glm::vec3& radiance) const noexcept {
  constexpr float kWhite = 1e4F;  // the curve has ended by then, and the product of three denominators is finite
  const auto scale = static_cast<float>(exposure);
  const auto light = [=](float x) { return std::min(x > 0.0F ? scale * x : 0.0F, kWhite); };
  const glm::vec3 x(light(radiance.x), light(radiance.y), light(radiance.z));
  const glm::vec3 above = x * (2.51F * x + 0.03F);
  const glm::vec3 below = x * (2.43F * x + 0.59F) + 0.14F;
  // One division serves all three channels.
  const float inverse = 1.0F / (below.x * below.y * below.z);
  return glm::min(above * glm::vec3(below.y * below.z, below.z * below.x, below.x * below.y) * inverse,
                  glm::vec3(1.0F));
}

/// Looks directions up in a cubemap as a GPU does: bilinear, seamless across edges, linear between mips.
class CubeLookup {
 public:
  /// `levels`: packed rgb_f32, largest first, at least one; they are not copied.
  explicit CubeLookup(std::vector<CubemapView> levels) : levels_(std::move(levels)) {}
  explicit CubeLookup(const Cubemap& chain) : CubeLookup(chain.views()) {}

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int size(int level) const noexcept { return levels_[static_cast<std::size_t>(level)].size; }

  /// `direction` must not be 0, but need not have unit length; levels beyond the last one are clamped to it.
  [[nodiscard]] glm::vec3 at(const glm::vec3& direction, int level) const;

  /// Interpolates between the two levels around `level`.
  [[nodiscard]] glm::vec3 at(const glm::vec3& direction, double level) const;

  /// Returns the level whose texels are `radians` across.
  [[nodiscard]] double level_for(double radians) const;

 private:
  std::vector<CubemapView> levels_;
};

/// An image of 8 bits per channel in sRGB.
class PreviewImage {
 public:
  /// `background`: linear light, as in `set`.
  PreviewImage(int width, int height, const glm::vec3& background);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

  /// `rgb`: linear light from 0 to 1, already tone mapped.
  void set(int column, int row, const glm::vec3& rgb);

  /// Writes a label in capitals, digits and + - . with a dark rim. `x`, `y`: its middle; `height`: of its letters. All
  /// are in pixels.
  void write(std::string_view text, double x, double y, double height);

  /// Writes a PNG. Throws `Error`: file_access, and unsupported_file in a build without PNG.
  void save(const std::filesystem::path& path) const;

 private:
  [[nodiscard]] std::size_t offset(int column, int row) const noexcept;

  int width_;
  int height_;
  std::vector<std::uint8_t> bytes_;  // rows from the top, three bytes per pixel
  const std::uint8_t* codes_;        // sRGB codes of light in fine steps
};

/// Returns the width of a label in pixels.
[[nodiscard]] double label_width(std::string_view text, double height) noexcept;

/// Options common to all previews.
struct PreviewOptions {
  ToneMap tone_map;
  int sphere = 256;  ///< diameter of a sphere in pixels
};

/// An image that was written.
struct WrittenPreview {
  const char* name;
  const char* what;
  int width;
  int height;
};

/// Draws preview_environment.png, preview_spheres.png and preview_mips.png into a folder, those for which `light` has
/// the data. Throws `Error`: file_access, unsupported_file (a build without PNG), cancelled.
[[nodiscard]] std::vector<WrittenPreview> write_previews(const BakeResult& light, const PreviewOptions& options,
                                                         const std::filesystem::path& folder,
                                                         const Control& control = {});

}  // namespace welkin::tool
