
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

using namespace welkin;
using namespace welkin::test;

// `welkin sh --json` has the documented shape and every digit of what the library computes.

namespace {

/// Returns the library's version of the sky that the command uses without an input file.
LatLongImage built_in_sky() {
  SkyTableOptions options{.heights = 8, .view_zeniths = 64, .sun_zeniths = 16};
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth(), options)), 0.0);
  return sky_lat_long(view, sun_direction(40.0, 25.0), 512, {.sun_disc = true});
}

bool is_triple(const nlohmann::json& value) {
  return value.is_array() && value.size() == 3 && value[0].is_number() && value[1].is_number() && value[2].is_number();
}

void require_triples(const nlohmann::json& list, std::size_t count) {
  REQUIRE(list.is_array());
  REQUIRE(list.size() == count);
  for (const auto& element : list) REQUIRE(is_triple(element));
}

glm::dvec3 triple(const nlohmann::json& value) {
  REQUIRE(is_triple(value));
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

void require_documented_shape(const nlohmann::json& document, int bands) {
  const auto count = static_cast<std::size_t>(bands * bands);
  const auto& source = document.at("source");
  CHECK(source.at("path").is_string());
  CHECK(source.at("layout").is_string());
  CHECK(source.at("width").is_number_integer());
  CHECK(source.at("height").is_number_integer());
  CHECK(source.at("format").is_string());
  CHECK(document.at("bands") == bands);
  require_triples(document.at("radiance"), count);
  require_triples(document.at("irradiance"), count);
  CHECK(document.at("babylon").size() == 9);
  for (const char* term : {"x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"}) {
    CHECK(is_triple(document.at("babylon").at(term)));
  }
  const auto& diagnostics = document.at("diagnostics");
  for (const char* count_name : {"texels", "replaced", "clamped"})
    CHECK(diagnostics.at(count_name).is_number_integer());
  CHECK(diagnostics.at("error_estimate").is_number());
  CHECK(diagnostics.at("passes").size() > 0);
  for (const auto& pass : diagnostics.at("passes")) {
    CHECK(pass.at("name").is_string());
    CHECK((pass.at("action") == "run" || pass.at("action") == "reuse" || pass.at("action") == "skip"));
    CHECK(!pass.at("reason").get<std::string>().empty());
    CHECK(pass.at("ms").is_number());
  }
}

}  // namespace

TEST_CASE("sh --json: documented shape for every number of bands", "[tools][slow]") {
  for (const int bands : {1, 2, 3, 5, 16}) {
    require_documented_shape(run_sh_json(small_image() + " --bands " + std::to_string(bands)), bands);
  }
}

TEST_CASE("sh --json: the built-in sky to the last bit", "[tools][slow]") {
  const nlohmann::json document = run_sh_json("--sky");
  CHECK(document.at("source").at("path") == "built-in sky");
  CHECK(document.at("source").at("layout") == "lat-long");
  CHECK(document.at("sky").at("unit") == "W/m2/sr/nm at 680, 550, 440 nm");
  CHECK(document.at("sky").at("sun_elevation_degrees") == 40.0);

  const LatLongImage sky = built_in_sky();
  const Projection light = project(sky.view());
  const SphericalHarmonics irradiance = irradiance_from_radiance(light.radiance);
  CHECK(document.at("diagnostics").at("texels") == light.diagnostics.texels);
  for (std::size_t i = 0; i < 9; ++i) {
    CHECK(triple(document.at("radiance").at(i)) == light.radiance.coefficients()[i]);
    CHECK(triple(document.at("irradiance").at(i)) == irradiance.coefficients()[i]);
  }
  const BabylonPolynomial polynomial = babylon_polynomial(light.radiance);
  CHECK(triple(document.at("babylon").at("y")) == polynomial.y);
  CHECK(triple(document.at("babylon").at("zx")) == polynomial.zx);
}

