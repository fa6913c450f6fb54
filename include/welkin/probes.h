// Grids of probes: what a level's captured cubemaps tell about its diffuse light, and who sees whom.
//
//   welkin::ProbeGrid grid{.counts = {12, 4, 12}, .origin = {-11, 0.5, -11}, .spacing = {2, 2, 2}};
//   welkin::BakedProbes probes = welkin::bake_probes(grid, cubes, depths);       // one of each a probe
//   welkin::dvec3 light = welkin::probe_irradiance(probes, position, normal);    // W/m2
//
// Cubemaps, depths and directions are in the axes of `CubemapView`; a grid's axes are the same.
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

// ---- What is captured

/// Where probes stand: at the corners of boxes, all of one size. Probe (i, j, k) along x, y and z is number
/// i + counts[0] (j + counts[1] k).
struct ProbeGrid {
  std::array<int, 3> counts{1, 1, 1};  ///< probes along x, y and z: each 1 to 2048, all together up to 2^24
  dvec3 origin{};                      ///< where probe 0 stands: up to 1e15 away along each axis
  dvec3 spacing{1.0};                  ///< from a probe to the next, 1e-9 to 1e12, also where there is but one

  /// How many probes there are.
  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
           static_cast<std::size_t>(counts[2]);
  }
  /// Where a probe stands.
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

/// Distances along the rays through the texels' centres, from the probe to what it sees there: straight, not along the
/// face's normal. Below 0: what is seen is a surface's back, so many units away. Infinite: nothing is there but the
/// environment. Faces as in `CubemapView`.
struct DepthView {
  std::array<const float*, 6> faces{};  ///< first texel of each face
  int size = 0;                         ///< texels along an edge, 1 to 1024; need not be that of the colours
  std::ptrdiff_t row_stride_bytes = 0;  ///< from a row to the next; 0: rows are packed; negative: bottom-up
};

// ---- Baking

/// How probes are baked.
struct ProbeOptions {
  /// 1 to 4 bands; the policy for pixels; how texels are integrated.
  ProjectionOptions projection{};

  /// What is seen nearer than this share of the smallest spacing counts against a probe, as backs do at any distance.
  double near_share = 0.1;

  /// A probe is valid if at least this share of the sphere, by solid angle, is neither near nor a back. 0.75 is what
  /// Unity's adaptive probe volumes take as their threshold of dilation.
  double valid_share = 0.75;

  /// Texels along an edge of a probe's octahedral map of distances, the border of one texel around them not counted: 1
  /// to 64; 0: no maps.
  int distance_size = 8;

  /// Power of the cosine by which distances about a texel's direction count: 1 to 1024. Majercik et al. take 50.
  int distance_power = 50;

  /// Distances above it count as it, so that what is far away does not spread; 0: one and a half diagonals of a cell.
  double distance_limit = 0.0;

  /// How many times valid probes are spread to their invalid neighbours: 0 to 1024.
  int dilation_passes = 4;

  /// Bands of environments for which `relight` is to work: 1 to 13, and no more than 16 together with those of the
  /// projection, less 1. 0: nothing is kept for it. Needs depths.
  int environment_bands = 0;

  friend bool operator==(const ProbeOptions&, const ProbeOptions&) = default;
};

/// What is known of a grid of probes. Arrays have so many values for each probe, probe after probe.
struct BakedProbes {
  ProbeGrid grid{};           ///< where they stand
  int bands = 0;              ///< of the radiance: 1 to 4
  int distance_size = 0;      ///< of the maps of distances, without their border; 0: there are none
  double distance_limit = 0;  ///< what distances above it were taken for
  int sky_bands = 0;          ///< of the visibility of the environment; 0: it was not kept

  /// [bands^2] Coefficients of radiance, in the order of `SphericalHarmonics::coefficients`. Of invalid probes those of
  /// their neighbours, if `passes` says so, else what was captured.
  std::vector<dvec3> coefficients;

  /// [1] Share of the sphere that is neither near nor a back: 0 to 1. 1 without depths.
  std::vector<float> validity;

  /// [1] 0: valid. n from 1 to 254: invalid, and filled by pass n of the dilation (254 for later ones). 255: invalid.
  std::vector<std::uint8_t> passes;

  /// [(distance_size + 2)^2][2] Mean distance and mean of its square about each texel's direction, row 0 first, as
  /// `octahedral_place` has it inside the border. Backs count by their distance. Not dilated.
  std::vector<float> distances;

  /// [sky_bands^2] Coefficients of the function that is 1 where a probe sees the environment and 0 elsewhere.
  std::vector<double> sky;

  ProjectionDiagnostics diagnostics;  ///< of all cubemaps together, as of `project_many`
  std::size_t invalid = 0;            ///< how many probes are invalid
  std::size_t unfilled = 0;           ///< how many of those no pass has filled

