// Promise: with an error budget a plan picks the cheapest setting of each pass that this environment allows; what comes
// out is within the budget of the full bake, and reasons say what was picked and why not.
#include <cmath>
#include <limits>
#include <span>

#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/random_environments.h"
#include "support/thrown_error.h"
#include "welkin/plan.h"
#include "welkin/sky_plan.h"

namespace welkin::test {
namespace {

/// Fine bounds, many bands: a budget has something to spend.
BakeOptions whole_bake() {
  BakeOptions options;
  options.background = false;
  options.specular = PrefilterOptions{.size = 16, .roughness = {0.0, 0.3, 0.6, 1.0}, .rms_error = 3e-4};
  options.irradiance_size = 8;
  options.bands = 9;
  options.brdf.reset();
  return options;
}

LatLongImage grey(int height) {
  return {2 * height, height, std::vector<float>(std::size_t{6} * static_cast<std::size_t>(height * height), 0.5F)};
}

/// With a spot that nothing smooths away.
LatLongImage spotted(int height) {
  LatLongImage image = grey(height);
  for (std::size_t k = 0; k < 3; ++k) image.pixels[image.pixels.size() / 3 + k] = 1e4F;
  return image;
}

double rms_difference(std::span<const float> a, std::span<const float> b) {
  double difference = 0.0;
  double whole = 0.0;
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double off = static_cast<double>(a[k]) - static_cast<double>(b[k]);
    difference += off * off;
    whole += static_cast<double>(b[k]) * static_cast<double>(b[k]);
  }
  return whole > 0.0 ? std::sqrt(difference / whole) : 0.0;
}

bool says(const Plan& plan, const std::string& pass, const std::string& words) {
  INFO(plan.pass(pass).reason);
  return plan.pass(pass).reason.find(words) != std::string::npos;
}

/// How often each was picked: a test of nothing would pass as well.
struct Picked {
  int bands = 0;
  int bounds = 0;
};

template <class Image>
void check_within(const Image& image, double budget, Picked& picked) {
  const Plan planned = plan(image.view(), {.diffuse_bands = 9, .error_budget = budget}, whole_bake());
  const BakeResult part = bake(image.view(), planned);
  BakeOptions exact = whole_bake();
  exact.irradiance_method = IrradianceMethod::direct;
  const BakeResult whole = bake(image.view(), exact);
  if (says(planned, "project", "picked")) {
    ++picked.bands;
    CHECK(part.radiance->bands() <= whole.radiance->bands());
    CHECK(rms_difference(part.irradiance.pixels, whole.irradiance.pixels) <= budget);
  } else {
    CHECK(part.radiance->bands() == whole.radiance->bands());
  }
  if (!says(planned, "specular", "picked")) {
    CHECK(planned.options.specular->rms_error == whole_bake().specular->rms_error);
    return;
  }
  ++picked.bounds;
  for (int level = 1; level < part.specular->cubemap.levels(); ++level) {
    CAPTURE(level);
    CHECK(rms_difference(level_of(part.specular->cubemap, level), level_of(whole.specular->cubemap, level)) <= budget);
  }
}

}  // namespace

TEST_CASE("A bake that spends an error budget is within it", "[plan][estimates]") {
  RandomEnvironments random(91);
  Picked picked;
  for (int trial = 0; trial < 6; ++trial) {
    const double budget = random.scale(3e-3, 0.1);
    if (trial % 2 == 0) {
      const LatLongImage image = random.lat_long(16, 48);
      CAPTURE(random.description(), budget);
      check_within(image, budget, picked);
    } else {
      const CubemapImage image = random.cubemap(12, 24);
      CAPTURE(random.description(), budget);
      check_within(image, budget, picked);
    }
  }
  CHECK(picked.bands >= 2);
  CHECK(picked.bounds >= 3);
}

TEST_CASE("A budget picks what a smooth environment can do with, and says so", "[plan][estimates]") {
  const LatLongImage image = grey(64);
  const Plan planned = plan(image.view(), {.error_budget = 0.01}, whole_bake());
  const Plan exact = plan(image.view(), {}, whole_bake());
  CHECK(planned.options.bands == 1);
  CHECK(planned.options.projected_bands == 0);
  CHECK(planned.options.specular->rms_error == 0.1);
  CHECK(says(planned, "project", "1 band picked: estimated error of irradiance "));
  CHECK(says(planned, "project", ", budget 1 %"));
  CHECK(says(planned, "specular", "rms bound 10 % picked: estimated error of the worst mip "));
  for (const char* pass : {"specular", "project", "irradiance"}) {
    INFO(pass);
    CHECK(planned.pass(pass).predicted_milliseconds < exact.pass(pass).predicted_milliseconds);
  }
  const BakeResult baked = bake(image.view(), planned);
  for (const PassRecord& record : baked.diagnostics.passes) {
    if (record.name == "project") CHECK(record.reason == planned.pass("project").reason);
  }
}

