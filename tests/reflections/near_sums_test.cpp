// Lobes split in sums over near texels and harmonics of farther ones: against the reference and for consistency.
#include "reflections/near_sums.h"

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

/// Returns the near sums of packed faces.
std::vector<float> near_sums(const NearSplit& split, const std::vector<float>& faces) {
  const auto face_floats = std::size_t{3} * static_cast<std::size_t>(split.size * split.size);
  std::vector<float> sums(6 * face_floats, 0.0F);
  std::vector<const float*> rows;
  rows.reserve(static_cast<std::size_t>(6 * split.face));
  for (int row = 0; row < 6 * split.face; ++row) rows.push_back(faces.data() + std::ptrdiff_t{3} * split.face * row);
  std::array<float*, 6> to{};
  for (std::size_t face = 0; face < 6; ++face) to[face] = sums.data() + face * face_floats;
  reflections::add_near_sums(rows, {{std::make_shared<const NearTable>(split), to}}, {});
  return sums;
}

/// A lobe's near part, and the lobe, in double, by their definition.
class NearPart {
 public:
  NearPart(const NearSplit& split, const glm::dvec3& direction) : split_(split), direction_(direction) {
    const double q = split.alpha * split.alpha / (1.0 - split.alpha * split.alpha);
    // the whole lobe's: Int_0^1/2 (1 - 2 s) / (q + s)^2 ds
    const double whole = (1.0 + 2.0 * q) * (1.0 / q - 1.0 / (q + 0.5)) - 2.0 * std::log((q + 0.5) / q);
    scale_ = 1.0 / (4.0 * std::numbers::pi * whole * split.end() * split.end());
    offset_ = q / split.end();
  }

  /// Integrates over columns and rows of a part of the source, halved until they are small against the lobe or their
  /// distance.
  [[nodiscard]] glm::dvec2 over(int part, double column, double row, double width) const {
    const glm::dvec3 middle = at(part, column + 0.5 * width, row + 0.5 * width).direction;
    const double size = width * std::numbers::pi / (split_.cubemap() ? split_.face : split_.rows);
    if (size > 0.4 * std::max(split_.alpha, glm::distance(middle, direction_)) || size > 0.1 * split_.reach) {
      glm::dvec2 sum(0.0);
      for (const double x : {0.0, 0.5}) {
        for (const double y : {0.0, 0.5}) sum += over(part, column + x * width, row + y * width, 0.5 * width);
      }
      return sum;
    }
    constexpr std::array<double, 3> points{0.1127016653792583, 0.5, 0.8872983346207417};
    constexpr std::array<double, 3> weights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    glm::dvec2 sum(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const Point point = at(part, column + points[i] * width, row + points[j] * width);
        sum += weights[i] * weights[j] * point.area * near(point.direction);
      }
    }
    return sum * width * width;
  }

 private:
  struct Point {
    glm::dvec3 direction;
    double area;  ///< steradians of a texel of its size
  };

  [[nodiscard]] Point at(int part, double column, double row) const {
    if (!split_.cubemap()) {
      const double angles = 2.0 * std::numbers::pi * std::numbers::pi / (split_.face * split_.rows);
      return {image::lat_long_direction(split_.face, split_.rows, column, row),
              angles * std::sin(std::numbers::pi * row / split_.rows)};
    }
    const int face = reflections::kNearFaces[static_cast<std::size_t>(part)];
    const glm::dvec3 direction = image::face_direction(split_.face, face, column, row);
    const double inverse = glm::dot(direction, image::face_frame(face).normal);
    return {direction, 4.0 / (split_.face * split_.face) * inverse * inverse * inverse};
  }

  [[nodiscard]] glm::dvec2 near(const glm::dvec3& direction) const {
    const glm::dvec3 way = direction - direction_;
    const double s = 0.25 * glm::dot(way, way);
    const double x = offset_ + s / split_.end();
    const double cosine = scale_ * (1.0 - 2.0 * s);
    const double whole = cosine / (x * x);
    return {x < 1.0 ? whole - cosine * reflections::far_polynomial(x) : 0.0, whole};
  }

  NearSplit split_;
  glm::dvec3 direction_;
  double scale_;
  double offset_;
};

TestCubemap noise_of(int size) { return make_cubemap(Content::random, size, 3, 5); }

}  // namespace

TEST_CASE("near sums of uniform light have the near part's share of it", "[prefilter][near]") {
  const std::vector<float> white(std::size_t{18} * 16 * 16, 1.0F);
  const std::vector<float> sums = near_sums(kSplit, white);
  const double share = 1.0 - reflections::far_spectrum(kSplit.alpha, kSplit.end(), 1).front();
  CHECK(share > 0.3);
  for (const float sum : sums) REQUIRE(std::abs(static_cast<double>(sum) - share) < 1e-6);
}

