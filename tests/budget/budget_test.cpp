// Error budgets: estimates are upper bounds in 99 % of random cases, and what is picked meets its budget.

#include "budget/budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "reference/reference_projection.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/honesty.h"
#include "support/random_atmospheres.h"
#include "support/random_environments.h"
#include "support/small_skies.h"
#include "support/thrown_error.h"
#include "welkin/error_budget.h"
#include "welkin/irradiance.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promise: what no estimate could answer is refused by name, and trivial environments are answered as one would.

namespace {

CubemapImage grey(int size, float value) {
  return {size,
          std::vector<float>(std::size_t{18} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size), value)};
}

}  // namespace

TEST_CASE("Budgets and probes out of range are refused", "[budget]") {
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

TEST_CASE("Light from everywhere needs one band and the smallest level", "[budget]") {
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
  CHECK_FALSE(full.setting.target_size);
  CHECK(full.tried.size() == 6);  // 1, 2, 4, 8, midpoint, exact
  const auto dark = choose_irradiance_bands(grey(3, 0.0F).view());
  CHECK(dark.met);
  CHECK(dark.error_estimate == 0.0);
}

TEST_CASE("A budget that nothing meets names the best there is", "[budget]") {
  CubemapImage image = grey(8, 0.0F);
  image.pixels[100] = 1e6F;
  const auto bands = choose_irradiance_bands(image.view(), {.relative = 1e-6});
  CHECK_FALSE(bands.met);
  CHECK(bands.setting == 15);
  CHECK(bands.error_estimate > 1e-3);
  CHECK(bands.tried.size() == 9);
}

TEST_CASE("A chain's levels above the one that is picked are not read", "[budget][projection]") {
  const CubemapImage image = grey(64, 1.0F);
  const CubemapChain chain = build_mips(image.view());
  std::vector<CubemapView> views = chain.views();
  const CubemapImage broken = grey(64, std::numeric_limits<float>::quiet_NaN());
  views[0] = broken.view();
  ProjectionOptions options;
  options.pixels.nan = NonFinitePolicy::reject;
  CHECK(choose_projection(views, options, {.relative = 0.01}).met);
}

// Promise: estimated errors of target sizes and mip levels are at least the true ones, against the double-precision
// projection of all texels, in 99 % of random environments, and the sizes that are picked meet their budget.

namespace {

using budget::relative_difference;

/// Below it, errors are floats' rounding.
constexpr double kFloor = 2e-6;

}  // namespace

TEST_CASE("A level of the mip chain is picked by what finer ones would change", "[budget][projection]") {
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
      all.add(error, entry.error_estimate,
              random.description() + ", " + std::to_string(entry.setting.target_size.value_or(0)), kFloor);
    }
    picked.add(relative_difference(project(chain.views(), choice.setting).radiance, truth), budget.relative,
               random.description());
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 5.0);
  CHECK(picked.share() >= 0.99);
}

// docs/error_budget.md, "what fools it": the promise above ends here, and by how much.
TEST_CASE("Stripes a texel wide leave no trace on the levels below", "[budget][projection]") {
  CubemapImage image{64, std::vector<float>(std::size_t{18} * 64 * 64)};
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = k / 3 % 2 == 0 ? 0.0F : 1.0F;
  const CubemapChain chain = build_mips(image.view());
  const auto choice = choose_projection(chain.views(), {}, {1e-4});
  const SphericalHarmonics truth = reference_projection(image.view());
  const double error = relative_difference(project(chain.views(), choice.setting).radiance, truth);
  CAPTURE(choice.setting.target_size.value_or(0), choice.error_estimate, error);
  CHECK(error > choice.error_estimate);
  CHECK(error < 1.0 / 64.0);
  // Where all texels are read, it is seen.
  const auto measured = choose_projection(image.view(), {}, {1e-4});
  for (const auto& entry : measured.tried) {
    const double off = relative_difference(project(image.view(), entry.setting).radiance, truth);
    CHECK(off <= entry.error_estimate);
  }
}

// Promise: the estimated error of irradiance by few bands is at least the true one, against direct integration, in 99 %
// of random environments, and the number of bands that is picked meets its budget.

