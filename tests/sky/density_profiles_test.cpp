// Densities are their layers' formulas, from 0 to 1 whatever the formulas do, and every kink is known.
#include <cmath>
#include <vector>

#include "sky/density.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"

namespace welkin {

TEST_CASE("sky: densities are their formulas, layer by layer", "[sky][air]") {
  const std::vector<DensityLayer> exponential = exponential_profile(8000.0);
  CHECK(sky::density(exponential, 0.0) == 1.0);
  CHECK(sky::density(exponential, -5.0) == 1.0);
  CHECK(sky::density(exponential, 16'000.0) == Approx(std::exp(-2.0)).epsilon(1e-14));
  const std::vector<DensityLayer> tent = tent_profile(25'000.0, 15'000.0);
  for (double h = 0.0; h < 60'000.0; h += 500.0) {
    CHECK(sky::density(tent, h) == Approx(std::max(0.0, 1.0 - std::abs(h - 25'000.0) / 15'000.0)).margin(1e-14));
  }
  const std::vector<DensityLayer> slabs{{.thickness_m = 100.0, .constant_term = 0.25},
                                        {.thickness_m = 0.0, .constant_term = 0.5},
                                        {.thickness_m = 50.0, .constant_term = 7.0},
                                        {.constant_term = -1.0}};
  CHECK(sky::density(slabs, 99.999) == 0.25);
  CHECK(sky::density(slabs, 100.0) == 1.0);
  CHECK(sky::density(slabs, 150.0) == 0.0);
  CHECK(sky::density({}, 10.0) == 0.0);
}

TEST_CASE("sky: formulas that overflow are clamped like others", "[sky][air]") {
  CHECK(sky::density(std::vector<DensityLayer>{{.exponential_term = 1.0, .exponential_scale_per_m = 1.0}}, 1e6) == 1.0);
  CHECK(sky::density(std::vector<DensityLayer>{{.exponential_term = -1.0, .exponential_scale_per_m = 1.0}}, 1e6) ==
        0.0);
  CHECK(sky::density(std::vector<DensityLayer>{{.exponential_scale_per_m = 1.0, .constant_term = 0.5}}, 1e6) == 0.5);
}

TEST_CASE("sky: between its breaks a density is smooth", "[sky][air]") {
  CHECK(sky::density_breaks(exponential_profile(8000.0), 60'000.0).empty());
  const std::vector<double> tent = sky::density_breaks(tent_profile(25'000.0, 15'000.0), 60'000.0);
  REQUIRE(tent.size() == 3);
  CHECK(tent[0] == Approx(10'000.0));
  CHECK(tent[1] == 25'000.0);
  CHECK(tent[2] == Approx(40'000.0));

  // Two thirds of an interval's ends differ from their chord by no more than curvature explains: a hidden kink would.
  test::RandomAtmospheres random(11);
  int kinks = 0;
  for (int i = 0; i < 1000; ++i) {
    const Atmosphere air = random.next();
    const double thickness = air.top_radius_m - air.bottom_radius_m;
    std::vector<double> ends = sky::density_breaks(air.rayleigh.density, thickness);
    kinks += static_cast<int>(ends.size());
    ends.insert(ends.begin(), 0.0);
    ends.push_back(thickness);
    for (std::size_t k = 1; k < ends.size(); ++k) {
      REQUIRE(ends[k] > ends[k - 1]);
      // Inside, it is all 0, all 1 or neither.
      const double width = ends[k] - ends[k - 1];
      int kind[3] = {0, 0, 0};
      for (int p = 1; p < 100; ++p) {
        const double value = sky::density(air.rayleigh.density, ends[k - 1] + width * p / 100.0);
        ++kind[value == 0.0 ? 0 : value == 1.0 ? 1 : 2];
      }
      // (An exponential may round to 0 or 1 far from its kink.)
      const bool one_kind = (kind[0] > 0) + (kind[1] > 0) + (kind[2] > 0) == 1;
      const double first = sky::density(air.rayleigh.density, ends[k - 1] + 0.01 * width);
      const double last = sky::density(air.rayleigh.density, ends[k - 1] + 0.99 * width);
      const bool rounded = first < 1e-300 || last < 1e-300 || first > 1.0 - 1e-12 || last > 1.0 - 1e-12;
      REQUIRE((one_kind || rounded));
    }
  }
  CHECK(kinks > 500);
}

}  // namespace welkin
