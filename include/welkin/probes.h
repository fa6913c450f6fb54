// Grids of light probes: diffuse light and visibility from captured cubemaps.
//
//   welkin::ProbeGrid grid{.counts = {12, 4, 12}, .origin = {-11, 0.5, -11}, .spacing = {2, 2, 2}};
//   welkin::BakedProbes probes = welkin::bake_probes(grid, cubes, depths);       // one of each per probe
//   welkin::dvec3 light = welkin::probe_irradiance(probes, position, normal);    // W/m2
//
// Cubemaps, depths, directions and grids are in the axes of `CubemapView`. Results are computed in double in a fixed
// order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Captures

/// Positions of probes: a regular grid. Probe (i, j, k) along x, y and z has the index i + counts[0] (j + counts[1] k).
struct ProbeGrid {
  std::array<int, 3> counts{1, 1, 1};  ///< probes along x, y and z: each 1 to 2048, at most 2^24 in total
  dvec3 origin{};                      ///< position of probe 0, at most 1e15 along each axis
  dvec3 spacing{1.0};                  ///< distance between probes, 1e-9 to 1e12, even along an axis with one probe

  /// Returns the number of probes.
  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
           static_cast<std::size_t>(counts[2]);
  }
  /// Returns the position of a probe.
  [[nodiscard]] dvec3 position(std::size_t probe) const noexcept {
    const auto columns = static_cast<std::size_t>(counts[0]);
    const auto rows = static_cast<std::size_t>(counts[1]);
    const std::size_t row = probe / columns % rows;
    const std::size_t slice = probe / columns / rows;
    return {origin.x + spacing.x * static_cast<double>(probe % columns),
            origin.y + spacing.y * static_cast<double>(row), origin.z + spacing.z * static_cast<double>(slice)};
  }

  friend bool operator==(const ProbeGrid&, const ProbeGrid&) = default;
};

/// Distances from the probe along the rays through the texels' centres (not along the face's normal). Negative values
/// are distances to a surface's back. Infinity means that only the environment is visible. Faces are those of
/// `CubemapView`.
struct DepthView {
  std::array<const float*, 6> faces{};  ///< first texel of each face
  int size = 0;                         ///< texels per edge, 1 to 1024; may differ from that of the colours
  std::ptrdiff_t row_stride_bytes = 0;  ///< distance between rows; 0 for packed rows; negative for bottom-up images
};

// ---- Relocation

/// Options of `relocate_probes`. Shares of a distance refer to the smallest spacing.
struct RelocationOptions {
  double back_share = 0.25;  ///< fraction of the sphere that must show backs for a probe to lie within geometry, 0 to 1
  double clearance = 0.12;   ///< distance to keep from surfaces, 0 to 0.5; larger than `ProbeOptions::near_share`
  double farthest = 0.45;    ///< bound of the offset along each axis, as a fraction of that axis's spacing, 0 to 0.5

  friend bool operator==(const RelocationOptions&, const RelocationOptions&) = default;
};

/// Returns where probes should be captured instead: an offset per probe, to be added to `ProbeGrid::position`. Engines
/// call it a virtual offset (Unity) or probe relocation (RTXGI). Capture again at the new positions, bake, and set
/// `BakedProbes::offsets`.
///
/// - A probe that sees more backs than `back_share` lies within geometry. It moves through the nearest back and
///   `clearance` beyond it: the shortest way out.
/// - Another probe with a surface nearer than `clearance` moves away from the nearest one, up to the middle of the free
///   space behind it.
/// - A probe without a way that `farthest` permits stays.
///
/// `depths` has one view per probe. `offsets` (empty for none) are those at which the depths were captured; they count
/// towards `farthest`. In a corner, the second call with new depths moves a probe away from the second wall. Throws
/// `Error`: invalid_argument, rejected_pixel for a NaN in depths.
[[nodiscard]] std::vector<dvec3> relocate_probes(const ProbeGrid& grid, std::span<const DepthView> depths,
                                                 const RelocationOptions& options = {},
                                                 std::span<const dvec3> offsets = {}, const Control& control = {});

// ---- Baking

/// Options of `bake_probes`.
struct ProbeOptions {
  /// Bands (1 to 4), pixel policy and quadrature.
  ProjectionOptions projection{};

  /// Distance, as a fraction of the smallest spacing, within which visible surfaces count against a probe's validity.
  /// Backs of surfaces count at any distance.
  double near_share = 0.1;

