// Promise: a result's estimate is at least its true error in 99 % of random environments, and at most five times too
// large in the median. `welkin_perf --estimates` measures this over any number of environments.
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/estimate_trials.h"
#include "support/random_environments.h"
#include "support/sun_maps.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

double largest_median(const std::string& kind) {
  // Few of the drawn mips have a notable error, and smooth images of odd sizes are overrepresented. The bound holds for
  // any image: on faces of 4 to 16 texels with many bands it is loose.
  if (kind == "projection, midpoint rule, cubemap") return 8.0;
  // Conservative near the lights of small cubemaps, whose mips hit a lamp's peak or miss it.
  if (kind == "prefilter, spectral, cubemap") return 8.0;
  // 1e-5 is added for the flanks of lamps, where most mips have no notable error.
  if (kind == "prefilter, near_far, lat-long") return 8.0;
  // Losses of rings in far parts are counted as those of other mips are.
  if (kind == "prefilter, near_far, cubemap") return 6.0;
  return 5.0;
}

void check(const EstimateTrials& trials) {
  for (const auto& [kind, honesty] : trials) {
    CAPTURE(kind, honesty->count(), honesty->worst(), honesty->worst_case());
    const auto count = static_cast<double>(honesty->count());
    CHECK((1.0 - honesty->share()) * count <= 1.001 + 0.02 * count);  // 1 % is expected: of so few, one or two
    CHECK(honesty->worst() < 2.0);
    CHECK(honesty->median() <= largest_median(kind));
  }
}

}  // namespace

TEST_CASE("True errors lie under their estimates", "[estimates][specular][projection][truth]") {
  EstimateTrials trials;
  add_estimate_trials(100'000, 300, {0.12, 1.0}, {}, trials);
  CHECK(trials.size() >= 9);
  check(trials);
}

// Small sources with large chains, lamps of 1e4 to 1e8, half black maps, checkers, uniform maps, noise of sigma 4: 100
// environments.
TEST_CASE("True errors of what deceived estimates lie under them", "[estimates][specular][projection][truth]") {
  EstimateTrials trials;
  add_family_trials(120'000, 100, {0.12, 1.0}, false, trials);
  std::erase_if(trials, [](const auto& entry) {
    return entry.first.find("level of a mip chain") != std::string::npos;  // unknowable: docs/maths/reflections.md
  });
  CHECK(trials.size() >= 8);
  for (const auto& [kind, honesty] : trials) {
    CAPTURE(kind, honesty->count(), honesty->share(), honesty->worst(), honesty->worst_case());
    CHECK(honesty->count() >= 6);
    CHECK((1.0 - honesty->share()) * static_cast<double>(honesty->count()) <= 1.001);
    CHECK(honesty->worst() < 3.0);
  }
}

TEST_CASE("True errors of narrow lobes lie under their estimates", "[estimates][specular][narrow][truth]") {
  EstimateTrials trials;
  add_estimate_trials(110'000, 20, {0.02, 0.0545}, {}, trials);
  add_family_trials(111'000, 20, {0.02, 0.0545}, false, trials);
  std::erase_if(trials, [](const auto& entry) { return entry.first.rfind("prefilter, near_far", 0) != 0; });
  CHECK(trials.size() == 2);
  check(trials);
}

// Panels, lamps, noise and all else, within 1e-3 and 1e-4. Lights at horizons were once wrong by 10 to 300 times this.
TEST_CASE("True errors of other lobes lie under their estimates, and few are refused", "[estimates][zonal][truth]") {
  EstimateTrials trials;
  CHECK(add_lobe_trials(130'000, 24, {}, trials) <= 2);
  for (const auto& [kind, honesty] : trials) {
    CAPTURE(kind, honesty->count(), honesty->worst(), honesty->worst_case());
    CHECK(honesty->share() == 1.0);
  }
}

// Observed: 7e-5, 3.5 times the estimate. Parts of lamps, meant for texels whose horizon cuts them, were used for all
// texels of a block, and a block of the smallest mips reaches from a lamp's peak to its horizon.
TEST_CASE("Lamps in the smallest mips are right at their peaks", "[estimates][specular][bright][truth]") {
  RandomEnvironments random(5);
  for (int k = 0; k < 4; ++k) {
    const Cubemap lamps = random.cubemap(Family::lamps, 67);
    const PrefilteredSpecular result = prefilter_specular(lamps.view(), {.size = 4, .mips = 1, .roughness = {0.4447}});
    CAPTURE(k);
    CHECK(error_of_mip(lamps.view(), result, 0).rms < 2e-6);
  }
}

TEST_CASE("A channel too dark for the bound on the largest error is named", "[specular]") {
  const auto names_dark = [](const Cubemap& image, double roughness) {
    const auto result = prefilter_specular(image.view(), {.size = 16, .mips = 1, .roughness = {roughness}});
    return std::ranges::count(result.pixels.passes, "mip 0: dark channels", &PassRecord::name) > 0;
  };
  for (const int size : {16, 67}) {
    const auto floats = std::size_t{3} * static_cast<std::size_t>(size * size);
    Cubemap image{size, std::vector<float>(6 * floats, 1.0F)};
    image.pixels()[floats / 2] = 1e6F;
    for (const double roughness : {0.03, 0.3, 0.7}) {
      CAPTURE(size, roughness);
      CHECK_FALSE(names_dark(image, roughness));
    }
    const std::vector<glm::dvec3> positions = texel_centres(size);  // a sky of 1 over a ground of 1e-7
    for (std::size_t k = 0; k < 3 * positions.size(); ++k) image.pixels()[k] = positions[k / 3].y > 0.0 ? 1.0F : 1e-7F;
    CHECK(names_dark(image, 0.3));
  }
}

// While images of more than 24576 texels were not summed, the error was 1.3e-2 and the estimate 3.6e-7.
TEST_CASE("Estimates count stripes next to the bands in images of many texels", "[estimates][specular]") {
  LatLongImage rows{248, 124, {}};
  for (int k = 0; k < 248 * 124; ++k) rows.pixels.insert(rows.pixels.end(), 3, k / 248 % 2 == 0 ? 1e-3F : 1.0F);
  const auto result = prefilter_specular(rows.view(), {.size = 4, .mips = 1, .roughness = {0.15}, .rms_error = 1e-2});
  CHECK(error_of_mip(rows.view(), result, 0).rms <= result.mips[0].error_estimate);
}

// Weights of a ring table are floats: their rounding of uniform light exceeded the estimate where lobes are narrow.
TEST_CASE("Estimates count what tables of rings round", "[estimates][specular][truth]") {
  for (const int size : {4, 8, 10, 16}) {
    const Cubemap even = grey_cubemap(size, 1.37F);
    for (const double roughness : {0.07, 0.15, 0.3}) {
      const auto result = prefilter_specular(even.view(), {.size = 16, .mips = 1, .roughness = {roughness}});
      const std::vector<glm::dvec3> truth(std::size_t{6} * 16 * 16, glm::dvec3(static_cast<double>(1.37F)));
      CAPTURE(size, roughness);
      CHECK(level_error(result.cubemap, 0, truth).rms <= result.mips[0].error_estimate);
    }
  }
}

}  // namespace welkin::test