TEST_CASE("sh --json: what was replaced and clamped is counted", "[tools]") {
  const TemporaryFile file("odd.pfm");
  std::vector<float> rgb = grey_image(16, 8, 1.0F);
  rgb[0] = std::numeric_limits<float>::quiet_NaN();
  rgb[30] = std::numeric_limits<float>::infinity();
  rgb[60] = -1.0F;
  rgb[90] = 5000.0F;
  write_pfm(file, 16, 8, rgb);

  const auto kept = run_sh_json(quoted(file)).at("diagnostics");
  CHECK(kept.at("replaced") == 2);
  CHECK(kept.at("nans_replaced") == 1);
  CHECK(kept.at("infinities_replaced") == 1);
  CHECK(kept.at("clamped") == 0);
  const auto clamped = run_sh_json("--negative replace --clamp 100 " + quoted(file)).at("diagnostics");
  CHECK(clamped.at("replaced") == 3);
  CHECK(clamped.at("settings").at("clamp") == 100.0);
  CHECK(triple(clamped.at("total_radiance")).x < triple(clamped.at("total_radiance_before_clamp")).x);
  const auto preserved = run_sh_json("--preserve-clamped " + quoted(file)).at("diagnostics");
  CHECK(preserved.at("settings").at("clamp") == 4096.0);
  CHECK(preserved.at("settings").at("preserve_clamped") == true);
}

TEST_CASE("sh: the options reach the projection", "[tools][slow]") {
  const LatLongImage sky = built_in_sky();
  const auto check = [&](const std::string& arguments, auto&& set) {
    ProjectionOptions options;
    set(options);
    INFO(arguments);
    CHECK(triple(run_sh_json("--sky " + arguments).at("radiance").at(4)) ==
          project(sky.view(), options).radiance.at(2, -2));
  };
  check("--quadrature midpoint", [](ProjectionOptions& options) { options.quadrature = Quadrature::midpoint; });
  check("--target-size 16", [](ProjectionOptions& options) { options.target_size = 16; });
  check("--clamp 1.5", [](ProjectionOptions& options) { options.pixels.clamp = RadianceClamp{1.5F, false}; });
  check("--clamp 1.5 --preserve-clamped", [](ProjectionOptions& options) {
    options.pixels.clamp = RadianceClamp{1.5F, true};
  });
  check("--gamma", [](ProjectionOptions& options) { options.pixels.gamma = true; });
}

// `welkin sh` without --json: a table that describes its numbers.

TEST_CASE("sh: the table says source, convention, terms and diagnostics", "[tools]") {
  const std::string table = printed_by("sh --sky");
  for (const char* part : {"built-in sky: 1024 x 512 lat-long", "without Condon-Shortley phase", "3zz - 1", "xx - yy",
                           "radiance r, g, b", "irradiance r, g, b", "in GLSL", "Average colour", "524,288 texels",
                           "no pixel value had to be replaced", "no clamp was requested", "relative error"}) {
    INFO(part);
    CHECK(contains(table, part));
  }
}

// `welkin sh --format`: text and C header carry the JSON's numbers.

namespace {

// Returns the numbers of the line "NAME r g b" of a text.
glm::dvec3 numbers_behind(const std::string& name, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    glm::dvec3 rgb{};
    if (words >> first >> rgb.x >> rgb.y >> rgb.z && first == name) return rgb;
  }
  FAIL("no line " << name << " in\n" << text);
  return {};
}

// Returns the output of a C program that includes the header and prints `expressions`, one per line.
std::string printed_by_c(const std::string& header, const std::string& expressions) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "light.h") << header;
  std::ofstream(folder.path() / "main.c") << "#include \"light.h\"\n#include \"light.h\"\n#include <stdio.h>\n"
                                          << "int main(void) {\n"
                                          << expressions << "  return 0;\n}\n";
  const CommandResult result = run_script("cd " + quoted(folder.path()) +
                                          " && cc -std=c99 -pedantic -Wall -Wno-unused-const-variable "
                                          "-Wno-unused-variable -Werror -o main main.c && ./main");
  INFO(result.errors);
  REQUIRE(result.exit_code == 0);
  return result.output;
}

}  // namespace

