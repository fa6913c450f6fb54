// Promise: roughness of mips as the named engines have it, and the way back.
#include "welkin/roughness.h"

#include <cmath>

#include "support/catch.h"
#include "support/thrown_error.h"

namespace welkin::test {

TEST_CASE("Schedules are those of their engines", "[specular][roughness]") {
  const auto linear = roughness_of_mips(RoughnessSchedule::linear, 10, 512);
  const auto filament = roughness_of_mips(RoughnessSchedule::filament, 10, 512);
  const auto babylon = roughness_of_mips(RoughnessSchedule::babylon, 10, 512);
  for (int mip = 0; mip < 10; ++mip) {
    CAPTURE(mip);
    const auto i = static_cast<std::size_t>(mip);
    CHECK(linear[i] == Approx(mip / 9.0));
    CHECK(filament[i] == Approx(1.0 - std::sqrt(1.0 - mip / 9.0)));
    // CONVENTIONS: alpha = 2^(lod / 0.8) / width, 0 at mip 0
    const double alpha = mip == 0 ? 0.0 : std::min(1.0, std::pow(2.0, mip / 0.8) / 512.0);
    CHECK(babylon[i] == Approx(std::sqrt(alpha)));
  }
}

TEST_CASE("Every table starts at 0 and rises", "[specular][roughness]") {
  for (const auto schedule : {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon}) {
    for (const int size : {1, 2, 256, 4096}) {
      for (int mips = 1; mips <= 16; ++mips) {
        const auto table = roughness_of_mips(schedule, mips, size);
        REQUIRE(table.size() == static_cast<std::size_t>(mips));
        CHECK(table[0] == 0.0);
        for (std::size_t k = 1; k < table.size(); ++k) CHECK((table[k] >= table[k - 1] && table[k] <= 1.0));
      }
    }
  }
}

TEST_CASE("A shader's look-up finds the roughness that a mip has", "[specular][roughness]") {
  for (const auto schedule : {RoughnessSchedule::linear, RoughnessSchedule::filament}) {
    const auto table = roughness_of_mips(schedule, 9, 256);
    for (std::size_t mip = 0; mip < table.size(); ++mip)
      CHECK(mip_of_roughness(table, table[mip]) == Approx(static_cast<double>(mip)).margin(1e-12));
    CHECK(mip_of_roughness(table, 0.5 * (table[3] + table[4])) == Approx(3.5));
    CHECK(mip_of_roughness(table, -1.0) == 0.0);
    CHECK(mip_of_roughness(table, 2.0) == 8.0);
  }
  CHECK(mip_of_roughness({0.0, 0.5, 1.0, 1.0}, 1.0) == 2.0);  // Babylon's last mips are alike
}

TEST_CASE("What is no schedule is refused", "[specular][roughness]") {
  CHECK(thrown_by([] { (void)roughness_of_mips(RoughnessSchedule::linear, 0, 4); }).says("mips"));
  CHECK(thrown_by([] { (void)roughness_of_mips(RoughnessSchedule::linear, 17, 4); }).says("mips"));
  CHECK(thrown_by([] { (void)roughness_of_mips(RoughnessSchedule::linear, 1, 0); }).says("size"));
  CHECK(thrown_by([] { (void)mip_of_roughness({}, 0.5); }).says("empty"));
  CHECK(thrown_by([] { (void)mip_of_roughness({0.0, 0.6, 0.5}, 0.5); }).says("falls at mip 2"));
  CHECK(std::string(name(RoughnessSchedule::filament)) == "filament");
}

}  // namespace welkin::test
