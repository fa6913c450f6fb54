// The environments of ../shared, where they are: the direct lat-long path against a dense double-precision integral,
// and against the values that an independent program (numpy, float64) recorded.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> lat_longs() {
  std::vector<fs::path> paths;
  const fs::path folder = fs::path(WELKIN_SHARED) / "hdr" / "env";
  if (!fs::exists(folder)) {
    WARN("no real environments: " << folder << " is not there");
    return paths;
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const EnvironmentInfo info = inspect_environment(entry.path());
    if (info.layout == Layout::lat_long && info.width <= 1024) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Recorded radiance coefficients by file name: nine names in the order of l (l + 1) + m.
std::map<std::string, std::vector<glm::dvec3>> recorded_radiance() {
  std::map<std::string, std::vector<glm::dvec3>> found;
  std::ifstream in(fs::path(WELKIN_SHARED) / "hdr" / "REFERENCE_SH.csv");
  for (std::string line; std::getline(in, line);) {
    if (line.find("radiance SH") == std::string::npos) continue;
    // file,"what, with commas",coefficient,r,g,b,note
    const std::string file = line.substr(0, line.find(','));
    const std::string rest = line.substr(line.rfind("\",") == std::string::npos ? 0 : line.find("\",") + 2);
    std::istringstream fields(rest);
    std::string name;
    glm::dvec3 value;
    char comma = 0;
    std::getline(fields, name, ',');
    fields >> value.x >> comma >> value.y >> comma >> value.z;
    found[fs::path(file).filename().string()].push_back(value);
  }
  return found;
}

}  // namespace

TEST_CASE("Real lat-longs agree with a dense double-precision integral", "[sh][shared]") {
  for (const fs::path& path : lat_longs()) {
    const Environment environment = read_environment(path);
    const SphericalHarmonics found = project_file(path).radiance;
    const double error = relative_error(found, reference_projection(environment.lat_long()));
    CAPTURE(path.filename().string(), error);
    CHECK(error < 1e-6);
  }
}

TEST_CASE("Real lat-longs agree with what an independent program recorded", "[sh][shared]") {
  const auto recorded = recorded_radiance();
  int compared = 0;
  for (const fs::path& path : lat_longs()) {
    const auto at = recorded.find(path.filename().string());
    if (at == recorded.end()) continue;
    ++compared;
    REQUIRE(at->second.size() == 9);
    const SphericalHarmonics found = project_file(path).radiance;
    // Recorded with +x a quarter in from the right, where Welkin and OpenEXR have it a quarter in from the
    // left: what is odd in x changes its sign. Their rule is the midpoint's, off by some 7 / width^2.
    constexpr double odd_in_x[9] = {1, 1, 1, -1, -1, 1, 1, -1, 1};
    SphericalHarmonics truth(3);
    for (std::size_t k = 0; k < 9; ++k) truth.coefficients()[k] = odd_in_x[k] * at->second[k];
    CAPTURE(path.filename().string(), relative_error(found, truth));
    const double width = inspect_environment(path).width;
    CHECK(relative_error(found, truth) < 10.0 / (width * width));
  }
  if (fs::exists(WELKIN_SHARED)) CHECK(compared > 0);
}

}  // namespace welkin::test
