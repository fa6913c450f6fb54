// Probes as three-dimensional textures of halves, as engines lay them out.
//
// Where the layouts stand:
//   three.js r187   examples/jsm/lighting/LightProbeGridWebGL.js, _ensureRepackResources, and
//                   src/renderers/shaders/ShaderChunk/lightprobes_pars_fragment.glsl.js
//   Unity           com.unity.render-pipelines.core Runtime/Lighting/ProbeVolume: ProbeBrickPool.cs (bricks),
//                   DecodeSH.hlsl (EncodeSH, EncodeSH_L2), ProbeVolume.hlsl (SampleAPV: what lies in which texture)
//   Bevy            crates/bevy_pbr/src/light_probe/irradiance_volume.wgsl, irradiance_volume_light: which texel is
//                   looked up for which side. (The table in irradiance_volume.rs has the halves of y exchanged; the
//                   shader is what renders.)
//   RTXGI           DDGI SDK 1.3: shaders/ddgi/include/ProbeIndexing.hlsl (DDGIGetProbeTexelCoords, DDGIGetProbeUV),
//                   ProbeOctahedral.hlsl, ProbeDataCommon.hlsl, ProbeBlendingCS.hlsl (sums are divided by twice the
//                   weights) and Irradiance.hlsl (what is undone on lookup)
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "harmonics/octahedral_border.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"

namespace welkin::probes {
namespace {

using Texel = std::array<float, 4>;

constexpr int kMaxTexels = 2048;  // along an edge of a texture

/// Adds a texture that is to be filled.
void add_texture(PackedProbes& packed, const char* name, const std::array<int, 3>& size, bool is_array = false) {
  for (const int edge : size) image::require_range("texels along an edge of a texture of probes", edge, 1, kMaxTexels);
  packed.textures.push_back(
      {name, size,
       std::vector<std::uint16_t>(4 * static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                                  static_cast<std::size_t>(size[2])),
       is_array});
}

/// Returns how many values did not fit.
std::uint64_t set(ProbeTexture& texture, int x, int y, int z, const Texel& texel) {
  const std::size_t index =
      (static_cast<std::size_t>(z) * static_cast<std::size_t>(texture.size[1]) + static_cast<std::size_t>(y)) *
          static_cast<std::size_t>(texture.size[0]) +
      static_cast<std::size_t>(x);
  auto* halves = reinterpret_cast<std::uint8_t*>(texture.halves.data() + 4 * index);
  return image::encode_texels(texel.data(), 2, 2, {.channels = 2, .halves = true}, halves);
}

/// Calls visit(column, row, slice) for all columns, rows and slices, slices side by side: work as on `texels` texels.
/// Returns the sum of what it returns.
template <class Visit>
std::uint64_t for_each_place(const std::array<int, 3>& size, std::int64_t texels, const Control& control,
                             const Visit& visit) {
  std::vector<std::uint64_t> clamped(static_cast<std::size_t>(size[2]));
  const auto placement = jobs::placement_for(texels);
  jobs::run_tiles(clamped.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t slice, std::size_t /*worker*/) {
                    std::uint64_t sum = 0;
                    for (int row = 0; row < size[1]; ++row) {
                      for (int column = 0; column < size[0]; ++column)
                        sum += visit(column, row, static_cast<int>(slice));
                    }
                    clamped[slice] = sum;
                  });
  std::uint64_t sum = 0;
  for (const std::uint64_t each : clamped) sum += each;
  return sum;
}

dvec3 coefficient(const BakedProbes& probes, std::size_t probe, std::size_t index) {
  const std::size_t functions = squared(probes.bands);
  return index < functions ? probes.coefficients[probe * functions + index] : dvec3(0.0);
}

std::size_t number_of(const ProbeGrid& grid, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(grid.counts[0]) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(grid.counts[1]) * static_cast<std::size_t>(z));
}

