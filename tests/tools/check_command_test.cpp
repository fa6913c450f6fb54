// `welkin check`: chains whose faults are known, and what is said of them.
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "tools/command.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

using namespace welkin;
using namespace welkin::test;

namespace {

constexpr int kSize = 32;

/// A room to check against, and a chain of it.
class Room {
 public:
  Room() : source_(directory_.file("room.pfm")) {
    const auto sample = directory_.file("sample.hdr");
    REQUIRE(run_welkin("sample -q --size 64 -o " + quoted(sample)).exit_code == 0);
    const LatLongImage small = to_lat_long(read_environment(sample).view(), 128, 64, dmat3(1.0), ResampleFilter::area);
    write_pfm(source_, small.width, small.height, small.pixels);
    environment_ = read_environment(source_);
  }

  [[nodiscard]] EnvironmentView view() const { return environment_.view(); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] Cubemap chain(std::vector<double> roughness = {}) const {
    return prefilter_specular(view(), {.size = kSize, .roughness = std::move(roughness)}).cubemap;
  }

  /// The report on a chain in floats.
  [[nodiscard]] nlohmann::json check(const Cubemap& chain, const std::string& options = "--roughness filament") const {
    write_texture(file("chain.ktx2"), chain.views(), {.format = TexelFormat::rgba32f});
    return check(file("chain.ktx2"), options);
  }
  [[nodiscard]] nlohmann::json check(const std::filesystem::path& path, const std::string& options = "") const {
    return json_printed_by("check --json " + quoted(path) + " " + quoted(source_) + " " + options);
  }
  [[nodiscard]] const std::filesystem::path& source() const { return source_; }

 private:
  TemporaryDirectory directory_;
  std::filesystem::path source_;
  Environment environment_;
};

std::vector<std::string> findings_of(const nlohmann::json& report) {
  return report["findings"].get<std::vector<std::string>>();
}

/// Each mip of a chain changed on its own.
Cubemap mips_changed(const Cubemap& chain, const std::function<Cubemap(Cubemap mip)>& change) {
  Cubemap result(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const std::size_t values = std::size_t{18} * static_cast<std::size_t>(chain.level_size(level)) *
                               static_cast<std::size_t>(chain.level_size(level));
    const Cubemap mip = change(Cubemap(chain.level_size(level), {chain.face(level, 0), values}));
    std::copy_n(mip.pixels().data(), values, result.face(level, 0));
  }
  return result;
}

Cubemap rotate_by(const Cubemap& chain, const glm::dmat3& rotation) {
  return mips_changed(chain, [&](const Cubemap& mip) { return to_cubemap(mip.view(), mip.size(), rotation); });
}

Cubemap with_values(const Cubemap& chain, const std::function<float(std::size_t index, float value)>& change) {
  Cubemap result = chain;
  for (std::size_t i = 0; i < result.pixels().size(); ++i) result.pixels()[i] = change(i, result.pixels()[i]);
  return result;
}

}  // namespace

TEST_CASE("command: check finds nothing wrong with an own chain", "[tools][check][slow]") {
  const Room room;
  const nlohmann::json report = room.check(room.chain(), "");
  CHECK(findings_of(report).empty());
  CHECK(report["rms"].get<double>() < 1e-3);
  CHECK(report["schedule"] == "filament");
  CHECK(report["mips"].size() == 5);
  CHECK(report["mips"][2]["fitted_roughness"].get<double>() ==
        Approx(mip_roughness(RoughnessSchedule::filament, 5, kSize)[2]).margin(0.01));
  const std::string said = run_welkin("check " + quoted(room.file("chain.ktx2")) + " " + quoted(room.source())).output;
  CHECK(contains(said, "Nothing is wrong with orientation, scale, roughness and edges."));

  const auto out = room.file("out");  // lobes fitted to lookups, in whole chains and in parts
  for (const auto& [bake, check] :
       {std::pair{" --mips 2", "--roughness filament"}, {" --glossy 0.2,0.6", ""}, {"", "--mips 3"}}) {
    bake_into(out, quoted(room.source()) + " --size 32 --formats ktx2 --ktx2-format rgba32f --fit-lookups on" + bake);
    const nlohmann::json of_lookups = room.check(out / "specular.ktx2", check);
    CAPTURE(bake, check);
    CHECK(of_lookups["mips"][1]["lobe_roughness"] != of_lookups["mips"][1]["roughness"]);
    CHECK(findings_of(of_lookups).empty());
    CHECK(of_lookups["rms"].get<double>() < 1e-3);
  }
}

