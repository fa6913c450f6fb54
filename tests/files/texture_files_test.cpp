// Texture files as environments, and those that are refused.
#include <nlohmann/json.hpp>

#include "harmonics/babylon.h"
#include "places.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: KTX2, DDS and .env files are environments like all others: recognized by their first bytes, inspected, read
// at each level, measured, projected, within a memory limit; an .env in Welkin's axes, with the light that it stores.

namespace {

ReadOptions at_level(int level) { return {.level = level}; }

const PassRecord& pass_named(const Projection& projection, const std::string& name) {
  for (const PassRecord& pass : projection.diagnostics.passes) {
    if (pass.name == name) return pass;
  }
  FAIL("no pass " << name);
  return projection.diagnostics.passes.front();
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
        CHECK(same_bytes(values_of(read), level_values(texture.cubemap, level)));
        CHECK(same_bits(project_file(path, at_level(level)).radiance, project(texture.cubemap.view(level)).radiance));
      }
      CHECK(measure_environment(path).texels == 6U * static_cast<unsigned>(size) * static_cast<unsigned>(size));
    }
  }
  CHECK(inspect_environment(directory.file("packed.ktx2")).compression == "zstd");
  CHECK(inspect_environment(directory.file("packed.ktx2")).storage == "e5b9g9r9");
  CHECK(inspect_environment(directory.file("floats.dds")).format == FileFormat::dds);
}

