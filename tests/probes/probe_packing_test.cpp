// Probes as textures, read back as the engines read them.
#include <Imath/half.h>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/engines.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

namespace {

/// Coefficients that halves hold exactly, all different; band 0 is large.
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
      if (k % 9 != 0) probes.coefficients[k] /= 32.0;  // near what light has beside its mean
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
              // DecodeSH: first bands are taken beside the mean, around 1/2, times 4; second ones times 3.5777088.
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

// Another environment for probes that were captured.

namespace {

/// An environment of so many bands that is nowhere dark.
SphericalHarmonics made_up(int bands, double seed) {
  SphericalHarmonics light(bands);
  for (std::size_t k = 0; k < light.coefficients().size(); ++k) {
    const double number = std::sin(seed + 3.7 * static_cast<double>(k));
    light.coefficients()[k] = dvec3(0.3 * number, 0.2 * number * number, -0.25 * number);
  }
  light.at(0, 0) = dvec3(8.0, 7.0, 9.0);
  return light;
}

const ProbeGrid kGrid{.counts = {3, 2, 2}, .spacing = {1, 1, 1}};

/// What a probe sees through a window in front of it; walls are lit from elsewhere.
bool sees_sky(std::size_t probe, const dvec3& d) {
  const double rotation = 0.5 * static_cast<double>(probe);
  return d.y > 0.1 && std::sin(rotation) * d.x + std::cos(rotation) * d.z > -0.6;
}

Captures captured(const SphericalHarmonics& environment) {
  return {kGrid.size(), 64,
          [&](std::size_t probe, const dvec3& d) {
            return sees_sky(probe, d) ? evaluate(environment, d) : dvec3(0.2, 0.1, 0.3);
          },
          64, [](std::size_t probe, const dvec3& d) { return sees_sky(probe, d) ? kNothing : 2.0F; }};
}

double difference(const BakedProbes& a, const BakedProbes& b) {
  double square = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < a.coefficients.size(); ++k) {
    square += glm::dot(a.coefficients[k] - b.coefficients[k], a.coefficients[k] - b.coefficients[k]);
    whole += glm::dot(a.coefficients[k], a.coefficients[k]);
  }
  return std::sqrt(square / whole);
}

const ProbeOptions kOptions{.projection = {.bands = 3}, .environment_bands = 4};

}  // namespace

TEST_CASE("relight: gives what capturing again gives, of any new, turned or brighter environment", "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const std::vector<SphericalHarmonics> others{made_up(4, 2.1),
                                               rotate(from, Quaternion{.w = 0.6, .x = 0.3, .y = 0.7, .z = -0.2}),
                                               scale(from, dvec3(3, 2, 0.1))};
  const Captures before = captured(from);
  const BakedProbes baked = before.bake(kGrid, kOptions);
  for (const SphericalHarmonics& to : others) {
    const Captures after = captured(to);
    const BakedProbes again = after.bake(kGrid, kOptions);
    BakedProbes relit = baked;
    relight(relit, from, to);
    CHECK(difference(again, baked) > 0.02);
    // Texels of 1/64 stand for their middles in what is captured.
    CHECK(difference(again, relit) < 3e-4);
    // And the way back.
    relight(relit, to, from);
    CHECK(difference(baked, relit) < 1e-14);
  }
}

TEST_CASE("relight: is linear, and the same on any number of threads", "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const SphericalHarmonics to = made_up(4, 1.3);
  const Captures captures = captured(from);
  const BakedProbes baked = captures.bake(kGrid, kOptions);
  BakedProbes once = baked;
  BakedProbes twice = baked;
  relight(once, from, to);
  run_with_threads(3, [&] { relight(twice, from, add(to, add(to, scale(from, dvec3(-1.0))))); });
  for (std::size_t k = 0; k < baked.coefficients.size(); ++k) {
    const dvec3 step = once.coefficients[k] - baked.coefficients[k];
    CHECK(glm::length(twice.coefficients[k] - baked.coefficients[k] - 2.0 * step) < 1e-12);
  }
  BakedProbes alone = baked;
  run_with_threads(1, [&] { relight(alone, from, to); });
  CHECK(same_bytes<dvec3>(once.coefficients, alone.coefficients));
}

TEST_CASE("relight: a probe that sees everything has the environment itself, one in a box nothing", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const SphericalHarmonics from = made_up(2, 0.4);
  const SphericalHarmonics to = made_up(5, 5.0);
  const Captures captures(
      2, 8, [&](std::size_t, const dvec3&) { return dvec3(1.0); }, 8,
      [](std::size_t probe, const dvec3&) { return probe == 0 ? kNothing : 3.0F; });
  BakedProbes probes = captures.bake(grid, {.projection = {.bands = 3}, .environment_bands = 3});
  const BakedProbes before = probes;
  CHECK(before.sky[0] == Approx(std::sqrt(4.0 * std::numbers::pi)));
  relight(probes, from, to);
  const SphericalHarmonics change = add(to, scale(from, dvec3(-1.0)));
  for (std::size_t k = 0; k < 9; ++k) {
    CHECK(glm::length(probes.coefficients[k] - before.coefficients[k] - change.coefficients()[k]) < 1e-5);
    CHECK(probes.coefficients[9 + k] == before.coefficients[9 + k]);
  }
}

TEST_CASE("relight: invalid probes get their neighbours' new light", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const Captures captures(
      2, 4, [&](std::size_t, const dvec3&) { return dvec3(1.0); }, 4,
      [](std::size_t probe, const dvec3&) { return probe == 0 ? kNothing : -3.0F; });
  BakedProbes probes = captures.bake(grid, {.environment_bands = 1});
  CHECK(probes.invalid == 1);
  relight(probes, constant_radiance(dvec3(1.0)), constant_radiance(dvec3(4.0)));
  CHECK(probes.coefficients[9] == probes.coefficients[0]);
  CHECK(probes.coefficients[9].x == Approx(4.0 * std::sqrt(4.0 * std::numbers::pi)));
}

TEST_CASE("relight: refuses coefficients that are not finite or too large, names them, and changes nothing",
          "[probes]") {
  const SphericalHarmonics from = made_up(4, 0.3);
  const Captures captures = captured(from);
  BakedProbes probes = captures.bake(kGrid, kOptions);
  const BakedProbes before = probes;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {nan, infinity, -infinity, 1e308, -1e101}) {
    SphericalHarmonics light = from;
    light.at(2, -1).y = wrong;
    CAPTURE(wrong);
    for (const bool is_new : {false, true}) {
      const ThrownError error = thrown_by([&] { relight(probes, is_new ? from : light, is_new ? light : from); });
      CHECK(error.code == ErrorCode::invalid_argument);
      CHECK(error.says(is_new ? "coefficient (2, -1) of `to` is " : "coefficient (2, -1) of `from` is "));
      CHECK(error.says("in green"));
      CHECK(same_bytes<dvec3>(probes.coefficients, before.coefficients));
    }
  }
  relight(probes, from, scale(from, dvec3(1e38)));
  for (const dvec3& coefficient : probes.coefficients) CHECK(std::isfinite(coefficient.x + coefficient.y));
}

TEST_CASE("relight: refuses probes that know nothing of the sky", "[probes]") {
  const Captures captures(1, 4, [&](std::size_t, const dvec3&) { return dvec3(1.0); });
  BakedProbes probes = bake_probes({}, captures.cubes);
  CHECK(thrown_by([&] { relight(probes, SphericalHarmonics(1), SphericalHarmonics(1)); }).says("environment_bands"));
}

}  // namespace welkin::test