TEST_CASE("command: check names what is wrong with a chain", "[tools][check][slow]") {
  const Room room;
  const Cubemap chain = room.chain();
  const auto swap_rows_of_top = [](Cubemap mip) {
    const int size = mip.size();
    for (int row = 0; row < size / 2; ++row) {
      std::swap_ranges(mip.face(2) + 3 * row * size, mip.face(2) + 3 * (row + 1) * size,
                       mip.face(2) + 3 * (size - 1 - row) * size);
    }
    return mip;
  };
  glm::dmat3 mirror(1.0);
  mirror[1][1] = -1.0;
  struct Fault {
    Cubemap chain;
    std::string finding;
  };
  const std::vector<Fault> faults = {
      {mirrored_x(chain), "mirrored in x, as Babylon.js and PlayCanvas have them"},
      {rotate_by(chain, mirror), "mirrored in y"},
      {rotate_by(chain, rotation_about_y(90.0)), "rotated by 90 degrees about y"},
      {rotate_by(chain, rotation_about_y(180.0)), "rotated by 180 degrees about y"},
      {mips_changed(chain, swap_rows_of_top), "faces do not fit together: +Y shows +Y with rows mirrored"},
      {with_values(chain, [](std::size_t /*index*/, float value) { return value * std::numbers::pi_v<float>; }),
       "scaled by 3.14"},
      {with_values(chain, [](std::size_t /*index*/, float value) { return value / 4.0F; }), "1/4 of the source"},
      {with_values(chain, [](std::size_t i, float value) { return i % 3 == 0 ? 1.5F * value : value; }),
       "channels are scaled by 1.5  1  1"},
      {with_values(chain, [&](std::size_t i, float) { return chain.pixels()[i - i % 3 + 2 - i % 3]; }),
       "channels in the order BGR"},
      {with_values(chain,
                   [](std::size_t i, float value) { return i == 7 ? std::numeric_limits<float>::quiet_NaN() : value; }),
       "1 value is NaN or infinite"},
      {with_values(chain, [](std::size_t /*index*/, float value) { return std::min(value, 2.0F); }),
       "values of mip 0 are clipped at 2"},
      {build_mips(chain.view(), MipFilter::solid_angle, chain.levels()), "levels are plain mips, not reflections"},
      {room.chain({0.0, 0.25, 0.4, 0.5, 1.0}), "roughness of mip 1 is 0.25, not 0.13"},
  };
  for (const Fault& fault : faults) {
    const nlohmann::json report = room.check(fault.chain);
    CAPTURE(fault.finding, report["findings"]);
    CHECK(std::ranges::any_of(findings_of(report),
                              [&](const std::string& finding) { return contains(finding, fault.finding); }));
  }
}

TEST_CASE("command: check finds nothing in even light, at any size", "[tools][check]") {
  const TemporaryDirectory directory;
  const auto source = directory.file("grey.pfm");
  write_pfm(source, 16, 8, grey_image(16, 8, 0.5F));
  for (const int size : {1, 2, 3, 7, 64, 129}) {
    Cubemap chain(size, std::min(full_chain_levels(size), 3));
    std::ranges::fill(chain.pixels(), 0.5F);
    write_texture(directory.file("chain.ktx2"), chain.views(), {.format = TexelFormat::rgba32f});
    const auto report = json_printed_by("check --json " + quoted(directory.file("chain.ktx2")) + " " + quoted(source));
    CAPTURE(size, report["findings"]);
    CHECK(report["findings"].empty());
    CHECK(report["rms"].get<double>() < 2e-4);
  }
}

TEST_CASE("command: check names edges that do not fit", "[tools][check][slow]") {
  const Room room;
  Cubemap chain = room.chain();
  // The outermost texels of +X and -X as a filter leaves them that knows one face alone.
  for (int level = 0; level < 2; ++level) {
    const int size = chain.level_size(level);
    for (int face = 0; face < 2; ++face) {
      float* texels = chain.face(level, face);
      for (int i = 0; i < size; ++i) {
        for (int channel = 0; channel < 3; ++channel) texels[3 * i * size + channel] *= 1.5F;
      }
    }
  }
  const nlohmann::json report = room.check(chain);
  CHECK(report["mips"][0]["seams"] == nlohmann::json::array({"+X/+Z", "-X/-Z"}));
  CHECK(report["mips"][2]["seams"].empty());
}

