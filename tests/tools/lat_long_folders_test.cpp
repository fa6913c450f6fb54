// `welkin bake --for unity, unreal, blender, godot, usd`: the lat-long is the source's own, and nothing is baked that
// no file of the folder holds.
#include "places.h"
#include "platform/text.h"
#include "support/images.h"
#include "tools/command.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

using namespace welkin;
using namespace welkin::test;

namespace {

const std::vector<std::string>& engines() {
  static const std::vector<std::string> all = {"unity", "unreal", "blender", "godot", "usd"};
  return all;
}

std::filesystem::path image_of(const std::string& engine, const std::filesystem::path& folder) {
  return folder / (engine == "unreal" ? "environment.hdr" : "environment.exr");
}

/// Noise that .hdr and halves hold to the last bit: 8 bits times a power of two, blue the largest so that it has all 8.
LatLongImage noise(int width, int height) {
  std::mt19937 random(3);
  LatLongImage image{width, height, {}};
  for (int texel = 0; texel < width * height; ++texel) {
    const double scale = std::exp2(static_cast<double>(random() % 8) - 10.0);
    image.pixels.push_back(static_cast<float>(scale * static_cast<double>(random() % 256)));
    image.pixels.push_back(static_cast<float>(scale * static_cast<double>(random() % 256)));
    image.pixels.push_back(static_cast<float>(scale * static_cast<double>(128 + random() % 128)));
  }
  return image;
}

constexpr const char* kQuick = " --size 8 --no-previews ";

}  // namespace

TEST_CASE("bake --for: a lat-long that nothing turns or cleans is the source's own pixels", "[tools][bake][lat_long]") {
  const TemporaryDirectory scratch;
  const LatLongImage image = noise(100, 50);
  const auto pfm = scratch.path() / "image.pfm";
  write_environment(pfm, image.view());
  for (const std::string& engine : engines()) {
    INFO(engine);
    const auto out = scratch.path() / engine;
    const auto manifest = bake_into(out, quoted(pfm) + " --for " + engine + kQuick);
    CHECK((pixels_in(image_of(engine, out)) == image.pixels));
    const auto said = file_of(manifest, image_of(engine, out).filename().string());
    CHECK(said.at("width") == 100);
    CHECK(said.at("height") == 50);
  }
  // Rotations by whole columns and mirrors only move pixels.
  const auto rotated = scratch.path() / "turned";
  bake_into(rotated, quoted(pfm) + " --for blender --yaw 90 --mirror" + kQuick);
  const glm::dmat3 rotation = rotation_about_y(90.0) * glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  CHECK((pixels_in(rotated / "environment.exr") == to_lat_long(image.view(), 100, 50, rotation).pixels));
  // Floats stay floats where the format requests it.
  LatLongImage fine = image;
  for (float& value : fine.pixels) value = std::nextafter(value, 1e9F);
  write_environment(pfm, fine.view());
  const auto floats = bake_into(rotated, quoted(pfm) + " --for usd --ktx2-format rgba32f" + kQuick);
  CHECK((pixels_in(rotated / "environment.exr") == fine.pixels));
  CHECK(file_of(floats, "environment.exr").at("format") == "OpenEXR float");
}

TEST_CASE("bake --for: what cleans a lat-long changes the pixels that it names and no other",
          "[tools][bake][lat_long]") {
  const TemporaryDirectory scratch;
  LatLongImage image = noise(64, 32);
  image.pixels[3 * 70] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[3 * 71 + 1] = 4096.0F;
  const auto pfm = scratch.path() / "image.pfm";
  write_environment(pfm, image.view());
  const auto out = scratch.path() / "out";
  bake_into(out, quoted(pfm) + " --for godot --clamp 1000" + kQuick);
  image.pixels[3 * 70] = 0.0F;
  image.pixels[3 * 71 + 1] = 1000.0F;
  CHECK((pixels_in(out / "environment.exr") == image.pixels));
  // Without its sun the rest is as it was.
  LatLongImage sunny{64, 32, std::vector<float>(std::size_t{3} * 64 * 32, 0.5F)};
  for (std::size_t c = 0; c < 3; ++c) sunny.pixels[3 * (10 * 64 + 20) + c] = 5e4F;
  for (std::size_t texel = 0; texel < 64 * 32; texel += 7) sunny.pixels[3 * texel] = 0.25F;
  write_environment(pfm, sunny.view());
  const auto manifest = bake_into(out, quoted(pfm) + " --for godot --extract-sun" + kQuick);
  REQUIRE(manifest.at("sun").is_object());
  const std::vector<float> rest = pixels_in(out / "environment.exr");
  CHECK(rest[3 * (10 * 64 + 20)] < 1.0F);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) changed += rest[i] != sunny.pixels[i] ? 1 : 0;
  CHECK(changed <= 27);
}

