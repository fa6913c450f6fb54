// Promise: chains of any engine are read as its shader reads them, in Welkin's axes, and measured against the integral.
#include "image/geometry.h"
#include "perf/report/passes.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

Cubemap image_chain() {
  return prefilter_specular(make_lat_long(Content::blocks, 64, 32, 5).view(), {.size = 8, .mips = 4}).cubemap;
}

dvec3 texel(const Cubemap& chain, int level, int face, int row, int column) {
  const float* const rgb = chain.face(level, face) + 3 * (row * chain.level_size(level) + column);
  return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace

TEST_CASE("report: a lookup finds texels at their centres, and what lies between two levels", "[report][lookups]") {
  const Cubemap chain = image_chain();
  for (int face = 0; face < 6; ++face) {
    for (const int row : {0, 3, 7}) {
      const int column = 7 - row / 2;
      const dvec3 where = image::face_direction(8, face, column + 0.5, row + 0.5);
      CHECK(glm::distance(report::lookup(chain, 0, where), texel(chain, 0, face, row, column)) < 1e-12);
      const dvec3 between = report::lookup(chain, 1.25, where);
      CHECK(glm::distance(between, 0.75 * report::lookup(chain, 1, where) + 0.25 * report::lookup(chain, 2, where)) <
            1e-12);
      CHECK(report::lookup(chain, 9.0, where) == report::lookup(chain, 3, where));
    }
  }
}

TEST_CASE("report: a lookup shows no seams, and at a corner the mean of three texels", "[report][lookups]") {
  const Cubemap chain = image_chain();
  for (const dvec3& edge : {dvec3(1, 0.3, 1), dvec3(-1, 1, 0.7), dvec3(0.1, -1, -1)}) {
    const dvec3 aside = 1e-9 * dvec3(1, -1, 2);
    CHECK(glm::distance(report::lookup(chain, 0, edge + aside), report::lookup(chain, 0, edge - aside)) < 1e-6);
  }
  const dvec3 three = (texel(chain, 3, 0, 0, 0) + texel(chain, 3, 2, 0, 0) + texel(chain, 3, 4, 0, 0)) / 3.0;
  CHECK(glm::distance(report::lookup(chain, 3, dvec3(1.0)), three) < 1e-6);
}

TEST_CASE("report: chains of engines are brought into Welkin's axes", "[report][lookups]") {
  const auto same = [](float a, float b) { return a == b; };
  const Cubemap chain = image_chain();
  const Convention& babylon = convention(Engine::babylon);
  const dmat3 faces = *babylon.faces_from_engine * babylon.from_welkin;
  CHECK(all_values(report::from_axes(mirrored_x(chain), faces), chain, same));
  CHECK(all_values(report::from_axes(chain, dmat3(1.0)), chain, same));
  CHECK_FALSE(all_values(report::from_axes(chain, faces), chain, same));
}

TEST_CASE("report: lookups err less in more mips of fitted lobes, and more by another formula",
          "[report][lookups][slow]") {
  const TestLatLong source = make_lat_long(Content::smooth, 64, 32, 3);
  const report::LookupTruth truth(source.view(), 40);
  const auto error = [&](int mips, bool fitted, RoughnessSchedule by) {
    PrefilterOptions options{.size = 32, .roughness = mip_roughness(RoughnessSchedule::filament, mips, 32)};
    if (fitted) options.lobe_roughness = fitted_mip_roughness(RoughnessSchedule::filament, mips, 32);
    return truth.errors(prefilter_specular(source.view(), options).cubemap, by);
  };
  const report::ErrorNorms fitted = error(4, true, RoughnessSchedule::filament);
  CHECK(fitted.rms < error(4, false, RoughnessSchedule::filament).rms);
  CHECK(error(4, false, RoughnessSchedule::filament).rms < error(2, false, RoughnessSchedule::filament).rms);
  CHECK(error(4, false, RoughnessSchedule::linear).rms > 2.0 * error(4, false, RoughnessSchedule::filament).rms);
  CHECK(fitted.maximum >= fitted.rms);
  CHECK(fitted.rms < 0.02);
}

TEST_CASE("report: lookups of even light have no error", "[report][lookups]") {
  const TestLatLong source = make_lat_long(Content::uniform, 32, 16, 3);
  const PrefilterOptions options{.size = 16, .mips = 4};
  const report::ErrorNorms errors =
      report::LookupTruth(source.view(), 10)
          .errors(prefilter_specular(source.view(), options).cubemap, RoughnessSchedule::filament);
  CHECK(errors.maximum < 1e-5);
}

}  // namespace welkin::test
