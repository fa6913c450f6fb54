// Baking captured cubemaps and depths to light, validity and distances.
#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

dvec3 grey(std::size_t probe, const dvec3& direction) {
  return dvec3(1.0 + 0.25 * static_cast<double>(probe % 7) + 0.5 * direction.y, 1.0, 1.0 + 0.5 * direction.x);
}

bool same_bits(const BakedProbes& a, const BakedProbes& b) {
  return same_bytes<dvec3>(a.coefficients, b.coefficients) && same_bytes<float>(a.validity, b.validity) &&
         a.passes == b.passes && same_bytes<float>(a.distances, b.distances) && same_bytes<double>(a.sky, b.sky) &&
         a.invalid == b.invalid && a.unfilled == b.unfilled;
}

constexpr int kDepthSize = 48;  ///< size of depths whose moments are summed over all texels

/// Returns the mean and mean square by definition, over every texel of the depths instead of blocks of them.
glm::dvec2 moments_of(const std::vector<float>& depths, const dvec3& axis, int power, double limit) {
  static const std::vector<dvec3> directions = texel_centres(kDepthSize);
  glm::dvec2 sums(0.0);
  double whole = 0.0;
  for (std::size_t texel = 0; texel < directions.size(); ++texel) {
    const dvec3& direction = directions[texel];
    const double cosine = glm::dot(axis, direction);
    if (cosine <= 0.0) continue;
    const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    const double weight = largest * largest * largest * std::pow(cosine, power);  // area as a small square
    const double distance = std::min(limit, static_cast<double>(std::abs(depths[texel])));
    sums += weight * glm::dvec2(distance, distance * distance);
    whole += weight;
  }
  return sums / whole;
}

/// Returns a map's texel; columns and rows are counted inside the border.
const float* texel_of(const BakedProbes& probes, std::size_t probe, int column, int row) {
  const auto edge = static_cast<std::size_t>(probes.distance_edge());
  return probes.distances.data() +
         2 * (probe * edge * edge + static_cast<std::size_t>(row + 1) * edge + static_cast<std::size_t>(column + 1));
}

}  // namespace

TEST_CASE("probes: light has the bits of project_many, for every number of bands and sizes down to a texel",
          "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 2}};
  for (const int size : {1, 2, 3, 7, 64}) {
    const Captures captures(grid.size(), size, grey);
    for (int bands = 1; bands <= 4; ++bands) {
      CAPTURE(size, bands);
      const ProjectionOptions options{.bands = bands};
      std::vector<dvec3> wanted(grid.size() * static_cast<std::size_t>(bands * bands));
      project_many(captures.cubes, wanted, options);
      const BakedProbes probes = bake_probes(grid, captures.cubes, {}, {.projection = options});
      CHECK(same_bytes<dvec3>(wanted, probes.coefficients));
      CHECK(probes.validity == std::vector<float>(grid.size(), 1.0F));
      CHECK(probes.distances.empty());
      CHECK(probes.invalid == 0);
      CHECK(probes.diagnostics.texels == grid.size() * 6 * static_cast<std::size_t>(size * size));
    }
  }
}

TEST_CASE("probes: numbers run along x first, then y, then z", "[probes]") {
  const ProbeGrid grid{.counts = {3, 4, 5}, .origin = {1, 2, 3}, .spacing = {0.5, 2, 4}};
  CHECK(grid.size() == 60);
  CHECK(grid.position(0) == dvec3(1, 2, 3));
  CHECK(grid.position(2 + 3 * (3 + 4 * 4)) == dvec3(2, 8, 19));
}

TEST_CASE("probes: validity is the share of the sphere that is neither near nor a back", "[probes]") {
  const ProbeGrid grid{.counts = {4, 1, 1}, .spacing = {2, 3, 4}};
  for (const int size : {1, 2, 3, 7, 16, 64}) {
    const Captures captures(grid.size(), 2, grey, size, [](std::size_t probe, const dvec3& d) {
      const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
      const bool on_right = d.x == largest;
      const bool on_top = d.y == largest;
      switch (probe) {
        case 0: return 5.0F;                                          // all in front
        case 1: return on_right ? -7.0F : 5.0F;                       // one face in six is backs
        case 2: return on_right ? 0.19F : on_top ? -0.1F : kNothing;  // near is below a tenth of the smallest spacing
        default: return on_right ? 0.21F : on_top ? -kNothing : 1.0F;
      }
    });
    CAPTURE(size);
    const BakedProbes probes = captures.bake(grid, {.valid_share = 0.8, .dilation_passes = 0});
    CHECK(probes.validity[0] == 1.0F);
    CHECK(probes.validity[1] == Approx(5.0 / 6.0).margin(1e-6));
    CHECK(probes.validity[2] == Approx(4.0 / 6.0).margin(1e-6));
    CHECK(probes.validity[3] == Approx(5.0 / 6.0).margin(1e-6));
    CHECK(probes.passes == std::vector<std::uint8_t>{0, 0, 255, 0});
    CHECK(probes.invalid == 1);
  }
}

