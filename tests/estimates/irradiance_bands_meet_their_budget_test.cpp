// Promise: the estimated error of irradiance by few bands is at least the true one, against direct integration, in 99 %
// of random environments, and the number of bands that is picked meets its budget.
#include <string>

#include "support/catch.h"
#include "support/honesty.h"
#include "support/random_atmospheres.h"
#include "support/random_environments.h"
#include "welkin/error_budget.h"
#include "welkin/irradiance.h"

namespace welkin::test {
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
    all.add(truth - kTruthError, entry.estimated_error, what + ", bands " + std::to_string(entry.setting), kTruthError);
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

TEST_CASE("Bands of irradiance are picked by the power of the others", "[estimates][irradiance]") {
  compare_family(ErrorMeasure::rms, "rms");
}

TEST_CASE("Bands of irradiance are picked by the worst normal", "[estimates][irradiance]") {
  compare_family(ErrorMeasure::maximum, "maximum");
}

}  // namespace welkin::test
