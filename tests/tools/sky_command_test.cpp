#include "tools/command.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

using namespace welkin;
using namespace welkin::test;

// `welkin sky --json` is what `welkin sh --json` is, and holds every digit of what the library computes. Tables are
// small ones, quickly made.

namespace {

const std::string kSmallSky = "--table-size 4,16,8,4 --orders 2 ";

SkyTableOptions small_sky_options() {
  return {.heights = 4, .view_zeniths = 16, .sun_zeniths = 8, .sun_angles = 4, .orders = 2};
}

std::shared_ptr<const SkyTables> small_sky() {
  return std::make_shared<const SkyTables>(precompute_sky(earth(), small_sky_options()));
}

/// Runs `welkin sky --json` with small tables and more arguments, requires success and silence; the JSON.
nlohmann::json sky_json(const std::string& arguments) { return json_printed_by("sky --json " + kSmallSky + arguments); }

std::string sky_failure(const std::string& arguments, int exit_code) { return failure("sky " + arguments, exit_code); }

glm::dvec3 rgb_of(const nlohmann::json& value) {
  REQUIRE(value.is_array());
  REQUIRE(value.size() == 3);
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

void require_coefficients(const nlohmann::json& list, const SphericalHarmonics& expected) {
  REQUIRE(list.size() == expected.coefficients().size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    INFO("coefficient " << i);
    CHECK(rgb_of(list.at(i)) == expected.coefficients()[i]);
  }
}

SphericalHarmonics harmonics_of(const nlohmann::json& list, int bands) {
  SphericalHarmonics harmonics(bands);
  for (int l = 0; l < bands; ++l) {
    for (int m = -l; m <= l; ++m) harmonics.at(l, m) = rgb_of(list.at(static_cast<std::size_t>(l * (l + 1) + m)));
  }
  return harmonics;
}

double relative_difference(const nlohmann::json& a, const SphericalHarmonics& b) {
  double difference = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < b.coefficients().size(); ++i) {
    difference = std::max(difference, glm::length(rgb_of(a.at(i)) - b.coefficients()[i]));
    power = std::max(power, glm::length(b.coefficients()[i]));
  }
  return difference / power;
}

}  // namespace

TEST_CASE("sky --date: the sun stands where sun_position has it", "[tools][sky][sun_position]") {
  const SunPosition berlin = sun_position("2026-06-21T18:30Z", {.latitude_degrees = 52.5, .longitude_degrees = 13.4});
  const nlohmann::json sky = sky_json("--date 2026-06-21T20:30+02:00 --at 52.5,13.4");
  CHECK(sky.at("sky").at("sun_elevation_degrees").get<double>() == berlin.elevation_degrees);
  CHECK(sky.at("sky").at("sun_azimuth_degrees").get<double>() == berlin.azimuth_degrees);
  CHECK(rgb_of(sky.at("sun").at("direction")) == berlin.direction);
  CHECK(sky.at("sky").at("sun_by_date").at("compass_degrees").get<double>() == berlin.compass_degrees);
  const SunObserver south{
      .latitude_degrees = -33.9, .longitude_degrees = -151.2, .north_azimuth_degrees = 10.0, .refraction = true};
  const SunPosition raised = sun_position("2026-06-21T18:30Z", south);
  const nlohmann::json seen = sky_json("--date 2026-06-21T18:30Z --at -33.9,-151.2 --north 10 --refraction");
  CHECK(rgb_of(seen.at("sun").at("direction")) == raised.direction);
  CHECK(seen.at("sky").at("sun_by_date").at("refraction_degrees").get<double>() == raised.refraction_degrees);
  CHECK(sky_json("--sun-elevation 20").at("sky").at("sun_by_date").is_null());
}

