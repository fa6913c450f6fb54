// Images: resampled, projected, convolved, and tables of roughness.
#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "calls.h"
#include "images.h"
#include "welkin/image.h"
#include "welkin/importance.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

void call_image(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  const glm::dmat3 rotation = rotation_about_y(21.0);
  calls.call("to_cubemap(EnvironmentView", [&] { return to_cubemap(cube.view(), 7, rotation); });
  calls.call("to_cubemap(EnvironmentView", [&] { return to_cubemap(wide.view(), 9); });
  calls.call("to_cubemap(EnvironmentView",
             [&] { return to_cubemap(wide.view(), 9, rotation, ResampleFilter::bilinear); });
  calls.call("to_lat_long(EnvironmentView", [&] { return to_lat_long(cube.view(), 18, 9, rotation); });
  calls.call("to_lat_long(EnvironmentView",
             [&] { return to_lat_long(cube.view(), 18, 9, glm::dmat3(1.0), ResampleFilter::area); });
  calls.call("to_lat_long(EnvironmentView", [&] { return to_lat_long(wide.view(), 18, 9, rotation); });
  calls.call("build_mips(", [&] { return build_mips(cube.view()); });
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("exposure_of(EnvironmentView", [&] { return exposure_of(view); });
  }
  Cubemap chain = build_mips(cube.view(), MipFilter::box);
  calls.call("octahedral_encode(", [] {
    const auto position = octahedral_encode({0.1, -0.7, -0.3});
    return dvec3(position[0], position[1], 0.0);
  });
  calls.call("octahedral_decode(", [] { return octahedral_decode(0.91, -0.13); });
  const auto square = [](const OctahedralMap& map) { return map.levels.front(); };
  calls.call("to_octahedral(Cubemap", [&] { return square(to_octahedral(chain, {.size = 9})); });
  calls.call("to_octahedral(SphericalHarmonics",
             [&] { return square(to_octahedral(project(cube.view()).radiance, {.size = 9})); });
  calls.call("fill_mips(", [&] {
    fill_mips(chain, MipFilter::solid_angle);
    return std::cref(chain);
  });
  LatLongImage wide_without_sun = wide;
  calls.call("extract_sun(LatLongImage", [&] { return extract_sun(wide_without_sun); });
  Cubemap cube_without_sun = cube;
  calls.call("extract_sun(Cubemap", [&] { return extract_sun(cube_without_sun); });
}

void call_projection(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  ProjectionOptions options{.bands = 4, .target_size = 5};
  options.pixels.clamp = RadianceClamp{123.4F, true};
  const TestCubemap special = make_cubemap(Content::special_values, 9, 3, 5);
  calls.call("project(EnvironmentView", [&] { return project(cube.view(), options); });
  calls.call("project(EnvironmentView", [&] { return project(special.view(), {.pixels = {.gamma = true}}); });
  calls.call("project(EnvironmentView", [&] {
    return project(cube.view(), {}, {{}, [](double) {
                                       if (current_environment() == FloatEnvironment{}) return;
                                       throw std::runtime_error("progress is told in the caller's environment");
                                     }});
  });
  const TestLatLongHalf half = make_lat_long_half(Content::special_values, 33, 17, 73, 4);
  calls.call("project(EnvironmentView", [&] { return project(wide.view(), options); });
  calls.call("project(EnvironmentView", [&] { return project(half.view(), {.quadrature = Quadrature::midpoint}); });
  calls.refused("project(EnvironmentView", [&] { static_cast<void>(project(wide.view(), {.bands = 0})); });
  const Cubemap mips = build_mips(cube.view());
  const std::vector<CubemapView> views = mips.views();
  calls.call("project(span<CubemapView", [&] { return project(views, options); });

  const std::vector<CubemapView> probes{cube.view(), special.view(), mips.view(1)};
  std::vector<dvec3> light(16 * probes.size());
  calls.call("project_many(", [&] {
    static_cast<void>(project_many(probes, light, options));
    return light;
  });

  FaceHarmonics kept = project_faces(cube.view(), {});
  calls.call("project_faces(", [&] { return combine(project_faces(cube.view(), {})); });
  const std::array<int, 2> faces{1, 4};
  calls.call("update_faces(", [&] {
    update_faces(kept, cube.view(), faces);
    return combine(kept);
  });
  calls.call("combine(FaceHarmonics", [&] { return combine(kept); });
}