TEST_CASE("probes: inside a sphere every mean is the radius, and its square the mean square", "[probes]") {
  const ProbeGrid grid{.spacing = {3, 3, 3}};
  for (const int size : {1, 2, 3, 7, 33}) {
    const Captures captures(1, 1, grey, size, [](std::size_t, const dvec3&) { return 2.5F; });
    for (const int map : {1, 2, 3, 7, 8}) {
      for (const int power : {1, 50, 1024}) {
        CAPTURE(size, map, power);
        const BakedProbes probes = captures.bake(grid, {.distance_size = map, .distance_power = power});
        REQUIRE(probes.distances.size() == 2 * static_cast<std::size_t>((map + 2) * (map + 2)));
        for (std::size_t k = 0; k < probes.distances.size(); k += 2) {
          REQUIRE(probes.distances[k] == Approx(2.5).margin(1e-6));
          REQUIRE(probes.distances[k + 1] == Approx(6.25).margin(1e-6));
        }
      }
    }
  }
}

TEST_CASE("probes: in a box, moments are those of its walls' distances, backs and what is far included", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}, .origin = {-0.5, 0.2, 0.1}, .spacing = {1, 1, 1}};
  const Captures captures(2, 1, grey, kDepthSize, [&](std::size_t probe, const dvec3& d) {
    const double distance = distance_to_walls(grid.position(probe), d, {-1, -1, -1}, {2, 1, 1});
    if (d.y > 0.8) return kNothing;
    return static_cast<float>(d.z > 0.7 ? -distance : distance);
  });
  for (const int power : {3, 50}) {
    const BakedProbes probes =
        captures.bake(grid, {.distance_size = 7, .distance_power = power, .distance_limit = 1.7, .dilation_passes = 0});
    for (std::size_t probe = 0; probe < 2; ++probe) {
      for (int row = 0; row < 7; ++row) {
        for (int column = 0; column < 7; ++column) {
          CAPTURE(power, probe, row, column);
          const glm::dvec2 wanted =
              moments_of(captures.distances[probe], octahedral_decode((column + 0.5) / 7, (row + 0.5) / 7), power, 1.7);
          const float* found = texel_of(probes, probe, column, row);
          // Blocks of 3 x 3 texels count at their centres: an eighth of a lobe's width for power 50.
          CHECK(found[0] == Approx(wanted.x).epsilon(0.004));
          CHECK(found[1] == Approx(wanted.y).epsilon(0.008));
          CHECK(found[1] >= found[0] * found[0] * (1 - 1e-6F));
        }
      }
    }
  }
}

TEST_CASE("probes: in a plain room, moments are within 0.4 and 1.5 % of sums over all texels, rms 0.1 and 0.25 %",
          "[probes][slow]") {
  const dvec3 room(6, 3, 4);
  for (const double margin : {0.25, 0.5}) {
    const ProbeGrid grid{.counts = {5, 3, 4}, .origin = dvec3(margin), .spacing = (room - 2 * margin) / dvec3(4, 2, 3)};
    const Captures captures(grid.size(), 1, grey, kDepthSize, [&](std::size_t probe, const dvec3& d) {
      return static_cast<float>(distance_to_walls(grid.position(probe), d, dvec3(0.0), room));
    });
    const BakedProbes probes = captures.bake(grid);
    glm::dvec2 most(0.0);
    glm::dvec2 squares(0.0);
    double count = 0.0;
    for (std::size_t probe = 0; probe < grid.size(); probe += 3) {
      for (int texel = 0; texel < 64; ++texel) {
        const dvec3 axis = octahedral_decode((texel % 8 + 0.5) / 8, (texel / 8 + 0.5) / 8);
        const glm::dvec2 wanted = moments_of(captures.distances[probe], axis, 50, probes.distance_limit);
        const float* found = texel_of(probes, probe, texel % 8, texel / 8);
        const glm::dvec2 off = glm::abs(glm::dvec2(found[0], found[1]) / wanted - 1.0);
        most = glm::max(most, off);
        squares += off * off;
        count += 1.0;
      }
    }
    const glm::dvec2 rms = glm::sqrt(squares / count);
    CAPTURE(margin, most.x, most.y, rms.x, rms.y);
    CHECK(most.x < 0.004);
    CHECK(most.y < 0.015);
    CHECK(rms.x < 0.001);
    CHECK(rms.y < 0.0025);
  }
}

