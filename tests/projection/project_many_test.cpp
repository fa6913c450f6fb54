// Many probes in one call: what the calls for each of them give, bit by bit, without the heap.
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

/// Probes of many sizes and formats, some with values that no light has, some large.
struct Probes {
  explicit Probes(int count) {
    for (int k = 0; k < 4; ++k) {
      const auto seed = static_cast<std::uint32_t>(k);
      const Content content = k == 2 ? Content::special_values : k == 3 ? Content::one_texel_sun : Content::random;
      floats.push_back(make_cubemap(content, 5 + 11 * k, 3 + k % 2, seed));
      halves.push_back(make_cubemap_half(content, k == 1 ? 64 : 16 + k, 4, seed));
      bytes.push_back(make_cubemap_bytes(Content::random, 9 + 23 * k, 3 + k % 2, seed));
      large.push_back(make_cubemap(Content::blocks, k == 0 ? 256 : 130 + k, 3, seed));
    }
    for (int k = 0; k < count; ++k) {
      const auto which = static_cast<std::size_t>(k / 3 % 4);
      if (k % 50 == 7) {
        views.push_back(large[static_cast<std::size_t>(k / 50 % 4)].view());
      } else if (k % 3 == 0) {
        views.push_back(floats[which].view());
      } else {
        views.push_back(k % 3 == 1 ? halves[which].view() : bytes[which].view());
      }
    }
  }

  std::vector<TestCubemap> floats;
  std::vector<TestCubemapHalf> halves;
  std::vector<TestCubemapBytes> bytes;
  std::vector<TestCubemap> large;
  std::vector<CubemapView> views;
};

std::vector<dvec3> one_by_one(const std::vector<CubemapView>& views, const ProjectionOptions& options,
                              ProjectionDiagnostics& sum) {
  std::vector<dvec3> all;
  for (const CubemapView& view : views) {
    const Projection one = project(view, options);
    const auto coefficients = one.radiance.coefficients();
    all.insert(all.end(), coefficients.begin(), coefficients.end());
    sum.texels += one.diagnostics.texels;
    sum.nans_replaced += one.diagnostics.nans_replaced;
    sum.infinities_replaced += one.diagnostics.infinities_replaced;
    sum.negatives_replaced += one.diagnostics.negatives_replaced;
    sum.texels_clamped += one.diagnostics.texels_clamped;
    sum.error_estimate = std::max(sum.error_estimate, one.diagnostics.error_estimate);
  }
  return all;
}

void require_the_same(const std::vector<CubemapView>& views, const ProjectionOptions& options) {
  ProjectionDiagnostics wanted;
  const std::vector<dvec3> expected = one_by_one(views, options, wanted);
  ProjectionDiagnostics first;
  for (const int threads : {1, 2, 4}) {
    CAPTURE(threads, options.bands);
    std::vector<dvec3> found(expected.size(), dvec3(-1.0));
    ProjectionDiagnostics sum;
    run_with_threads(threads, [&] { sum = project_many(views, found, options); });
    CHECK(same_bytes<dvec3>(expected, found));
    CHECK(sum.texels == wanted.texels);
    CHECK(sum.nans_replaced == wanted.nans_replaced);
    CHECK(sum.infinities_replaced == wanted.infinities_replaced);
    CHECK(sum.negatives_replaced == wanted.negatives_replaced);
    CHECK(sum.texels_clamped == wanted.texels_clamped);
    CHECK(same_bits(sum.error_estimate, wanted.error_estimate));
    if (threads == 1) first = sum;
    CHECK(same_bits(sum.total_radiance, first.total_radiance));
    CHECK(same_bits(sum.total_radiance_before_clamp, first.total_radiance_before_clamp));
  }
}

}  // namespace

TEST_CASE("Many probes in one call have the bits of a call for each", "[projection][many]") {
  for (const int count : {0, 1, 2, 8, 257}) {
    CAPTURE(count);
    require_the_same(Probes(count).views, {});
  }
}

TEST_CASE("Many probes are projected with all options that one is", "[projection][many][truth]") {
  const Probes probes(60);
  ProjectionOptions clamped{.bands = 5, .target_size = 12, .pixels = {.clamp = RadianceClamp{0.8F, true}}};
  clamped.pixels.negative = NegativePolicy::replace;
  require_the_same(probes.views, clamped);
  require_the_same(probes.views, {.bands = 1, .pixels = {.gamma = true}});
  require_the_same(probes.views, {.bands = 2, .quadrature = Quadrature::midpoint});
  require_the_same(probes.views, {.quadrature = Quadrature::midpoint, .target_size = 8});
  require_the_same(Probes(12).views, {.bands = 16});
}

