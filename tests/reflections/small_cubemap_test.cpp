// Small cubemaps, as engines capture probes: blurred by the method of every other size, within the default bounds.
#include "image/geometry.h"
#include "reflections/band_choice.h"
#include "reflections/halved_faces.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {

namespace {

/// A sky of radiance 1 over a ground.
Cubemap sky_over_dark_ground(int size, float ground) {
  return cubemap_of(size,
                    [=](const glm::dvec3& d) { return glm::dvec3(d.y > 0.0 ? 1.0 : static_cast<double>(ground)); });
}

void check_chain(const CubemapView& view, const PrefilterOptions& options, std::size_t step) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  for (std::size_t level = 1; level < result.mips.size(); ++level) {
    const MipRecord& mip = result.mips[level];
    REQUIRE(mip.method == MipMethod::spectral);
    const LevelError error = error_of_mip(view, result, level, mip.size > 8 ? step : 7);
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

// Faces with half as many texels: uniform light, positions of light, and instruction sets.

namespace {

std::size_t floats_of(int size) { return std::size_t{18} * static_cast<std::size_t>(size * size); }

std::vector<const float*> rows_of(const std::vector<float>& faces, int size) {
  std::vector<const float*> rows;
  for (int row = 0; row < 6 * size; ++row) rows.push_back(faces.data() + std::ptrdiff_t{3} * size * row);
  return rows;
}

std::vector<float> black(int size) { return std::vector<float>(floats_of(size), 0.0F); }

}  // namespace

TEST_CASE("uniform light stays uniform on halved faces", "[prefilter][halved]") {
  const std::vector<float> faces(floats_of(64), 0.7F);
  for (const int size : {32, 8}) {
    const auto halved = reflections::halved_faces({rows_of(faces, 64)}, size, {}).owned;
    float worst = 0.0F;
    for (std::size_t k = 0; k < floats_of(size); ++k) worst = std::max(worst, std::abs(halved.data()[k] / 0.7F - 1.0F));
    CHECK(worst < 2e-6F);
  }
}

// A mean over 2 x 2 texels moves the light by a quarter of a large texel.
TEST_CASE("a texel's light stays where it was on halved faces", "[prefilter][halved]") {
  constexpr int size = 64;
  constexpr int half = size / 2;
  const auto fine = image::FaceSolidAngles::get(size);
  const auto coarse = image::FaceSolidAngles::get(half);
  const int row = GENERATE(0, 1, 2, 12, 31, 50, 63);
  const int column = GENERATE(0, 1, 17, 40, 62);
  std::vector<float> faces = black(size);
  faces[3 * static_cast<std::size_t>((2 * size + row) * size + column)] = 1.0F;
  const auto halved = reflections::halved_faces({rows_of(faces, size)}, half, {}).owned;
  glm::dvec3 moments(0.0);  // light, and light times its position in fine texels
  for (int r = 0; r < half; ++r) {
    for (int c = 0; c < half; ++c) {
      const double light = coarse->at(r, c) * static_cast<double>(halved.data()[3 * ((2 * half + r) * half + c)]);
      moments += light * glm::dvec3(1.0, 2 * c + 0.5, 2 * r + 0.5);
    }
  }
  CAPTURE(row, column);
  // next to edges the fraction that lies beyond depends on how fast solid angles change there
  const auto beside_edge = [](int at) { return std::min(at, size - 1 - at) < 11; };
  const double tolerance = beside_edge(row) || beside_edge(column) ? 0.04 : 2e-3;
  CHECK(moments.x == Approx(fine->at(row, column)).epsilon(tolerance));
  CHECK(std::abs(moments.y / moments.x - column) < std::max(tolerance, 0.004));
  CHECK(std::abs(moments.z / moments.x - row) < std::max(tolerance, 0.004));
}

TEST_CASE("halved faces have the same bits with every instruction set", "[prefilter][halved]") {
  constexpr int size = 48;
  std::vector<float> faces = black(size);
  std::uint32_t state = 7;
  for (float& value : faces) value = static_cast<float>((state = state * 1664525U + 1013904223U) >> 8U) * 0x1p-24F;
  const InstructionSet before = active_instruction_set();
  std::vector<float> first;
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    const auto halved = reflections::halved_faces({rows_of(faces, size)}, 24, {}).owned;
    const std::vector<float> values(halved.data(), halved.data() + floats_of(24));
    if (first.empty()) first = values;
    CHECK(same_bytes<float>(values, first));
  }
  force_instruction_set(before);
}

// The prefilter's numbers of bands and rings: as few as the bounds allow, more for images that need them.

namespace {

Cubemap image(int size, const std::function<float(const glm::dvec3&)>& light) {
  return cubemap_of(size, [&](const glm::dvec3& d) { return glm::dvec3(static_cast<double>(light(d))); });
}

/// Rings of latitude of one frequency.
Cubemap stripes(int size, double frequency) {
  return image(size, [=](const glm::dvec3& d) { return std::sin(frequency * std::asin(d.y)) > 0.0 ? 1.0F : 0.01F; });
}

int bands_of(const Cubemap& image, const PrefilterOptions& options) {
  return prefilter_specular(image.view(), options).mips.front().bands;
}

}  // namespace

TEST_CASE("Each looser bound takes fewer bands and rings", "[specular][bands]") {
  constexpr double kAlpha = 0.018;
  int bands = 10'000;
  double rings = 1e9;
  for (const double rms : {1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
    const reflections::ErrorBounds bounds{rms, 10.0 * rms};
    CAPTURE(rms);
    const int own = reflections::bands_within(kAlpha, bounds);
    CHECK(own < bands);
    CHECK(reflections::rings_within(kAlpha, bounds) <= rings);
    const int wide = reflections::bands_within(1.0, bounds);
    CHECK((wide < reflections::bands_within(1.0, bounds.tightened(1)) || wide == 24));  // the minimum
    bands = own;
    rings = reflections::rings_within(kAlpha, bounds);
  }
  // 264 and 540 were taken whatever the image
  CHECK(reflections::bands_within(kAlpha, {}) <= 208);
  CHECK(reflections::rings_within(kAlpha, {}) <= 320.0);
}

TEST_CASE("Each looser bound takes fewer bands, rings and texels of small probes too", "[specular][bands]") {
  int bands = 10'000;
  int rows = 10'000;
  int face = 64;
  for (const double rms : {1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
    const reflections::PrefilterPlan plan =
        reflections::plan_prefilter(PrefilterOptions{.size = 64, .mips = 3, .rms_error = rms})
            .at_step(0, {true, 64, 64});
    CAPTURE(rms);
    CHECK(plan.bands <= bands);
    CHECK(plan.rows_for_cubemap() <= rows);
    CHECK(plan.face_for_cubemap(64) <= face);
    bands = plan.bands;
    rows = plan.rows_for_cubemap();
    face = plan.face_for_cubemap(64);
  }
  CHECK(bands <= 40);
  CHECK(rows <= 60);
  CHECK(face <= 32);
}

TEST_CASE("A bound of 1e-4 begins with hardly more bands than one of 1e-3", "[specular][bands]") {
  for (const int size : {16, 32, 64, 128, 256}) {
    const auto first = [&](double rms) {
      return reflections::plan_prefilter(PrefilterOptions{.size = size, .rms_error = rms})
          .at_step(0, {true, size, size});
    };
    CAPTURE(size);
    CHECK(first(1e-4).bands <= first(1e-3).bands * 5 / 4);
    CHECK(first(1e-3).bands <= (size > 64 ? 192 : 64));
    CHECK(first(1e-4).rows_for_cubemap() <= first(1e-3).rows_for_cubemap() * 9 / 4);
    CHECK(!first(1e-3).near_mips.empty());
    // dark parts then need more
    CHECK(reflections::plan_prefilter(PrefilterOptions{.size = size}).at_step(1, {true, size, size}).bands >=
          reflections::bands_for_dark({}));
  }
}

TEST_CASE("A bound of 1e-4 is kept by one transform of an even image", "[specular][bands]") {
  const Cubemap even =
      image(64, [](const glm::dvec3& d) { return static_cast<float>(1.5 + d.x + 0.3 * std::sin(9.0 * d.y)); });
  const PrefilteredSpecular result = prefilter_specular(even.view(), {.size = 64, .mips = 3, .rms_error = 1.001e-4});
  CHECK(std::ranges::count(result.pixels.passes, "energies", &PassRecord::name) == 0);
  for (const MipRecord& mip : result.mips) CHECK(mip.bands <= 80);  // 240 were used
}

TEST_CASE("An image takes its bands at once where the transform has enough", "[specular][bands]") {
  const Cubemap fine = stripes(64, 20.0);
  const PrefilteredSpecular result =
      prefilter_specular(fine.view(), {.size = 64, .mips = 3, .method = PrefilterMethod::spectral, .rms_error = 3e-2});
  CHECK(std::ranges::count(result.pixels.passes, "energies", &PassRecord::name) == 0);
  CHECK(*result.mips[1].error_estimate <= 3e-2);
}

TEST_CASE("Images with more energy than most take more bands", "[specular][bands]") {
  const PrefilterOptions options{.size = 16, .mips = 1, .roughness = {0.2}, .method = PrefilterMethod::spectral};
  const int usual = reflections::plan_prefilter(options).bands;
  CHECK(bands_of(image(32, [](const glm::dvec3& d) { return static_cast<float>(2.0 + d.x); }), options) <= usual);
  const Cubemap fine = stripes(64, 78.0);
  const PrefilteredSpecular result = prefilter_specular(fine.view(), options);
  CHECK(result.mips.front().bands > reflections::plan_prefilter(options).mips.front().bands.bands());
  CHECK(*result.mips.front().error_estimate <= 1e-3);
}

TEST_CASE("Bands that a small cubemap's lobe will take are foreseen within reason", "[kernels][bands]") {
  const Cubemap noise = image(64, [](const glm::dvec3& d) {
    return static_cast<float>(1.5 + std::sin(9.0 * d.x) +
                              (std::sin(71.0 * d.x + 53.0 * d.y + 97.0 * d.z) > 0.9 ? 20.0 : 0.0));
  });
  const PrefilteredSpecular result =
      prefilter_specular(noise.view(), {.size = 64, .mips = 3, .lobe = LobeFamily::charlie, .rms_error = 1e-2});
  int most = 0;
  for (const PassRecord& pass : result.pixels.passes) {
    if (pass.name == "analyse") most = std::max(most, std::stoi(pass.reason));
  }
  CHECK(most > 112);
  CHECK(most < 2 * result.mips.front().bands);
}

// A chain's other mips decide too, so that a mip has identical bits with and without them.
TEST_CASE("Mips that are left out do not change the bands of the others", "[specular][bands][bits]") {
  const Cubemap fine = stripes(64, 78.0);
  const reflections::PrefilterPlan plan =
      reflections::plan_prefilter({.size = 16, .roughness = {0.2, 0.5}, .method = PrefilterMethod::spectral});
  const PrefilteredSpecular whole = reflections::prefilter(fine.view(), plan, {}, {}, {});
  const PrefilteredSpecular rough = reflections::prefilter(fine.view(), plan.without(1, 0), {}, {}, {});
  CHECK(whole.mips[0].bands > plan.mips[0].bands.bands());
  CHECK(std::ranges::equal(level_values(whole.cubemap, 1), level_values(rough.cubemap, 0)));
}

TEST_CASE("The dark side of a bright sky keeps the bound on the largest error", "[specular][bands][truth]") {
  TestLatLong sky = make_lat_long(Content::uniform, 64, 32, 0);
  for (std::size_t k = 0; k < sky.pixels.size(); ++k) sky.pixels[k] = k < 13U * 64U * 3U ? 1.0F : 3e-4F;
  for (const double roughness : {0.3, 1.0}) {
    const PrefilteredSpecular result = prefilter_specular(
        sky.view(), {.size = 8, .mips = 1, .roughness = {roughness}, .method = PrefilterMethod::spectral});
    const LevelError error = error_of_mip(sky.view(), result, 0);
    CAPTURE(roughness, result.mips[0].bands, error.rms, error.maximum);
    CHECK(error.maximum < 1e-2);
  }
}

TEST_CASE("No estimate is above the bound that was asked for", "[specular][bands]") {
  for (const double rms : {1e-2, 1e-3, 1e-4}) {
    for (const Content content : {Content::random, Content::blocks, Content::one_texel_sun}) {
      const TestCubemap source = make_cubemap(content, 32, 3, 17);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 16,
                                                                            .roughness = {0.2, 0.6},
                                                                            .method = PrefilterMethod::spectral,
                                                                            .rms_error = rms,
                                                                            .maximum_error = 10.0 * rms});
      for (const MipRecord& mip : result.mips) {
        CAPTURE(rms, std::string(name(content)), mip.roughness);
        CHECK(*mip.error_estimate <= rms);
      }
    }
  }
  const TestCubemap source = make_cubemap(Content::one_texel_sun, 32, 3, 17);
  const ThrownError thrown = thrown_by([&] {
    (void)prefilter_specular(source.view(),
                             {.size = 16, .mips = 1, .roughness = {0.6}, .rms_error = 2e-6, .maximum_error = 2e-5});
  });
  CHECK(thrown.code == ErrorCode::limit_exceeded);
  CHECK(thrown.says("would err by an estimated"));
}

// Texels of a coarse mip may miss a lamp whose lobe is narrower than they are: the rest is dark against the lamp's
// errors.
TEST_CASE("Mips that harmonics do not bring within the bound are integrated", "[specular][bands][truth]") {
  int integrated = 0;
  for (std::size_t texel = 0; texel < 5766; texel += 61) {
    TestCubemap source = make_cubemap(Content::random, 31, 3, 17);  // near sums need an even size
    for (float& value : source.pixels) value = static_cast<float>(std::pow(static_cast<double>(value), 12.0));
    for (std::size_t c = 0; c < 3; ++c) source.pixels[3 * texel + c] *= 1e6F;
    PrefilterOptions options{.size = 8, .mips = 1, .roughness = {0.134}};
    const MipRecord mip = prefilter_specular(source.view(), options).mips.front();
    CHECK(*mip.error_estimate <= options.rms_error);
    if (mip.method != MipMethod::reference) continue;
    ++integrated;
    options.method = PrefilterMethod::spectral;
    const ThrownError thrown = thrown_by([&] { (void)prefilter_specular(source.view(), options); });
    CHECK(thrown.code == ErrorCode::limit_exceeded);
  }
  CHECK(integrated > 0);
}

}  // namespace welkin::test
