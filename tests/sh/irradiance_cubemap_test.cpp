// Promise: an irradiance cubemap holds what its harmonics say at each texel's centre, and the direct one what cosine
// integration says.
#include "welkin/irradiance_cubemap.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/instruction_set.h"
#include "welkin/irradiance.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

SphericalHarmonics some_harmonics(int bands) {
  SphericalHarmonics harmonics(bands);
  double value = 0.3;
  for (glm::dvec3& coefficient : harmonics.coefficients()) {
    for (int c = 0; c < 3; ++c) {
      value = std::fmod(value * 7.13 + 0.71, 2.0);
      coefficient[c] = value - 1.0;
    }
  }
  return harmonics;
}

}  // namespace

TEST_CASE("An irradiance cubemap is its harmonics' sum at every texel's centre", "[irradiance_cubemap]") {
  for (const int bands : {1, 2, 3, 4, 9, 16}) {
    const SphericalHarmonics harmonics = some_harmonics(bands);
    for (const int size : {1, 2, 3, 7, 33}) {
      const CubemapImage map = irradiance_cubemap(harmonics, size);
      REQUIRE(map.size == size);
      for (int row = 0; row < 6 * size; ++row) {
        for (int column = 0; column < size; ++column) {
          const glm::dvec3 to = image::face_direction(size, row / size, column + 0.5, row % size + 0.5);
          const glm::dvec3 wanted = evaluate(harmonics, to);
          const float* const found = map.pixels.data() + 3 * (row * size + column);
          for (int c = 0; c < 3; ++c)
            REQUIRE(std::abs(wanted[c] - static_cast<double>(found[c])) < 1e-7 * bands * bands);
        }
      }
    }
  }
}

TEST_CASE("A uniform environment's irradiance is pi times it, everywhere the same", "[irradiance_cubemap]") {
  const CubemapImage map = irradiance_cubemap(irradiance_from_radiance(constant_radiance({1.0, 2.0, 0.5}, 3)), 64);
  for (std::size_t i = 0; i < map.pixels.size(); ++i) {
    const double radiance = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 2.0 : 0.5;
    REQUIRE(map.pixels[i] == static_cast<float>(std::numbers::pi * radiance));
  }
}

TEST_CASE("The direct irradiance cubemap is direct irradiance", "[irradiance_cubemap]") {
  const TestCubemap source = make_cubemap(Content::high_range, 16, 3, 2);
  const CubemapImage direct = direct_irradiance_cubemap(source.view(), 5);
  std::vector<glm::dvec3> normals;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 5; ++column) {
      normals.push_back(image::face_direction(5, row / 5, column + 0.5, row % 5 + 0.5));
    }
  }
  const std::vector<glm::dvec3> wanted = direct_irradiance(source.view(), normals);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      REQUIRE(direct.pixels[3 * i + c] == static_cast<float>(wanted[i][static_cast<glm::length_t>(c)]));
    }
  }
  const TestLatLong lat_long = make_lat_long(Content::smooth, 32, 16, 2);
  const SphericalHarmonics radiance = project(lat_long.view()).radiance;
  const CubemapImage by_bands = irradiance_cubemap(irradiance_from_radiance(radiance), 6);
  const CubemapImage reference = direct_irradiance_cubemap(lat_long.view(), 6);
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    REQUIRE(by_bands.pixels[i] == Approx(reference.pixels[i]).epsilon(0.02));
  }
}

TEST_CASE("Irradiance cubemaps have the same bits everywhere, and their tiles allocate nothing",
          "[irradiance_cubemap]") {
  const InstructionSet before = active_instruction_set();
  const SphericalHarmonics harmonics = some_harmonics(5);
  force_instruction_set(InstructionSet::sse2);
  CubemapImage expected;
  run_with_threads(1, [&] { expected = irradiance_cubemap(harmonics, 67); });
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 7}) {
      CAPTURE(name(set), threads);
      forget_allocations_in_tiles();
      run_with_threads(threads, [&] { CHECK(same_bits(irradiance_cubemap(harmonics, 67), expected)); });
      CHECK(allocations_in_tiles() == 0);
    }
  }
  force_instruction_set(before);
}

TEST_CASE("Irradiance cubemaps are refused, stopped and reported upon", "[irradiance_cubemap]") {
  const SphericalHarmonics harmonics = some_harmonics(3);
  CHECK(thrown_by([&] { return irradiance_cubemap(harmonics, 0); }).says("from 1 to 4096"));
  CHECK(thrown_by([&] { return irradiance_cubemap(harmonics, 4097); }).code == ErrorCode::invalid_argument);
  const TestCubemap source = make_cubemap(Content::random, 4, 3, 2);
  CHECK(thrown_by([&] { return direct_irradiance_cubemap(source.view(), 5000); }).code == ErrorCode::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  CHECK(thrown_by([&] {
          return irradiance_cubemap(harmonics, 64, {stop.get_token(), {}});
        }).code == ErrorCode::cancelled);
  CHECK(thrown_by([&] {
          return direct_irradiance_cubemap(source.view(), 4, {stop.get_token(), {}});
        }).code == ErrorCode::cancelled);
  std::vector<double> shares;
  (void)direct_irradiance_cubemap(source.view(), 3, {{}, [&](double share) { shares.push_back(share); }});
  CHECK(shares.back() == 1.0);
}

}  // namespace welkin::test
