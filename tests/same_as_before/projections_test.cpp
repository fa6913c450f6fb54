// Promise: projections are bit-identical to those on record. The other results are tested by the other files of this
// folder; all are on record in data/same_as_before.txt. A changed bit is a finding to be explained. Only public headers
// are included here, so that the tests outlive changes of the internals.
//
// Results that use libm, and so differ between C libraries, are left out: the reference projection, the reference sky
// and its paths. Texts and times are left out, too.
#include "support/catch.h"
#include "support/recorded_results.h"
#include "support/test_environments.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

template <class View>
View with_format(View view, PixelFormat format) {
  view.format = format;
  return view;
}

PixelFormat srgb_of(PixelFormat linear) {
  return linear == PixelFormat::rgb8 ? PixelFormat::srgb8 : PixelFormat::srgba8;
}

constexpr std::array<std::pair<const char*, Quadrature>, 2> kQuadratures{
    {{"exact", Quadrature::exact}, {"midpoint", Quadrature::midpoint}}};

struct NamedOptions {
  const char* name;
  Content content;
  ProjectionOptions options;
};

/// Pixel policies, with content that each applies to.
const std::vector<NamedOptions>& policies() {
  static const std::vector<NamedOptions> all{
      {"replaced", Content::special_values, {}},
      {"clamp", Content::clamped, {.pixels = {.clamp = RadianceClamp{}}}},
      {"clamp_keeps_colour", Content::clamped, {.pixels = {.clamp = RadianceClamp{1000.0F, true}}}},
      {"clamp_low", Content::high_range, {.pixels = {.clamp = RadianceClamp{0.75F, false}}}},
      {"clamp_of_special_values", Content::special_values, {.pixels = {.clamp = RadianceClamp{}}}},
      {"clamp_keeps_colour_of_special_values",
       Content::special_values,
       {.pixels = {.clamp = RadianceClamp{50.0F, true}}}},
      {"gamma", Content::gamma_encoded, {.pixels = {.gamma = true}}},
      {"gamma_and_clamp", Content::gamma_encoded, {.pixels = {.clamp = RadianceClamp{0.5F, false}, .gamma = true}}},
      {"negatives_kept", Content::nan_bearing, {}},
      {"negatives_replaced", Content::nan_bearing, {.pixels = {.negative = NegativePolicy::replace}}},
      {"nothing_to_reject",
       Content::random,
       {.pixels = {.nan = NonFinitePolicy::reject,
                   .infinity = NonFinitePolicy::reject,
                   .negative = NegativePolicy::reject}}},
      {"midpoint_of_special_values",
       Content::special_values,
       {.quadrature = Quadrature::midpoint, .pixels = {.clamp = RadianceClamp{}, .negative = NegativePolicy::replace}}},
  };
  return all;
}

}  // namespace

TEST_CASE("Projections of every pixel format under every policy are the same as before", "[same_as_before]") {
  // A table of weights, weights that are computed as rows are read, strips, the means of blocks, and a lat-long.
  // Radiance to 3e38 overflows a tile's sums of float.
  struct NamedShape {
    const char* name;
    int size;
    std::optional<int> target;
  };
  constexpr std::array<NamedShape, 4> kCubemaps{
      {{"table", 31, {}}, {"rows", 200, {}}, {"strips", 256, {}}, {"reduced", 62, 16}}};
  const std::vector<std::pair<const char*, PixelPolicy>> policies{
      {"kept", {}},
      {"clamped", {.clamp = RadianceClamp{0.5F, true}}},
      {"no_negatives", {.negative = NegativePolicy::replace}},
      {"gamma", {.gamma = true}},
  };
  constexpr Content kContent = Content::special_values;
  std::vector<NamedResult> results;
  const auto add = [&](const std::string& name, const auto& image, std::optional<int> target, PixelFormat format) {
    for (const auto& [policy_name, policy] : policies) {
      results.emplace_back(name + '_' + policy_name,
                           [image, format, options = ProjectionOptions{.target_size = target, .pixels = policy}] {
                             return project(with_format(image->view(), format), options);
                           });
    }
  };
  const auto add_kind = [&](const std::string& name, const auto& cubemap, const auto& lat_long, bool srgb) {
    for (const int channels : {3, 4}) {
      const std::string start = joined(channels == 3 ? "rgb" : "rgba", name);
      for (const NamedShape& shape : kCubemaps) {
        const auto image = std::make_shared<decltype(cubemap(kContent, 1, 3, 0))>(
            cubemap(kContent, shape.size, channels, channels == 3 ? 1U : 2U));
        const PixelFormat linear = image->view().format;
        add(start + '_' + shape.name, image, shape.target, linear);
        if (srgb) add("s" + start + '_' + shape.name, image, shape.target, srgb_of(linear));
      }
      const auto image = std::make_shared<decltype(lat_long(kContent, 1, 1, 0, 3))>(
          lat_long(kContent, 70, 35, channels == 3 ? 1U : 2U, channels));
      const PixelFormat linear = image->view().format;
      add(start + "_lat_long", image, std::nullopt, linear);
      if (srgb) add("s" + start + "_lat_long", image, std::nullopt, srgb_of(linear));
    }
  };
  add_kind("32f", make_cubemap, make_lat_long, false);
  add_kind("16f", make_cubemap_half, make_lat_long_half, false);
  add_kind("8", make_cubemap_bytes, make_lat_long_bytes, true);
  require_as_recorded("projection_format", results);
}