void call_probes(Calls& calls, const Cubemap& cube) {
  const ProbeGrid grid{.counts = {2, 2, 1}, .origin = {0.1, 0.2, 0.3}, .spacing = {1.1, 0.7, 0.9}};
  std::vector<float> distances(6 * 9);
  for (std::size_t k = 0; k < distances.size(); ++k) distances[k] = 0.3F + 0.1F * static_cast<float>(k % 7);
  std::vector<float> backs(distances.size(), -0.7F);
  distances[5] = std::numeric_limits<float>::infinity();
  const auto view = [](const std::vector<float>& depths) {
    DepthView one{{}, 3, 0};
    for (std::size_t face = 0; face < 6; ++face) one.faces[face] = depths.data() + 9 * face;
    return one;
  };
  const std::vector<CubemapView> cubes(4, cube.view());
  const std::vector<DepthView> depths{view(distances), view(backs), view(distances), view(distances)};
  const ProbeOptions options{.distance_size = 3, .environment_bands = 2};
  BakedProbes probes = calls.call("bake_probes(", [&] { return bake_probes(grid, cubes, depths, options); });
  const std::vector<std::size_t> changed{2};
  const auto change = [&](const char* name, const auto& work) {
    calls.call(name, [&] {
      BakedProbes copy = probes;
      work(copy);
      return copy;
    });
  };
  change("update_probes(", [&](BakedProbes& copy) {
    update_probes(copy, changed, std::span(cubes).first(1), std::span(depths).first(1), options);
  });
  change("dilate(", [](BakedProbes& copy) { dilate(copy, 2); });
  calls.call("windowed(", [&] { return windowed(probes, Window::min_laplacian); });
  change("relight(", [&](BakedProbes& copy) { relight(copy, project(cube.view()).radiance, SphericalHarmonics(1)); });
  calls.call("probe_irradiance(", [&] { return probe_irradiance(probes, {0.3, 0.3, 0.3}, {0.0, 0.6, 0.8}); });
  calls.call("pack_probes(", [&] { return pack_probes(probes, ProbeLayout::unity_l2); });
  calls.call("pack_probes(", [&] { return pack_probes(probes, ProbeLayout::rtxgi); });
  calls.call("relocate_probes(", [&] { return relocate_probes(grid, depths, {.farthest = 0.5}); });
}

void call_importance(Calls& calls, const LatLongImage& wide) {
  const ImportanceOptions options{.width = 7, .height = 5, .mis_compensation = true};
  ImportanceTable table = importance_table(wide.view(), options);
  const auto sums = [&] {
    std::vector<float> all = table.function;
    all.insert(all.end(), table.row_cdf.begin(), table.row_cdf.end());
    all.insert(all.end(), table.column_cdf.begin(), table.column_cdf.end());
    return all;
  };
  calls.call("importance_table(LatLongView const&, ImportanceOptions", [&] {
    table = importance_table(wide.view(), options);
    return sums();
  });
  calls.call("importance_table(LatLongView const&, ImportanceTargets", [&] {
    table.integral = importance_table(wide.view(), {table.function, table.row_cdf, table.column_cdf}, options);
    return sums();
  });
  calls.call("ImportanceTable::sample(", [&] { return table.sample(0.37, 0.61).direction; });
  calls.call("ImportanceTable::density(", [&] { return table.density({0.36, -0.48, 0.8}); });
  calls.call("alias_table(", [&] {
    std::vector<float> all;
    for (const AliasEntry& entry : alias_table(table).columns) all.push_back(entry.own);
    return all;
  });
  calls.call("importance_pyramid(", [&] { return importance_pyramid(table).levels[1].probabilities; });
  const ImportanceTable whole = importance_table(wide.view(), {.width = 7, .height = 5});
  calls.call("importance_variance(", [&] { return importance_variance(wide.view(), whole).table; });
}

void call_irradiance(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  const std::vector<glm::dvec3> normals{{0.36, -0.48, 0.8}, {0.0, 1.0, 0.0}};
  const SphericalHarmonics radiance = project(cube.view()).radiance;
  calls.call("irradiance_cubemap(", [&] { return irradiance_cubemap(irradiance_from_radiance(radiance), 3); });
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("direct_irradiance(EnvironmentView const&, span", [&] { return direct_irradiance(view, normals); });
    calls.call("direct_irradiance(EnvironmentView const&, dvec3", [&] { return direct_irradiance(view, normals[0]); });
    calls.call("irradiance_errors(EnvironmentView", [&] { return irradiance_errors(view, radiance, 8); });
    calls.call("direct_irradiance_cubemap(EnvironmentView", [&] { return direct_irradiance_cubemap(view, 2); });
  }
}

