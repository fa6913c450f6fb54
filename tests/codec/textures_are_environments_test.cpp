// Promises: KTX2, DDS and .env files are environments like all others: told by their first bytes, inspected, read at
// each level, measured, projected, within a memory limit; an .env in Welkin's axes, with the light that it stores.
#include <cmath>
#include <glm/geometric.hpp>

#include "places.h"
#include "sh/babylon_radiance.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/babylon_environment.h"
#include "welkin/environment_file.h"
#include "welkin/texture_file.h"

namespace welkin::test {
namespace {

ReadOptions at_level(int level) {
  ReadOptions options;
  options.level = level;
  return options;
}

std::span<const float> level_pixels(const CubemapChain& chain, int level) {
  return {chain.face(level, 0), 6 * face_values(chain, level)};
}

std::span<const float> pixels_of(const Environment& environment) {
  const auto width = static_cast<std::size_t>(environment.info.width);
  return {environment.pixels.get(), 18 * width * width};
}

const PassRecord& pass_named(const Projection& projection, const std::string& name) {
  for (const PassRecord& pass : projection.diagnostics.passes) {
    if (pass.name == name) return pass;
  }
  FAIL("no pass " << name);
  return projection.diagnostics.passes.front();
}

bool same_bits(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return same_bytes<glm::dvec3>(a.coefficients(), b.coefficients());
}

double distance(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double sum = 0.0;
  double size = 0.0;
  for (int l = 0; l < a.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      sum += glm::dot(a.at(l, m) - b.at(l, m), a.at(l, m) - b.at(l, m));
      size += glm::dot(b.at(l, m), b.at(l, m));
    }
  }
  return std::sqrt(sum / size);
}

}  // namespace

TEST_CASE("a texture is an environment at each of its levels", "[codec][textures]") {
  const TemporaryDirectory directory;
  const std::pair<const char*, TextureOptions> files[] = {
      {"plain.ktx2", {}},
      {"packed.ktx2", {TexelFormat::e5b9g9r9, Supercompression::zstd, {}}},
      {"floats.dds", {TexelFormat::rgba32f, Supercompression::none, {}}}};
  for (const auto& [file, options] : files) {
    for (const int size : {1, 7, 200}) {
      CAPTURE(file, size);
      const auto path = directory.file(file);
      write_texture(path, noisy_chain(size, full_chain_levels(size)).views(), options);
      const CubemapTexture texture = read_texture(path);
      for (int level = 0; level < texture.cubemap.levels(); ++level) {
        const EnvironmentInfo info = inspect_environment(path, at_level(level));
        CHECK(info.layout == Layout::vertical_strip);
        CHECK(info.levels.size() == static_cast<std::size_t>(texture.cubemap.levels()));
        CHECK(info.width == texture.cubemap.level_size(level));
        CHECK(info.height == 6 * info.width);
        const Environment read = read_environment(path, at_level(level));
        CHECK(same_bytes<float>(pixels_of(read), level_pixels(texture.cubemap, level)));
        CHECK(same_bits(project_file(path, at_level(level)).radiance, project(texture.cubemap.view(level)).radiance));
      }
      CHECK(measure_environment(path).texels == 6U * static_cast<unsigned>(size) * static_cast<unsigned>(size));
    }
  }
  CHECK(inspect_environment(directory.file("packed.ktx2")).compression == "zstd");
  CHECK(inspect_environment(directory.file("packed.ktx2")).storage == "e5b9g9r9");
  CHECK(inspect_environment(directory.file("floats.dds")).format == "DDS");
}

TEST_CASE("8-bit textures are linear or sRGB as their format says, or as was asked for", "[codec][textures]") {
  const TemporaryDirectory directory;
  const auto path = directory.file("sky.dds");
  const CubemapChain chain = noisy_chain(1, 1);
  write_texture(path, chain.views(), {TexelFormat::e5b9g9r9, Supercompression::none, {}});
  std::vector<char> bytes = read_bytes(path);
  for (std::size_t i = 0; i < 24; ++i) bytes[148 + i] = static_cast<char>(10 * i);
  for (const bool srgb : {false, true}) {
    bytes[128] = srgb ? 29 : 28;
    write_bytes(path, bytes);
    for (const Transfer transfer : {Transfer::automatic, Transfer::linear, Transfer::srgb}) {
      ReadOptions options;
      options.transfer = transfer;
      const bool curved = transfer == Transfer::srgb || (transfer == Transfer::automatic && srgb);
      const double code = 50.0 / 255.0;  // green of the second texel
      const double wanted = curved ? std::pow((code + 0.055) / 1.055, 2.4) : code;
      CHECK(std::abs(static_cast<double>(read_environment(path, options).pixels[4]) - wanted) < 1e-6);
    }
  }
}

TEST_CASE("another layout or a level that is not there is refused", "[codec][textures]") {
  const TemporaryDirectory directory;
  write_texture(directory.file("sky.ktx2"), noisy_chain(4, 3).views(), {});
  ReadOptions options;
  options.layout = Layout::lat_long;
  const auto read = [&] { (void)read_environment(directory.file("sky.ktx2"), options); };
  CHECK(thrown_by(read).says("leave --layout out"));
  options = at_level(3);
  CHECK(thrown_by(read).says("has no level 3; it has 3: pass --level 0 to 2"));
  options = at_level(0);
  options.memory_limit_bytes = 500;
  CHECK(thrown_by(read).code == ErrorCode::limit_exceeded);
}

