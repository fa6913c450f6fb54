// Promises: of a multi-part OpenEXR file the part that is asked for is read, by name or number; by default the first
// with colour, else with luminance; deep ones are skipped.
#include <algorithm>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

test::ExrPartRecipe part(const std::string& name, const std::vector<test::ExrChannel>& channels, unsigned seed) {
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, channels};
  return {name, recipe, test::some_pixels(32, 16, seed)};
}

std::string name_of_read_part(const std::filesystem::path& path, const std::vector<test::ExrPartRecipe>& parts,
                              const ReadOptions& options = {}) {
  const Environment read = read_environment(path, options);
  for (const test::ExrPartRecipe& candidate : parts) {
    if (std::equal(candidate.rgb.begin(), candidate.rgb.end(), read.pixels.get())) {
      return candidate.name;
    }
  }
  return "none";
}

ReadOptions with_part(const std::string& name) {
  ReadOptions options;
  options.part = name;
  return options;
}

}  // namespace

TEST_CASE("parts are chosen by name, by number and by what they hold", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("parts.exr");
  const std::vector<test::ExrChannel> colour = test::rgb_channels(Imf::FLOAT);
  std::vector<test::ExrPartRecipe> parts{part("mask", {{"Y"}}, 1), part("depth", {{"Z", Imf::FLOAT}}, 2),
                                         part("sky", colour, 3), part("0", colour, 4), part("tiles", colour, 5)};
  parts[4].recipe.tiles = Imf::TileDescription(7, 5);
  test::write_exr_parts(path, parts);
  CHECK(inspect_environment(path).parts == std::vector<std::string>{"mask", "depth", "sky", "0", "tiles"});
  CHECK(name_of_read_part(path, parts) == "sky");
  CHECK(name_of_read_part(path, parts, with_part("sky")) == "sky");
  CHECK(name_of_read_part(path, parts, with_part("0")) == "0");  // a name goes before a number
  CHECK(name_of_read_part(path, parts, with_part("4")) == "tiles");
  CHECK(inspect_environment(path, with_part("tiles")).storage == "tiled 7 x 5");
  const Environment mask = read_environment(path, with_part("mask"));
  CHECK(mask.pixels[0] == mask.pixels[2]);
}

TEST_CASE("without colour the first part with luminance is read", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("parts.exr");
  test::write_exr_parts(path, {part("depth", {{"Z", Imf::FLOAT}}, 1), part("mask", {{"Y", Imf::FLOAT, 1, 1}}, 2)});
  CHECK(read_environment(path).pixels[0] == test::some_pixels(32, 16, 2)[1]);
}

TEST_CASE("the part that has the layer is read", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("parts.exr");
  const std::vector<test::ExrPartRecipe> parts{
      part("a", test::rgb_channels(Imf::FLOAT), 1),
      part("b", {{"sun.R", Imf::FLOAT, 1, 0}, {"sun.G", Imf::FLOAT, 1, 1}, {"sun.B", Imf::FLOAT, 1, 2}}, 2)};
  test::write_exr_parts(path, parts);
  ReadOptions options;
  options.layer = "sun";
  CHECK(name_of_read_part(path, parts, options) == "b");
}

TEST_CASE("deep parts are skipped, and refused if they are asked for", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("parts.exr");
  std::vector<test::ExrPartRecipe> parts{part("smoke", test::rgb_channels(Imf::FLOAT), 1),
                                         part("sky", test::rgb_channels(Imf::FLOAT), 2)};
  parts[0].deep = true;
  parts[0].recipe.compression = Imf::ZIPS_COMPRESSION;
  test::write_exr_parts(path, parts);
  CHECK(name_of_read_part(path, parts) == "sky");
  const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, with_part("smoke")); });
  CHECK(error.code == ErrorCode::unsupported_file);
  CHECK(error.says(path.string() + ": its part \"smoke\" is a deep OpenEXR picture; flatten it"));
  parts.pop_back();
  test::write_exr_parts(path, parts);
  CHECK(test::thrown_by([&] { (void)inspect_environment(path); }).says("deep OpenEXR picture; flatten it"));
}

TEST_CASE("a part that is not there is an error that names those that are", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("parts.exr");
  const auto message = [&](const ReadOptions& options) {
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, options); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  const std::vector<test::ExrPartRecipe> parts{part("depth", {{"Z"}}, 1), part("alpha", {{"A"}}, 2)};
  test::write_exr_parts(path, parts);
  CHECK(message(with_part("sky")) == path.string() + ": has no part \"sky\"; its parts are 0 \"depth\", 1 \"alpha\": " +
                                         "pass one's name or number with --part");
  CHECK(message(with_part("2")).find("has no part \"2\"") != std::string::npos);
  CHECK(message(with_part("-1")).find("has no part \"-1\"") != std::string::npos);
  CHECK(message({}).find("none of its parts (0 \"depth\", 1 \"alpha\") is a flat picture with R, G and B or Y; "
                         "pass the part with --part") != std::string::npos);
  test::write_exr(path, parts[0].recipe, parts[0].rgb);
  CHECK(message(with_part("sky")).find("has a single part, and part \"sky\" was asked for; leave --part out") !=
        std::string::npos);
}

}  // namespace welkin
