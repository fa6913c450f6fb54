// Promise: resampled, prefiltered and tabulated images are bit-identical to those on record (see projections_test.cpp).
#include "reflections/prefilter.h"
#include "support/catch.h"
#include "support/recorded_results.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

/// One of a cube's 48 symmetries, with a mirror in it.
const glm::dmat3 kSymmetry(0, 0, 1, 0, -1, 0, 1, 0, 0);

/// A rotation that is none of a cube's symmetries. It is rational: exact up to the division.
glm::dmat3 crooked_turn() { return glm::dmat3(2, -1, 2, 2, 2, -1, -1, 2, 2) / 3.0; }

PrefilterOptions prefilter(PrefilterMethod method, int size, const std::vector<double>& roughness) {
  PrefilterOptions options{.size = size, .roughness = roughness, .method = method};
  return options;
}

PrefilterOptions scheduled(RoughnessSchedule schedule, int size, int mips) {
  return prefilter(PrefilterMethod::automatic, size, mip_roughness(schedule, mips, size));
}

PrefilterOptions bounded(double rms, double maximum) {
  PrefilterOptions options = prefilter(PrefilterMethod::automatic, 16, {0.0, 0.2, 0.5});
  options.rms_error = rms;
  options.maximum_error = maximum;
  return options;
}

/// Returns a function that prefilters an image, which must outlive it.
template <class Image>
auto prefiltered(const Image& image, const PrefilterOptions& options) {
  return [&image, options] { return prefilter_specular(image.view(), options); };
}

/// Some mips at the ends are left out, as where a cache holds them.
PrefilteredSpecular prefiltered_without(const EnvironmentView& view, const PrefilterOptions& options, int sharp,
                                        int rough) {
  return reflections::prefilter(view, reflections::plan_prefilter(options).without(sharp, rough), options.pixels, {},
                                {});
}

const std::vector<glm::dvec3>& directions() {
  static const std::vector<glm::dvec3> all{{1, 0, 0}, {0, 1, 0}, {1, 2, 3}, {-0.3, 0.2, -0.9}};
  return all;
}

}  // namespace

TEST_CASE("Resampled images are the same as before", "[same_as_before]") {
  const TestLatLong wide = make_lat_long(Content::high_range, 128, 64, 41);
  const TestLatLong odd_wide = make_lat_long(Content::random, 37, 19, 42, 4);
  const TestLatLongHalf half = make_lat_long_half(Content::one_texel_sun, 96, 50, 43);
  const TestCubemap cube = make_cubemap(Content::high_range, 32, 3, 44);
  const TestCubemap odd_cube = make_cubemap(Content::nan_bearing, 27, 4, 45);
  const TestCubemapBytes bytes = make_cubemap_bytes(Content::random, 16, 4, 46);
  const glm::dmat3 same(1.0);
  const Control control;
  const auto bilinear = ResampleFilter::bilinear;
  const auto area = ResampleFilter::area;
  require_as_recorded(
      "resampling",
      {
          {"lat_long_to_cubemap_smaller", [&] { return to_cubemap(wide.view(), 12); }},
          {"lat_long_to_cubemap_larger", [&] { return to_cubemap(odd_wide.view(), 33); }},
          {"lat_long_to_cubemap_1", [&] { return to_cubemap(wide.view(), 1); }},
          {"lat_long_to_cubemap_f16", [&] { return to_cubemap(half.view(), 24); }},
          {"lat_long_to_cubemap_symmetry", [&] { return to_cubemap(wide.view(), 16, kSymmetry); }},
          {"lat_long_to_cubemap_turned", [&] { return to_cubemap(wide.view(), 16, crooked_turn()); }},
          {"lat_long_to_cubemap_bilinear", [&] { return to_cubemap(wide.view(), 32, same, bilinear, control); }},
          {"cubemap_moved", [&] { return to_cubemap(odd_cube.view(), 27, kSymmetry); }},
          {"cubemap_to_half", [&] { return to_cubemap(cube.view(), 16); }},
          {"cubemap_to_quarter_symmetry", [&] { return to_cubemap(cube.view(), 8, kSymmetry); }},
          {"cubemap_to_odd", [&] { return to_cubemap(cube.view(), 13); }},
          {"cubemap_to_larger", [&] { return to_cubemap(bytes.view(), 21); }},
          {"cubemap_turned", [&] { return to_cubemap(odd_cube.view(), 15, crooked_turn()); }},
          {"cubemap_to_lat_long", [&] { return to_lat_long(cube.view(), 64, 32); }},
          {"cubemap_to_lat_long_odd", [&] { return to_lat_long(odd_cube.view(), 51, 33); }},
          {"cubemap_to_lat_long_area", [&] { return to_lat_long(cube.view(), 40, 21, same, area, control); }},
          {"cubemap_to_lat_long_area_symmetry",
           [&] { return to_lat_long(cube.view(), 40, 20, kSymmetry, area, control); }},
          {"cubemap_to_lat_long_turned", [&] { return to_lat_long(cube.view(), 40, 20, crooked_turn()); }},
          {"lat_long_to_lat_long", [&] { return to_lat_long(wide.view(), 50, 31); }},
          {"lat_long_turned", [&] { return to_lat_long(odd_wide.view(), 37, 19, crooked_turn()); }},
          {"lat_long_by_texels", [&] { return to_lat_long(wide.view(), 128, 64, rotation_about_y(45.0)); }},
          {"lat_long_mirrored",
           [&] { return to_lat_long(odd_wide.view(), 37, 19, glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1)); }},
          {"rotation_about_y",
           [] { return bits_of(rotation_about_y(33.3), rotation_about_y(-90.0), rotation_about_y(1e5)); }},
          {"mirrored_x", [&] { return mirrored_x(to_cubemap(cube.view(), 8)); }},
      });
}

