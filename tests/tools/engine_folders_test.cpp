#include <regex>

#include "files/env.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "tools/command.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

using namespace welkin;
using namespace welkin::test;

// `welkin bake --for ENGINE`: the folder holds what the engine loads as it is, and a README that says how.

namespace {

using Names = std::vector<std::string>;

constexpr const char* kSmall = " --size 32 --irradiance 8 --brdf 8 ";

/// Returns the files of each engine's folder in addition to those that all folders have.
const std::map<std::string, Names>& folders() {
  static const std::map<std::string, Names> all = {
      {"three", {"specular.dds", "specular.ktx2", "specular_uastc.ktx2"}},
      {"babylon", {"environment.env", "specular.dds"}},
      {"filament", {"environment_ibl.ktx", "environment_skybox.ktx"}},
      {"bevy", {"diffuse.ktx2", "specular.ktx2", "specular_bc6h.ktx2"}},
      {"gltf", {"charlie.ktx2", "environment.glb", "ggx.ktx2", "lambertian.ktx2"}},
      {"unity", {"environment.exr"}},
      {"unreal", {"environment.hdr"}},
      {"blender", {"environment.exr"}},
      {"godot", {"environment.exr"}},
      {"playcanvas", {"env_atlas.json", "env_atlas.png"}},
      {"qt", {"environment.ktx"}},
      {"usd", {"environment.exr", "environment.usda"}}};
  return all;
}

/// With a lat-long alone there are no mips and no spheres to show.
Names with_common_files(const std::string& engine, Names names) {
  const bool is_lat_long = std::all_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "environment.exr" || name == "environment.hdr" || name == "environment.usda";
  });
  for (const char* name :
       {"README.md", "manifest.json", "preview_environment.png", engine == "unity" ? "sh.cs" : "sh.h", "sh.json"}) {
    names.emplace_back(name);
  }
  if (!is_lat_long) names.insert(names.end(), {"preview_mips.png", "preview_spheres.png"});
  std::sort(names.begin(), names.end());
  return names;
}

/// The files of a bake's folder that a text names; not those that it names with a folder of another place.
Names files_named_in(const std::string& text) {
  static const std::regex pattern(
      R"((^|[^A-Za-z0-9_/])(?:/|\./|//|res://|Assets/)?([a-z0-9_]+\.(?:ktx2|ktx|dds|exr|hdr|env|glb|png|usda|json|h)\b))");
  Names names;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern); at != std::sregex_iterator(); ++at) {
    names.push_back((*at)[2]);
  }
  return names;
}

void check_readme(const std::filesystem::path& folder) {
  const Names there = names_in(folder);
  const Names named = files_named_in(file_text(folder / "README.md"));
  CHECK_FALSE(named.empty());
  for (const std::string& name : named) {
    INFO(name);
    CHECK(std::find(there.begin(), there.end(), name) != there.end());
  }
}

std::vector<float> numbers_in(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<float>(words), {}};
}

/// Root mean square of the difference, over that of what is wanted.
double difference(std::span<const float> wanted, std::span<const float> got) {
  REQUIRE(wanted.size() == got.size());
  double error = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double off = static_cast<double>(got[i]) - static_cast<double>(wanted[i]);
    error += off * off;
    all += static_cast<double>(wanted[i]) * static_cast<double>(wanted[i]);
  }
  return std::sqrt(error / all);
}

/// A .glb taken apart; requires that header, chunks and buffer views are as glTF 2.0 has them.
struct Glb {
  nlohmann::json document;
  std::string binary;

  explicit Glb(const std::string& bytes) {
    REQUIRE(bytes.starts_with("glTF"));
    REQUIRE(number_at(bytes, 4) == 2);
    REQUIRE(number_at(bytes, 8) == bytes.size());
    const std::size_t text = number_at(bytes, 12);
    REQUIRE(text % 4 == 0);
    REQUIRE(bytes.substr(16, 4) == "JSON");
    document = json_of(bytes.substr(20, text));
    REQUIRE(bytes.substr(24 + text, 4) == std::string("BIN\0", 4));
    binary = bytes.substr(28 + text);
    REQUIRE(number_at(bytes, 20 + text) == binary.size());
    REQUIRE(binary.size() % 4 == 0);
    REQUIRE(document.at("buffers").at(0).at("byteLength").get<std::size_t>() == binary.size());
  }

