// Promises: what is not read is refused by a code and a message with the file's name, what was found, what would do.
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

void check_refusal(const std::filesystem::path& path, ErrorCode code, const std::string& found,
                   const std::string& remedy, const ReadOptions& options = {}) {
  const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, options); });
  INFO(error.message);
  CHECK(error.code == code);
  CHECK(error.says(path.string() + ": "));
  CHECK(error.says(found));
  CHECK(error.says(remedy));
}

std::vector<char> text(const std::string& words) { return {words.begin(), words.end()}; }

void check_text(const std::filesystem::path& path, const std::string& content, ErrorCode code, const std::string& found,
                const std::string& remedy) {
  test::write_bytes(path, text(content));
  check_refusal(path, code, found, remedy);
}

test::ExrRecipe small_recipe(const std::vector<test::ExrChannel>& channels) {
  test::ExrRecipe recipe{8, 4, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, channels};
  return recipe;
}

}  // namespace

TEST_CASE("what is no readable file is refused", "[codec]") {
  const test::TemporaryDirectory directory;
  check_refusal(directory.file("none.exr"), ErrorCode::file_access, "no such file", "");
  check_refusal(directory.file("."), ErrorCode::file_access, "is a directory", "name a picture in it");
  check_refusal("/dev/null", ErrorCode::file_access, "not a regular file", "copy");
}

TEST_CASE("other formats are refused by their names", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.pic");
  const ErrorCode code = ErrorCode::unsupported_file;
  const std::string remedy =
      "OpenEXR (.exr), Radiance (.hdr), PFM (.pfm), PNG, KTX2, DDS and .env are read: convert it";
  check_text(path, "", code, "is empty", remedy);
  check_text(path, "\xff\xd8\xff\xe0 JFIF", code, "a JPEG", remedy);
  check_text(path, "RIFF1234WEBP", code, "a WebP", remedy);
  check_text(path, "\xabKTX 11\xbb\r\n\x1a\n", code, "a KTX", "not of version 2.0; convert it");
  check_text(path, "good morning", code, "is of no kind that is known here", remedy);
}

TEST_CASE("channels that make no colour are refused by their names", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  const ErrorCode code = ErrorCode::unsupported_file;
  const std::vector<float> pixels = test::some_pixels(8, 4);

  test::write_exr(path, small_recipe({{"R"}, {"G"}}), pixels);
  check_refusal(path, code, "has channels G, R", "rename or convert the channels");
  test::write_exr(path, small_recipe({{"R"}, {"G"}, {"B", Imf::HALF, 2}}), pixels);
  check_refusal(path, code, "channel B is sampled at every 2 x 2 texels where 1 x 1 is read",
                "save it as R, G and B at full resolution");
  test::write_exr(path, small_recipe({{"Y"}, {"RY"}, {"BY"}}), pixels);
  check_refusal(path, code, "channel RY is sampled at every 1 x 1 texels where 2 x 2 (luminance-chroma) is read",
                "save it as R, G and B");
}

TEST_CASE("deep and multi-part files and unknown versions are refused by what they are", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  const ErrorCode code = ErrorCode::unsupported_file;
  test::write_exr(path, small_recipe(test::rgb_channels(Imf::HALF)), test::some_pixels(8, 4));
  const std::vector<char> sound = test::read_bytes(path);
  const auto with_version = [&](char version, char flags) {
    std::vector<char> bytes = sound;
    bytes[4] = version;
    bytes[5] = flags;
    test::write_bytes(path, bytes);
  };
  with_version(2, 0x08);
  check_refusal(path, code, "is a deep OpenEXR picture", "flatten");
  with_version(2, 0x10);
  check_refusal(path, ErrorCode::corrupt_file, "part 0 lacks a name", "fetch or export it again");
  with_version(2, 0x12);
  check_refusal(path, ErrorCode::corrupt_file, "single-part tiled and multi-part at once", "fetch or export it again");
  with_version(3, 0);
  check_refusal(path, code, "version 3", "save it as OpenEXR 2");
  with_version(2, 0x20);
  check_refusal(path, code, "flags 32", "save it as OpenEXR 2");
}

TEST_CASE("pictures too large for any layout are refused before they are read", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("vast.exr");
  const std::vector<float> pixels = test::some_pixels(65538, 1);
  test::ExrRecipe recipe{65538, 1, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, pixels);
  check_refusal(path, ErrorCode::unsupported_file, "65538 x 1", "reduce it");
  check_text(directory.file("vast.pfm"), "PF\n70000 1\n-1\n", ErrorCode::unsupported_file, "70000", "reduce");
}

TEST_CASE("damaged PFM headers are refused by what is wrong with them", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.pfm");
  const ErrorCode code = ErrorCode::corrupt_file;
  check_text(path, "PF", code, "ends too early", "fetch or export it again");
  check_text(path, "PF\n2", code, "ends too early", "");
  check_text(path, "PF\n2 1\n-1\n12345678", code, "ends too early: 2 x 1 texels take 24 bytes, 8 follow", "");
  check_text(path, "PF\n0 1\n-1\n", code, "width is 0", "");
  check_text(path, "PF\n2 -1\n-1\n", code, "height is -1", "");
  check_text(path, "PF\n2x 1\n-1\n", code, "width is no number: \"2x\"", "");
  check_text(path, "PF\n99999999999999999999 1\n-1\n", code, "width is no number", "");
  check_text(path, "PF\n2 1\n0\n", code, "scale is 0", "");
  check_text(path, "PF\n2 1\nnan\n", code, "scale is 0 or not finite", "");
  check_text(path, "PF\n2 1\nbig\n", code, "scale is no number", "");
  check_text(path, "PF" + std::string(5000, ' '), code, "has no width", "");
  check_text(path, "PF\n" + std::string(5000, '1'), code, "width is no number", "");
  check_text(path, "PFX\n2 1\n-1\n", ErrorCode::unsupported_file, "starts with \"PFX\"", "PF (colour) or Pf (grey)");
}

TEST_CASE("a picture above the memory limit is refused, a streamed one is not", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.pfm");
  test::write_bytes(path, test::pfm_bytes(512, 256, false, "-1", test::some_pixels(512, 256)));
  ReadOptions options;
  options.memory_limit_bytes = 512 * 256 * 12 - 1;
  const test::ThrownError error = test::thrown_by([&] { (void)read_environment(path, options); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says(path.string() + ": 512 x 256 texels take 1572864 bytes"));
  CHECK(error.says("raise the limit or reduce the picture"));
  CHECK(measure_environment(path, options).texels == 512 * 256);
  options.memory_limit_bytes = 1000;
  CHECK(test::thrown_by([&] { (void)measure_environment(path, options); }).code == ErrorCode::limit_exceeded);
}

}  // namespace welkin
