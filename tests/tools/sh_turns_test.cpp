// `welkin sh` turns the light: --yaw, --mirror, --rotation, --from, --for.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "support/catch.h"
#include "tools/command.h"
#include "tools/pfm_file.h"
#include "tools/temporary_folder.h"
#include "welkin/babylon.h"
#include "welkin/convention.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/projection.h"

using namespace welkin;
using namespace welkin::test;

namespace {

glm::dvec3 triple(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

SphericalHarmonics radiance_of(const nlohmann::json& json) {
  SphericalHarmonics harmonics(json.at("bands").get<int>());
  for (std::size_t i = 0; i < harmonics.coefficients().size(); ++i) {
    harmonics.coefficients()[i] = triple(json.at("radiance").at(i));
  }
  return harmonics;
}

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

TEST_CASE("sh: yaw takes +z to +x, and a quaternion does the same", "[tools]") {
  const SphericalHarmonics plain = radiance_of(run_sh_json("--bands 4"));
  const SphericalHarmonics turned = radiance_of(run_sh_json("--bands 4 --yaw 90"));
  CHECK(glm::length(turned.at(1, 1) - plain.at(1, 0)) < 1e-12);
  CHECK(glm::length(turned.at(1, -1) - plain.at(1, -1)) < 1e-12);
  CHECK(distance(turned, rotate(plain, glm::angleAxis(std::acos(-1.0) / 2.0, glm::dvec3(0, 1, 0)))) < 1e-12);
  const std::string half = std::to_string(std::sqrt(0.5));
  CHECK(distance(turned, radiance_of(run_sh_json("--bands 4 --rotation 0," + half + ",0," + half))) < 1e-12);
  CHECK(distance(plain, radiance_of(run_sh_json("--bands 4 --yaw 30 --rotation 0,0.25881904510252074,0,"
                                                "-0.9659258262890683"))) < 1e-12);
  CHECK(distance(plain, radiance_of(run_sh_json("--bands 4 --yaw 360"))) == 0.0);
}

TEST_CASE("sh: a mirror changes the sign of what is odd in x", "[tools]") {
  const SphericalHarmonics plain = radiance_of(run_sh_json("--bands 3"));
  const SphericalHarmonics mirrored = radiance_of(run_sh_json("--bands 3 --mirror"));
  for (int l = 0; l < 3; ++l) {
    for (int m = -l; m <= l; ++m) {
      // Y(l, m) ~ x: (1, 1); xy: (2, -2); xz: (2, 1)
      const bool odd = (l == 1 && m == 1) || (l == 2 && (m == -2 || m == 1));
      CHECK(glm::length(mirrored.at(l, m) - (odd ? -1.0 : 1.0) * plain.at(l, m)) < 1e-12);
    }
  }
}

TEST_CASE("sh: --for turns to the engine's axes, whose lat-long centre the sun is near", "[tools]") {
  const SphericalHarmonics plain = radiance_of(run_sh_json(""));
  for (const Convention& engine : conventions()) {
    INFO(engine.name);
    const nlohmann::json json = run_sh_json(std::string("--for ") + engine.name);
    CHECK(json.at("axes").at("engine") == engine.name);
    CHECK(distance(radiance_of(json), transform(plain, engine.from_welkin)) < 1e-12);
  }
}

TEST_CASE("sh: a cubemap of an engine, for that engine, is taken as it is", "[tools]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "faces.pfm";
  write_pfm(path, 4, 24, uneven_strip(4));
  const nlohmann::json as_it_is = run_sh_json(quoted(path));
  const nlohmann::json babylon = run_sh_json("--from babylon --for babylon " + quoted(path));
  CHECK(distance(radiance_of(as_it_is), radiance_of(babylon)) < 1e-12);
  const BabylonPolynomial polynomial = babylon_polynomial(radiance_of(babylon));
  CHECK(glm::length(triple(babylon.at("babylon").at("zx")) - polynomial.zx) < 1e-12);

  // three.js looks the other way along x into its cube textures.
  const nlohmann::json three = run_sh_json("--from three --for three " + quoted(path));
  const SphericalHarmonics mirrored = transform(radiance_of(as_it_is), glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1));
  CHECK(distance(radiance_of(three), mirrored) < 1e-12);
}

TEST_CASE("sh: what cannot be turned is refused", "[tools]") {
  CHECK(run_welkin("sh --rotation 0,0,0,0").exit_code == 2);
  CHECK(run_welkin("sh --rotation 1,2,3").exit_code == 2);
  CHECK(run_welkin("sh --yaw nan").exit_code == 2);
  CHECK(run_welkin("sh --for godzilla").exit_code == 2);
  const TemporaryFolder folder;
  const auto path = folder.path() / "faces.pfm";
  write_pfm(path, 4, 24, uneven_strip(4));
  const CommandResult blender = run_welkin("sh --from blender " + quoted(path));
  CHECK(blender.exit_code == 2);
  CHECK(contains(blender.errors, "Blender"));
  CHECK(contains(blender.errors, "no cube faces"));
}
