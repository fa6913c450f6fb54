// Environments as octahedral maps: the sphere on one square, with borders, as Godot's shaders read their radiance.
//
//   const welkin::OctahedralMap map = welkin::to_octahedral(light.specular->cubemap, {.size = 512, .levels = 5});
//   welkin::write_octahedral("radiance.ktx2", map);                      // texture_file.h
#pragma once

#include <array>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Returns where a direction lies on the square from (0, 0) to (1, 1), column first: +z in its middle, +x to the right,
/// +y down, -z in all four corners. With n = |x| + |y| + |z| it is ((x / n, y / n) + 1) / 2, and where z is below 0
/// that point is folded over the nearest side of the inner diamond (Meyer et al. 2010, "On Floating-Point Normal
/// Vectors"). Throws `Error` (invalid_argument) for a direction that is zero or not finite.
[[nodiscard]] std::array<double, 2> octahedral_place(const dvec3& direction);

/// The way back; of unit length. Beyond an edge of the square the sphere goes on: place (-a, b) is (a, 1 - b), up to a
/// whole square beyond.
[[nodiscard]] dvec3 octahedral_direction(double column, double row) noexcept;

/// How a map is made.
struct OctahedralOptions {
  int size = 256;  ///< texels along an edge of level 0, borders included: 1 to 16384

  /// At least 1, and no more than a chain has. Size and border of more than one level must be multiples of
  /// 2^(levels - 1), so that every level has whole texels of border.
  int levels = 1;

  /// Texels on each side of level 0 that repeat what lies on the sphere beyond the edge; 0: 2^(levels - 1), which is
  /// one texel of the last level. Bilinear filtering inside the square needs one at each level.
  int border = 0;

  friend bool operator==(const OctahedralOptions&, const OctahedralOptions&) = default;
};

/// Square pictures of RGB floats.
///
/// A shader looks a direction up at octahedral_place(d) (1 - 2 b) + b with b = border / size, the same at each level:
/// Godot's vec3_to_oct_with_border(d, vec2(b, 1 - 2 b)).
struct OctahedralMap {
  int size = 0;                            ///< texels along an edge of level 0
  int border = 0;                          ///< of level 0, on each side
  std::vector<std::vector<float>> levels;  ///< each size >> level squared x 3, row 0 on top

  /// Texels along an edge of a level.
  [[nodiscard]] int level_size(int level) const noexcept { return size >> level; }
  /// A level as a picture. It is valid while `levels` are.
  [[nodiscard]] LatLongView view(int level) const noexcept {
    return {levels[static_cast<std::size_t>(level)].data(), level_size(level), level_size(level), 0,
            PixelFormat::rgb32f};
  }
};

/// Makes each level of the map from the chain's level of that number. A texel is the mean, by solid angle, of the
/// cubemap's bilinear interpolation over the part of the sphere that the texel covers. Uniform light stays uniform, and
/// each texel of the cubemap keeps its light: within 0.6 % from 32 texels along an edge of the cubemap on, within 5 %
/// from 4 on. Texels of the border are copies. Allocates a copy of the cubemap's level.
/// The same bits on any number of threads and instruction set. Throws `Error`: invalid_argument (options, too few
/// levels), cancelled.
[[nodiscard]] OctahedralMap to_octahedral(const CubemapChain& chain, const OctahedralOptions& options = {},
                                          const Control& control = {});

/// One level straight from coefficients, which it has at its texels' centres: of irradiance or radiance. Throws as
/// above; `options.levels` must be 1.
[[nodiscard]] OctahedralMap to_octahedral(const SphericalHarmonics& harmonics, const OctahedralOptions& options = {},
                                          const Control& control = {});

}  // namespace welkin
