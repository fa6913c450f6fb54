// Probes packed as textures, and read back as the engines read them.
#include <Imath/half.h>

#include <glm/geometric.hpp>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/engines.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

namespace {

/// Returns probes whose coefficients halves hold exactly, all different; band 0 is large.
BakedProbes made_up(std::array<int, 3> counts, int bands) {
  BakedProbes probes;
  probes.grid.counts = counts;
  probes.bands = bands;
  const auto functions = static_cast<std::size_t>(bands * bands);
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {
    for (std::size_t f = 0; f < functions; ++f) {
      const double number =
          static_cast<double>(f == 0 ? 32 : 0) + static_cast<double>(k) + static_cast<double>(f) / 16.0;
      probes.coefficients.emplace_back(number, number + 0.25, f % 2 == 0 ? number : -number);
    }
    probes.validity.push_back(static_cast<float>(k % 8) / 8.0F);
    probes.passes.push_back(0);
  }
  return probes;
}

double value(const ProbeTexture& texture, int x, int y, int z, int channel) {
  const auto slot =
      (static_cast<std::size_t>(z) * static_cast<std::size_t>(texture.size[1]) + static_cast<std::size_t>(y)) *
          static_cast<std::size_t>(texture.size[0]) +
      static_cast<std::size_t>(x);
  Imath::half half;
  half.setBits(texture.halves[4 * slot + static_cast<std::size_t>(channel)]);
  return static_cast<double>(static_cast<float>(half));
}

dvec3 coefficient(const BakedProbes& probes, std::size_t probe, int index) {
  return probes
      .coefficients[probe * static_cast<std::size_t>(probes.bands * probes.bands) + static_cast<std::size_t>(index)];
}

template <class Visit>
void for_each_probe(const ProbeGrid& grid, const Visit& visit) {
  std::size_t probe = 0;
  for (int z = 0; z < grid.counts[2]; ++z) {
    for (int y = 0; y < grid.counts[1]; ++y) {
      for (int x = 0; x < grid.counts[0]; ++x) visit(x, y, z, probe++);
    }
  }
}

}  // namespace

TEST_CASE("pack: three.js's atlas has seven volumes, each between copies of its ends", "[probes]") {
  for (const std::array<int, 3> counts : {std::array{1, 1, 1}, std::array{2, 3, 7}, std::array{3, 1, 2}}) {
    for (const int bands : {1, 2, 3, 4}) {
      CAPTURE(counts, bands);
      const BakedProbes probes = made_up(counts, bands);
      const PackedProbes packed = pack_probes(probes, ProbeLayout::three);
      REQUIRE(packed.textures.size() == 1);
      const ProbeTexture& texture = packed.textures[0];
      CHECK(texture.name == "texture");
      CHECK(texture.size == std::array{counts[0], counts[1], 7 * (counts[2] + 2)});
      CHECK(packed.values_clamped == 0);
      for_each_probe(probes.grid, [&](int x, int y, int z, std::size_t probe) {
        for (int number = 0; number < 28; ++number) {
          const int slice = number / 4 * (counts[2] + 2);
          const double wanted =
              number < 27 && number / 3 < bands * bands ? coefficient(probes, probe, number / 3)[number % 3] : 0.0;
          REQUIRE(value(texture, x, y, slice + 1 + z, number % 4) == wanted);
          if (z == 0) REQUIRE(value(texture, x, y, slice, number % 4) == wanted);
          if (z == counts[2] - 1) REQUIRE(value(texture, x, y, slice + 1 + counts[2], number % 4) == wanted);
        }
      });
    }
  }
}

TEST_CASE("pack: the plain layout has a volume a coefficient, and validity beside each", "[probes]") {
  for (const int bands : {1, 4}) {
    const BakedProbes probes = made_up({3, 2, 7}, bands);
    const PackedProbes packed = pack_probes(probes, ProbeLayout::plain);
    const ProbeTexture& texture = packed.textures.at(0);
    CHECK(texture.size == std::array{3, 2, 7 * bands * bands});
    for_each_probe(probes.grid, [&](int x, int y, int z, std::size_t probe) {
      for (int f = 0; f < bands * bands; ++f) {
        for (int c = 0; c < 3; ++c) REQUIRE(value(texture, x, y, f * 7 + z, c) == coefficient(probes, probe, f)[c]);
        REQUIRE(value(texture, x, y, f * 7 + z, 3) == static_cast<double>(probes.validity[probe]));
      }
    });
  }
}

