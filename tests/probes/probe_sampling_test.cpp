// Lookups in a grid, compared with another implementation of the same sums in double; and the code for shaders.
#include <glm/common.hpp>

#include "probes/probe_captures.h"
#include "probes/room.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

namespace {

const ProbeGrid kGrid{.counts = {4, 3, 2}, .origin = {-1, 0.5, 2}, .spacing = {1, 0.75, 1.25}};

/// Bakes two adjacent rooms that are lit differently; some probes stand in the wall.
BakedProbes two_rooms(int bands) {
  const auto in_wall = [](std::size_t probe) { return probe % 5 == 2; };
  const Captures captures(
      kGrid.size(), 8,
      [](std::size_t probe, const dvec3& d) {
        return dvec3(1.0 + 0.8 * d.y, 0.2 + 0.1 * static_cast<double>(probe), 2.0 - d.x + 0.5 * d.z * d.z);
      },
      16,
      [&](std::size_t probe, const dvec3& d) {
        const double away = distance_to_walls(kGrid.position(probe), d, {-1.5, 0, 1}, {2.6, 2.5, 4});
        return static_cast<float>(in_wall(probe) ? -away : away * (0.5 + 0.1 * static_cast<double>(probe % 4)));
      });
  return captures.bake(kGrid, {.projection = {.bands = bands}, .distance_size = 6});
}

dvec3 light_of(const BakedProbes& probes, std::size_t probe, const dvec3& normal) {
  SphericalHarmonics radiance = radiance_of(probes, probe);
  if (probes.bands > 3) radiance = resized(radiance, 3);
  return evaluate(irradiance_from_radiance(radiance), normal);
}

/// Interpolates bilinearly between the centres of the four nearest texels, border included.
double moment(const BakedProbes& probes, std::size_t probe, const dvec3& direction, int which) {
  const std::array<double, 2> uv = octahedral_encode(direction);
  const int edge = probes.distance_edge();
  double sum = 0.0;
  for (int row = 0; row < edge; ++row) {
    for (int column = 0; column < edge; ++column) {
      const double across = 1.0 - std::abs(uv[0] * probes.distance_size - (column - 0.5));
      const double along = 1.0 - std::abs(uv[1] * probes.distance_size - (row - 0.5));
      if (across <= 0.0 || along <= 0.0) continue;
      const auto texel =
          (probe * static_cast<std::size_t>(edge) + static_cast<std::size_t>(row)) * static_cast<std::size_t>(edge) +
          static_cast<std::size_t>(column);
      sum += across * along * static_cast<double>(probes.distances[2 * texel + static_cast<std::size_t>(which)]);
    }
  }
  return sum;
}

/// Sums over all probes of the grid; probes that are not corners of the cell have weight 0.
dvec3 twin(const BakedProbes& probes, const dvec3& surface, const dvec3& normal, const ProbeSampling& sampling) {
  const ProbeGrid& grid = probes.grid;
  const dvec3 biased =
      surface + normal * sampling.normal_bias * std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  dvec3 sum(0.0);
  double weights = 0.0;
  for (std::size_t probe = 0; probe < grid.size(); ++probe) {
    const dvec3 at = grid.position(probe);
    const dvec3 clamped = glm::clamp(biased, grid.origin, grid.position(grid.size() - 1));
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      weight *= std::max(0.0, 1.0 - std::abs(clamped[axis] - at[axis]) / grid.spacing[axis]);
    }
    if (weight == 0.0) continue;
    double factor = 1.0;
    if (sampling.facing) factor *= std::pow(0.5 + 0.5 * glm::dot(glm::normalize(at - surface), normal), 2) + 0.2;
    if (sampling.visibility) {
      const dvec3 way = biased - at;
      const double mean = moment(probes, probe, way, 0);
      const double variance = std::abs(moment(probes, probe, way, 1) - mean * mean);
      const double beyond = std::max(0.0, glm::length(way) - mean);
      factor = std::max(1e-6, factor * std::pow(variance / (variance + beyond * beyond), 3));
      if (factor < 0.2) factor = std::pow(factor, 3) / 0.04;
    }
    weight *= factor;
    if (sampling.validity) weight *= probes.passes[probe] == 0 ? 1.0 : probes.passes[probe] < 255 ? 1e-3 : 0.0;
    sum += weight * light_of(probes, probe, normal);
    weights += weight;
  }
  return weights > 0.0 ? glm::max(sum / weights, dvec3(0.0)) : dvec3(0.0);
}