  [[nodiscard]] std::vector<std::uint8_t> image(std::size_t number) const {
    const nlohmann::json& image = document.at("images").at(number);
    CHECK(image.at("mimeType") == "image/png");
    const nlohmann::json& view = document.at("bufferViews").at(image.at("bufferView").get<std::size_t>());
    const auto offset = view.at("byteOffset").get<std::size_t>();
    const auto length = view.at("byteLength").get<std::size_t>();
    REQUIRE(offset + length <= binary.size());
    return {binary.begin() + static_cast<std::ptrdiff_t>(offset),
            binary.begin() + static_cast<std::ptrdiff_t>(offset + length)};
  }
};

/// The chain of such images, bottom row first.
Cubemap decoded(const Glb& glb, int size, int mips) {
  Cubemap chain(size, mips);
  const files::RgbdDecoder decoder;
  for (int image = 0; image < 6 * mips; ++image) {
    const int edge = size >> (image / 6);
    const std::vector<std::uint8_t> png = glb.image(static_cast<std::size_t>(image));
    std::vector<std::uint8_t> rgbd(static_cast<std::size_t>(4 * edge * edge));
    files::decode_rgba({png, edge, "environment.glb", "an image"}, rgbd.data());
    for (int row = 0; row < edge; ++row) {
      decoder.decode(rgbd.data() + std::ptrdiff_t{4} * edge * (edge - 1 - row), static_cast<std::size_t>(edge),
                     chain.face(image / 6, image % 6) + std::ptrdiff_t{3} * edge * row);
    }
  }
  return chain;
}

