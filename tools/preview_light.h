// Light to what a screen can show: exposure, curve, look-ups in cubemaps, pictures with labels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "welkin/image.h"

namespace welkin::tool {

/// An exposure and a curve. The result is linear, in [0, 1]; the sRGB curve comes when it is written.
struct ToneMap {
  double exposure = 1.0;  ///< radiance is multiplied by it first

  /// Narkowicz's fit of the ACES curve (2015), without its 0.6: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14).
  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& radiance) const noexcept;
  /// The same in floats, for 8 bits a channel.
  [[nodiscard]] glm::vec3 operator()(const glm::vec3& radiance) const noexcept;

  /// The exposure in stops: its logarithm to base 2.
  [[nodiscard]] double stops() const noexcept;
};

/// What puts the 75th percentile of the lit surroundings' luminance, by solid angle, at 0.36: a stop above middle grey.
/// Lit is what has at least 1/32 of the mean, for which luminance above its 99th percentile counts as that one: neither
/// the black around a studio's lamps nor a sun moves the result. 1 if there is no light. `level` is packed rgb_f32; a
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
  [[nodiscard]] glm::vec3 at(const glm::vec3& direction, int level) const;

  /// The same between two levels, `level` being a fraction.
  [[nodiscard]] glm::vec3 at(const glm::vec3& direction, double level) const;

  /// The level whose texels are `radians` across.
  [[nodiscard]] double level_for(double radians) const;

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

  /// Writes a label in capitals, digits and + - . with a dark rim. `x`, `y`: its middle; `height`: of its letters. All
  /// in pixels.
  void write(std::string_view text, double x, double y, double height);

  /// For the writer, which takes a picture of any shape.
  [[nodiscard]] LatLongView view() const noexcept { return image_.view(); }

  /// As 8 bit sRGB, three bytes a pixel, row by row.
  [[nodiscard]] std::vector<std::uint8_t> bytes() const;

 private:
  LatLongImage image_;
};

/// The width of a label in pixels.
[[nodiscard]] double label_width(std::string_view text, double height) noexcept;

}  // namespace welkin::tool
