// The sampled method's kernel against the same sums in double precision, look-up by look-up.

#include "reflections/sampled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "image/geometry.h"
#include "reflections/prefilter_support.h"
#include "reflections/sampled_kernels.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

/// All levels of random texels from 0 to 1, each level's of its own: a look-up in the wrong one shows.
CubemapChain random_chain(int size) {
  CubemapChain chain(size, full_chain_levels(size));
  for (int level = 0; level < chain.levels(); ++level) {
    const TestCubemap cube =
        make_cubemap(Content::random, chain.level_size(level), 3, 7U + static_cast<unsigned>(level));
    std::copy(cube.pixels.begin(), cube.pixels.end(), chain.face(level, 0));
  }
  return chain;
}

// The twin: as the page says it, from the chain itself, in double.

glm::dvec3 texel_of(const CubemapChain& chain, int level, image::CubeTexel at) {
  const int size = chain.level_size(level);
  const bool beyond_columns = at.column < 0 || at.column == size;
  const bool beyond_rows = at.row < 0 || at.row == size;
  if (beyond_columns && beyond_rows) {  // no texel is there: the mean of the three that meet
    const int column = std::clamp(at.column, 0, size - 1);
    const int row = std::clamp(at.row, 0, size - 1);
    return (texel_of(chain, level, {at.face, column, row}) + texel_of(chain, level, {at.face, at.column, row}) +
            texel_of(chain, level, {at.face, column, at.row})) /
           3.0;
  }
  if (beyond_columns || beyond_rows) at = image::across_edge(size, at);
  const float* const rgb = chain.face(level, at.face) + 3 * (static_cast<std::ptrdiff_t>(at.row) * size + at.column);
  return {rgb[0], rgb[1], rgb[2]};
}

glm::dvec3 bilinear(const CubemapChain& chain, int level, const glm::dvec3& direction) {
  const int size = chain.level_size(level);
  const int face = image::face_of(direction);
  // A face's plane from three of its places, which are not those that the kernel knows.
  const glm::dvec3 middle = image::face_direction(2, face, 1.0, 1.0);
  const glm::dvec3 right = image::face_direction(2, face, 2.0, 1.0);
  const glm::dvec3 down = image::face_direction(2, face, 1.0, 2.0);
  const glm::dvec3 on_plane = direction / glm::dot(direction, middle);
  const double u = glm::dot(on_plane, right / glm::dot(right, middle) - middle);
  const double v = glm::dot(on_plane, down / glm::dot(down, middle) - middle);
  const double column = std::clamp((u + 1.0) * 0.5 * size - 0.5, -0.5, size - 0.5);
  const double row = std::clamp((v + 1.0) * 0.5 * size - 0.5, -0.5, size - 0.5);
  const int left = static_cast<int>(std::floor(column));
  const int top = static_cast<int>(std::floor(row));
  const double x = column - left;
  const double y = row - top;
  const glm::dvec3 above =
      (1.0 - x) * texel_of(chain, level, {face, left, top}) + x * texel_of(chain, level, {face, left + 1, top});
  const glm::dvec3 below =
      (1.0 - x) * texel_of(chain, level, {face, left, top + 1}) + x * texel_of(chain, level, {face, left + 1, top + 1});
  return (1.0 - y) * above + y * below;
}

glm::dvec3 sum_of_taps(const CubemapChain& chain, const std::vector<reflections::Tap>& taps, const glm::dvec3& normal) {
  const glm::dvec3 up = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(up, normal));
  const glm::dvec3 y = glm::cross(normal, x);
  glm::dvec3 sum(0.0);
  for (const reflections::Tap& tap : taps) {
    const glm::dvec3 direction =
        static_cast<double>(tap.x) * x + static_cast<double>(tap.y) * y + static_cast<double>(tap.z) * normal;
    const int level = static_cast<int>(tap.level);
    const double share = static_cast<double>(tap.level) - level;
    glm::dvec3 value = (1.0 - share) * bilinear(chain, level, direction);
    if (share > 0.0) value += share * bilinear(chain, level + 1, direction);
    sum += static_cast<double>(tap.weight) * value;
  }
  return sum;
}

