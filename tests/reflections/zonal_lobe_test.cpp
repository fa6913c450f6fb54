// Chains by kernels: each mip is the integral over its kernel, against the reference and closed forms.
#include "image/geometry.h"
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

std::vector<ZonalLobe> named_kernels() {
  return {ZonalLobe::charlie(0.125), ZonalLobe::charlie(0.35), ZonalLobe::charlie(1.0),
          ZonalLobe::lambert(),      ZonalLobe::phong(20.0),   ZonalLobe::blinn(64.0)};
}

/// Checks all mips against the reference, at about `probes` texels each.
void check_kernels(const EnvironmentView& view, const std::vector<ZonalLobe>& kernels, int size, std::size_t probes) {
  const PrefilteredSpecular result = prefilter_by_lobes(view, {.size = size, .lobes = kernels});
  for (std::size_t level = 0; level < result.mips.size(); ++level) {
    const std::size_t step = step_for(result.mips[level].size, probes);
    const auto truth = reference_by_lobe(view, kernels[level], every(step, texel_centres(result.mips[level].size)));
    const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth, step);
    CAPTURE(level, result.mips[level].bands, result.mips[level].bright_texels, error.rms, error.maximum,
            *result.mips[level].error_estimate);
    CHECK(error.rms < 1e-3);
    CHECK(error.maximum < 1e-2);
    CHECK(error.rms < 2.0 * *result.mips[level].error_estimate);
  }
}

}  // namespace

TEST_CASE("Every content is blurred by kernels to within the bounds", "[zonal][truth]") {
  for (const Content content :
       {Content::random, Content::high_range, Content::sun_disc, Content::blocks, Content::one_texel_sun}) {
    CAPTURE(std::string(name(content)));
    check_kernels(make_lat_long(content, 128, 64, 17).view(), named_kernels(), 32, 6);
  }
}

TEST_CASE("Cubemaps are blurred by kernels to within the bounds", "[zonal][truth]") {
  for (const Content content : {Content::high_range, Content::blocks, Content::one_texel_sun}) {
    CAPTURE(std::string(name(content)));
    check_kernels(make_cubemap(content, 32, 3, 17).view(), named_kernels(), 32, 5);
  }
}

TEST_CASE("Odd sizes are blurred by kernels to within the bounds", "[zonal][truth]") {
  const std::vector<ZonalLobe> kernels{ZonalLobe::charlie(0.2), ZonalLobe::lambert(), ZonalLobe::phong(7.0)};
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {7, 5}, {65, 33}}) {
    CAPTURE(width, height);
    check_kernels(make_lat_long(Content::random, width, height, 4).view(), kernels, 7, 5);
  }
}

TEST_CASE("Chains by kernels have the same bits on any number of threads", "[zonal]") {
  const TestLatLong source = make_lat_long(Content::high_range, 64, 32, 5);
  const LobeChainOptions options{.size = 16, .lobes = {ZonalLobe::charlie(0.3), ZonalLobe::phong(30.0)}};
  std::vector<float> first;
  for (const int threads : {1, 2, 5}) {
    std::vector<float> values;
    run_with_threads(threads, [&] {
      const PrefilteredSpecular result = prefilter_by_lobes(source.view(), options);
      for (int level = 0; level < 2; ++level) {
        const auto own = level_values(result.cubemap, level);
        values.insert(values.end(), own.begin(), own.end());
      }
    });
    if (first.empty()) first = values;
    CHECK(values == first);
  }
}

TEST_CASE("Even light goes through every kernel as it is", "[zonal]") {
  const TestLatLong source = make_lat_long(Content::uniform, 64, 32, 0);
  std::vector<ZonalLobe> kernels = named_kernels();
  kernels.push_back(ZonalLobe::from_spectrum({2.0, 1.0, -0.5}));
  const PrefilteredSpecular result = prefilter_by_lobes(source.view(), {.size = 64, .lobes = kernels});
  for (int level = 0; level < result.cubemap.levels(); ++level)
    CHECK(largest_deviation(result.cubemap, level, source.pixels) < 3e-6);
}

