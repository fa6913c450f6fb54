// What comes through the C interface is, bit for bit, what the C++ calls give.
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include "c_interface/c_views.h"
#include "support/catch.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/engine_light.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

bool same_triple(const double* values, const glm::dvec3& expected) {
  return same_bits(values[0], expected.x) && same_bits(values[1], expected.y) && same_bits(values[2], expected.z);
}

void require_same(const welkin_projection& light, const Projection& expected) {
  REQUIRE(light.bands == expected.radiance.bands());
  const auto coefficients = expected.radiance.coefficients();
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    INFO("coefficient " << i);
    REQUIRE(same_triple(light.coefficients + 3 * i, coefficients[i]));
  }
  for (std::size_t i = 3 * coefficients.size(); i < std::size(light.coefficients); ++i) {
    REQUIRE(light.coefficients[i] == 0.0);
  }
  const ProjectionDiagnostics& diagnostics = expected.diagnostics;
  REQUIRE(light.texels == diagnostics.texels);
  REQUIRE(light.nans_replaced == diagnostics.nans_replaced);
  REQUIRE(light.infinities_replaced == diagnostics.infinities_replaced);
  REQUIRE(light.negatives_replaced == diagnostics.negatives_replaced);
  REQUIRE(light.texels_clamped == diagnostics.texels_clamped);
  REQUIRE(same_triple(light.flux_before_clamp, diagnostics.flux_before_clamp));
  REQUIRE(same_triple(light.flux, diagnostics.flux));
  REQUIRE(same_bits(light.error_estimate, diagnostics.error_estimate));
}

/// Every option away from its default in one of them at least, in both languages.
struct Wanted {
  ProjectionOptions options;
  welkin_projection_options c_options;
};

std::vector<Wanted> all_wanted() {
  std::vector<Wanted> all(5, {{}, c_struct<welkin_projection_options>()});
  all[1].options = {.bands = 16, .clamp = RadianceClamp{100.0F, true}, .negative = NegativePolicy::replace};
  all[1].c_options.bands = 16;
  all[1].c_options.clamp_maximum = 100.0F;
  all[1].c_options.clamp_preserve_colour = 1;
  all[1].c_options.negative = WELKIN_NEGATIVE_REPLACE;
  all[2].options = {.quadrature = Quadrature::midpoint, .target_size = 8, .gamma = true};
  all[2].c_options.quadrature = WELKIN_QUADRATURE_MIDPOINT;
  all[2].c_options.target_size = 8;
  all[2].c_options.gamma = 1;
  all[3].options = {.bands = 1, .clamp = RadianceClamp{2.5F, false}};
  all[3].c_options.bands = 1;
  all[3].c_options.clamp_maximum = 2.5F;
  all[4].options = {.bands = 4, .target_size = 16};
  all[4].c_options.bands = 4;
  all[4].c_options.target_size = 16;
  return all;
}

/// The result of a posted job. `post` gets where the handle is to go.
welkin_projection posted(const std::function<welkin_status(welkin_job**)>& post) {
  welkin_job* job = nullptr;
  REQUIRE(post(&job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_OK);
  auto light = c_struct<welkin_projection>();
  REQUIRE(welkin_job_projection(job, &light) == WELKIN_OK);
  welkin_job_release(job);
  return light;
}

}  // namespace

TEST_CASE("C: cubemaps and their mip chains give the C++ calls' bits", "[c_interface]") {
  const CWorker worker(2);
  const auto large = make_cubemap_half(Content::special_values, 32, 4, 1);
  const auto small = make_cubemap_half(Content::random, 16, 4, 2);
  const std::vector<CubemapView> views{large.view(), small.view()};
  const std::vector<welkin_cubemap> mips{c_view(views[0]), c_view(views[1])};
  for (const auto& [options, c_options] : all_wanted()) {
    for (const std::size_t levels : {1U, 2U}) {
      const Projection expected = project(std::span(views).first(levels), options);
      const auto count = static_cast<std::int32_t>(levels);
      auto light = c_struct<welkin_projection>();
      REQUIRE(welkin_project_cubemap(mips.data(), count, &c_options, nullptr, &light) == WELKIN_OK);
      require_same(light, expected);
      require_same(posted([&, options = &c_options](welkin_job** job) {
                     return welkin_post_project_cubemap(worker.get(), mips.data(), count, options, nullptr, job);
                   }),
                   expected);
    }
  }
}

