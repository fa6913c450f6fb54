// One chain for every lobe: what holds for GGX holds for the others.
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

/// GGX of the split sum, as a function that the library knows nothing of.
ZonalLobe ggx_by_function(double alpha) {
  return ZonalLobe::from_function([alpha](double cosine) { return reflections::lobe(cosine, alpha); });
}

bool has_pass(const PrefilteredSpecular& result, const std::string& name) {
  return std::ranges::any_of(result.pixels.passes, [&](const PassRecord& pass) { return pass.name == name; });
}

double relative(double found, double expected) { return std::abs(found / expected - 1.0); }

}  // namespace

TEST_CASE("GGX has one form as a lobe, in closed form and followed by polynomials", "[zonal][lobe]") {
  for (const double alpha : {0.04, 0.3, 1.0}) {
    const reflections::Lobe closed(alpha);
    const ZonalLobe kernel = ggx_by_function(alpha);
    const reflections::Lobe& followed = *kernel.lobe();
    CAPTURE(alpha);
    CHECK(closed.alpha() == alpha);
    CHECK(followed.alpha() == 0.0);
    for (const double cosine : {1.0, 0.999, 0.7, 0.01, -0.5})
      CHECK(std::abs(closed.value(cosine) - followed.value(cosine)) < 1e-9 * closed.peak());
    const std::vector<double> one = closed.spectrum(200);
    const std::vector<double> other = followed.spectrum(200);
    for (std::size_t l = 0; l < one.size(); ++l) REQUIRE(std::abs(one[l] - other[l]) < 1e-9);
    CHECK(relative(closed.peak(), followed.peak()) < 1e-9);
    CHECK(closed.square() >= 0.999 * followed.square());
    CHECK(closed.square() < 2.0 * followed.square());
    CHECK(closed.scale() <= 1.1 * followed.scale());
    CHECK(closed.scale() >= 0.5 * followed.scale());
    CHECK(closed.hemisphere());
    CHECK(followed.hemisphere());
    CHECK(closed.farthest() >= followed.farthest() - 1e-9);
  }
}

TEST_CASE("A spectrum has the same bits however many bands were asked for before", "[zonal][lobe]") {
  const ZonalLobe fresh = ZonalLobe::charlie(0.4);
  const ZonalLobe used = ZonalLobe::charlie(0.4);
  static_cast<void>(used.spectrum(700));
  CHECK(fresh.spectrum(40) == used.spectrum(40));
}

TEST_CASE("GGX given as a function is blurred as GGX", "[zonal]") {
  const TestCubemap source = make_cubemap(Content::high_range, 32, 3, 9);
  const std::vector<double> roughness{0.35, 0.6};
  LobeChainOptions kernels{.size = 16};
  for (const double one : roughness) kernels.lobes.push_back(ggx_by_function(one * one));
  const PrefilteredSpecular found = prefilter_by_lobes(source.view(), kernels);
  const PrefilteredSpecular expected =
      prefilter_specular(source.view(), {.size = 16, .mips = 2, .roughness = roughness});
  for (int level = 0; level < 2; ++level) {
    const auto values = level_values(found.cubemap, level);
    const auto truth = level_values(expected.cubemap, level);
    double off = 0.0;
    double whole = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto wanted = static_cast<double>(truth[k]);
      off += (static_cast<double>(values[k]) - wanted) * (static_cast<double>(values[k]) - wanted);
      whole += wanted * wanted;
    }
    CHECK(std::sqrt(off / whole) < 1e-3);
  }
}

TEST_CASE("Chains by kernels name their passes, their memory and dark channels", "[zonal]") {
  TestLatLong source = make_lat_long(Content::high_range, 64, 32, 5);
  const LobeChainOptions options{.size = 16, .lobes = {ZonalLobe::charlie(0.4), ZonalLobe::lambert()}};
  const PrefilteredSpecular result = prefilter_by_lobes(source.view(), options);
  for (const char* const pass : {"bright texels", "rings", "analyse", "mip 0: synthesise", "mip 1: lobes"})
    CHECK(has_pass(result, pass));
  CHECK(result.peak_bytes > 0);
  CHECK_FALSE(has_pass(result, "mip 0: dark channels"));
  for (std::size_t k = 2; k < source.pixels.size(); k += 3) source.pixels[k] = 1e-7F;  // blue
  CHECK(has_pass(prefilter_by_lobes(source.view(), options), "mip 0: dark channels"));
}

TEST_CASE("A mip by a kernel keeps its bits where others are left out", "[zonal][bits]") {
  const TestCubemap source = make_cubemap(Content::one_texel_sun, 16, 3, 2);
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(
      LobeChainOptions{.size = 16, .lobes = {ZonalLobe::charlie(0.3), ZonalLobe::phong(30.0), ZonalLobe::lambert()}});
  const PrefilteredSpecular whole = reflections::prefilter(source.view(), plan, {}, {}, {});
  const PrefilteredSpecular part = reflections::prefilter(source.view(), plan.without(1, 1), {}, {}, {});
  CHECK(std::ranges::equal(level_values(part.cubemap, 0), level_values(whole.cubemap, 1)));
  CHECK(part.mips[0].error_estimate == whole.mips[1].error_estimate);
}

TEST_CASE("Pictures too dark or too bright for floats are blurred by kernels through a scale", "[zonal]") {
  const TestCubemap source = make_cubemap(Content::random, 8, 3, 2);
  const LobeChainOptions options{.size = 4, .lobes = {ZonalLobe::charlie(0.5)}};
  const PrefilteredSpecular unscaled = prefilter_by_lobes(source.view(), options);
  const auto expected = level_values(unscaled.cubemap, 0);
  for (const float scale : {0x1p-122F, 0x1p124F}) {
    TestCubemap scaled = source;
    for (auto& value : scaled.pixels) value *= scale;
    const PrefilteredSpecular result = prefilter_by_lobes(scaled.view(), options);
    const auto found = level_values(result.cubemap, 0);
    for (std::size_t k = 0; k < found.size(); ++k)
      REQUIRE(relative(static_cast<double>(found[k]), static_cast<double>(scale) * static_cast<double>(expected[k])) <
              1e-5);
  }
}

TEST_CASE("A kernel with a name is made once", "[zonal]") {
  CHECK(ZonalLobe::charlie(0.3).lobe() == ZonalLobe::charlie(0.3).lobe());
  CHECK(ZonalLobe::charlie(0.3).lobe() != ZonalLobe::charlie(0.4).lobe());
  CHECK(ZonalLobe::phong(20.0).lobe() != ZonalLobe::blinn(20.0).lobe());
}

TEST_CASE("The transform that a cubemap needs for sheen is foreseen by the rings that it will have", "[zonal][bits]") {
  reflections::PrefilterPlan plan =
      reflections::plan_prefilter(PrefilterOptions{.size = 64, .mips = 1, .lobe = LobeFamily::charlie});
  std::vector<double> energies;
  for (int l = 0; l < plan.bands; ++l) energies.push_back((2.0 * l + 1.0) / (1.0 + std::pow(l, 3.0)));
  const reflections::SpectralSource source{energies, 512, plan.rows_for_cubemap()};
  const int first = plan.bands;
  const int wanted = reflections::choose_bands_by_energy(plan, source);
  CAPTURE(first, wanted);
  CHECK(wanted > first);
  CHECK(wanted < 2 * first);  // by the rings of the first transform none would do
}

}  // namespace welkin::test