TEST_CASE("sh: text has a line a coefficient, every digit", "[tools][slow]") {
  const nlohmann::json json = run_sh_json(small_image() + " --bands 4");
  const std::string text = printed_by("sh " + small_image() + " --bands 4 --format text");
  for (int l = 0; l < 4; ++l) {
    for (int m = -l; m <= l; ++m) {
      const std::string index_text = '[' + std::to_string(l) + ',' + std::to_string(m) + ']';
      const std::size_t index = static_cast<std::size_t>(l * (l + 1) + m);
      CHECK(numbers_behind("radiance" + index_text, text) == triple(json.at("radiance").at(index)));
      CHECK(numbers_behind("irradiance" + index_text, text) == triple(json.at("irradiance").at(index)));
    }
  }
}

TEST_CASE("sh: the C header compiles as C99 and holds the numbers", "[tools][posix][slow]") {
  const nlohmann::json json = run_sh_json(small_image());
  const std::string printed =
      printed_by_c(printed_by("sh " + small_image() + " --format c"),
                   "  for (int i = 0; i < 9; ++i) printf(\"radiance%d %.9g %.9g %.9g\\n\", i, light_radiance[i][0], "
                   "light_radiance[i][1], light_radiance[i][2]);\n");
  for (std::size_t i = 0; i < 9; ++i) {
    const glm::dvec3 expected = triple(json.at("radiance").at(i));
    const glm::dvec3 found = numbers_behind("radiance" + std::to_string(i), printed);
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(static_cast<float>(found[channel]) == static_cast<float>(expected[channel]));
    }
  }
}

namespace {

SphericalHarmonics radiance_of(const nlohmann::json& json) {
  SphericalHarmonics harmonics(json.at("bands").get<int>());
  for (std::size_t i = 0; i < harmonics.coefficients().size(); ++i) {
    harmonics.coefficients()[i] = triple(json.at("radiance").at(i));
  }
  return harmonics;
}

/// The numbers of all lines that start so.
std::vector<float> numbers_of_rows(const std::string& start, const std::string& text) {
  std::vector<float> numbers;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(start)) continue;
    for (char& c : line)
      c = std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == 'e' ? c : ' ';
    std::istringstream words(line.substr(start.size()));
    numbers.insert(numbers.end(), std::istream_iterator<float>(words), {});
  }
  return numbers;
}

void check_numbers(const std::vector<float>& numbers, const EngineLight& expected) {
  REQUIRE(numbers.size() == 27);
  for (std::size_t i = 0; i < 27; ++i) {
    const auto wanted = static_cast<float>(expected.terms[i / 3].rgb[static_cast<int>(i % 3)]);
    CHECK(numbers[i] == wanted);
  }
}

}  // namespace

TEST_CASE("sh: GLSL has Welkin's form in the axes that are asked for, and compiles", "[tools][posix][slow]") {
  for (const std::string axes : {"", " --for blender"}) {
    INFO(axes);
    const SphericalHarmonics light = radiance_of(run_sh_json(small_image() + axes));
    const std::string code = printed_by("sh " + small_image() + " --format glsl" + axes);
    check_numbers(numbers_of_rows("  vec3(", code), engine_light_unrotated(light, Engine::welkin));
    CHECK(contains(code, "vec3 diffuse_light(vec3 n) {"));
    if (run_script("command -v glslangValidator").exit_code != 0) continue;
    const TemporaryDirectory folder;
    for (const char* const version : {"330", "300 es\nprecision highp float;"}) {
      std::ofstream(folder.path() / "light.frag") << "#version " << version << '\n'
                                                  << code
                                                  << "in vec3 n;\nout vec3 colour;\n"
                                                     "void main() { colour = diffuse_light(normalize(n)); }\n";
      CHECK(run_script("glslangValidator " + quoted(folder.path() / "light.frag")).exit_code == 0);
    }
  }
}

