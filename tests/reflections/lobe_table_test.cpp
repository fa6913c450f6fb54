// Blurred mips of small cubemaps as sums over texels: near the truth, the same bits everywhere, and honest about it.
#include "reflections/lobe_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "image/geometry.h"
#include "platform/memory.h"
#include "reflections/cube_levels.h"
#include "reflections/lobe_weights.h"
#include "reflections/prefilter_support.h"
#include "reflections/ring_kernels.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {

using reflections::CubeLevel, reflections::kRecordFloats, reflections::kTexelsOfGroup, reflections::LobeWeights;

TEST_CASE("Light that goes to coarser points keeps its moments up to the third", "[prefilter][sums]") {
  for (const int size : {6, 16, 20}) {
    const std::vector<CubeLevel> levels = reflections::cube_levels(size);
    std::vector<float> fine(levels[0].points() / 2);
    const std::size_t texel = static_cast<std::size_t>(size) * 1 + static_cast<std::size_t>(size) - 1;  // at an edge
    fine[3 * texel] = 1.0F;
    CAPTURE(size);
    for (std::size_t k = 1; k < levels.size(); ++k) {
      std::vector<float> coarse(levels[k].points() / 2);
      std::vector<float> room(reflections::coarsening_floats(levels[k - 1], levels[k]));
      reflections::coarsen(levels[k - 1], fine.data(), levels[k], coarse.data(), room.data());
      const int edge = levels[k].edge();
      for (int power = 0; power <= 3; ++power) {
        double across = 0.0;
        double down = 0.0;
        for (int row = 0; row < edge; ++row) {
          for (int column = 0; column < edge; ++column) {
            const auto light = static_cast<double>(coarse[static_cast<std::size_t>(3 * (row * edge + column))]);
            across += light * std::pow(levels[k].place(column), power);
            down += light * std::pow(levels[k].place(row), power);
          }
        }
        CHECK(std::abs(across - std::pow(levels[0].place(size - 1), power)) < 2e-6);
        CHECK(std::abs(down - std::pow(levels[0].place(1), power)) < 2e-6);
      }
      fine = coarse;
    }
  }
}

TEST_CASE("A lobe's weights are its integrals over all texels", "[prefilter][sums]") {
  const std::vector<CubeLevel> levels = reflections::cube_levels(16);
  const image::TexelGrid grid = image::TexelGrid::cubemap(16);
  for (const double alpha : {0.05, 0.1, 0.4, 1.0}) {  // 0.05: about the narrowest that faces of 16 are summed with
    LobeWeights weights(levels, alpha);
    CAPTURE(alpha);
    for (const glm::dvec3& direction :
         {glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(0.36, 0.48, -0.8), glm::dvec3(2.0, 1.0, -2.0) / 3.0}) {
      CHECK_FALSE(weights.about(direction).empty());
      const std::vector<double>& errors = weights.errors();
      double squares = 0.0;
      glm::dvec3 halves{};
      for (std::size_t texel = 0; texel < errors.size(); ++texel) {
        squares += errors[texel] * errors[texel];
        for (int axis = 0; axis < 3; ++axis)
          halves[axis] += grid.direction(static_cast<std::int64_t>(texel))[axis] > 0.0 ? errors[texel] : -errors[texel];
      }
      CHECK(std::sqrt(squares) < 5e-4);
      for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(halves[axis]) < 5e-4);
    }
  }
}

