// BRDF tables: the quadrature behind them, their layout, options, cache and errors.

#include "perf/report/passes.h"
#include "reflections/brdf_kernels.h"
#include "reflections/brdf_table.h"
#include "simd/dispatch.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {

// Checks the quadrature of BRDF tables against integration over the light's hemisphere, closed limits and more nodes.

namespace {

using report::BrdfTruth;
using report::ggx_truth;
using report::sheen_truth;

using Sixteen = std::array<float, simd::kLanes>;

/// Cosines from the first column of the widest table to the last.
constexpr Sixteen kCosines{0.5F / 4096, 2.0F / 4096, 0.5F / 256, 0.5F / 64,     1.5F / 64, 2.5F / 64,
                           0.086F,      0.13F,       0.2F,       0.35F,         0.5F,      0.65F,
                           0.8F,        0.9F,        63.5F / 64, 4095.5F / 4096};
/// Roughness of rows, on both sides of each change in the number of nodes.
const std::vector<double> kRoughness{0.5 / 4096, 0.5 / 1024, 0.5 / 256, 0.5 / 64, 1.5 / 64, 0.03, 0.05,
                                     0.07,       0.1,        0.15,      0.199,    0.2,      0.24, 0.26,
                                     0.35,       0.49,       0.5,       0.6,      0.7,      0.85, 1.0 - 0.5 / 4096};

struct Albedos {
  Sixteen whole{};
  Sixteen fresnel{};
  Sixteen sheen{};
};

Albedos albedos(const reflections::AlbedoRule& ggx, const reflections::AlbedoRule& sheen, double roughness,
                const Sixteen& cosines) {
  Albedos result;
  const auto& kernels = reflections::brdf_kernels();
  const auto alpha = static_cast<float>(roughness * roughness);
  kernels.directional_albedo(ggx, alpha, cosines.data(), result.whole.data(), result.fresnel.data());
  kernels.sheen_albedo(sheen, alpha, cosines.data(), result.sheen.data());
  return result;
}

/// Returns the albedos by the table's quadrature rules.
Albedos by_rules(double roughness) {
  const reflections::AlbedoRules rules;
  return albedos(rules.ggx(roughness), rules.sheen(roughness), roughness, kCosines);
}

}  // namespace

TEST_CASE("GGX albedo is the light hemisphere's integral to 1e-5 from grazing to normal view", "[brdf][truth]") {
  double worst = 0.0;
  for (const double roughness : kRoughness) {
    const Albedos found = by_rules(roughness);
    const double alpha = static_cast<float>(roughness * roughness);
    for (std::size_t k = 0; k < kCosines.size(); ++k) {
      const BrdfTruth truth = ggx_truth(kCosines[k], alpha);
      const double error =
          std::max(std::abs(found.fresnel[k] - truth.bias), std::abs(found.whole[k] - found.fresnel[k] - truth.scale));
      INFO("roughness " << roughness << " N.V " << kCosines[k] << " error " << error);
      CHECK(error < 1e-5);
      worst = std::max(worst, error);
    }
  }
  CHECK(worst > 1e-8);  // computed in float: a smaller difference would mean that nothing was compared
}

TEST_CASE("Sheen albedo is the light hemisphere's integral to 1e-5", "[brdf][truth]") {
  for (const double roughness : kRoughness) {
    const Albedos found = by_rules(roughness);
    for (std::size_t k = 0; k < kCosines.size(); ++k) {
      const double truth = sheen_truth(kCosines[k], static_cast<float>(roughness * roughness));
      INFO("roughness " << roughness << " N.V " << kCosines[k] << " truth " << truth << " found " << found.sheen[k]);
      CHECK(std::abs(found.sheen[k] - truth) < 1e-5 * std::max(1.0, truth));
    }
  }
}

TEST_CASE("BRDF tables of any size are within 1e-5 of twice the nodes at each texel", "[brdf]") {
  const reflections::AlbedoQuadrature dense_ggx({20, 20, 32}, reflections::AlbedoQuadrature::Radii::even);
  const reflections::AlbedoQuadrature dense_sheen({28, 16, 32}, reflections::AlbedoQuadrature::Radii::thinning);
  for (const auto& [width, height] :
       std::vector<std::pair<int, int>>{{17, 16}, {33, 70}, {64, 64}, {256, 19}, {257, 40}, {4096, 3}, {20, 1024}}) {
    const auto table = brdf_table({width, height, BrdfModel::multiple_scattering, true});
    for (int row = 0; row<height; row += height> 100 ? 7 : 1) {
      const double roughness = (row + 0.5) / height;
      for (int first = 0; first<width; first += width> 1000 && first > 200 ? 400 : simd::kLanes) {
        Sixteen cosines{};
        for (int k = 0; k < simd::kLanes; ++k)
          cosines[static_cast<std::size_t>(k)] =
              (static_cast<float>(std::min(first + k, width - 1)) + 0.5F) / static_cast<float>(width);
        const Albedos truth = albedos(dense_ggx.rule(), dense_sheen.rule(), roughness, cosines);
        for (int k = 0; k < std::min(simd::kLanes, width - first); ++k) {
          const auto at = static_cast<std::size_t>(k);
          const float* const texel = table->values.data() + 3 * (std::ptrdiff_t{row} * width + first + k);
          const auto near = [](float found, float wanted, float scale) {
            return std::abs(found - wanted) < 1e-5F * scale;
          };
          const bool right = near(texel[0], truth.fresnel[at], 1.0F) && near(texel[1], truth.whole[at], 1.0F) &&
                             near(texel[2], truth.sheen[at], std::max(1.0F, truth.sheen[at])) && texel[0] >= 0.0F &&
                             texel[2] >= 0.0F;
          if (!right) FAIL_CHECK(width << " x " << height << " texel " << first + k << ", " << row);
        }
      }
    }
  }
}