std::size_t occurrences(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("probe_irradiance: every weight as it is written down in double", "[probes]") {
  std::mt19937 random(7);
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (const int bands : {1, 2, 3, 4}) {
    const BakedProbes probes = two_rooms(bands);
    CHECK(probes.invalid > 3);
    for (int k = 0; k < 400; ++k) {
      const dvec3 surface{number(-1.8, 2.8), number(0.1, 2.4), number(1.5, 3.8)};
      const dvec3 normal = glm::normalize(dvec3(number(-1, 1), number(-1, 1), number(-1, 1)));
      const ProbeSampling sampling{.visibility = k % 2 == 0,
                                   .facing = k / 2 % 2 == 0,
                                   .validity = k / 4 % 2 == 0,
                                   .normal_bias = k % 3 == 0 ? 0.0 : 0.3};
      CAPTURE(bands, k);
      const dvec3 wanted = twin(probes, surface, normal, sampling);
      const dvec3 found = probe_irradiance(probes, surface, normal, sampling);
      for (int c = 0; c < 3; ++c) REQUIRE(found[c] == Approx(wanted[c]).epsilon(2e-3).margin(1e-3));
    }
  }
}

TEST_CASE("probe_irradiance: at a probe it is that probe's, and beyond the grid that of its edge", "[probes]") {
  BakedProbes probes = two_rooms(3);
  const ProbeSampling plain{.visibility = false, .facing = false, .validity = false, .normal_bias = 0.0};
  for (std::size_t probe = 0; probe < probes.grid.size(); ++probe) {
    for (const dvec3 normal : {dvec3(0, 0, 1), dvec3(-0.6, 0.8, 0)}) {
      const dvec3 wanted = glm::max(light_of(probes, probe, normal), dvec3(0.0));
      const dvec3 found = probe_irradiance(probes, probes.grid.position(probe), normal, plain);
      CHECK(glm::length(found - wanted) < 1e-5);
    }
  }
  CHECK(probe_irradiance(probes, {-50, 0.9, 2.4}, {0, 1, 0}, plain) ==
        probe_irradiance(probes, {-1, 0.9, 2.4}, {0, 1, 0}, plain));
  // Without a probe that has light the result is 0.
  probes.passes.assign(probes.passes.size(), 255);
  CHECK(probe_irradiance(probes, {0, 1, 2.5}, {0, 1, 0}) == dvec3(0.0));
}

TEST_CASE("probe_irradiance: what is not finite is refused, as far away as floats go it is not", "[probes]") {
  const BakedProbes probes = two_rooms(3);
  const dvec3 position = kGrid.position(0);
  const double nan = std::nan("");
  CHECK_THROWS_AS(probe_irradiance(probes, {nan, 0, 0}, {0, 1, 0}), Error);
  CHECK_THROWS_AS(probe_irradiance(probes, {1e39, 0, 0}, {0, 1, 0}), Error);
  CHECK_THROWS_AS(probe_irradiance(probes, position, {0, nan, 0}), Error);
  CHECK_THROWS_AS(probe_irradiance(probes, position, {0, 1, 0}, {.normal_bias = nan}), Error);
  for (const double far : {-1e15, -1e9, 1e9, 1e15}) {
    const dvec3 light = probe_irradiance(probes, {far, far, far}, {0, 1, 0});
    CAPTURE(far, light.x, light.y, light.z);
    CHECK((std::isfinite(light.x) && std::isfinite(light.y) && std::isfinite(light.z)));
  }
  BakedProbes elsewhere = probes;
  elsewhere.grid.origin.x = 1e39;
  CHECK_THROWS_AS(probe_irradiance(elsewhere, position, {0, 1, 0}), Error);
}

TEST_CASE("probe_irradiance: light beyond what floats sum is right, and coefficients that are no numbers are named",
          "[probes]") {
  BakedProbes probes;
  probes.grid = {.counts = {2, 1, 1}};
  probes.bands = 2;
  probes.coefficients.assign(8, dvec3(0.25, -0.125, 0.5));
  probes.coefficients[0] = probes.coefficients[4] = dvec3(3.0, 2.0, 1.0);
  probes.validity.assign(2, 1.0F);
  probes.passes.assign(2, 0);
  const dvec3 position(0.3, 0.1, 0.0);
  const dvec3 wanted = probe_irradiance(probes, position, {0, 1, 0});
  for (const double bright : {1e37, 3e38, 1e100}) {
    BakedProbes brighter = probes;
    for (dvec3& coefficient : brighter.coefficients) coefficient *= bright;
    const dvec3 light = probe_irradiance(brighter, position, {0, 1, 0});
    CAPTURE(bright);
    for (int c = 0; c < 3; ++c) CHECK(light[c] / bright == Approx(wanted[c]).epsilon(1e-5));
  }
  probes.coefficients[6].z = std::numeric_limits<double>::quiet_NaN();
  const ThrownError error = thrown_by([&] { static_cast<void>(probe_irradiance(probes, position, {0, 1, 0})); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("coefficient 2 of probe 1 is not finite"));
}

TEST_CASE("probe_sampling_code: one source in four languages", "[probes]") {
  const std::string glsl = probe_sampling_code(ShaderLanguage::glsl);
  CHECK(glsl == probe_sampling_code(ShaderLanguage::cpp));
  CHECK(glsl.find("vec3 probe_volume_light(ProbeVolume volume, vec3 surface, vec3 normal) {") != std::string::npos);
  const std::string hlsl = probe_sampling_code(ShaderLanguage::hlsl);
  CHECK(hlsl.find("float3 probe_volume_light(ProbeVolume volume, float3 surface, float3 normal) {") !=
        std::string::npos);
  CHECK(hlsl.find("  int3 counts;") != std::string::npos);
  CHECK(occurrences(hlsl, "vec") == 0);
  const std::string wgsl = probe_sampling_code(ShaderLanguage::wgsl);
  CHECK(wgsl.find("fn probe_volume_light(volume : ProbeVolume, surface : vec3f, normal : vec3f) -> vec3f {") !=
        std::string::npos);
  CHECK(wgsl.find("  for (var corner : i32 = 0; corner < 8; corner++) {") != std::string::npos);
  CHECK(wgsl.find("  counts : vec3i,") != std::string::npos);
  CHECK(wgsl.find("    var wrapped : f32 = 0.5f * cosine + 0.5f;") != std::string::npos);
  CHECK(occurrences(wgsl, "float") + occurrences(wgsl, "int ") + occurrences(wgsl, "ivec") == 0);
  for (const std::string& code : {glsl, hlsl, wgsl}) {
    CHECK(occurrences(code, "{") == occurrences(glsl, "{"));
    CHECK(occurrences(code, "return") == occurrences(glsl, "return"));
  }
}

// A room with walls that light must not pass: the light of a grid of probes, compared with path tracing.

namespace {

struct Surface {
  dvec3 position;
  dvec3 normal;
};

/// Returns points on the floor and on both sides of the wall between the halves.
std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  for (double x = -1.9; x < 2.0; x += 0.2) {
    for (double z = -0.9; z < 1.0; z += 0.3) all.push_back({{x, 0.0, z}, {0, 1, 0}});
  }
  for (double y = 0.1; y < 2.0; y += 0.2) {
    for (double z = -0.9; z < 0.3; z += 0.3) {
      all.push_back({{0.04, y, z}, {1, 0, 0}});
      all.push_back({{-0.04, y, z}, {-1, 0, 0}});
    }
  }
  return all;
}

/// Returns the root mean square of the difference relative to that of the reference.
double error_of(const BakedProbes& probes, const std::vector<Surface>& points, const std::vector<dvec3>& wanted,
                const ProbeSampling& sampling) {
  double square = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const dvec3 found = probe_irradiance(probes, points[k].position, points[k].normal, sampling);
    square += glm::dot(found - wanted[k], found - wanted[k]);
    whole += glm::dot(wanted[k], wanted[k]);
  }
  return std::sqrt(square / whole);
}

/// Bakes a grid whose probes are captured where successive calls of `relocate_probes` have moved them.
BakedProbes baked_out_of_walls(const Room& room, const ProbeGrid& grid) {
  std::vector<dvec3> offsets(grid.size());
  for (int call = 0;; ++call) {
    std::vector<Captures> captures;
    std::vector<CubemapView> cubes;
    std::vector<DepthView> depths;
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const ProbeGrid one{.origin = grid.position(k) + offsets[k], .spacing = grid.spacing};
      captures.push_back(room.capture(one, 12, call < 4 ? 0 : 4));
      cubes.push_back(captures.back().cubes[0]);
      depths.push_back(captures.back().depths[0]);
    }
    if (call == 4) {
      BakedProbes probes = bake_probes(grid, cubes, depths);
      probes.offsets = offsets;
      return probes;
    }
    offsets = relocate_probes(grid, depths, {}, offsets);
  }
}

}  // namespace