TEST_CASE("sky --json: the library's light to the last bit", "[tools][sky][slow]") {
  struct Case {
    const char* arguments;
    double elevation, azimuth, altitude;
    SkyHarmonicsOptions options;
  };
  SkyHarmonicsOptions uniform;
  uniform.quadrature = SkyQuadrature::uniform;
  SkyHarmonicsOptions coarse{.bands = 2, .quadrature = SkyQuadrature::gauss, .zeniths = 8, .azimuths = 9};
  const auto tables = small_sky();
  for (const Case& each : {Case{"--sun-elevation 20", 20.0, 0.0, 0.0, {}},
                           Case{"--sun-elevation -4 --sun-azimuth 115", -4.0, 115.0, 0.0, {}},
                           Case{"--sun-elevation 60 --altitude 8000 --quadrature uniform", 60.0, 0.0, 8000.0, uniform},
                           Case{"--sun-elevation 3 --quadrature gauss --directions 8,9 --bands 2", 3, 0, 0, coarse}}) {
    INFO(each.arguments);
    const nlohmann::json json = sky_json(each.arguments);
    const SkyView view(tables, each.altitude);
    const glm::dvec3 sun = sun_direction(each.elevation, each.azimuth);
    const SkyProjector projector(view, each.options);
    const SphericalHarmonics radiance = projector.project(sun);
    require_coefficients(json.at("radiance"), radiance);
    require_coefficients(json.at("irradiance"), irradiance_from_radiance(radiance));
    CHECK(json.at("diagnostics").at("texels") == projector.directions());
    const Sun light = view.sun_light(sun);
    CHECK(rgb_of(json.at("sun").at("direction")) == light.direction);
    CHECK(rgb_of(json.at("sun").at("irradiance")) == light.irradiance);
    CHECK(rgb_of(json.at("sun").at("radiance")) == light.radiance);
    CHECK(json.at("sun").at("solid_angle") == light.solid_angle);
    CHECK(rgb_of(json.at("sky").at("sky_irradiance")) == view.irradiance(sun));
    if (each.options.bands >= 3) {
      CHECK(rgb_of(json.at("babylon").at("zx")) == babylon_polynomial(radiance).zx);
    }
  }
}

TEST_CASE("sky: light and sun are given in the engine's axes", "[tools][sky][slow]") {
  const nlohmann::json welkin_axes = sky_json("--sun-elevation 12 --sun-azimuth 30");
  for (const Engine engine : {Engine::unreal, Engine::unity, Engine::three}) {
    const Convention& of = convention(engine);
    const nlohmann::json json = sky_json("--sun-elevation 12 --sun-azimuth 30 --for " + std::string(of.name));
    INFO(of.name);
    CHECK(json.at("axes").at("engine") == of.name);
    const SphericalHarmonics expected = rotate(harmonics_of(welkin_axes.at("radiance"), 3), of.from_welkin);
    CHECK(relative_difference(json.at("radiance"), expected) < 1e-12);
    CHECK(glm::length(rgb_of(json.at("sun").at("direction")) -
                      of.from_welkin * rgb_of(welkin_axes.at("sun").at("direction"))) < 1e-14);
    CHECK(json.at("engine").at("name") == of.name);
  }
}

TEST_CASE("sky: each option reaches the tables", "[tools][sky][slow]") {
  const nlohmann::json plain = sky_json("--sun-elevation 20");
  const auto check = [&](const std::string& arguments, const Atmosphere& atmosphere, SkyTableOptions options) {
    INFO(arguments);
    const nlohmann::json json = sky_json("--sun-elevation 20 " + arguments);
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(atmosphere, options));
    const SphericalHarmonics expected = SkyProjector(SkyView(tables, 0.0)).project(sun_direction(20.0, 0.0));
    require_coefficients(json.at("radiance"), expected);
    CHECK(json.at("radiance") != plain.at("radiance"));
    return json;
  };
  const SkyTableOptions small = small_sky_options();
  check("--ground-albedo 0.7", with_ground_albedo(earth(), 0.7), small);
  Atmosphere at_night = earth();
  at_night.night_zenith_luminance = kDarkNightZenithLuminance;
  check("--night 2e-4", at_night, small);
  check("--preset no-aerosol", without_aerosol(earth()), small);
  check("--preset earth-hillaire", earth_hillaire(), small);
  const std::vector<double> rgb{680.0, 550.0, 440.0};
  CHECK(sky_json("--sun-elevation 20 --preset clear").at("radiance") == plain.at("radiance"));
  check("--preset hazy", earth(rgb, AerosolKind::hazy), small);
  check("--preset dusty", earth(rgb, AerosolKind::dusty), small);
  check("--preset polluted", earth(rgb, AerosolKind::polluted), small);
  check("--preset earth-bruneton", earth_bruneton(), small);
  check("--preset earth --aerosol 0.25", with_aerosol(earth(), {.optical_depth = 0.25}), small);
  check("--preset mars", mars(), small);
  check("--wavelengths 615,535,445", earth({615.0, 535.0, 445.0}), small);
  SkyTableOptions options = small;
  options.layout = ScatteringLayout::compact;
  check("--layout compact", earth(), options);
  CHECK(sky_json("--sun-elevation 20 --convergence-threshold 0.9").at("sky").at("tables").at("convergence_threshold") ==
        0.9);
  options = small;
  options.truncate_orders = true;
  CHECK(check("--truncate-orders", earth(), options).at("sky").at("tables").at("truncate_orders") == true);
  options = small;
  options.colour = SkyColour::linear_srgb;
  const nlohmann::json colours =
      check("--colour srgb --wavelengths 450,500,550,600,650", earth({450.0, 500.0, 550.0, 600.0, 650.0}), options);
  CHECK(colours.at("sky").at("unit") == "cd/m2, linear sRGB");
  const nlohmann::json air_only = sky_json("--sun-elevation 20 --no-ground");
  CHECK(rgb_of(air_only.at("radiance").at(0)).x < rgb_of(plain.at("radiance").at(0)).x);
}

