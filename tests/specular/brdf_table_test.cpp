// Layout, options, cache and errors of BRDF tables.
#include "welkin/brdf_table.h"

#include <half.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <stop_token>
#include <thread>
#include <vector>

#include "perf/report/brdf_truth.h"
#include "specular/brdf_integration.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

using report::BrdfTruth;
using report::ggx_truth;
using report::sheen_truth;

float value(const BrdfTable& table, int column, int row, int channel) {
  return table.values[static_cast<std::size_t>((row * table.options.width + column) * table.channels + channel)];
}

bool same(const BrdfTable& a, const BrdfTable& b) {
  return a.options == b.options && same_bytes<float>(a.values, b.values);
}

}  // namespace

TEST_CASE("Each texel of a BRDF table is at its own angle and roughness", "[brdf]") {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{1, 1},
                                                                      {2, 3},
                                                                      {7, 5},
                                                                      {15, 2},
                                                                      {16, 2},
                                                                      {17, 2},
                                                                      {63, 3},
                                                                      {64, 4},
                                                                      {65, 3},
                                                                      {257, 2},
                                                                      {4096, 1},
                                                                      {1, 4096}}) {
    const auto table = brdf_table({width, height, BrdfModel::split_sum, true});
    REQUIRE(table->channels == 3);
    REQUIRE(table->values.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
    CHECK(table->bytes() == table->values.size() * 4);
    for (const int column : {0, width / 2, width - 1}) {
      for (const int row : {0, height / 3, height - 1}) {
        const double cosine = (column + 0.5) / width;
        const double roughness = (row + 0.5) / height;
        const BrdfTruth truth = ggx_truth(cosine, roughness * roughness);
        const double sheen = sheen_truth(cosine, roughness * roughness);
        INFO(width << " x " << height << " texel " << column << ", " << row);
        CHECK(std::abs(value(*table, column, row, 0) - truth.scale) < 1e-5);
        CHECK(std::abs(value(*table, column, row, 1) - truth.bias) < 1e-5);
        CHECK(std::abs(value(*table, column, row, 2) - sheen) < 1e-5 * std::max(1.0, sheen));
      }
    }
  }
}

TEST_CASE("The multiple-scattering table holds the bias and the sum, and sheen is optional", "[brdf]") {
  const auto split = brdf_table({33, 21, BrdfModel::split_sum, true});
  const auto multiple = brdf_table({33, 21, BrdfModel::multiple_scattering, true});
  const auto bare = brdf_table({33, 21, BrdfModel::split_sum, false});
  REQUIRE(bare->channels == 2);
  REQUIRE(bare->values.size() == 33 * 21 * 2);
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 33; ++column) {
      CHECK(value(*multiple, column, row, 0) == value(*split, column, row, 1));
      CHECK(value(*multiple, column, row, 1) ==
            Approx(value(*split, column, row, 0) + value(*split, column, row, 1)).margin(1e-6));
      CHECK(value(*multiple, column, row, 2) == value(*split, column, row, 2));
      CHECK(value(*bare, column, row, 0) == value(*split, column, row, 0));
      CHECK(value(*bare, column, row, 1) == value(*split, column, row, 1));
    }
  }
}

TEST_CASE("A BRDF table has the same bits on any number of threads and instruction set", "[brdf]") {
  const BrdfTableOptions options{70, 37, BrdfModel::split_sum, true};
  const auto once = specular::integrated_brdf(options, {});
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 3, 8}) {
      run_with_threads(threads, [&] { CHECK(same(*once, *specular::integrated_brdf(options, {}))); });
    }
  }
  force_instruction_set(before);
}

TEST_CASE("BRDF tables are made once and shared", "[brdf]") {
  const BrdfTableOptions options{61, 59, BrdfModel::multiple_scattering, true};
  std::vector<std::shared_ptr<const BrdfTable>> found(6);
  std::vector<std::thread> threads;
  for (auto& table : found) threads.emplace_back([&table, &options] { table = brdf_table(options); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& table : found) CHECK(table == found.front());
  CHECK(brdf_table({61, 59, BrdfModel::split_sum, true}) != found.front());
}

TEST_CASE("Filling a BRDF table allocates nothing in its tiles", "[brdf]") {
  forget_allocations_in_tiles();
  (void)specular::integrated_brdf({130, 40, BrdfModel::split_sum, true}, {});
  CHECK(allocations_in_tiles() == 0);
}

TEST_CASE("BRDF tables report their progress, cached ones too", "[brdf]") {
  const BrdfTableOptions options{67, 31, BrdfModel::split_sum, false};
  for (int call = 0; call < 2; ++call) {
    std::vector<double> reports;
    (void)brdf_table(options, {{}, [&](double done) { reports.push_back(done); }});
    REQUIRE(!reports.empty());
    CHECK(std::is_sorted(reports.begin(), reports.end()));
    CHECK(reports.back() == 1.0);
    if (call == 0) CHECK(reports.size() > 10);
  }
}

TEST_CASE("A cancelled BRDF table is not there, and the next call makes it", "[brdf]") {
  const BrdfTableOptions options{251, 127, BrdfModel::split_sum, true};
  std::stop_source source;
  const Control control{source.get_token(), [&](double done) {
                          if (done > 0.3) source.request_stop();
                        }};
  CHECK(thrown_by([&] { (void)brdf_table(options, control); }).code == ErrorCode::cancelled);
  CHECK(thrown_by([&] { (void)brdf_table(options, {source.get_token(), {}}); }).code == ErrorCode::cancelled);
  const auto table = brdf_table(options);
  CHECK(same(*table, *specular::integrated_brdf(options, {})));
  // Also where it is cached.
  CHECK(thrown_by([&] { (void)brdf_table(options, {source.get_token(), {}}); }).code == ErrorCode::cancelled);
}

TEST_CASE("BRDF table sizes out of range are refused", "[brdf]") {
  for (const int edge : {0, -1, 4097, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    CHECK(thrown_by([&] { (void)brdf_table({edge, 64}); }).says("width is " + std::to_string(edge)));
    CHECK(thrown_by([&] { (void)brdf_table({64, edge}); }).says("height is " + std::to_string(edge)));
  }
}

TEST_CASE("Half values are rounded as Imath rounds them", "[brdf]") {
  BrdfTable table;
  for (unsigned bits = 0; bits < 0x7C00U; ++bits) {  // all finite ones, what lies half way to the next, and beside it
    const auto here = Imath::half(Imath::half::FromBits, static_cast<std::uint16_t>(bits));
    const auto next = Imath::half(Imath::half::FromBits, static_cast<std::uint16_t>(bits + 1));
    if (!next.isFinite()) break;
    const float middle = 0.5F * (static_cast<float>(here) + static_cast<float>(next));
    for (const float v :
         {static_cast<float>(here), middle, std::nextafter(middle, 0.0F), std::nextafter(middle, 1e9F)}) {
      table.values.push_back(v);
      table.values.push_back(-v);
    }
  }
  std::mt19937 random(5);
  for (int k = 0; k < 100'000; ++k) {
    const float v = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::abs(v) <= 65504.0F) table.values.push_back(v);
  }
  const std::vector<std::uint16_t> halves = table.half_values();
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < halves.size(); ++k) {
    if (halves[k] != Imath::half(table.values[k]).bits()) ++wrong;
  }
  CHECK(wrong == 0);
  table.values = {65504.0F, 65519.0F, 65520.0F, 1e30F, -1e30F};
  CHECK(table.half_values() == std::vector<std::uint16_t>{0x7BFF, 0x7BFF, 0x7BFF, 0x7BFF, 0xFBFF});
}

}  // namespace welkin::test
