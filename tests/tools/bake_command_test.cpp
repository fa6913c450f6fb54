
#include "support/chains.h"
#include "support/exr_files.h"
#include "support/same_bits.h"
#include "tools/command.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"

using namespace welkin;
using namespace welkin::test;

// `welkin bake`: the folder holds the files of the manifest, and the files hold the requested results.

namespace {

constexpr const char* kSmall = " --size 16 --irradiance 8 --brdf 16 ";

void check_manifest_matches(const std::filesystem::path& folder) {
  const nlohmann::json manifest = manifest_of(folder);
  CHECK(names_in(folder) == names_of(manifest));
  for (const auto& file : manifest.at("files")) {
    INFO(file.dump());
    CHECK(std::filesystem::file_size(folder / file.at("name").get<std::string>()) ==
          file.at("bytes").get<std::uintmax_t>());
    CHECK(file.at("bytes").get<std::uintmax_t>() > 0);
  }
}

std::vector<float> texels(const Cubemap& chain, int level) {
  const std::span<const float> values = level_values(chain, level);
  return {values.begin(), values.end()};
}

/// Whether this build packs such textures: it may lack astcenc.
bool is_built(const TextureOptions& options) {
  std::vector<std::byte> bytes;
  try {
    write_texture({bytes, "some.ktx2"}, noisy_chain(4, 1).views(), options);
  } catch (const Error& error) {
    return error.code() != ErrorCode::unsupported_file;
  }
  return true;
}

}  // namespace

TEST_CASE("bake: the built-in sky fills a folder that was not there", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto folder = scratch.path() / "some" / "where";
  const std::string said = printed_by("bake --sky --formats ktx2,env -o " + quoted(folder) + kSmall);
  for (const char* name : {"background.ktx2", "specular.ktx2", "irradiance.ktx2", "environment.env", "sh.json", "sh.h",
                           "preview_environment.png", "preview_spheres.png", "preview_mips.png", "manifest.json"}) {
    INFO(name);
    CHECK(contains(said, name));
    CHECK(std::filesystem::exists(folder / name));
  }
  check_manifest_matches(folder);
}

TEST_CASE("bake: textures, metadata and manifest agree about the mips", "[tools][bake][slow]") {
  const TemporaryFile folder("out");
  const auto manifest = bake_into(folder, small_image() +
                                              " --size 32 --mips 5 --roughness filament --background-size 24 "
                                              "--irradiance 7 --no-previews --formats ktx2,env");
  const std::vector<double> wanted = mip_roughness(RoughnessSchedule::filament, 5, 32);

  const CubemapTexture specular = read_texture(folder / "specular.ktx2");
  CHECK(specular.cubemap.size() == 32);
  CHECK(specular.cubemap.levels() == 5);
  const auto said = file_of(manifest, "specular.ktx2");
  CHECK(said.at("roughness").get<std::vector<double>>() == wanted);
  std::istringstream words(specular.metadata.at("welkin.roughness"));
  const std::vector<double> stored{std::istream_iterator<double>(words), {}};
  CHECK(stored == wanted);
  REQUIRE(manifest.at("specular").size() == 5);
  for (std::size_t mip = 0; mip < 5; ++mip) {
    CHECK(manifest.at("specular").at(mip).at("size") == 32 >> mip);
    CHECK(manifest.at("specular").at(mip).at("error_estimate").get<double>() <= 0.01);
  }
  CHECK(read_texture(folder / "background.ktx2").cubemap.size() == 24);
  CHECK(read_texture(folder / "irradiance.ktx2").cubemap.size() == 7);

  const BabylonEnvironment env = read_babylon_environment(folder / "environment.env");
  CHECK(env.specular.size() == 32);
  CHECK(env.specular.levels() == 6);
  CHECK(env.polynomial.has_value());
  CHECK(file_of(manifest, "environment.env").at("roughness").get<std::vector<double>>() ==
        mip_roughness(RoughnessSchedule::babylon, 6, 32));
}