TEST_CASE("C: lat-longs give the C++ call's bits", "[c_interface]") {
  const CWorker worker(2);
  const auto picture = make_lat_long(Content::high_range, 128, 64, 3);
  const welkin_lat_long view = c_view(picture.view());
  for (const auto& [options, c_options] : all_wanted()) {
    const Projection expected = project(picture.view(), options);
    auto light = c_struct<welkin_projection>();
    REQUIRE(welkin_project_lat_long(&view, &c_options, nullptr, &light) == WELKIN_OK);
    require_same(light, expected);
    require_same(posted([&, options = &c_options](welkin_job** job) {
                   return welkin_post_project_lat_long(worker.get(), &view, options, nullptr, job);
                 }),
                 expected);
  }
}

TEST_CASE("C: files give the C++ call's bits", "[c_interface]") {
  const CWorker worker(2);
  const TemporaryDirectory directory;
  const auto picture = make_lat_long(Content::sun_disc, 64, 32, 4);
  write_bytes(directory.file("sky.pfm"), pfm_bytes(64, 32, false, "-1.0", picture.pixels));
  const std::string path = directory.file("sky.pfm").string();
  auto reading = c_struct<welkin_read_options>();
  reading.layout = WELKIN_LAYOUT_LAT_LONG;
  reading.primaries = WELKIN_PRIMARIES_AS_STORED;
  for (const auto& [options, c_options] : all_wanted()) {
    const Projection expected = project_file(path, {}, options);
    auto light = c_struct<welkin_projection>();
    REQUIRE(welkin_project_file(path.c_str(), &reading, &c_options, nullptr, &light) == WELKIN_OK);
    require_same(light, expected);
    require_same(posted([&, options = &c_options](welkin_job** job) {
                   return welkin_post_project_file(worker.get(), path.c_str(), nullptr, options, nullptr, job);
                 }),
                 expected);
  }
}

TEST_CASE("C: what is made of coefficients has the C++ calls' bits", "[c_interface]") {
  const auto picture = make_lat_long(Content::sun_disc, 64, 32, 5);
  for (const int bands : {1, 2, 3, 5}) {
    const Projection light = project(picture.view(), {.bands = bands});
    std::vector<double> radiance;
    for (const glm::dvec3& rgb : light.radiance.coefficients()) radiance.insert(radiance.end(), {rgb.x, rgb.y, rgb.z});

    const SphericalHarmonics expected = irradiance_from_radiance(light.radiance);
    std::vector<double> irradiance(radiance.size());
    REQUIRE(welkin_irradiance_from_radiance(bands, radiance.data(), irradiance.data()) == WELKIN_OK);
    for (std::size_t i = 0; i < expected.coefficients().size(); ++i) {
      REQUIRE(same_triple(irradiance.data() + 3 * i, expected.coefficients()[i]));
    }

    const double direction[3] = {0.6, 0.0, -0.8};
    double value[3];
    REQUIRE(welkin_evaluate(bands, irradiance.data(), direction, value) == WELKIN_OK);
    REQUIRE(same_triple(value, evaluate(expected, {0.6, 0.0, -0.8})));

    for (const Convention& convention : conventions()) {
      auto form = c_struct<welkin_engine_light>();
      const auto number = static_cast<welkin_engine>(convention.engine);
      for (const bool turned : {false, true}) {
        const auto call = turned ? welkin_engine_light_from_radiance : welkin_engine_light_in_place;
        const welkin_status status = call(bands, radiance.data(), number, &form);
        INFO(convention.name);
        REQUIRE((status == WELKIN_OK) == has_engine_light(convention.engine));
        if (status != WELKIN_OK) continue;
        const EngineLight engine = turned ? engine_light(light.radiance, convention.engine)
                                          : engine_light_in_place(light.radiance, convention.engine);
        REQUIRE(form.engine == number);
        REQUIRE(static_cast<std::size_t>(form.term_count) == engine.terms.size());
        REQUIRE(static_cast<std::size_t>(form.vector_count) == engine.vectors.size());
        for (std::size_t i = 0; i < engine.terms.size(); ++i) REQUIRE(same_triple(form.terms[i], engine.terms[i].rgb));
        for (std::size_t i = 0; i < engine.vectors.size(); ++i) {
          REQUIRE(same_triple(form.vectors[i], glm::dvec3(engine.vectors[i].value)));
          REQUIRE(same_bits(form.vectors[i][3], engine.vectors[i].value.w));
        }
      }
    }
  }
}

}  // namespace welkin::test
