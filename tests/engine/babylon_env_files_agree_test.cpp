// Promise: the polynomial that the real Babylon.js stored in .env files, when it baked them from the photographs of
// ../shared, is the one that we have for the same photographs: orientation, signs and factors, over its whole way.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <sstream>
#include <string>

#include "places.h"
#include "support/catch.h"
#include "welkin/engine_light.h"
#include "welkin/environment_file.h"
#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

const std::filesystem::path kShared = std::filesystem::path(WELKIN_SHARED) / "hdr";

using Terms = std::map<std::string, glm::dvec3>;

// The stored polynomials by file name; lines are file,what,term,r,g,b,note.
std::map<std::string, Terms> stored_polynomials() {
  std::map<std::string, Terms> stored;
  std::ifstream lines(kShared / "REFERENCE_SH.csv");
  for (std::string line; std::getline(lines, line);) {
    if (line.find("env polynomial (as stored)") == std::string::npos) continue;
    std::istringstream fields(line);
    std::string file;
    std::string what;
    std::string term;
    std::getline(fields, file, ',');
    std::getline(fields, what, ',');
    std::getline(fields, term, ',');
    glm::dvec3 rgb{};
    char comma = 0;
    fields >> rgb.r >> comma >> rgb.g >> comma >> rgb.b;
    stored[std::filesystem::path(file).filename().string()][term] = rgb;
  }
  return stored;
}

double deviation(const EngineLight& light, const Terms& stored) {
  double worst = 0.0;
  double largest = 0.0;
  for (const EngineTerm& term : light.terms) {
    worst = std::max(worst, glm::length(term.rgb - stored.at(term.name)));
    largest = std::max(largest, glm::length(stored.at(term.name)));
  }
  return worst / largest;
}

}  // namespace

TEST_CASE("the .env files that Babylon.js baked hold the polynomials of their photographs", "[engine][shared]") {
  const auto stored = stored_polynomials();
  if (stored.empty()) {
    WARN("left out: the shared environments are not at " << kShared);
    return;
  }
  const std::pair<const char*, const char*> pairs[] = {{"babylon_dikhololo_night_64.env", "dikhololo_night_1k.hdr"},
                                                       {"babylon_lebombo_64_webp.env", "lebombo_1k.hdr"},
                                                       {"babylon_potsdamer_platz_256.env", "potsdamer_platz_1k.hdr"},
                                                       {"babylon_spruit_sunrise_128.env", "spruit_sunrise_1k.hdr"},
                                                       {"babylon_studio_small_03_128.env", "studio_small_03_1k.hdr"},
                                                       {"babylon_venice_sunset_128.env", "venice_sunset_1k.hdr"}};
  for (const auto& [baked, photograph] : pairs) {
    INFO(baked);
    ProjectionOptions options;
    options.clamp = RadianceClamp{};  // 4096, as Babylon.js has it
    const SphericalHarmonics light = project_file(kShared / "env" / photograph, {}, options).radiance;
    // It goes through cube faces of 64 to 256 texels, each the nearest pixel's: up to 3 % off.
    CHECK(deviation(engine_light(light, Engine::babylon), stored.at(baked)) < 0.04);
    const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
    CHECK(deviation(engine_light(transform(light, mirror), Engine::babylon), stored.at(baked)) > 0.05);
  }
}

}  // namespace welkin
