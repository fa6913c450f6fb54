// The quadrature of BRDF tables against integration over the light's hemisphere, closed limits and more nodes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "perf/report/brdf_truth.h"
#include "simd/kernels.h"
#include "specular/brdf_quadrature.h"
#include "support/catch.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

using report::BrdfTruth;
using report::ggx_truth;
using report::sheen_truth;

using Sixteen = std::array<float, simd::kLanes>;

/// From the first column of the widest table to the last.
constexpr Sixteen kCosines{0.5F / 4096, 2.0F / 4096, 0.5F / 256, 0.5F / 64,     1.5F / 64, 2.5F / 64,
                           0.086F,      0.13F,       0.2F,       0.35F,         0.5F,      0.65F,
                           0.8F,        0.9F,        63.5F / 64, 4095.5F / 4096};
/// The same for rows, with both sides of where the number of nodes changes.
const std::vector<double> kRoughness{0.5 / 4096, 0.5 / 1024, 0.5 / 256, 0.5 / 64, 1.5 / 64, 0.03, 0.05,
                                     0.07,       0.1,        0.15,      0.2,      0.28,     0.3,  0.349,
                                     0.35,       0.45,       0.5,       0.6,      0.7,      0.85, 1.0 - 0.5 / 4096};

struct Albedos {
  Sixteen whole{};
  Sixteen fresnel{};
  Sixteen sheen{};
};

Albedos albedos(const simd::AlbedoRule& ggx, const simd::AlbedoRule& sheen, double roughness, const Sixteen& cosines,
                InstructionSet set) {
  Albedos result;
  const auto alpha = static_cast<float>(roughness * roughness);
  simd::kernels(set).directional_albedo(ggx, alpha, cosines.data(), result.whole.data(), result.fresnel.data());
  simd::kernels(set).sheen_albedo(sheen, alpha, cosines.data(), result.sheen.data());
  return result;
}

/// As the table's rules give it, for each cosine as if its sixteen began there.
Albedos by_rules(double roughness) {
  const specular::AlbedoRules rules;
  Albedos result;
  for (std::size_t k = 0; k < kCosines.size(); ++k) {
    const Albedos one = albedos(rules.ggx(roughness, kCosines[k]), rules.sheen(roughness), roughness, kCosines,
                                active_instruction_set());
    result.whole[k] = one.whole[k];
    result.fresnel[k] = one.fresnel[k];
    result.sheen[k] = one.sheen[k];
  }
  return result;
}

}  // namespace

TEST_CASE("GGX albedo is the light hemisphere's integral to 1e-5 from grazing to normal view", "[brdf]") {
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
  CHECK(worst > 1e-8);  // in float: anything else compared nothing
}

TEST_CASE("Sheen albedo is the light hemisphere's integral to 1e-5", "[brdf]") {
  for (const double roughness : kRoughness) {
    const Albedos found = by_rules(roughness);
    for (std::size_t k = 0; k < kCosines.size(); ++k) {
      const double truth = sheen_truth(kCosines[k], static_cast<float>(roughness * roughness));
      INFO("roughness " << roughness << " N.V " << kCosines[k] << " truth " << truth << " found " << found.sheen[k]);
      CHECK(std::abs(found.sheen[k] - truth) < 1e-5 * std::max(1.0, truth));
    }
  }
}

TEST_CASE("Twice the nodes change no albedo by 1e-5", "[brdf]") {
  const auto dense_ggx = specular::AlbedoQuadrature::even({20, 20, 32});
  const auto dense_sheen = specular::AlbedoQuadrature::thinning({28, 16, 32});
  const specular::AlbedoRules rules;
  for (int row = 0; row < 97; ++row) {
    const double roughness = (row + 0.5) / 97.0 * (row % 3 == 0 ? 0.3 : 1.0);
    for (int first = 0; first < 129; first += simd::kLanes) {
      Sixteen cosines{};
      for (std::size_t k = 0; k < cosines.size(); ++k) {
        cosines[k] = (static_cast<float>(first) + static_cast<float>(k) + 0.5F) / 144.0F;
      }
      const auto set = active_instruction_set();
      const Albedos few = albedos(rules.ggx(roughness, cosines[0]), rules.sheen(roughness), roughness, cosines, set);
      const Albedos many = albedos(dense_ggx.rule(), dense_sheen.rule(), roughness, cosines, set);
      for (std::size_t k = 0; k < cosines.size(); ++k) {
        INFO("roughness " << roughness << " N.V " << cosines[k]);
        REQUIRE(std::abs(few.whole[k] - many.whole[k]) < 1e-5F);
        REQUIRE(std::abs(few.fresnel[k] - many.fresnel[k]) < 1e-5F);
        REQUIRE(std::abs(few.sheen[k] - many.sheen[k]) < 1e-5F * std::max(1.0F, many.sheen[k]));
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
  // D is 1 / pi and V = 1 / (2 (n.l + n.v)): what is left is Int n.l / (n.l + n.v) d(n.l) over [0, 1].
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

TEST_CASE("Albedo has the same bits on every instruction set", "[brdf]") {
  const specular::AlbedoRules rules;
  for (const double roughness : kRoughness) {
    std::vector<Albedos> found;
    for (const InstructionSet set : available_instruction_sets()) {
      found.push_back(albedos(rules.ggx(roughness, 0.0), rules.sheen(roughness), roughness, kCosines, set));
    }
    for (const Albedos& other : found) CHECK(std::memcmp(&other, &found.front(), sizeof other) == 0);
  }
}

}  // namespace welkin::test
