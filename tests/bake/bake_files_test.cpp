// Promise: a file bakes as what is in it; an .env file keeps its polynomial.
#include <cstring>
#include <glm/geometric.hpp>
#include <vector>

#include "bake/baked.h"
#include "places.h"
#include "support/catch.h"
#include "support/shared_pictures.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/babylon_environment.h"
#include "welkin/bake.h"
#include "welkin/environment_writer.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"

namespace welkin::test {

TEST_CASE("A file bakes as its pixels do", "[bake][codec]") {
  const TemporaryDirectory directory;
  const TestLatLong picture = make_lat_long(Content::high_range, 64, 32, 3);
  write_environment(directory.file("sky.pfm"), picture.view());
  std::vector<double> reports;
  const Control control{{}, [&](double done) { reports.push_back(done); }};
  BakeResult found = bake_file(directory.file("sky.pfm"), {}, small_bake(), control);
  REQUIRE(!reports.empty());
  CHECK(std::is_sorted(reports.begin(), reports.end()));
  CHECK(reports.back() == 1.0);
  REQUIRE(!found.diagnostics.passes.empty());
  CHECK(found.diagnostics.passes.front().name == "read");
  CHECK(found.diagnostics.passes.front().reason.find("PFM") != std::string::npos);
  CHECK(!found.stored_polynomial);
  found.diagnostics.passes.erase(found.diagnostics.passes.begin());
  CHECK(same_bits(found, bake(picture.view(), small_bake())));
}

TEST_CASE("A cubemap's file bakes as the cubemap", "[bake][codec]") {
  const TemporaryDirectory directory;
  const TestCubemap cubemap = make_cubemap(Content::high_range, 16, 3, 3);
  write_environment(directory.file("sky.hdr"), cubemap.view());
  const Environment read = read_environment(directory.file("sky.hdr"));
  BakeResult found = bake_file(directory.file("sky.hdr"), {}, small_bake());
  found.diagnostics.passes.erase(found.diagnostics.passes.begin());
  CHECK(same_bits(found, bake(read.cubemap(), small_bake())));
}

TEST_CASE("An .env file is baked in our axes and keeps its polynomial", "[bake][codec]") {
  const TemporaryDirectory directory;
  CubemapChain chain(16, full_chain_levels(16));
  for (int level = 0; level < chain.levels(); ++level) {
    const TestCubemap pixels = make_cubemap(Content::smooth, chain.level_size(level), 3, 3);
    std::memcpy(chain.face(level, 0), pixels.pixels.data(), pixels.pixels.size() * sizeof(float));
  }
  const SphericalHarmonics radiance = project(chain.view(0)).radiance;
  BabylonEnvironment environment = to_babylon(chain, radiance);
  environment.polynomial->xx = {41.0, 42.0, 43.0};  // one that no pixels have
  write_babylon_environment(directory.file("sky.env"), environment);

  BakeResult found = bake_file(directory.file("sky.env"), {}, small_bake());
  REQUIRE(found.stored_polynomial);
  CHECK(found.stored_polynomial->xx == glm::dvec3(41.0, 42.0, 43.0));
  CHECK(pass_named(found, "project").action == "reuse");
  CHECK(found.diagnostics.passes.front().name == "read");
  // That is also where the coefficients and the irradiance come from.
  const Projection stored = project_file(directory.file("sky.env"));
  REQUIRE(found.radiance);
  CHECK(same_bytes<glm::dvec3>(found.radiance->coefficients(), stored.radiance.coefficients()));
  CHECK(same_bits(found.irradiance, irradiance_cubemap(irradiance_from_radiance(stored.radiance), 5)));
  CHECK(same_bits(found.diagnostics.flux, stored.diagnostics.flux));
  CHECK(found.diagnostics.texels == 6 * 16 * 16);

  // More bands are not in it. RGBD rounds to some parts of a thousand: the same picture, the same way round.
  BakeOptions more = small_bake();
  more.bands = 4;
  const BakeResult projected = bake_file(directory.file("sky.env"), {}, more);
  CHECK(pass_named(projected, "project").action == "run");
  CHECK(projected.stored_polynomial);
  for (std::size_t k = 0; k < 9; ++k) {
    INFO("coefficient " << k);
    CHECK(glm::length(projected.radiance->coefficients()[k] - radiance.coefficients()[k]) < 0.01);
  }
}

TEST_CASE("A real .env file bakes and keeps its polynomial", "[bake][codec]") {
  const std::filesystem::path folder = std::filesystem::path(WELKIN_SHARED) / "oracles" / "web" / "env";
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".env") files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    WARN("left out: no .env files at " << folder);
    return;
  }
  for (const auto& file : files) {
    INFO(file);
    const BakeResult found = bake_file(file, {}, small_bake());
    const BabylonEnvironment stored = read_babylon_environment(file);
    REQUIRE(stored.polynomial);
    REQUIRE(found.stored_polynomial);
    CHECK(std::memcmp(&*found.stored_polynomial, &*stored.polynomial, sizeof(BabylonPolynomial)) == 0);
  }
}

TEST_CASE("Files that cannot be baked say why", "[bake][codec]") {
  const TemporaryDirectory directory;
  CHECK(thrown_by([&] { static_cast<void>(bake_file(directory.file("none.hdr"))); }).code == ErrorCode::file_access);
  write_bytes(directory.file("text.hdr"), {'n', 'o'});
  CHECK(thrown_by([&] { static_cast<void>(bake_file(directory.file("text.hdr"))); }).says("text.hdr"));
  const TestLatLong picture = make_lat_long(Content::nan_bearing, 64, 32, 3);
  write_environment(directory.file("nan.pfm"), picture.view());
  BakeOptions options = small_bake();
  options.pixels.nan = NonFinitePolicy::reject;
  const ThrownError error = thrown_by([&] { static_cast<void>(bake_file(directory.file("nan.pfm"), {}, options)); });
  CHECK(error.code == ErrorCode::rejected_pixel);
  CHECK(error.says("nan.pfm"));
  CHECK(error.says("row"));
}

}  // namespace welkin::test
