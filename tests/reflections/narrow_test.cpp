// Lobes below roughness 0.055: the same bounds as everywhere, against the integral in double.

#include <cstddef>
#include <vector>

#include "reflections/lobe.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

const std::vector<double> kNarrow{0.002, 0.01, 0.02, 0.048, 0.0548};

/// The worst relative error allowed, and of the rms: those that the options ask for by default.
constexpr double kMaximum = 1e-2;
constexpr double kRms = 1e-3;

/// Every `step`-th texel of a mip of each roughness.
template <class View>
void check_bounds(const View& view, const std::vector<double>& roughness, int size, std::size_t step) {
  for (const double rough : roughness) {
    CAPTURE(rough, size);
    const PrefilteredSpecular result = prefilter_specular(view, {.size = size, .mips = 1, .roughness = {rough}});
    const MipRecord& mip = result.mips.front();
    REQUIRE(mip.method == MipMethod::narrow);
    REQUIRE(mip.error_estimate.has_value());
    std::vector<glm::dvec3> directions;
    const std::vector<glm::dvec3> all = centres(size);
    for (std::size_t k = 0; k < all.size(); k += step) directions.push_back(all[k]);
    const LevelError error = level_error(result.cubemap, 0, reference_specular(view, rough, directions), step);
    CHECK(error.rms < kRms);
    CHECK(error.maximum < kMaximum);
    CHECK(error.maximum < *mip.error_estimate);
  }
}

/// Squares of 0.01 and 10, `edge` texels each.
LatLongImage blocks(int width, int edge) {
  LatLongImage image{width, width / 2, {}};
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < width; ++column) {
      const float value = (column / edge + row / edge) % 2 == 0 ? 0.01F : 10.0F;
      image.pixels.insert(image.pixels.end(), {value, 0.5F * value, 2.0F * value});
    }
  }
  return image;
}

TestCubemap noisy_cube(int size) { return make_cubemap(Content::random, size, 3, 3); }

}  // namespace

TEST_CASE("Narrow lobes keep the bounds", "[specular][prefilter][narrow]") {
  check_bounds(make_lat_long(Content::random, 256, 128, 3).view(), kNarrow, 32, 101);
  check_bounds(make_lat_long(Content::one_texel_sun, 256, 128, 3).view(), kNarrow, 16, 23);
  check_bounds(blocks(512, 8).view(), {0.01, 0.0548}, 64, 389);
  check_bounds(make_lat_long(Content::random, 64, 32, 3).view(), kNarrow, 16, 31);
  check_bounds(make_lat_long(Content::random, 1024, 512, 3).view(), {0.02, 0.0548}, 128, 4001);
}

TEST_CASE("Narrow lobes keep the bounds near the poles and where texels are not square",
          "[specular][prefilter][narrow]") {
  // the upper and lower face's centres: every texel of small ones is close to a pole
  const TestLatLong source = make_lat_long(Content::random, 128, 64, 3);
  check_bounds(source.view(), {0.01, 0.0548}, 2, 1);
  check_bounds(make_lat_long(Content::random, 67, 35, 3).view(), {0.02}, 7, 5);
  check_bounds(make_lat_long(Content::random, 256, 32, 3).view(), {0.0548}, 16, 37);
  // of 512 texels the middle ones lie within a texel of the pole
  const PrefilteredSpecular fine = prefilter_specular(source.view(), {.size = 256, .mips = 1, .roughness = {0.03}});
  std::vector<glm::dvec3> directions;
  std::vector<std::size_t> places;
  const std::vector<glm::dvec3> all = centres(256);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].y < 0.9999) continue;
    places.push_back(k);
    directions.push_back(all[k]);
  }
  REQUIRE(places.size() > 4);
  const std::vector<glm::dvec3> truth = reference_specular(source.view(), 0.03, directions);
  for (std::size_t k = 0; k < places.size(); ++k)
    CHECK(static_cast<double>(fine.cubemap.face(0, 0)[3 * places[k]]) == Approx(truth[k].x).epsilon(kMaximum));
}