  /// Fraction of the sphere, by solid angle, that must be neither near nor a back for a probe to be valid. 0.75 is the
  /// dilation threshold of Unity's adaptive probe volumes.
  double valid_share = 0.75;

  /// Texels per edge of a probe's octahedral distance map, without its border of one texel: 1 to 64; 0 for no maps.
  int distance_size = 8;

  /// Power of the cosine with which distances are weighted around a texel's direction: 1 to 1024. Majercik et al. use
  /// 50.
  int distance_power = 50;

  /// Maximum of distances, so that what is far away does not dominate; 0 for one and a half diagonals of a cell.
  double distance_limit = 0.0;

  /// Number of passes in which valid probes are spread to invalid neighbours: 0 to 1024.
  int dilation_passes = 4;

  /// Bands of environments that `relight` supports: 1 to 13, and at most 17 together with the bands of the projection.
  /// 0 stores no visibility for `relight`. Requires depths.
  int environment_bands = 0;

  friend bool operator==(const ProbeOptions&, const ProbeOptions&) = default;
};

/// A baked grid of probes. Arrays have the stated number of values per probe, probe by probe.
struct BakedProbes {
  ProbeGrid grid{};           ///< positions
  int bands = 0;              ///< bands of radiance, 1 to 4
  int distance_size = 0;      ///< texels per edge of the distance maps, without borders; 0 without maps
  double distance_limit = 0;  ///< maximum to which distances were clamped
  int sky_bands = 0;          ///< bands of the environment's visibility; 0 without

  /// [bands^2] Coefficients of radiance, in the order of `SphericalHarmonics::coefficients`. For invalid probes that
  /// `passes` marks as filled, those of their neighbours; otherwise as captured.
  std::vector<dvec3> coefficients;

  /// [1] Fraction of the sphere that is neither near nor a back: 0 to 1. 1 without depths.
  std::vector<float> validity;

  /// [1] 0: valid. 1 to 254: invalid, filled by that pass of the dilation (254 also for later ones). 255: invalid.
  std::vector<std::uint8_t> passes;

  /// [(distance_size + 2)^2][2] Mean distance and mean squared distance around each texel's direction, top row first,
  /// laid out by `octahedral_encode` inside the border. Backs count by their distance. Not dilated.
  std::vector<float> distances;

  /// [sky_bands^2] Coefficients of the function that is 1 where a probe sees the environment and 0 elsewhere.
  std::vector<double> sky;

  /// [1] Position of the capture minus that of the grid, as `relocate_probes` returns it, or empty for none. Set it
  /// after the bake. Lookups measure distances and directions from there, and weight by the grid.
  std::vector<dvec3> offsets;

  ProjectionDiagnostics diagnostics;  ///< totals over all cubemaps, as in `project_many`
  std::size_t invalid = 0;            ///< number of invalid probes
  std::size_t unfilled = 0;           ///< number of invalid probes that no pass has filled

  /// Returns the texels per edge of a distance map including its border, or 0 without maps.
  [[nodiscard]] int distance_edge() const noexcept { return distance_size > 0 ? distance_size + 2 : 0; }
};

/// Bakes a grid. `cubes` has one cubemap per probe, in the grid's order, of any sizes and formats. `depths` has one
/// view per probe, all of one size; without depths all probes are valid, and there are neither distances nor visibility
/// of the sky.
///
/// - Radiance is bit-identical to that of `project_many`, and fails with the same errors.
/// - Distances: texels are first averaged by solid angle in blocks, at most 16 per edge. A texel of a map is a mean of
///   blocks. The weight is solid angle times max(0, cosine)^power, for the angle between the texel's direction and the
///   block's centre, corrected for variation within the block (docs/guides/probe_grids.md).
/// - Validity is measured by the solid angles of texels.
/// - Invalid probes are filled by `dilate`.
/// - Visibility of the sky is computed as by `project` with exact quadrature, in the number of bands that relighting
///   needs.
///
/// Does not allocate per probe. Throws `Error`: invalid_argument (grid, options, views or their number; the message
/// names the probe), rejected_pixel (as `project_many`, and for a NaN in depths).
[[nodiscard]] BakedProbes bake_probes(const ProbeGrid& grid, std::span<const CubemapView> cubes,
                                      std::span<const DepthView> depths = {}, const ProbeOptions& options = {},
                                      const Control& control = {});