PackedProbes pack_three(const BakedProbes& probes, const Control& control) {
  constexpr int volumes = 7;
  PackedProbes packed{ProbeLayout::three, {}, {}, 0};
  const auto [columns, rows, slices] = probes.grid.counts;
  const int padded = slices + 2;
  add_texture(packed, "texture", {columns, rows, volumes * padded});
  const auto pack_texel = [&, slices = slices](int x, int y, int slice) {
    const int z = std::clamp(slice % padded - 1, 0, slices - 1);
    // Nine colours in a row, four numbers of them a volume; the last number is 0.
    Texel texel{};
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t number = static_cast<std::size_t>(slice / padded) * 4 + c;
      if (number >= 27) continue;
      const dvec3 rgb = coefficient(probes, number_of(probes.grid, x, y, z), number / 3);
      texel[c] = static_cast<float>(rgb[static_cast<int>(number % 3)]);
    }
    return set(packed.textures[0], x, y, slice, texel);
  };
  packed.values_clamped =
      for_each_place(packed.textures[0].size, std::int64_t{64} * columns * rows * padded, control, pack_texel);
  return packed;
}

PackedProbes pack_plain(const BakedProbes& probes, const Control& control) {
  PackedProbes packed{ProbeLayout::plain, {}, {}, 0};
  const auto [columns, rows, slices] = probes.grid.counts;
  add_texture(packed, "coefficients", {columns, rows, probes.bands * probes.bands * slices});
  const auto pack_texel = [&, slices = slices](int x, int y, int slice) {
    const std::size_t probe = number_of(probes.grid, x, y, slice % slices);
    const dvec3 rgb = coefficient(probes, probe, static_cast<std::size_t>(slice / slices));
    return set(
        packed.textures[0], x, y, slice,
        {static_cast<float>(rgb.x), static_cast<float>(rgb.y), static_cast<float>(rgb.z), probes.validity[probe]});
  };
  packed.values_clamped =
      for_each_place(packed.textures[0].size, std::int64_t{64} * columns * rows * slices, control, pack_texel);
  return packed;
}

// ---- Unity

constexpr int kBrickEdge = 4;         // probes: three cells and one more
constexpr int kMaxBricksInRow = 512;  // 2048 texels

// APV_L1_ENCODING_SCALE, twice, and APV_L2_ENCODING_SCALE.
constexpr double kFirstScale = 4.0;
constexpr double kSecondScale = 3.5777088;

/// A probe in Unity's seven textures.
using UnityTexels = std::array<Texel, 7>;

/// Returns value / mean / scale + 1/2, so that 1/2 stands for 0.
float relative(double value, double mean, double scale) noexcept {
  return static_cast<float>(mean == 0.0 ? 0.5 : value / mean / scale + 0.5);
}

UnityTexels unity_texels(const BakedProbes& probes, std::size_t probe, int bands) {
  SphericalHarmonics radiance(bands);
  for (std::size_t k = 0; k < radiance.coefficients().size(); ++k) {
    radiance.coefficients()[k] = coefficient(probes, probe, k);
  }
  // unity_SHAr, SHAg, SHAb, SHBr, SHBg, SHBb, SHC. The mean is w of the first three without what z^2 of the next adds.
  const EngineLight light = engine_light_unrotated(radiance, Engine::unity);
  UnityTexels texels{};
  for (std::size_t c = 0; c < 3; ++c) {
    const dvec4& first = light.vectors[c].value;
    const dvec4& second = light.vectors[c + 3].value;
    const double mean = first.w + second.z / 3.0;
    texels[0][c] = static_cast<float>(mean);
    // A texture's w holds one axis of red; its x, y and z all axes of green or of blue.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = relative(first[static_cast<int>(axis)], mean, kFirstScale);
      if (c == 0) {
        texels[axis][3] = value;
      } else {
        texels[c][axis] = value;
      }
    }
    texels[3 + c] = {relative(second.x, mean, kSecondScale), relative(second.y, mean, kSecondScale),
                     relative(second.z / 3.0, mean, kSecondScale), relative(second.w, mean, kSecondScale)};
    texels[6][c] = relative(light.vectors[6].value[static_cast<int>(c)], mean, kSecondScale);
  }
  return texels;
}

