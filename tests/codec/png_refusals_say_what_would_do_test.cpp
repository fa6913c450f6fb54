// Promises: a PNG that is not read is refused by a code and a message with the file's name, what was found, and what
// would do.
#include "codec/row_source.h"
#include "support/catch.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

constexpr std::size_t kBitsPlace = 24;  // in the file

std::vector<char> sound_png(int width = 8, int height = 4, bool interlaced = false) {
  const test::PngRecipe recipe{width, height, 8, SPNG_COLOR_TYPE_TRUECOLOR, interlaced};
  return test::png_bytes(recipe, test::some_samples(recipe));
}

void check_refusal(const std::vector<char>& file, ErrorCode code, const std::string& found, const std::string& remedy) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  test::write_bytes(path, file);
  const test::ThrownError error = test::thrown_by([&] { (void)read_environment(path, {Layout::lat_long}); });
  INFO(error.message);
  CHECK(error.code == code);
  CHECK(error.says(path.string() + ": "));
  CHECK(error.says(found));
  CHECK(error.says(remedy));
}

}  // namespace

TEST_CASE("damaged PNGs are refused by what is wrong with them", "[codec][png]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  const std::vector<char> sound = sound_png();
  const auto cut = [&](std::size_t size) {
    return std::vector<char>(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size));
  };
  check_refusal(cut(8), corrupt, "ends too early", "fetch or export it again");
  check_refusal(cut(sound.size() / 2), corrupt, "ends too early", "fetch or export it again");
  check_refusal(cut(sound.size() - 1), corrupt, "ends too early", "fetch or export it again");

  std::vector<char> damaged = sound;
  damaged[sound.size() / 2] = static_cast<char>(damaged[sound.size() / 2] ^ 0x55);
  check_refusal(damaged, corrupt, "is a damaged PNG: ", "fetch or export it again");
  damaged = sound;
  damaged[5] = 'x';
  check_refusal(damaged, corrupt, "libspng says \"", "fetch or export it again");
  damaged = sound;
  damaged[kBitsPlace] = 7;
  check_refusal(damaged, corrupt, "bit depth", "fetch or export it again");
  check_refusal(test::with_png_size(sound, 0, 4), corrupt, "libspng says \"", "");
  check_refusal(test::with_png_size(sound, 8, 0xffffffff), corrupt, "libspng says \"", "");
  check_refusal(test::with_png_size(sound, 8, 5), corrupt, "near row 3 of 5", "fetch or export it again");
  check_refusal(test::with_png_chunk(sound, "WHAT", "is this"), corrupt, "libspng says \"", "");
}

TEST_CASE("PNGs too large for any layout are refused before they are read", "[codec][png]") {
  const std::vector<char> sound = sound_png();
  check_refusal(test::with_png_size(sound, 65537, 4), ErrorCode::unsupported_file,
                "its 65537 x 4 texels are more than 65536 x 98304", "reduce the picture first");
  check_refusal(test::with_png_size(sound, 8, 0x7fffffff), ErrorCode::unsupported_file, "its 8 x 2147483647 texels",
                "reduce the picture first");
}

TEST_CASE("what a PNG's header claims costs no memory", "[codec][png]") {
  for (const bool interlaced : {false, true}) {
    check_refusal(test::with_png_size(sound_png(8, 4, interlaced), 65536, 32768), ErrorCode::corrupt_file,
                  "ends too early: 65536 x 32768 texels of a PNG take at least 6242685 bytes",
                  "fetch or export it again");
  }
}

TEST_CASE("an interlaced PNG is refused where decoding it whole takes too much", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  ReadOptions options;
  options.memory_limit_bytes = std::uint64_t{512} << 10U;
  test::write_bytes(path, sound_png(640, 320, true));
  CHECK(inspect_environment(path, options).width == 640);
  CHECK(test::thrown_by([&] { (void)measure_environment(path, options); }).code == ErrorCode::limit_exceeded);
  const test::ThrownError error = test::thrown_by([&] { (void)codec::open_row_source(path, options)->open_reader(); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says(path.string() + ": is interlaced, so that it must be decoded whole"));
  CHECK(error.says("save it without interlacing"));
  test::write_bytes(path, sound_png(640, 320, false));
  CHECK(codec::open_row_source(path, options)->reader_bytes() < options.memory_limit_bytes);
  (void)codec::open_row_source(path, options)->open_reader();
}

}  // namespace welkin
