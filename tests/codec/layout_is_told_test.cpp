// Promises: the layout is what was asked for, else what the header says, else what the shape says; and the reason
// is given.
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

std::filesystem::path write_picture(const test::TemporaryDirectory& directory, int width, int height,
                                    std::optional<Imf::Envmap> envmap = std::nullopt) {
  std::filesystem::path path = directory.file("sky.exr");
  test::ExrRecipe recipe{width, height, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, envmap, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, test::some_pixels(width, height));
  return path;
}

ReadOptions as(Layout layout) {
  ReadOptions options;
  options.layout = layout;
  return options;
}

}  // namespace

TEST_CASE("layouts have names", "[codec]") {
  CHECK(std::string(name(Layout::automatic)) == "automatic");
  CHECK(std::string(name(Layout::lat_long)) == "lat-long");
  CHECK(std::string(name(Layout::vertical_strip)) == "vertical-strip");
}

TEST_CASE("the shape tells the layout", "[codec]") {
  const test::TemporaryDirectory directory;
  const EnvironmentInfo wide = inspect_environment(write_picture(directory, 64, 32));
  CHECK(wide.layout == Layout::lat_long);
  CHECK(wide.layout_reason == "64 x 32 is 2:1");
  const EnvironmentInfo tall = inspect_environment(write_picture(directory, 8, 48));
  CHECK(tall.layout == Layout::vertical_strip);
  CHECK(tall.layout_reason == "8 x 48 is 1:6");
}

TEST_CASE("a shape that tells nothing is refused, and --layout is offered", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = write_picture(directory, 64, 31);
  const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
  CHECK(error.code == ErrorCode::unsupported_file);
  CHECK(error.message ==
        path.string() + ": 64 x 31 is neither a 2:1 lat-long nor a 1:6 vertical strip; pass --layout to say otherwise");
}

TEST_CASE("the header tells before the shape", "[codec]") {
  const test::TemporaryDirectory directory;
  const EnvironmentInfo odd = inspect_environment(write_picture(directory, 50, 31, Imf::ENVMAP_LATLONG));
  CHECK(odd.layout == Layout::lat_long);
  CHECK(odd.layout_reason == "the header's envmap attribute says latlong");
  const EnvironmentInfo cube = inspect_environment(write_picture(directory, 4, 24, Imf::ENVMAP_CUBE));
  CHECK(cube.layout == Layout::vertical_strip);
  CHECK(cube.layout_reason == "the header's envmap attribute says cube");
  const std::filesystem::path path = write_picture(directory, 64, 32, Imf::ENVMAP_CUBE);
  const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
  CHECK(error.code == ErrorCode::unsupported_file);
  CHECK(error.says(path.string() + ": 64 x 32 is not a 1:6 vertical strip"));
  CHECK(error.says("--layout lat-long"));
}

TEST_CASE("what is asked for comes before header and shape", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = write_picture(directory, 8, 48, Imf::ENVMAP_CUBE);
  const EnvironmentInfo info = inspect_environment(path, as(Layout::lat_long));
  CHECK(info.layout == Layout::lat_long);
  CHECK(info.layout_reason == "lat-long was asked for");
  CHECK(inspect_environment(path, as(Layout::vertical_strip)).layout == Layout::vertical_strip);
  const std::filesystem::path wide = write_picture(directory, 100, 31);
  CHECK(inspect_environment(wide, as(Layout::lat_long)).layout == Layout::lat_long);
  CHECK(test::thrown_by([&] {
          (void)inspect_environment(wide, as(Layout::vertical_strip));
        }).says("100 x 31 is not a 1:6 vertical strip"));
}

TEST_CASE("an environment gives the view of its own layout and no other", "[codec]") {
  const test::TemporaryDirectory directory;
  const Environment sky = read_environment(write_picture(directory, 64, 32));
  CHECK(sky.lat_long().pixels == sky.pixels.get());
  CHECK(sky.lat_long().width == 64);
  CHECK(sky.lat_long().height == 32);
  CHECK(test::thrown_by([&] { (void)sky.cubemap(); }).code == ErrorCode::invalid_argument);
  const Environment strip = read_environment(write_picture(directory, 8, 48));
  CHECK(strip.cubemap().size == 8);
  CHECK(strip.cubemap().faces[5] == strip.pixels.get() + 5 * 8 * 8 * 3);
  CHECK(test::thrown_by([&] { (void)strip.lat_long(); }).says("vertical-strip"));
}

}  // namespace welkin
