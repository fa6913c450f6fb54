// Promise: what an engine does to its threads' floating-point environment changes no bit of a sky, and raises nothing.
#include <xmmintrin.h>

#include <functional>
#include <vector>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "welkin/sky_harmonics.h"
#include "welkin/sky_reference.h"

namespace welkin::test {
namespace {

constexpr unsigned kUsual = 0x1F80;
constexpr unsigned kFlushing = kUsual | 0x8040;                     // denormals are zero
constexpr unsigned kUpwards = kUsual | 0x4000;                      // rounding
constexpr unsigned kRaising = kUsual & ~(0x80U | 0x200U | 0x400U);  // invalid, by zero, overflow

class Environment {
 public:
  explicit Environment(unsigned csr) : saved_(_mm_getcsr()) { _mm_setcsr(csr); }
  ~Environment() { _mm_setcsr(saved_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  unsigned saved_;
};

using Values = std::vector<glm::dvec3>;

Values coefficients(const SphericalHarmonics& harmonics) {
  return {harmonics.coefficients().begin(), harmonics.coefficients().end()};
}

}  // namespace

TEST_CASE("Skies are the same bits under any floating-point environment", "[sky][view][harmonics]") {
  const Atmosphere air = earth();
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, tiny_tables()));
  const glm::dvec3 sun = sun_direction(3.0, 40.0);
  const glm::dvec3 up = sun_direction(70.0, 10.0);
  const auto of = [](const std::vector<double>& rgb) { return Values{{rgb[0], rgb[1], rgb[2]}}; };
  const std::vector<std::function<Values()>> calls{
      [&] { return Values{SkyView(tables, 7.0).radiance(up, sun)}; },
      [&] {
        return Values{SkyView(tables, 1e6).sun(sun).irradiance, SkyView(tables, 7.0).irradiance(sun)};
      },
      [&] { return coefficients(SkyProjector(SkyView(tables, 7.0)).project(sun)); },
      [&] { return coefficients(SkyProjector(SkyView(tables, 1e6)).project(sun)); },
      [&] { return coefficients(SkyCurve(SkyView(tables, 7.0), {.nodes = 16}).at(sun)); },
      [&] { return Values{SkyCurve(SkyView(tables, 7.0), {.nodes = 16}).sun_irradiance(sun)}; },
      [&] { return of(reference_transmittance(air, 7.0, 0.1)); },
      [&] { return of(reference_sky_radiance(air, 7.0, up, sun)); },
      [&] { return of(reference_sun_irradiance(air, 7.0, sun)); },
      [&] { return of(trace_sky_harmonics(air, 7.0, sun, 2, {.paths = 500}).radiance[1]); },
  };
  for (std::size_t k = 0; k < calls.size(); ++k) {
    const Values expected = calls[k]();
    for (const unsigned csr : {kFlushing, kUpwards, kRaising}) {
      Values found;
      {
        const Environment environment(csr);
        found = calls[k]();
      }
      CAPTURE(k, csr);
      CHECK(same_bytes<glm::dvec3>(found, expected));
    }
  }
}

}  // namespace welkin::test