TEST_CASE("8-bit textures are linear or sRGB as their format says, or as was asked for", "[codec][textures]") {
  const TemporaryFile path("sky.dds");
  const Cubemap chain = noisy_chain(1, 1);
  write_texture(path, chain.views(), {TexelFormat::e5b9g9r9, Supercompression::none, {}});
  std::vector<char> bytes = read_bytes(path);
  for (std::size_t i = 0; i < 24; ++i) bytes[148 + i] = static_cast<char>(10 * i);
  for (const bool srgb : {false, true}) {
    bytes[128] = srgb ? 29 : 28;
    write_bytes(path, bytes);
    for (const Transfer transfer : {Transfer::automatic, Transfer::linear, Transfer::srgb}) {
      ReadOptions options{.transfer = transfer};
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
  ReadOptions options{.layout = Layout::lat_long};
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
  const Cubemap chain = noisy_chain(16, 5);
  ProjectionOptions options{.target_size = 4};
  const TextureOptions blurred{TexelFormat::rgba16f, Supercompression::none, {{"Welkin.Roughness", "0 1"}}};
  for (const char* const file : {"sky.ktx2", "sky.exr", "sky.dds"}) {
    CAPTURE(file);
    const auto path = directory.file(file);
    write_texture(path, chain.views(), {});
    const bool can_say = path.extension() != ".dds";
    CHECK((pass_named(project_file(path, {}, options), "reduce").action == PassAction::reuse) == can_say);
    write_texture(path, chain.views(), blurred);
    const Projection projected = project_file(path, {}, options);
    CHECK(pass_named(projected, "reduce").action != PassAction::reuse);
    const Environment whole = read_environment(path);
    CHECK(same_bits(projected.radiance, project(whole.cubemap(), options).radiance));
  }
}

TEST_CASE("an .env is an environment in Welkin's axes, with the light that it stores", "[codec][env]") {
  const TemporaryFile path("sky.env");
  const Cubemap chain = noisy_chain(8, 4);
  const SphericalHarmonics radiance = RandomLight(5).harmonics(3);
  write_babylon_environment(path, to_babylon(chain, radiance));
  const Cubemap stored = mirrored_x(read_babylon_environment(path).specular);
  for (int level = 0; level < 4; ++level) {
    CHECK(same_bytes(values_of(read_environment(path, at_level(level))), level_values(stored, level)));
  }
  const Projection reused = project_file(path);
  CHECK(relative_error(reused.radiance, radiance) < 1e-14);
  CHECK(pass_named(reused, "project").action == PassAction::reuse);
  CHECK(glm::length(reused.diagnostics.total_radiance - radiance.at(0, 0) * std::sqrt(4.0 * 3.14159265358979)) < 1e-9);
  ProjectionOptions options{.bands = 2};
  CHECK(project_file(path, {}, options).radiance.bands() == 2);
  CHECK(project_file(path, {}, options).radiance.at(1, -1) == reused.radiance.at(1, -1));
  // More bands than are stored: by the pixels, of the sharp level, whatever the target size.
  options.bands = 4;
  options.target_size = 2;
  const Projection projected = project_file(path, {}, options);
  CHECK(pass_named(projected, "project").action == PassAction::run);
  CHECK(same_bits(projected.radiance, project(stored.view(0), options).radiance));

  BabylonEnvironment bare = to_babylon(chain, radiance);
  bare.polynomial.reset();
  write_babylon_environment(path, bare);
  CHECK(same_bits(project_file(path).radiance, project(stored.view(0)).radiance));
  const EnvironmentInfo info = inspect_environment(path);
  CHECK(info.format == FileFormat::babylon);
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
    options.pixels.clamp = RadianceClamp{};  // 4096, as Babylon.js has it
    const SphericalHarmonics wanted = project_file(shared / "env" / photograph, {}, options).radiance;
    // Through cube faces of 64 and 128 texels, each the nearest pixel's.
    CHECK(relative_error(project_file(shared / "cube" / file).radiance, wanted) < 0.04);
  }
}

// Promises: textures and .env files that cannot be read or written are refused with a word that helps; whatever goes
// wrong, no file is left behind.

namespace {

using Json = nlohmann::json;

template <class Bytes>
void put(Bytes& bytes, std::size_t index, std::uint32_t value) {
  std::memcpy(bytes.data() + index, &value, sizeof value);
}

/// Returns the reader's error for a valid texture file after `change` of its bytes.
template <class Change>
ThrownError refusal_of(const char* file, const Cubemap& chain, Supercompression packing, const Change& change) {
  std::vector<std::byte> bytes;
  write_texture({bytes, file}, chain.views(), {TexelFormat::rgba16f, packing, {}});
  change(bytes);
  ThrownError error = thrown_by([&] { (void)read_texture({std::as_const(bytes), file}); });
  CHECK(error.says(file));
  return error;
}

/// Returns the reader's error for a valid texture file with one field changed.
ThrownError refusal_with(const char* file, std::size_t index, std::uint32_t value,
                         Supercompression packing = Supercompression::none) {
  return refusal_of(file, noisy_chain(4, 3), packing, [&](auto& bytes) { put(bytes, index, value); });
}

struct EnvParts {
  Json manifest;
  std::vector<char> payload;
};

EnvParts sound_env(const TemporaryDirectory& directory) {
  BabylonEnvironment environment;
  environment.specular = noisy_chain(4, 3);
  environment.polynomial = BabylonPolynomial{};
  environment.irradiance = {1, std::vector<float>(18, 1.0F)};
  write_babylon_environment(directory.file("sound.env"), environment);
  const std::vector<char> bytes = read_bytes(directory.file("sound.env"));
  const auto end = std::find(bytes.begin() + 8, bytes.end(), '\0');
  return {Json::parse(bytes.begin() + 8, end), {end + 1, bytes.end()}};
}

void write_env(const std::filesystem::path& path, const std::string& manifest, const std::vector<char>& payload) {
  std::string text = "\x86\x16\x87\x96\xF6\xD6\x96\x36" + manifest;
  text += '\0';
  std::vector<char> bytes(text.begin(), text.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  write_bytes(path, bytes);
}

/// Returns the reader's error for a valid .env file after `change` of its manifest and payload.
template <class Change>
ThrownError env_refusal(const Change& change) {
  const TemporaryDirectory directory;
  EnvParts parts = sound_env(directory);
  change(parts);
  write_env(directory.file("sky.env"), parts.manifest.dump(), parts.payload);
  ThrownError error = thrown_by([&] { (void)read_babylon_environment(directory.file("sky.env")); });
  CHECK(error.says("sky.env: "));
  return error;
}

std::size_t entries(const TemporaryDirectory& directory) {
  const auto all = std::filesystem::directory_iterator(directory.file("").parent_path());
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

}  // namespace

TEST_CASE("KTX2 files that are not for us are named for what they are", "[codec][textures]") {
  CHECK(refusal_with("sky.ktx2", 5, 0x31BB3331).says("of an unknown version"));
  CHECK(refusal_with("sky.ktx2", 12, 9999).says("VkFormat 9999"));
  CHECK(refusal_with("sky.ktx2", 12, 9999).code == ErrorCode::unsupported_file);
  CHECK(refusal_with("sky.ktx2", 16, 1).says("type size"));
  CHECK(refusal_with("sky.ktx2", 20, 5).says("5 x 4"));
  CHECK(refusal_with("sky.ktx2", 28, 2).says("3D texture"));
  CHECK(refusal_with("sky.ktx2", 32, 3).says("bytes instead of"));
  CHECK(refusal_with("sky.ktx2", 32, 3).says("; fetch or export it again"));  // which its own message leaves out
  CHECK(refusal_with("sky.ktx2", 32, 70000).says("array of 70000"));
  CHECK(refusal_with("sky.ktx2", 36, 3).says("has 3 faces"));
  CHECK(refusal_with("sky.ktx2", 40, 9).says("9 levels"));
  CHECK(refusal_with("sky.ktx2", 44, 1).says("supercompression scheme 1"));
  CHECK(refusal_with("sky.ktx2", 60, 0x7fffffff).says("key/value data"));
  CHECK(refusal_with("sky.ktx2", 80, 0x7fffffff).says("level 0"));
  CHECK(refusal_with("sky.ktx2", 88, 5).says("has 5 bytes"));
  CHECK(refusal_with("sky.ktx2", 96, 5, Supercompression::zstd).says("bytes instead of 768"));
  for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
    const ThrownError error = refusal_of("sky.ktx2", noisy_chain(16, 1), packing, [](auto& bytes) {
      for (std::size_t i = bytes.size() - 4000; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
    });
    CHECK(error.code == ErrorCode::corrupt_file);
    CHECK(error.says("does not unpack"));
  }
}

TEST_CASE("a packed level that unpacks to less than its size is refused", "[codec][textures]") {
  for (const Supercompression packing : {Supercompression::zlib, Supercompression::zstd}) {
    const ThrownError error = refusal_of("sky.ktx2", noisy_chain(4, 1), packing, [](auto& bytes) {
      put(bytes, 20, 8);              // width
      put(bytes, 24, 8);              // height
      put(bytes, 96, 6 * 8 * 8 * 8);  // unpacked bytes
    });
    CHECK(error.says("shorter than the level index says"));
  }
}

TEST_CASE("DDS files that are not for us are named for what they are", "[codec][textures]") {
  CHECK(refusal_with("sky.dds", 4, 123).says("states wrong sizes"));
  CHECK(refusal_with("sky.dds", 84, 0x31545844).says("no DX10 header"));
  CHECK(refusal_with("sky.dds", 128, 98).says("DXGI_FORMAT 98"));
  CHECK(refusal_with("sky.dds", 132, 4).says("a 1D or 3D texture"));
  CHECK(refusal_with("sky.dds", 136, 0).says("not a cubemap"));
  CHECK(refusal_with("sky.dds", 140, 2).says("ends too early"));
  CHECK(refusal_with("sky.dds", 16, 8).says("8 x 4"));
  CHECK(refusal_with("sky.dds", 28, 12).says("12 levels"));
}

TEST_CASE("a texture that takes more memory than it may is refused before it is read", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(64, 1);
  for (const Supercompression packing : {Supercompression::none, Supercompression::zstd}) {
    write_texture(directory.file("sky.ktx2"), chain.views(), {TexelFormat::rgba16f, packing, {}});
    const auto read = [&] { (void)read_texture(directory.file("sky.ktx2"), 100000); };
    check_thrown(read, ErrorCode::limit_exceeded, {"raise the limit"});
  }
  BabylonEnvironment environment;
  environment.specular = noisy_chain(64, 7);
  write_babylon_environment(directory.file("sky.env"), environment);
  check_thrown([&] { (void)read_babylon_environment(directory.file("sky.env"), 100000); }, ErrorCode::limit_exceeded);
}

TEST_CASE("packed sizes that overflow together are above the limit", "[codec][textures]") {
  const TemporaryFile path("sky.ktx2");
  write_texture(path, noisy_chain(8, 4).views(), {TexelFormat::rgba16f, Supercompression::zstd, {}});
  std::vector<char> bytes = read_bytes(path);
  for (std::size_t level = 0; level < 4; ++level) put(bytes, 80 + 24 * level + 12, 1U << 30U);  // 2^62 bytes each
  write_bytes(path, bytes);
  std::error_code too_large;
  std::filesystem::resize_file(path, (std::uintmax_t{1} << 62U) + (1U << 20U), too_large);
  if (too_large) {
    WARN("left out: the file system holds no sparse file of 2^62 bytes");
    return;
  }
  CHECK(thrown_by([&] { (void)read_texture(path); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("DDS mips are counted by their number, whether or not the flag beside it is set", "[codec][textures]") {
  const TemporaryFile path("sky.dds");
  write_texture(path, noisy_chain(4, 3).views(), {});
  const CubemapTexture flagged = read_texture(path);
  std::vector<char> bytes = read_bytes(path);
  bytes[10] = static_cast<char>(bytes[10] & ~2);  // DDSD_MIPMAPCOUNT
  write_bytes(path, bytes);
  const CubemapTexture read = read_texture(path);
  REQUIRE(read.cubemap.levels() == 3);
  CHECK(std::memcmp(read.cubemap.face(0, 0), flagged.cubemap.face(0, 0), read.cubemap.bytes()) == 0);
}

TEST_CASE("numbers that are no enumerators are refused", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(2, 1);
  for (const int number : {-1, 9, 99}) {
    TextureOptions options{.format = static_cast<TexelFormat>(number)};
    for (const char* const file : {"sky.ktx2", "sky.dds", "sky.exr"}) {
      const ThrownError error = thrown_by([&] { write_texture(directory.file(file), chain.views(), options); });
      CHECK(error.code == ErrorCode::invalid_argument);
    }
    options = {};
    options.format = TexelFormat::bc6h_ufloat;
    options.bc6h_effort = static_cast<Bc6hEffort>(number);
    const auto with_effort = [&] { write_texture(directory.file("sky.ktx2"), chain.views(), options); };
    CHECK(thrown_by(with_effort).code == ErrorCode::invalid_argument);
    options = {};
    options.supercompression = static_cast<Supercompression>(number);
    const ThrownError error = thrown_by([&] { write_texture(directory.file("sky.ktx2"), chain.views(), options); });
    CHECK(error.code == ErrorCode::invalid_argument);
  }
  CHECK(entries(directory) == 0);
}

TEST_CASE("flaws in an .env's manifest are named", "[codec][env]") {
  const auto with = [](const char* pointer, const Json& value) {
    return env_refusal([&](EnvParts& parts) { parts.manifest[Json::json_pointer(pointer)] = value; });
  };
  const auto without = [](const char* parent, const auto& child) {
    return env_refusal([&](EnvParts& parts) { parts.manifest[Json::json_pointer(parent)].erase(child); });
  };
  CHECK(with("/version", 3).code == ErrorCode::unsupported_file);
  CHECK(with("/version", 3).says("is an .env of version 3"));
  CHECK(without("", "version").says("no \"version\""));
  CHECK(with("/width", 5).says("a power of two"));
  CHECK(with("/width", 32768).says("from 1 to 16384"));
  CHECK(with("/width", "4").says("not a number"));
  CHECK(with("/width", 2).says("there must be 12"));
  CHECK(with("/width", 1e300).says("not an integer"));
  CHECK(with("/specular", nullptr).says("no \"specular\""));
  CHECK(with("/specular/mipmaps/3/position", 1 << 20).says("bytes follow it"));
  CHECK(with("/specular/mipmaps/3/length", -1).says("not an integer from 0 up"));
  CHECK(with("/specular/lodGenerationScale", -1).says("below 0"));
  CHECK(with("/irradiance/yz", {1, 2}).says("not three numbers"));
  CHECK(without("/irradiance", "zx").says("no \"zx\""));
  CHECK(without("/irradiance/irradianceTexture/faces", std::size_t{5}).says("there must be 6"));
  CHECK(env_refusal([](EnvParts& parts) {
          std::swap(parts.manifest["specular"]["mipmaps"][0], parts.manifest["specular"]["mipmaps"][6]);
        }).says("level 0, face +X, is 2 x 2 texels; its level has 4 x 4"));
  CHECK(env_refusal([](EnvParts& parts) {
          parts.payload[40] = static_cast<char>(~parts.payload[40]);
        }).says("is a damaged PNG"));
  CHECK(env_refusal([](EnvParts& parts) { parts.payload[1] = 'X'; }).says("neither a PNG nor a WebP"));
  CHECK(env_refusal([](EnvParts& parts) { parts.payload.resize(100); }).says("bytes follow it"));
}

TEST_CASE("older .env versions are read as the first, without an image type", "[codec][env]") {
  for (const Json& version : {Json(1), Json(0), Json(1.5), Json(-7)}) {
    const TemporaryDirectory directory;
    EnvParts parts = sound_env(directory);
    parts.manifest["version"] = version;
    parts.manifest.erase("imageType");
    parts.manifest["specular"].erase("lodGenerationScale");
    write_env(directory.file("old.env"), parts.manifest.dump(), parts.payload);
    const BabylonEnvironment read = read_babylon_environment(directory.file("old.env"));
    CHECK(read.version == 1);
    CHECK(read.lod_generation_scale == 0.8);
    CHECK(read.specular.size() == 4);
  }
}

TEST_CASE("a manifest that is huge, deep or no JSON is refused", "[codec][env]") {
  const TemporaryDirectory directory;
  const auto refusal = [&directory](const std::string& manifest) {
    write_env(directory.file("sky.env"), manifest, {});
    return thrown_by([&] { (void)read_babylon_environment(directory.file("sky.env")); });
  };
  CHECK(refusal("{\"version\": 2,").says("is not JSON"));
  CHECK(refusal("").says("is not JSON"));
  CHECK(refusal("[]").says("no \"version\""));
  CHECK(refusal("{\"version\":2,\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}")
            .says("nested deeper than 8"));
  CHECK(refusal("{\"version\":2,\"a\":\"" + std::string(std::size_t{1} << 20U, 'x') + "\"}").code ==
        ErrorCode::limit_exceeded);
  write_bytes(directory.file("sky.env"), {'\x86', '\x16', '\x87', '\x96', '\xF6', '\xD6', '\x96', '\x36', '{', '}'});
  CHECK(thrown_by([&] { (void)read_babylon_environment(directory.file("sky.env")); }).says("does not end"));
}

TEST_CASE("textures that cannot be written are refused, and nothing is left", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(4, 3);
  const std::vector<CubemapView> mips = chain.views();
  const auto refusal = [&](const char* file, std::span<const CubemapView> levels, const TextureOptions& options = {}) {
    ThrownError error = thrown_by([&] { write_texture(directory.file(file), levels, options); });
    CHECK(entries(directory) == 0);
    return error;
  };
  CHECK(refusal("sky.png", mips).code == ErrorCode::unsupported_file);
  CHECK(refusal("sky.png", mips).says("use .ktx2, .ktx, .dds or .exr"));
  CHECK(refusal("sky", mips).says("no extension"));
  CHECK(refusal("none/sky.dds", mips).code == ErrorCode::file_access);
  CHECK(refusal("sky.ktx2", {}).says("a level at least"));
  const std::vector<CubemapView> gap{mips[0], mips[2]};
  CHECK(refusal("sky.ktx2", gap).says("level 1 has 1 texels along an edge; below 4 it must have 2"));
  const std::vector<CubemapView> many{mips[2], mips[2]};
  CHECK(refusal("sky.ktx2", many).says("2 levels were passed; from 1 texels down there are 1"));
  CHECK(refusal("sky.exr", mips, {TexelFormat::e5b9g9r9}).says("cannot hold e5b9g9r9"));
  const TextureOptions packed{TexelFormat::rgba16f, Supercompression::zlib, {}};
  CHECK(refusal("sky.dds", mips, packed).says("cannot be supercompressed"));
  CHECK(refusal("sky.exr", mips, packed).says("cannot be supercompressed"));
  for (const std::string& key : {std::string(), std::string("KTXwriter"), std::string("a\0b", 3)}) {
    const TextureOptions options{TexelFormat::rgba16f, Supercompression::none, {{key, "x"}}};
    CHECK(refusal("sky.ktx2", mips, options).code == ErrorCode::invalid_argument);
  }
  const TextureOptions taken{TexelFormat::rgba16f, Supercompression::none, {{"channels", "x"}}};
  CHECK(refusal("sky.exr", mips, taken).says("which OpenEXR keeps for itself"));
  const TextureOptions long_value{
      TexelFormat::rgba16f, Supercompression::none, {{"a", std::string(std::size_t{2} << 20U, 'x')}}};
  CHECK(refusal("sky.ktx2", mips, long_value).says("1 MiB is the most"));
}

TEST_CASE("a texture's or an .env's writing and reading can be cancelled, and its progress never falls",
          "[codec][textures][env]") {
  const TemporaryDirectory directory;
  BabylonEnvironment environment;
  environment.specular = noisy_chain(64, 7);
  const std::vector<CubemapView> mips = environment.specular.views();
  const auto write = [&](const std::string& file, const Control& control) {
    const bool packed = file == "packed.ktx2";
    const TextureOptions options{TexelFormat::rgba16f, packed ? Supercompression::zstd : Supercompression::none, {}};
    if (file == "sky.env") {
      write_babylon_environment(directory.file(file), environment, control);
    } else {
      write_texture(directory.file(file), mips, options, control);
    }
  };
  const auto read = [&](const std::string& file, const Control& control) {
    if (file == "sky.exr") return;
    if (file == "sky.env") {
      (void)read_babylon_environment(directory.file(file), std::uint64_t{1} << 30U, control);
    } else {
      (void)read_texture(directory.file(file), std::uint64_t{1} << 30U, control);
    }
  };
  std::size_t files = 0;
  for (const std::string file : {"sky.ktx2", "packed.ktx2", "sky.dds", "sky.exr", "sky.env"}) {
    CAPTURE(file);
    stop_source stop;
    const Control cancelled{stop.get_token(), [&stop](double done) {
                              if (done > 0.3) stop.request_stop();
                            }};
    CHECK(thrown_by([&] { write(file, cancelled); }).code == ErrorCode::cancelled);
    CHECK(entries(directory) == files);
    for (const bool writing : {true, false}) {
      double last = 0.0;
      const Control watched{{}, [&last](double done) {
                              CHECK(done >= last);
                              last = done;
                            }};
      writing ? write(file, watched) : read(file, watched);
      if (writing || file != "sky.exr") CHECK(last == 1.0);
    }
    ++files;
    if (file != "sky.exr") CHECK(thrown_by([&] { read(file, cancelled); }).code == ErrorCode::cancelled);
  }
}

}  // namespace welkin::test
