// `welkin sky` writes air as JSON and reads it; what is wrong with a file is said with its name.
#include <fstream>
#include <limits>

#include "tools/sky_command.h"
#include "tools/temporary_folder.h"

using namespace welkin;
using namespace welkin::test;

namespace {

nlohmann::json printed(const std::string& arguments) {
  const CommandResult result = run_welkin("sky --print-atmosphere " + arguments);
  INFO(result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return nlohmann::json::parse(result.output);
}

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

nlohmann::json same_light(const nlohmann::json& document) {
  return {document.at("radiance"), document.at("sun"), document.at("sky").at("parameters")};
}

}  // namespace

TEST_CASE("sky: air that was printed is read as the same air", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "air.json";
  for (const char* preset : {"earth", "earth-hillaire", "mars", "no-aerosol"}) {
    INFO(preset);
    write(file, printed(std::string("--preset ") + preset).dump());
    CHECK(same_light(sky_json("--atmosphere " + quoted(file))) ==
          same_light(sky_json(std::string("--preset ") + preset)));
  }
  const nlohmann::json air = printed("--ground-albedo 0.3 --wavelengths 615,535,445");
  CHECK(air.at("ground_albedo") == nlohmann::json({0.3, 0.3, 0.3}));
  CHECK(air.at("wavelengths_nm") == nlohmann::json({615.0, 535.0, 445.0}));
  CHECK(air.at("solar_irradiance").get<std::vector<double>>() == earth({615.0, 535.0, 445.0}).solar_irradiance);
  CHECK(printed("--colour srgb").at("wavelengths_nm").size() == 15);
}

TEST_CASE("sky: air from a file can be changed", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "air.json";
  nlohmann::json air = printed("");
  air["aerosol_phase"] = "henyey-greenstein";
  air["name"] = "hazy \xc3\xa4";
  write(file, air.dump());
  const nlohmann::json json = sky_json("--ground-albedo 0.5 --atmosphere " + quoted(file));
  CHECK(json.at("sky").at("atmosphere") == "hazy \xc3\xa4");
  CHECK(json.at("sky").at("parameters").at("aerosol_phase") == "henyey-greenstein");
  CHECK(json.at("sky").at("parameters").at("ground_albedo") == nlohmann::json({0.5, 0.5, 0.5}));
  CHECK(json.at("radiance") != sky_json("--ground-albedo 0.5").at("radiance"));
}

TEST_CASE("sky: air that makes no sense is refused, and the member named", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "air.json";
  const nlohmann::json air = printed("");
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    nlohmann::json changed = air;
    changed[nlohmann::json::json_pointer(pointer)] = value;
    write(file, changed.dump());
    const std::string said = sky_failure("--atmosphere " + quoted(file), 1);
    INFO(said);
    CHECK(contains(said, "air.json: "));
    CHECK(contains(said, message));
  };
  refused("/rayliegh", 1, "\"rayliegh\"");
  refused("/rayleigh/density/0/scale", 1, "rayleigh.density[0] has a member \"scale\"");
  refused("/aerosol_phase", "mie", "aerosol_phase");
  refused("/aerosol_phase", 0, "aerosol_phase");
  refused("/aerosol_asymmetry", "0.8", "aerosol_asymmetry is no number");
  refused("/aerosol_asymmetry", 1.0, "");
  refused("/aerosol", {1, 2}, "aerosol is no object");
  refused("/absorbers", {{"density", 1}}, "absorbers is no list");
  refused("/name", 7, "name is no text");
  refused("/solar_irradiance", {1.0, nullptr, 1.0}, "solar_irradiance[1] is no number");
  refused("/solar_irradiance", {1.0, -1.0, 1.0}, "");
  refused("/solar_irradiance", {1.0, 1.0}, "");
  refused("/rayleigh/scattering_per_m", {-1e-5, 1e-5, 1e-5}, "");
  refused("/bottom_radius_m", -1.0, "");
  refused("/top_radius_m", 6.0e6, "");
  refused("/ground_albedo", {2.0, 0.1, 0.1}, "");
}

TEST_CASE("sky: files that hold no air are refused", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "air.json";
  const auto refused = [&](const std::string& text, const std::string& message) {
    write(file, text);
    const std::string said = sky_failure("--atmosphere " + quoted(file), 1);
    INFO(said);
    CHECK(contains(said, "air.json: "));
    CHECK(contains(said, message));
  };
  refused("", "is no JSON");
  refused("{\"name\": ", "is no JSON");
  refused("{\"bottom_radius_m\": NaN}", "is no JSON");
  refused("{\"bottom_radius_m\": 1e999}", "");
  refused("[]", "no object");
  refused("\xff\xfe", "is no JSON");
  refused(std::string(100000, '['), "nests deeper");
  refused("{\"ground_albedo\": [" + std::string(20000, '0') + "]}", "");
  refused(
      "{\"ground_albedo\": [0" +
          [] {
            std::string text;
            for (int i = 0; i < 5000; ++i) text += ",0";
            return text;
          }() +
          "]}",
      "5001 elements");
  refused(std::string(2 << 20, ' '), "megabyte");
  CHECK(contains(sky_failure("--atmosphere " + quoted(folder.path() / "none.json"), 1), "none.json"));
  CHECK(contains(sky_failure("--atmosphere " + quoted(folder.path()), 1), "directory"));
  CHECK(contains(sky_failure("--atmosphere a.json --preset mars", 2), "--preset"));
}