// `welkin sky`: what cannot be is refused with exit code 2 and the option's name, before any work.

TEST_CASE("sky: numbers out of range are refused by name, and options that do not go together", "[tools][sky][slow]") {
  check_refused("sky", {{"--sun-elevation", {"90.001", "-91", "nan", "inf", "up"}},
                        {"--sun-azimuth", {"nan", "inf"}},
                        {"--altitude", {"-1", "nan", "2e9"}},
                        {"--orders", {"0", "65", "1.5"}},
                        {"--ground-albedo", {"-0.1", "1.1", "nan"}},
                        {"--convergence-threshold", {"-1", "nan"}},
                        {"--colour", {"rgb"}},
                        {"--layout", {"4d"}},
                        {"--table-size", {"32,128", "1,2,3,4,5", "a,b,c"}},
                        {"--quadrature", {"monte-carlo"}},
                        {"--directions", {"16"}},
                        {"--preset", {"venus"}},
                        {"--aerosol", {"-0.1", "101", "much"}},
                        {"--bands", {"0", "17"}},
                        {"--window-width", {"0"}},
                        {"--for", {"doom"}},
                        {"--threads", {"-1"}},
                        {"--memory-limit", {"-1"}},
                        {"--format", {"xml"}}});
  const TemporaryDirectory folder;
  const std::string out = "-o " + quoted(folder.path() / "out") + ' ';
  const std::string day = "--sweep " + quoted(folder.path() / "day.png") + ' ';
  const std::map<std::string, std::vector<std::string>> not_together{
      {"",
       {"--size 64", "--sun-disc", "--formats exr", "--image-height 64", "--sweep-to -6", "--sweep-tiles 3",
        "--sweep " + quoted(folder.path() / "day.jpg"), "--json --format text", "input.hdr"}},
      {out,
       {"--format c", day, "--window min-laplacian", "--quadrature gauss", "--directions 8,8", "--size 0",
        "--image-height 0"}},
      {day,
       {"--json", "--sun-azimuth 5", "--quadrature gauss", "--directions 8,8", "--bands 2", "--window min-laplacian",
        "--for unity", "--sweep-tiles 0", "--sweep-to -91", "--sweep-size 4"}}};
  for (const auto& [start, options] : not_together) {
    for (const std::string& option : options) {
      INFO(start + option);
      sky_failure(start + option, 2);
    }
  }
  CHECK_FALSE(std::filesystem::exists(folder.path() / "out"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "day.png"));
}

// `welkin sky --tables FILE`: tables are made once, reused if they match the options, and always validated.

namespace {

std::string tables_action(const nlohmann::json& document) {
  for (const auto& pass : document.at("diagnostics").at("passes")) {
    if (pass.at("name") == "tables") return pass.at("action").get<std::string>();
  }
  return "none";
}

}  // namespace

TEST_CASE("sky: tables are saved, and used again for any sun and height", "[tools][sky][slow]") {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "earth.sky";
  const std::string tables = "--tables " + quoted(file);
  const nlohmann::json first = sky_json("--sun-elevation 20 " + tables);
  CHECK(tables_action(first) == "run");
  REQUIRE(std::filesystem::exists(file));
  const std::string stored = file_text(file);
  const nlohmann::json again = sky_json("--sun-elevation 20 " + tables);
  CHECK(tables_action(again) == "reuse");
  CHECK(again.at("radiance") == first.at("radiance"));
  CHECK(again.at("sun") == first.at("sun"));
  CHECK(tables_action(sky_json("--sun-elevation -3 --altitude 5000 --memory-limit 1GB " + tables)) == "reuse");
  CHECK(sky_json("--sun-elevation -3 " + tables).at("radiance") == sky_json("--sun-elevation -3").at("radiance"));
  CHECK((file_text(file) == stored));
  CHECK(names_in(folder.path()) == std::vector<std::string>{"earth.sky"});
}