TEST_CASE("The kernels of sums over texels do what their words say", "[prefilter][sums]") {
  constexpr int count = 37;
  alignas(64) std::array<float, count * kRecordFloats> records{};
  for (std::size_t k = 0; k < records.size(); ++k) records[k] = 0.01F * static_cast<float>((k * 7919) % 997);
  std::vector<reflections::GroupTap> taps;
  for (std::uint32_t k = 0; k < 3 * count; ++k) {
    const auto weight = static_cast<float>(k % 11) - 4.0F;
    taps.push_back({k * 5 % count, {weight, 0.5F * weight, 0.0F, 1.0F - weight}});
  }
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    CAPTURE(name(set));
    alignas(64) float sums[kTexelsOfGroup][kRecordFloats];
    reflections::ring_kernels().sum_group_taps({records.data(), taps.data(), taps.data() + taps.size()}, sums);
    double largest = 0.0;
    for (std::size_t texel = 0; texel < kTexelsOfGroup; ++texel) {
      for (std::size_t k = 0; k < kRecordFloats; ++k) {
        double sum = 0.0;
        for (const auto& tap : taps) {
          sum += static_cast<double>(tap.weights[texel]) *
                 static_cast<double>(records[tap.record * std::size_t{kRecordFloats} + k]);
        }
        largest = std::max(largest, std::abs(sum - static_cast<double>(sums[texel][k])));
      }
    }
    CHECK(largest < 1e-2);  // of sums of some thousands

    std::array<float, 200> points{};
    for (std::size_t k = 0; k < points.size(); ++k) points[k] = static_cast<float>(k);
    reflections::ImageRows rows{};
    rows.count = 3;
    for (int image = 0; image < reflections::kRingImages; ++image) {
      rows.from[image] = points.data() + 60 + image;
      rows.step[image] = image % 2 == 0 ? 6 : -9;
    }
    alignas(64) std::array<float, 4 * kRecordFloats> gathered{};
    reflections::ring_kernels().gather_images(rows, gathered.data());
    int wrong = 0;
    for (int point = 0; point < 3; ++point) {
      for (int image = 0; image < reflections::kRingImages; ++image) {
        for (int c = 0; c < 3; ++c) {
          const float expected = rows.from[image][rows.step[image] * point + c];
          const auto at = static_cast<std::size_t>(point * kRecordFloats + 3 * image + c);
          wrong += gathered[at] == expected ? 0 : 1;
        }
      }
    }
    CHECK(wrong == 0);
    CHECK(gathered[3 * kRecordFloats] == 0.0F);  // nothing is written beyond the records
  }
  force_instruction_set(before);
}

namespace {

/// A sky of 1 over a ground.
CubemapImage sky_over_dark_ground(int size, float ground) {
  CubemapImage image{size, std::vector<float>(std::size_t{18} * static_cast<std::size_t>(size * size), ground)};
  const image::TexelGrid grid = image::TexelGrid::cubemap(size);
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    if (grid.direction(texel).y > 0.0) std::fill_n(image.pixels.begin() + 3 * texel, 3, 1.0F);
  }
  return image;
}

void check_sums(const CubemapView& view, const PrefilterOptions& options, std::size_t step) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  for (std::size_t level = 1; level < result.mips.size(); ++level) {
    const MipRecord& mip = result.mips[level];
    REQUIRE(mip.method == MipMethod::summed);
    std::vector<glm::dvec3> some;
    const std::vector<glm::dvec3> all = centres(mip.size);
    const std::size_t own_step = mip.size > 8 ? step : 1;
    for (std::size_t k = 0; k < all.size(); k += own_step) some.push_back(all[k]);
    const LevelError error =
        level_error(result.cubemap, static_cast<int>(level), reference_specular(view, mip.roughness, some), own_step);
    CAPTURE(view.size, mip.size, mip.roughness, error.rms, *mip.error_estimate);
    CHECK(error.rms < 5e-4);
    CHECK(error.maximum < 1e-2);
    CHECK(error.rms <= *mip.error_estimate);
    CHECK(*mip.error_estimate < 5e-3);
  }
}

}  // namespace

TEST_CASE("Chains from small cubemaps are within the default bounds", "[specular][prefilter][truth][sums]") {
  for (const int size : {8, 10, 32, 64}) {
    for (const Content content : {Content::random, Content::high_range, Content::one_texel_sun, Content::uniform}) {
      CAPTURE(name(content));
      const double sharpest = size < 50 ? 0.35 : 0.14;
      check_sums(make_cubemap(content, size, 3, 5).view(), {.size = size, .mips = 3, .roughness = {0.0, sharpest, 0.6}},
                 23);
    }
  }
  for (const float ground : {1e-3F, 1e-4F}) {
    check_sums(sky_over_dark_ground(64, ground).view(), {.size = 64}, 23);
  }
  check_sums(sky_over_dark_ground(44, 1e-3F).view(), {.size = 44}, 1);
}