TEST_CASE("bake: --lobe writes chains by other lobes, --octahedral the specular one as a map", "[tools][bake][slow]") {
  const TemporaryFile folder("out");
  bake_into(folder, small_image() +
                        " --size 32 --irradiance 8 --brdf 8 --no-previews --formats ktx2,exr --ktx2-format rgba32f "
                        "--lobe charlie,lambert,phong --octahedral 32");
  check_manifest_matches(folder);
  const CubemapTexture charlie = read_texture(folder / "charlie.ktx2");
  CHECK(charlie.cubemap.size() == 32);
  CHECK(charlie.cubemap.levels() == 5);
  CHECK(contains(charlie.metadata.at("welkin.roughness"), "0.05 "));
  CHECK(read_texture(folder / "phong.ktx2").cubemap.levels() == 5);
  const CubemapTexture lambert = read_texture(folder / "lambert.ktx2");
  const CubemapTexture irradiance = read_texture(folder / "irradiance.ktx2");
  REQUIRE(lambert.cubemap.levels() == 1);
  REQUIRE(lambert.cubemap.size() == irradiance.cubemap.size());
  const std::vector<float> over_pi = texels(lambert.cubemap, 0);
  const std::vector<float> whole = texels(irradiance.cubemap, 0);
  const auto sum = [](const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); };
  CHECK(std::abs(3.14159265 * sum(over_pi) - sum(whole)) < 1e-3 * sum(whole));
  const auto said = file_of(manifest_of(folder), "specular_octahedral.ktx2");
  CHECK(said.at("size") == 32);
  CHECK(said.at("border") == 8);
  CHECK(said.at("mips") == 4);
  CHECK(std::filesystem::exists(folder / "specular_octahedral_m3.exr"));
  CHECK(run_welkin("bake --sky -o " + quoted(folder) + " --lobe velvet").exit_code == 2);
}

TEST_CASE("bake: --rms-error bounds reflections and irradiance, and the manifest says so", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto in = scratch.path() / "in.pfm";
  write_pfm(in, 32, 16, some_pixels(32, 16));
  const std::string options =
      quoted(in) + " --size 8 --irradiance 6 --no-brdf --no-previews --formats ktx2 --ktx2-format rgba32f ";
  const auto said = [&](const std::string& more) {
    return bake_into(scratch.path() / "out", options + more).at("options");
  };
  const auto irradiance = [&] { return texels(read_texture(scratch.path() / "out" / "irradiance.ktx2").cubemap, 0); };
  const nlohmann::json usual = said("");
  CHECK(usual.at("rms_error") == 1e-3);
  CHECK(usual.at("maximum_error") == 1e-2);
  CHECK(usual.at("irradiance_method") == "automatic");
  const nlohmann::json loose = said("--rms-error 1e-2");
  CHECK(loose.at("rms_error") == 1e-2);
  CHECK(loose.at("maximum_error") == 0.1);
  const nlohmann::json fast = said("--quality fast");
  CHECK(fast.at("rms_error") == 1e-2);
  CHECK(fast.at("maximum_error") == 0.1);
  CHECK(said("--quality reference --rms-error 2e-3").at("method") == "automatic");  // the bound wins
  static_cast<void>(said("--irradiance-method direct"));
  const std::vector<float> truth = irradiance();
  CHECK(said("--irradiance-method harmonics").at("irradiance_method") == "harmonics");
  CHECK(irradiance() != truth);
  static_cast<void>(said("--rms-error 1e-6 --method reference --roughness 0,1"));
  CHECK(irradiance() == truth);  // harmonics are never that exact
  CHECK(said("--quality reference --roughness 0,1").at("method") == "reference");
  CHECK(irradiance() == truth);
}

TEST_CASE("bake: lobes are fitted to lookups for engines that interpolate by a formula", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto in = scratch.path() / "in.pfm";
  write_pfm(in, 128, 64, some_pixels(128, 64));
  const auto manifest = [&](const std::string& more) {
    return bake_into(scratch.path() / "out",
                     quoted(in) + " --size 32 --mips 4 --irradiance 4 --no-brdf --no-previews " + more);
  };
  const auto of_mips = [](const nlohmann::json& said, const char* what) {
    std::vector<double> numbers;
    for (const nlohmann::json& mip : said.at("specular")) numbers.push_back(mip.at(what));
    return numbers;
  };
  const std::vector<double> filament = mip_roughness(RoughnessSchedule::filament, 4, 32);
  const std::vector<double> fitted = fitted_mip_roughness(RoughnessSchedule::filament, 4, 32);
  const nlohmann::json on = manifest("--for filament");
  CHECK(on.at("options").at("fit_lookups") == true);
  CHECK(of_mips(on, "roughness") == filament);  // where the shader looks
  CHECK(of_mips(on, "lobe_roughness") == fitted);
  CHECK(on.at("specular").at(1).at("error_between").get<double>() > 0.0);
  CHECK(on.at("specular").at(3).at("error_between").is_null());
  for (const char* off : {"--for filament --fit-lookups off", "--formats ktx2", "--for three"})
    CHECK(of_mips(manifest(off), "lobe_roughness") == filament);
  CHECK(of_mips(manifest("--formats ktx2 --fit-lookups on"), "lobe_roughness") == fitted);
  CHECK(run_welkin("bake --sky --fit-lookups on --roughness 0,1 -o " + quoted(scratch.path() / "no")).exit_code != 0);
}

