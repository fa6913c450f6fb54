// A small sky for reflections.
#include <cmath>
#include <cstddef>

#include "sky/sky_tables_for_tests.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/sky_view.h"
#include "welkin/specular.h"

namespace welkin::test {

TEST_CASE("sky specular: it is the sky's cubemap, prefiltered", "[sky][view][specular]") {
  const SkyView view(small_view_tables(), 0.0);
  const glm::dvec3 sun = sun_direction(25.0, 40.0);
  PrefilterOptions options;
  options.size = 16;
  for (const bool disc : {false, true}) {
    const PrefilteredSpecular found = sky_specular(view, sun, options, {.sun_disc = disc});
    const CubemapImage sky = sky_cubemap(view, sun, 16, {.sun_disc = disc});
    const PrefilteredSpecular expected = prefilter_specular(sky.view(), options);
    REQUIRE(found.cubemap.levels() == expected.cubemap.levels());
    bool same = true;
    bool sound = true;
    for (int level = 0; level < found.cubemap.levels(); ++level) {
      const auto count =
          static_cast<std::size_t>(3 * found.cubemap.level_size(level) * found.cubemap.level_size(level));
      for (int face = 0; face < 6; ++face) {
        for (std::size_t i = 0; i < count; ++i) {
          const float value = found.cubemap.face(level, face)[i];
          same = same && value == expected.cubemap.face(level, face)[i];
          sound = sound && std::isfinite(value) && value >= 0.0F;
        }
      }
    }
    CHECK(same);
    CHECK(sound);
  }
  options.size = 0;
  CHECK(thrown_by([&] { static_cast<void>(sky_specular(view, sun, options)); }).code == ErrorCode::invalid_argument);
}

}  // namespace welkin::test