TEST_CASE("A mirror's albedo is Schlick's Fresnel", "[brdf]") {
  const Albedos found = by_rules(0.5 / 4096);
  for (std::size_t k = 0; k < kCosines.size(); ++k) {
    INFO("N.V " << kCosines[k]);
    CHECK(std::abs(found.whole[k] - 1.0) < 1e-5);
    CHECK(std::abs(found.fresnel[k] - std::pow(1.0 - kCosines[k], 5.0)) < 1e-5);
  }
}

TEST_CASE("At roughness 1 the whole albedo is 1 - N.V log(1 + 1 / N.V)", "[brdf]") {
  // D is 1 / pi and V = 1 / (2 (n.l + n.v)), which leaves Int n.l / (n.l + n.v) d(n.l) over [0, 1].
  const Albedos found = by_rules(1.0);
  for (std::size_t k = 0; k < kCosines.size(); ++k) {
    const double cosine = kCosines[k];
    CHECK(std::abs(found.whole[k] - (1.0 - cosine * std::log1p(1.0 / cosine))) < 1e-5);
  }
}

TEST_CASE("No surface sends back more than it gets", "[brdf]") {
  for (const double roughness : kRoughness) {
    const Albedos found = by_rules(roughness);
    for (std::size_t k = 0; k < kCosines.size(); ++k) {
      INFO("roughness " << roughness << " N.V " << kCosines[k]);
      CHECK(found.whole[k] <= 1.0F + 1e-6F);
      CHECK(found.fresnel[k] >= 0.0F);
      CHECK(found.fresnel[k] <= found.whole[k]);
      CHECK(found.sheen[k] >= 0.0F);
    }
  }
}

// Layout, options, cache and errors of BRDF tables.

namespace {

float value(const BrdfTable& table, int column, int row, int channel) {
  return table.values[static_cast<std::size_t>((row * table.options.width + column) * table.channels + channel)];
}

bool same(const BrdfTable& a, const BrdfTable& b) {
  return a.options == b.options && same_bytes<float>(a.values, b.values);
}

}  // namespace

TEST_CASE("Each texel of a BRDF table is at its own angle and roughness", "[brdf]") {
  const int sizes[][2] = {{1, 1},  {2, 3},  {7, 5},  {15, 2},  {16, 2},   {17, 2},
                          {63, 3}, {64, 4}, {65, 3}, {257, 2}, {4096, 1}, {1, 4096}};
  for (const auto& [width, height] : sizes) {
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
  const auto once = reflections::integrated_brdf(options, {});
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 3, 8}) {
      run_with_threads(threads, [&] { CHECK(same(*once, *reflections::integrated_brdf(options, {}))); });
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
  stop_source source;
  const Control control{source.get_token(), [&](double done) {
                          if (done > 0.3) source.request_stop();
                        }};
  CHECK(thrown_by([&] { (void)brdf_table(options, control); }).code == ErrorCode::cancelled);
  CHECK(thrown_by([&] { (void)brdf_table(options, {source.get_token(), {}}); }).code == ErrorCode::cancelled);
  const auto table = brdf_table(options);
  CHECK(same(*table, *reflections::integrated_brdf(options, {})));
  // A cached table is cancelled, too.
  CHECK(thrown_by([&] { (void)brdf_table(options, {source.get_token(), {}}); }).code == ErrorCode::cancelled);
}

TEST_CASE("BRDF table sizes out of range are refused", "[brdf]") {
  for (const int edge : {0, -1, 4097, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    CHECK(thrown_by([&] { (void)brdf_table({edge, 64}); }).says("width is " + std::to_string(edge)));
    CHECK(thrown_by([&] { (void)brdf_table({64, edge}); }).says("height is " + std::to_string(edge)));
  }
}

}  // namespace welkin::test
