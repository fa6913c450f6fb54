// Promise: directions and weights integrate what they should, and what is in closed form is what integrals give.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sky/aerosol_lobe.h"
#include "sky/phase_functions.h"
#include "sky/phase_spectrum.h"
#include "sky/sky_quadrature.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "tables/gauss_legendre.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/sky_harmonics.h"

namespace welkin::test {
namespace {

using std::numbers::pi;

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

}  // namespace

TEST_CASE("weights of a sky's quadratures add up to the sphere", "[sky][harmonics]") {
  for (const double horizon : {0.0, -0.02, -0.136, -0.9}) {
    for (const int zeniths : {2, 3, 7, 16, 33, 128}) {
      CAPTURE(horizon, zeniths);
      for (const SkyQuadrature quadrature : {SkyQuadrature::gauss, SkyQuadrature::gauss_split}) {
        const sky::SkyRule rule = sky::sky_rule({3, quadrature, zeniths, 16}, horizon, 1.0, 0.8);
        CHECK(sum(rule.above.weights) == Approx(1.0 - horizon).epsilon(1e-13));
        CHECK(sum(rule.below.weights) == Approx(1.0 + horizon).epsilon(1e-13));
        for (const double cosine : rule.above.cosines) CHECK(cosine >= horizon);
        for (const double cosine : rule.below.cosines) CHECK(cosine <= horizon);
      }
      const sky::SkyRule article = sky::sky_rule({3, SkyQuadrature::article, zeniths, 16}, horizon, 1.0, 0.8);
      const double midpoint = pi / (2.0 * zeniths) / std::sin(pi / (2.0 * zeniths)) * 2.0;
      CHECK(sum(article.above.weights) + sum(article.below.weights) == Approx(midpoint).epsilon(1e-12));
    }
  }
}

TEST_CASE("clustered azimuths integrate harmonics, for any lobe and number", "[sky][harmonics]") {
  for (const double g : {0.0, 0.5, 0.8, 0.95, 0.999, -0.8, -0.999}) {
    for (const int azimuths : {16, 17, 64, 256}) {
      CAPTURE(g, azimuths);
      const sky::AzimuthRule rule = sky::sky_rule({3, SkyQuadrature::gauss_split, 4, azimuths}, 0.0, 1.0, g).azimuths;
      CHECK(sum(rule.weights) == Approx(2.0 * pi).epsilon(2e-3));
      for (const int order : {1, 2, 4}) {
        double integral = 0.0;
        for (std::size_t i = 0; i < rule.cosines.size(); ++i) {
          CHECK(rule.from_sun[i] == Approx(1.0 - rule.cosines[i]).margin(1e-14));
          CHECK(rule.from_opposite[i] == Approx(1.0 + rule.cosines[i]).margin(1e-14));
          integral += rule.weights[i] * std::cos(order * std::acos(rule.cosines[i]));
        }
        CHECK(std::abs(integral) < 5e-2);
      }
    }
  }
  // At Earth's g, to what the default promises.
  const sky::AzimuthRule rule = sky::sky_rule({}, 0.0, 1.0, 0.8).azimuths;
  double integral = 0.0;
  for (std::size_t i = 0; i < rule.cosines.size(); ++i) integral += rule.weights[i] * rule.cosines[i] * rule.cosines[i];
  CHECK(integral == Approx(pi).epsilon(1e-6));
}

TEST_CASE("Gauss' rules of any order are exact for their degree", "[sky][tables]") {
  for (const int order : {1, 2, 3, 33, 64, 128, 257}) {
    const tables::GaussNodes rule = tables::gauss_nodes(order);
    for (const int degree : {0, order / 2 * 2, 2 * order - 2}) {
      CAPTURE(order, degree);
      double integral = 0.0;
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) integral += rule.weights[k] * std::pow(rule.nodes[k], degree);
      CHECK(integral == Approx(2.0 / (degree + 1)).epsilon(1e-12));
    }
  }
}

