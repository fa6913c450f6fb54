// `welkin sh --json` has the documented shape and every digit of what the library computes.
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.h"
#include "tools/built_in_sky.h"
#include "tools/command.h"
#include "tools/pfm_file.h"
#include "tools/temporary_folder.h"
#include "welkin/babylon.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

using namespace welkin;
using namespace welkin::test;

namespace {

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

TEST_CASE("sh --json: documented shape for every number of bands", "[tools]") {
  for (const int bands : {1, 2, 3, 5, 16}) {
    require_documented_shape(run_sh_json("--bands " + std::to_string(bands)), bands);
  }
}

TEST_CASE("sh --json: the built-in sky to the last bit", "[tools]") {
  const nlohmann::json document = run_sh_json("");
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

TEST_CASE("sh --json: a file in either layout", "[tools]") {
  const TemporaryFolder folder;
  const auto lat_long = folder.path() / "lat-long.pfm";
  const auto strip = folder.path() / "strip.pfm";
  write_pfm(lat_long, 16, 8, grey_picture(16, 8, 2.0F));
  write_pfm(strip, 4, 24, grey_picture(4, 24, 2.0F));
  for (const auto& [path, layout] : {std::pair{lat_long, "lat-long"}, {strip, "vertical-strip"}}) {
    const nlohmann::json document = run_sh_json(quoted(path));
    require_documented_shape(document, 3);
    CHECK(document.at("source").at("path") == path.string());
    CHECK(document.at("source").at("layout") == layout);
    CHECK(document.at("source").at("format") == "PFM");
    const double constant = triple(document.at("radiance").at(0)).x;
    CHECK(std::abs(constant - 2.0 * std::sqrt(4.0 * std::numbers::pi)) < 1e-6);
  }
}

TEST_CASE("sh --json: what was replaced and clamped is counted", "[tools]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "odd.pfm";
  std::vector<float> rgb = grey_picture(16, 8, 1.0F);
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
  CHECK(triple(clamped.at("flux")).x < triple(clamped.at("flux_before_clamp")).x);
  const auto preserved = run_sh_json("--preserve-clamped " + quoted(file)).at("diagnostics");
  CHECK(preserved.at("settings").at("clamp") == 4096.0);
  CHECK(preserved.at("settings").at("preserve_clamped") == true);
}

TEST_CASE("sh --json: valid JSON whatever the file is called", "[tools]") {
  const TemporaryFolder folder;
  for (const std::string name : {"a \"b\" \\ c.pfm", "l\xc3\xa4nd.pfm", "not-utf8-\xff\xfe.pfm", "new\nline.pfm"}) {
    const auto file = folder.path() / name;
    write_pfm(file, 4, 2, grey_picture(4, 2, 1.0F));
    require_documented_shape(run_sh_json(quoted(file)), 3);
  }
}

TEST_CASE("sh: the options reach the projection", "[tools]") {
  const LatLongImage sky = built_in_sky();
  const auto check = [&](const std::string& arguments, auto&& set) {
    ProjectionOptions options;
    set(options);
    INFO(arguments);
    CHECK(triple(run_sh_json(arguments).at("radiance").at(4)) == project(sky.view(), options).radiance.at(2, -2));
  };
  check("--quadrature midpoint", [](ProjectionOptions& options) { options.quadrature = Quadrature::midpoint; });
  check("--target-size 16", [](ProjectionOptions& options) { options.target_size = 16; });
  check("--clamp 1.5", [](ProjectionOptions& options) { options.clamp = RadianceClamp{1.5F, false}; });
  check("--clamp 1.5 --preserve-clamped", [](ProjectionOptions& options) {
    options.clamp = RadianceClamp{1.5F, true};
  });
  check("--gamma", [](ProjectionOptions& options) { options.gamma = true; });
}
