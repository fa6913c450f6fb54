// A host that calls a large part of the interface with GLM's vectors and prints the bits of the results. It is built
// twice, with GLM's macros and without. Both link the same library and must get the same numbers from it, so no type
// that they share with it may change with a macro.
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "welkin/welkin.hpp"

#if defined(GLM_FORCE_DEFAULT_ALIGNED_GENTYPES)
// Otherwise the macros have had no effect, and the test proves nothing.
static_assert(sizeof(glm::dvec3) != sizeof(welkin::dvec3) && sizeof(glm::dmat3) != sizeof(welkin::dmat3));
static_assert(sizeof(glm::vec3) != sizeof(welkin::vec3));
#endif
#if defined(GLM_FORCE_QUAT_DATA_WXYZ)
static_assert(offsetof(glm::dquat, w) == 0);
#endif

namespace {

void print(const char* what, double value) {
  std::printf("%s %016llx %.9g\n", what, static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(value)), value);
}

/// Results arrive in the host's vectors, whatever those are.
void print(const char* what, const glm::dvec3& value) {
  for (int i = 0; i < 3; ++i) print(what, static_cast<double>(value[i]));
}

void print(const char* what, const glm::dmat3& value) {
  for (int i = 0; i < 3; ++i) print(what, glm::dvec3(value[i]));
}

void print(const char* what, const welkin::SphericalHarmonics& harmonics) {
  print(what, static_cast<double>(harmonics.bands()));
  for (const glm::dvec3 coefficient : harmonics.coefficients()) print(what, coefficient);
}

void print(const char* what, std::span<const float> values) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    sum += static_cast<double>(values[i]) * static_cast<double>(i % 7 + 1);
  print(what, sum);
}

/// Prints several results.
template <class... Values>
requires(sizeof...(Values) > 1) void print(const char* what, const Values&... values) { (print(what, values), ...); }

void print(const char* what, const welkin::ProjectionDiagnostics& diagnostics) {
  print(what, static_cast<double>(diagnostics.texels), diagnostics.total_radiance_before_clamp,
        diagnostics.total_radiance, diagnostics.error_estimate, static_cast<double>(diagnostics.passes.size()));
}

void print(const char* what, const welkin::Sun& sun) {
  print(what, sun.direction, sun.irradiance, sun.radiance, sun.solid_angle, sun.angular_radius_degrees,
        static_cast<double>(sun.texels), sun.total_radiance_before, sun.total_radiance_after);
}

/// A grey panorama with a gradient and a small bright spot.
welkin::LatLongImage panorama() {
  welkin::LatLongImage image{64, 32, {}};
  for (int row = 0; row < 32; ++row) {
    for (int column = 0; column < 64; ++column) {
      const bool spot = row == 9 && column == 20;
      for (int c = 0; c < 3; ++c) {
        image.pixels.push_back(spot ? 20000.0F : 0.25F + 0.01F * static_cast<float>(32 - row + c * column));
      }
    }
  }
  return image;
}

void call_harmonics(const welkin::SphericalHarmonics& light) {
  // Written out, because the host's own arithmetic may be rounded differently under a macro.
  const glm::dvec3 direction(0.36, -0.48, 0.8);
  const glm::dquat quaternion(0.4, 0.2, -0.4, 0.8);
  const glm::dmat3 matrix(0.6, 0.0, 0.8, 0.0, 1.0, 0.0, 0.8, 0.0, -0.6);
  print("evaluate", glm::dvec3(welkin::evaluate(light, direction)));
  print("turned by a quaternion", welkin::rotate(light, quaternion));
  print("turned by a matrix", welkin::rotate(light, matrix));
  print("scale", welkin::scale(light, glm::dvec3(0.5, 1.0, 2.0)));
  print("mean", glm::dvec3(welkin::mean_radiance(light)));
  const welkin::HarmonicMinimum minimum = welkin::minimum(light);
  print("minimum", glm::dvec3(minimum.value));
  for (const glm::dvec3 position : minimum.direction) print("minimum at", position);
  const welkin::WindowResult windowed = welkin::apply_window(light, welkin::Window::min_laplacian);
  print("window", windowed.radiance, windowed.parameter, glm::dvec3(windowed.minimum_before),
        glm::dvec3(windowed.minimum_after), static_cast<double>(windowed.factors.size()));
  if (const auto dominant = welkin::dominant_light(light)) {
    print("dominant light", glm::dvec3(dominant->direction), glm::dvec3(dominant->irradiance));
  }
  for (const welkin::Convention& convention : welkin::conventions()) {
    print(convention.name, glm::dmat3(convention.from_welkin));
    if (convention.faces_from_engine) print(convention.name, glm::dmat3(*convention.faces_from_engine));
  }
  const welkin::EngineLight unity = welkin::engine_light(light, welkin::Engine::unity);
  for (const welkin::EngineTerm& term : unity.terms) print(term.name.c_str(), glm::dvec3(term.rgb));
  for (const welkin::EngineVector& vector : unity.vectors) {
    const glm::dvec4 value = vector.value;
    for (int i = 0; i < 4; ++i) print(vector.name.c_str(), static_cast<double>(value[i]));
  }
  const welkin::BabylonPolynomial polynomial = welkin::babylon_polynomial(light);
  print("polynomial", glm::dvec3(polynomial.xy), glm::dvec3(welkin::evaluate(polynomial, direction)));
}

