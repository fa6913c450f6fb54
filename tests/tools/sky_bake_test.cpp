// `welkin sky -o DIR`: the bundle is that of `welkin bake` of the picture that lies beside it.
#include <glm/geometric.hpp>

#include "tools/baked_folder.h"
#include "tools/sky_command.h"
#include "tools/temporary_folder.h"
#include "welkin/environment_file.h"
#include "welkin/sky_view.h"
#include "welkin/texture_file.h"

using namespace welkin;
using namespace welkin::test;

namespace {

const std::string kSmallBake = "--irradiance 16 --brdf 16 ";

nlohmann::json bake_sky(const std::filesystem::path& folder, const std::string& arguments) {
  const CommandResult result = run_welkin("sky " + kSmallSky + kSmallBake + arguments + " -o " + quoted(folder));
  INFO("welkin sky " << arguments << "\nstandard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return manifest_of(folder);
}

}  // namespace

TEST_CASE("sky -o: the files are those of a bake of sky.exr", "[tools][sky][bake]") {
  const TemporaryFolder scratch;
  const auto sky = scratch.path() / "sky";
  const auto baked = scratch.path() / "baked";
  for (const std::string& engine : {std::string(), std::string("--for unreal ")}) {
    const nlohmann::json manifest =
        bake_sky(sky, engine + "--sun-elevation 20 --picture-height 64 --no-previews --formats ktx2,dds,exr,env");
    CHECK(names_in(sky) == names_of(manifest));
    bake_into(baked, engine + kSmallBake +
                         "--size 32 --mips all --background-size 128 --no-previews --formats ktx2,dds,exr,env " +
                         quoted(sky / "sky.exr"));
    std::vector<std::string> names = names_in(baked);
    names.insert(std::upper_bound(names.begin(), names.end(), "sky.exr"), "sky.exr");
    REQUIRE(names_in(sky) == names);
    for (const std::string& name : names_in(baked)) {
      if (name == "manifest.json" || name == "sh.json" || name == "sh.h") continue;  // they name their source
      INFO(name);
      CHECK((file_text(sky / name) == file_text(baked / name)));
    }
    const auto ours = nlohmann::json::parse(file_text(sky / "sh.json"));
    const auto theirs = nlohmann::json::parse(file_text(baked / "sh.json"));
    CHECK(ours.at("radiance") == theirs.at("radiance"));
    CHECK(ours.at("engines") == theirs.at("engines"));
  }
}

TEST_CASE("sky -o: sky.exr is the library's picture, the sun apart unless asked for", "[tools][sky][bake]") {
  const TemporaryFolder scratch;
  const auto out = scratch.path() / "out";
  const auto tables = small_sky();
  const SkyView view(tables, 0.0);
  const glm::dvec3 sun = sun_direction(30.0, 40.0);
  for (const bool inside : {false, true}) {
    const nlohmann::json manifest =
        bake_sky(out, std::string("--sun-elevation 30 --sun-azimuth 40 --picture-height 48 --no-previews ") +
                          (inside ? "--sun-disc" : ""));
    const Environment stored = read_environment(out / "sky.exr");
    const LatLongImage expected = sky_lat_long(view, sun, 48, {.sun_disc = inside});
    REQUIRE(stored.info.width == 96);
    const auto* pixels = static_cast<const float*>(stored.lat_long().pixels);
    CHECK(std::equal(expected.pixels.begin(), expected.pixels.end(), pixels));
    CHECK(manifest.contains("sun") == !inside);
    CHECK(manifest.at("sky").at("sun_elevation_degrees") == 30.0);
    if (!inside) {
      CHECK(rgb_of(manifest.at("sun").at("irradiance")) == view.sun(sun).irradiance);
      CHECK(rgb_of(manifest.at("sun").at("direction")) == view.sun(sun).direction);
    }
    const auto sh = nlohmann::json::parse(file_text(out / "sh.json"));
    CHECK(sh.contains("sun") == !inside);
  }
}

TEST_CASE("sky -o: sizes, and the manifest on standard output", "[tools][sky][bake]") {
  const TemporaryFolder scratch;
  const auto out = scratch.path() / "out";
  const nlohmann::json manifest = bake_sky(out, "--picture-height 32 --no-previews");
  CHECK(read_texture(out / "specular.ktx2").cubemap.size() == 32);
  CHECK(read_texture(out / "specular.ktx2").cubemap.levels() == 6);
  CHECK(read_texture(out / "background.ktx2").cubemap.size() == 128);
  CHECK(manifest.at("source").at("path") == "sky");
  bake_sky(out, "--picture-height 16 --roughness 0,0.5,1 --no-previews");
  CHECK(read_texture(out / "specular.ktx2").cubemap.levels() == 3);
  bake_sky(out, "--picture-height 33 --size 7 --background-size 5 --no-previews --bands 5");
  CHECK(read_texture(out / "specular.ktx2").cubemap.size() == 7);
  CHECK(read_texture(out / "background.ktx2").cubemap.size() == 5);
  CHECK(nlohmann::json::parse(file_text(out / "sh.json")).at("bands") == 5);
  const CommandResult result =
      run_welkin("sky " + kSmallSky + kSmallBake + "--json --picture-height 16 --no-previews -o " + quoted(out));
  CHECK(result.exit_code == 0);
  CHECK(result.output == file_text(out / "manifest.json"));
  CHECK(run_welkin("sky " + kSmallSky + " -o /proc/welkin").exit_code == 1);
}