/// Bakes some probes again from new cubemaps (and new depths, if the grid was baked with depths), and dilates all
/// probes. The result is bit-identical to `bake_probes` of the whole grid. `options` must be those of the first bake.
/// The diagnostics cover the probes that were baked again. Throws the same errors as `bake_probes`, and `Error`
/// (invalid_argument) for indices outside the grid or listed twice. After an error, also after cancellation, `probes`
/// is unchanged. Messages about a cubemap or depths name a probe by its index in `changed`.
void update_probes(BakedProbes& probes, std::span<const std::size_t> changed, std::span<const CubemapView> cubes,
                   std::span<const DepthView> depths = {}, const ProbeOptions& options = {},
                   const Control& control = {});

/// Fills invalid probes from their neighbours. In each pass, a probe without light receives the mean of its neighbours
/// (up to 26) that had light before the pass, weighted by 1 / distance^2. Probes filled by an earlier call are filled
/// again. Sets `passes`, `invalid` and `unfilled`. Throws `Error` (invalid_argument). If cancelled, it leaves some
/// probes unfilled; call it again.
void dilate(BakedProbes& probes, int most_passes = 4, const Control& control = {});

/// Returns the probes with coefficients windowed by `apply_window`, for drawing and packing. `relight` needs the
/// originals. Throws the errors of `apply_window`, with the probe's index.
[[nodiscard]] BakedProbes windowed(const BakedProbes& probes, Window window, double width = 0.0,
                                   const Control& control = {});

// ---- Relighting

/// Changes probes to what they would capture in another environment: adds the difference of the two environments, seen
/// through each probe's visibility of the sky, and dilates again (`dilation_passes`). Light reflected by surfaces is
/// not updated; the result is exact if the capture shows only the environment in front of black surfaces.
///
/// `from` is the radiance of the environment of the capture, or of the last call; `to` that of the new one (rotated,
/// scaled, or with another sun). Bands above the bake's `environment_bands` are ignored: environments with no more
/// bands are exact, up to the resolution of the depths; a sun becomes a lobe of that many bands. With 0
/// `dilation_passes`, filled probes keep their light plus the change that they see themselves.
///
/// Cost: bands^2 x sky_bands^2 multiplications per probe and channel. Linear in `to` - `from`. Throws `Error`
/// (invalid_argument) if no visibility was kept, and for a coefficient that is not finite or beyond 1e100, which the
/// message names. After an error, including cancelled, `probes` is unchanged.
void relight(BakedProbes& probes, const SphericalHarmonics& from, const SphericalHarmonics& to, int dilation_passes = 4,
             const Control& control = {});

// ---- Lookup

/// Options of `probe_irradiance`.
struct ProbeSampling {
  bool visibility = true;    ///< weights probes by the probability that they see the position (Chebyshev's inequality)
  bool facing = true;        ///< reduces the weight of probes behind the surface
  bool validity = true;      ///< omits invalid probes if there are valid ones
  double normal_bias = 0.2;  ///< offset of the position along the normal, as a fraction of the smallest spacing

  friend bool operator==(const ProbeSampling&, const ProbeSampling&) = default;
};

/// Returns irradiance (W/m2 where radiance is W/m2/sr) at a position on a surface, from at most three bands: the eight
/// probes around it with trilinear weights, each multiplied by the weights of `sampling`, normalized to a sum of 1.
/// Positions outside the grid use the trilinear weights of the nearest position in it. Computed in float, by the code
/// that `probe_sampling_code` returns; light whose sum overflows is scaled first. Throws `Error` (invalid_argument) for
/// arrays of a wrong length, for coefficients in use that are not finite, and for a position, normal or bias out of
/// range.
[[nodiscard]] dvec3 probe_irradiance(const BakedProbes& probes, const dvec3& position, const dvec3& normal,
                                     const ProbeSampling& sampling = {});

/// Shading languages.
enum class ShaderLanguage {
  glsl,  ///< OpenGL Shading Language, 4.20 or ES 3.00 and later
  hlsl,  ///< High-Level Shading Language, shader model 5 and later
  wgsl,  ///< WebGPU Shading Language
  cpp,   ///< C++ with GLM, for a namespace that uses glm's
};

/// Returns "glsl", "hlsl", "wgsl" or "cpp".
[[nodiscard]] const char* name(ShaderLanguage language) noexcept;