TEST_CASE("a target size takes a mip of a texture, but no prefiltered level", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = noisy_chain(16, 5);
  ProjectionOptions options;
  options.target_size = 4;
  const TextureOptions blurred{TexelFormat::rgba16f, Supercompression::none, {{"Welkin.Roughness", "0 1"}}};
  for (const char* const file : {"sky.ktx2", "sky.exr", "sky.dds"}) {
    CAPTURE(file);
    const auto path = directory.file(file);
    write_texture(path, chain.views(), {});
    const bool can_say = path.extension() != ".dds";
    CHECK((pass_named(project_file(path, {}, options), "reduce").action == "reuse") == can_say);
    write_texture(path, chain.views(), blurred);
    const Projection projected = project_file(path, {}, options);
    CHECK(pass_named(projected, "reduce").action != "reuse");
    const Environment whole = read_environment(path);
    CHECK(same_bits(projected.radiance, project(whole.cubemap(), options).radiance));
  }
}

TEST_CASE("the light that an .env stores is cancelled and reported like any other", "[codec][env]") {
  const TemporaryDirectory directory;
  const auto path = directory.file("sky.env");
  write_babylon_environment(path, to_babylon(noisy_chain(4, 3), RandomLight(5).harmonics(3)));
  std::vector<double> shares;
  std::stop_source source;
  const Control control{source.get_token(), [&](double done) { shares.push_back(done); }};
  (void)project_file(path, {}, {}, control);
  CHECK(shares == std::vector<double>{1.0});
  source.request_stop();
  CHECK(thrown_by([&] { (void)project_file(path, {}, {}, control); }).code == ErrorCode::cancelled);
}

TEST_CASE("radiance comes back from Babylon.js's polynomial", "[codec][env]") {
  for (unsigned seed = 1; seed < 20; ++seed) {
    const SphericalHarmonics radiance = RandomLight(seed).harmonics(3);
    CHECK(distance(sh::radiance_of(babylon_polynomial(radiance)), radiance) < 1e-14);
  }
}

TEST_CASE("an .env is an environment in Welkin's axes, with the light that it stores", "[codec][env]") {
  const TemporaryDirectory directory;
  const auto path = directory.file("sky.env");
  const CubemapChain chain = noisy_chain(8, 4);
  const SphericalHarmonics radiance = RandomLight(5).harmonics(3);
  write_babylon_environment(path, to_babylon(chain, radiance));
  const CubemapChain stored = mirrored_x(read_babylon_environment(path).specular);
  for (int level = 0; level < 4; ++level) {
    CHECK(same_bytes<float>(pixels_of(read_environment(path, at_level(level))), level_pixels(stored, level)));
  }
  const Projection reused = project_file(path);
  CHECK(distance(reused.radiance, radiance) < 1e-14);
  CHECK(pass_named(reused, "project").action == "reuse");
  CHECK(glm::length(reused.diagnostics.flux - radiance.at(0, 0) * std::sqrt(4.0 * 3.14159265358979)) < 1e-9);
  ProjectionOptions options;
  options.bands = 2;
  CHECK(project_file(path, {}, options).radiance.bands() == 2);
  CHECK(project_file(path, {}, options).radiance.at(1, -1) == reused.radiance.at(1, -1));
  // More bands than are stored: by the pixels, of the sharp level, whatever the target size.
  options.bands = 4;
  options.target_size = 2;
  const Projection projected = project_file(path, {}, options);
  CHECK(pass_named(projected, "project").action == "run");
  CHECK(same_bits(projected.radiance, project(stored.view(0), options).radiance));

  BabylonEnvironment bare = to_babylon(chain, radiance);
  bare.polynomial.reset();
  write_babylon_environment(path, bare);
  CHECK(same_bits(project_file(path).radiance, project(stored.view(0)).radiance));
  const EnvironmentInfo info = inspect_environment(path);
  CHECK(info.format == "Babylon.js .env");
  bool says_so = false;
  for (const std::string& note : info.notes) says_so = says_so || note.find("RGBD ends at 255") != std::string::npos;
  CHECK(says_so);
}

TEST_CASE("the light that Babylon.js stored is that of its photograph", "[codec][env][shared]") {
  const std::filesystem::path shared = std::filesystem::path(WELKIN_SHARED) / "hdr";
  const std::pair<const char*, const char*> pairs[] = {{"babylon_dikhololo_night_64.env", "dikhololo_night_1k.hdr"},
                                                       {"babylon_lebombo_64_webp.env", "lebombo_1k.hdr"},
                                                       {"babylon_venice_sunset_128.env", "venice_sunset_1k.hdr"}};
  for (const auto& [file, photograph] : pairs) {
    if (!std::filesystem::exists(shared / "cube" / file)) {
      WARN("left out: the shared environments are not at " << shared);
      return;
    }
    ProjectionOptions options;
    options.clamp = RadianceClamp{};  // 4096, as Babylon.js has it
    const SphericalHarmonics wanted = project_file(shared / "env" / photograph, {}, options).radiance;
    // Through cube faces of 64 and 128 texels, each the nearest pixel's.
    CHECK(distance(project_file(shared / "cube" / file).radiance, wanted) < 0.04);
  }
}

}  // namespace welkin::test
