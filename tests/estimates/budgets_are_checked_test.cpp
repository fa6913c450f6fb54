// Promise: what no estimate could answer is refused by name, and trivial environments are answered as one would.
#include <array>
#include <limits>
#include <vector>

#include "support/catch.h"
#include "support/small_skies.h"
#include "support/thrown_error.h"
#include "welkin/error_budget.h"
#include "welkin/mip_chain.h"

namespace welkin::test {
namespace {

CubemapImage grey(int size, float value) {
  return {size,
          std::vector<float>(std::size_t{18} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size), value)};
}

}  // namespace

TEST_CASE("Budgets and probes out of range are refused", "[estimates]") {
  const CubemapImage image = grey(4, 1.0F);
  for (const double wrong : {0.0, -1.0, 9e-7, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(thrown_by([&] { (void)choose_projection(image.view(), {}, {.relative = wrong}); }).code ==
          ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { (void)choose_irradiance_bands(image.view(), {.relative = wrong}); }).code ==
          ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { (void)choose_prefilter(image.view(), {.size = 4}, {.relative = wrong}); }).code ==
          ErrorCode::invalid_argument);
  }
  CHECK(thrown_by([&] { (void)choose_projection(std::span<const CubemapView>{}); }).code ==
        ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)choose_irradiance_bands(SphericalHarmonics(3), {.energy = -1.0}); }).code ==
        ErrorCode::invalid_argument);
  const SkyView view(small_earth(), 0.0);
  CHECK(thrown_by([&] { (void)choose_sky_harmonics(view, {}); }).code == ErrorCode::invalid_argument);
  const std::array<glm::dvec3, 1> nowhere{glm::dvec3(0.0)};
  CHECK(thrown_by([&] { (void)choose_sky_harmonics(view, nowhere); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)choose_sky_tables(earth(), {}, tiny_tables()); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)choose_sky_orders(earth(), {}, tiny_tables()); }).code == ErrorCode::invalid_argument);
}

TEST_CASE("Light from everywhere needs one band and the smallest level", "[estimates]") {
  const CubemapImage image = grey(16, 2.0F);
  const auto bands = choose_irradiance_bands(image.view(), {.relative = 1e-3});
  CHECK(bands.met);
  CHECK(bands.setting == 1);
  CHECK(bands.relative_to == "root mean square of the irradiance over all normals");
  const CubemapChain chain = build_mips(image.view());
  const auto level = choose_projection(chain.views(), {}, {.relative = 1e-3});
  CHECK(level.met);
  CHECK(level.setting.target_size == 4);  // two differences are asked for
  CHECK(level.tried.size() == 1);
  const auto full = choose_projection(image.view(), {}, {.relative = 1e-3});
  CHECK(full.met);
  CHECK(full.setting.target_size == 0);
  CHECK(full.tried.size() == 6);  // 1, 2, 4, 8, midpoint, exact
  const auto dark = choose_irradiance_bands(grey(3, 0.0F).view());
  CHECK(dark.met);
  CHECK(dark.estimated_error == 0.0);
}

TEST_CASE("A budget that nothing meets names the best there is", "[estimates]") {
  CubemapImage image = grey(8, 0.0F);
  image.pixels[100] = 1e6F;
  const auto bands = choose_irradiance_bands(image.view(), {.relative = 1e-6});
  CHECK_FALSE(bands.met);
  CHECK(bands.setting == 15);
  CHECK(bands.estimated_error > 1e-3);
  CHECK(bands.tried.size() == 9);
}

TEST_CASE("A chain's levels above the one that is picked are not read", "[estimates][projection]") {
  const CubemapImage image = grey(64, 1.0F);
  const CubemapChain chain = build_mips(image.view());
  std::vector<CubemapView> views = chain.views();
  const CubemapImage broken = grey(64, std::numeric_limits<float>::quiet_NaN());
  views[0] = broken.view();
  ProjectionOptions options;
  options.nan = NonFinitePolicy::reject;
  CHECK(choose_projection(views, options, {.relative = 0.01}).met);
}

}  // namespace welkin::test