  /// Texels along an edge of a map of distances, border included; 0: there is none.
  [[nodiscard]] int distance_edge() const noexcept { return distance_size > 0 ? distance_size + 2 : 0; }
};

/// Bakes a grid. `cubes`: one a probe, in the grid's order, of any sizes and formats. `depths`: one a probe, all of one
/// size, or none: then all probes are valid, and there are neither distances nor visibility of the sky.
///
/// - Radiance: `project_many`, with its bits and errors.
/// - Distances: texels are averaged first in blocks, so that no more than 16 blocks lie along an edge (exactly, by
///   solid angle). A map's texel is the mean of blocks by solid angle times max(0, cosine)^power of the angle between
///   the texel's direction and the middle of the block, corrected for variation within the block
///   (docs/guides/probe_grids.md).
/// - Validity: by the solid angles of texels.
/// - Dilation: see `dilate`.
/// - Visibility of the sky: as `project` with exact quadrature, so many bands as relighting needs.
///
/// Parallel over probes, in double, in one order: the same bits on any number of threads and instruction set. Nothing
/// is allocated for each probe. Throws `Error`: invalid_argument (grid, options, views, numbers of them; the message
/// says which probe), rejected_pixel (as `project_many`, and for a depth that is NaN), cancelled.
[[nodiscard]] BakedProbes bake_probes(const ProbeGrid& grid, std::span<const CubemapView> cubes,
                                      std::span<const DepthView> depths = {}, const ProbeOptions& options = {},
                                      const Control& control = {});

/// Bakes only the probes that are named again, each with its new cubemap and, if the grid was baked with them, its
/// depths; then dilates all. The very bits of `bake_probes` of everything. `options` must be those of the first bake.
/// The diagnostics become those of the probes that were baked. Throws as above, and invalid_argument for a number
/// that is not in the grid or stands twice; then, or if cancelled, `probes` is what it was. In messages about a cubemap
/// or depths, a probe's number is its place among those that are named.
void update_probes(BakedProbes& probes, std::span<const std::size_t> changed, std::span<const CubemapView> cubes,
                   std::span<const DepthView> depths = {}, const ProbeOptions& options = {},
                   const Control& control = {});

/// Gives invalid probes the light of their neighbours. In each pass, a probe that has none yet becomes the mean of
/// those of its up to 26 neighbours that had light before the pass, weighted by 1 / distance^2. Does what was filled
/// before again. Sets `passes`, `invalid` and `unfilled`. Throws `Error`: invalid_argument; cancelled, after which what
/// is filled is in part old and in part new: dilate again.
void dilate(BakedProbes& probes, int most_passes = 4, const Control& control = {});

/// The same probes with each one's coefficients windowed by `apply_window`; for drawing and packing. (Only the others
/// can be relit.) Throws as `apply_window`, naming the probe, and cancelled.
[[nodiscard]] BakedProbes windowed(const BakedProbes& probes, Window window, double width = 0.0,
                                   const Control& control = {});

// ---- Relighting

/// What the probes would have captured of another environment, as far as they see it themselves: adds the difference
/// of the two environments, seen through each probe's visibility of the sky, and dilates again (`dilation_passes`).
/// What surfaces reflect stays as it was; if the capture was of the environment alone, before black surfaces, nothing
/// is left out.
///
/// `from`: radiance of the environment of the capture, or of the last call; `to`: of the new one (turned, scaled, with
/// another sun). Bands above `environment_bands` of the bake are left out: an environment with no more bands is seen
/// exactly, up to the texels of the depths; a sun becomes a lobe as wide as so many bands make it.
///
/// `dilation_passes`: as in the bake. With 0, what was filled stays, and has the change that its own probe sees.
///
/// Cost: bands^2 x sky_bands^2 multiplications a probe and channel. Linear in `to` - `from`. The same bits everywhere.
/// Throws `Error`: invalid_argument (no visibility was kept; a coefficient that is not finite or beyond 1e100, which
/// the message names), cancelled: then `probes` is what it was.
void relight(BakedProbes& probes, const SphericalHarmonics& from, const SphericalHarmonics& to, int dilation_passes = 4,
             const Control& control = {});

// ---- Looking up

/// How a grid is looked up.
struct ProbeSampling {
  bool visibility = true;    ///< weigh probes by the chance that they see the place (Chebyshev's inequality)
  bool facing = true;        ///< weigh probes less that lie behind the surface
  bool validity = true;      ///< leave invalid probes out where valid ones are at hand
  double normal_bias = 0.2;  ///< the place that is looked up lies so far along the normal: share of smallest spacing

  friend bool operator==(const ProbeSampling&, const ProbeSampling&) = default;
};