TEST_CASE("bake: every container holds the same light", "[tools][bake][slow]") {
  const TemporaryFile folder("out");
  bake_into(folder,
            small_image() +
                " --formats ktx2,dds,exr,hdr,pfm --ktx2-format rgba32f --supercompression zstd --mips 5 --no-previews" +
                kSmall);
  check_manifest_matches(folder);
  const CubemapTexture ktx2 = read_texture(folder / "specular.ktx2");
  const CubemapTexture dds = read_texture(folder / "specular.dds");
  REQUIRE(ktx2.cubemap.levels() == 5);
  REQUIRE(dds.cubemap.levels() == 5);
  for (int level = 0; level < 5; ++level) {
    const std::vector<float> wanted = texels(ktx2.cubemap, level);
    CHECK(texels(dds.cubemap, level) == wanted);
    const std::string number = std::to_string(level);
    CHECK(pixels_in(folder / ("specular_m" + number + ".pfm")) == wanted);
    const Environment exr = read_environment(folder / "specular.exr", {.level = level});
    REQUIRE(exr.face_size() == 16 >> level);
    CHECK(std::equal(wanted.begin(), wanted.end(), exr.pixels.get()));
    const Environment hdr = read_environment(folder / ("specular_m" + number + ".hdr"));
    float worst = 0.0F;
    for (std::size_t i = 0; i < wanted.size(); i += 3) {
      const float largest = std::max({wanted[i], wanted[i + 1], wanted[i + 2]});
      for (std::size_t c = i; c < i + 3; ++c) worst = std::max(worst, std::abs(hdr.pixels[c] - wanted[c]) / largest);
    }
    CHECK(worst < 1.0F / 128.0F);
  }
  for (const char* name : {"environment.exr", "environment.hdr", "environment.pfm"}) {
    CHECK(inspect_environment(folder / name).width == 64);
  }
}

TEST_CASE("bake: --ktx2-format bc6h, astc4x4 and astc6x6 pack background and reflections, and nothing else",
          "[tools][bake][astc][slow]") {
  const TemporaryDirectory scratch;
  const std::string bake =
      small_image() + " --size 32 --mips 2 --irradiance 8 --brdf 16 --no-previews --formats ktx2,dds --ktx2-format ";
  const auto blocks = scratch.path() / "blocks";
  const auto floats = scratch.path() / "floats";
  bake_into(floats, bake + "rgba32f");
  const TextureOptions bc6h{.format = TexelFormat::bc6h_ufloat, .bc6h_effort = Bc6hEffort::slow};
  TextureOptions astc{.format = TexelFormat::astc_4x4_hdr, .astc_effort = AstcEffort::fastest};
  const auto check = [&](const std::string& word, const std::string& effort, const TextureOptions& options) {
    INFO(word);
    if (!is_built(options)) return;
    const nlohmann::json manifest = bake_into(blocks, bake + word + effort);
    check_manifest_matches(blocks);
    const bool in_dds = options.format == TexelFormat::bc6h_ufloat;
    for (const std::string name : {"background", "specular"}) {
      CHECK(file_of(manifest, name + ".ktx2").at("format") == "KTX2 " + word);
      CHECK(file_of(manifest, name + ".dds").at("format") == (in_dds ? "DDS bc6h" : "DDS rgba16f"));
      // The blocks equal those that the library makes of the same floats with the requested effort.
      const CubemapTexture given = read_texture(floats / (name + ".ktx2"));
      std::vector<std::byte> bytes;
      write_texture({bytes, "wanted.ktx2"}, given.cubemap.views(), options);
      const Cubemap wanted = read_texture({std::as_const(bytes), "wanted.ktx2"}).cubemap;
      CHECK(same_bits(read_texture(blocks / (name + ".ktx2")).cubemap, wanted));
      if (in_dds) CHECK(same_bits(read_texture(blocks / (name + ".dds")).cubemap, wanted));
    }
    for (const char* const name : {"irradiance.ktx2", "brdf.ktx2"}) {
      CHECK(file_of(manifest, name).at("format") == "KTX2 rgba16f");
    }
  };
  check("bc6h", " --bc6h-effort slow", bc6h);
  check("astc4x4", " --astc-effort fastest", astc);
  astc.format = TexelFormat::astc_6x6_hdr;
  check("astc6x6", " --astc-effort fastest", astc);
}