/// Mean over all values, for what must be nearly the same.
double mean(const Cubemap& chain, int level) {
  const std::span<const float> values = level_values(chain, level);
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("bake --for: each engine's folder has its files and none of the engine before, and our readers take them",
          "[tools][bake][engine_folders][slow]") {
  const TemporaryFile folder("out");
  for (const auto& [engine, files] : folders()) {
    INFO(engine);
    const nlohmann::json manifest = bake_into(folder, small_image() + " --for " + engine + kSmall);
    CHECK(names_in(folder) == with_common_files(engine, files));
    CHECK(names_of(manifest) == with_common_files(engine, files));
    for (const std::string& name : files) {
      INFO(name);
      const std::filesystem::path path = folder / name;
      const std::string extension = path.extension().string();
      const nlohmann::json said = file_of(manifest, name);
      CHECK(said.at("bytes").get<std::uintmax_t>() == std::filesystem::file_size(path));
      if (extension == ".ktx2" || extension == ".ktx" || extension == ".dds") {
        const CubemapTexture texture = read_texture(path);
        CHECK(texture.cubemap.size() == said.at("size").get<int>());
        CHECK(texture.cubemap.levels() == said.at("mips").get<int>());
      } else if (extension == ".env") {
        CHECK(read_babylon_environment(path).polynomial.has_value());
      } else if (extension == ".exr" || extension == ".hdr") {
        CHECK(inspect_environment(path).layout == Layout::lat_long);
      }
    }
    check_readme(folder);
    const std::string readme = file_text(folder / "README.md");
    for (const std::string& name : files) CHECK(contains(readme, name));
  }
  for (const char* const engine : {"three", "filament"}) {  // what the scene leaves out
    INFO(engine);
    bake_into(folder, small_image() + " --no-previews --no-glossy --for " + engine + kSmall);
    check_readme(folder);
  }
}

TEST_CASE("bake --for: the texels are those of the same bake by --formats", "[tools][bake][engine_folders][slow]") {
  const TemporaryDirectory scratch;
  const auto formats = scratch.path() / "formats";
  const auto folder = scratch.path() / "folder";
  const std::string bake = small_image() + kSmall + "--no-previews --for ";
  bake_into(formats, bake + "three --formats ktx2,dds");
  bake_into(folder, bake + "three");
  CHECK(file_text(folder / "specular.ktx2") == file_text(formats / "specular.ktx2"));
  bake_into(formats, bake + "three --formats dds --ktx2-format bc6h");
  CHECK(file_text(folder / "specular.dds") == file_text(formats / "specular.dds"));
  bake_into(formats, bake + "babylon --formats dds,env");
  bake_into(scratch.path() / "babylon", bake + "babylon");
  for (const char* name : {"specular.dds", "environment.env"}) {
    CHECK(file_text(scratch.path() / "babylon" / name) == file_text(formats / name));
  }
  // Named formats are all that is written, for whichever engine.
  const Names named = names_in(formats);
  CHECK(std::find(named.begin(), named.end(), "README.md") == named.end());
  CHECK(std::find(named.begin(), named.end(), "background.dds") != named.end());
}

TEST_CASE("bake --for filament: the reflections carry the harmonics as cmgen writes them",
          "[tools][bake][engine_folders][slow]") {
  const TemporaryFile folder("out");
  const std::string bake = small_image() + " --for filament --no-previews" + kSmall;
  bake_into(folder, bake);
  const CubemapTexture reflections = read_texture(folder / "environment_ibl.ktx");
  const CubemapTexture skybox = read_texture(folder / "environment_skybox.ktx");
  CHECK(reflections.cubemap.levels() == 5);
  CHECK(skybox.cubemap.levels() == 1);
  CHECK_FALSE(skybox.metadata.contains("sh"));
  const std::string text = reflections.metadata.at("sh");
  CHECK(std::count(text.begin(), text.end(), '\n') == 9);
  const std::vector<float> numbers = numbers_in(text);
  REQUIRE(numbers.size() == 27);
  const nlohmann::json terms = run_sh_json(small_image() + " --for filament").at("engine").at("terms");
  std::size_t at = 0;
  for (const auto& [name, rgb] : terms.items()) {
    for (std::size_t c = 0; c < 3; ++c, ++at)
      CHECK(static_cast<double>(numbers[at]) == Approx(rgb.at(c).get<double>()).epsilon(1e-5));
  }
  // Band 0 of that form is the mean radiance.
  const dvec3 mean_radiance = measure_environment(folder / "environment_skybox.ktx").mean;
  for (int c = 0; c < 3; ++c)
    CHECK(static_cast<double>(numbers[static_cast<std::size_t>(c)]) == Approx(mean_radiance[c]).epsilon(0.02));
  // Without files of harmonics they are there all the same.
  bake_into(folder, bake + "--bands 0");
  CHECK(read_texture(folder / "environment_ibl.ktx").metadata.at("sh") == text);
}

TEST_CASE("bake --for filament: the files are those of cmgen, but for its noise",
          "[tools][bake][engine_folders][posix][slow]") {
  if (run_script("command -v cmgen").exit_code != 0) {
    WARN("left out: there is no cmgen (Debian's libfilament-tools)");
    return;
  }
  const TemporaryDirectory scratch;
  const auto source = scratch.path() / "source";
  std::filesystem::create_directory(source);
  const LatLongImage image = lat_long_of(512, 256, [](const dvec3& d) {
    return dvec3(2.0 + d.x + 0.5 * d.y * d.z, 1.5 + d.y - 0.4 * d.x * d.z, 1.0 + 0.8 * d.z + 0.3 * d.x * d.y * d.z);
  });
  write_environment(source / "environment.hdr", image.view());
  const auto own = scratch.path() / "own";
  bake_into(own, quoted(source / "environment.hdr") +
                     " --for filament --size 256 --mips 5 --fit-lookups off --irradiance 0 --no-previews");
  const std::string cmgen = "cmgen -x " + quoted(scratch.path() / "cm") +
                            " --format=ktx --size=256 --ibl-samples=256 --sh-window=no --quiet " +
                            quoted(source / "environment.hdr");
  REQUIRE(run_script(cmgen).exit_code == 0);
  for (const char* kind : {"ibl", "skybox"}) {
    INFO(kind);
    const auto theirs = scratch.path() / "cm" / (std::string("cm_") + kind + ".ktx");
    const auto ours = own / (std::string("environment_") + kind + ".ktx");
    // identifier, byte order, types and formats, sizes, faces, levels
    CHECK(file_text(ours).substr(0, 60) == file_text(theirs).substr(0, 60));
    const CubemapTexture wanted = read_texture(theirs);
    const CubemapTexture got = read_texture(ours);
    REQUIRE(got.cubemap.levels() == wanted.cubemap.levels());
    for (int level = 0; level < got.cubemap.levels(); ++level) {
      INFO(level);
      CHECK(difference(level_values(wanted.cubemap, level), level_values(got.cubemap, level)) < 0.03);
    }
    if (!wanted.metadata.contains("sh")) continue;
    const std::vector<float> theirs_sh = numbers_in(wanted.metadata.at("sh"));
    const std::vector<float> ours_sh = numbers_in(got.metadata.at("sh"));
    REQUIRE(theirs_sh.size() == 27);
    CHECK(difference(theirs_sh, ours_sh) < 0.01);
  }
}

TEST_CASE("bake --for bevy: faces are mirrored in z, and the diffuse map is irradiance over pi",
          "[tools][bake][engine_folders][slow]") {
  const TemporaryDirectory scratch;
  const std::string options =
      small_image() + " --roughness linear --fit-lookups off --no-previews --ktx2-format rgba32f" + kSmall;
  const auto plain = scratch.path() / "plain";
  const auto folder = scratch.path() / "out";
  bake_into(plain, options + "--formats ktx2");
  bake_into(folder, options + "--for bevy");
  CHECK_FALSE(std::filesystem::exists(folder / "specular_bc6h.ktx2"));  // the format was named
  const Cubemap straight = read_texture(plain / "specular.ktx2").cubemap;
  const Cubemap mirrored = read_texture(folder / "specular.ktx2").cubemap;
  REQUIRE(mirrored.levels() == straight.levels());
  const glm::dmat3 mirror(1, 0, 0, 0, 1, 0, 0, 0, -1);
  for (int level = 0; level < straight.levels(); ++level) {
    const Cubemap wanted = to_cubemap(straight.view(level), straight.level_size(level), mirror);
    const std::span<const float> got = level_values(mirrored, level);
    CHECK(std::ranges::equal(got, wanted.pixels()));
  }
  CHECK_FALSE(same_bits(straight, mirrored));
  const double irradiance = mean(read_texture(plain / "irradiance.ktx2").cubemap, 0);
  CHECK(mean(read_texture(folder / "diffuse.ktx2").cubemap, 0) == Approx(irradiance / 3.14159265).epsilon(0.03));
}

TEST_CASE("bake --for gltf: the light is a .glb whose images are the chain and whose coefficients are sh.json's",
          "[tools][bake][engine_folders][slow]") {
  const TemporaryDirectory scratch;
  const auto folder = scratch.path() / "out";
  const std::string bake = small_image() + " --for gltf --no-previews" + kSmall;
  const nlohmann::json manifest = bake_into(folder, bake);
  const Glb glb(file_text(folder / "environment.glb"));
  const nlohmann::json& document = glb.document;
  CHECK(document.at("asset").at("version") == "2.0");
  CHECK(document.at("extensionsUsed") == nlohmann::json::array({"EXT_lights_image_based"}));
  CHECK(document.at("scenes").at(0).at("extensions").at("EXT_lights_image_based").at("light") == 0);
  const nlohmann::json& light = document.at("extensions").at("EXT_lights_image_based").at("lights").at(0);
  CHECK(light.at("intensity") == 1.0);
  CHECK(light.at("rotation") == nlohmann::json::array({0.0, 0.0, 0.0, 1.0}));
  CHECK(light.at("specularImageSize") == 32);

  // Six images a mip, in this order; alpha = 32^(mip / 2 - 1), where Babylon.js's loader looks.
  CHECK(light.at("specularImages") ==
        nlohmann::json::array({{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}, {12, 13, 14, 15, 16, 17}}));
  CHECK(document.at("images").size() == 18);
  const auto roughness = file_of(manifest, "environment.glb").at("roughness").get<std::vector<double>>();
  REQUIRE(roughness.size() == 3);
  CHECK(roughness[0] == 0.0);
  CHECK(roughness[1] == Approx(std::pow(32.0, -0.25)).epsilon(1e-14));
  CHECK(roughness[2] == 1.0);

  // The loader evaluates the coefficients in its own axes: what is odd in x has the other sign.
  const nlohmann::json engines = json_of(file_text(folder / "sh.json")).at("engines");
  const auto own =
      std::find_if(engines.begin(), engines.end(), [](const auto& each) { return each.at("name") == "gltf"; });
  REQUIRE(own != engines.end());
  std::size_t k = 0;
  for (const auto& [name, rgb] : own->at("terms").items()) {
    const double sign = k == 3 || k == 4 || k == 7 ? -1.0 : 1.0;
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(light.at("irradianceCoefficients").at(k).at(c).get<double>() ==
            Approx(sign * rgb.at(c).get<double>()).epsilon(1e-12));
    }
    ++k;
  }
  CHECK(k == 9);

  // The file has that chain in glTF's faces, mirrored in x. RGBD ends at 255, below the sun; its error is at most 1 %.
  const std::string list = "0," + std::to_string(std::pow(32.0, -0.25)) + ",1";
  const auto chain = scratch.path() / "chain";
  bake_into(chain, bake + "--formats ktx2 --ktx2-format rgba32f --roughness " + list);
  const Cubemap wanted = mirrored_x(read_texture(chain / "specular.ktx2").cubemap);
  const Cubemap got = decoded(glb, 32, 3);
  REQUIRE(wanted.levels() == 3);
  for (int level = 0; level < 3; ++level) {
    INFO(level);
    const std::span<const float> exact = level_values(wanted, level);
    std::vector<float> held(exact.begin(), exact.end());
    for (float& value : held) value = std::min(value, files::kLargestRgbd);
    CHECK(difference(held, level_values(got, level)) < 0.01);
  }
}