TEST_CASE("probes in a room: each weight brings the light nearer to that of paths", "[probes][slow]") {
  const Room room;
  const ProbeGrid grid = Room::grid();
  const Captures captures = room.capture(grid, 12, 4);
  const BakedProbes raw = captures.bake(grid, {.dilation_passes = 0});
  const BakedProbes probes = captures.bake(grid);

  // Only probes in the six walls and in the block are invalid: the thin wall stands between probes.
  std::size_t in_stone = 0;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const dvec3 p = grid.position(k);
    const bool outside = std::abs(p.x) > 2.0 || p.y < 0.0 || p.y > 2.0 || std::abs(p.z) > 1.0;
    const bool in_block = p.x > -1.5 && p.x < -0.9 && p.y > 0.0 && p.y < 0.7 && p.z > -0.7 && p.z < -0.1;
    CAPTURE(k, p.x, p.y, p.z, probes.validity[k]);
    CHECK((probes.passes[k] != 0) == (outside || in_block));
    in_stone += outside || in_block ? 1 : 0;
  }
  CHECK(probes.invalid == in_stone);
  CHECK(probes.unfilled == 0);

  const std::vector<Surface> points = surfaces();
  std::vector<dvec3> wanted;
  for (std::size_t k = 0; k < points.size(); ++k) {
    wanted.push_back(room.irradiance(points[k].position, points[k].normal, 256, static_cast<std::uint32_t>(k)));
  }
  const ProbeSampling plain{.visibility = false, .facing = false, .validity = false, .normal_bias = 0.0};
  const double dark = error_of(raw, points, wanted, plain);
  const double leaking = error_of(probes, points, wanted, plain);
  const double seen = error_of(probes, points, wanted, {});
  CHECK(dark > 1.3 * leaking);
  CHECK(leaking > 1.3 * seen);
  CHECK(seen < 0.3);

  // Probes that were moved out of the stone see the room.
  const BakedProbes moved = baked_out_of_walls(room, grid);
  const double relocated = error_of(moved, points, wanted, {});
  CAPTURE(seen, relocated);
  CHECK(moved.invalid == 0);
  CHECK(relocated < 0.8 * seen);  // 0.21 and 0.28
}

}  // namespace welkin::test
