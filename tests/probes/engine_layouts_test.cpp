// Probes packed for Bevy and RTXGI, looked up by formulas written after the engines' shaders.
#include <glm/geometric.hpp>

#include "image/pixels.h"
#include "math/elementary.h"
#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// Light of three bands that is nowhere negative, distances and offsets, all different from probe to probe.
BakedProbes sample_grid(std::array<int, 3> counts, double directional) {
  BakedProbes probes;
  probes.grid = {.counts = counts, .origin = {-1.0, 2.0, 0.5}, .spacing = {0.5, 2.0, 1.0}};
  probes.bands = 3;
  probes.distance_size = 6;
  probes.distance_limit = 4.0;
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(probes.grid.size());
    probes.coefficients.emplace_back(3.0 + u, 4.0, 5.0 - u);
    for (int f = 1; f < 9; ++f) {
      probes.coefficients.emplace_back(directional * std::sin(7.0 * u + f), directional * std::cos(5.0 * u + f),
                                       directional * std::sin(3.0 * u - f));
    }
    probes.validity.push_back(1.0F);
    probes.passes.push_back(k % 5 == 3 ? 255 : k % 5 == 2 ? 1 : 0);
    for (int texel = 0; texel < 64; ++texel) {
      const double mean = 1.0 + u + 0.01 * texel;
      probes.distances.push_back(static_cast<float>(mean));
      probes.distances.push_back(static_cast<float>(mean * mean + 0.1));
    }
    probes.offsets.emplace_back(0.2 * u, -0.5 * u, 0.1);
  }
  return probes;
}

dvec3 irradiance_at(const BakedProbes& probes, std::size_t probe, const dvec3& normal) {
  return evaluate(irradiance_from_radiance(radiance_of(probes, probe)), normal);
}

std::vector<dvec3> normals_around(int count) {
  std::vector<dvec3> normals;
  for (int k = 0; k < count; ++k) {  // a spiral of even density
    const double z = 1.0 - (2.0 * k + 1.0) / count;
    const double angle = 2.399963229728653 * k;
    normals.emplace_back(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
  }
  return normals;
}

/// A texture with the filter of GPUs: bilinear in x and y, linear in z unless it is an array; edges are clamped.
dvec3 sampled(const ProbeTexture& texture, const dvec3& uvw, double layer = 0.0) {
  const dvec3 size(texture.size[0], texture.size[1], texture.size[2]);
  dvec3 point = uvw * size - 0.5;
  if (texture.is_array) point.z = layer;
  dvec3 sum(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::size_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double low = std::floor(point[axis]);
      const int step = corner >> axis & 1;
      weight *= step == 1 ? point[axis] - low : 1.0 - (point[axis] - low);
      const int at = std::clamp(static_cast<int>(low) + step, 0, texture.size[static_cast<std::size_t>(axis)] - 1);
      index =
          index * static_cast<std::size_t>(texture.size[static_cast<std::size_t>(axis)]) + static_cast<std::size_t>(at);
    }
    for (int c = 0; c < 3; ++c) {
      sum[c] +=
          weight * static_cast<double>(image::float_from_half(texture.halves[4 * index + static_cast<std::size_t>(c)]));
    }
  }
  return sum;
}

/// `irradiance_volume_light` of Bevy 0.17, irradiance_volume.wgsl, for the volume whose box the description states.
dvec3 bevy_light(const ProbeTexture& texture, const ProbeGrid& grid, const dvec3& position, const dvec3& normal) {
  const dvec3 counts(grid.counts[0], grid.counts[1], grid.counts[2]);
  const dvec3 centre = grid.origin + 0.5 * (counts - 1.0) * grid.spacing;
  const dvec3 atlas(texture.size[0], texture.size[1], texture.size[2]);
  const dvec3 resolution = atlas / dvec3(1.0, 2.0, 3.0);
  const dvec3 unit = (position - centre) / (counts * grid.spacing);
  const dvec3 uvw = glm::clamp((unit + 0.5) * resolution, dvec3(0.5), resolution - 0.5) / atlas;
  dvec3 sum(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const dvec3 side = uvw + dvec3(0.0, normal[axis] < 0.0 ? 0.5 : 0.0, axis / 3.0);
    sum += sampled(texture, side) * normal[axis] * normal[axis];
  }
  return sum;
}

}  // namespace