TEST_CASE("probes: what differs within a block is in the mean square", "[probes]") {
  // Texels alternate between 1 and 3: the mean is 2, the mean square 5. Blocks have 4 x 4 texels.
  int texel = 0;
  const Captures captures(1, 1, grey, 64, [&](std::size_t, const dvec3&) {
    const int column = texel % 64;
    const int row = texel++ / 64;
    return (column + row) % 2 == 0 ? 1.0F : 3.0F;
  });
  const BakedProbes probes = captures.bake({.spacing = {9, 9, 9}});
  for (int k = 0; k < 8; ++k) {
    CHECK(texel_of(probes, 0, k, 7 - k)[0] == Approx(2.0).epsilon(1e-3));
    CHECK(texel_of(probes, 0, k, 7 - k)[1] == Approx(5.0).epsilon(1e-3));
  }
}

TEST_CASE("probes: the border of a map has what lies beyond its edges on the sphere", "[probes]") {
  const ProbeGrid grid{};
  const Captures captures(1, 1, grey, 9, [](std::size_t, const dvec3& d) {
    return static_cast<float>(1.0 + 0.3 * d.x - 0.2 * d.y + 0.1 * d.z);
  });
  for (const int map : {1, 2, 3, 8}) {
    const BakedProbes probes = captures.bake(grid, {.distance_size = map});
    for (int k = 0; k < map; ++k) {
      CAPTURE(map, k);
      // Point (-a, b) of the square is (a, 1 - b).
      CHECK(texel_of(probes, 0, -1, k)[0] == texel_of(probes, 0, 0, map - 1 - k)[0]);
      CHECK(texel_of(probes, 0, map, k)[1] == texel_of(probes, 0, map - 1, map - 1 - k)[1]);
      CHECK(texel_of(probes, 0, k, -1)[0] == texel_of(probes, 0, map - 1 - k, 0)[0]);
      CHECK(texel_of(probes, 0, k, map)[1] == texel_of(probes, 0, map - 1 - k, map - 1)[1]);
    }
    CHECK(texel_of(probes, 0, -1, -1)[0] == texel_of(probes, 0, map - 1, map - 1)[0]);
    CHECK(texel_of(probes, 0, map, -1)[0] == texel_of(probes, 0, 0, map - 1)[0]);
  }
}