PackedProbes pack_unity(const BakedProbes& probes, ProbeLayout layout, const Control& control) {
  constexpr std::array<const char*, 7> names{"L0_L1Rx", "L1G_L1Ry", "L1B_L1Rz", "L2_0", "L2_1", "L2_2", "L2_3"};
  PackedProbes packed{layout, {}, {}, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) packed.bricks[axis] = std::max(1, (probes.grid.counts[axis] + 1) / 3);
  const std::int64_t bricks = std::int64_t{packed.bricks[0]} * packed.bricks[1] * packed.bricks[2];
  const int in_row = static_cast<int>(std::min<std::int64_t>(bricks, kMaxBricksInRow));
  const auto row_count = (bricks + in_row - 1) / in_row;
  const int rows = static_cast<int>(std::min<std::int64_t>(row_count, kMaxBricksInRow));
  const int layers = static_cast<int>((row_count + rows - 1) / rows);
  const std::size_t count = layout == ProbeLayout::unity_l2 ? 7 : 3;
  for (std::size_t k = 0; k < count; ++k) {
    add_texture(packed, names[k], {in_row * kBrickEdge, rows * kBrickEdge, layers * kBrickEdge});
  }
  const auto pack_brick = [&](int /*column*/, int /*row*/, int brick) {
    std::uint64_t clamped = 0;
    const std::array<int, 3> first{3 * (brick % packed.bricks[0]), 3 * (brick / packed.bricks[0] % packed.bricks[1]),
                                   3 * (brick / packed.bricks[0] / packed.bricks[1])};
    const std::array<int, 3> origin{brick % in_row * kBrickEdge, brick / in_row % rows * kBrickEdge,
                                    brick / in_row / rows * kBrickEdge};
    const auto at = [&](std::size_t axis, int step) {
      return std::min(first[axis] + step, probes.grid.counts[axis] - 1);
    };
    for (int z = 0; z < kBrickEdge; ++z) {
      for (int y = 0; y < kBrickEdge; ++y) {
        for (int x = 0; x < kBrickEdge; ++x) {
          const UnityTexels texels = unity_texels(probes, number_of(probes.grid, at(0, x), at(1, y), at(2, z)),
                                                  layout == ProbeLayout::unity_l2 ? 3 : 2);
          for (std::size_t k = 0; k < count; ++k) {
            clamped += set(packed.textures[k], origin[0] + x, origin[1] + y, origin[2] + z, texels[k]);
          }
        }
      }
    }
    return clamped;
  };
  packed.values_clamped = for_each_place({1, 1, static_cast<int>(bricks)}, bricks * 100'000, control, pack_brick);
  return packed;
}

// ---- Bevy: ambient cubes

// Irradiance from radiance of three bands: y_lm(n) A_l without the direction's polynomials, as in probe_sampling.glsl.
// A(l) K(l, m) with A = pi, 2 pi / 3, pi / 4 and the harmonics' constants: pi sqrt(1 / (4 pi)), 2 pi / 3
// sqrt(3 / (4 pi)), pi / 4 sqrt(15 / (4 pi)), pi / 4 sqrt(5 / (16 pi)). (x x - y y) has half of kBand2:
// sqrt(15 / (16 pi)).
constexpr double kBand0 = 0.88622692545275801;  // sqrt(pi) / 2
constexpr double kBand1 = 1.0233267079464885;   // sqrt(pi / 3)
constexpr double kBand2 = 0.85808553080978302;  // sqrt(15 pi) / 8
constexpr double kAxial = 0.24770795610037571;  // sqrt(5 pi) / 16

dvec3 irradiance_of(const BakedProbes& probes, std::size_t probe, const dvec3& n) {
  const auto c = [&](std::size_t index) { return coefficient(probes, probe, index); };
  return kBand0 * c(0) + kBand1 * (n.y * c(1) + n.z * c(2) + n.x * c(3)) +
         kBand2 * (n.x * n.y * c(4) + n.y * n.z * c(5) + n.x * n.z * c(7) + 0.5 * (n.x * n.x - n.y * n.y) * c(8)) +
         kAxial * (3.0 * n.z * n.z - 1.0) * c(6);
}

/// The six sides -x +x -y ... of the ambient cube nearest to a probe's irradiance over pi.
///
/// A cube's light is the sum over axes of n_i^2 times the side that n_i points to. Its even part, the sum of q_i n_i^2,
/// spans band 0 and those two functions of band 2 that have no mixed terms: these are met exactly, and q_i is the
/// irradiance's even part along the axis. Of its odd part, the functions sign(n_i) n_i^2 are orthogonal over the sphere
/// with the mean square 1/5, and the mean of sign(n_i) n_i^2 times n_i is 1/4: band 1 with the slope s has the least
/// squared distance from 5/4 s.
std::array<dvec3, 6> cube_sides(const BakedProbes& probes, std::size_t probe) {
  std::array<dvec3, 6> sides;
  for (int axis = 0; axis < 3; ++axis) {
    dvec3 towards(0.0);
    towards[axis] = 1.0;
    const dvec3 ahead = irradiance_of(probes, probe, towards);
    const dvec3 behind = irradiance_of(probes, probe, -towards);
    // A side is the even part along its axis plus the odd one, or minus it on the negative side.
    const dvec3 even = 0.5 * (ahead + behind);
    const dvec3 odd = 1.25 * 0.5 * (ahead - behind);
    for (int c = 0; c < 3; ++c) {
      const auto side = static_cast<std::size_t>(2 * axis);
      sides[side][c] = std::max(0.0, even[c] - odd[c]) * std::numbers::inv_pi;
      sides[side + 1][c] = std::max(0.0, even[c] + odd[c]) * std::numbers::inv_pi;
    }
  }
  return sides;
}

// ---- RTXGI: octahedral maps

constexpr int kIrradianceTexels = 6;
constexpr double kGamma = 5.0;  // DDGIVolumeDesc::probeIrradianceEncodingGamma

/// (irradiance / 2 pi)^(1 / gamma).
float encoded(double irradiance) {
  // The cosine-weighted mean of radiance is E / pi. RTXGI's blending divides by twice the sum of cosines, so a texel
  // holds E / (2 pi), to the power 1 / gamma.
  if (!(irradiance > 0.0)) return 0.0F;
  return static_cast<float>(math::exponential(math::logarithm(irradiance / (2.0 * std::numbers::pi)) / kGamma));
}

/// Texels along an edge of a probe's map.
constexpr int kIrradianceEdge = kIrradianceTexels + 2;

std::vector<dvec3> map_directions() {
  std::vector<dvec3> directions;
  for (int row = -1; row <= kIrradianceTexels; ++row) {
    for (int column = -1; column <= kIrradianceTexels; ++column) {
      int x = column;
      int y = row;
      octahedral::move_inside(kIrradianceTexels, x, y);
      directions.push_back(octahedral_decode((x + 0.5) / kIrradianceTexels, (y + 0.5) / kIrradianceTexels));
    }
  }
  return directions;
}

/// Packs the maps of the probe at that position of the grid. Columns lie along x, rows along z, a layer per plane of y.
std::uint64_t pack_maps(std::vector<ProbeTexture>& textures, const BakedProbes& probes,
                        const std::vector<dvec3>& directions, const glm::ivec3& at) {
  const std::size_t probe = number_of(probes.grid, at.x, at.y, at.z);
  std::uint64_t clamped = 0;
  for (int texel = 0; texel < kIrradianceEdge * kIrradianceEdge; ++texel) {
    const dvec3 light = irradiance_of(probes, probe, directions[static_cast<std::size_t>(texel)]);
    clamped += set(textures[0], at.x * kIrradianceEdge + texel % kIrradianceEdge,
                   at.z * kIrradianceEdge + texel / kIrradianceEdge, at.y,
                   {encoded(light.x), encoded(light.y), encoded(light.z), 1.0F});
  }
  const int edge = probes.distance_edge();
  const float* moments = probes.distances.data() + probe * distance_floats(probes);
  for (int texel = 0; texel < edge * edge; ++texel, moments += 2) {
    clamped += set(textures[1], at.x * edge + texel % edge, at.z * edge + texel / edge, at.y,
                   {0.5F * moments[0], 0.5F * moments[1], 0.0F, 1.0F});
  }
  const dvec3 moved = probes.offsets.empty() ? dvec3(0.0) : probes.offsets[probe] / probes.grid.spacing;
  return clamped + set(textures[2], at.x, at.z, at.y,
                       {static_cast<float>(moved.x), static_cast<float>(moved.y), static_cast<float>(moved.z),
                        probes.passes[probe] == kUnfilled ? 1.0F : 0.0F});
}

PackedProbes pack_bevy(const BakedProbes& probes, const Control& control) {
  PackedProbes packed{ProbeLayout::bevy, {}, {}, 0};
  const auto [columns, rows, slices] = probes.grid.counts;
  add_texture(packed, "voxels", {columns, 2 * rows, 3 * slices});
  const auto pack_cube = [&, rows = rows, slices = slices](int x, int y, int z) {
    std::uint64_t clamped = 0;
    const auto sides = cube_sides(probes, number_of(probes.grid, x, y, z));
    for (int side = 0; side < 6; ++side) {
      const dvec3& light = sides[static_cast<std::size_t>(side)];
      const int half = side % 2 == 0 ? rows : 0;  // negative sides
      clamped += set(packed.textures[0], x, y + half, z + side / 2 * slices,
                     {static_cast<float>(light.x), static_cast<float>(light.y), static_cast<float>(light.z), 1.0F});
    }
    return clamped;
  };
  packed.values_clamped =
      for_each_place(probes.grid.counts, std::int64_t{64} * columns * rows * slices, control, pack_cube);
  return packed;
}

PackedProbes pack_rtxgi(const BakedProbes& probes, const Control& control) {
  if (probes.distance_size == 0) {
    throw Error(ErrorCode::invalid_argument,
                "ProbeLayout::rtxgi needs distances; bake the probes with depths, and a distance_size above 0");
  }
  PackedProbes packed{ProbeLayout::rtxgi, {}, {}, 0};
  const auto [columns, planes, rows] = probes.grid.counts;
  const int edge = probes.distance_edge();
  add_texture(packed, "irradiance", {columns * kIrradianceEdge, rows * kIrradianceEdge, planes}, true);
  add_texture(packed, "distance", {columns * edge, rows * edge, planes}, true);
  add_texture(packed, "data", {columns, rows, planes}, true);
  const std::vector<dvec3> directions = map_directions();
  packed.values_clamped = for_each_place({columns, rows, planes}, std::int64_t{10'000} * columns * rows * planes,
                                         control, [&](int x, int z, int y) {
                                           return pack_maps(packed.textures, probes, directions, {x, y, z});
                                         });
  return packed;
}

}  // namespace
}  // namespace welkin::probes

namespace welkin {

const char* name(ProbeLayout layout) noexcept {
  static constexpr std::array kNames{"three", "unity-l2", "unity-l1", "plain", "bevy", "rtxgi"};
  return platform::name_in<ProbeLayout::rtxgi>(kNames, layout, "");
}

PackedProbes pack_probes(const BakedProbes& probes, ProbeLayout layout, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  switch (layout) {
    case ProbeLayout::three: return probes::pack_three(probes, control);
    case ProbeLayout::unity_l2:
    case ProbeLayout::unity_l1: return probes::pack_unity(probes, layout, control);
    case ProbeLayout::plain: return probes::pack_plain(probes, control);
    case ProbeLayout::bevy: return probes::pack_bevy(probes, control);
    case ProbeLayout::rtxgi: return probes::pack_rtxgi(probes, control);
  }
  throw Error(ErrorCode::invalid_argument, "ProbeLayout: no known value; pass one of the enumeration");
}

}  // namespace welkin