TEST_CASE("Nothing is taken from the heap for a probe", "[projection][many]") {
  const Probes probes(257);
  std::vector<dvec3> found(9 * probes.views.size());
  for (const int threads : {1, 4}) {
    run_with_threads(threads, [&] {
      forget_allocations_in_tiles();
      project_many(probes.views, found);
      CHECK(allocations_in_tiles() == 0);
    });
  }
}

TEST_CASE("The first probe with a rejected texel is named, whichever thread meets one", "[projection][many]") {
  const TestCubemap clean = make_cubemap(Content::random, 16, 3, 1);
  TestCubemap bad = clean;
  bad.pixels[3 * 16 * 5 + 3 * 7] = std::numeric_limits<float>::quiet_NaN();
  TestCubemap large = make_cubemap(Content::random, 140, 3, 1);
  large.pixels[0] = std::numeric_limits<float>::infinity();
  ProjectionOptions options;
  options.pixels.nan = NonFinitePolicy::reject;
  options.pixels.infinity = NonFinitePolicy::reject;
  std::vector<CubemapView> views(300, clean.view());
  views[41] = large.view();
  std::vector<dvec3> found(9 * views.size());
  const auto message = [&] {
    const ThrownError error = thrown_by([&] { project_many(views, found, options); });
    CHECK(error.code == ErrorCode::rejected_pixel);
    return error.message;
  };
  for (const int threads : {1, 4}) {
    run_with_threads(threads, [&] {
      CHECK(message().starts_with("probe 41: a channel of the texel at face +X, row 0, column 0 is infinite"));
      views[33] = views[34] = views[290] = bad.view();
      CHECK(message().starts_with("probe 33: a channel of the texel at face +X, row 5, column 7 is NaN"));
      views[33] = views[34] = clean.view();
      CHECK(message().starts_with("probe 41: "));
      options.target_size = 4;
      options.quadrature = Quadrature::midpoint;
      views[33] = bad.view();
      CHECK(message().starts_with("probe 33: "));
      options.target_size.reset();
      options.quadrature = Quadrature::exact;
      views[33] = views[290] = clean.view();
    });
  }
}

TEST_CASE("Probes and room are looked at before anything is written", "[projection][many]") {
  const TestCubemap clean = make_cubemap(Content::random, 16, 3, 1);
  std::vector<CubemapView> views(20, clean.view());
  views[12].faces[3] = nullptr;
  std::vector<dvec3> found(9 * views.size(), dvec3(7.0));
  const ThrownError broken = thrown_by([&] { project_many(views, found); });
  CHECK(broken.code == ErrorCode::invalid_argument);
  CHECK(broken.message.starts_with("probe 12: "));
  views[12] = clean.view();
  found.pop_back();
  const ThrownError too_short = thrown_by([&] { project_many(views, found); });
  CHECK(too_short.code == ErrorCode::invalid_argument);
  CHECK(too_short.says("179 elements"));
  CHECK(thrown_by([&] { project_many(views, found, {.bands = 17}); }).code == ErrorCode::invalid_argument);
  CHECK(std::ranges::all_of(found, [](const dvec3& value) { return value == dvec3(7.0); }));
}

TEST_CASE("Many probes are stopped, and tell how far they are", "[projection][many]") {
  const Probes probes(257);
  std::vector<dvec3> found(9 * probes.views.size());
  stop_source stop;
  std::atomic<int> calls{0};
  double last = 0.0;
  project_many(probes.views, found, {}, {.progress = [&](double done) {
                 CHECK(done >= last);
                 last = done;
                 ++calls;
               }});
  CHECK(last == 1.0);
  CHECK(calls > 20);
  calls = 0;
  const ThrownError error = thrown_by([&] {
    project_many(probes.views, found, {}, {.stop = stop.get_token(), .progress = [&](double done) {
                                             ++calls;
                                             if (done > 0.3) stop.request_stop();
                                           }});
  });
  CHECK(error.code == ErrorCode::cancelled);
  CHECK(error.message == "cancelled by the caller");
  CHECK(thrown_by([&] { project_many(probes.views, found, {}, {.stop = stop.get_token()}); }).code ==
        ErrorCode::cancelled);
}

}  // namespace welkin::test
