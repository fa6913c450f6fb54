// Environments of another shape, size or orientation, mip chains of cubemaps, and octahedral maps.
//
//   welkin::Cubemap cubemap = welkin::to_cubemap(panorama, 1024, welkin::turn_about_y(90.0));
//   welkin::Cubemap mips = welkin::build_mips(cubemap.view());
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

class SphericalHarmonics;  // spherical_harmonics.h

// ---- Another shape, size or orientation

/// How a lat-long becomes a cubemap, or the other way about.
enum class ResampleFilter {
  /// Each texel is the mean of the source over the texel's area. The source's texels are areas too, with ramps between
  /// neighbours: where the result is finer than the source as wide as linear interpolation has them, where it is
  /// coarser none. Every texel of the source keeps its total radiance (a lone one of any brightness to 1e-6, at poles,
  /// seams, edges and corners alike); a uniform source stays exactly what it is; nothing becomes negative that was not.
  /// Edges of texels are followed in steps, to less than half a texel of the result.
  area,
  /// Bilinear interpolation at the centre of each texel of the result: fast, smooth, and right where the result is as
  /// fine as the source or finer; a source that is finer is passed over in part, and total radiance is not kept.
  bilinear,
};

/// Turning, mirroring and resampling.
///
/// `turn` is an orthogonal matrix (a rotation, or a rotation and a mirror): what lies in direction d of the source
/// lies in direction turn * d of the result. Where shape and size stay and the turn takes texels to texels (any of a
/// cube's 48 symmetries; for a lat-long a mirror in x or y, in z if the width is even, or a turn about y by whole
/// texels), every texel is moved as it is, bit for bit.
///
/// From a lat-long to a cubemap, with one of a cube's 48 symmetries for a turn (the identity is one): as `filter` says.
/// From a cubemap to one of half the size, a quarter and so on, likewise turned: by mean over the texel's area,
/// weighted by solid angle, so that total radiance is kept to rounding.
/// From a cubemap to a lat-long by `area`, likewise turned: each texel is the mean of the cube's texels, as areas of
/// one value each, over its own area. Total radiance is kept to rounding; where the result is finer, the cube's texels
/// show.
/// From a lat-long to one of the same size, rotated about y by a fraction of a texel and mirrored or not: each row is
/// resampled along itself by cubic convolution. Each result is limited to the range of the four texels around it, and
/// the row's sum is kept to rounding.
/// Else each texel of the result is the mean, by solid angle, of the source's bilinear interpolation over the texel's
/// area, at evenly spaced samples. Along either edge these are the source's texels a radian where they lie closest
/// (cube: size; lat-long: width / 2 pi or height / pi, the larger) over the result's where they lie widest apart (cube:
/// size / 2; lat-long: width / 2 pi across, height / pi down), rounded up, and at least 2. So no texel of the source is
/// passed over, and total radiance is kept to the error of the interpolation; but not close to the poles of a lat-long
/// source. Its texels there are narrower than samples lie apart, and one that differs much from its row may count many
/// times or not at all (from 256 x 128 to 16 x 16 x 6 in the first row 0 to 26 times, in the fifth 0.2 to 4 times).
///
/// Faces are interpolated across their edges, a lat-long across its poles and its seam; NaN and infinities spread to
/// the texels that they touch, by area to some more. Cost: by area some 30 ns a texel of the result and thread,
/// bilinear 8, else some 20 ns a sample and thread from a cubemap, 60 ns from a lat-long. The same bits on any number
/// of threads and every instruction set. Throws `Error`: invalid_argument (views, sizes, a matrix that is off
/// orthogonal by more than 1e-6), cancelled.
/// `filter` is of use between a lat-long and a cubemap alone: pictures of one kind have one way each.
[[nodiscard]] Cubemap to_cubemap(const EnvironmentView& source, int size, const dmat3& turn = dmat3(1.0),
                                 ResampleFilter filter = ResampleFilter::area, const Control& control = {});
[[nodiscard]] LatLongImage to_lat_long(const EnvironmentView& source, int width, int height,
                                       const dmat3& turn = dmat3(1.0), ResampleFilter filter = ResampleFilter::bilinear,
                                       const Control& control = {});

/// A turn about y, from +z towards +x: what lies in the middle of a lat-long moves to the left. The same bits
/// everywhere, exact at multiples of 90 degrees. Throws `Error` (invalid_argument) unless |degrees| <= 1e6.
[[nodiscard]] dmat3 turn_about_y(double degrees);

// ---- Mip chains, for minification

/// How each level is made from the one above it.
enum class MipFilter {
  box,          ///< the plain mean of the texels below: what graphics APIs do
  solid_angle,  ///< their mean by solid angle: keeps the sphere's total radiance on every level
};

/// Copies `source` to level 0 and fills the levels below from it, each from the one above. Odd sizes: a texel below
/// covers 1 / its size of the face, cut texels count by the part (for solid_angle: the solid angle) that is covered.
/// `levels`: how many, the source's own counted; none: down to 1 texel. Cost: bounded by memory. The same bits on any
/// number of threads and instruction set. Throws `Error`: invalid_argument (view, levels), cancelled.
[[nodiscard]] Cubemap build_mips(const CubemapView& source, MipFilter filter = MipFilter::solid_angle,
                                 std::optional<int> levels = std::nullopt, const Control& control = {});

/// The same where level 0 of `chain` is filled already.
void fill_mips(Cubemap& chain, MipFilter filter, const Control& control = {});

// ---- Octahedral maps: the sphere on one square, with borders, as Godot's shaders read their radiance
//
//   const welkin::OctahedralMap map = welkin::to_octahedral(light.specular->cubemap, {.size = 512, .levels = 5});
//   welkin::write_octahedral("radiance.ktx2", map);                      // bake_file.h

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
[[nodiscard]] OctahedralMap to_octahedral(const Cubemap& chain, const OctahedralOptions& options = {},
                                          const Control& control = {});

/// One level straight from coefficients, which it has at its texels' centres: of irradiance or radiance. Throws as
/// above; `options.levels` must be 1.
[[nodiscard]] OctahedralMap to_octahedral(const SphericalHarmonics& harmonics, const OctahedralOptions& options = {},
                                          const Control& control = {});

}  // namespace welkin
