// Promises: a colour-preserving clamp takes texels above its maximum down to it, with the ratios of their channels; it
// leaves all others alone, and says how much light it took from which channel.
#include <algorithm>
#include <random>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/test_environments.h"
#include "welkin/projection.h"

namespace welkin::test {

TEST_CASE("A colour-preserving clamp scales texels and reports what it took", "[sh][policy]") {
  std::mt19937 generator(11);
  for (const int size : {1, 3, 7, 64}) {
    for (const float maximum : {0.3F, 10.0F, 4096.0F}) {
      TestCubemap cubemap{size, 3, std::vector<float>(static_cast<std::size_t>(18 * size * size))};
      TestCubemap scaled = cubemap;
      std::uint64_t above = 0;
      for (std::size_t i = 0; i < cubemap.pixels.size(); i += 3) {
        const float scale = static_cast<float>(generator() % 1000) * maximum / 300.0F;
        float brightest = 0.0F;
        for (std::size_t c = i; c < i + 3; ++c) {
          cubemap.pixels[c] = scale * (static_cast<float>(generator() % 1000) / 1000.0F - 0.05F);
          brightest = std::max(brightest, cubemap.pixels[c]);
        }
        above += brightest > maximum ? 1 : 0;
        const double factor = std::min(1.0, static_cast<double>(maximum) / std::max(1e-30F, brightest));
        for (std::size_t c = i; c < i + 3; ++c) {
          scaled.pixels[c] = static_cast<float>(factor * static_cast<double>(cubemap.pixels[c]));
        }
      }
      ProjectionOptions options;
      options.clamp = RadianceClamp{maximum, true};
      const Projection found = project(cubemap.view(), options);
      const Projection expected = project(scaled.view());
      const Projection whole = project(cubemap.view());
      CAPTURE(size, maximum);
      CHECK(found.diagnostics.texels_clamped == above);
      CHECK(relative_error(found.radiance, expected.radiance) < 1e-6);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.diagnostics.flux[c] == Approx(expected.diagnostics.flux[c]).epsilon(1e-6));
        CHECK(found.diagnostics.flux_before_clamp[c] == Approx(whole.diagnostics.flux[c]).epsilon(1e-6));
      }
    }
  }
}

}  // namespace welkin::test
