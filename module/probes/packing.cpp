// Probes as three-dimensional textures of halves, as engines lay them out.
//
// Where the layouts stand:
//   three.js r187   examples/jsm/lighting/LightProbeGridWebGL.js, _ensureRepackResources, and
//                   src/renderers/shaders/ShaderChunk/lightprobes_pars_fragment.glsl.js
//   Unity           com.unity.render-pipelines.core Runtime/Lighting/ProbeVolume: ProbeBrickPool.cs (bricks),
//                   DecodeSH.hlsl (EncodeSH, EncodeSH_L2), ProbeVolume.hlsl (SampleAPV: what lies in which texture)
#include "probes/packing.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/float_environment.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/probes.h"

namespace welkin {
namespace {

using probes::coefficient;
using probes::Filling;
using probes::for_each_slice;
using probes::number_of;
using probes::Texel;

constexpr int kBrickEdge = 4;         // probes: three cells and one more
constexpr int kMaxBricksInRow = 512;  // 2048 texels

/// Fills a texture whose slices are those of the grid, again and again: texel(slice, x, y).
template <class TexelAt>
std::uint64_t fill(PackedProbes& packed, const Filling& texture, const ProbeGrid& grid, int slices, std::int64_t texels,
                   const Control& control, const TexelAt& texel) {
  return for_each_slice(slices, texels, control, [&](int slice) {
    std::uint64_t clamped = 0;
    for (int y = 0; y < grid.counts[1]; ++y) {
      for (int x = 0; x < grid.counts[0]; ++x) clamped += texture.set(packed, x, y, slice, texel(slice, x, y));
    }
    return clamped;
  });
}

PackedProbes pack_three(const BakedProbes& probes, const Control& control) {
  constexpr int volumes = 7;
  PackedProbes packed{ProbeLayout::three, {}, {}, 0};
  const int columns = probes.grid.counts[0];
  const int rows = probes.grid.counts[1];
  const int slices = probes.grid.counts[2];
  const int padded = slices + 2;
  const Filling texture(packed, "texture", {columns, rows, volumes * padded});
  packed.values_clamped = fill(packed, texture, probes.grid, volumes * padded,
                               std::int64_t{64} * columns * rows * padded, control, [&](int slice, int x, int y) {
                                 const int z = std::clamp(slice % padded - 1, 0, slices - 1);
                                 // Nine colours in a row, four numbers of them a volume; the last number is 0.
                                 Texel texel{};
                                 for (std::size_t c = 0; c < 4; ++c) {
                                   const std::size_t number = static_cast<std::size_t>(slice / padded) * 4 + c;
                                   if (number >= 27) continue;
                                   texel[c] = static_cast<float>(coefficient(probes, number_of(probes.grid, x, y, z),
                                                                             number / 3)[static_cast<int>(number % 3)]);
                                 }
                                 return texel;
                               });
  return packed;
}

PackedProbes pack_plain(const BakedProbes& probes, const Control& control) {
  PackedProbes packed{ProbeLayout::plain, {}, {}, 0};
  const int columns = probes.grid.counts[0];
  const int rows = probes.grid.counts[1];
  const int slices = probes.grid.counts[2];
  const int volumes = probes.bands * probes.bands;
  const Filling texture(packed, "coefficients", {columns, rows, volumes * slices});
  packed.values_clamped = fill(packed, texture, probes.grid, volumes * slices,
                               std::int64_t{64} * columns * rows * slices, control, [&](int slice, int x, int y) {
                                 const std::size_t probe = number_of(probes.grid, x, y, slice % slices);
                                 const dvec3 rgb = coefficient(probes, probe, static_cast<std::size_t>(slice / slices));
                                 return Texel{static_cast<float>(rgb.x), static_cast<float>(rgb.y),
                                              static_cast<float>(rgb.z), probes.validity[probe]};
                               });
  return packed;
}

// ---- Unity

// APV_L1_ENCODING_SCALE, twice, and APV_L2_ENCODING_SCALE.
constexpr double kFirstScale = 4.0;
constexpr double kSecondScale = 3.5777088;

/// A probe in Unity's seven textures.
using UnityTexels = std::array<Texel, 7>;

/// Beside the mean; 1/2 stands for nothing.
float beside(double value, double mean, double scale) noexcept {
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
      const float value = beside(first[static_cast<int>(axis)], mean, kFirstScale);
      if (c == 0) {
        texels[axis][3] = value;
      } else {
        texels[c][axis] = value;
      }
    }
    texels[3 + c] = {beside(second.x, mean, kSecondScale), beside(second.y, mean, kSecondScale),
                     beside(second.z / 3.0, mean, kSecondScale), beside(second.w, mean, kSecondScale)};
    texels[6][c] = beside(light.vectors[6].value[static_cast<int>(c)], mean, kSecondScale);
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
  std::vector<Filling> textures;
  const std::size_t count = layout == ProbeLayout::unity_l2 ? 7 : 3;
  for (std::size_t k = 0; k < count; ++k) {
    textures.emplace_back(packed, names[k], std::array{in_row * kBrickEdge, rows * kBrickEdge, layers * kBrickEdge});
  }
  const auto pack_brick = [&](int brick) {
    std::uint64_t clamped = 0;
    const std::array<int, 3> first{3 * (brick % packed.bricks[0]), 3 * (brick / packed.bricks[0] % packed.bricks[1]),
                                   3 * (brick / packed.bricks[0] / packed.bricks[1])};
    const std::array<int, 3> place{brick % in_row * kBrickEdge, brick / in_row % rows * kBrickEdge,
                                   brick / in_row / rows * kBrickEdge};
    const auto at = [&](std::size_t axis, int step) {
      return std::min(first[axis] + step, probes.grid.counts[axis] - 1);
    };
    for (int z = 0; z < kBrickEdge; ++z) {
      for (int y = 0; y < kBrickEdge; ++y) {
        for (int x = 0; x < kBrickEdge; ++x) {
          const UnityTexels texels = unity_texels(probes, number_of(probes.grid, at(0, x), at(1, y), at(2, z)),
                                                  layout == ProbeLayout::unity_l2 ? 3 : 2);
          for (std::size_t k = 0; k < textures.size(); ++k) {
            clamped += textures[k].set(packed, place[0] + x, place[1] + y, place[2] + z, texels[k]);
          }
        }
      }
    }
    return clamped;
  };
  packed.values_clamped = for_each_slice(static_cast<int>(bricks), bricks * 100'000, control, pack_brick);
  return packed;
}

}  // namespace

const char* name(ProbeLayout layout) noexcept {
  switch (layout) {
    case ProbeLayout::three: return "three";
    case ProbeLayout::unity_l2: return "unity-l2";
    case ProbeLayout::unity_l1: return "unity-l1";
    case ProbeLayout::plain: return "plain";
    case ProbeLayout::bevy: return "bevy";
    case ProbeLayout::rtxgi: return "rtxgi";
  }
  return "";
}

PackedProbes pack_probes(const BakedProbes& probes, ProbeLayout layout, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  switch (layout) {
    case ProbeLayout::three: return pack_three(probes, control);
    case ProbeLayout::unity_l2:
    case ProbeLayout::unity_l1: return pack_unity(probes, layout, control);
    case ProbeLayout::plain: return pack_plain(probes, control);
    case ProbeLayout::bevy: return probes::pack_bevy(probes, control);
    case ProbeLayout::rtxgi: return probes::pack_rtxgi(probes, control);
  }
  throw Error(ErrorCode::invalid_argument, "ProbeLayout: no known value; pass one of the enumeration");
}

}  // namespace welkin