TEST_CASE("A harmonic is multiplied by the kernel's own coefficient", "[zonal]") {
  // 2 + P_2(y), sampled at texels' centres of a map fine enough that it is the harmonic
  TestLatLong source = make_lat_long(Content::uniform, 512, 256, 0);
  for (int row = 0; row < 256; ++row) {
    const double y = image::lat_long_direction(512, 256, 0.5, row + 0.5).y;
    std::fill_n(source.pixels.begin() + std::ptrdiff_t{3} * 512 * row, 3 * 512,
                static_cast<float>(2.0 + 1.5 * y * y - 0.5));
  }
  const std::vector<ZonalLobe> kernels = named_kernels();
  const PrefilteredSpecular result = prefilter_by_lobes(source.view(), {.size = 32, .lobes = kernels});
  for (std::size_t level = 0; level < kernels.size(); ++level) {
    const double factor = kernels[level].spectrum(3)[2];
    const auto directions = texel_centres(result.mips[level].size);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double y = directions[k].y;
      const auto got = static_cast<double>(result.cubemap.face(static_cast<int>(level), 0)[3 * k]);
      CAPTURE(level, factor, y);
      REQUIRE(std::abs(got - (2.0 + factor * (1.5 * y * y - 0.5))) < 5e-5);
    }
  }
}

TEST_CASE("A spectrum that ends far above 0 is integrated to 1e-6, and its mips err by no more than estimated",
          "[zonal][slow]") {
  for (const int rows : {28, 56, 112}) {
    TestLatLong sky = make_lat_long(Content::uniform, 2 * rows, rows, 0);
    for (int row = 0; row < rows; ++row) {
      const double y = image::lat_long_direction(2 * rows, rows, 0.5, row + 0.5).y;
      std::fill_n(sky.pixels.begin() + std::ptrdiff_t{6} * rows * row, 6 * rows, static_cast<float>(1.0 + 0.5 * y));
    }
    std::vector<double> factors(16);
    for (std::size_t l = 0; l < factors.size(); ++l) factors[l] = std::exp(-0.005 * static_cast<double>(l * (l + 1)));
    const ZonalLobe kernel = ZonalLobe::from_spectrum(factors);
    // perpendicular to the axis of a gradient every kernel leaves its mean
    CHECK(std::abs(reference_by_lobe(sky.view(), kernel, {{1.0, 0.0, 0.0}}).front().x - 1.0) < 1e-6);
    const PrefilteredSpecular result = prefilter_by_lobes(sky.view(), {.size = 8, .lobes = {kernel}});
    const LevelError error = level_error(result.cubemap, 0, reference_by_lobe(sky.view(), kernel, texel_centres(8)));
    CAPTURE(rows, error.rms, *result.mips[0].error_estimate);
    CHECK(error.rms <= *result.mips[0].error_estimate);
  }
}

TEST_CASE("Kernels have their closed forms", "[zonal]") {
  SECTION("Charlie's first coefficients") {
    for (const double roughness : {0.11, 0.25, 0.5, 1.0}) {
      const double p = 0.5 / (roughness * roughness);
      const std::vector<double> spectrum = ZonalLobe::charlie(roughness).spectrum(3);
      CHECK(std::abs(spectrum[1] - 2.0 / (p + 3.0)) < 1e-10);
      CHECK(std::abs(spectrum[2] - (9.0 / ((p + 3.0) * (p + 4.0)) - 0.5)) < 1e-10);
      const double c = 1.0 / (1.0 + p);
      const double peak = (p + 1.0) * (p + 2.0) / (2.0 * std::numbers::pi) * c * std::pow(1.0 - c, p);
      CHECK(std::abs(ZonalLobe::charlie(roughness).value(c) - peak) < 1e-9 * peak);
    }
  }
  SECTION("Lambert's") {
    const std::vector<double> spectrum = ZonalLobe::lambert().spectrum(6);
    const std::vector<double> expected{1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0};
    for (std::size_t l = 0; l < expected.size(); ++l) CHECK(std::abs(spectrum[l] - expected[l]) < 1e-12);
    CHECK(std::abs(ZonalLobe::lambert().value(0.3) - 0.3 / std::numbers::pi) < 1e-12);
    CHECK(ZonalLobe::lambert().value(-0.3) == 0.0);
  }
  SECTION("Phong's and Blinn's values, where the lobe is narrow too") {
    for (const double power : {0.5, 1.0, 20.0, 5000.0}) {
      for (const double c : {0.1, 0.9, 0.9999}) {
        const double phong = (power + 1.0) / (2.0 * std::numbers::pi);
        CHECK(std::abs(ZonalLobe::phong(power).value(c) - phong * std::pow(c, power)) < 1e-8 * phong);
      }
    }
    CHECK(std::abs(ZonalLobe::blinn(0.0).value(0.4) - ZonalLobe::lambert().value(0.4)) < 1e-12);
  }
  SECTION("A function of the caller's is the kernel with a name") {
    const ZonalLobe own = ZonalLobe::from_function([](double c) { return c > 0.0 ? 7.0 * c * c * c : 0.0; });
    const std::vector<double> spectrum = own.spectrum(64);
    const std::vector<double> named = ZonalLobe::phong(3.0).spectrum(64);
    for (std::size_t l = 0; l < named.size(); ++l) CHECK(std::abs(spectrum[l] - named[l]) < 1e-11);
  }
  SECTION("Functions that end at the cosine -1, to the last band") {
    for (const double slope : {0.0, 1.0}) {
      const ZonalLobe own = ZonalLobe::from_function([slope](double c) { return 1.0 + slope * c; }, {});
      const std::vector<double> spectrum = own.spectrum(1536);
      for (std::size_t l = 0; l < spectrum.size(); ++l) {
        CAPTURE(slope, l);
        REQUIRE(std::abs(spectrum[l] - (l == 0 ? 1.0 : l == 1 ? slope / 3.0 : 0.0)) < 1e-10);
      }
    }
  }
  SECTION("GGX as a function has its own alpha, by which lamps are searched for") {
    for (const double alpha : {0.02, 0.05, 0.08}) {
      const ZonalLobe own = ZonalLobe::from_function([alpha](double c) {
        const double width = alpha * alpha + 0.5 * (1.0 - c) * (1.0 - alpha * alpha);
        return c > 0.0 ? c / (width * width) : 0.0;
      });
      CHECK(std::abs(own.lobe()->light_alpha() - alpha) < 0.05 * alpha);
    }
  }
  SECTION("A spectrum is what it was made of, and its values are their sum") {
    const ZonalLobe own = ZonalLobe::from_spectrum({2.0, 1.0, 0.5});
    CHECK(own.spectrum(4) == std::vector<double>{1.0, 0.5, 0.25, 0.0});
    CHECK(std::abs(own.value(0.5) - (1.0 + 3.0 * 0.5 * 0.5 + 5.0 * 0.25 * -0.125) / (4.0 * std::numbers::pi)) < 1e-11);
  }
}