TEST_CASE("bake: its own textures and .env are sources too", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto first = scratch.path() / "first";
  const auto second = scratch.path() / "second";
  bake_into(first, small_image() + " --ktx2-format rgba32f --formats ktx2,dds,env --no-previews" + kSmall);
  const std::vector<float> wanted = texels(read_texture(first / "specular.ktx2").cubemap, 0);
  bake_into(second, quoted(first / "specular.ktx2") + " --ktx2-format rgba32f --no-previews" + kSmall);
  CHECK(texels(read_texture(second / "specular.ktx2").cubemap, 0) == wanted);
  bake_into(second, quoted(first / "specular.dds") + " --ktx2-format rgba32f --no-previews" + kSmall);
  CHECK(texels(read_texture(second / "specular.ktx2").cubemap, 0) == wanted);
  // Out of Babylon.js's axes and into them again: an .env of an .env keeps faces and polynomial.
  bake_into(second, quoted(first / "environment.env") + " --no-previews --formats ktx2,env" + kSmall);
  const BabylonEnvironment before = read_babylon_environment(first / "environment.env");
  const BabylonEnvironment after = read_babylon_environment(second / "environment.env");
  // By way of the harmonics that it was made of.
  for (int c = 0; c < 3; ++c) {
    CHECK(after.polynomial->x[c] == Approx(before.polynomial->x[c]).epsilon(1e-13));
    CHECK(after.polynomial->zx[c] == Approx(before.polynomial->zx[c]).epsilon(1e-13));
  }
  const std::vector<float> old_texels = texels(before.specular, 0);
  const std::vector<float> new_texels = texels(after.specular, 0);
  for (std::size_t i = 0; i < old_texels.size(); i += 41) CHECK(new_texels[i] == Approx(old_texels[i]).epsilon(0.03));
}

TEST_CASE("bake: harmonics are those of welkin sh, and of every engine", "[tools][bake][slow]") {
  const TemporaryFile folder("out");
  bake_into(folder, small_image() + " --no-previews --for three --bands 4" + kSmall);
  const nlohmann::json baked = json_of(file_text(folder / "sh.json"));
  const nlohmann::json sh = run_sh_json(small_image() + " --for three --bands 4");
  CHECK(baked.at("radiance") == sh.at("radiance"));
  CHECK(baked.at("axes") == sh.at("axes"));
  std::vector<std::string> engines;
  for (const auto& engine : baked.at("engines")) {
    const std::string name = engine.at("name");
    engines.push_back(name);
    const nlohmann::json alone = run_sh_json(small_image() + " --bands 4 --for " + name).at("engine");
    for (const auto& [term, rgb] : alone.at("terms").items()) {
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(engine.at("terms").at(term).at(c).get<double>() == Approx(rgb.at(c).get<double>()).margin(1e-12));
      }
    }
    CHECK(contains(file_text(folder / "sh.h"), "light_" + name + "["));
  }
  CHECK(engines ==
        std::vector<std::string>{"welkin", "babylon", "three", "filament", "gltf", "unity", "unreal", "godot"});
}