TEST_CASE("sh: C# is Unity's, and refused for others", "[tools][slow]") {
  const SphericalHarmonics light = radiance_of(run_sh_json(small_image() + " --for unity"));
  const std::string code = printed_by("sh --sky --for unity --format cs --extract-sun");
  check_numbers(numbers_of_rows("    {", run_welkin("sh " + small_image() + " --for unity --format cs").output),
                engine_light_unrotated(light, Engine::unity));
  for (const char* const part : {"public static SphericalHarmonicsL2 Probe()", "using UnityEngine.Rendering;",
                                 "SunDirection = new Vector3(", "AmbientMode.Custom"}) {
    CHECK(contains(code, part));
  }
  CHECK(contains(failure("sh " + small_image() + " --format cs", 2), "add --for unity"));
}

// `welkin sh` and what is done with the light: windows, the sun, the dominant light, the error of irradiance.

TEST_CASE("sh: a window damps the bands, and says what it did to the least irradiance", "[tools][slow]") {
  const nlohmann::json plain = run_sh_json(small_image());
  CHECK(plain.at("window").at("name") == "none");
  for (const char* window : {"hanning", "lanczos", "min-laplacian"}) {
    INFO(window);
    const nlohmann::json json = run_sh_json(small_image() + " --window " + window);
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
  CHECK(contains(printed_by("sh " + small_image() + " --window min-laplacian"), "after it (min-laplacian"));
  CHECK(run_welkin("sh --sky --window-width 0").exit_code == 2);
}

TEST_CASE("sh: the built-in sky's sun is taken out and what is left is darker by it", "[tools][slow]") {
  const nlohmann::json json = run_sh_json("--sky --extract-sun");
  REQUIRE(json.at("sun").is_object());
  const glm::dvec3 direction = triple(json.at("sun").at("direction"));
  CHECK(direction.y == Approx(std::sin(40.0 / 180.0 * std::acos(-1.0))).margin(0.01));
  const nlohmann::json whole = run_sh_json("--sky");
  const glm::dvec3 lost =
      triple(whole.at("diagnostics").at("total_radiance")) - triple(json.at("diagnostics").at("total_radiance"));
  const glm::dvec3 sun = triple(json.at("sun").at("irradiance"));
  CHECK(glm::length(lost - sun) < 1e-6 * glm::length(triple(whole.at("diagnostics").at("total_radiance"))));
  CHECK(contains(run_welkin("sh --sky --extract-sun").output, "Sun, extracted"));
}

TEST_CASE("convert: the map without its sun, plus the sun that is reported, is the map", "[tools][convert]") {
  const TemporaryDirectory folder;
  const auto sky = folder.path() / "sky.pfm";
  const auto rest = folder.path() / "rest.pfm";
  std::vector<float> pixels = grey_image(128, 64, 0.5F);
  for (const std::size_t texel : {20 * 128 + 40, 20 * 128 + 41, 21 * 128 + 40, 21 * 128 + 41}) {
    for (std::size_t k = 0; k < 3; ++k) pixels[3 * texel + k] = 5000.0F + 700.0F * static_cast<float>(k);
  }
  write_pfm(sky, 128, 64, pixels);
  CHECK(contains(printed_by("convert " + quoted(sky) + " " + quoted(rest) + " --extract-sun --sun-radius 10"),
                 "Sun, extracted"));
  const nlohmann::json whole = run_sh_json(quoted(sky) + " --extract-sun --sun-radius 10");
  REQUIRE(whole.at("sun").is_object());
  const glm::dvec3 total_radiance = triple(run_sh_json(quoted(sky)).at("diagnostics").at("total_radiance"));
  const glm::dvec3 left = triple(run_sh_json(quoted(rest)).at("diagnostics").at("total_radiance"));
  const glm::dvec3 sun = triple(whole.at("sun").at("irradiance"));
  CHECK(glm::length(total_radiance - left - sun) < 1e-6 * glm::length(total_radiance));
  CHECK(glm::length(left - triple(whole.at("diagnostics").at("total_radiance"))) < 1e-9 * glm::length(total_radiance));
  CHECK(run_welkin("convert " + quoted(sky) + " " + quoted(rest) + " --sun-radius 10").exit_code == 2);
}

// `welkin sh` rotates light: --yaw, --mirror, --rotation, --from, --for.

namespace {

double distance(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    largest = std::max(largest, glm::length(a.coefficients()[i] - b.coefficients()[i]));
  }
  return largest;
}

// A vertical strip whose texels are all different.
std::vector<float> uneven_strip(int size) {
  std::vector<float> pixels(static_cast<std::size_t>(size * size * 18));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>((i * 2654435761U) % 1009U) / 1009.0F;
  return pixels;
}

}  // namespace