TEST_CASE("an aerosol's spectrum is the integral of its phase function", "[sky][harmonics]") {
  const tables::GaussNodes rule = tables::gauss_nodes(128);
  for (const AerosolPhase phase : {AerosolPhase::cornette_shanks, AerosolPhase::henyey_greenstein}) {
    for (const double g : {0.0, 0.3, 0.8, -0.6, 0.95, 0.999}) {
      Atmosphere air = earth();
      air.aerosol_phase = phase;
      air.aerosol_asymmetry = g;
      const auto spectrum = sky::aerosol_moments(air, kMaximumBands);
      for (const int l : {0, 1, 2, 7, 15}) {
        double integral = 0.0;
        double high = 2.0;
        for (int panel = 0; panel < 30; ++panel) {  // towards the lobe, in 1 - nu or 1 + nu
          const double low = panel == 29 ? 0.0 : 0.4 * high;
          for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            const double gap = low + 0.5 * (high - low) * (1.0 + rule.nodes[k]);
            const double nu = g < 0.0 ? gap - 1.0 : 1.0 - gap;
            integral += pi * (high - low) * rule.weights[k] * sky::aerosol_phase(phase, g, nu) *
                        std::legendre(static_cast<unsigned>(l), nu);
          }
          high = low;
        }
        CAPTURE(static_cast<int>(phase), g, l);
        CHECK(spectrum[static_cast<std::size_t>(l)] == Approx(integral).epsilon(1e-7).margin(1e-9));
      }
    }
  }
}

TEST_CASE("harmonics about the vertical are Welkin's, turned", "[sky][harmonics]") {
  constexpr int bands = kMaximumBands;
  std::vector<double> basis(sky::even_count(bands));
  std::vector<glm::dvec3> even(sky::even_count(bands));
  for (const double elevation : {90.0, 71.0, 20.0, 0.0, -33.0, -90.0}) {
    for (const double azimuth : {0.0, 45.0, 133.0, -90.0, 180.0}) {
      CAPTURE(elevation, azimuth);
      // The light of one direction in the sun's vertical plane, but for what is odd about it: nothing.
      const glm::dvec3 direction = sun_direction(elevation, azimuth);
      const sky::SunAngles angles = sky::sun_angles(direction);
      sky::even_basis(angles.zenith_cosine, angles.zenith_sine, bands, basis);
      for (std::size_t k = 0; k < basis.size(); ++k) even[k] = glm::dvec3(basis[k]);
      std::vector<glm::dvec3> turned(bands * bands);
      sky::turn_even(even, bands, angles, turned);
      std::vector<double> expected(bands * bands);
      evaluate_basis(direction, bands, expected);
      for (std::size_t k = 0; k < expected.size(); ++k) CHECK(turned[k].x == Approx(expected[k]).margin(1e-12));
    }
  }
}

TEST_CASE("sky quadratures out of range are refused by name", "[sky][harmonics]") {
  const auto refused = [](SkyHarmonicsOptions options) {
    const ThrownError error = thrown_by([&] { (void)sky::sky_rule(options, 0.0, 1.0, 0.8); });
    CHECK(error.code == ErrorCode::invalid_argument);
    return error.message;
  };
  CHECK(refused({.bands = 0}).find("bands") != std::string::npos);
  CHECK(refused({.bands = 17}).find("1 to 16") != std::string::npos);
  CHECK(refused({.zeniths = 1}).find("zeniths") != std::string::npos);
  CHECK(refused({.zeniths = 129}).find("129") != std::string::npos);
  CHECK(refused({.azimuths = 1}).find("azimuths") != std::string::npos);
  CHECK(refused({.azimuths = 257}).find("257") != std::string::npos);
  CHECK(refused({.quadrature = static_cast<SkyQuadrature>(7)}).find("quadrature 7") != std::string::npos);
}

}  // namespace welkin::test
