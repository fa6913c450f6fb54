// Many probes baked in one call: what single calls give, in memory of the caller's.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

/// Room for the chains of many probes, as halves.
struct Room {
  Room(const PrefilterOptions& options, std::size_t count)
      : layout{.format = TexelFormat::rgba16f, .size = options.size, .levels = *options.mips},
        bytes(upload_bytes(layout)),
        memory(bytes * count, std::byte{0xEE}) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto of_probe = upload_targets(layout, std::span(memory).subspan(k * bytes, bytes));
      targets.insert(targets.end(), of_probe.begin(), of_probe.end());
    }
  }

  UploadLayout layout;
  std::size_t bytes;
  std::vector<std::byte> memory;
  std::vector<CubemapTarget> targets;
};

PrefilterOptions small_chain() { return {.size = 8, .mips = 4, .roughness = {0.0, 0.35, 0.6, 1.0}}; }

struct Probes {
  explicit Probes(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      if (k % 40 == 11) {
        views.push_back(large.view());
      } else {
        views.push_back(k % 3 == 0 ? floats.view() : k % 3 == 1 ? halves.view() : sun.view());
      }
    }
  }

  TestCubemap floats = make_cubemap(Content::random, 8, 3, 1);
  TestCubemapHalf halves = make_cubemap_half(Content::special_values, 16, 4, 2);
  TestCubemap sun = make_cubemap(Content::one_texel_sun, 13, 4, 3);
  TestCubemap large = make_cubemap(Content::blocks, 132, 3, 4);
  std::vector<CubemapView> views;
};

}  // namespace

TEST_CASE("Many probes are baked with the bits of single calls", "[bake][many][slow]") {
  const PrefilterOptions options = small_chain();
  for (const std::size_t count : {0, 1, 2, 50}) {
    const Probes probes(count);
    Room expected(options, count);
    std::vector<dvec3> light;
    std::uint64_t clamped = 0;
    ProjectionDiagnostics sum;
    for (std::size_t k = 0; k < count; ++k) {
      const PrefilteredSpecular chain = prefilter_specular(probes.views[k], options);
      clamped += store_texels(chain.cubemap, std::span(expected.targets).subspan(4 * k, 4));
      const Projection one = project(probes.views[k], {.bands = 4});
      light.insert(light.end(), one.radiance.coefficients().begin(), one.radiance.coefficients().end());
      sum.texels += one.diagnostics.texels;
      sum.nans_replaced += one.diagnostics.nans_replaced;
    }
    for (const int threads : {1, 2, 4}) {
      CAPTURE(count, threads);
      Room found(options, count);
      std::vector<dvec3> coefficients(16 * count);
      BakeResult result;
      run_with_threads(threads, [&] {
        result = bake_many(probes.views, found.targets, coefficients, options, 4);
        CHECK(same_bytes<dvec3>(light, coefficients));
        CHECK(same_bytes<std::byte>(expected.memory, found.memory));
      });
      CHECK(result.values_clamped == clamped);
      CHECK(result.diagnostics.texels == sum.texels);
      CHECK(result.diagnostics.nans_replaced == sum.nans_replaced);
      CHECK((count == 0 || result.peak_bytes > 0));
    }
  }
}

TEST_CASE("Many probes need no harmonics", "[bake][many]") {
  const Probes probes(9);
  const PrefilterOptions options = small_chain();
  Room with(options, 9);
  Room without(options, 9);
  std::vector<dvec3> coefficients(9 * 9);
  bake_many(probes.views, with.targets, coefficients, options);
  const BakeResult result = bake_many(probes.views, without.targets, {}, options, 0);
  CHECK(same_bytes<std::byte>(with.memory, without.memory));
  CHECK(result.diagnostics.total_radiance.x > 0.0);
}

TEST_CASE("Errors of many bakes name the first probe that they are about", "[bake][many]") {
  Probes probes(30);
  PrefilterOptions options = small_chain();
  Room room(options, 30);
  std::vector<dvec3> coefficients(9 * 30);
  const auto error = [&] { return thrown_by([&] { bake_many(probes.views, room.targets, coefficients, options); }); };
  options.pixels.nan = NonFinitePolicy::reject;
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [&] {
      const ThrownError rejected = error();
      CHECK(rejected.code == ErrorCode::rejected_pixel);
      CHECK(rejected.message.starts_with("probe 1: a channel of the texel at face +X"));
    });
  }
  const std::vector<std::byte> before = room.memory;
  room.targets[4 * 17 + 2].faces[3] = nullptr;
  CHECK(error().code == ErrorCode::invalid_argument);
  CHECK(error().message.starts_with("probe 17: "));
  probes.views[5].size = 0;
  CHECK(error().message.starts_with("probe 5: "));
  room.targets.pop_back();
  CHECK(error().says("119 targets"));
  coefficients.pop_back();
  CHECK(thrown_by([&] { bake_many(probes.views, room.targets, coefficients, options, 17); }).says("bands is 17"));
  CHECK(same_bytes<std::byte>(before, room.memory));
}

TEST_CASE("Many bakes are stopped, and tell how far they are", "[bake][many][slow]") {
  const Probes probes(60);
  const PrefilterOptions options = small_chain();
  Room room(options, 60);
  std::vector<dvec3> coefficients(9 * 60);
  double last = 0.0;
  bake_many(probes.views, room.targets, coefficients, options, 3, {.progress = [&](double done) {
              CHECK(done >= last);
              last = done;
            }});
  CHECK(last == 1.0);
  std::stop_source stop;
  const ThrownError error = thrown_by([&] {
    bake_many(probes.views, room.targets, coefficients, options, 3,
              {.stop = stop.get_token(), .progress = [&](double done) {
                 if (done > 0.3) stop.request_stop();
               }});
  });
  CHECK(error.code == ErrorCode::cancelled);
}

}  // namespace welkin::test
