// Prints hashes of the results of welkin::core: `core_hashes`. The record, core_hashes.txt, is from a build on x86-64;
// every other processor, system, compiler and number of threads must print the same lines.
#include <memory>
#include <vector>

#include "portability/hashing.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::portability {
namespace {

void projections() {
  for (const int size : kSizes) {
    const Cubemap cube = cubemap(size, 1);
    const LatLongImage wide = lat_long(size, 2);
    for (const int bands : {3, 9}) {
      const std::string ending = "_bands_" + std::to_string(bands);
      print(sized("project/cubemap", size) + ending, project(cube.view(), {.bands = bands}).radiance);
      print(sized("project/midpoint", size) + ending,
            project(cube.view(), {.bands = bands, .quadrature = Quadrature::midpoint}).radiance);
      print(sized("project/lat_long", size) + ending, project(wide.view(), {.bands = bands}).radiance);
    }
    const ProjectionOptions babylon{.target_size = 16, .pixels = {.clamp = RadianceClamp{0.75F}, .gamma = true}};
    print(sized("project/gamma_and_clamp", size), project(cube.view(), babylon).radiance);
  }
  for (const PixelFormat format : {PixelFormat::rgb16f, PixelFormat::rgba16f, PixelFormat::rgb8, PixelFormat::rgba8,
                                   PixelFormat::srgb8, PixelFormat::srgba8}) {
    for (const int size : {7, 64}) {
      const std::vector<std::uint8_t> bytes = texel_bytes(size, format, 3);
      print(sized("project/format", static_cast<int>(format)) + "_" + std::to_string(size),
            project(faces_of(bytes, size, format)).radiance);
    }
  }
}

void harmonics() {
  const SphericalHarmonics light = project(cubemap(64, 4).view(), {.bands = 6}).radiance;
  print("harmonics/turned", rotate(light, Quaternion{0.3, -0.2, 0.9, 0.1}));
  print("harmonics/product", product(light, light));
  print("harmonics/window", apply_window(light, Window::min_laplacian).radiance);
  for (const Engine engine : {Engine::babylon, Engine::three, Engine::unity, Engine::unreal, Engine::filament}) {
    const EngineLight form = engine_light(light, engine);
    SphericalHarmonics terms(3);
    for (std::size_t k = 0; k < form.terms.size() && k < 9; ++k) terms.coefficients()[k] = form.terms[k].rgb;
    print(std::string("harmonics/") + convention(engine).name, terms);
  }
  print("harmonics/irradiance_cubemap", irradiance_cubemap(irradiance_from_radiance(light), 17).pixels());
  LatLongImage sunny = lat_long(64, 5);
  for (int c = 0; c < 3; ++c) sunny.pixels[static_cast<std::size_t>(3 * (20 * 128 + 30) + c)] = 60000.0F;
  const auto sun = extract_sun(sunny);
  print("harmonics/sun", sun ? sun->direction : dvec3(0.0), sun ? sun->irradiance : dvec3(0.0), sunny.pixels);
}

void resampling() {
  for (const int size : kSizes) {
    print(sized("resample/to_cubemap", size), to_cubemap(lat_long(size, 6).view(), size).pixels());
    print(sized("resample/mips", size), build_mips(cubemap(size, 7).view()));
  }
  print("resample/turned", to_cubemap(cubemap(31, 8).view(), 16, rotation_about_y(33.0)).pixels());
  print("resample/to_lat_long", to_lat_long(cubemap(31, 9).view(), 40, 20).pixels);
}

void reflections() {
  for (const int size : kSizes) {
    print(sized("prefilter/cubemap", size), prefilter_specular(cubemap(size, 10).view(), {.size = size}).cubemap);
    print(sized("prefilter/lat_long", size), prefilter_specular(lat_long(size, 11).view(), {.size = size}).cubemap);
  }
  const Cubemap cube = cubemap(32, 12);
  print("prefilter/spectral",
        prefilter_specular(cube.view(), {.size = 32, .method = PrefilterMethod::spectral}).cubemap);
  // Light so faint that factors of it are denormal numbers, which not every processor can flush to zero.
  for (const int decades : {20, 27, 34, 40}) {
    float scale = 1.0F;
    for (int k = 0; k < decades; ++k) scale *= 0.1F;
    const std::string ending = "_times_1e-" + std::to_string(decades);
    print("prefilter/cubemap" + ending, prefilter_specular(cubemap(64, 13, scale).view(), {.size = 32}).cubemap);
    print("prefilter/lat_long" + ending, prefilter_specular(lat_long(64, 13, scale).view(), {.size = 32}).cubemap);
    print("project/cubemap" + ending, project(cubemap(64, 13, scale).view()).radiance);
  }
  for (const BrdfModel model : {BrdfModel::split_sum, BrdfModel::multiple_scattering}) {
    print(sized("brdf/model", static_cast<int>(model)), brdf_table({33, 17, model})->values);
  }
}

void skies() {
  const SkyTableOptions options{.heights = 5,
                                .view_zeniths = 16,
                                .sun_zeniths = 16,
                                .sun_angles = 4,
                                .transmittance_heights = 16,
                                .transmittance_zeniths = 64,
                                .irradiance_heights = 4,
                                .irradiance_sun_zeniths = 16,
                                .orders = 3};
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), options));
  print("sky/tables", tables->transmittance, tables->scattering, tables->single_mie, tables->irradiance);
  const SkyView view(tables, 200.0);
  for (const double elevation : {60.0, 2.0, -5.0}) {
    const dvec3 sun = sun_direction(elevation, 120.0);
    const std::string ending = "_" + std::to_string(static_cast<int>(elevation));
    print("sky/cubemap" + ending, sky_cubemap(view, sun, 33, {.sun_disc = true}).pixels());
    print("sky/harmonics" + ending, SkyProjector(view).project(sun), view.irradiance(sun),
          view.sun_light(sun).irradiance);
  }
  const SkyCurve curve(view, {.nodes = 32});
  print("sky/curve", curve.at(sun_direction(10.0, 30.0)), curve.sun_irradiance(sun_direction(10.0, 30.0)));
}

}  // namespace
}  // namespace welkin::portability

int main() {
  welkin::run_with_threads(3, [] {  // where a build has threads
    welkin::portability::projections();
    welkin::portability::harmonics();
    welkin::portability::resampling();
    welkin::portability::reflections();
    welkin::portability::skies();
  });
}