/// Returns the code of `probe_irradiance` for a shader: a structure ProbeVolume, and functions whose names begin with
/// probe_. The shader must define, before it, how a probe's values are read (docs/guides/probe_grids.md lists them
/// all):
///
///   vec3 probe_coefficient(int probe, int index)      radiance, `BakedProbes::coefficients`
///   vec2 probe_distance(int probe, int column, int row)    `BakedProbes::distances`, including borders
///   float probe_share(int probe)                      1 valid, 0.001 filled, 0 neither: `probe_share` (below)
///   vec3 probe_offset(int probe)                      `BakedProbes::offsets`; vec3(0) without
[[nodiscard]] std::string probe_sampling_code(ShaderLanguage language);

/// Returns the weight of a probe in lookups that respect validity, from its entry in `BakedProbes::passes`.
[[nodiscard]] constexpr float probe_share(std::uint8_t pass) noexcept {
  return pass == 0 ? 1.0F : pass < 255 ? 0.001F : 0.0F;
}

// ---- Packing

/// Layouts of three-dimensional textures.
enum class ProbeLayout {
  /// One texture with nine values per texel and sub-volume, as LightProbeGrid and LightProbeGridWebGL of three.js r187
  /// (examples/jsm/lighting) keep in `texture`: counts[0] x counts[1] x 7 (counts[2] + 2) texels, in which each of the
  /// seven sub-volumes has a copy of its first and last slice around it. Radiance of three bands; missing bands are
  /// zero. `write_probes` adds a scene for ObjectLoader, with a LightProbe per probe.
  three,

  /// Seven textures of bricks of 4 x 4 x 4 probes, as in Unity's adaptive probe volumes with L2: L0_L1Rx, L1G_L1Ry,
  /// L1B_L1Rz, L2_0, L2_1, L2_2, L2_3. Neighbouring bricks share a layer of probes, as in Unity. Where a grid ends
  /// inside a brick, its last probes are repeated. Lambertian radiance (irradiance / pi), encoded for Unity's
  /// DecodeSH.hlsl, in the grid's axes.
  unity_l2,
  unity_l1,  ///< the first three of these, with two bands

  /// Sub-volumes stacked along z without copies, each of one coefficient: (r, g, b, validity). counts[0] x counts[1] x
  /// (bands^2 counts[2]) texels of radiance.
  plain,

  /// One texture of ambient cubes, as IrradianceVolume of Bevy reads it (irradiance_volume.wgsl): counts[0] x
  /// 2 counts[1] x 3 counts[2] texels; +x, +y and +z along z, and below each, in the second half of y, its opposite.
  /// Lambertian radiance (irradiance / pi), fitted to that of three bands over all normals by least squares; negative
  /// values are 0.
  bevy,

  /// Three arrays of two-dimensional textures with one layer per plane of y, as the DDGI of RTXGI 1.3 reads them in its
  /// axes with y up: "irradiance" (octahedral maps of 6 x 6 texels and a border: (irradiance / 2 pi)^(1 / 5)),
  /// "distance" (red and green: half the mean, and half the mean square, of `BakedProbes::distances`), "data" (offset /
  /// spacing; alpha 1 for a probe that is invalid and not filled). Requires distances.
  rtxgi,
};

/// Returns "three", "unity-l2", "unity-l1", "plain", "bevy" or "rtxgi".
[[nodiscard]] const char* name(ProbeLayout layout) noexcept;

/// A three-dimensional texture, or an array of two-dimensional ones, of four half floats per texel.
struct ProbeTexture {
  std::string name;                   ///< "texture", "L0_L1Rx", ..., "coefficients"
  std::array<int, 3> size{};          ///< texels along x, y and z
  std::vector<std::uint16_t> halves;  ///< [z][y][x][4]
  bool is_array = false;              ///< z counts layers
};

/// Probes packed as textures.
struct PackedProbes {
  ProbeLayout layout{};                ///< layout of the textures
  std::vector<ProbeTexture> textures;  ///< all textures of the layout
  std::array<int, 3> bricks{};         ///< bricks along each axis, for Unity's layouts
  std::uint64_t values_clamped = 0;    ///< values out of the range of half floats: they become +-65504, NaN 0
};

/// Packs probes as textures. Unity's brick (i, j, k) has the index i + bricks[0] (j + bricks[1] k); bricks are stored
/// along x, up to 512 (2048 texels) per row, then along y, then along z, as in Unity's pool of bricks. A grid captured
/// in the engine's own axes is packed unchanged. Throws `Error` (invalid_argument).
[[nodiscard]] PackedProbes pack_probes(const BakedProbes& probes, ProbeLayout layout, const Control& control = {});

}  // namespace welkin
