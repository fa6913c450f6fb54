// Probes as ambient cubes (Bevy) and as octahedral maps (RTXGI).
//
// Where the layouts stand:
//   Bevy   crates/bevy_pbr/src/light_probe/irradiance_volume.wgsl, irradiance_volume_light: which texel is looked up
//   for
//          which side. (The table in irradiance_volume.rs has the halves of y exchanged; the shader is what renders.)
//   RTXGI  DDGI SDK 1.3: shaders/ddgi/include/ProbeIndexing.hlsl (DDGIGetProbeTexelCoords, DDGIGetProbeUV),
//          ProbeOctahedral.hlsl, ProbeDataCommon.hlsl, ProbeBlendingCS.hlsl (sums are divided by twice the weights) and
//          Irradiance.hlsl (what is undone on lookup)
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "harmonics/octahedral_border.h"
#include "math/elementary.h"
#include "probes/packing.h"
#include "welkin/core.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"

namespace welkin::probes {
namespace {

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

// ---- RTXGI

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

/// A probe's maps, and where they lie: columns along x, rows along z, a layer per plane of y.
struct ProbeTexel {
  std::size_t probe;
  int x;
  int y;
  int z;
};

std::uint64_t pack_maps(PackedProbes& packed, const std::vector<Filling>& textures, const BakedProbes& probes,
                        const std::vector<dvec3>& directions, const ProbeTexel& at) {
  std::uint64_t clamped = 0;
  for (int texel = 0; texel < kIrradianceEdge * kIrradianceEdge; ++texel) {
    const dvec3 light = irradiance_of(probes, at.probe, directions[static_cast<std::size_t>(texel)]);
    clamped += textures[0].set(packed, at.x * kIrradianceEdge + texel % kIrradianceEdge,
                               at.z * kIrradianceEdge + texel / kIrradianceEdge, at.y,
                               {encoded(light.x), encoded(light.y), encoded(light.z), 1.0F});
  }
  const int edge = probes.distance_edge();
  const float* moments = probes.distances.data() + at.probe * distance_floats(probes);
  for (int texel = 0; texel < edge * edge; ++texel, moments += 2) {
    clamped += textures[1].set(packed, at.x * edge + texel % edge, at.z * edge + texel / edge, at.y,
                               {0.5F * moments[0], 0.5F * moments[1], 0.0F, 1.0F});
  }
  const dvec3 moved = probes.offsets.empty() ? dvec3(0.0) : probes.offsets[at.probe] / probes.grid.spacing;
  return clamped + textures[2].set(packed, at.x, at.z, at.y,
                                   {static_cast<float>(moved.x), static_cast<float>(moved.y),
                                    static_cast<float>(moved.z), probes.passes[at.probe] == kUnfilled ? 1.0F : 0.0F});
}

}  // namespace

PackedProbes pack_bevy(const BakedProbes& probes, const Control& control) {
  PackedProbes packed{ProbeLayout::bevy, {}, {}, 0};
  const auto [columns, rows, slices] = probes.grid.counts;
  const Filling texture(packed, "voxels", {columns, 2 * rows, 3 * slices});
  const auto pack_slice = [&, columns = columns, rows = rows, slices = slices](int z) {
    std::uint64_t clamped = 0;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const auto sides = cube_sides(probes, number_of(probes.grid, x, y, z));
        for (int side = 0; side < 6; ++side) {
          const dvec3& light = sides[static_cast<std::size_t>(side)];
          const int half = side % 2 == 0 ? rows : 0;  // negative sides
          clamped += texture.set(
              packed, x, y + half, z + side / 2 * slices,
              {static_cast<float>(light.x), static_cast<float>(light.y), static_cast<float>(light.z), 1.0F});
        }
      }
    }
    return clamped;
  };
  packed.values_clamped = for_each_slice(slices, std::int64_t{64} * columns * rows * slices, control, pack_slice);
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
  const std::vector<Filling> textures{
      {packed, "irradiance", {columns * kIrradianceEdge, rows * kIrradianceEdge, planes}, true},
      {packed, "distance", {columns * edge, rows * edge, planes}, true},
      {packed, "data", {columns, rows, planes}, true}};
  const std::vector<dvec3> directions = map_directions();
  const auto pack_plane = [&, columns = columns, rows = rows](int y) {
    std::uint64_t clamped = 0;
    for (int z = 0; z < rows; ++z) {
      for (int x = 0; x < columns; ++x) {
        clamped += pack_maps(packed, textures, probes, directions, {number_of(probes.grid, x, y, z), x, y, z});
      }
    }
    return clamped;
  };
  packed.values_clamped = for_each_slice(planes, std::int64_t{10'000} * columns * rows * planes, control, pack_plane);
  return packed;
}

}  // namespace welkin::probes