TEST_CASE("Mip chains are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results;
  for (const auto& [filter_name, filter] :
       {std::pair{"box_", MipFilter::box}, std::pair{"solid_angle_", MipFilter::solid_angle}}) {
    for (const int size : {1, 7, 64, 97}) {
      results.emplace_back(joined(filter_name, size), [cube = make_cubemap(Content::high_range, size, 4, 47),
                                                       filter = filter] { return build_mips(cube.view(), filter); });
    }
  }
  const TestCubemapHalf half = make_cubemap_half(Content::random, 30, 3, 48);
  results.emplace_back("three_levels", [&] { return build_mips(half.view(), MipFilter::solid_angle, 3); });
  require_as_recorded("mips", results);
}

TEST_CASE("Prefiltered specular of lat-longs is the same as before", "[same_as_before]") {
  const TestLatLong sunny = make_lat_long(Content::sun_disc, 128, 64, 51);
  const TestLatLong texel = make_lat_long(Content::one_texel_sun, 96, 48, 52);
  const TestLatLong smooth = make_lat_long(Content::smooth, 75, 38, 53, 4);
  const TestLatLong special = make_lat_long(Content::special_values, 64, 32, 54);
  const TestLatLongHalf half = make_lat_long_half(Content::high_range, 128, 64, 55);
  const std::vector<double> rough{0.0, 0.15, 0.4, 0.7, 1.0};
  PrefilterOptions clamped = prefilter(PrefilterMethod::automatic, 16, rough);
  clamped.pixels.clamp = RadianceClamp{100.0F, true};
  clamped.pixels.negative = NegativePolicy::replace;
  const auto spectral = PrefilterMethod::spectral;
  const auto reference = PrefilterMethod::reference;
  require_as_recorded(
      "prefilter_lat_long",
      {
          {"linear_32", prefiltered(sunny, scheduled(RoughnessSchedule::linear, 32, 6))},
          {"filament_32", prefiltered(sunny, scheduled(RoughnessSchedule::filament, 32, 5))},
          {"babylon_64", prefiltered(half, scheduled(RoughnessSchedule::babylon, 64, 7)), Repeats::once},
          {"default_schedule_8", prefiltered(smooth, {.size = 8})},
          {"odd_19", prefiltered(texel, scheduled(RoughnessSchedule::linear, 19, 4))},
          {"left_out",
           [&] { return prefiltered_without(sunny.view(), scheduled(RoughnessSchedule::linear, 32, 5), 2, 1); }},
          {"clamped", prefiltered(special, clamped)},
          {"loose_bounds", prefiltered(sunny, bounded(3e-2, 0.3))},
          {"tight_bounds", prefiltered(smooth, bounded(1e-4, 1e-3))},
          {"spectral_sun", prefiltered(sunny, prefilter(spectral, 16, {0.2, 0.3, 0.5, 0.8, 1.0}))},
          {"spectral_texel", prefiltered(texel, prefilter(spectral, 16, {0.25, 0.6, 1.0}))},
          {"narrow", prefiltered(texel, prefilter(PrefilterMethod::automatic, 16, {0.002, 0.02, 0.05}))},
          {"reference", prefiltered(smooth, prefilter(reference, 4, {0.0, 0.3, 1.0}))},
          {"reference_at_directions",
           [&] {
             return bits_of(reference_specular(texel.view(), 0.3, directions()),
                            reference_specular(smooth.view(), 0.05, directions()));
           }},
      });
}