// In double, texels halved until each piece is small: lobes wider and far narrower than texels, at corners and poles.
TEST_CASE("weights of near sums are the integrals over texels", "[near][narrow][slow]") {
  const NearSplit split =
      GENERATE(NearSplit{.face = 64, .size = 6, .alpha = 0.0125, .reach = 0.2, .bands = 42},
               NearSplit{.face = 64, .size = 5, .alpha = 1e-3, .reach = 0.1, .bands = 120},
               NearSplit{.face = 96, .size = 24, .alpha = 3e-3, .reach = 0.08, .bands = 150},
               NearSplit{.face = 128, .size = 5, .alpha = 3e-3, .reach = 0.1, .bands = 120, .rows = 64},
               NearSplit{.face = 512, .size = 6, .alpha = 3e-3, .reach = 0.1, .bands = 120, .rows = 128},
               NearSplit{.face = 128, .size = 24, .alpha = 1e-4, .reach = 0.1, .bands = 120, .rows = 64});
  CAPTURE(split.face, split.rows, split.alpha, split.size);
  const NearTable table(split);
  reflections::NearTile room;
  reflections::NearWeights::Scratch weights;
  double worst = 0.0;
  double worst_sum = 0.0;
  for (std::size_t index = 0; index < table.weights().tiles(); ++index) {
    const reflections::NearTile& tile = table.tile(index, room, weights);
    auto run = tile.runs.begin();
    const float* weight = tile.weights.data();
    for (std::size_t k = 0; k < tile.runs_ends.size(); ++k) {
      const glm::dvec3 direction(table.weights().directions()[reflections::NearWeights::first_of(index) + k]);
      const NearPart near(split, glm::normalize(direction));
      const auto end = tile.runs.begin() + static_cast<std::ptrdiff_t>(tile.runs_ends[k]);
      double share = 0.0;
      double errors = 0.0;
      std::vector<std::pair<double, glm::dvec2>> pairs;
      for (; run != end; ++run) {
        const int rows = split.cubemap() ? split.face : split.rows;
        for (int column = run->first; column < run->first + run->count; ++column)
          pairs.emplace_back(static_cast<double>(*weight++), near.over(run->row / rows, column, run->row % rows, 1.0));
      }
      for (const auto& [own, truth] : pairs) share += own;
      const double images = std::round((1.0 - table.far().front()) / share);
      for (const auto& [own, truth] : pairs) {
        errors += std::abs(images * own - truth.x);
        worst = std::max(worst, std::abs(images * own - truth.x) / (truth.y + 1e-6));
      }
      worst_sum = std::max(worst_sum, errors);
    }
  }
  CHECK(worst < 3e-3);  // of the lobe over the texel
  CHECK(worst_sum < 2e-4);
}

// On odd sizes, which have a texel in the middle of an edge, too few directions were counted.
TEST_CASE("near weights: directions are as many as are counted for, of odd sizes too", "[prefilter][near]") {
  for (const int rows : {0, 64}) {
    for (int size = 1; size <= 33; ++size) {
      const reflections::NearSplit split{
          .face = rows == 0 ? 64 : 128, .size = size, .alpha = 0.05, .reach = 0.1, .bands = 120, .rows = rows};
      const NearTable table(split);
      CAPTURE(rows, size);
      CHECK(table.weights().directions().size() == reflections::NearWeights::directions_of(split));
      CHECK(table.bytes() <= NearTable::most_bytes(split));
    }
  }
}

// Texels on the diagonals of a face have two images.
TEST_CASE("near sums of a turned image are turned near sums, to the last bit", "[prefilter][near]") {
  const auto rotated = [](const std::vector<float>& faces, int size) {
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
  CHECK(same_bytes<float>(near_sums(kSplit, rotated(faces, 16)), rotated(near_sums(kSplit, faces), 8)));
}

TEST_CASE("chains with near sums keep their bounds", "[prefilter][near][truth]") {
  const int size = GENERATE(16, 64);
  const double rms_error = GENERATE(1e-4, 1e-3, 1e-2);
  TestCubemap cube = noise_of(size);
  cube.pixels[5] = 3000.0F;                         // a lamp in a corner,
  cube.pixels[cube.pixels.size() / 2 + 1] = 40.0F;  // a bright texel, and a dark half
  for (std::size_t k = 0; k < cube.pixels.size() / 3; ++k) cube.pixels[k] *= 0.01F;
  PrefilterOptions options{.size = size};
  options.rms_error = rms_error;
  options.maximum_error = 10.0 * rms_error;
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(options).at_step(0, {true, size, size});
  CAPTURE(size, rms_error);
  CHECK(!plan.near_mips.empty());
  const PrefilteredSpecular result = prefilter_specular(cube.view(), options);
  for (int level = 1; level < result.cubemap.levels(); ++level) {
    const MipRecord& record = result.mips[static_cast<std::size_t>(level)];
    const std::size_t step = step_for(record.size, size < 64 ? 150 : 40) | 1U;
    const LevelError error = error_of_mip(cube.view(), result, static_cast<std::size_t>(level), step);
    CAPTURE(level, error.rms, error.maximum, *record.error_estimate);
    CHECK(error.rms < rms_error);
    CHECK(error.rms < *record.error_estimate);
    CHECK(error.maximum < 10.0 * rms_error);
  }
}

TEST_CASE("near sums of texels much wider than the lobe say what they err by", "[prefilter][near][truth]") {
  const double rms_error = GENERATE(1e-4, 1e-3);
  TestCubemap checkers = noise_of(16);
  for (std::size_t k = 0; k < checkers.pixels.size(); ++k) checkers.pixels[k] = (k / 3 + k / 48) % 2 == 0 ? 0.2F : 3.0F;
  const PrefilterOptions options{.size = 16, .mips = 1, .roughness = {0.0966}, .rms_error = rms_error};
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(options).at_step(0, {true, 16, 16});
  REQUIRE(!plan.near_mips.empty());
  CHECK(plan.near_mips.front().near.face == (rms_error < 1e-3 ? 32 : 16));  // tight bounds cut texels
  const PrefilteredSpecular result = prefilter_specular(checkers.view(), options);
  const LevelError error = error_of_mip(checkers.view(), result, 0, 11);
  CHECK(error.rms < *result.mips.front().error_estimate);
  CHECK(*result.mips.front().error_estimate <= rms_error);
}

TEST_CASE("a mip with near sums has the same bits whatever else is made, with any threads and set",
          "[prefilter][near]") {
  const TestCubemap cube = noise_of(64);
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(PrefilterOptions{.size = 64});
  REQUIRE(!plan.at_step(0, {true, 64, 64}).near_mips.empty());
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