TEST_CASE("sky: tables of another sky are made anew, and replace those in the file", "[tools][sky][slow]") {
  const TemporaryDirectory folder;
  const std::string tables = "--sun-elevation 20 --tables " + quoted(folder.path() / "some.sky");
  sky_json(tables);
  for (const char* other :
       {"--ground-albedo 0.5 ", "--preset mars ", "--convergence-threshold 0.5 ", "--layout compact ", ""}) {
    INFO(other);
    const nlohmann::json made = sky_json(other + tables);
    CHECK(tables_action(made) == "run");
    CHECK(made.at("radiance") == sky_json(std::string(other) + "--sun-elevation 20").at("radiance"));
    CHECK(tables_action(sky_json(other + tables)) == "reuse");
  }
}

TEST_CASE("sky: a file that holds no sound tables is named and left as it is", "[tools][sky][posix][slow]") {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "broken.sky";
  const std::string tables = kSmallSky + "--tables " + quoted(file);
  std::ofstream(file) << "my holiday images\n";
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  CHECK(file_text(file) == "my holiday images\n");
  std::filesystem::remove(file);

  sky_json("--tables " + quoted(file));
  const std::string sound = file_text(file);
  std::string damaged = sound;
  damaged[sound.size() / 2] = static_cast<char>(damaged[sound.size() / 2] ^ 1);
  std::ofstream(file, std::ios::binary) << damaged;
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  std::ofstream(file, std::ios::binary) << sound.substr(0, sound.size() - 5);
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  CHECK(contains(sky_failure(kSmallSky + "--tables " + quoted(folder.path() / "no" / "folder.sky"), 1), "folder.sky"));
  CHECK(contains(sky_failure(kSmallSky + "--tables " + quoted(folder.path()), 1), folder.path().filename().string()));
}

// `welkin sky -o DIR`: the bundle equals that of `welkin bake` of the image in the folder.

namespace {

const std::string kSmallBake = "--irradiance 16 --brdf 16 ";

nlohmann::json bake_sky(const std::filesystem::path& folder, const std::string& arguments) {
  printed_by("sky " + kSmallSky + kSmallBake + arguments + " -o " + quoted(folder));
  return manifest_of(folder);
}

}  // namespace

TEST_CASE("sky -o: the files are those of a bake of sky.exr", "[tools][sky][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto sky = scratch.path() / "sky";
  const auto baked = scratch.path() / "baked";
  for (const std::string& engine : {std::string(), std::string("--for unreal ")}) {
    const nlohmann::json manifest =
        bake_sky(sky, engine + "--sun-elevation 20 --image-height 64 --no-previews --formats ktx2,dds,exr,env");
    CHECK(names_in(sky) == names_of(manifest));
    bake_into(baked, engine + kSmallBake + "--size 32 --background-size 128 --no-previews --formats ktx2,dds,exr,env " +
                         quoted(sky / "sky.exr"));
    std::vector<std::string> names = names_in(baked);
    names.insert(std::upper_bound(names.begin(), names.end(), "sky.exr"), "sky.exr");
    REQUIRE(names_in(sky) == names);
    for (const std::string& name : names_in(baked)) {
      if (name == "manifest.json" || name == "sh.json" || name == "sh.h") continue;  // they name their source
      INFO(name);
      CHECK((file_text(sky / name) == file_text(baked / name)));
    }
    const auto ours = json_of(file_text(sky / "sh.json"));
    const auto theirs = json_of(file_text(baked / "sh.json"));
    CHECK(ours.at("radiance") == theirs.at("radiance"));
    CHECK(ours.at("engines") == theirs.at("engines"));
  }
}

TEST_CASE("sky -o: sky.exr is the library's image, the sun left out unless asked for", "[tools][sky][bake][slow]") {
  const TemporaryFile out("out");
  const auto tables = small_sky();
  const SkyView view(tables, 0.0);
  const glm::dvec3 sun = sun_direction(30.0, 40.0);
  for (const bool inside : {false, true}) {
    const nlohmann::json manifest =
        bake_sky(out, std::string("--sun-elevation 30 --sun-azimuth 40 --image-height 48 --no-previews ") +
                          (inside ? "--sun-disc" : ""));
    const Environment stored = read_environment(out / "sky.exr");
    const LatLongImage expected = sky_lat_long(view, sun, 48, {.sun_disc = inside});
    REQUIRE(stored.info.width == 96);
    const auto* pixels = static_cast<const float*>(stored.lat_long().pixels);
    CHECK(std::equal(expected.pixels.begin(), expected.pixels.end(), pixels));
    CHECK(manifest.contains("sun") == !inside);
    CHECK(manifest.at("sky").at("sun_elevation_degrees") == 30.0);
    if (!inside) {
      CHECK(rgb_of(manifest.at("sun").at("irradiance")) == view.sun_light(sun).irradiance);
      CHECK(rgb_of(manifest.at("sun").at("direction")) == view.sun_light(sun).direction);
    }
    const auto sh = json_of(file_text(out / "sh.json"));
    CHECK(sh.contains("sun") == !inside);
  }
}