TEST_CASE("Narrow lobes of cubemaps keep the bounds", "[specular][prefilter][narrow]") {
  check_bounds(noisy_cube(48).view(), kNarrow, 16, 37);
  // all directions lie on corners of the source's texels
  check_bounds(noisy_cube(32).view(), {0.002, 0.0548}, 16, 29);
  check_bounds(noisy_cube(3).view(), {0.02}, 8, 7);
}

TEST_CASE("A lobe's far part and near part are the lobe", "[specular][prefilter][narrow]") {
  for (const double alpha : {1e-3, 3e-3}) {
    const std::vector<double> whole = reflections::lobe_spectrum(alpha, 64);
    // split so high that all is far: u is above 40 even at the peak
    const std::vector<double> all = reflections::far_spectrum(alpha, 40.0 / (alpha * alpha), 64);
    for (std::size_t l = 0; l < whole.size(); ++l) CHECK(all[l] == Approx(whole[l]).epsilon(1e-9));
    // and so low that only Gaussians wider than the sphere are far
    CHECK(reflections::far_spectrum(alpha, 1e-3, 1).front() < 1e-8);
  }
}

TEST_CASE("Across the bound between the methods a mip changes by no more than both may err",
          "[specular][prefilter][narrow]") {
  const TestLatLong source = make_lat_long(Content::random, 512, 256, 3);
  const auto mip_of = [&](double roughness) {
    return prefilter_specular(source.view(), {.size = 32, .mips = 1, .roughness = {roughness}});
  };
  const PrefilteredSpecular below = mip_of(0.05486);
  const PrefilteredSpecular above = mip_of(0.05488);
  REQUIRE(below.mips[0].method == MipMethod::narrow);
  REQUIRE(above.mips[0].method == MipMethod::spectral);
  std::vector<glm::dvec3> other;
  for (std::size_t k = 0; k < std::size_t{6} * 32 * 32; ++k) {
    const float* const rgb = above.cubemap.face(0, 0) + 3 * k;
    other.emplace_back(rgb[0], rgb[1], rgb[2]);
  }
  const LevelError error = level_error(below.cubemap, 0, other);
  CHECK(error.rms < 2.0 * kRms);
  CHECK(error.maximum < 2.0 * kMaximum);
}

TEST_CASE("Narrow lobes keep even light, and give the same bits everywhere", "[specular][prefilter][narrow][bits]") {
  LatLongImage even{100, 50, {}};
  for (int k = 0; k < 5000; ++k) even.pixels.insert(even.pixels.end(), {0.7F, 3.0F, 0.01F});
  const PrefilteredSpecular uniform = prefilter_specular(even.view(), {.size = 32, .roughness = kNarrow});
  for (std::size_t k = 0; k < std::size_t{18} * 32 * 32; ++k)
    REQUIRE(static_cast<double>(uniform.cubemap.face(0, 0)[k]) ==
            Approx(static_cast<double>(even.pixels[k % 3])).epsilon(3e-6));

  const TestLatLong source = make_lat_long(Content::one_texel_sun, 128, 64, 3);
  const TestCubemap cube = noisy_cube(24);
  const PrefilterOptions options{.size = 16, .roughness = kNarrow};
  const InstructionSet before = active_instruction_set();
  const PrefilteredSpecular flat = prefilter_specular(source.view(), options);
  const PrefilteredSpecular faces = prefilter_specular(cube.view(), options);
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 3}) {
      CAPTURE(name(set), threads);
      run_with_threads(threads, [&] {
        CHECK(same_bits(prefilter_specular(source.view(), options).cubemap, flat.cubemap));
        CHECK(same_bits(prefilter_specular(cube.view(), options).cubemap, faces.cubemap));
      });
    }
  }
  force_instruction_set(before);
}

TEST_CASE("What is not known of a mip's error is not called zero", "[specular][prefilter][narrow]") {
  const TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  const PrefilteredSpecular sampled = prefilter_specular(
      source.view(), {.size = 8, .roughness = {0.0, 0.02, 0.5}, .method = PrefilterMethod::sampled, .samples = 16});
  CHECK(sampled.mips[0].error_estimate == 0.0);
  CHECK_FALSE(sampled.mips[1].error_estimate.has_value());
  CHECK_FALSE(sampled.mips[2].error_estimate.has_value());
}

}  // namespace welkin::test