TEST_CASE("bake: --for names the faces, the .env stays Babylon.js's", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto plain = scratch.path() / "plain";
  const auto babylon = scratch.path() / "babylon";
  const std::string options =
      small_image() + " --ktx2-format rgba32f --formats ktx2,env --preview-size 32 --roughness filament";
  bake_into(plain, options + kSmall);
  bake_into(babylon, options + " --for babylon" + kSmall);
  for (const char* name : {"background.ktx2", "specular.ktx2", "irradiance.ktx2"}) {
    const CubemapTexture straight = read_texture(plain / name);
    const CubemapTexture rotated = read_texture(babylon / name);
    CHECK(same_bits(rotated.cubemap, mirrored_x(straight.cubemap)));
    CHECK(texels(rotated.cubemap, 0) != texels(straight.cubemap, 0));
  }
  for (const char* name : {"environment.env", "preview_spheres.png", "preview_environment.png"}) {
    CHECK(file_text(plain / name) == file_text(babylon / name));
  }
}

TEST_CASE("bake: what a format cannot hold is counted, file by file", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto in = scratch.path() / "bright.pfm";
  std::vector<float> pixels = grey_image(16, 96, 0.5F);
  pixels[0] = 1e5F;
  pixels[3] = 300.0F;
  write_pfm(in, 16, 96, pixels);
  const auto folder = scratch.path() / "out";
  const auto manifest = bake_into(folder, quoted(in) + " --formats ktx2,env" + kSmall);
  CHECK(file_of(manifest, "background.ktx2").at("values_clamped") == 1);
  CHECK(file_of(manifest, "environment.env").at("values_clamped").get<int>() >= 2);
  const std::string notes = manifest.at("notes").dump();
  CHECK(contains(notes, "background.ktx2: 1 value beyond +-65504, the range of half floats, clamped"));
  CHECK(contains(notes, "above 255 or below 0, the range of RGBD, clamped"));

  const auto clamped = bake_into(folder, quoted(in) + " --clamp 200 --formats ktx2,env" + kSmall);
  CHECK(clamped.at("notes").dump() == "[\"the input: 2 texels clamped at 200\"]");
  CHECK(clamped.at("diagnostics").at("clamped") == 2);
}

TEST_CASE("bake: the .env's own chain counts towards the memory limit, before any work", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const std::string options = " --no-previews --size 64 --background-size 1 --mips 1 --irradiance 1 --brdf 8";
  const auto needed = [&](const std::string& formats) {
    const auto out = scratch.path() / "none";
    const std::string message =
        failure("bake --sky -o " + quoted(out) + options + " --formats " + formats + " --memory-limit 1MB", 1);
    INFO(message);
    CHECK_FALSE(std::filesystem::exists(out));
    const std::size_t at = message.find(" take ");
    REQUIRE(at != std::string::npos);
    return std::stoull(message.substr(at + 6));
  };
  const auto alone = needed("ktx2");
  const auto with_env = needed("ktx2,env");
  CHECK(with_env > alone);
  const std::string bake = options + " --formats ktx2,env --memory-limit ";
  CHECK(contains(failure("bake --sky -o " + quoted(scratch.path() / "none") + bake + std::to_string(with_env - 1), 1),
                 "the .env's specular chain"));
  bake_into(scratch.path() / "out", "--sky" + bake + std::to_string(with_env));
  CHECK(contains(run_welkin("bake --help-all").output, "are not counted"));
}

TEST_CASE("bake: the examples of --help-all work", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  REQUIRE(run_welkin("testmap --size 64 -o " + quoted(scratch.path() / "city.hdr")).exit_code == 0);
  std::ofstream(scratch.path() / "scene.json") << R"({"glossy": null})";
  std::istringstream help(run_welkin("bake --help-all").output);
  int examples = 0;
  for (std::string line; std::getline(help, line);) {
    if (line.rfind("  welkin bake", 0) != 0) continue;
    ++examples;
    std::string arguments = line.substr(line.find("bake"));
    arguments = arguments.substr(0, arguments.find("   "));  // what follows says what it does
    for (const std::string path : {"city.hdr", "out", "scene.json"}) {
      const std::size_t at = arguments.find(" " + path);
      if (at != std::string::npos) arguments.replace(at + 1, path.size(), quoted(scratch.path() / path));
    }
    if (arguments.find(" -o ") == std::string::npos) arguments += " -o " + quoted(scratch.path() / "city");
    const CommandResult result = run_welkin(arguments);
    INFO(arguments << '\n' << result.errors);
    CHECK(result.exit_code == 0);
  }
  CHECK(examples >= 8);
}