/// The faces of a mip as the method fills them.
std::vector<float> sampled(const reflections::PaddedCube& cube, const std::vector<reflections::Tap>& taps, int size) {
  std::vector<float> pixels(static_cast<std::size_t>(18 * size * size));
  std::array<float*, 6> faces{};
  for (std::size_t face = 0; face < 6; ++face)
    faces[face] = pixels.data() + 3 * face * static_cast<std::size_t>(size * size);
  reflections::sample_mip(cube, taps, size, faces, {});
  return pixels;
}

/// The largest difference of a channel, where texels are from 0 to 1.
double worst_difference(const std::vector<float>& pixels, const CubemapChain& chain,
                        const std::vector<reflections::Tap>& taps, int size) {
  const std::vector<glm::dvec3> directions = centres(size);
  double worst = 0.0;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const glm::dvec3 expected = sum_of_taps(chain, taps, directions[k]);
    for (int c = 0; c < 3; ++c) {
      const auto got = static_cast<double>(pixels[3 * k + static_cast<std::size_t>(c)]);
      worst = std::max(worst, std::abs(got - expected[c]));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("Sums of taps are those in double precision", "[specular][prefilter][sampled]") {
  for (const int size : {1, 2, 5, 16, 64}) {
    const CubemapChain chain = random_chain(size);
    const reflections::PaddedCube cube(chain);
    for (const int samples : {1, 7, 16, 33, 200}) {
      for (const double alpha : {1e-4, 0.01, 0.2, 1.0}) {
        CAPTURE(size, samples, alpha);
        const std::vector<reflections::Tap> taps = reflections::make_taps(alpha, samples, size, chain.levels());
        // A float's place on a face errs by 2^-23 or so, times the texels along an edge.
        CHECK(worst_difference(sampled(cube, taps, 5), chain, taps, 5) < 2e-7 + 1.2e-7 * size);
      }
    }
  }
}

TEST_CASE("Sums of taps have the same bits on every instruction set", "[specular][prefilter][sampled]") {
  const CubemapChain chain = random_chain(32);
  const reflections::PaddedCube cube(chain);
  const InstructionSet before = active_instruction_set();
  for (const int samples : {1, 15, 16, 17, 100}) {
    const std::vector<reflections::Tap> taps = reflections::make_taps(0.3, samples, 32, chain.levels());
    const std::vector<float> expected = sampled(cube, taps, 9);
    for (const InstructionSet set : available_instruction_sets()) {
      CAPTURE(samples, name(set));
      force_instruction_set(set);
      CHECK(sampled(cube, taps, 9) == expected);
    }
    force_instruction_set(before);
  }
}

TEST_CASE("A tap reads one place, of the levels beside its own in their shares", "[specular][prefilter][sampled]") {
  const CubemapChain chain = random_chain(16);
  const reflections::PaddedCube cube(chain);
  for (const float level : {0.0F, 1.0F, 1.25F, 2.5F, 3.75F, 4.0F}) {
    CAPTURE(level);
    const std::vector<reflections::Tap> taps{{0.0F, 0.0F, 1.0F, 1.0F, level}};
    // Centres of 32 fall on quarters between those of 16, beyond the outermost ones too, and at corners.
    CHECK(worst_difference(sampled(cube, taps, 32), chain, taps, 32) < 4e-6);
  }
}

TEST_CASE("Taps of a uniform picture give its value", "[specular][prefilter][sampled]") {
  CubemapChain chain(8, 4);
  for (int level = 0; level < 4; ++level) {
    const auto count = static_cast<std::ptrdiff_t>(18) * chain.level_size(level) * chain.level_size(level);
    std::fill_n(chain.face(level, 0), count, 3.0F);
  }
  const reflections::PaddedCube cube(chain);
  // A lobe so narrow that all weights are equal: what each addition rounds away has the same sign.
  for (const double alpha : {1e-6, 0.5}) {
    for (const int samples : {1, 5, 64, 1000, 1024, 5000}) {
      CAPTURE(alpha, samples);
      double worst = 0.0;
      for (const float value : sampled(cube, reflections::make_taps(alpha, samples, 8, 4), 7))
        worst = std::max(worst, std::abs(static_cast<double>(value) / 3.0 - 1.0));
      CHECK(worst < 4e-7);
    }
  }
}

}  // namespace welkin::test