void call_images(const welkin::LatLongImage& image, const std::string& folder) {
  const glm::dmat3 rotation = welkin::rotation_about_y(35.0);
  const welkin::Cubemap cubemap = welkin::to_cubemap(image.view(), 16, rotation);
  print("to_cubemap", std::span<const float>(cubemap.pixels()));
  const std::vector<welkin::dvec3> normals{glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.6, 0.0, 0.8)};
  for (const glm::dvec3 value : welkin::direct_irradiance(cubemap.view(), normals)) print("direct irradiance", value);
  print("direct irradiance", glm::dvec3(welkin::direct_irradiance(image.view(), glm::dvec3(0.0, 0.0, 1.0))));
  const welkin::Projection light = welkin::project(cubemap.view(), {.bands = 2});
  for (const welkin::IrradianceError& error : welkin::irradiance_errors(cubemap.view(), light.radiance, 20)) {
    print("irradiance error", error.maximum, glm::dvec3(error.worst_normal));
  }
  const welkin::PrefilteredSpecular specular = welkin::prefilter_specular(cubemap.view(), {.size = 8});
  for (const welkin::MipRecord& mip : specular.mips) {
    print("mip", mip.roughness, mip.error_estimate.value_or(-1.0), glm::dvec3(mip.mean));
  }
  print("prefilter", specular.pixels);
  for (const glm::dvec3 value : welkin::reference_specular(image.view(), 0.5, normals)) print("specular", value);

  welkin::BakeOptions options;
  options.specular.reset();
  options.irradiance->size = 4;
  options.background->size = 8;
  welkin::BakeResult bake = welkin::bake(cubemap.view(), options);
  print("bake", *bake.radiance, std::span<const float>(bake.irradiance->pixels()));
  print("bake", bake.diagnostics);

  const std::filesystem::path file = std::filesystem::path(folder) / "image.pfm";
  welkin::write_environment(file, image.view());
  const welkin::EnvironmentStatistics statistics = welkin::measure_environment(file);
  print("file", glm::dvec3(statistics.minimum), glm::dvec3(statistics.maximum), glm::dvec3(statistics.total_radiance),
        static_cast<double>(statistics.brightest_row), glm::dvec3(statistics.brightest_direction));

  welkin::ResultCache cache;
  print("cache", cache.project(cubemap.view(), {}, {.exposure = 2.0, .rotation = rotation}).radiance);
  welkin::Worker worker;
  auto job = worker.post(welkin::ToCubemap{image, 4, rotation});
  print("job", job.get().pixels());
}

void call_sky() {
  const welkin::SkyTableOptions options{.heights = 4,
                                        .view_zeniths = 16,
                                        .sun_zeniths = 8,
                                        .sun_angles = 4,
                                        .transmittance_heights = 16,
                                        .transmittance_zeniths = 64,
                                        .irradiance_heights = 4,
                                        .irradiance_sun_zeniths = 16,
                                        .orders = 1};
  const auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth(), options));
  const glm::dvec3 sun = welkin::sun_direction(20.0, 145.0);
  print("sun", sun);
  const welkin::SkyView view(tables, 100.0);
  print("sky", glm::dvec3(view.radiance(glm::dvec3(0.0, 0.6, 0.8), sun)), glm::dvec3(view.irradiance(sun)));
  print("sky's sun", view.sun_light(sun));
  const std::vector<welkin::vec3> directions{glm::vec3(0.0F, 1.0F, 0.0F), glm::vec3(0.6F, 0.8F, 0.0F)};
  std::vector<welkin::vec3> radiances(directions.size());
  view.radiance(directions, sun, radiances);
  for (const glm::vec3 radiance : radiances) print("skies", glm::dvec3(radiance));
  const welkin::SkyProjector projector(view);
  std::vector<welkin::dvec3> coefficients(9);
  projector.project(sun, coefficients);
  for (const glm::dvec3 coefficient : coefficients) print("projector", coefficient);
  const welkin::SkyCurve curve(view, {.nodes = 16});
  print("curve", curve.at(sun), glm::dvec3(curve.sun_irradiance(sun)));
  print("sun's light", welkin::sun_harmonics(view.sun_light(sun), 3));

  welkin::SkyLightOptions light_options;
  light_options.curve.nodes = 16;
  light_options.specular.size = 4;
  light_options.blend_seconds = 0.0;
  welkin::Worker worker;
  welkin::SkyLight sky(worker, tables, light_options);
  sky.set_sun(glm::dvec3(sun));
  const auto settled = [&](double azimuth_degrees) {
    sky.set_sun(20.0, azimuth_degrees);
    for (int frame = 0; frame < 1000 && !sky.update(1.0).settled; ++frame) worker.wait_until_idle();
  };
  settled(145.0);
  settled(160.0);
  const welkin::SkyLightFrame& frame = sky.light();
  print("frame", static_cast<double>(frame.settled), frame.radiance, glm::dmat3(frame.reflections[0].rotation),
        frame.reflections[0].weight);
  print("frame", frame.sun);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return EXIT_FAILURE;
  }
  std::filesystem::create_directories(argv[1]);
  welkin::LatLongImage image = panorama();
  if (const auto sun = welkin::extract_sun(image)) print("sun of a panorama", *sun);
  const welkin::Projection light = welkin::project(image.view(), {.bands = 4});
  print("projection", light.radiance);
  print("projection", light.diagnostics);
  call_harmonics(light.radiance);
  call_images(image, argv[1]);
  call_sky();
  return EXIT_SUCCESS;
}
