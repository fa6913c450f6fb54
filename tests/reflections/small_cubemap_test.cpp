// Small cubemaps, as engines capture probes: blurred by the method of every other size, within the default bounds.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "image/geometry.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

/// A sky of radiance 1 over a ground.
Cubemap sky_over_dark_ground(int size, float ground) {
  Cubemap image{size, std::vector<float>(std::size_t{18} * static_cast<std::size_t>(size * size), ground)};
  const image::TexelGrid grid = image::TexelGrid::cubemap(size);
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    if (grid.direction(texel).y > 0.0) std::fill_n(image.pixels().begin() + 3 * texel, 3, 1.0F);
  }
  return image;
}

void check_chain(const CubemapView& view, const PrefilterOptions& options, std::size_t step) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  for (std::size_t level = 1; level < result.mips.size(); ++level) {
    const MipRecord& mip = result.mips[level];
    REQUIRE(mip.method == MipMethod::spectral);
    std::vector<glm::dvec3> some;
    const std::vector<glm::dvec3> all = centres(mip.size);
    const std::size_t own_step = mip.size > 8 ? step : 7;
    for (std::size_t k = 0; k < all.size(); k += own_step) some.push_back(all[k]);
    const LevelError error =
        level_error(result.cubemap, static_cast<int>(level), reference_specular(view, mip.roughness, some), own_step);
    CAPTURE(view.size, mip.size, mip.roughness, error.rms, *mip.error_estimate);
    CHECK(error.rms < 5e-4);
    CHECK(error.maximum < 1e-2);
    CHECK(error.rms <= *mip.error_estimate);
    CHECK(*mip.error_estimate < 2e-3);
  }
}

}  // namespace

TEST_CASE("Chains from small cubemaps are within the default bounds", "[specular][prefilter][truth][small]") {
  for (const int size : {8, 10, 64}) {
    for (const Content content : {Content::random, Content::high_range, Content::one_texel_sun, Content::uniform}) {
      CAPTURE(name(content));
      const double sharpest = size < 50 ? 0.35 : 0.14;
      check_chain(make_cubemap(content, size, 3, 5).view(),
                  {.size = size, .mips = 3, .roughness = {0.0, sharpest, 0.6}}, 17);
    }
  }
  for (const float ground : {1e-3F, 1e-4F}) {
    check_chain(sky_over_dark_ground(64, ground).view(), {.size = 64}, 97);
  }
  check_chain(sky_over_dark_ground(44, 1e-3F).view(), {.size = 44}, 31);
}

TEST_CASE("Mips of a small cubemap keep their bits in shorter chains, on any threads and instruction set",
          "[specular][prefilter][bits][small]") {
  const TestCubemap source = make_cubemap(Content::high_range, 32, 3, 3);
  const InstructionSet before = active_instruction_set();
  const std::vector<double> roughness{0.0, 0.2, 0.5, 1.0};
  const PrefilteredSpecular expected = prefilter_specular(source.view(), {.size = 32, .roughness = roughness});
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 3}) {
      CAPTURE(name(set), threads);
      run_with_threads(threads, [&] {
        const PrefilteredSpecular chain = prefilter_specular(source.view(), {.size = 32, .roughness = roughness});
        CHECK(same_bits(chain.cubemap, expected.cubemap));
      });
    }
  }
  force_instruction_set(before);
  forget_allocations_in_tiles();
  static_cast<void>(prefilter_specular(source.view(), {.size = 32, .roughness = roughness}));
  CHECK(allocations_in_tiles() == 0);
}

}  // namespace welkin::test
