// Many probes baked in one call: the results of single calls, in the caller's memory.
#include <memory_resource>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"

namespace welkin::test {

namespace {

/// Memory for the chains of many probes, stored in half precision.
struct Chains {
  Chains(const PrefilterOptions& options, std::size_t count)
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
    Chains expected(options, count);
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
      Chains found(options, count);
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
  Chains with(options, 9);
  Chains without(options, 9);
  std::vector<dvec3> coefficients(9 * 9);
  bake_many(probes.views, with.targets, coefficients, options);
  const BakeResult result = bake_many(probes.views, without.targets, {}, options, 0);
  CHECK(same_bytes<std::byte>(with.memory, without.memory));
  CHECK(result.diagnostics.total_radiance.x > 0.0);
}

TEST_CASE("Errors of many bakes name the first probe that they are about", "[bake][many]") {
  Probes probes(30);
  PrefilterOptions options = small_chain();
  Chains chains(options, 30);
  std::vector<dvec3> coefficients(9 * 30);
  const auto error = [&] { return thrown_by([&] { bake_many(probes.views, chains.targets, coefficients, options); }); };
  options.pixels.nan = NonFinitePolicy::reject;
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [&] {
      const ThrownError rejected = error();
      CHECK(rejected.code == ErrorCode::rejected_pixel);
      CHECK(rejected.message.starts_with("probe 1: a channel of the texel at face +X"));
    });
  }
  const std::vector<std::byte> before = chains.memory;
  chains.targets[4 * 17 + 2].faces[3] = nullptr;
  CHECK(error().code == ErrorCode::invalid_argument);
  CHECK(error().message.starts_with("probe 17: "));
  probes.views[5].size = 0;
  CHECK(error().message.starts_with("probe 5: "));
  chains.targets.pop_back();
  CHECK(error().says("119 targets"));
  coefficients.pop_back();
  CHECK(thrown_by([&] { bake_many(probes.views, chains.targets, coefficients, options, 17); }).says("bands is 17"));
  CHECK(same_bytes<std::byte>(before, chains.memory));
}

TEST_CASE("Many bakes are stopped, and tell how far they are", "[bake][many][slow]") {
  const Probes probes(20);
  const PrefilterOptions options = small_chain();
  Chains chains(options, 20);
  std::vector<dvec3> coefficients(9 * 20);
  double last = 0.0;
  bake_many(probes.views, chains.targets, coefficients, options, 3, {.progress = [&](double done) {
              CHECK(done >= last);
              last = done;
            }});
  CHECK(last == 1.0);
  stop_source stop;
  const ThrownError error = thrown_by([&] {
    bake_many(probes.views, chains.targets, coefficients, options, 3,
              {.stop = stop.get_token(), .progress = [&](double done) {
                 if (done > 0.3) stop.request_stop();
               }});
  });
  CHECK(error.code == ErrorCode::cancelled);
}

// The memory of a bake's cubemaps: the caller's targets, or memory from the caller's memory resource.

namespace {

struct Block : TargetMemory {
  Block(TexelFormat format, int size, int levels)
      : TargetMemory({.format = format, .size = size, .levels = levels, .row_alignment_bytes = 64}) {}
};

/// Counts allocated and freed memory, on any threads.
class CountingResource final : public std::pmr::memory_resource {
 public:
  [[nodiscard]] std::size_t taken() const { return taken_; }
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    taken_ += bytes;
    held_ += bytes;
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    held_ -= bytes;
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

  std::atomic<std::size_t> taken_{0};
  std::atomic<std::size_t> held_{0};
};

}  // namespace

TEST_CASE("targets: a bake writes the texels that store_texels writes of its result", "[bake]") {
  const TestLatLong wide = make_lat_long(Content::high_range, 32, 16, 5);
  const TestCubemap cube = make_cubemap(Content::high_range, 8, 3, 6);
  const auto check = [](const auto& view) {
    const BakeOptions options = quick_bake();
    const BakeResult whole = bake(view, options);
    Block background(TexelFormat::b10g11r11, 16, 5);
    Block specular(TexelFormat::rgba16f, 8, 3);
    Block irradiance(TexelFormat::rgba32f, 5, 1);
    const BakeTargets targets{background.targets, specular.targets, irradiance.targets.front()};
    const BakeResult rest = bake_to(targets, view, options);
    CHECK(background.memory ==
          stored(*whole.background, {.format = TexelFormat::b10g11r11, .row_alignment_bytes = 64}));
    CHECK(specular.memory ==
          stored(whole.specular->cubemap, {.format = TexelFormat::rgba16f, .row_alignment_bytes = 64}));
    Block expected(TexelFormat::rgba32f, 5, 1);
    static_cast<void>(store_texels(whole.irradiance->view(), expected.targets.front()));
    CHECK(irradiance.memory == expected.memory);
    CHECK_FALSE(rest.background);
    CHECK_FALSE(rest.irradiance);
    REQUIRE(rest.specular);
    CHECK(rest.specular->cubemap.levels() == 0);
    CHECK(rest.specular->mips.size() == 3);
    CHECK(rest.radiance.has_value());
  };
  check(wide.view());
  check(cube.view());
}

