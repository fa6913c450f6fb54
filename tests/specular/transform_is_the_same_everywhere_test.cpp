// The transform's bits do not depend on threads or instruction set, its tiles allocate nothing, and it stops when told.
#include <algorithm>
#include <cstring>
#include <stop_token>
#include <tuple>
#include <vector>

#include "specular/spectrum.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

using image::GridContent;
using image::SphereGrid;

/// There and back at several shapes, every number in a row.
std::vector<float> transform_all() {
  std::vector<float> numbers;
  for (const auto& [width, height, bands] : {std::tuple{1, 1, 9}, std::tuple{7, 5, 20}, std::tuple{37, 41, 30},
                                             std::tuple{360, 181, 96}, std::tuple{512, 600, 100}}) {
    const TestLatLong source = make_lat_long(Content::high_range, width, height, 41);
    const specular::Spectrum spectrum = specular::analyse(source.view(), bands, {});
    for (int m = 0; m < bands; ++m) {
      for (int l = m; l < bands; ++l) {
        for (int k = 0; k < 6; ++k) numbers.push_back(spectrum.order(m)[8 * (l - m) + k]);
      }
    }
    const std::vector<double> zonal(static_cast<std::size_t>(bands), 0.9);
    for (const GridContent content : {GridContent::samples, GridContent::spline_coefficients}) {
      SphereGrid grid(bands + 3, 2 * bands + 2, content);
      specular::synthesise(spectrum, zonal, grid, {});
      for (int ring = -SphereGrid::kBorder; ring < grid.rings() + SphereGrid::kBorder; ++ring) {
        const float* const row = grid.texel(-SphereGrid::kBorder, ring);
        numbers.insert(numbers.end(), row, row + grid.stride());
      }
    }
  }
  return numbers;
}

}  // namespace

TEST_CASE("The transform's bits do not depend on the number of threads", "[specular][transform][determinism]") {
  std::vector<float> expected;
  run_with_threads(1, [&] { expected = transform_all(); });
  for (const int threads : {2, 3, 8}) {
    CAPTURE(threads);
    run_with_threads(threads, [&] { CHECK(same_bytes<float>(transform_all(), expected)); });
  }
}

TEST_CASE("The transform's bits do not depend on the instruction set", "[specular][transform][determinism]") {
  const InstructionSet before = active_instruction_set();
  force_instruction_set(InstructionSet::sse2);
  const std::vector<float> expected = transform_all();
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    force_instruction_set(set);
    CHECK(same_bytes<float>(transform_all(), expected));
  }
  force_instruction_set(before);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("The transform's tiles allocate nothing", "[specular][transform][allocation]") {
  for (const int width : {512, 509}) {  // the second one prime: a convolution
    const TestLatLong source = make_lat_long(Content::random, width, 256, 42);
    for (const int threads : {1, 3}) {
      run_with_threads(threads, [&] {
        forget_allocations_in_tiles();
        const specular::Spectrum spectrum = specular::analyse(source.view(), 120, {});
        SphereGrid grid(160, 320, GridContent::spline_coefficients);
        specular::synthesise(spectrum, std::vector<double>(120, 1.0), grid, {});
        CHECK(allocations_in_tiles() == 0);
      });
    }
  }
}
#endif

TEST_CASE("The transform can be stopped and says how far it is", "[specular][transform][cancellation]") {
  const TestLatLong source = make_lat_long(Content::random, 512, 256, 43);
  const std::vector<double> zonal(100, 1.0);
  std::vector<double> done;
  const Control watching{{}, [&](double part) { done.push_back(part); }};
  const specular::Spectrum spectrum = specular::analyse(source.view(), 100, watching);
  REQUIRE(done.size() > 10);
  CHECK(std::is_sorted(done.begin(), done.end()));
  CHECK(done.back() == 1.0);
  done.clear();
  SphereGrid grid(128, 256, GridContent::samples);
  specular::synthesise(spectrum, zonal, grid, watching);
  REQUIRE(done.size() > 10);
  CHECK(std::is_sorted(done.begin(), done.end()));
  CHECK(done.back() == 1.0);
  for (const double moment : {0.0, 0.1, 0.3, 0.7}) {
    CAPTURE(moment);
    std::stop_source stop;
    if (moment == 0.0) stop.request_stop();
    const Control stopping{stop.get_token(), [&](double part) {
                             if (part >= moment) stop.request_stop();
                           }};
    CHECK(thrown_by([&] { static_cast<void>(specular::analyse(source.view(), 100, stopping)); }).code ==
          ErrorCode::cancelled);
    std::stop_source stop_back;
    if (moment == 0.0) stop_back.request_stop();
    const Control stopping_back{stop_back.get_token(), [&](double part) {
                                  if (part >= moment) stop_back.request_stop();
                                }};
    CHECK(thrown_by([&] { specular::synthesise(spectrum, zonal, grid, stopping_back); }).code == ErrorCode::cancelled);
  }
}

TEST_CASE("The transform refuses what it cannot do", "[specular][transform]") {
  const TestLatLong source = make_lat_long(Content::random, 8, 4, 44);
  const TestLatLong with_alpha = make_lat_long(Content::random, 8, 4, 44, 4);
  const auto refused = [](const auto& work) { return thrown_by(work).code == ErrorCode::invalid_argument; };
  CHECK(refused([&] { static_cast<void>(specular::analyse(source.view(), 0, {})); }));
  CHECK(refused([&] { static_cast<void>(specular::analyse(source.view(), 1537, {})); }));
  CHECK(refused([&] { static_cast<void>(specular::analyse(with_alpha.view(), 4, {})); }));
  CHECK(refused([&] { static_cast<void>(specular::analyse({}, 4, {})); }));
  const specular::Spectrum spectrum = specular::analyse(source.view(), 4, {});
  const std::vector<double> zonal(5, 1.0);
  SphereGrid narrow(4, 6, GridContent::samples);
  SphereGrid odd(4, 9, GridContent::samples);
  SphereGrid good(4, 8, GridContent::samples);
  const std::span<const double> four(zonal.data(), 4);
  CHECK(refused([&] { specular::synthesise(spectrum, four, narrow, {}); }));
  CHECK(refused([&] { specular::synthesise(spectrum, four, odd, {}); }));
  CHECK(refused([&] { specular::synthesise(spectrum, zonal, good, {}); }));
  CHECK(refused([&] { specular::synthesise(spectrum, {}, good, {}); }));
  CHECK_NOTHROW(specular::synthesise(spectrum, four, good, {}));
}

}  // namespace welkin::test