TEST_CASE("pack: Unity's shader reads the irradiance of each probe out of its bricks", "[probes]") {
  for (const std::array<int, 3> counts : {std::array{1, 1, 1}, std::array{2, 3, 7}, std::array{7, 5, 8}}) {
    BakedProbes probes = made_up(counts, 3);
    for (std::size_t k = 0; k < probes.coefficients.size(); ++k) {
      if (k % 9 != 0) probes.coefficients[k] /= 32.0;  // near the realistic share of higher bands
    }
    for (const ProbeLayout layout : {ProbeLayout::unity_l2, ProbeLayout::unity_l1}) {
      const bool second = layout == ProbeLayout::unity_l2;
      CAPTURE(counts, second);
      const PackedProbes packed = pack_probes(probes, layout);
      REQUIRE(packed.textures.size() == (second ? 7 : 3));
      const auto bricks_of = [](int count) { return std::max(1, (count + 1) / 3); };
      CHECK(packed.bricks == std::array{bricks_of(counts[0]), bricks_of(counts[1]), bricks_of(counts[2])});
      const int whole = packed.bricks[0] * packed.bricks[1] * packed.bricks[2];
      CHECK(packed.textures[0].size == std::array{4 * whole, 4, 4});
      CHECK(packed.values_clamped == 0);
      for (int brick = 0; brick < whole; ++brick) {
        const std::array first{3 * (brick % packed.bricks[0]), 3 * (brick / packed.bricks[0] % packed.bricks[1]),
                               3 * (brick / packed.bricks[0] / packed.bricks[1])};
        for (int k = 0; k < 64; ++k) {
          const std::array step{k % 4, k / 4 % 4, k / 16};
          std::array<int, 3> at{};
          for (std::size_t a = 0; a < 3; ++a) at[a] = std::min(first[a] + step[a], counts[a] - 1);
          const auto probe = static_cast<std::size_t>(at[0] + counts[0] * (at[1] + counts[1] * at[2]));
          const auto read = [&](std::size_t texture, int channel) {
            return value(packed.textures[texture], 4 * brick + step[0], step[1], step[2], channel);
          };
          const SphericalHarmonics radiance = resized(radiance_of(probes, probe), second ? 3 : 2);
          const SphericalHarmonics lambertian = lambertian_from_irradiance(irradiance_from_radiance(radiance));
          for (const dvec3 raw : {dvec3(0, 1, 0), dvec3(1, -2, 0.5), dvec3(-1, 0.3, -0.7)}) {
            const dvec3 n = glm::normalize(raw);
            const dvec3 wanted = evaluate(lambertian, n);
            for (int c = 0; c < 3; ++c) {
              const auto channel = static_cast<std::size_t>(c);
              // DecodeSH: band 1 is stored relative to the mean, around 1/2, times 4; band 2 times 3.5777088.
              const double mean = read(0, c);
              const auto axis_value = [&](int axis) {
                return c == 0 ? read(static_cast<std::size_t>(axis), 3) : read(channel, axis);
              };
              double found = mean;
              for (int axis = 0; axis < 3; ++axis) found += (axis_value(axis) - 0.5) * 4.0 * mean * n[axis];
              if (second) {
                const auto part = [&](std::size_t texture, int slot) {
                  return (read(texture, slot) - 0.5) * 3.5777088 * mean;
                };
                const double zz = part(3 + channel, 2);
                found += -zz + part(3 + channel, 0) * n.x * n.y + part(3 + channel, 1) * n.y * n.z +
                         3.0 * zz * n.z * n.z + part(3 + channel, 3) * n.z * n.x + part(6, c) * (n.x * n.x - n.y * n.y);
              }
              REQUIRE(found == Approx(wanted[c]).epsilon(0.005));
            }
          }
        }
      }
    }
  }
}