TEST_CASE("Kernels that cannot be are refused, and those that are too sharp for the bands", "[zonal]") {
  const TestLatLong source = make_lat_long(Content::random, 32, 16, 1);
  const auto chain = [&](const ZonalLobe& kernel) {
    return thrown_by([&] { static_cast<void>(prefilter_by_lobes(source.view(), {.size = 8, .lobes = {kernel}})); })
        .code;
  };
  CHECK(chain(ZonalLobe::phong(1e6)) == ErrorCode::limit_exceeded);
  CHECK_NOTHROW(prefilter_by_lobes(source.view(), {.size = 8, .lobes = {ZonalLobe::charlie(kMinCharlieRoughness)}}));
  const auto refused = [](const auto& make) {
    return thrown_by([&] { static_cast<void>(make()); }).code == ErrorCode::invalid_argument;
  };
  CHECK(refused([] { return ZonalLobe::charlie(0.0); }));
  CHECK(refused([] { return ZonalLobe::phong(std::numeric_limits<double>::quiet_NaN()); }));
  CHECK(refused([] { return ZonalLobe::from_function([](double) { return 0.0; }); }));
  CHECK(refused([] { return ZonalLobe::from_function([](double c) { return 1.0 / (c - c); }); }));
  CHECK(refused([] { return ZonalLobe::from_function([](double c) { return std::sin(1e9 * c) + 2.0; }); }));
  CHECK(refused([] { return ZonalLobe::from_function(nullptr); }));
  CHECK(refused([] { return ZonalLobe::from_function([](double c) { return c + 2.0; }, {1.0}); }));
  CHECK(refused([] { return ZonalLobe::from_spectrum({}); }));
  CHECK(refused([] { return ZonalLobe::from_spectrum({0.0, 1.0}); }));
  CHECK(refused([&] { return prefilter_by_lobes(source.view(), {.size = 8}); }));
  CHECK(refused([&] {
    return prefilter_by_lobes(source.view(), {.size = 1, .lobes = {ZonalLobe::lambert(), ZonalLobe::lambert()}});
  }));
  CHECK(refused([&] {
    return prefilter_by_lobes(source.view(),
                              {.lobes = {ZonalLobe::lambert()}, .method = static_cast<PrefilterMethod>(9)});
  }));
}

TEST_CASE("Kernels take bands by the energy of the image", "[zonal]") {
  const auto bands = [](Content content, double roughness) {
    const TestLatLong source = make_lat_long(content, 64, 32, 5);
    const PrefilteredSpecular result =
        prefilter_by_lobes(source.view(), {.size = 8, .lobes = {ZonalLobe::charlie(roughness)}});
    CHECK(*result.mips[0].error_estimate < 1e-3);
    // the first estimate of the energies predicts what the second one needs
    CHECK(std::ranges::count(result.pixels.passes, std::string("analyse"), &PassRecord::name) <= 2);
    return result.mips[0].bands;
  };
  CHECK(bands(Content::smooth, 0.11) < bands(Content::blocks, 0.11));
  CHECK(bands(Content::blocks, 0.11) < 400);
  CHECK(bands(Content::blocks, 0.11) < bands(Content::blocks, 0.05));
}

