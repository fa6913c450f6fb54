// Promise: a bake that cannot be says so before it begins; one that is stopped or fails leaves nothing behind.
#include <atomic>
#include <limits>
#include <new>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/outcome.h"
#include "support/sanitized.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/control.h"

namespace welkin::test {

TEST_CASE("Options that no bake can have are refused", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::smooth, 24, 12, 5);
  const auto refused = [&](const std::function<void(BakeOptions&)>& change) {
    BakeOptions options = small_bake();
    change(options);
    bool worked = false;
    const ThrownError error = thrown_by([&] {
      static_cast<void>(bake(picture.view(), options, {{}, [&](double) { worked = true; }}));
    });
    CHECK(!worked);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(bake_bytes(picture.view(), options)); }).code ==
          ErrorCode::invalid_argument);
    return error.message;
  };
  using Catch::Matchers::Contains;
  constexpr int largest = std::numeric_limits<int>::max();
  for (const int wrong : {-1, 16385, largest, std::numeric_limits<int>::min()}) {
    CHECK_THAT(refused([&](BakeOptions& o) { o.background_size = wrong; }), Contains("background_size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.irradiance_size = wrong; }), Contains("irradiance_size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.bands = wrong; }), Contains("bands"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.specular->size = wrong; }), Contains("size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.specular->mips = wrong; }), Contains("mips"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.brdf->width = wrong; }), Contains("width"));
  }
  CHECK_THAT(refused([&](BakeOptions& o) { o.bands = 0; }), Contains("irradiance_size = 0"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.specular->roughness = {0.0, 1.5}; }), Contains("roughness"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.pixels.clamp = RadianceClamp{-1.0F}; }), Contains("clamp"));
  CHECK(thrown_by([&] {
          static_cast<void>(bake(LatLongView{nullptr, 4, 2}, small_bake()));
        }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] {
          static_cast<void>(bake(CubemapView{{}, 4}, small_bake()));
        }).code == ErrorCode::invalid_argument);
}

TEST_CASE("A bake above its memory limit is refused before it begins", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::smooth, 64, 32, 5);
  BakeOptions options = small_bake(64);
  const std::uint64_t needed = bake_bytes(picture.view(), options);
  options.memory_limit_bytes = needed - 1;
  bool worked = false;
  const ThrownError error = thrown_by([&] {
    static_cast<void>(bake(picture.view(), options, {{}, [&](double) { worked = true; }}));
  });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says(std::to_string(needed)));
  CHECK(error.says(std::to_string(needed - 1)));
  CHECK(error.says("memory_limit_bytes"));
  CHECK(!worked);
  options.memory_limit_bytes = needed;
  CHECK(bake(picture.view(), options).background.size() == 64);
  // The largest of everything does not overflow.
  BakeOptions huge;
  huge.background_size = 16384;
  huge.specular = PrefilterOptions{.size = 8192};
  huge.irradiance_size = 4096;
  huge.brdf = BrdfTableOptions{4096, 4096};
  CHECK(bake_bytes(picture.view(), huge) > std::uint64_t{12} * 6 * 16384 * 16384);
  CHECK(thrown_by([&] { static_cast<void>(bake(picture.view(), huge)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("A bake stops at any point of its progress", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::high_range, 512, 256, 5);
  for (const int threads : {1, 2}) {
    run_with_threads(threads, [&] {
      for (const double at : {0.0, 0.1, 0.5, 0.9}) {
        INFO("at " << at << ", " << threads << " threads");
        std::stop_source source;
        const Control control{source.get_token(), [&](double done) {
                                if (done >= at) source.request_stop();
                              }};
        CHECK(outcome_of([&] { static_cast<void>(bake(picture.view(), small_bake(64), control)); }) == "cancelled");
      }
      // Before the first tile, and after the last.
      std::stop_source source;
      const Control late{source.get_token(), [&](double done) {
                           if (done == 1.0) source.request_stop();
                         }};
      CHECK(outcome_of([&] { static_cast<void>(bake(picture.view(), small_bake(64), late)); }) == "result");
      CHECK(outcome_of([&] { static_cast<void>(bake(picture.view(), small_bake(64), late)); }) == "cancelled");
    });
  }
}

TEST_CASE("A bake's progress is one rising number", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::high_range, 512, 256, 5);
  std::vector<double> reports;
  static_cast<void>(bake(picture.view(), small_bake(64), {{}, [&](double done) { reports.push_back(done); }}));
  REQUIRE(reports.size() > 10);
  CHECK(std::is_sorted(reports.begin(), reports.end()));
  CHECK(reports.front() >= 0.0);
  CHECK(reports.back() == 1.0);
  CHECK(std::count(reports.begin(), reports.end(), 1.0) == 1);
}

TEST_CASE("What stops a bake comes out of it", "[bake]") {
  TestCubemap source = make_cubemap(Content::smooth, 33, 3, 2);
  source.pixels[3 * (2 * 33 * 33 + 4 * 33 + 5) + 1] = -1.0F;
  BakeOptions options = small_bake();
  options.pixels.negative = NegativePolicy::reject;
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [&] {
      const ThrownError error = thrown_by([&] { static_cast<void>(bake(source.view(), options)); });
      CHECK(error.code == ErrorCode::rejected_pixel);
      CHECK(error.says("face +Y, row 4, column 5"));
    });
  }
  const Control throwing{{}, [](double) { throw std::runtime_error("of the callback"); }};
  CHECK_THROWS_WITH(bake(source.view(), small_bake(), throwing), "of the callback");
}

TEST_CASE("A bake runs out of memory cleanly wherever it does", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::special_values, 40, 20, 5);
  const BakeResult expected = bake(picture.view(), small_bake());
  for (const bool for_good : {false, true}) {
    bool failed = true;
    for (long number = 1; failed; number += kSanitized ? 11 : 1) {
      INFO("allocation " << number << (for_good ? " and all after it" : ""));
      REQUIRE(number < 100'000);
      std::string end;
      BakeResult result;
      {
        const FailingHeap heap(Heap::this_thread, number, for_good);
        end = outcome_of([&] { result = bake(picture.view(), small_bake()); });
        failed = heap.failed();
      }
      if (!failed) CHECK(end == "result");
      if (end == "result") {
        CHECK(same_bits(result, expected));
      } else {
        CHECK(end == "bad_alloc");
      }
    }
  }
}

}  // namespace welkin::test
