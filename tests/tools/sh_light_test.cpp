// `welkin sh` and what is done with the light: windows, the sun, the dominant light, the error of irradiance.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "support/catch.h"
#include "tools/command.h"
#include "tools/pfm_file.h"
#include "tools/temporary_folder.h"

using namespace welkin::test;

namespace {

glm::dvec3 triple(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

}  // namespace

TEST_CASE("sh: a window damps the bands, and says what it did to the least irradiance", "[tools]") {
  const nlohmann::json plain = run_sh_json("");
  CHECK(plain.at("window").at("name") == "none");
  for (const char* window : {"hanning", "lanczos", "least"}) {
    INFO(window);
    const nlohmann::json json = run_sh_json(std::string("--window ") + window);
    const auto& factors = json.at("window").at("factors");
    REQUIRE(factors.size() == 3);
    CHECK(factors.at(0) == 1.0);
    for (std::size_t i = 0; i < 9; ++i) {
      const double factor = factors.at(i == 0 ? 0 : i < 4 ? 1 : 2).get<double>();
      CHECK(glm::length(triple(json.at("radiance").at(i)) - factor * triple(plain.at("radiance").at(i))) < 1e-12);
    }
    CHECK(triple(json.at("window").at("minimum_irradiance_before")) ==
          triple(plain.at("window").at("minimum_irradiance_before")));
    CHECK(json.at("window").contains("minimum_irradiance_after"));
  }
  CHECK(contains(run_welkin("sh --window least").output, "after it (least"));
  CHECK(run_welkin("sh --window-width 0").exit_code == 2);
}

TEST_CASE("sh: the built-in sky's sun is taken out and what is left is darker by it", "[tools]") {
  const nlohmann::json json = run_sh_json("--take-out-sun");
  REQUIRE(json.at("sun").is_object());
  const glm::dvec3 direction = triple(json.at("sun").at("direction"));
  CHECK(direction.y == Approx(std::sin(40.0 / 180.0 * std::acos(-1.0))).margin(0.01));
  const nlohmann::json whole = run_sh_json("");
  const glm::dvec3 lost = triple(whole.at("diagnostics").at("flux")) - triple(json.at("diagnostics").at("flux"));
  const glm::dvec3 sun = triple(json.at("sun").at("irradiance"));
  CHECK(glm::length(lost - sun) < 1e-6 * glm::length(triple(whole.at("diagnostics").at("flux"))));
  CHECK(contains(run_welkin("sh --take-out-sun").output, "Sun, taken out"));
}

TEST_CASE("sh: the sun turns with the light", "[tools]") {
  const glm::dvec3 before = triple(run_sh_json("--take-out-sun").at("sun").at("direction"));
  const glm::dvec3 after = triple(run_sh_json("--take-out-sun --yaw 90").at("sun").at("direction"));
  CHECK(glm::length(after - glm::dvec3(before.z, before.y, -before.x)) < 1e-12);
}

TEST_CASE("sh: the dominant light of a sunny sky points at its sun", "[tools]") {
  const nlohmann::json json = run_sh_json("");
  CHECK(triple(json.at("dominant_light").at("direction")).y > 0.3);
}

TEST_CASE("sh: where z is up, directions are told so", "[tools]") {
  const std::string text = run_welkin("sh --take-out-sun --for unreal").output;
  CHECK(contains(text, "degrees up"));
  CHECK(contains(text, "degrees from +x towards"));
  CHECK_FALSE(contains(text, "+z towards"));
  CHECK_FALSE(contains(text, "y is up"));
}

TEST_CASE("sh: a sun that overflowed to infinity is taken out too", "[tools]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "overflow.pfm";
  std::vector<float> pixels = grey_picture(64, 32, 0.5F);
  for (std::size_t k = 0; k < 3; ++k) pixels[3 * (10 * 64 + 20) + k] = std::numeric_limits<float>::infinity();
  write_pfm(file, 64, 32, pixels);
  const nlohmann::json json = run_sh_json(quoted(file) + " --take-out-sun");
  CHECK(json.at("sun").is_object());
  CHECK(json.at("diagnostics").at("infinities_replaced") == 3);
  CHECK(run_welkin("sh --take-out-sun --gamma").exit_code == 2);
}

TEST_CASE("sh: a window leaves the dominant light as it is", "[tools]") {
  const nlohmann::json plain = run_sh_json("");
  CHECK(run_sh_json("--window hanning").at("dominant_light") == plain.at("dominant_light"));
}

TEST_CASE("sh: the error of the irradiance falls with the bands", "[tools]") {
  const nlohmann::json json = run_sh_json("--irradiance-error --bands 3");
  const auto& errors = json.at("irradiance_errors");
  REQUIRE(errors.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(errors.at(i).at("bands") == i + 1);
  CHECK(errors.at(2).at("rms").get<double>() < 0.2 * errors.at(0).at("rms").get<double>());
  CHECK(errors.at(0).at("maximum").get<double>() >= errors.at(0).at("rms").get<double>());
}

TEST_CASE("convert: the map without its sun, plus the sun that is reported, is the map", "[tools][convert]") {
  const TemporaryFolder folder;
  const auto sky = folder.path() / "sky.pfm";
  const auto rest = folder.path() / "rest.pfm";
  std::vector<float> pixels = grey_picture(128, 64, 0.5F);
  for (const std::size_t texel : {20 * 128 + 40, 20 * 128 + 41, 21 * 128 + 40, 21 * 128 + 41}) {
    for (std::size_t k = 0; k < 3; ++k) pixels[3 * texel + k] = 5000.0F + 700.0F * static_cast<float>(k);
  }
  write_pfm(sky, 128, 64, pixels);
  const CommandResult result =
      run_welkin("convert " + quoted(sky) + " " + quoted(rest) + " --take-out-sun --sun-radius 10");
  INFO(result.errors);
  REQUIRE(result.exit_code == 0);
  CHECK(contains(result.output, "Sun, taken out"));
  const nlohmann::json whole = run_sh_json(quoted(sky) + " --take-out-sun --sun-radius 10");
  REQUIRE(whole.at("sun").is_object());
  const glm::dvec3 flux = triple(run_sh_json(quoted(sky)).at("diagnostics").at("flux"));
  const glm::dvec3 left = triple(run_sh_json(quoted(rest)).at("diagnostics").at("flux"));
  const glm::dvec3 sun = triple(whole.at("sun").at("irradiance"));
  CHECK(glm::length(flux - left - sun) < 1e-6 * glm::length(flux));
  CHECK(glm::length(left - triple(whole.at("diagnostics").at("flux"))) < 1e-9 * glm::length(flux));
  CHECK(run_welkin("convert " + quoted(sky) + " " + quoted(rest) + " --sun-radius 10").exit_code == 2);
}