TEST_CASE("Where no estimate is under the budget, all stays as it was", "[plan][estimates]") {
  const LatLongImage image = spotted(64);
  const Plan strict = plan(image.view(), {.diffuse_bands = 9, .error_budget = 1e-6}, whole_bake());
  CHECK(strict.options.bands == 9);
  CHECK(strict.options.specular->rms_error == whole_bake().specular->rms_error);
  CHECK(strict.options.specular->maximum_error == whole_bake().specular->maximum_error);
  CHECK(says(strict, "project", "no fewer: estimated error of irradiance "));
  CHECK(says(strict, "project", "above the budget of 0.0001 %"));
  CHECK(says(strict, "specular", "bounds as they were: of none is the estimated error under the budget of 0.0001 %"));

  BakeOptions few = whole_bake();
  few.bands = 2;
  few.specular->roughness = {0.0, 0.02, 0.6, 1.0};
  const Plan narrow = plan(image.view(), {.error_budget = 0.1}, few);
  CHECK(narrow.options.bands == 2);
  CHECK(says(narrow, "project", "above the budget of 10 %, which 3 bands would meet"));
  CHECK(says(narrow, "specular", "a mip that is sampled has no estimate"));
  CHECK(narrow.options.specular->rms_error == few.specular->rms_error);

  // Nothing but rounding is left of what cancels.
  LatLongImage board = grey(32);
  for (std::size_t k = 0; k < board.pixels.size(); ++k) board.pixels[k] = (k / 3 + k / 192) % 2 == 0 ? 1.0F : -1.0F;
  BakeOptions rough = whole_bake();
  rough.specular = PrefilterOptions{.size = 8, .roughness = {1.0}};
  const Plan cancelled = plan(board.view(), {.error_budget = 0.01}, rough);
  INFO(plan_text(cancelled));
  CHECK(plan_text(cancelled).find("sampled") == std::string::npos);
  CHECK(plan_text(cancelled).find("inf") == std::string::npos);
  CHECK(plan_text(cancelled).find("e+") == std::string::npos);

  few.specular->method = PrefilterMethod::sampled;
  CHECK(says(plan(image.view(), {.error_budget = 0.5}, few), "specular", "the method that was asked for"));
}

TEST_CASE("A budget spends only what the scene needs", "[plan][estimates]") {
  const LatLongImage image = grey(32);
  const Plan light =
      plan(image.view(), {.diffuse_bands = 0, .glossy = std::nullopt, .error_budget = 0.01}, whole_bake());
  CHECK(light.pass("project").reason == "no diffuse light is used");
  CHECK(light.pass("specular").reason == "no glossy materials");
  const Plan rough = plan(image.view(), {.glossy = RoughnessRange{0.6, 1.0}, .error_budget = 0.01}, whole_bake());
  CHECK(rough.options.specular->size == 4);  // a chain of its own: there are no bits to keep
}

TEST_CASE("A budget without pixels, or out of range, is refused", "[plan][estimates]") {
  const LatLongImage image = grey(8);
  for (const double budget : {0.0, -0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    const ThrownError error = thrown_by([&] { static_cast<void>(plan(image.view(), {.error_budget = budget})); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("error budget"));
  }
  const SceneNeeds needs{.error_budget = 0.01};
  const ThrownError shape = thrown_by([&] { static_cast<void>(plan(shape_of(image.view()), needs)); });
  CHECK(shape.code == ErrorCode::invalid_argument);
  CHECK(shape.says("plan the view"));
  const ThrownError file = thrown_by([&] { static_cast<void>(plan(StoredEnvironment{}, needs)); });
  CHECK(file.says("read the file"));
  const ThrownError sky = thrown_by([&] { static_cast<void>(plan(earth(), needs)); });
  CHECK(sky.code == ErrorCode::invalid_argument);
  CHECK(sky.says("choose_sky_tables"));
}

TEST_CASE("Planning by a budget can be stopped", "[plan][estimates]") {
  const LatLongImage image = grey(64);
  std::stop_source stop;
  stop.request_stop();
  const ThrownError error = thrown_by([&] {
    static_cast<void>(plan(image.view(), {.error_budget = 0.01}, whole_bake(), {}, {stop.get_token(), {}}));
  });
  CHECK(error.code == ErrorCode::cancelled);
}

}  // namespace welkin::test
