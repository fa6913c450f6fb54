// A program that takes pixels in memory to light, and is linked with welkin::core alone. A test looks at which
// libraries it needs. It calls into every room of core, so that a use of files in any of them could not hide.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "welkin/bake.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"
#include "welkin/worker.h"

namespace {

constexpr int kSize = 8;
constexpr double kPi = 3.14159265358979324;

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "core_program: %s\n", what);
  std::exit(1);
}

bool near(double value, double wanted) { return std::abs(value - wanted) < 1e-4 * std::abs(wanted); }

/// Everything is 2: the light of every direction, and each of its harmonics' sums, is known.
welkin::LatLongImage even_image() {
  return {2 * kSize, kSize, std::vector<float>(std::size_t{2} * kSize * kSize * 3, 2.0F)};
}

void pixels_to_light() {
  const welkin::LatLongImage image = even_image();
  const welkin::Cubemap faces = welkin::to_cubemap(image.view(), kSize);
  const welkin::SphericalHarmonics radiance = welkin::project(faces.view()).radiance;
  const welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(radiance);
  const glm::dvec3 up(0.0, 1.0, 0.0);
  require(near(welkin::evaluate(irradiance, up).x, 2.0 * kPi), "the irradiance of an even sphere is not pi times it");
  require(near(welkin::direct_irradiance(faces.view(), {&up, 1}).front().y, 2.0 * kPi), "nor is the direct one");
  const welkin::Cubemap diffuse = welkin::irradiance_cubemap(irradiance, 4);
  require(diffuse.size() == 4, "the irradiance cubemap has another size");

  welkin::PrefilterOptions options{.size = kSize};
  const welkin::PrefilteredSpecular specular = welkin::prefilter_specular(faces.view(), options);
  require(near(specular.mips.back().mean.x, 2.0), "a prefiltered mip has another mean than its source");
  const auto brdf = welkin::brdf_table({16, 16});
  require(!brdf->values.empty(), "the BRDF table is empty");
}

void sky_to_light() {
  welkin::SkyTableOptions options{.heights = 4, .view_zeniths = 16, .sun_zeniths = 8, .sun_angles = 4, .orders = 2};
  const auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth(), options));
  const welkin::SkyView view(tables, 0.0);
  const glm::dvec3 sun = welkin::sun_direction(30.0, 0.0);
  require(view.radiance({0.0, 1.0, 0.0}, sun).z > 0.0, "the sky overhead is black");
  require(welkin::SkyProjector(view).project(sun).coefficients().front().z > 0.0, "the sky has no light");
}

void plan_and_worker() {
  const welkin::LatLongImage image = even_image();
  welkin::BakeOptions whole;
  whole.specular->size = kSize;
  whole.irradiance->size = 4;
  const welkin::Plan plan = welkin::plan(image.view(), {.background = false, .brdf_table = false}, whole);
  require(!plan.passes.empty(), "the plan has no passes");
  require(near(welkin::bake(image.view(), plan).radiance->coefficients().front().x, 2.0 * std::sqrt(4.0 * kPi)),
          "the planned bake has other light");
  welkin::Worker worker;
  auto job = worker.post(welkin::Project{even_image()});
  require(near(job.get().radiance.coefficients().front().x, 2.0 * std::sqrt(4.0 * kPi)), "the worker's light differs");
}

void c_interface() {
  const welkin::LatLongImage image = even_image();
  welkin_environment view;
  WELKIN_INIT(view);
  view.format = WELKIN_FORMAT_RGB_F32;
  view.faces[0] = image.pixels.data();
  view.width = image.width;
  view.height = image.height;
  welkin_projection projection;
  WELKIN_INIT(projection);
  require(welkin_project(&view, 1, nullptr, nullptr, &projection) == WELKIN_OK, welkin_last_error());
  require(near(projection.coefficients[0], 2.0 * std::sqrt(4.0 * kPi)), "the C interface's light differs");
}

/// An error crosses the library's boundary, and is known on this side.
void errors() {
  try {
    (void)welkin::project(welkin::CubemapView{});
  } catch (const welkin::Error& error) {
    require(error.code() == welkin::ErrorCode::invalid_argument, "an empty view is another error");
    return;
  }
  require(false, "an empty view is no error");
}

}  // namespace

int main() {
  pixels_to_light();
  sky_to_light();
  plan_and_worker();
  c_interface();
  errors();
  std::puts("welkin::core gives its light");
}
