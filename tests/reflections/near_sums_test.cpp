// Lobes split in sums over texels near by and harmonics of what lies farther: against the truth, and by itself.
#include "reflections/near_sums.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {

using reflections::NearSplit, reflections::NearTable;

namespace {

constexpr NearSplit kSplit{.face = 16, .size = 8, .alpha = 0.07, .reach = 0.4, .bands = 24};

/// The near sums of packed faces.
std::vector<float> near_sums(const NearSplit& split, const std::vector<float>& faces) {
  const auto face_floats = std::size_t{3} * static_cast<std::size_t>(split.size * split.size);
  std::vector<float> sums(6 * face_floats, 0.0F);
  std::vector<const float*> rows;
  for (int row = 0; row < 6 * split.face; ++row) rows.push_back(faces.data() + std::ptrdiff_t{3} * split.face * row);
  reflections::NearMip mip{split, {}};
  for (std::size_t face = 0; face < 6; ++face) mip.faces[face] = sums.data() + face * face_floats;
  reflections::add_near_sums(rows, {mip}, {});
  return sums;
}

TestCubemap noise_of(int size) { return make_cubemap(Content::random, size, 3, 5); }

}  // namespace

TEST_CASE("near sums of uniform light have the near part's share of it", "[prefilter][near]") {
  const std::vector<float> white(std::size_t{18} * 16 * 16, 1.0F);
  const std::vector<float> sums = near_sums(kSplit, white);
  const double share = 1.0 - reflections::far_spectrum(kSplit.alpha, kSplit.end(), 1).front();
  CHECK(share > 0.3);
  for (const float sum : sums) REQUIRE(std::abs(static_cast<double>(sum) - share) < 1e-6);
}

TEST_CASE("near sums of a texel are its lobe's near part over its area", "[prefilter][near]") {
  // the texel of +X in the middle, seen from each texel of the mip that is near enough
  std::vector<float> faces(std::size_t{18} * 16 * 16, 0.0F);
  faces[3 * (7 * 16 + 8)] = 1.0F;
  const std::vector<float> sums = near_sums(kSplit, faces);
  const glm::dvec3 from = image::face_direction(16, 0, 8.5, 7.5);
  const double texel = image::FaceSolidAngles::get(16)->at(7, 8);
  int seen = 0;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      const double cosine = glm::dot(from, image::face_direction(8, 0, column + 0.5, row + 0.5));
      const auto sum = static_cast<double>(sums[static_cast<std::size_t>(3 * (8 * row + column))]);
      if (std::acos(cosine) > kSplit.reach + 0.1) CHECK(sum == 0.0);
      if (std::acos(cosine) > 0.2) continue;
      const double whole = reflections::lobe(cosine, kSplit.alpha) / reflections::lobe_integral(kSplit.alpha) * texel;
      CHECK(sum < 1.02 * whole);
      CHECK(sum > 0.5 * whole);
      ++seen;
    }
  }
  CHECK(seen >= 3);
  CHECK(std::count_if(sums.begin(), sums.end(), [](float value) { return value > 0.0F; }) < 80);
}

// Two images have the texels on the diagonals of a face.
TEST_CASE("near sums of a turned picture are turned near sums, to the last bit", "[prefilter][near]") {
  const auto turned = [](const std::vector<float>& faces, int size) {
    std::vector<float> result(faces.size());
    for (int k = 0; k < 6 * size * size; ++k) {
      const glm::ivec3 point = image::point_of(size, {k / (size * size), k % size, k / size % size});
      const image::CubeTexel to = image::texel_at(size, image::moved(image::cube_image_of(4), point));
      std::copy_n(faces.begin() + 3 * k, 3, result.begin() + 3 * ((to.face * size + to.row) * size + to.column));
    }
    return result;
  };
  const TestCubemap cube = noise_of(16);
  const std::vector<float> faces(cube.pixels.begin(), cube.pixels.end());
  CHECK(same_bytes<float>(near_sums(kSplit, turned(faces, 16)), turned(near_sums(kSplit, faces), 8)));
}

TEST_CASE("chains with near sums keep their bounds", "[prefilter][near][truth]") {
  const int size = GENERATE(16, 64);
  const double rms_error = GENERATE(1e-3, 1e-2);
  TestCubemap cube = noise_of(size);
  cube.pixels[5] = 3000.0F;                         // a lamp in a corner,
  cube.pixels[cube.pixels.size() / 2 + 1] = 40.0F;  // a bright texel, and a dark half
  for (std::size_t k = 0; k < cube.pixels.size() / 3; ++k) cube.pixels[k] *= 0.01F;
  PrefilterOptions options{.size = size};
  options.rms_error = rms_error;
  options.maximum_error = 10.0 * rms_error;
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(options).with_near_sums(size);
  CAPTURE(size, rms_error);
  if (size == 64) CHECK(!plan.near_mips.empty());
  const PrefilteredSpecular result = prefilter_specular(cube.view(), options);
  for (int level = 1; level < result.cubemap.levels(); ++level) {
    const MipRecord& record = result.mips[static_cast<std::size_t>(level)];
    const auto directions = centres(record.size);
    std::vector<glm::dvec3> some;
    const std::size_t step = std::max<std::size_t>(1, directions.size() / (size < 64 ? 150 : 40)) | 1U;
    for (std::size_t k = 0; k < directions.size(); k += step) some.push_back(directions[k]);
    const LevelError error =
        level_error(result.cubemap, level, reference_specular(cube.view(), record.roughness, some), step);
    CAPTURE(level, error.rms, error.maximum, *record.error_estimate);
    CHECK(error.rms < rms_error);
    CHECK(error.rms < *record.error_estimate);
    CHECK(error.maximum < 10.0 * rms_error);
  }
}

TEST_CASE("a mip with near sums has the same bits whatever else is made, with any threads and set",
          "[prefilter][near]") {
  const TestCubemap cube = noise_of(64);
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(PrefilterOptions{.size = 64});
  REQUIRE(!plan.with_near_sums(64).near_mips.empty());
  const InstructionSet before = active_instruction_set();
  std::vector<float> first;
  const auto values_of = [&](const reflections::PrefilterPlan& made, int level) {
    const PrefilteredSpecular result = reflections::prefilter(cube.view(), made, {}, {}, {});
    const float* const values = result.cubemap.face(level, 0);
    return std::vector<float>(values, values + std::size_t{18} * 32 * 32);
  };
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 3}) {
      run_with_threads(threads, [&] {
        if (first.empty()) first = values_of(plan, 1);
        CHECK(same_bytes<float>(values_of(plan, 1), first));
        CHECK(same_bytes<float>(values_of(plan.without(1, 3), 0), first));
      });
    }
  }
  force_instruction_set(before);
}

}  // namespace welkin::test
