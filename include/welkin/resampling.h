// Resampling environments to another kind, size or orientation; mip chains of cubemaps; octahedral maps.
//
//   welkin::Cubemap cubemap = welkin::to_cubemap(panorama, 1024, welkin::rotation_about_y(90.0));
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

// ---- Another kind, size or orientation

/// Filter between lat-longs and cubemaps.
enum class ResampleFilter {
  /// Each texel is the mean of the source over its area. The source's texels are areas with ramps between neighbours.
  /// Ramps are as wide as in linear interpolation where the result is finer than the source, and absent where it is
  /// coarser. Every source texel keeps its total radiance to 1e-6 (also a single bright one, at poles, seams, edges and
  /// corners). A uniform source stays exactly uniform, and no new negative values appear. Edges of texels are
  /// approximated to less than half a texel of the result.
  area,
  /// Bilinear interpolation: of a lat-long at the centre of each texel of the cubemap, which is fast and suitable where
  /// the cubemap is at least as fine; of a cubemap the mean over each texel of the lat-long ("otherwise" below). Does
  /// not preserve total radiance.
  bilinear,
};

/// Resamples, rotates and mirrors an environment to a cubemap of `size` texels per edge, or a lat-long of `width` x
/// `height`.
///
/// `rotation` is an orthogonal matrix (a rotation, possibly with a mirror): direction d of the source becomes direction
/// rotation * d of the result. If kind and size stay the same and the matrix maps texels to texels, they are copied bit
/// for bit. For cubemaps, these are the 48 symmetries of a cube. For lat-longs, they are mirrors in x and y, the mirror
/// in z if the width is even, and rotations about y by whole texels.
///
/// Methods:
/// - From a lat-long to a cubemap with one of a cube's 48 symmetries (such as the identity): by `filter`.
/// - From a cubemap to one of 1/2, 1/4, ... the size with such a symmetry: mean over the texel's area, weighted by
///   solid angle. Total radiance is preserved to rounding.
/// - From a cubemap to a lat-long by `area` with such a symmetry: mean of the cubemap's texels, as constant areas.
///   Total radiance is preserved to rounding; where the result is finer, the cubemap's texels are visible.
/// - From a lat-long to one of the same size, rotated about y by a fraction of a texel and possibly mirrored: cubic
///   convolution along each row, limited to the range of the four nearest texels. Each row's sum is preserved to
///   rounding.
/// - Otherwise: mean, by solid angle, of the source's bilinear interpolation at evenly spaced samples over the texel's
///   area. The number of samples per edge is the source's maximum density of texels per radian (cubemap: size, that
///   in the middle of edges; 6 % less than in corners; lat-long: the larger of width / 2 pi and height / pi) divided by
///   the result's minimum density (cubemap: size / 2; lat-long: width / 2 pi and height / pi), rounded up, at least 2.
///   No source texel is missed: where a lat-long's texels are narrower than the distance of samples, the mean over that
///   distance along the row is taken. A lone texel counts 0.4 to 1.5 times within 10 rows of a pole, 0.88 to 1.11 times
///   elsewhere (from 256 x 128, to half of that or to 16 x 16 x 6); a cubemap's 0.7 to 1.2 times in a corner, 0.97 to
///   1.04 times inside of a face (from 32 to 16 x 16 x 6).
///
/// Interpolation continues across edges of faces, poles and the seam. NaN and infinities spread to the texels that they
/// touch, with `area` to a few more. `filter` is used between a lat-long and a cubemap only. Cost on one thread: `area`
/// 30 ns and `bilinear` 8 ns per texel of the result; otherwise 20 ns per sample from a cubemap, 60 ns from a lat-long.
/// Throws `Error` (invalid_argument) for views, sizes, and a matrix that is off orthogonal by more than 1e-6.
[[nodiscard]] Cubemap to_cubemap(const EnvironmentView& source, int size, const dmat3& rotation = dmat3(1.0),
                                 ResampleFilter filter = ResampleFilter::area, const Control& control = {});
[[nodiscard]] LatLongImage to_lat_long(const EnvironmentView& source, int width, int height,
                                       const dmat3& rotation = dmat3(1.0),
                                       ResampleFilter filter = ResampleFilter::bilinear, const Control& control = {});

/// Returns a rotation about y, from +z towards +x: the centre of a lat-long moves to the left. Exact at multiples of 90
/// degrees. Throws `Error` (invalid_argument) unless |degrees| <= 1e6.
[[nodiscard]] dmat3 rotation_about_y(double degrees);

// ---- Mip chains, for minification