TEST_CASE("targets: what has none stays in the result, and what formats cannot hold is counted", "[bake]") {
  TestLatLong image = make_lat_long(Content::smooth, 32, 16, 5);
  image.pixels[0] = 1e9F;
  const BakeOptions options = quick_bake();
  Block background(TexelFormat::rgba16f, 16, 5);
  const BakeResult result = bake_to({.background = background.targets}, image.view(), options);
  CHECK(result.values_clamped > 0);
  CHECK(result.specular->cubemap.levels() == 3);
  CHECK(result.irradiance.has_value());
  CHECK(bake_to({}, image.view(), options).background->levels() == 5);
}

TEST_CASE("targets: those that do not fit are refused before anything is written", "[bake]") {
  const TestLatLong image = make_lat_long(Content::smooth, 32, 16, 5);
  const auto refused = [&](const BakeTargets& targets, const BakeOptions& options) {
    return thrown_by([&] { static_cast<void>(bake_to(targets, image.view(), options)); });
  };
  Block specular(TexelFormat::rgba16f, 8, 3);
  Block background(TexelFormat::rgba16f, 16, 4);
  const ThrownError few = refused({.background = background.targets, .specular = specular.targets}, quick_bake());
  CHECK(few.code == ErrorCode::invalid_argument);
  CHECK(few.says("the background has 5 levels, and there are 4 targets"));
  CHECK(specular.untouched());

  Block large(TexelFormat::rgba16f, 16, 3);
  CHECK(refused({.specular = large.targets}, quick_bake()).says("have 16 texels per edge"));
  BakeOptions without = quick_bake();
  without.irradiance.reset();
  CHECK(refused({.irradiance = specular.targets.front()}, without).says("the irradiance cubemap has 0 levels"));
  without.specular.reset();
  CHECK(refused({.specular = specular.targets}, without).says("the specular cubemap has 0 levels"));
}

TEST_CASE("memory: chains of results are taken from the caller's resource, and given back to it", "[bake]") {
  const TestLatLong image = make_lat_long(Content::high_range, 32, 16, 5);
  CountingResource memory;
  const Control control{.memory = &memory};
  {
    const BakeResult result = bake(image.view(), quick_bake(), control);
    CHECK(memory.held() == result.background->bytes() + result.specular->cubemap.bytes());
    const BakeResult same = bake(image.view(), quick_bake());
    CHECK(std::ranges::equal(std::span(result.background->face(0, 0), result.background->bytes() / sizeof(float)),
                             std::span(same.background->face(0, 0), same.background->bytes() / sizeof(float))));
    const Cubemap cube = to_cubemap(image.view(), 8);
    const std::size_t before = memory.held();
    const Cubemap mips = build_mips(cube.view(), MipFilter::box, std::nullopt, control);
    CHECK(memory.held() == before + mips.bytes());
    Cubemap other(4, 1, &memory);
    other = Cubemap();
    CHECK(memory.held() == before + mips.bytes());
  }
  CHECK(memory.taken() > 0);
  CHECK(memory.held() == 0);
}

TEST_CASE("memory: a bake that a cache knows takes as much as the others", "[bake][cache]") {
  const TestLatLong image = make_lat_long(Content::high_range, 32, 16, 5);
  ResultCache cache({.memory_bytes = 1 << 20});
  const BakeOptions options = quick_bake();
  BakeOptions others = options;
  others.specular->roughness = {0.0, 0.3, 0.8};
  for (const BakeOptions& each : {options, options, others}) {  // cached: nothing, everything, two mips of three
    CountingResource memory;
    const BakeResult result = cache.bake(image.view(), each, {.memory = &memory});
    const std::size_t bytes = result.background->bytes() + result.specular->cubemap.bytes();
    CHECK(memory.held() == bytes);
    CHECK(memory.taken() == bytes);
  }
}

TEST_CASE("memory: chains fit into one block of the caller's, and other memory is the heap's", "[bake]") {
  const Cubemap cube = to_cubemap(make_lat_long(Content::smooth, 32, 16, 5).view(), 16);
  alignas(64) std::byte block[40 * 1024];
  std::pmr::monotonic_buffer_resource memory(block, sizeof block, std::pmr::null_memory_resource());
  std::pmr::memory_resource* const before = std::pmr::set_default_resource(std::pmr::null_memory_resource());
  const Cubemap mips = build_mips(cube.view(), MipFilter::box, std::nullopt, {.memory = &memory});
  CHECK(static_cast<const void*>(mips.face(0, 0)) == block);
  CHECK_THROWS_AS(build_mips(cube.view(), MipFilter::box, std::nullopt, {.memory = &memory}), std::bad_alloc);
  CHECK_NOTHROW(project(cube.view(), {.quadrature = Quadrature::midpoint, .target_size = 8}));
  std::pmr::set_default_resource(before);
}

}  // namespace welkin::test
