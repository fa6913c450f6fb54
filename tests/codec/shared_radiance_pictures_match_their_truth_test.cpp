// Promises: Radiance pictures that other programs wrote, where they are at hand, decode to the pixels that are known to
// be in them.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/catch.h"
#include "support/npy.h"
#include "support/shared_pictures.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

using test::kPictures;
using test::kVariants;
using test::shared_pictures_are_here;

}  // namespace

TEST_CASE("one picture in every Radiance form is the same picture", "[codec][hdr][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const std::vector<float> truth = test::read_npy(kVariants / "truth_256x128.npy");
  REQUIRE(truth.size() == 256 * 128 * 3);
  const auto read = [&](const std::string& name) {
    CAPTURE(name);
    Environment environment = read_environment(kVariants / (name + "_256x128.hdr"));
    REQUIRE(environment.info.format == "Radiance");
    REQUIRE(environment.info.width == 256);
    REQUIRE(environment.info.height == 128);
    return environment;
  };
  for (const std::string name : {"newrle", "oldrle", "flat", "minusX", "plusY", "plusX_minusY", "magic_rgbe"}) {
    CAPTURE(name);
    CHECK(std::memcmp(read(name).pixels.get(), truth.data(), truth.size() * sizeof(float)) == 0);
  }
  CHECK(read("oldrle").info.compression == "old rle");
  CHECK(read("flat").info.compression == "none");

  // EXPOSURE=2 twice, and what is stored is four times the radiance.
  const Environment exposed = read("exposure2x2");
  REQUIRE(exposed.info.notes.size() == 1);
  CHECK(exposed.info.notes[0].find("divided by 4,") != std::string::npos);
  CHECK(std::memcmp(exposed.pixels.get(), truth.data(), truth.size() * sizeof(float)) == 0);

  // XYZ in 8 bits beside the largest of the three: half a step of X, Y, Z, each times its share of R, G, B (at most 3.3
  // for X in red), is what may be lost, and less than 5 % of a texel's largest component.
  const Environment xyz = read("xyze");
  double worst = 0.0;
  double sum_of_errors = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); i += 3) {
    const float largest = std::max({truth[i], truth[i + 1], truth[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = static_cast<double>(xyz.pixels[i + c]) - static_cast<double>(truth[i + c]);
      worst = std::max(worst, std::abs(error) / static_cast<double>(largest));
      sum_of_errors += error;
      sum += static_cast<double>(truth[i + c]);
    }
  }
  CAPTURE(worst, sum_of_errors / sum);
  CHECK(worst < 0.05);
  CHECK(std::abs(sum_of_errors / sum) < 0.01);
}

TEST_CASE("the Radiance environments have the extremes that are on record", "[codec][hdr][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  // From the shared manifest, which other programs made.
  const EnvironmentStatistics spruit = measure_environment(kPictures / "env" / "spruit_sunrise_1k.hdr");
  CHECK(spruit.maximum == glm::dvec3(222208.0, 154624.0, 44032.0));
  const EnvironmentStatistics venice = measure_environment(kPictures / "env" / "venice_sunset_1k.hdr");
  CHECK(venice.maximum.r == 6496.0);
  CHECK(venice.maximum.g == 992.0);
  const EnvironmentStatistics night = measure_environment(kPictures / "env" / "dikhololo_night_1k.hdr");
  CHECK(night.maximum == glm::dvec3(115.0, 63.5, 43.0));
}

}  // namespace welkin