TEST_CASE("probes: an invalid probe becomes the mean of its neighbours by 1 / distance^2, pass by pass", "[probes]") {
  const ProbeGrid grid{.counts = {3, 2, 1}, .spacing = {1, 2, 1}};
  //  0 1 2      (y = 0)    0 and 5 are valid
  //  3 4 5
  BakedProbes probes;
  probes.grid = grid;
  probes.bands = 1;
  probes.coefficients = {dvec3(6), dvec3(-1), dvec3(-1), dvec3(-1), dvec3(-1), dvec3(1, 2, 3)};
  probes.validity.assign(6, 1.0F);
  probes.passes = {0, 3, 255, 17, 255, 0};
  dilate(probes, 8);
  CHECK(probes.passes == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 0});
  CHECK(probes.invalid == 4);
  CHECK(probes.unfilled == 0);
  // Probe 1 is filled from probe 0 at distance 1 and probe 5 at sqrt(5).
  CHECK(probes.coefficients[1].x == Approx((6.0 + 1.0 / 5) / (1 + 1.0 / 5)));
  CHECK(probes.coefficients[1].z == Approx((6.0 + 3.0 / 5) / (1 + 1.0 / 5)));
  // Probe 2 is filled from probe 5 alone, at distance 2; probes filled in the same pass do not count.
  CHECK(probes.coefficients[2] == dvec3(1, 2, 3));
  CHECK(probes.coefficients[3] == dvec3(6));

  // In a row, each pass reaches one probe further.
  BakedProbes row;
  row.grid.counts = {6, 1, 1};
  row.bands = 1;
  row.coefficients = {dvec3(4), dvec3(9), dvec3(9), dvec3(9), dvec3(9), dvec3(9)};
  row.validity.assign(6, 1.0F);
  row.passes = {0, 255, 255, 255, 255, 255};
  BakedProbes untouched = row;
  dilate(untouched, 0);
  CHECK(untouched.coefficients[1] == dvec3(9));
  CHECK(untouched.unfilled == 5);
  dilate(row, 3);
  CHECK(row.passes == std::vector<std::uint8_t>{0, 1, 2, 3, 255, 255});
  CHECK(row.coefficients[3] == dvec3(4));
  CHECK(row.coefficients[4] == dvec3(0));
  CHECK(row.unfilled == 2);

  // Without a valid probe there is no light.
  row.passes.assign(6, 255);
  dilate(row, 3);
  CHECK(row.unfilled == 6);
  CHECK(row.coefficients[0] == dvec3(0));
}

TEST_CASE("probes: the same bits on any number of threads and instruction set, and changed ones baked alone",
          "[probes]") {
  const ProbeGrid grid{.counts = {7, 5, 3}, .spacing = {1, 1.5, 2}};
  const auto depth = [](std::size_t probe, const dvec3& d) {
    const auto seed = static_cast<double>(probe * 37 % 19);
    if (d.y > 0.5) return kNothing;
    return static_cast<float>((probe % 5 == 3 && d.x > -0.2 ? -1.0 : 1.0) * (0.3 + 0.1 * seed + d.z * d.z));
  };
  const Captures captures(grid.size(), 16, grey, 24, depth);
  const ProbeOptions options{.projection = {.bands = 4}, .environment_bands = 3};
  const BakedProbes wanted = captures.bake(grid, options);
  CHECK(wanted.invalid > 10);
  CHECK(wanted.sky_bands == 6);
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 5}) {
      CAPTURE(name(set), threads);
      BakedProbes found;
      run_with_threads(threads, [&] { found = captures.bake(grid, options); });
      CHECK(same_bits(wanted, found));
    }
  }
  force_instruction_set(before);

  // Three probes change: one becomes valid, one invalid.
  const std::vector<std::size_t> changed{3, 50, 51};
  const Captures others(
      changed.size(), 16, [](std::size_t probe, const dvec3& d) { return grey(probe + 3, d) * 2.0; }, 24,
      [&](std::size_t k, const dvec3& d) {
        return depth(k == 0 ? 0 : k == 1 ? 8 : 51, d);
      });
  std::vector<CubemapView> cubes = captures.cubes;
  std::vector<DepthView> depths = captures.depths;
  for (std::size_t k = 0; k < changed.size(); ++k) {
    cubes[changed[k]] = others.cubes[k];
    depths[changed[k]] = others.depths[k];
  }
  BakedProbes updated = wanted;
  update_probes(updated, changed, others.cubes, others.depths, options);
  CHECK_FALSE(same_bits(wanted, updated));
  CHECK(updated.passes[3] == 0);
  CHECK(updated.passes[50] != 0);
  CHECK(same_bits(bake_probes(grid, cubes, depths, options), updated));
}