void call_kernels(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  const std::vector<dvec3> directions{{0.1, 0.7, -0.3}};
  calls.call("ZonalLobe::charlie(", [] { return ZonalLobe::charlie(0.4).spectrum(40); });
  calls.call("ZonalLobe::lambert(", [] { return ZonalLobe::lambert().spectrum(9); });
  calls.call("ZonalLobe::phong(", [] { return ZonalLobe::phong(17.0).spectrum(40); });
  calls.call("ZonalLobe::blinn(", [] { return ZonalLobe::blinn(17.0).value(0.4); });
  calls.call("ZonalLobe::from_function(",
             [] { return ZonalLobe::from_function([](double c) { return c > 0.0 ? c : 0.0; }).spectrum(9); });
  calls.call("ZonalLobe::from_spectrum(", [] { return ZonalLobe::from_spectrum({3.0, 0.7}).spectrum(3); });
  const ZonalLobe sheen = ZonalLobe::charlie(0.7);
  calls.call("ZonalLobe::value(", [&] { return sheen.value(0.21); });
  calls.call("ZonalLobe::spectrum(", [&] { return sheen.spectrum(17); });
  const LobeChainOptions options{.size = 8, .lobes = {sheen, ZonalLobe::lambert()}};
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("prefilter_by_lobes(EnvironmentView", [&] { return prefilter_by_lobes(view, options); });
    calls.call("reference_by_lobe(EnvironmentView", [&] { return reference_by_lobe(view, sheen, directions); });
    calls.call("reference_specular(EnvironmentView", [&] { return reference_specular(view, 0.5, directions); });
  }
}

void call_reflections(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  for (const RoughnessSchedule schedule :
       {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon, RoughnessSchedule::unity,
        RoughnessSchedule::unreal}) {
    calls.call("mip_roughness(", [&] { return mip_roughness(schedule, 6, 32); });
    calls.call("fitted_mip_roughness(", [&] { return fitted_mip_roughness(schedule, 6, 32); });
    calls.call("PrefilterOptions::use_schedule(", [&] {
      PrefilterOptions options{.size = 32, .mips = 6};
      options.use_schedule(schedule, true);
      return options.lobe_roughness;
    });
  }
  const std::vector<double> table = mip_roughness(RoughnessSchedule::filament, 6, 32);
  calls.call("mip_for_roughness(", [&] { return mip_for_roughness(table, 0.37); });

  const PrefilterOptions spectral{.size = 8, .roughness = {0.0, 0.3, 0.9}, .method = PrefilterMethod::spectral};
  PrefilterOptions reference = spectral;
  reference.method = PrefilterMethod::reference;
  reference.size = 2;
  reference.roughness = {0.4, 0.9};
  calls.call("prefilter_specular(EnvironmentView", [&] { return prefilter_specular(wide.view(), spectral); });
  calls.call("prefilter_specular(EnvironmentView", [&] { return prefilter_specular(wide.view(), reference); });
  calls.call("prefilter_specular(EnvironmentView", [&] { return prefilter_specular(cube.view(), spectral); });
  call_kernels(calls, wide, cube);

  const BrdfTableOptions small{.width = 5, .height = 4};
  const auto brdf = calls.call("brdf_table(", [&] { return brdf_table(small); });
}

void call_upload(Calls& calls, const Cubemap& cube) {
  const Cubemap mips = build_mips(cube.view());
  for (const TexelFormat format : {TexelFormat::rgba16f, TexelFormat::b10g11r11, TexelFormat::e5b9g9r9}) {
    const UploadLayout layout{.format = format, .size = mips.size(), .levels = mips.levels()};
    std::vector<std::byte> memory(upload_bytes(layout));
    const std::vector<CubemapTarget> targets = upload_targets(layout, memory);
    const auto bytes = [&] {
      std::vector<char> all(memory.size());
      std::memcpy(all.data(), memory.data(), memory.size());
      return all;
    };
    calls.call("store_texels(CubemapView", [&] {
      store_texels(mips.view(0), targets.front());
      return bytes();
    });
    calls.call("store_texels(Cubemap const", [&] {
      store_texels(mips, targets);
      return bytes();
    });
  }
}

void call_bc6h(Calls& calls, const Cubemap& cube) {
  const Cubemap mips = build_mips(cube.view());
  const Bc6hCubemap blocks = calls.call("encode_bc6h(", [&] { return encode_bc6h(mips.views()); });
  calls.call("decode_bc6h(", [&] { return decode_bc6h(blocks); });
  calls.call("bc6h_errors(", [&] { return bc6h_errors(blocks, mips.views()); });
}

}  // namespace

void call_images(Calls& calls) {
  const LatLongImage wide = small_lat_long();
  const Cubemap cube = small_cubemap();
  call_image(calls, wide, cube);
  call_image(calls, faint(wide), faint(cube));
  call_projection(calls, wide, cube);
  call_projection(calls, faint(wide), faint(cube));
  call_importance(calls, wide);
  call_probes(calls, cube);
  call_irradiance(calls, wide, cube);
  call_irradiance(calls, faint(wide), faint(cube));
  call_reflections(calls, wide, cube);
  call_upload(calls, cube);
  call_bc6h(calls, cube);
}

}  // namespace welkin::test
