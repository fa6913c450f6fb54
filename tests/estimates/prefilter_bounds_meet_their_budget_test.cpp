// Promise: the estimated rms error of prefiltered mips is at least the true one, against the double-precision integral
// over all texels, in 99 % of random environments; the bounds and source sizes that are picked meet their budget.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "image/texel_geometry.h"
#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/honesty.h"
#include "support/random_atmospheres.h"
#include "support/random_environments.h"
#include "welkin/error_budget.h"
#include "welkin/mip_chain.h"
#include "welkin/resampling.h"

namespace welkin::test {
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
    const auto values = level_of(chain, level);
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
    counts.all.add(error, entry.estimated_error, place + ", bound " + std::to_string(entry.setting.rms_error), 1e-5);
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

TEST_CASE("Bounds of the prefilter are picked by the environment's spectrum", "[estimates][specular]") {
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

TEST_CASE("An estimate does not depend on the exposure", "[estimates][specular]") {
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
    CHECK(choice.estimated_error == Approx(usual.estimated_error).epsilon(1e-3));
  }
  const LatLongImage black{16, 8, std::vector<float>(std::size_t{3} * 16 * 8)};
  CHECK(choose_prefilter(black.view(), options, {.relative = 1e-3}).met);
}

TEST_CASE("A smooth environment asks for looser bounds than a sun", "[estimates][specular]") {
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

}  // namespace welkin::test