TEST_CASE("Sums over texels give the same bits on any threads and instruction set",
          "[specular][prefilter][bits][sums]") {
  const TestCubemap source = make_cubemap(Content::high_range, 64, 3, 3);
  const InstructionSet before = active_instruction_set();
  const PrefilteredSpecular expected = prefilter_specular(source.view(), {.size = 64});
  REQUIRE(expected.mips[1].method == MipMethod::summed);
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 3}) {
      CAPTURE(name(set), threads);
      run_with_threads(threads, [&] {
        CHECK(same_bits(prefilter_specular(source.view(), {.size = 64}).cubemap, expected.cubemap));
      });
    }
  }
  force_instruction_set(before);
  // A mip does not depend on which others are made.
  const PrefilteredSpecular some = prefilter_specular(source.view(), {.size = 64, .mips = 5});
  CHECK(same_bits(some.cubemap, expected.cubemap));
  forget_allocations_in_tiles();
  static_cast<void>(prefilter_specular(source.view(), {.size = 64}));
  CHECK(allocations_in_tiles() == 0);
}

TEST_CASE("A table of sums has the same weights whichever threads made it", "[prefilter][bits][sums]") {
  const reflections::LobeTableKey key{20, {{10, 0.1}, {7, 0.3}, {1, 1.0}}};  // not from the cache: odd mips, too
  const TestCubemap source = make_cubemap(Content::high_range, 20, 3, 3);
  const auto mips_of = [&](int threads) {
    std::vector<float> texels;
    std::vector<std::array<float*, 6>> faces;
    std::vector<std::vector<float>> mips;
    run_with_threads(threads, [&] {
      const reflections::LobeTable table(key);
      platform::AlignedBuffer<float> room(table.room_floats());
      for (const reflections::LobeMip& mip : key.mips) {
        const auto face = static_cast<std::size_t>(3 * mip.size * mip.size);
        mips.emplace_back(6 * face);
        std::array<float*, 6> to{};
        for (std::size_t k = 0; k < 6; ++k) to[k] = mips.back().data() + k * face;
        faces.push_back(to);
      }
      table.fill(source.view(), room.data(), faces, true, {});
      reflections::BlockLight light(20);
      light.read(source.view());
      for (std::size_t k = 0; k < mips.size(); ++k) {
        texels.insert(texels.end(), mips[k].begin(), mips[k].end());
        texels.push_back(static_cast<float>(table.errors(k).rms(light)));
      }
    });
    return texels;
  };
  const std::vector<float> expected = mips_of(1);
  for (const int threads : {2, 5}) CHECK(same_bytes<float>(expected, mips_of(threads)));
}

TEST_CASE("Tighter bounds, other sizes and the spectral method take harmonics", "[specular][prefilter][sums]") {
  const TestCubemap source = make_cubemap(Content::random, 32, 3, 3);
  const auto method = [&](const PrefilterOptions& options) {
    return prefilter_specular(source.view(), options).mips.back().method;
  };
  CHECK(method({.size = 16, .mips = 1, .roughness = {0.5}}) == MipMethod::summed);
  CHECK(method({.size = 17, .mips = 1, .roughness = {0.5}}) == MipMethod::spectral);
  CHECK(method({.size = 16, .mips = 1, .roughness = {0.14}}) == MipMethod::spectral);  // too narrow for faces of 32
  CHECK(method({.size = 16, .mips = 1, .roughness = {0.5}, .method = PrefilterMethod::spectral}) ==
        MipMethod::spectral);
  CHECK(method({.size = 16, .mips = 1, .roughness = {0.5}, .rms_error = 1e-4}) == MipMethod::spectral);
}

}  // namespace welkin::test