TEST_CASE("pack: Bevy's shader finds the light of each probe in its ambient cubes", "[probes]") {
  const BakedProbes probes = sample_grid({3, 2, 4}, 0.0);
  const PackedProbes packed = pack_probes(probes, ProbeLayout::bevy);
  REQUIRE(packed.textures.size() == 1);
  CHECK(packed.textures[0].size == std::array{3, 4, 12});
  CHECK(!packed.textures[0].is_array);
  CHECK(packed.values_clamped == 0);
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {  // light that is the same from everywhere
    for (const dvec3& normal : normals_around(20)) {
      const dvec3 found = bevy_light(packed.textures[0], probes.grid, probes.grid.position(k), normal);
      CHECK(glm::length(found - irradiance_at(probes, k, normal) / std::numbers::pi) < 2e-3);
    }
  }

  // Light along one axis at a time shows which side is where, and the sides are those of least squares.
  for (int axis = 0; axis < 3; ++axis) {
    BakedProbes lit = sample_grid({2, 3, 2}, 0.0);
    lit.coefficients[static_cast<std::size_t>(std::array{3, 1, 2}[static_cast<std::size_t>(axis)])] = dvec3(1.0);
    const ProbeTexture texture = pack_probes(lit, ProbeLayout::bevy).textures[0];
    double squares = 0.0;
    double plain = 0.0;  // of sides that are the irradiance along the axes
    for (const dvec3& normal : normals_around(2000)) {
      const dvec3 truth = irradiance_at(lit, 0, normal) / std::numbers::pi;
      const dvec3 found = bevy_light(texture, lit.grid, lit.grid.origin, normal);
      CHECK((found.y - 4.0 * 0.282095) * normal[axis] >= -1e-3);  // brighter towards the light
      squares += std::pow(found.y - truth.y, 2.0);
      dvec3 sides(0.0);
      for (int each = 0; each < 3; ++each) {
        dvec3 towards(0.0);
        towards[each] = normal[each] < 0.0 ? -1.0 : 1.0;
        sides += irradiance_at(lit, 0, towards) / std::numbers::pi * normal[each] * normal[each];
      }
      plain += std::pow(sides.y - truth.y, 2.0);
    }
    // The mean square of s n - b sign(n) n^2 is s^2 / 48 for b = 5/4 s, and s^2 / 30 for b = s; s = 2/3 sqrt(3 / 4 pi).
    const double slope = 2.0 / 3.0 * std::sqrt(3.0 / (4.0 * std::numbers::pi));
    CHECK(squares / 2000.0 == Approx(slope * slope / 48.0).epsilon(0.02));
    CHECK(plain / 2000.0 == Approx(slope * slope / 30.0).epsilon(0.02));
  }
  // Between probes light is mixed, and nothing of a neighbouring side bleeds in at the ends.
  const dvec3 outside = probes.grid.origin - 5.0;
  CHECK(glm::length(bevy_light(packed.textures[0], probes.grid, outside, {0, -1, 0}) -
                    irradiance_at(probes, 0, {0, -1, 0}) / std::numbers::pi) < 2e-3);
}

