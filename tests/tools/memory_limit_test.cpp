// Promises: --memory-limit counts all pixels that are held at once, and a refusal's remedy is one that would do.
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "tools/command.h"
#include "tools/temporary_folder.h"
#include "welkin/environment_writer.h"
#include "welkin/image.h"

using namespace welkin::test;

namespace {

constexpr int kWidth = 512;
constexpr int kHeight = 256;
constexpr int kPictureBytes = 12 * kWidth * kHeight;
constexpr int kRowsBytes = 1'000'000;  // of some rows at a time, and to spare

std::string limit(int bytes) { return " --memory-limit " + std::to_string(bytes); }

std::filesystem::path write_map(const TemporaryFolder& folder) {
  const auto path = folder.path() / "sky.pfm";
  const welkin::LatLongImage map{kWidth, kHeight, some_pixels(kWidth, kHeight)};
  welkin::write_environment(path, map.view());
  return path;
}

void check_refused(const std::string& arguments, const std::string& message) {
  const CommandResult result = run_welkin(arguments);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  CHECK(result.exit_code == 1);
  CHECK(contains(result.errors, message));
}

}  // namespace

TEST_CASE("command: convert's memory limit counts the source and the result", "[tools]") {
  const TemporaryFolder folder;
  const std::string convert =
      "convert " + quoted(write_map(folder)) + " " + quoted(folder.path() / "out.pfm") + " --yaw 33";
  CHECK(run_welkin(convert + limit(2 * kPictureBytes)).exit_code == 0);
  check_refused(convert + limit(2 * kPictureBytes - 1), "beside the 1572864 of the picture that is read");
}

TEST_CASE("command: what sh holds twice counts twice", "[tools]") {
  const TemporaryFolder folder;
  const std::string sh = "sh " + quoted(write_map(folder));
  CHECK(run_welkin(sh + limit(kRowsBytes)).exit_code == 0);
  CHECK(run_welkin(sh + " --take-out-sun" + limit(2 * kPictureBytes)).exit_code == 0);
  check_refused(sh + " --take-out-sun" + limit(2 * kPictureBytes - 1), "held twice for --take-out-sun");
}

TEST_CASE("command: a picture that must be decoded whole is not told to have smaller blocks", "[tools]") {
  const TemporaryFolder folder;
  PngRecipe recipe;
  recipe.width = 640;
  recipe.height = 320;
  recipe.interlaced = true;
  const auto path = folder.path() / "sky.png";
  write_bytes(path, png_bytes(recipe, some_samples(recipe)));
  check_refused("info " + quoted(path) + limit(300'000), "save it without interlacing");
}