TEST_CASE("bake --for: the chain that no file holds is not baked, and the plan says so",
          "[tools][bake][lat_long][slow]") {
  const TemporaryDirectory scratch;
  const auto pass_of = [](const nlohmann::json& list, const std::string& name) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& pass) { return pass.at("name") == name; });
    REQUIRE(found != list.end());
    return *found;
  };
  for (const std::string& engine : engines()) {
    INFO(engine);
    const auto out = scratch.path() / engine;
    const auto manifest = bake_into(out, small_image() + " --size 16 --preview-size 16 --for " + engine);
    CHECK(manifest.at("specular").empty());
    CHECK_FALSE(manifest.contains("brdf"));
    for (const char* name : {"specular", "irradiance", "brdf"}) {
      CHECK(pass_of(manifest.at("times"), name).at("action") == "skip");
      CHECK(contains(pass_of(manifest.at("times"), name).at("reason").get<std::string>(), "no file of the folder"));
    }
    CHECK(std::filesystem::exists(out / "preview_environment.png"));
    CHECK_FALSE(std::filesystem::exists(out / "preview_spheres.png"));
    CHECK_FALSE(std::filesystem::exists(out / "preview_mips.png"));
    CHECK(std::filesystem::exists(out / "sh.json"));
  }
  const nlohmann::json plan = json_of(
      run_welkin("bake --sky --for usd --no-previews --plan-only --json -o " + quoted(scratch.path() / "no")).output);
  for (const char* name : {"specular", "background"}) {
    CHECK(pass_of(plan.at("passes"), name).at("action") == "skip");
    CHECK(contains(pass_of(plan.at("passes"), name).at("reason").get<std::string>(), "no file of the folder"));
  }
  // An octahedral map is such a file.
  const auto octahedral =
      bake_into(scratch.path() / "o", small_image() + " --size 16 --no-previews --for godot --octahedral 32");
  CHECK(octahedral.at("specular").size() > 1);
}

TEST_CASE("The table of sharpness in docs/notes/measurements.md", "[.sharpness]") {
  const TemporaryDirectory scratch;
  for (const char* name : {"venice_sunset_1k.hdr", "potsdamer_platz_1k.hdr", "spruit_sunrise_4k.hdr"}) {
    const auto path = std::filesystem::path(WELKIN_SHARED) / "hdr" / "env" / name;
    if (!std::filesystem::exists(path)) continue;
    const Environment source = read_environment(path);
    std::printf("| %s | %.4f |", platform::utf8(path.stem()).c_str(), sharpness(source.lat_long()));
    for (const std::string& engine : engines()) {
      const auto out = scratch.path() / "out";
      bake_into(out, quoted(path) + " --no-previews --for " + engine);
      const Environment written = read_environment(image_of(engine, out));
      std::printf(" %.4f |", sharpness(written.lat_long()));
      std::filesystem::remove_all(out);
    }
    for (const char* rotation : {"--yaw 37.31", "--rotation 0.3,0.2,0.1,0.9"}) {
      const auto out = scratch.path() / "out";
      bake_into(out, quoted(path) + " --no-previews --for blender " + rotation);
      const Environment written = read_environment(out / "environment.exr");
      std::printf(" %.4f |", sharpness(written.lat_long()));
      std::filesystem::remove_all(out);
    }
    std::printf("\n");
  }
}
