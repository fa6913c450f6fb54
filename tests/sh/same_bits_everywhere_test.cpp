// Same input, same options: same bits, on any number of threads, in any arena, under load, on every
// instruction set, today and tomorrow.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/golden.h"
#include "support/test_environments.h"
#include "welkin/control.h"
#include "welkin/instruction_set.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

/// Sizes on both sides of the inline threshold and of every table's, formats with kernels of their own.
struct Cases {
  TestCubemap small = make_cubemap(Content::high_range, 64, 3, 21);
  TestCubemap odd = make_cubemap(Content::random, 201, 4, 22);
  TestCubemap large = make_cubemap(Content::one_texel_sun, 320, 3, 23);
  TestCubemapHalf half = make_cubemap_half(Content::random, 160, 4, 24);
  TestCubemap special = make_cubemap(Content::special_values, 200, 3, 25);
  TestLatLong lat_long = make_lat_long(Content::high_range, 640, 320, 26);
  TestLatLong odd_lat_long = make_lat_long(Content::special_values, 333, 301, 27);

  [[nodiscard]] std::vector<SphericalHarmonics> project_all() const {
    ProjectionOptions ten;
    ten.bands = 10;
    ProjectionOptions babylon;
    babylon.quadrature = Quadrature::midpoint;
    babylon.clamp = RadianceClamp{};
    babylon.target_size = 64;
    ProjectionOptions reduced;
    reduced.target_size = 48;
    ProjectionOptions gamma;
    gamma.gamma = true;
    return {project(small.view()).radiance,
            project(odd.view()).radiance,
            project(large.view()).radiance,
            project(half.view()).radiance,
            project(special.view()).radiance,
            project(lat_long.view()).radiance,
            project(odd_lat_long.view()).radiance,
            project(odd.view(), ten).radiance,
            project(large.view(), babylon).radiance,
            project(large.view(), reduced).radiance,
            project(lat_long.view(), reduced).radiance,
            project(odd.view(), gamma).radiance};
  }
};

const Cases& cases() {
  static const Cases all;
  return all;
}

void require_same(const std::vector<SphericalHarmonics>& a, const std::vector<SphericalHarmonics>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    CAPTURE(k);
    CHECK(same_bits(a[k], b[k]));
  }
}

}  // namespace

TEST_CASE("Any number of threads gives the same bits", "[sh][determinism]") {
  std::vector<SphericalHarmonics> expected;
  run_with_threads(1, [&] { expected = cases().project_all(); });
  for (const int threads : {2, 3, 5, 8, 16}) {
    CAPTURE(threads);
    run_with_threads(threads, [&] { require_same(cases().project_all(), expected); });
  }
}

TEST_CASE("A hundred repetitions under load in a foreign arena give the same bits", "[sh][determinism]") {
  const TestCubemap cubemap = make_cubemap(Content::high_range, 256, 3, 31);
  const SphericalHarmonics expected = project(cubemap.view()).radiance;
  std::atomic<bool> done{false};
  std::vector<std::thread> load;
  for (int k = 0; k < 3; ++k) {
    load.emplace_back([&] {
      while (!done) tbb::parallel_for(0, 1000, [](int) { std::this_thread::yield(); });
    });
  }
  const tbb::global_control allowance(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena foreign(3);
  int different = 0;
  for (int repetition = 0; repetition < 100; ++repetition) {
    SphericalHarmonics result;
    foreign.execute([&] { result = project(cubemap.view()).radiance; });
    different += same_bits(result, expected) ? 0 : 1;
  }
  done = true;
  for (std::thread& thread : load) thread.join();
  CHECK(different == 0);
}

TEST_CASE("Several threads that project at the same time get the same bits", "[sh][determinism]") {
  const std::vector<SphericalHarmonics> expected = cases().project_all();
  std::vector<std::vector<SphericalHarmonics>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back([&result] { result = cases().project_all(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) require_same(result, expected);
}

TEST_CASE("Every instruction set gives the same bits", "[sh][determinism]") {
  const InstructionSet before = active_instruction_set();
  force_instruction_set(InstructionSet::sse2);
  const std::vector<SphericalHarmonics> expected = cases().project_all();
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    force_instruction_set(set);
    require_same(cases().project_all(), expected);
  }
  force_instruction_set(before);
}

TEST_CASE("The coefficients are those on record", "[sh][determinism][golden]") {
  require_golden("projection", cases().project_all());
}

}  // namespace welkin::test