/// Irradiance (W/m2 where radiance is W/m2/sr) at a place on a surface, of three bands at most: the eight probes about
/// it by trilinear weights, each times the weights that `sampling` asks for, their sum being 1. Outside of the
/// grid the trilinear weights are those of the nearest place in it. Computed in floats by the code that
/// `probe_sampling_code` gives; light that floats cannot sum is scaled first. Throws `Error` (invalid_argument) for
/// probes whose arrays do not have the lengths that they must or hold coefficients in use that are
/// not finite, and for a place, normal or bias that is out of range.
[[nodiscard]] dvec3 probe_irradiance(const BakedProbes& probes, const dvec3& position, const dvec3& normal,
                                     const ProbeSampling& sampling = {});

/// A language that shaders are written in.
enum class ShaderLanguage {
  glsl,  ///< OpenGL Shading Language, from 4.20 or ES 3.00 on
  hlsl,  ///< High-Level Shading Language, from shader model 5 on
  wgsl,  ///< WebGPU Shading Language
  cpp,   ///< C++ with GLM, to stand in a namespace that uses glm's
};

/// "glsl", "hlsl", "wgsl", "cpp"
[[nodiscard]] const char* name(ShaderLanguage language) noexcept;

/// The code of `probe_irradiance` for a shader: a structure ProbeVolume and functions whose names begin with probe_.
/// All languages are made of one source. The shader has to define, before it, how a probe's numbers are read
/// (docs/guides/probe_grids.md has all of them):
///
///   vec3 probe_coefficient(int probe, int index)      radiance, `BakedProbes::coefficients`
///   vec2 probe_distance(int probe, int column, int row)    `BakedProbes::distances`, border included
///   float probe_share(int probe)                      1 valid, 0.001 filled, 0 neither: `probe_share` (below)
[[nodiscard]] std::string probe_sampling_code(ShaderLanguage language);

/// What a probe counts in look-ups that heed validity, by its entry in `BakedProbes::passes`.
[[nodiscard]] constexpr float probe_share(std::uint8_t pass) noexcept {
  return pass == 0 ? 1.0F : pass < 255 ? 0.001F : 0.0F;
}

// ---- Packing

/// Whose three-dimensional textures.
enum class ProbeLayout {
  /// One texture, nine values a texel and sub-volume: what LightProbeGrid and LightProbeGridWebGL of three.js r187
  /// (examples/jsm/lighting) keep in `texture`: counts[0] x counts[1] x 7 (counts[2] + 2) texels, each of the seven
  /// sub-volumes with a copy of its first and last slice around it. Radiance of three bands; missing bands are zero.
  three,

  /// Seven textures of bricks of 4 x 4 x 4 probes, as Unity's adaptive probe volumes have them with L2: L0_L1Rx,
  /// L1G_L1Ry, L1B_L1Rz, L2_0, L2_1, L2_2, L2_3. Neighbouring bricks share a layer of probes, as they do in Unity;
  /// where a grid ends inside a brick its last probes are repeated. Lambertian radiance (irradiance / pi), encoded as
  /// Unity's DecodeSH.hlsl decodes it. In the axes of the grid.
  unity_l2,
  unity_l1,  ///< the first three of these alone, with L0 of two bands

  /// Sub-volumes one after the other along z without copies, each of one coefficient: (r, g, b, validity).
  /// counts[0] x counts[1] x (bands^2 counts[2]) texels of radiance.
  plain,
};

/// "three", "unity-l2", "unity-l1", "plain"
[[nodiscard]] const char* name(ProbeLayout layout) noexcept;

/// A three-dimensional texture of four halves a texel.
struct ProbeTexture {
  std::string name;                   ///< "texture", "L0_L1Rx", ..., "coefficients"
  std::array<int, 3> size{};          ///< texels along x, y and z
  std::vector<std::uint16_t> halves;  ///< [z][y][x][4]
};

/// Probes as textures.
struct PackedProbes {
  ProbeLayout layout{};                ///< how they are packed
  std::vector<ProbeTexture> textures;  ///< all of them
  std::array<int, 3> bricks{};         ///< along each axis; of Unity's layouts
  std::uint64_t values_clamped = 0;    ///< values that halves could not hold: they are +-65504, NaN 0
};

/// Packs probes. Unity's bricks lie one after the other along x, (i, j, k) of them being number i + bricks[0] (j +
/// bricks[1] k), up to 512 (2048 texels) a row, then along y, then along z, as its pool of bricks does. A grid whose
/// axes are the engine's own (captured by the engine) is packed as it stands. The same bits everywhere. Throws `Error`:
/// invalid_argument, cancelled.
[[nodiscard]] PackedProbes pack_probes(const BakedProbes& probes, ProbeLayout layout, const Control& control = {});

}  // namespace welkin