TEST_CASE("pack: 512 of Unity's bricks lie in a row", "[probes]") {
  BakedProbes probes = made_up({121, 16, 13}, 1);
  for (std::size_t k = 0; k < probes.coefficients.size(); ++k) {
    probes.coefficients[k] = dvec3(static_cast<double>(k % 2048), static_cast<double>(k / 2048), 1.0);
  }
  const PackedProbes packed = pack_probes(probes, ProbeLayout::unity_l1);
  CHECK(packed.bricks == std::array{40, 5, 4});
  CHECK(packed.textures[0].size == std::array{2048, 8, 4});
  // Brick (7, 3, 3) is number 727; its probe (2, 1, 3) is (23, 10, 12) of the grid.
  const std::size_t probe = 23 + 121 * (10 + 16 * 12);
  const double scale = value(packed.textures[0], 4 * (727 - 512) + 2, 4 + 1, 3, 2);
  CHECK(value(packed.textures[0], 4 * (727 - 512) + 2, 4 + 1, 3, 0) ==
        Approx(static_cast<double>(probe % 2048) * scale).epsilon(1e-3));
  CHECK(value(packed.textures[0], 4 * (727 - 512) + 2, 4 + 1, 3, 1) ==
        Approx(static_cast<double>(probe / 2048) * scale).epsilon(1e-3));
}

TEST_CASE("pack: what halves cannot hold is counted; black stays black", "[probes]") {
  BakedProbes probes = made_up({2, 1, 1}, 1);
  probes.coefficients = {dvec3(1e6, -1e6, std::numeric_limits<double>::quiet_NaN()), dvec3(0.0)};
  const PackedProbes plain = pack_probes(probes, ProbeLayout::plain);
  CHECK(plain.values_clamped == 3);
  CHECK(value(plain.textures[0], 0, 0, 0, 0) == 65504.0);
  CHECK(value(plain.textures[0], 0, 0, 0, 1) == -65504.0);
  CHECK(value(plain.textures[0], 0, 0, 0, 2) == 0.0);
  const PackedProbes unity = pack_probes(probes, ProbeLayout::unity_l2);
  CHECK(value(unity.textures[0], 1, 0, 0, 0) == 0.0);
  CHECK(value(unity.textures[5], 1, 0, 0, 3) == 0.5);
  CHECK(thrown_by([&] { static_cast<void>(pack_probes(made_up({2, 1, 300}, 1), ProbeLayout::three)); }).says("2114"));
}

// Bevy and RTXGI, by formulas written after their shaders.

namespace {

/// Returns probes with three bands of nowhere negative light, distances and offsets; all differ from probe to probe.
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
    std::array<int, 3> at{};
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::floor(point[axis]);
      const int step = corner >> axis & 1;
      weight *= step == 1 ? point[axis] - low : 1.0 - (point[axis] - low);
      const auto a = static_cast<std::size_t>(axis);
      at[a] = std::clamp(static_cast<int>(low) + step, 0, texture.size[a] - 1);
    }
    for (int c = 0; c < 3; ++c) sum[c] += weight * value(texture, at[0], at[1], at[2], c);
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
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {  // light that is the same from every direction
    for (const dvec3& normal : normals_around(20)) {
      const dvec3 found = bevy_light(packed.textures[0], probes.grid, probes.grid.position(k), normal);
      CHECK(glm::length(found - irradiance_at(probes, k, normal) / std::numbers::pi) < 2e-3);
    }
  }

  // Light along one axis at a time shows the position of each side, and the sides are least-squares fits.
  for (int axis = 0; axis < 3; ++axis) {
    BakedProbes lit = sample_grid({2, 3, 2}, 0.0);
    lit.coefficients[static_cast<std::size_t>(std::array{3, 1, 2}[static_cast<std::size_t>(axis)])] = dvec3(1.0);
    const ProbeTexture texture = pack_probes(lit, ProbeLayout::bevy).textures[0];
    double squares = 0.0;
    double plain = 0.0;  // error of sides that are the irradiance along the axes
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
  // Light is interpolated between probes, and no neighbouring side bleeds in at the ends.
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
    const int index = static_cast<int>(k);
    const auto number = [&](int c) { return value(packed.textures[2], index % 3, index / 6, index / 3 % 2, c); };
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
  const auto texel_at = [&](int x, int y) { return value(packed.textures[0], x, y, 0, 0); };
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