TEST_CASE("pack: RTXGI's shaders find irradiance, distances and offsets in its arrays", "[probes]") {
  const BakedProbes probes = sample_grid({3, 2, 4}, 0.4);
  const PackedProbes packed = pack_probes(probes, ProbeLayout::rtxgi);
  REQUIRE(packed.textures.size() == 3);
  CHECK(packed.textures[0].size == std::array{24, 32, 2});
  CHECK(packed.textures[1].size == std::array{24, 32, 2});
  CHECK(packed.textures[2].size == std::array{3, 4, 2});
  // DDGIGetProbeTexelCoords and DDGIGetProbeUV of ProbeIndexing.hlsl, y up; DDGIGetOctahedralCoordinates is
  // `octahedral_encode`, from 0 to 1.
  const auto uv_of = [&](std::size_t k, const dvec3& direction, double texels) {
    const std::size_t x = k % 3;
    const std::size_t z = k / 6;
    const auto [u, v] = octahedral_encode(direction);
    return dvec3((static_cast<double>(x) * (texels + 2.0) + 1.0 + u * texels) / (3.0 * (texels + 2.0)),
                 (static_cast<double>(z) * (texels + 2.0) + 1.0 + v * texels) / (4.0 * (texels + 2.0)), 0.0);
  };
  double worst = 0.0;
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {
    const auto layer = static_cast<double>(k / 3 % 2);
    for (const dvec3& normal : normals_around(100)) {
      // DDGIGetVolumeIrradiance for one probe: the power, the square, and 2 pi.
      const dvec3 stored = sampled(packed.textures[0], uv_of(k, normal, 6.0), layer);
      const dvec3 truth = irradiance_at(probes, k, normal);
      for (int c = 0; c < 3; ++c) {
        const double root = std::pow(stored[c], 5.0 * 0.5);
        worst = std::max(worst, std::abs(root * root * 2.0 * std::numbers::pi / truth[c] - 1.0));
      }
      const dvec3 moments = 2.0 * sampled(packed.textures[1], uv_of(k, normal, 6.0), layer);
      CHECK(moments.x >= 1.0);
      CHECK(moments.y - moments.x * moments.x == Approx(0.1).margin(0.06));
    }
    const ProbeTexture& data = packed.textures[2];
    const std::size_t texel = 4 * (k % 3 + 3 * (k / 6 + 4 * (k / 3 % 2)));
    const auto number = [&](std::size_t c) {
      return static_cast<double>(image::float_from_half(data.halves[texel + c]));
    };
    CHECK(glm::length(dvec3(number(0), number(1), number(2)) * probes.grid.spacing - probes.offsets[k]) < 1e-3);
    CHECK(number(3) == (probes.passes[k] == 255 ? 1.0 : 0.0));
  }
  CHECK(worst < 0.07);       // 0.059: maps of 6 x 6 texels, between which the fifth root is interpolated
  double worst_texel = 0.0;  // halves to the fifth power
  for (int texel = 0; texel < 36; ++texel) {
    const dvec3 towards = octahedral_decode((texel % 6 + 0.5) / 6.0, (texel / 6 + 0.5) / 6.0);
    const double stored = sampled(packed.textures[0], uv_of(13, towards, 6.0), 0.0).x;
    worst_texel =
        std::max(worst_texel,
                 std::abs(std::pow(stored, 5.0) * 2.0 * std::numbers::pi / irradiance_at(probes, 13, towards).x - 1.0));
  }
  CHECK(worst_texel < 0.003);
  // The border has the values from across the edge, as bilinear filters need them.
  const auto texel_at = [&](int x, int y) {
    return image::float_from_half(packed.textures[0].halves[4 * static_cast<std::size_t>(x + 24 * y)]);
  };
  CHECK(texel_at(0, 0) == texel_at(6, 6));
  CHECK(texel_at(7, 0) == texel_at(1, 6));
  for (int i = 1; i < 7; ++i) {
    CHECK(texel_at(i, 0) == texel_at(7 - i, 1));
    CHECK(texel_at(0, i) == texel_at(1, 7 - i));
    CHECK(texel_at(7, i) == texel_at(6, 7 - i));
  }

  BakedProbes flat = probes;
  flat.distance_size = 0;
  flat.distances.clear();
  CHECK(thrown_by([&] { static_cast<void>(pack_probes(flat, ProbeLayout::rtxgi)); }).says("needs distances"));
  flat.offsets.resize(3);
  CHECK(thrown_by([&] { static_cast<void>(pack_probes(flat, ProbeLayout::bevy)); }).says("offsets has 3"));
}

}  // namespace welkin::test