TEST_CASE("sh: yaw takes +z to +x, and a quaternion does the same", "[tools][slow]") {
  const auto light = [](const std::string& turn) {
    return radiance_of(run_sh_json(small_image() + " --bands 4" + turn));
  };
  const SphericalHarmonics plain = light("");
  const SphericalHarmonics made = light(" --yaw 90");
  CHECK(glm::length(made.at(1, 1) - plain.at(1, 0)) < 1e-12);
  CHECK(glm::length(made.at(1, -1) - plain.at(1, -1)) < 1e-12);
  CHECK(distance(made, rotate(plain, glm::angleAxis(std::acos(-1.0) / 2.0, glm::dvec3(0, 1, 0)))) < 1e-12);
  const std::string root = std::to_string(std::sqrt(0.5));
  CHECK(distance(made, light(" --rotation 0," + root + ",0," + root)) < 1e-12);
  CHECK(distance(plain, light(" --yaw 30 --rotation 0,0.25881904510252074,0,-0.9659258262890683")) < 1e-12);
  CHECK(distance(plain, light(" --yaw 360")) == 0.0);
}

TEST_CASE("bake: harmonics of a rotated image are those that sh rotates, and a note says what resampling moves",
          "[tools][bake]") {
  const TemporaryDirectory scratch;
  const std::string rotated = small_image() + " --bands 4 --rotation 0.1,0.2,0.3,0.9";
  const nlohmann::json manifest = bake_into(scratch.path() / "out", rotated + " --size 8 --no-previews");
  const SphericalHarmonics found = radiance_of(json_of(file_text(scratch.path() / "out" / "sh.json")));
  CHECK(distance(found, radiance_of(run_sh_json(rotated))) < 1e-12);
  CHECK(contains(manifest.at("notes").dump(), "rotated by resampling"));
}

TEST_CASE("sh: --for turns to the engine's axes, whose lat-long centre the sun is near", "[tools][slow]") {
  const SphericalHarmonics plain = radiance_of(run_sh_json(small_image()));
  for (const Convention& engine : conventions()) {
    INFO(engine.name);
    const nlohmann::json json = run_sh_json(small_image() + " --for " + engine.name);
    CHECK(json.at("axes").at("engine") == engine.name);
    CHECK(distance(radiance_of(json), rotate(plain, engine.from_welkin)) < 1e-12);
  }
}

TEST_CASE("sh: what cannot be turned is refused", "[tools]") {
  CHECK(run_welkin("sh --sky --rotation 0,0,0,0").exit_code == 2);
  CHECK(run_welkin("sh --sky --rotation 1,2,3").exit_code == 2);
  CHECK(run_welkin("sh --sky --yaw nan").exit_code == 2);
  CHECK(run_welkin("sh --sky --for godzilla").exit_code == 2);
  const TemporaryFile path("faces.pfm");
  write_pfm(path, 4, 24, uneven_strip(4));
  const std::string blender = failure("sh --from blender " + quoted(path), 2);
  CHECK(contains(blender, "Blender"));
  CHECK(contains(blender, "no cube faces"));
}
