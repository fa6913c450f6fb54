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
  CHECK(std::string(name(Layout::horizontal_strip)) == "horizontal-strip");
  CHECK(std::string(name(Layout::horizontal_cross)) == "horizontal-cross");
  CHECK(std::string(name(Layout::vertical_cross)) == "vertical-cross");
  CHECK(std::string(name(Layout::six_files)) == "six-files");
}

TEST_CASE("the shape tells the layout", "[codec]") {
  const test::TemporaryDirectory directory;
  const auto check = [&](int width, int height, Layout layout, const std::string& reason) {
    const EnvironmentInfo info = inspect_environment(write_picture(directory, width, height));
    CHECK(info.layout == layout);
    CHECK(info.layout_reason == reason);
  };
  check(64, 32, Layout::lat_long, "64 x 32 is 2:1");
  check(8, 48, Layout::vertical_strip, "8 x 48 is 1:6");
  check(48, 8, Layout::horizontal_strip, "48 x 8 is 6:1");
  check(32, 24, Layout::horizontal_cross, "32 x 24 is 4:3");
  check(24, 32, Layout::vertical_cross, "24 x 32 is 3:4");
  check(4, 3, Layout::horizontal_cross, "4 x 3 is 4:3");
}

TEST_CASE("a shape that tells nothing is refused, and --layout is offered", "[codec]") {
  const test::TemporaryDirectory directory;
  for (const auto& [width, height] : {std::pair{64, 31}, {33, 24}, {32, 25}, {49, 8}, {8, 47}, {13, 9}, {5, 1}}) {
    const std::filesystem::path path = write_picture(directory, width, height);
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
    CHECK(error.code == ErrorCode::unsupported_file);
    CHECK(error.message ==
          path.string() + ": " + std::to_string(width) + " x " + std::to_string(height) +
              " is neither a 2:1 lat-long nor a 1:6 vertical strip, a 6:1 horizontal strip, a 4:3 or a 3:4 cross; pass "
              "--layout to say what it is: lat-long (any ratio), vertical-strip (1:6), horizontal-strip (6:1), "
              "horizontal-cross (4:3), "
              "vertical-cross (3:4) or six-files (1:1 each)");
  }
}

TEST_CASE("a square that is none of six files is refused, saying why it is not", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = write_picture(directory, 8, 8);
  const test::ThrownError plain = test::thrown_by([&] { (void)inspect_environment(path); });
  CHECK(plain.code == ErrorCode::unsupported_file);
  CHECK(plain.says(path.string() + ": 8 x 8 is square, so it would be a face among six files, but " + path.string() +
                   ": its name does not end as one of six faces does (px nx"));
  CHECK(plain.says(". If it is something else, pass --layout to say what: lat-long (any ratio), "));
  const std::filesystem::path face = directory.file("sky_px.exr");
  std::filesystem::rename(path, face);
  const test::ThrownError alone = test::thrown_by([&] { (void)inspect_environment(face); });
  CHECK(alone.code == ErrorCode::unsupported_file);
  CHECK(alone.says("is one of six faces of which others are missing beside it: -X (sky_nx.exr), +Y (sky_py.exr)"));
  CHECK(inspect_environment(face, as(Layout::lat_long)).layout == Layout::lat_long);
  const test::ThrownError asked = test::thrown_by([&] { (void)inspect_environment(face, as(Layout::six_files)); });
  CHECK(asked.code == ErrorCode::file_access);
  CHECK(asked.says("-X (sky_nx.exr)"));
}

TEST_CASE("strips and crosses that are asked for must have their shape", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = write_picture(directory, 100, 31);
  const std::vector<std::pair<Layout, std::string>> cases{
      {Layout::vertical_strip, "1:6 vertical strip"},
      {Layout::horizontal_strip, "6:1 horizontal strip"},
      {Layout::horizontal_cross, "4:3 horizontal cross"},
      {Layout::vertical_cross, "3:4 vertical cross"},
  };
  for (const auto& [layout, words] : cases) {
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, as(layout)); });
    CHECK(error.code == ErrorCode::unsupported_file);
    CHECK(error.message == path.string() + ": 100 x 31 is not a " + words + " of six square faces (" + name(layout) +
                               " was asked for); pass --layout lat-long if it is one, or export the faces anew");
  }
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
  const test::ThrownError no_cube = test::thrown_by([&] { (void)sky.cubemap(); });
  CHECK(no_cube.code == ErrorCode::invalid_argument);
  CHECK(no_cube.says("is held as a lat-long (64 x 32 is 2:1), and a view of a cubemap was asked for"));
  CHECK(sky.face_size() == 0);
  const Environment strip = read_environment(write_picture(directory, 8, 48));
  CHECK(strip.cubemap().size == 8);
  CHECK(strip.cubemap().faces[5] == strip.pixels.get() + 5 * 8 * 8 * 3);
  CHECK(test::thrown_by([&] { (void)strip.lat_long(); }).says("vertical-strip"));
}

}  // namespace welkin
