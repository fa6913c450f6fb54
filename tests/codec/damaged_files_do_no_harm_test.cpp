// Promises: a file that is cut off anywhere, has any byte changed, or any field of its header set to an extreme, is
// either read or refused with an Error that names it. Nothing else happens.
#include "support/catch.h"
#include "support/damaged_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"

namespace welkin {
namespace {

struct Tally {
  int loaded = 0;
  int refused = 0;
};

// Whatever but an Error comes out of this fails the test.
void try_to_read(const std::filesystem::path& path, const std::vector<char>& bytes, Tally& tally) {
  std::filesystem::remove(path);  // ext4 waits for the disc when a file is written over, not when it is new
  test::write_bytes(path, bytes);
  ReadOptions options;
  options.memory_limit_bytes = std::uint64_t{16} << 20U;
  try {
    (void)read_environment(path, options);
    (void)measure_environment(path, options);
    ++tally.loaded;
  } catch (const Error& error) {
    if (std::string(error.what()).find(path.string()) != 0) FAIL("no file is named in: " << error.what());
    ++tally.refused;
  }
}

using Damage = void (*)(const test::SoundFile&, const test::Use&);

void check_damage(Damage damage, const std::string& extension, bool may_load) {
  const test::TemporaryDirectory directory;
  for (const test::SoundFile& sound : test::sound_files(directory.file(""))) {
    if (std::filesystem::path(sound.name).extension() != extension) continue;
    CAPTURE(sound.name);
    const std::filesystem::path path = directory.file(sound.name);
    Tally tally;
    try_to_read(path, sound.bytes, tally);
    REQUIRE(tally.loaded == 1);
    damage(sound, [&](const std::vector<char>& bytes) { try_to_read(path, bytes, tally); });
    if (!may_load && sound.all_is_read) CHECK(tally.loaded == 1);
    CHECK(tally.refused > 0);
  }
}

}  // namespace

TEST_CASE("a file that is cut off is refused, wherever the cut is", "[codec][damage]") {
  for (const char* extension : {".exr", ".pfm", ".hdr"}) check_damage(test::for_each_truncation, extension, false);
  check_damage(test::for_each_truncation, ".png", true);  // nothing that is needed follows the last row
}

TEST_CASE("no changed byte does harm", "[codec][damage]") {
  for (const char* extension : {".exr", ".pfm", ".hdr", ".png"}) {
    check_damage(test::for_each_changed_byte, extension, true);
  }
}

TEST_CASE("no extreme number in a header of text does harm", "[codec][damage]") {
  for (const char* extension : {".pfm", ".hdr"}) check_damage(test::for_each_extreme_number, extension, true);
}

TEST_CASE("no extreme field of an OpenEXR file does harm", "[codec][damage]") {
  check_damage(test::for_each_extreme_field, ".exr", true);
}

TEST_CASE("no extreme field of a Radiance or PFM or PNG file does harm", "[codec][damage]") {
  for (const char* extension : {".pfm", ".hdr", ".png"}) check_damage(test::for_each_extreme_field, extension, true);
}

}  // namespace welkin