namespace {

constexpr double kTruthError = 1e-5;  ///< below it, the truth's own error

template <class Image>
void compare(const Image& image, const std::string& what, const ErrorBudget& budget, Honesty& all, Honesty& picked) {
  const bool by_maximum = budget.measure == ErrorMeasure::maximum;
  const auto choice = choose_irradiance_bands(image.view(), budget);
  const auto errors = irradiance_errors(image.view(), project(image.view(), {.bands = 15}).radiance, 200);
  for (const auto& entry : choice.tried) {
    const IrradianceError& error = errors[static_cast<std::size_t>(entry.setting - 1)];
    const double truth = by_maximum ? error.maximum : error.rms;
    all.add(truth - kTruthError, entry.error_estimate, what + ", bands " + std::to_string(entry.setting), kTruthError);
    if (choice.met && entry.setting == choice.setting) picked.add(truth - kTruthError, budget.relative, what);
  }
}

void compare_family(ErrorMeasure measure, const std::string& name) {
  RandomEnvironments random(72);
  Honesty all("bands, " + name);
  Honesty picked("bands, " + name + ", picked");
  for (int trial = trials(16); trial > 0; --trial) {
    const ErrorBudget budget{random.scale(1e-3, 0.3), measure};
    if (random.chance(0.5)) {
      const CubemapImage image = random.cubemap(5, 24);
      compare(image, random.description(), budget, all, picked);
    } else {
      const LatLongImage image = random.lat_long(8, 40);
      compare(image, random.description(), budget, all, picked);
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

}  // namespace

TEST_CASE("Bands of irradiance are picked by the power of the others", "[budget][irradiance]") {
  compare_family(ErrorMeasure::rms, "rms");
}

TEST_CASE("Bands of irradiance are picked by the worst normal", "[budget][irradiance]") {
  compare_family(ErrorMeasure::maximum, "maximum");
}

// Promise: the estimated rms error of prefiltered mips is at least the true one, against the double-precision integral
// over all texels, in 99 % of random environments; the bounds and source sizes that are picked meet their budget.

namespace {

constexpr int kSize = 8;  ///< of the mip: 384 directions of the truth

/// One mip of one roughness, judged at all its texels.
struct Probe {
  double roughness;
  std::vector<glm::dvec3> truth;

  template <class View>
  Probe(const View& view, double rough) : roughness(rough), truth(reference_specular(view, rough, centres(kSize))) {}

  template <class View>
  [[nodiscard]] double error(const View& view, PrefilterOptions options) const {
    return level_error(prefilter_specular(view, options).cubemap, 0, truth).rms;
  }
};

struct Counts {
  Honesty all{"prefilter, bounds"};
  Honesty picked{"prefilter, bounds that are picked"};
  Honesty sizes{"prefilter, source sizes that are picked"};
};

CubemapImage reduced(const LatLongImage& image, int size) { return to_cubemap(image.view(), size); }

CubemapImage reduced(const CubemapImage& image, int size) {
  const CubemapChain chain = build_mips(image.view());
  CubemapImage result{size, {}};
  for (int level = 0; level < chain.levels(); ++level) {
    if (chain.level_size(level) != size) continue;
    const auto values = level_values(chain, level);
    result.pixels.assign(values.begin(), values.end());
  }
  return result;
}

template <class Image>
void compare(const Image& image, const std::string& what, double roughness, const ErrorBudget& budget,
             bool every_setting, Counts& counts) {
  const Probe probe(image.view(), roughness);
  const PrefilterOptions options{.size = kSize, .mips = 1, .roughness = {roughness}};
  const PrefilterChoice choice = choose_prefilter(image.view(), options, budget, true);
  REQUIRE(choice.mips.size() == 1);
  const std::string place = what + ", roughness " + std::to_string(roughness);
  for (const auto& entry : choice.tried) {
    if (!every_setting && entry.setting != choice.setting) continue;
    const double error = probe.error(image.view(), entry.setting);
    counts.all.add(error, entry.error_estimate, place + ", bound " + std::to_string(entry.setting.rms_error), 1e-5);
    if (choice.met && entry.setting == choice.setting) counts.picked.add(error, budget.relative, place);
  }
  const MipNeed& need = choice.mips[0];
  if (need.source_size == 0) return;
  PrefilterOptions tight = options;
  tight.rms_error = 1e-4;
  tight.maximum_error = 1e-3;
  const CubemapImage small = reduced(image, need.source_size);
  counts.sizes.add(probe.error(small.view(), tight), need.source_size_error, place, 1e-5);
}

}  // namespace

// Seen: 1.2 times the estimate, when all bounds were judged with the lights of the tightest ones.
TEST_CASE("Lights that loose bounds merge count in the estimate", "[budget][specular]") {
  RandomEnvironments random(300'061);
  random.number();
  random.number();
  const LatLongImage image = random.lat_long(6, 24);
  INFO(random.description());
  const PrefilterOptions options{.size = kSize / 2, .mips = 1, .roughness = {0.4888}};
  const PrefilterChoice choice = choose_prefilter(image.view(), options, {0.01});
  const PrefilteredSpecular result = prefilter_specular(image.view(), choice.setting);
  const auto truth = reference_specular(image.view(), 0.4888, centres(kSize / 2));
  CHECK(result.mips[0].bright_texels > 0);
  CHECK(level_error(result.cubemap, 0, truth).rms <= choice.error_estimate);
}

TEST_CASE("Bounds of the prefilter are picked by the environment's spectrum", "[budget][specular]") {
  RandomEnvironments random(73);
  Counts counts;
  // Of fewer than two none may have a source size to judge.
  for (int trial = std::max(2, trials(8)); trial > 0; --trial) {
    const double roughness = random.between(0.25, 1.0);
    const ErrorBudget budget{random.scale(1e-3, 0.1)};
    const bool every_setting = trial % 3 == 0;
    if (random.chance(0.5)) {
      const CubemapImage image = random.cubemap(8, 24);
      compare(image, random.description(), roughness, budget, every_setting, counts);
    } else {
      const LatLongImage image = random.lat_long(12, 32);
      compare(image, random.description(), roughness, budget, every_setting, counts);
    }
  }
  CAPTURE(counts.all.worst_case(), counts.picked.worst_case(), counts.sizes.worst_case());
  CHECK(counts.all.share() >= 0.99);
  CHECK(counts.all.median() <= 10.0);
  CHECK(counts.picked.share() >= 0.99);
  CHECK(counts.sizes.share() >= 0.99);
  CHECK(counts.sizes.median() <= 10.0);
}

TEST_CASE("An estimate does not depend on the exposure", "[budget][specular]") {
  RandomEnvironments random(91);
  const LatLongImage image = random.lat_long(16, 16);
  const PrefilterOptions options{.size = kSize, .mips = 1, .roughness = {0.3}};
  const auto choose_at = [&](int exponent) {
    LatLongImage scaled = image;
    const float most = *std::max_element(scaled.pixels.begin(), scaled.pixels.end());
    for (float& value : scaled.pixels) value = std::ldexp(value / most, exponent);
    return choose_prefilter(scaled.view(), options, {.relative = 1e-3});
  };
  const PrefilterChoice usual = choose_at(0);
  for (const int exponent : {-120, -100, -90, -60, 90, 105, 120, 127}) {
    INFO("times 2^" << exponent);
    const PrefilterChoice choice = choose_at(exponent);
    CHECK(choice.setting.rms_error == usual.setting.rms_error);
    CHECK(choice.error_estimate == Approx(usual.error_estimate).epsilon(1e-3));
  }
  const LatLongImage black{16, 8, std::vector<float>(std::size_t{3} * 16 * 8)};
  CHECK(choose_prefilter(black.view(), options, {.relative = 1e-3}).met);
}

TEST_CASE("A smooth environment asks for looser bounds than a sun", "[budget][specular]") {
  const int height = 64;
  LatLongImage image{2 * height, height, std::vector<float>(std::size_t{6} * height * height)};
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = 1.0F;
  const PrefilterOptions options{.size = 64, .mips = 4};
  const PrefilterChoice uniform = choose_prefilter(image.view(), options, {.relative = 1e-3});
  CHECK(uniform.met);
  CHECK(uniform.setting.rms_error == 0.1);
  for (std::size_t k = 0; k < image.pixels.size(); k += 37) image.pixels[k] = 40.0F;
  const PrefilterChoice dotted = choose_prefilter(image.view(), options, {.relative = 1e-3});
  CHECK(dotted.setting.rms_error < 0.1);
  CHECK(dotted.predicted_nanoseconds > uniform.predicted_nanoseconds);
}

// Promise: estimated errors of a sky's quadrature, table sizes and orders are at least the true ones, against far finer
// settings, in 99 % of random airs and suns, and what is picked meets its budget.

namespace {

using Lights = std::vector<SphericalHarmonics>;

/// Planets with air such as planets have: an Earth's sizes and depths, each off by up to several times.
Atmosphere varied_earth(RandomAtmospheres& random) {
  Atmosphere air = random.chance(0.3) ? mars() : earth();
  const double thicker = random.scale(0.2, 3.0);
  const double hazier = random.scale(0.1, 6.0);
  for (double& value : air.rayleigh.scattering_per_m) value *= thicker;
  for (double& value : air.aerosol.scattering_per_m) value *= hazier;
  for (double& value : air.aerosol.absorption_per_m) value *= hazier;
  air.aerosol_asymmetry = random.between(0.3, 0.95);
  air.aerosol_asymmetries.clear();
  for (double& value : air.ground_albedo) value = random.number();
  return air;
}

glm::dvec3 random_sun(RandomAtmospheres& random) {
  return sun_direction(random.chance(0.3) ? random.between(-6.0, 6.0) : random.between(-6.0, 90.0),
                       random.between(0.0, 360.0));
}

SkyTableOptions small_tables(int orders) {
  SkyTableOptions options = tiny_tables();
  options.view_zeniths = 32;
  options.sun_zeniths = 16;
  options.orders = orders;
  return options;
}

std::string text(const SkyHarmonicsOptions& setting) {
  return std::to_string(setting.zeniths) + " x " + std::to_string(setting.azimuths);
}

}  // namespace

TEST_CASE("Directions of a sky's harmonics are picked by finer ones", "[budget][sky]") {
  RandomAtmospheres random(74);
  Honesty all("sky quadrature");
  Honesty picked("sky quadrature, picked");
  for (int trial = trials(8); trial > 0; --trial) {
    const Atmosphere air = random.chance(0.7) ? varied_earth(random) : random.next();
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, small_tables(1)));
    const SkyView view(tables, random.chance(0.7) ? 0.0 : random.number() * (air.top_radius_m - air.bottom_radius_m));
    const SkyQuadrature quadrature = random.chance(0.6) ? SkyQuadrature::gauss_split : SkyQuadrature::gauss;
    for (int suns = 3; suns > 0; --suns) {
      const std::vector<glm::dvec3> sun{random_sun(random)};
      const ErrorBudget budget{random.scale(1e-3, 0.1)};
      const auto choice = choose_sky_harmonics(view, sun, {.bands = 3, .quadrature = quadrature}, budget);
      const SphericalHarmonics truth =
          SkyProjector(view, {.bands = 3, .quadrature = SkyQuadrature::gauss, .zeniths = 128, .azimuths = 256})
              .project(sun[0]);
      for (const auto& entry : choice.tried) {
        const double error = budget::relative_difference(SkyProjector(view, entry.setting).project(sun[0]), truth);
        all.add(error, entry.error_estimate, text(entry.setting), 1e-5);
        if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, text(entry.setting));
      }
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

TEST_CASE("Sizes of a sky's tables are picked by smaller ones", "[budget][sky]") {
  RandomAtmospheres random(75);
  Honesty all("sky table sizes");
  Honesty picked("sky table sizes, picked");
  SkyTableOptions most = small_tables(1);
  most.sun_zeniths = 32;
  most.transmittance_heights = 32;
  most.transmittance_zeniths = 128;
  most.irradiance_sun_zeniths = 32;
  SkyTableOptions finest = most;
  finest.view_zeniths = 96;
  finest.sun_zeniths = 96;
  finest.sun_angles = 12;
  finest.transmittance_heights = 64;
  finest.transmittance_zeniths = 256;
  for (int trial = trials(3); trial > 0; --trial) {
    const Atmosphere air = varied_earth(random);
    const SkyProbe probe{0.0, {random_sun(random), random_sun(random)}};
    const ErrorBudget budget{random.scale(3e-3, 0.3)};
    const auto choice = choose_sky_tables(air, probe, most, budget);
    const Lights truth = budget::light_of(precompute_sky(air, finest), probe);
    for (const auto& entry : choice.tried) {
      const double error = budget::worst_difference(budget::light_of(precompute_sky(air, entry.setting), probe), truth);
      const std::string size = std::to_string(entry.setting.view_zeniths);
      all.add(error, entry.error_estimate, size, 1e-5);
      if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, size);
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

TEST_CASE("Orders of scattering are picked by how they fall", "[budget][sky]") {
  RandomAtmospheres random(76);
  Honesty all("orders of scattering");
  Honesty picked("orders of scattering, picked");
  for (int trial = trials(2); trial > 0; --trial) {
    const Atmosphere air = varied_earth(random);
    const SkyProbe probe{0.0, {random_sun(random)}};
    const ErrorBudget budget{random.scale(1e-3, 0.1)};
    SkyTableOptions most = tiny_tables();
    most.orders = 10;
    const auto choice = choose_sky_orders(air, probe, most, budget);
    most.orders = 30;
    const Lights truth = budget::light_of(precompute_sky(air, most), probe);
    for (const auto& entry : choice.tried) {
      if (!std::isfinite(entry.error_estimate)) continue;
      const double error = budget::worst_difference(budget::light_of(precompute_sky(air, entry.setting), probe), truth);
      const std::string orders = std::to_string(entry.setting.orders);
      all.add(error, entry.error_estimate, orders, 1e-5);
      if (choice.met && entry.setting == choice.setting) picked.add(error, budget.relative, orders);
    }
  }
  CAPTURE(all.worst_case(), picked.worst_case());
  CHECK(all.share() >= 0.99);
  CHECK(all.median() <= 10.0);
  CHECK(picked.share() >= 0.99);
}

}  // namespace welkin::test
