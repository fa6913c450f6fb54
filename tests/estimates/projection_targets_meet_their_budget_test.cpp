// Promise: estimated errors of target sizes and mip levels are at least the true ones, against the double-precision
// projection of all texels, in 99 % of random environments, and the sizes that are picked meet their budget.
#include <cstddef>
#include <string>
#include <vector>

#include "estimates/budget.h"
#include "support/catch.h"
#include "support/honesty.h"
#include "support/random_atmospheres.h"
#include "support/random_environments.h"
#include "welkin/error_budget.h"
#include "welkin/mip_chain.h"

namespace welkin::test {
namespace {

using estimates::relative_difference;

/// Below it, errors are floats' rounding.
constexpr double kFloor = 2e-6;

}  // namespace

TEST_CASE("A level of the mip chain is picked by what finer ones would change", "[estimates][projection]") {
  RandomEnvironments random(71);
  Honesty all("projection, levels of a chain");
  Honesty picked("projection, the level that is picked");
  for (int trial = trials(50); trial > 0; --trial) {
    const CubemapImage image = random.cubemap(8, 48);
    const SphericalHarmonics truth = reference_projection(image.view());
    const CubemapChain chain = build_mips(image.view(), random.chance(0.7) ? MipFilter::solid_angle : MipFilter::box);
    const ErrorBudget budget{random.scale(1e-5, 0.3)};
    const auto choice = choose_projection(chain.views(), {}, budget);
    REQUIRE(choice.met);
    for (const auto& entry : choice.tried) {
      const double error = relative_difference(project(chain.views(), entry.setting).radiance, truth);
      all.add(error, entry.estimated_error, random.description() + ", " + std::to_string(entry.setting.target_size),
              kFloor);
    }
    picked.add(relative_difference(project(chain.views(), choice.setting).radiance, truth), budget.relative,
               random.description());
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

// docs/error_budget.md, "what fools it": the promise above ends here, and by how much.
TEST_CASE("Stripes a texel wide leave no trace on the levels below", "[estimates][projection]") {
  CubemapImage image{64, std::vector<float>(std::size_t{18} * 64 * 64)};
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = k / 3 % 2 == 0 ? 0.0F : 1.0F;
  const CubemapChain chain = build_mips(image.view());
  const auto choice = choose_projection(chain.views(), {}, {1e-4});
  const SphericalHarmonics truth = reference_projection(image.view());
  const double error = relative_difference(project(chain.views(), choice.setting).radiance, truth);
  CAPTURE(choice.setting.target_size, choice.estimated_error, error);
  CHECK(error > choice.estimated_error);
  CHECK(error < 1.0 / 64.0);
  // Where all texels are read, it is seen.
  const auto measured = choose_projection(image.view(), {}, {1e-4});
  for (const auto& entry : measured.tried) {
    const double off = relative_difference(project(image.view(), entry.setting).radiance, truth);
    CHECK(off <= entry.estimated_error);
  }
}

}  // namespace welkin::test