TEST_CASE("probes: what cannot be baked is refused, and the message says what", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const Captures captures(2, 4, grey, 4, [](std::size_t, const dvec3&) { return 1.0F; });
  const auto bake = [&](const ProbeGrid& g, const ProbeOptions& options) {
    return thrown_by([&] { static_cast<void>(captures.bake(g, options)); });
  };
  CHECK(bake({.counts = {2, 0, 1}}, {}).says("along y"));
  CHECK(bake({.counts = {2, 1, 1}, .spacing = {1, 1, 0}}, {}).says("spacing along z"));
  CHECK(bake({.counts = {3, 1, 1}}, {}).says("there are 2 for 3 probes"));
  CHECK(bake(grid, {.projection = {.bands = 5}}).says("bands"));
  CHECK(bake({.counts = {2, 1, 1}, .spacing = {1, 1e13, 1}}, {}).says("spacing along y"));
  CHECK(bake({.counts = {2, 1, 1}, .origin = {0, 0, std::nan("")}}, {}).says("origin along z"));
  CHECK(bake(grid, {.near_share = -1}).says("near_share"));
  CHECK(bake(grid, {.valid_share = std::nan("")}).says("valid_share"));
  CHECK(bake(grid, {.distance_size = 65}).says("distance_size"));
  CHECK(bake(grid, {.distance_power = 0}).says("distance_power"));
  CHECK(bake(grid, {.environment_bands = 14}).says("environment_bands"));
  CHECK(thrown_by([&] {
          static_cast<void>(bake_probes(grid, captures.cubes, {}, {.environment_bands = 2}));
        }).says("no depths"));
  std::vector<DepthView> depths = captures.depths;
  depths[1].size = 2;
  CHECK(thrown_by([&] { static_cast<void>(bake_probes(grid, captures.cubes, depths)); }).says("probe 1"));
  for (const std::ptrdiff_t stride : {12, -12, 18}) {
    depths = captures.depths;
    depths[1].row_stride_bytes = stride;
    CAPTURE(stride);
    CHECK(thrown_by([&] { static_cast<void>(bake_probes(grid, captures.cubes, depths)); }).says("row_stride_bytes"));
  }
  depths = captures.depths;
  depths[1].faces[4] = nullptr;
  CHECK(thrown_by([&] { static_cast<void>(bake_probes(grid, captures.cubes, depths)); }).says("face 4"));
  std::vector<float> bad = captures.distances[1];
  bad[95] = std::numeric_limits<float>::quiet_NaN();
  depths = captures.depths;
  depths[1] = Captures::depth_view(bad, 4);
  const ThrownError rejected = thrown_by([&] { static_cast<void>(bake_probes(grid, captures.cubes, depths)); });
  CHECK(rejected.code == ErrorCode::rejected_pixel);
  CHECK(rejected.says("probe 1"));

  BakedProbes probes = captures.bake(grid);
  const BakedProbes before = probes;
  const std::vector<std::size_t> twice{1, 1};
  CHECK(thrown_by([&] { update_probes(probes, twice, captures.cubes, captures.depths); }).says("probe 1"));
  const std::vector<std::size_t> beyond{0, 2};
  CHECK(thrown_by([&] { update_probes(probes, beyond, captures.cubes, captures.depths); }).says("probe 2"));
  const std::vector<std::size_t> both{0, 1};
  CHECK(thrown_by([&] { update_probes(probes, both, captures.cubes); }).says("other options"));
  CHECK(same_bits(before, probes));
  probes.validity.pop_back();
  CHECK(thrown_by([&] { dilate(probes); }).says("validity has 1 values"));

  stop_source stop;
  stop.request_stop();
  CHECK(thrown_by([&] { static_cast<void>(captures.bake(grid, {}, {.stop = stop.get_token()})); }).code ==
        ErrorCode::cancelled);
  double last = -1.0;
  static_cast<void>(captures.bake(grid, {.environment_bands = 1}, {{}, [&](double share) {
                                                                     CHECK(share >= last);
                                                                     last = share;
                                                                   }}));
  CHECK(last == 1.0);
}

TEST_CASE("probes: a window takes ringing away, and takes each probe alone", "[probes]") {
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const Captures captures(2, 16, [](std::size_t probe, const dvec3& d) {
    return probe == 0 ? dvec3(1.0) : dvec3(d.y > 0.9 ? 100.0 : 0.001);
  });
  const BakedProbes probes = bake_probes(grid, captures.cubes);
  const BakedProbes calm = windowed(probes, Window::min_laplacian);
  CHECK(same_bytes<dvec3>(std::span(probes.coefficients).first(9), std::span(calm.coefficients).first(9)));
  const WindowResult wanted = apply_window(radiance_of(probes, 1), Window::min_laplacian);
  CHECK(wanted.minimum_before.x < -1.0);
  CHECK(same_bytes<dvec3>(wanted.radiance.coefficients(), std::span(calm.coefficients).subspan(9, 9)));
  CHECK(thrown_by([&] { static_cast<void>(windowed(probes, Window::hanning, -1.0)); }).says("probe 0"));
}

}  // namespace welkin::test