TEST_CASE("bake --for usd: the stage is a dome light with the lat-long beside it", "[tools][bake][engine_folders]") {
  const TemporaryFile folder("out");
  bake_into(folder, small_image() + " --for usd" + kSmall);
  const std::string stage = file_text(folder / "environment.usda");
  CHECK(stage.starts_with("#usda 1.0\n"));
  CHECK(contains(stage, "defaultPrim = \"Environment\""));
  CHECK(contains(stage, "upAxis = \"Y\""));
  CHECK(contains(stage, "def DomeLight \"Environment\""));
  CHECK(contains(stage, "token inputs:texture:format = \"latlong\""));
  std::smatch found;
  REQUIRE(std::regex_search(stage, found, std::regex("asset inputs:texture:file = @([^@]+)@")));
  CHECK(std::filesystem::exists(folder / found[1].str()));
  for (const auto& [open, close] : {std::pair{'(', ')'}, std::pair{'{', '}'}}) {
    CHECK(std::count(stage.begin(), stage.end(), open) == 1);
    CHECK(std::count(stage.begin(), stage.end(), close) == 1);
  }
}

TEST_CASE("bake --for: what the engine's loader does not take is refused", "[tools][bake][engine_folders]") {
  const TemporaryDirectory scratch;
  const std::string folder = " -o " + quoted(scratch.path() / "out") + kSmall;
  const auto refused = [&](const std::string& options, const char* words) {
    const CommandResult result = run_welkin("bake --sky " + options + folder);
    CAPTURE(options, result.errors);
    CHECK(result.exit_code != 0);
    CHECK(contains(result.errors, words));
    CHECK_FALSE(std::filesystem::exists(scratch.path() / "out"));
  };
  refused("--for three --supercompression zlib", "--supercompression zstd");
  for (const char* engine : {"three", "gltf", "babylon", "usd"})
    refused(std::string("--ktx2-format bc6h --for ") + engine, "leave --ktx2-format out");
  const auto bevy = scratch.path() / "bevy";
  const auto manifest =
      bake_into(bevy, small_image() + " --for bevy --ktx2-format bc6h --supercompression zlib --no-previews" + kSmall);
  CHECK(file_of(manifest, "specular.ktx2").at("format") == "KTX2 bc6h zlib");
  CHECK(contains(file_text(bevy / "README.md"), "a GPU that supports it"));
}

TEST_CASE("bake --for: a README that is somebody's own is not written over", "[tools][bake][engine_folders][slow]") {
  const TemporaryFile folder("out");
  const std::string bake = small_image() + " --for godot --no-previews" + kSmall;
  bake_into(folder, bake);
  bake_into(folder, bake);  // ours is
  std::ofstream(folder / "README.md") << "# My project\n";
  const std::string message = failure("bake " + bake + "-o " + quoted(folder), 1);
  CHECK(contains(message, "README.md"));
  CHECK(contains(message, "another folder"));
  CHECK(file_text(folder / "README.md") == "# My project\n");
  bake_into(folder, bake + "--formats exr");
  CHECK(file_text(folder / "README.md") == "# My project\n");
}