TEST_CASE("command: check reads irradiance, .env files and folders of faces", "[tools][check][slow]") {
  const Room room;
  const auto out = room.file("out");
  printed_by("bake -q --no-previews --size 32 --formats ktx2 -o " + quoted(out) + " " + quoted(room.source()));
  const nlohmann::json irradiance = room.check(out / "irradiance.ktx2");
  CHECK(irradiance["lobe"] == "lambert");
  CHECK(irradiance["unit"].get<double>() == Approx(double{std::numbers::pi}));
  CHECK(irradiance["rms"].get<double>() < 2e-3);
  CHECK(findings_of(irradiance).empty());

  const nlohmann::json harmonics = room.check(out / "sh.json");
  CHECK(harmonics["form"] == "radiance");
  CHECK(harmonics["rms"].get<double>() < 1e-3);

  const Cubemap chain = room.chain();
  const auto folder = room.file("faces");
  std::filesystem::create_directory(folder);
  for (int level = 0; level < 2; ++level) {
    constexpr const char* kFaces[] = {"px", "nx", "py", "ny", "pz", "nz"};
    const int size = chain.level_size(level);
    for (int face = 0; face < 6; ++face) {
      const float* texels = chain.face(level, face);
      write_pfm(folder / ("m" + std::to_string(level) + "_" + kFaces[face] + ".pfm"), size, size,
                {texels, texels + std::ptrdiff_t{3} * size * size});
    }
  }
  const nlohmann::json faces =
      room.check(folder, "--roughness 0," + std::to_string(mip_roughness(RoughnessSchedule::filament, 5, kSize)[1]));
  CHECK(faces["mips"].size() == 2);
  CHECK(faces["rms"].get<double>() < 2e-3);

  const SphericalHarmonics light = project(room.view()).radiance;
  const auto env = room.file("chain.env");
  PrefilterOptions babylon{.size = kSize};
  babylon.mips = default_mip_count(RoughnessSchedule::babylon, kSize);
  babylon.roughness = mip_roughness(RoughnessSchedule::babylon, *babylon.mips, kSize);
  write_babylon_environment(env, to_babylon(prefilter_specular(room.view(), babylon).cubemap, light));
  const nlohmann::json file = room.check(env);
  CHECK(file["schedule"] == "babylon");
  CHECK(file["polynomial"]["form"] == "Babylon.js's polynomial");
  CHECK(file["polynomial"]["rms"].get<double>() < 1e-3);
}

TEST_CASE("command: check judges harmonics in cmgen's text", "[tools][check][slow]") {
  const Room room;
  SphericalHarmonics light = project(room.view()).radiance;
  const auto write = [&](const SphericalHarmonics& harmonics) {
    std::ofstream text(room.file("sh.txt"));
    text.precision(12);
    for (const dvec3& rgb : harmonics.coefficients())
      text << "(" << rgb.x << ", " << rgb.y << ", " << rgb.z << "); // L\n";
  };
  write(lambertian_from_irradiance(irradiance_from_radiance(light)));
  CHECK(room.check(room.file("sh.txt"))["form"] == "irradiance / pi");
  CHECK(room.check(room.file("sh.txt"))["rms"].get<double>() < 1e-3);

  glm::dmat3 mirror(1.0);
  mirror[2][2] = -1.0;
  write(scale(rotate(light, mirror), dvec3(2.0)));
  const nlohmann::json report = room.check(room.file("sh.txt"));
  CHECK(report["form"] == "radiance");
  CHECK(report["placement"] == "mirrored in z, as Bevy has them");
  CHECK(contains(findings_of(report).back(), "2 times the source"));

  write(apply_window(light, Window::lanczos).radiance);
  CHECK(contains(findings_of(room.check(room.file("sh.txt"))).back(), "band 2 has 0.41"));

  std::ofstream(room.file("sh.txt")) << "(1, 2, 3); // L00\n(1, 2); // L1-1\n";
  CHECK(contains(failure("check " + quoted(room.file("sh.txt")) + " " + quoted(room.source()), 1),
                 "line 2 should have three numbers"));
  std::ofstream(room.file("sh.txt")) << "(1, 2, 3); // L00\n";
  CHECK(contains(failure("check " + quoted(room.file("sh.txt")) + " " + quoted(room.source()), 1), "nine lines"));
  std::ofstream(room.file("sh.json")) << R"({"radiance": [[1, 2, "3"]]})";
  CHECK(contains(failure("check " + quoted(room.file("sh.json")) + " " + quoted(room.source()), 1),
                 "triples of numbers"));
}

TEST_CASE("command: check fails where a mip errs by more than --error", "[tools][check][slow]") {
  const Room room;
  const Cubemap chain = room.chain();
  write_texture(room.file("chain.ktx2"), chain.views(), {.format = TexelFormat::b10g11r11});
  const std::string files = quoted(room.file("chain.ktx2")) + " " + quoted(room.source());
  CHECK(run_welkin("check --error 0.1 " + files).exit_code == 0);
  const CommandResult result = run_welkin("check --error 0.001 " + files);
  CHECK(result.exit_code == 1);
  CHECK(contains(result.errors, "more than --error 0.001"));
  CHECK(contains(result.output, "rms %"));
  CHECK(run_welkin("check --image " + quoted(room.file("check.png")) + " " + files).exit_code == 0);
  CHECK(std::filesystem::file_size(room.file("check.png")) > 10000);
  CHECK(contains(failure("check " + quoted(room.source()) + " " + quoted(room.source()), 1), "a chain is a cubemap"));
  CHECK(contains(failure("check --roughness 0,1 " + files, 2), "2 roughnesses for 5 mips"));
}