/// How each level is made from the one before.
enum class MipFilter {
  box,          ///< plain mean of texels, as in graphics APIs
  solid_angle,  ///< mean by solid angle: preserves the sphere's total radiance on every level
};

/// Returns a chain with `source` as level 0, each further level computed from the one before. `levels` is their number,
/// including the source's; empty for levels down to 1 texel. With odd sizes, a texel covers 1 / size of the face;
/// fractional texels are weighted by covered area (`solid_angle`: by covered solid angle). Cost: limited by memory
/// bandwidth. Throws `Error` (invalid_argument) for the view or the number of levels.
[[nodiscard]] Cubemap build_mips(const CubemapView& source, MipFilter filter = MipFilter::solid_angle,
                                 std::optional<int> levels = std::nullopt, const Control& control = {});

/// Computes the levels of a chain whose level 0 is already filled.
void fill_mips(Cubemap& chain, MipFilter filter, const Control& control = {});

// ---- Octahedral maps: the sphere on one square with borders, as Godot's shaders read their radiance
//
//   const welkin::OctahedralMap map = welkin::to_octahedral(light.specular->cubemap, {.size = 512, .levels = 5});
//   welkin::write_octahedral("radiance.ktx2", map);                      // bake_file.h

/// Encodes a direction as a position on the square from (0, 0) to (1, 1), column first: +z in its centre, +x to the
/// right, +y down, -z in all four corners. With n = |x| + |y| + |z| it is ((x / n, y / n) + 1) / 2; where z is below 0,
/// that point is folded over the nearest side of the inner diamond (Meyer et al. 2010, "On Floating-Point Normal
/// Vectors"). Throws `Error` (invalid_argument) for a direction that is zero or not finite.
[[nodiscard]] std::array<double, 2> octahedral_encode(const dvec3& direction);

/// Decodes a position to a unit direction. Beyond an edge of the square, up to one whole square, the sphere continues:
/// (-a, b) is (a, 1 - b).
[[nodiscard]] dvec3 octahedral_decode(double column, double row) noexcept;

/// Options of `to_octahedral`.
struct OctahedralOptions {
  int size = 256;  ///< texels per edge of level 0, including borders: 1 to 16384

  /// Number of levels, at least 1 and at most that of the chain. With more than one, size and border must be multiples
  /// of 2^(levels - 1), so that every level has whole texels of border.
  int levels = 1;

  /// Texels on each side of level 0 that repeat the sphere beyond the edge. 0 selects 2^(levels - 1), one texel of the
  /// last level. Bilinear filtering needs one on each level.
  int border = 0;

  friend bool operator==(const OctahedralOptions&, const OctahedralOptions&) = default;
};

/// Square images of RGB floats.
///
/// A shader looks a direction up at octahedral_encode(d) (1 - 2 b) + b with b = border / size, on every level: Godot's
/// vec3_to_oct_with_border(d, vec2(b, 1 - 2 b)).
struct OctahedralMap {
  int size = 0;                            ///< texels per edge of level 0
  int border = 0;                          ///< texels of border on each side of level 0
  std::vector<std::vector<float>> levels;  ///< (size >> level)^2 x 3 values each, top row first

  /// Returns the texels per edge of a level.
  [[nodiscard]] int level_size(int level) const noexcept { return size >> level; }
  /// Returns a level as a flat image, valid as long as `levels` is unchanged.
  [[nodiscard]] LatLongView view(int level) const noexcept {
    return {levels[static_cast<std::size_t>(level)].data(), level_size(level), level_size(level), 0,
            PixelFormat::rgb32f};
  }
};

/// Computes an octahedral map, each level from the chain's level of the same index. A texel is the mean, by solid
/// angle, of the cubemap's bilinear interpolation over the part of the sphere that the texel covers. Uniform light
/// stays uniform. Each texel of the cubemap keeps its light to within 0.6 % for cubemaps from 32 texels per edge on,
/// and within 5 % from 4 on. Border texels are copies. Allocates a copy of one level of the cubemap. Throws `Error`
/// (invalid_argument) for options, or too few levels.
[[nodiscard]] OctahedralMap to_octahedral(const Cubemap& chain, const OctahedralOptions& options = {},
                                          const Control& control = {});

/// Computes one level from coefficients of irradiance or radiance, evaluated at texels' centres. `options.levels` must
/// be 1. Throws `Error` (invalid_argument).
[[nodiscard]] OctahedralMap to_octahedral(const SphericalHarmonics& harmonics, const OctahedralOptions& options = {},
                                          const Control& control = {});

}  // namespace welkin
