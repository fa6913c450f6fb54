// Contracts of all calls: the directions that they take, and the `Control` of work that takes long.
#include "image/sphere_grid.h"
#include "math/basis.h"
#include "reflections/brdf_table.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/importance.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: a direction may have any finite length but 0, which changes the result by no more than rounding. One that is
// zero or not finite is refused.

namespace {

/// A call that takes a direction, with its result as numbers.
struct Taking {
  const char* name;
  std::function<std::vector<double>(const dvec3&)> call;
};

std::vector<double> numbers(const dvec3& value) { return {value.x, value.y, value.z}; }

SphericalHarmonics made_up() {
  SphericalHarmonics light(4);
  for (std::size_t k = 0; k < light.coefficients().size(); ++k) {
    light.coefficients()[k] = dvec3(std::sin(1.0 + 3.7 * static_cast<double>(k)), 0.1, 0.2 * static_cast<double>(k));
  }
  return light;
}

BakedProbes lit_probe() {
  BakedProbes probes;
  probes.bands = 3;
  const SphericalHarmonics light = resized(made_up(), 3);
  probes.coefficients.assign(light.coefficients().begin(), light.coefficients().end());
  probes.coefficients[0] = dvec3(20.0);
  probes.validity = {1.0F};
  probes.passes = {0};
  return probes;
}

std::vector<Taking> calls_about_light() {
  return {
      {"evaluate", [](const dvec3& d) { return numbers(evaluate(made_up(), d)); }},
      {"evaluate_basis",
       [](const dvec3& d) {
         std::vector<double> values(25);
         evaluate_basis(d, 5, values);
         return values;
       }},
      {"evaluate of Babylon.js's polynomial",
       [](const dvec3& d) { return numbers(evaluate(babylon_polynomial(made_up()), d)); }},
      {"sun_harmonics",
       [](const dvec3& d) {
         return numbers(sun_harmonics({.direction = d, .irradiance = dvec3(1, 2, 3)}, 3).coefficients()[7]);
       }},
      {"octahedral_encode",
       [](const dvec3& d) {
         const std::array<double, 2> position = octahedral_encode(d);
         return std::vector<double>{position[0], position[1]};
       }},
      {"probe_irradiance", [](const dvec3& d) { return numbers(probe_irradiance(lit_probe(), {}, d)); }},
  };
}

std::vector<Taking> calls_about_images() {
  const auto image = std::make_shared<LatLongImage>(grey_lat_long(16, 8, 1.0F));
  image->pixels[100] = 30.0F;
  const LatLongView view = image->view();
  const auto table = std::make_shared<ImportanceTable>(importance_table(view));
  return {
      {"direct_irradiance", [=](const dvec3& d) { return numbers(direct_irradiance(image->view(), d)); }},
      {"reference_specular", [=](const dvec3& d) { return numbers(reference_specular(image->view(), 0.5, {d})[0]); }},
      {"reference_by_lobe",
       [=](const dvec3& d) { return numbers(reference_by_lobe(image->view(), ZonalLobe::lambert(), {d})[0]); }},
      {"ImportanceTable::density", [=](const dvec3& d) { return std::vector<double>{table->density(d)}; }},
  };
}

std::vector<Taking> calls_about_skies() {
  const auto view = std::make_shared<SkyView>(small_earth(), 0.0);
  const auto curve = std::make_shared<SkyCurve>(*view, SkyCurveOptions{.nodes = 8});
  const dvec3 sun = sun_direction(30.0, 10.0);
  return {
      {"SkyView::radiance", [=](const dvec3& d) { return numbers(view->radiance(d, sun)); }},
      {"SkyView::radiance, the sun",
       [=](const dvec3& d) {
         return numbers(view->radiance({0, 1, 0}, d));
       }},
      {"SkyView::sun", [=](const dvec3& d) { return numbers(view->sun_light(d).irradiance); }},
      {"SkyView::irradiance", [=](const dvec3& d) { return numbers(view->irradiance(d)); }},
      {"SkyCurve::at", [=](const dvec3& d) { return numbers(curve->at(d).at(1, 1)); }},
      {"SkyCurve::sun_irradiance", [=](const dvec3& d) { return numbers(curve->sun_irradiance(d)); }},
  };
}

void check(const Taking& taking) {
  const std::string name = taking.name;
  const dvec3 unit = glm::normalize(dvec3(0.48, 0.6, 0.64));
  const std::vector<double> wanted = taking.call(unit);
  for (const double length : {2.0, 0.3, 1.0 + 1e-6, 1e-12, 1e200, 1e-200}) {
    CAPTURE(name, length);
    const std::vector<double> found = taking.call(length * unit);
    for (std::size_t k = 0; k < wanted.size(); ++k) CHECK(found[k] == Approx(wanted[k]).epsilon(1e-6).margin(1e-12));
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<dvec3> refused = {{0, 0, 0},       {nan, 1, 1}, {1, nan, 1},      {1, 1, nan},
                                      {nan, nan, nan}, {0, nan, 0}, {infinity, 1, 1}, {1, 1, -infinity}};
  for (const dvec3& direction : refused) {
    CAPTURE(name, direction.x, direction.y, direction.z);
    const ThrownError error = thrown_by([&] { static_cast<void>(taking.call(direction)); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("it must be finite and not zero, of any length"));
  }
}

}  // namespace

TEST_CASE("directions of any length are normalised, those without one are refused", "[directions]") {
  for (const Taking& taking : calls_about_light()) check(taking);
  for (const Taking& taking : calls_about_images()) check(taking);
  for (const Taking& taking : calls_about_skies()) check(taking);
}

TEST_CASE("directions of unit length are taken as they are, bit by bit", "[directions]") {
  std::vector<double> found(25);
  std::vector<double> wanted(25);
  for (int k = 0; k < 1000; ++k) {
    const dvec3 d = glm::normalize(dvec3(std::sin(1.0 + k), std::sin(2.0 + 3.0 * k), std::sin(3.0 + 7.0 * k)));
    evaluate_basis(d, 5, found);
    math::evaluate_basis(d.x, d.y, d.z, 5, wanted.data());
    CHECK(same_bytes<double>(found, wanted));
  }
}

TEST_CASE("directions that are refused are numbered among many", "[directions]") {
  const LatLongImage image = grey_lat_long(4, 2, 1.0F);
  const std::vector<dvec3> normals = {{0, 1, 0}, {3, 0, 0}, {0, 0, 0}};
  CHECK(thrown_by([&] { static_cast<void>(direct_irradiance(image.view(), normals)); }).says("normal 2 is (0, 0, 0)"));
  CHECK(thrown_by([&] {
          static_cast<void>(reference_specular(image.view(), 0.5, normals));
        }).says("direction 2 is (0, 0, 0)"));
}

// Promises: a call ends when it is cancelled, reports its progress by numbers that rise to 1, one at a time, and
// allocates nothing inside tiles.

namespace {

struct Work {
  const char* name;
  std::function<void(const Control&)> run;
  std::vector<double> moments{};  ///< shares of the work at which it is cancelled, in addition to 0
  int reports = 1;                ///< minimum number of reports
};

const std::vector<double> kLate{0.02, 0.3, 0.6, 0.9};

std::vector<Work> resampling() {
  const auto wide = std::make_shared<TestLatLong>(make_lat_long(Content::high_range, 333, 301, 4));
  const auto cube = std::make_shared<TestCubemap>(make_cubemap(Content::high_range, 300, 3, 4));
  const auto to_cube = [wide](const glm::dmat3& rotation, ResampleFilter filter) {
    return [=](const Control& control) { static_cast<void>(to_cubemap(wide->view(), 130, rotation, filter, control)); };
  };
  const auto to_wide = [](int size) {
    return [grey = grey_cubemap(size, 0.1F), size](const Control& control) {
      static_cast<void>(to_lat_long(grey.view(), 4 * size, 2 * size, glm::dmat3(1.0), ResampleFilter::area, control));
    };
  };
  const auto mips = [cube](MipFilter filter, std::optional<int> levels) {
    return [=](const Control& control) { static_cast<void>(build_mips(cube->view(), filter, levels, control)); };
  };
  return {{"to_cubemap by area", to_cube(glm::dmat3(1.0), ResampleFilter::area)},
          {"to_cubemap by area, turned", to_cube(rotation_about_y(90.0), ResampleFilter::area)},
          {"to_cubemap, bilinear", to_cube(glm::dmat3(1.0), ResampleFilter::bilinear)},
          {"to_lat_long by area, from 1", to_wide(1)},
          {"to_lat_long by area, from 7", to_wide(7)},
          {"to_lat_long by area, from 64", to_wide(64)},
          {"build_mips, box", mips(MipFilter::box, std::nullopt)},
          {"build_mips, solid angle", mips(MipFilter::solid_angle, std::nullopt)},
          {"build_mips, one level", mips(MipFilter::box, 1)},
          {"irradiance_cubemap", [harmonics = RandomLight(50).harmonics(5)](const Control& control) {
             static_cast<void>(irradiance_cubemap(harmonics, 67, control));
           }}};
}

std::vector<Work> reflections_of_images() {
  const auto prefilter = [](auto image, const PrefilterOptions& options) {
    return [image = std::make_shared<decltype(image)>(std::move(image)), options](const Control& control) {
      static_cast<void>(prefilter_specular(image->view(), options, control));
    };
  };
  const PrefilterOptions integrals{.size = 4, .method = PrefilterMethod::reference};
  return {{"prefilter_specular", prefilter(make_lat_long(Content::random, 64, 32, 3), {.size = 4}), kLate},
          {"prefilter_specular by integrals", prefilter(make_lat_long(Content::random, 64, 32, 3), integrals), kLate},
          {"prefilter_specular of a lamp",
           prefilter(make_lat_long(Content::one_texel_sun, 256, 128, 3), {.size = 4, .roughness = {0.3, 0.7}})},
          {"prefilter_specular of a cubemap",
           prefilter(make_cubemap(Content::high_range, 32, 3, 3), {.size = 32, .roughness = {0.0, 0.2, 0.5, 1.0}})},
          {"integrated_brdf",
           [](const Control& control) {
             static_cast<void>(reflections::integrated_brdf({251, 127, BrdfModel::split_sum, true}, control));
           },
           {0.3},
           10}};
}

std::vector<Work> transforms_of_images() {
  using transforms::SourceRows, transforms::Spectrum;
  const auto analyse = [](int width, int height, int bands, SourceRows rows) {
    return [source = std::make_shared<TestLatLong>(make_lat_long(Content::random, width, height, 43)), bands,
            rows](const Control& control) {
      static_cast<void>(transforms::analyse(source->view(), bands, control, rows));
    };
  };
  const TestLatLong source = make_lat_long(Content::random, 512, 256, 43);
  const auto spectrum = std::make_shared<Spectrum>(transforms::analyse(source.view(), 100, {}));
  return {{"analyse", analyse(512, 256, 100, SourceRows::all), {0.1, 0.3, 0.7}, 10},
          {"analyse, a prime number of columns", analyse(509, 256, 120, SourceRows::all)},
          {"analyse, fewer rows", analyse(1024, 512, 60, SourceRows::fewer), {0.1}},
          {"synthesise",
           [spectrum](const Control& control) {
             image::SphereGrid grid(160, 320, image::GridContent::spline_coefficients);
             transforms::synthesise(*spectrum, std::vector<double>(100, 1.0), grid, control);
           },
           {0.1, 0.3, 0.7},
           10}};
}

std::vector<Work> skies() {
  const auto tables_of = [](const Atmosphere& air) {
    return [air](const Control& control) {
      SkyTableOptions options = tiny_tables();
      options.orders = 3;
      static_cast<void>(precompute_sky(air, options, control));
    };
  };
  const SkyView view = sky_view_of(earth_bruneton(), tiny_tables());
  const glm::dvec3 sun(0.0, 1.0, 0.0);
  return {{"precompute_sky", tables_of(earth_bruneton()), {0.01, 0.04, 0.2, 0.5, 0.9}, 50},
          {"precompute_sky, each wavelength with its own lobe", tables_of(mars())},
          {"SkyCurve", [view](const Control& control) { SkyCurve(view, {}, control); }},
          {"sky_cubemap", [=](const Control& control) { static_cast<void>(sky_cubemap(view, sun, 40, {}, control)); }},
          {"sky_lat_long",
           [=](const Control& control) { static_cast<void>(sky_lat_long(view, sun, 512, {}, control)); },
           {0.1}}};
}

/// Work whose tiles' heap use other tests check.
std::vector<Work> integrals() {
  const auto small = std::make_shared<TestCubemap>(make_cubemap(Content::random, 4, 3, 2));
  const auto large = std::make_shared<TestCubemap>(make_cubemap(Content::random, 256, 3, 1));
  const auto light = [large](const ProjectionOptions& options) {
    return [=](const Control& control) { static_cast<void>(project(large->view(), options, control)); };
  };
  return {{"project", light({})},
          {"project, of a smaller size", light({.quadrature = Quadrature::midpoint, .target_size = 128})},
          {"direct_irradiance",
           [small](const Control& control) {
             const glm::dvec3 up(0.0, 1.0, 0.0);
             static_cast<void>(direct_irradiance(small->view(), {&up, 1}, {}, control));
           }},
          {"direct_irradiance_cubemap", [small](const Control& control) {
             static_cast<void>(direct_irradiance_cubemap(small->view(), 4, control));
           }}};
}

void check_control(const Work& work) {
  for (std::size_t k = 0; k <= work.moments.size(); ++k) {
    const double moment = k == 0 ? 0.0 : work.moments[k - 1];
    stop_source stop;
    if (k == 0) stop.request_stop();
    const Control stopping{stop.get_token(), [&](double share) {
                             if (share >= moment) stop.request_stop();
                           }};
    CAPTURE(work.name, moment);
    CHECK(thrown_by([&] { work.run(stopping); }).code == ErrorCode::cancelled);
  }
  double last = 0.0;
  int reports = 0;
  bool fell = false;
  bool together = false;
  std::atomic<int> inside{0};
  work.run({{}, [&](double share) {
              together = together || inside.fetch_add(1) != 0;
              fell = fell || share < last;
              last = share;
              ++reports;
              inside.fetch_sub(1);
            }});
  CAPTURE(work.name, reports);
  CHECK(last == 1.0);
  CHECK(reports >= work.reports);
  CHECK_FALSE(fell);
  CHECK_FALSE(together);
}

/// `warm`: not on the first call, which builds tables.
void check_tiles(const Work& work, bool warm) {
  run_with_threads(3, [&] {
    if (warm) work.run({});
    forget_allocations_in_tiles();
    work.run({});
    CAPTURE(work.name);
    CHECK(allocations_in_tiles() == 0);
  });
}

}  // namespace

TEST_CASE("Work ends when it is asked to, and says how far it is by numbers that rise to 1", "[control][slow]") {
  for (const auto& list : {resampling(), reflections_of_images(), transforms_of_images(), skies(), integrals()}) {
    for (const Work& work : list) check_control(work);
  }
}

TEST_CASE("Tiles allocate nothing", "[control][heap][slow]") {
  for (const auto& list : {resampling(), reflections_of_images()}) {
    for (const Work& work : list) check_tiles(work, true);
  }
  for (const auto& list : {transforms_of_images(), skies()}) {
    for (const Work& work : list) check_tiles(work, false);
  }
}

}  // namespace welkin::test
