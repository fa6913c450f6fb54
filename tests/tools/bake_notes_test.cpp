// What `welkin bake` notes for a person: options in vain or against an engine, and what a format cost.
#include "tools/baked_folder.h"
#include "tools/command.h"

using namespace welkin;
using namespace welkin::test;

TEST_CASE("bake: what an engine's folder does not have, or its shader contradicts, is noted",
          "[tools][bake][notes][slow]") {
  const TemporaryFolder scratch;
  const auto notes = [&](const std::string& options) {
    return bake_into(scratch.path() / "out", "--sky --size 16 --irradiance 4 --no-previews " + options)
        .at("notes")
        .dump();
  };
  CHECK(contains(notes("--for filament --brdf-model multiple-scattering"), "writes no BRDF table"));
  CHECK(contains(notes("--for three --brdf 8"), "writes no BRDF table"));
  CHECK_FALSE(contains(notes("--for filament --formats ktx2 --brdf-model multiple-scattering"), "BRDF"));
  CHECK_FALSE(contains(notes("--for filament"), "BRDF"));
  CHECK(contains(notes("--for three --roughness linear"), "looks the mips up by its own formula"));
  CHECK(contains(notes("--for bevy --roughness 0,0.2,1"), "looks the mips up by its own formula"));
  CHECK_FALSE(contains(notes("--for bevy --roughness 0,0.5,1"), "formula"));
  CHECK_FALSE(contains(notes("--for three --roughness filament"), "formula"));
  CHECK_FALSE(contains(notes("--for three --roughness linear --formats ktx2"), "formula"));
  CHECK(contains(notes("--for blender"), "--background-size"));
  CHECK_FALSE(contains(bake_into(scratch.path() / "out", "--sky --no-previews --for blender").at("notes").dump(),
                       "--background-size"));
}

TEST_CASE("bake: the note on clamped values says how much light that is and what keeps it", "[tools][bake][notes]") {
  const TemporaryFolder scratch;
  const auto input = scratch.path() / "in.pfm";
  std::vector<float> pixels = grey_picture(64, 32, 0.0F);
  for (std::size_t c = 0; c < 3; ++c) pixels[3 * (16 * 64 + 20) + c] = 20.0F * 65504.0F;
  write_pfm(input, 64, 32, pixels);
  const auto notes = [&](const std::string& options) {
    return bake_into(scratch.path() / "out",
                     quoted(input) + " --size 32 --irradiance 4 --brdf 8 --no-previews " + options)
        .at("notes")
        .dump();
  };
  const std::string blender = notes("--for blender");
  CHECK(contains(blender,
                 "environment.exr: 3 values beyond +-65504 clamped: halves end there, which takes 95 % of the "
                 "light away; --ktx2-format rgba32f keeps it, --take-out-sun makes the sun a light of its own"));
  const auto said = file_of(manifest_of(scratch.path() / "out"), "environment.exr");
  CHECK(said.at("share_clamped").get<double>() == Approx(0.95).epsilon(1e-9));
  CHECK_FALSE(contains(notes("--for blender --ktx2-format rgba32f"), "clamped"));
  CHECK(contains(notes("--formats ktx2"), "% of the light away"));
  CHECK(contains(notes("--for babylon"), "RGBD ends there, which takes "));
  for (std::size_t c = 0; c < 3; ++c) pixels[3 * (16 * 64 + 20) + c] = 1e4F * 65504.0F;
  write_pfm(input, 64, 32, pixels);
  CHECK(contains(notes("--for blender"), "takes over 99 % of the light away"));
}