TEST_CASE("Prefiltered specular of cubemaps is the same as before", "[same_as_before]") {
  const TestCubemap sunny = make_cubemap(Content::sun_disc, 32, 3, 56);
  const TestCubemap odd = make_cubemap(Content::special_values, 21, 4, 57);
  const TestCubemapHalf half = make_cubemap_half(Content::high_range, 16, 4, 58);
  const PrefilterOptions four = prefilter(PrefilterMethod::automatic, 16, {0.0, 0.2, 0.5, 1.0});
  const auto spectral = PrefilterMethod::spectral;
  const auto reference = PrefilterMethod::reference;
  require_as_recorded(
      "prefilter_cubemap",
      {
          {"linear_32", prefiltered(sunny, scheduled(RoughnessSchedule::linear, 32, 6)), Repeats::once},
          {"filament_16", prefiltered(half, scheduled(RoughnessSchedule::filament, 16, 4))},
          {"babylon_16", prefiltered(half, scheduled(RoughnessSchedule::babylon, 16, 5))},
          {"odd_11", prefiltered(odd, scheduled(RoughnessSchedule::linear, 11, 3))},
          {"left_out", [&] { return prefiltered_without(half.view(), four, 1, 0); }},
          {"spectral", prefiltered(sunny, prefilter(spectral, 8, {0.3, 0.6, 1.0}))},
          {"narrow", prefiltered(sunny, prefilter(PrefilterMethod::automatic, 16, {0.002, 0.02, 0.05}))},
          {"reference", prefiltered(half, prefilter(reference, 4, {0.0, 0.2, 0.7}))},
          {"reference_at_directions", [&] { return reference_specular(sunny.view(), 0.2, directions()); }},
      });
}

TEST_CASE("Roughness schedules are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results;
  for (const RoughnessSchedule schedule :
       {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon, RoughnessSchedule::unity,
        RoughnessSchedule::unreal}) {
    results.emplace_back(name(schedule), [schedule] {
      return bits_of(mip_roughness(schedule, 9, 256), mip_roughness(schedule, 1, 1), mip_roughness(schedule, 16, 77));
    });
  }
  results.emplace_back("mip_for_roughness", [] {
    const std::vector<double> table = mip_roughness(RoughnessSchedule::filament, 6, 64);
    return bits_of(mip_for_roughness(table, 0.37), mip_for_roughness(table, 2.0), mip_for_roughness(table, -1.0));
  });
  require_as_recorded("roughness", results);
}

// The process keeps tables, so that a second request would compare a table with itself: each is requested once.
TEST_CASE("BRDF tables are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results;
  for (const auto& [model_name, model] : {std::pair{"split_sum", BrdfModel::split_sum},
                                          std::pair{"multiple_scattering", BrdfModel::multiple_scattering}}) {
    for (const bool sheen : {false, true}) {
      for (const auto& [width, height] : {std::pair{1, 1}, {9, 7}, {32, 32}}) {
        const BrdfTableOptions options{width, height, model, sheen};
        results.emplace_back(
            joined(model_name, sheen ? "_sheen_" : "_", width, 'x', height), [options] { return brdf_table(options); },
            Repeats::once);
      }
    }
  }
  require_as_recorded("brdf", results);
}

}  // namespace welkin::test