TEST_CASE("A kernel's table is the kernel wherever it is seen", "[zonal]") {
  for (const ZonalLobe& kernel : {ZonalLobe::charlie(0.05), ZonalLobe::charlie(0.5), ZonalLobe::phong(400.0)}) {
    const reflections::Lobe& lobe = *kernel.lobe();
    const reflections::KernelTable& table = lobe.table();
    const double end = (table.first_cell + table.cells()) / table.cells_of_s;
    CHECK(table.first_cell / table.cells_of_s <= lobe.nearest());
    CHECK(end >= lobe.farthest());
    CHECK(end - lobe.nearest() < 1.01 * (lobe.farthest() - lobe.nearest()) + 1e-3);
    for (double s = 0.0; s < 1.0; s += 1.37e-4) {
      const double truth = kernel.value(1.0 - 2.0 * s * s);
      const double position = s * table.cells_of_s - table.first_cell;
      CAPTURE(s);
      if (s < lobe.nearest() || s > lobe.farthest()) {
        REQUIRE(std::abs(truth) < 1e-9 * lobe.peak());
      } else {
        const auto cell = std::min(static_cast<std::size_t>(position), table.lines.size() / 2 - 1);
        const double line = static_cast<double>(table.lines[2 * cell]) +
                            (position - static_cast<double>(cell)) * static_cast<double>(table.lines[2 * cell + 1]);
        REQUIRE(std::abs(line - truth) < 4e-6 * lobe.peak());
      }
    }
  }
}

TEST_CASE("Sheen of roughness 0.05 is within the bounds", "[zonal][truth]") {
  check_kernels(make_lat_long(Content::blocks, 64, 32, 17).view(), {ZonalLobe::charlie(0.05)}, 16, 4);
}

TEST_CASE("Sheen of a panel of lamps is within the bounds", "[zonal][truth]") {
  TestLatLong studio = make_lat_long(Content::uniform, 64, 32, 1);
  for (float& value : studio.pixels) value = 1e-2F;
  for (int row = 8; row < 12; ++row)
    std::fill_n(studio.pixels.begin() + std::ptrdiff_t{3} * (64 * row + 20), 3 * 4, 500.0F);
  check_kernels(studio.view(), {ZonalLobe::charlie(0.1), ZonalLobe::charlie(0.5)}, 16, 1536);
}

TEST_CASE("A kernel's mip whose estimate exceeds the bound is integrated, or refused", "[zonal][truth]") {
  const TestLatLong lamp = make_lat_long(Content::one_texel_sun, 32, 16, 1);
  LobeChainOptions options{.size = 4, .lobes = {ZonalLobe::charlie(0.1)}, .rms_error = 2e-5};
  const PrefilteredSpecular made = prefilter_by_lobes(lamp.view(), options);
  CHECK(made.mips[0].method == MipMethod::reference);
  CHECK(*made.mips[0].error_estimate <= 2e-5);
  const auto refused = [&] {
    const ThrownError thrown = thrown_by([&] { static_cast<void>(prefilter_by_lobes(lamp.view(), options)); });
    return thrown.code == ErrorCode::limit_exceeded && thrown.says("raise rms_error");
  };
  options.method = PrefilterMethod::spectral;
  CHECK(refused());
  options.method = PrefilterMethod::automatic;
  options.lobes = {ZonalLobe::charlie(0.05)};
  options.size = 32;  // whose integral takes minutes
  CHECK(refused());
}

TEST_CASE("The reference method is the truth at every texel", "[zonal]") {
  const TestCubemap source = make_cubemap(Content::high_range, 7, 3, 2);
  const ZonalLobe kernel = ZonalLobe::charlie(0.6);
  const PrefilteredSpecular result =
      prefilter_by_lobes(source.view(), {.size = 3, .lobes = {kernel}, .method = PrefilterMethod::reference});
  const LevelError error = level_error(result.cubemap, 0, reference_by_lobe(source.view(), kernel, texel_centres(3)));
  CHECK(error.maximum < 1e-6);
}

// Properties that hold for GGX hold for the other kernels.

namespace {

/// GGX of the split sum, as a function that the library has no closed form for.
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

TEST_CASE("Images too dark or too bright for floats are blurred by kernels through a scale", "[zonal]") {
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
  CHECK(wanted < 2 * first);  // the rings of the first transform would give no such bound
}

}  // namespace welkin::test