TEST_CASE("Projections of every size are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results;
  for (const auto& [quadrature_name, quadrature] : kQuadratures) {
    const ProjectionOptions options{.bands = 4, .quadrature = quadrature};
    for (const int size : {1, 2, 3, 7, 64, 257}) {
      results.emplace_back(
          joined("cubemap_", size, '_', quadrature_name),
          [cube = make_cubemap(Content::sun_disc, size, 4, 7), options] { return project(cube.view(), options); });
    }
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 2}, {7, 9}, {64, 32}, {257, 129}, {512, 256}}) {
      results.emplace_back(joined("lat_long_", width, 'x', height, '_', quadrature_name),
                           [wide = make_lat_long(Content::sun_disc, width, height, 8), options] {
                             return project(wide.view(), options);
                           });
    }
  }
  require_as_recorded("projection_size", results);
}

TEST_CASE("Projections to every number of bands are the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 33, 3, 9);
  const TestLatLong wide = make_lat_long(Content::high_range, 65, 33, 10);
  std::vector<NamedResult> results;
  for (const int bands : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 16}) {
    results.emplace_back(joined("cubemap_", bands), [&cube, bands] { return project(cube.view(), {.bands = bands}); });
  }
  for (const int bands : {1, 2, 3, 6, 10, 16}) {
    results.emplace_back(joined("lat_long_", bands), [&wide, bands] { return project(wide.view(), {.bands = bands}); });
  }
  results.emplace_back("cubemap_10_midpoint",
                       [&] { return project(cube.view(), {.bands = 10, .quadrature = Quadrature::midpoint}); });
  require_as_recorded("projection_bands", results);
}

TEST_CASE("Projections under every policy are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results;
  for (const NamedOptions& policy : policies()) {
    results.emplace_back(joined("cubemap_", policy.name),
                         [cube = make_cubemap(policy.content, 41, 4, 11), options = policy.options] {
                           return project(cube.view(), options);
                         });
    results.emplace_back(joined("lat_long_", policy.name),
                         [wide = make_lat_long(policy.content, 90, 47, 12), options = policy.options] {
                           return project(wide.view(), options);
                         });
  }
  require_as_recorded("projection_policy", results);
}

TEST_CASE("Projections at a target size and of mip chains are the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 128, 3, 13);
  const TestCubemap odd = make_cubemap(Content::special_values, 99, 4, 14);
  const TestLatLong wide = make_lat_long(Content::high_range, 300, 151, 15);
  const Cubemap mips = build_mips(cube.view());
  const std::vector<CubemapView> levels = mips.views();
  std::vector<NamedResult> results;
  for (const auto& [quadrature_name, quadrature] : kQuadratures) {
    for (const int target : {1, 16, 20, 200}) {
      const ProjectionOptions options{
          .quadrature = quadrature, .target_size = target, .pixels = {.clamp = RadianceClamp{}}};
      const std::string end = joined("_to_", target, '_', quadrature_name);
      for (const auto& [kind, view] : {std::pair{"cubemap", cube.view()}, {"odd_cubemap", odd.view()}}) {
        results.emplace_back(kind + end, [view = view, options] { return project(view, options); });
      }
      results.emplace_back("lat_long" + end, [&wide, options] { return project(wide.view(), options); });
      results.emplace_back("mips" + end, [&levels, options] { return project(std::span(levels), options); });
    }
  }
  require_as_recorded("projection_target", results);
}

TEST_CASE("Projections of rows that are padded or bottom-up are the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::sun_disc, 40, 3, 16);
  const TestLatLong wide = make_lat_long(Content::sun_disc, 80, 40, 17);
  CubemapView part = cube.view();  // of each face the upper left 31 x 31
  part.size = 31;
  part.row_stride_bytes = 40 * 12;
  CubemapView rotated = cube.view();
  for (const void*& face : rotated.faces) face = static_cast<const float*>(face) + 39 * 40 * 3;
  rotated.row_stride_bytes = -40 * 12;
  LatLongView bottom_up = wide.view();
  bottom_up.pixels = wide.pixels.data() + 39 * 80 * 3;
  bottom_up.row_stride_bytes = -80 * 12;
  LatLongView narrow = wide.view();
  narrow.width = 71;
  narrow.row_stride_bytes = 80 * 12;
  require_as_recorded("projection_rows", {
                                             {"cubemap_padded", [&] { return project(part); }},
                                             {"cubemap_bottom_up", [&] { return project(rotated); }},
                                             {"lat_long_padded", [&] { return project(narrow); }},
                                             {"lat_long_bottom_up", [&] { return project(bottom_up); }},
                                         });
}

TEST_CASE("Projections face by face are the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 65, 4, 18);
  const TestCubemap other = make_cubemap(Content::special_values, 65, 4, 19);
  CubemapView mixed = cube.view();
  mixed.faces[1] = other.view().faces[1];
  mixed.faces[4] = other.view().faces[4];
  const ProjectionOptions options{.bands = 5, .pixels = {.clamp = RadianceClamp{}}};
  require_as_recorded("face_harmonics",
                      {
                          {"total", [&] { return combine(project_faces(cube.view(), options)); }},
                          {"total_after_update",
                           [&] {
                             FaceHarmonics kept = project_faces(cube.view(), options);
                             update_faces(kept, mixed, std::array{4, 1});
                             return combine(kept);
                           }},
                          {"total_at_target", [&] { return combine(project_faces(cube.view(), {.target_size = 16})); }},
                      });
  CHECK(bits_of(combine(project_faces(mixed, options))) == bits_of(project(mixed, options)));
}

}  // namespace welkin::test
