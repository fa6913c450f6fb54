// Promise: on the real environments of ../shared the bands' errors stay within what docs/irradiance.md says.
#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "welkin/environment_file.h"
#include "welkin/irradiance.h"
#include "welkin/windowing.h"

namespace welkin::test {

namespace fs = std::filesystem;

TEST_CASE("Bands of real environments are off by no more than the docs say", "[sh][irradiance][shared]") {
  const fs::path folder = fs::path(WELKIN_SHARED) / "hdr" / "env";
  if (!fs::exists(folder)) {
    WARN("no real environments: " << folder << " is not there");
    return;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".exr") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  double worst_of_three = 0.0;
  for (const fs::path& file : files) {
    const Environment environment = read_environment(file);
    if (environment.info.layout != Layout::lat_long) continue;
    const SphericalHarmonics radiance = project(environment.lat_long(), {.bands = 7}).radiance;
    const auto errors = irradiance_errors(environment.lat_long(), radiance, 40);  // few, for the time they take
    CAPTURE(file.filename().string());
    CHECK(errors[0].rms < 0.75);
    CHECK(errors[1].rms < 0.38);
    CHECK(errors[2].rms < 0.085);
    CHECK(errors[2].maximum < 0.22);
    CHECK(errors[3].rms < errors[2].rms * 1.0001);
    CHECK(errors[4].rms < 0.045);
    CHECK(errors[6].rms < 0.03);
    CHECK(errors[6].rms < 0.5 * errors[2].rms);
    worst_of_three = std::max(worst_of_three, errors[2].rms);
  }
  CHECK(worst_of_three > 0.06);
}

TEST_CASE("The least window repairs the real environments that ring, and leaves the others alone",
          "[sh][window][shared]") {
  const fs::path folder = fs::path(WELKIN_SHARED) / "hdr" / "env";
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".exr") continue;
    if (inspect_environment(entry.path()).layout != Layout::lat_long) continue;
    const SphericalHarmonics radiance = project_file(entry.path()).radiance;
    const Windowed windowed = apply_window(radiance, Window::least);
    const glm::dvec3 mean = std::numbers::pi * average_radiance(radiance);
    CAPTURE(entry.path().filename().string(), windowed.parameter);
    double before = 1.0;
    for (int c = 0; c < 3; ++c) {
      CHECK(windowed.minimum_after[c] >= -1e-9 * mean[c]);
      before = std::min(before, windowed.minimum_before[c] / mean[c]);
    }
    CHECK((windowed.parameter > 0.0) == (before < -1e-9));
    CHECK(before > -0.06);
    CHECK(windowed.parameter < 0.01);
  }
}

}  // namespace welkin::test