// `welkin sky --sweep`: an image and a text file; days are bright and blue, dusk is red, nights are dark.

namespace {

/// Colours of any size; the wavelengths are few, for speed.
const std::string kFewColours = kSmallSky + "--wavelengths 440,490,550,600,640,680 ";

std::vector<double> elevations(const std::string& text) {
  std::vector<double> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    double elevation = 0.0;
    if (words >> number >> elevation && number == found.size() + 1) found.push_back(elevation);
  }
  return found;
}

}  // namespace

TEST_CASE("sky --sweep: image and text have the tiles that were asked for", "[tools][sky][slow]") {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "day.png";
  struct Case {
    const char* arguments;
    int width, height;
    std::size_t tiles;
    double first, last;
  };
  for (const Case& each : {Case{"--sweep-tiles 6 --sweep-size 32", 4 * 64 - 4, 2 * 36 - 4, 6, 90.0, -18.0},
                           Case{"--sweep-tiles 1 --sweep-size 16 --sun-elevation 50", 30, 16, 1, 50.0, 50.0},
                           Case{"--sweep-tiles 9 --sweep-size 15 --sweep-view fisheye --sun-elevation 61.5 --sweep-to "
                                "-7",
                                8 * 19 - 4, 2 * 19 - 4, 9, 61.5, -7.0}}) {
    INFO(each.arguments);
    const std::string said = printed_by("sky " + kFewColours + each.arguments + " --sweep " + quoted(file));
    CHECK(said == file_text(folder.path() / "day.txt"));
    const EnvironmentInfo image = read_environment(file, {.layout = Layout::lat_long}).info;
    CHECK(image.width == each.width);
    CHECK(image.height == each.height);
    const std::vector<double> found = elevations(said);
    REQUIRE(found.size() == each.tiles);
    CHECK(found.front() == each.first);
    CHECK(found.back() == each.last);
    CHECK(std::is_sorted(found.rbegin(), found.rend()));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"day.png", "day.txt"});
  }
}

// `welkin sky` writes air as JSON and reads it; what is wrong with a file is said with its name.

namespace {

nlohmann::json printed(const std::string& arguments) { return json_printed_by("sky --print-atmosphere " + arguments); }

nlohmann::json same_light(const nlohmann::json& document) {
  return {document.at("radiance"), document.at("sun"), document.at("sky").at("parameters")};
}

}  // namespace

TEST_CASE("sky: air that was printed is read as the same air", "[tools][sky][slow]") {
  const TemporaryFile file("air.json");
  for (const char* preset : {"earth", "dusty", "earth-bruneton", "earth-hillaire", "mars", "no-aerosol"}) {
    INFO(preset);
    write_text(file, printed(std::string("--preset ") + preset).dump());
    CHECK(same_light(sky_json("--atmosphere " + quoted(file))) ==
          same_light(sky_json(std::string("--preset ") + preset)));
  }
  const nlohmann::json air = printed("--ground-albedo 0.3 --wavelengths 615,535,445");
  CHECK(air.at("ground_albedo") == nlohmann::json({0.3, 0.3, 0.3}));
  CHECK(air.at("wavelengths_nm") == nlohmann::json({615.0, 535.0, 445.0}));
  CHECK(air.at("solar_irradiance").get<std::vector<double>>() == earth({615.0, 535.0, 445.0}).solar_irradiance);
  CHECK(printed("--colour srgb").at("wavelengths_nm").size() == 15);
}

TEST_CASE("sky: files that hold no air are refused", "[tools][sky][posix]") {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "air.json";
  const auto refused = [&](const std::string& text, const std::string& message) {
    write_text(file, text);
    const std::string said = sky_failure("--atmosphere " + quoted(file), 1);
    INFO(said);
    CHECK(contains(said, "air.json: "));
    CHECK(contains(said, message));
  };
  refused("", "is not JSON");
  refused("{\"name\": ", "is not JSON");
  refused("{\"bottom_radius_m\": NaN}", "is not JSON");
  refused("{\"bottom_radius_m\": 1e999}", "");
  refused("[]", "not a JSON object");
  refused("\xff\xfe", "is not JSON");
  refused(std::string(100000, '['), "nested too deeply");
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
