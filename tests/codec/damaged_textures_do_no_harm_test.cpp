// Promises: a texture or .env that is cut off anywhere, has any byte changed, or any field set to an extreme, is either
// read or refused with an Error that names it. Nothing else happens.
#include "support/catch.h"
#include "support/chains.h"
#include "support/damaged_files.h"
#include "support/temporary_directory.h"
#include "support/webp_env.h"
#include "welkin/babylon_environment.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/texture_file.h"

namespace welkin::test {
namespace {

SoundFile texture(const TemporaryDirectory& directory, const std::string& name, const TextureOptions& options) {
  write_texture(directory.file(name), noisy_chain(3, 2).views(), options);
  SoundFile file{name, read_bytes(directory.file(name))};
  file.header_bytes = std::min<std::size_t>(file.bytes.size(), 500);
  return file;
}

SoundFile env(const TemporaryDirectory& directory) {
  BabylonEnvironment environment;
  environment.specular = noisy_chain(2, 2);
  environment.polynomial = BabylonPolynomial{};
  environment.irradiance = {1, std::vector<float>(18, 0.5F)};
  write_babylon_environment(directory.file("sky.env"), environment);
  SoundFile file{"sky.env", read_bytes(directory.file("sky.env"))};
  file.header_bytes = std::min<std::size_t>(file.bytes.size(), 1300);
  return file;
}

SoundFile webp_env(const TemporaryDirectory& directory) {
  SoundFile file = env(directory);
  file.name = "webp.env";
  file.bytes = with_webp_pictures(file.bytes);
  file.header_bytes = file.bytes.size();
  return file;
}

std::vector<SoundFile> sound_textures(const TemporaryDirectory& directory) {
  return {texture(directory, "sky.ktx2", {}),
          texture(directory, "zlib.ktx2", {TexelFormat::b10g11r11, Supercompression::zlib, {{"key", "value"}}}),
          texture(directory, "zstd.ktx2", {TexelFormat::e5b9g9r9, Supercompression::zstd, {}}),
          texture(directory, "sky.dds", {}),
          env(directory),
          webp_env(directory)};
}

struct Tally {
  int loaded = 0;
  int refused = 0;
};

void try_to_read(const std::filesystem::path& path, const std::vector<char>& bytes, Tally& tally) {
  std::filesystem::remove(path);  // ext4 waits for the disc when a file is written over, not when it is new
  write_bytes(path, bytes);
  constexpr std::uint64_t limit = std::uint64_t{16} << 20U;
  ReadOptions options;
  options.memory_limit_bytes = limit;
  const auto attempt = [&](const auto& call) {
    try {
      call();
      ++tally.loaded;
    } catch (const Error& error) {
      if (std::string(error.what()).find(path.string()) != 0) FAIL("no file is named in: " << error.what());
      ++tally.refused;
    }
  };
  if (path.extension() == ".env") {
    attempt([&] { (void)read_babylon_environment(path, limit); });
  } else {
    attempt([&] { (void)read_texture(path, limit); });
  }
  attempt([&] { (void)read_environment(path, options); });
}

using Damage = void (*)(const SoundFile&, const Use&);

void check_damage(Damage damage, bool may_load) {
  const TemporaryDirectory directory;
  for (const SoundFile& sound : sound_textures(directory)) {
    CAPTURE(sound.name);
    Tally tally;
    try_to_read(directory.file(sound.name), sound.bytes, tally);
    REQUIRE(tally.loaded == 2);
    const Tally before = tally;
    damage(sound, [&](const std::vector<char>& bytes) { try_to_read(directory.file(sound.name), bytes, tally); });
    if (!may_load) CHECK(tally.loaded == before.loaded);
    CHECK(tally.refused > 0);
  }
}

}  // namespace

TEST_CASE("a texture that is cut off is refused, wherever the cut is", "[codec][textures][damage]") {
  check_damage(for_each_truncation, false);
}

TEST_CASE("no changed byte of a texture does harm", "[codec][textures][damage]") {
  check_damage(for_each_changed_byte, true);
}

TEST_CASE("no extreme field of a texture does harm", "[codec][textures][damage]") {
  check_damage(for_each_extreme_field, true);
}

TEST_CASE("no extreme number in an .env's manifest does harm", "[codec][env][damage]") {
  const TemporaryDirectory directory;
  const SoundFile sound = env(directory);
  Tally tally;
  for_each_extreme_number(
      sound, [&](const std::vector<char>& bytes) { try_to_read(directory.file("sky.env"), bytes, tally); });
  CHECK(tally.refused > 0);
}

}  // namespace welkin::test
