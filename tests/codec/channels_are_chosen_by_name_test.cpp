// Promises: R, G and B are found by name among whatever other channels there are, in the layer that is asked for; Y
// alone is grey; integers are the numbers that they state.
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <algorithm>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

// Writes 32 x 16 texels in the channels and gives them back.
std::vector<float> write_channels(const std::filesystem::path& path, const std::vector<test::ExrChannel>& channels) {
  std::vector<float> pixels = test::some_pixels(32, 16);
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, channels};
  test::write_exr(path, recipe, pixels);
  return pixels;
}

std::vector<test::ExrChannel> layer(const std::string& prefix, const std::vector<std::string>& names) {
  std::vector<test::ExrChannel> channels;
  for (std::size_t i = 0; i < names.size(); ++i) {
    channels.push_back({prefix + names[i], Imf::FLOAT, 1, static_cast<int>(i)});
  }
  return channels;
}

std::vector<test::ExrChannel> together(std::vector<test::ExrChannel> channels,
                                       const std::vector<test::ExrChannel>& others) {
  channels.insert(channels.end(), others.begin(), others.end());
  return channels;
}

ReadOptions with_layer(const std::string& name) {
  ReadOptions options;
  options.layer = name;
  return options;
}

bool reads(const std::filesystem::path& path, const std::vector<float>& pixels, const ReadOptions& options = {}) {
  return std::equal(pixels.begin(), pixels.end(), read_environment(path, options).pixels.get());
}

std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
  const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, options); });
  CHECK(error.code == ErrorCode::unsupported_file);
  return error.message.substr(path.string().size());
}

}  // namespace

TEST_CASE("R, G and B are found among other channels, whatever those are", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("channels.exr");
  const std::vector<float> pixels = test::some_pixels(32, 16);
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = {{"R", Imf::FLOAT, 1, 0},    {"G", Imf::HALF, 1, 1},        {"B", Imf::FLOAT, 1, 2},
                     {"A", Imf::HALF, 1, 0},     {"Z", Imf::FLOAT, 1, 1},       {"id", Imf::UINT, 1, 2},
                     {"sky.R", Imf::HALF, 1, 2}, {"half.size", Imf::HALF, 2, 0}};
  test::write_exr(path, recipe, pixels);
  const Environment read = read_environment(path);
  REQUIRE(read.info.channels.size() == 8);
  CHECK(read.info.channels[0].name == "A");
  CHECK(read.info.channels[0].type == "half");
  CHECK(read.info.channels[5].name == "half.size");
  CHECK(read.info.channels[6].name == "id");
  CHECK(read.info.channels[6].type == "uint");
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    REQUIRE(read.pixels[i] == (i % 3 == 1 ? test::as_half(pixels[i]) : pixels[i]));
  }
}

TEST_CASE("Y alone becomes grey, scanline and tiled", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("grey.exr");
  const std::vector<float> pixels = test::some_pixels(32, 16);
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(8, 8)}}) {
    test::ExrRecipe recipe{32, 16, 5, -3, Imf::PIZ_COMPRESSION, Imf::INCREASING_Y, tiles, std::nullopt, {}};
    recipe.channels = {{"Y", Imf::FLOAT, 1, 1}};
    test::write_exr(path, recipe, pixels);
    const Environment read = read_environment(path);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      REQUIRE(read.pixels[i] == pixels[i / 3 * 3 + 1]);
    }
  }
}

TEST_CASE("colours are found in any spelling, alone and in layers", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("layers.exr");
  for (const std::string prefix : {"", "env.", "ViewLayer.Combined.", "..", "a b."}) {
    for (const auto& names : {std::vector<std::string>{"R", "G", "B"},
                              {"r", "g", "b"},
                              {"red", "green", "blue"},
                              {"Red", "Green", "Blue"}}) {
      CAPTURE(prefix, names[0]);
      CHECK(reads(path, write_channels(path, together(layer(prefix, names), {{"depth.Z"}, {"crypto.a"}}))));
      CHECK(inspect_environment(path).layers.size() == (prefix.empty() ? 0 : 1));
    }
  }
}

TEST_CASE("layers are chosen by name; by default the channels without one, else the only one in colour", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("layers.exr");
  const std::vector<std::string> rgb{"R", "G", "B"};
  const std::vector<std::string> bgr{"B", "G", "R"};
  std::vector<float> pixels = write_channels(path, together(together(layer("", rgb), layer("env.", bgr)), {{"a.b.Y"}}));
  CHECK(inspect_environment(path).layers == std::vector<std::string>{"a.b", "env"});
  CHECK(reads(path, pixels));
  CHECK(read_environment(path, with_layer("env")).pixels[0] == pixels[2]);
  CHECK(read_environment(path, with_layer("a.b")).pixels[0] == test::as_half(pixels[0]));
  CHECK(reads(path, write_channels(path, together(layer("env.", rgb), {{"ao.Y"}, {"mask.Y"}}))));
  CHECK(reads(path, write_channels(path, together(layer("env.", rgb), layer("N.", {"X", "Y", "Z"})))));
  CHECK(inspect_environment(path).layers == std::vector<std::string>{"env"});
}

TEST_CASE("layers that are not there, and too many of them, are errors that name them", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("layers.exr");
  write_channels(path, together(layer("left.", {"R", "G", "B"}), layer("right.", {"R", "G", "B"})));
  CHECK(refusal(path) == ": has several layers; pass --layer with one of: left, right");
  CHECK(
      refusal(path, with_layer("top")) ==
      ": has no layer \"top\" with R, G and B or Y (channels left.B, left.G, left.R, right.B, right.G, right.R); pass "
      "--layer with one of: left, right");
  write_channels(path, {{"ao.Y"}, {"mask.Y"}});
  CHECK(refusal(path) == ": has several layers; pass --layer with one of: ao, mask");
  write_channels(path, layer("", {"R", "G", "B"}));
  CHECK(refusal(path, with_layer("top")) ==
        ": has no layer \"top\" with R, G and B or Y (channels B, G, R); leave --layer out");
  write_channels(path, layer("", {"X", "Y", "Z"}));
  CHECK(refusal(path).find("has channels X, Y, Z; R, G and B, or Y") != std::string::npos);
}

TEST_CASE("the views of a multi-view file are its layers, and the default view has none", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("views.exr");
  const std::vector<float> pixels = test::some_pixels(32, 16);
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = together(layer("", {"R", "G", "B"}), layer("left.", {"B", "G", "R"}));
  recipe.adjust = [](Imf::Header& header) { Imf::addMultiView(header, {"right", "left"}); };
  test::write_exr(path, recipe, pixels);
  CHECK(reads(path, pixels));
  CHECK(read_environment(path, with_layer("left")).pixels[2] == pixels[0]);
}

TEST_CASE("integers are the numbers that they state", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("integers.exr");
  std::vector<float> pixels;
  for (int i = 0; i < 32 * 16 * 3; ++i) {
    pixels.push_back(i < 3 ? 4294967040.0F : static_cast<float>(i * 131));  // the first: the largest float below 2^32
  }
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(8, 8)}}) {
    test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, tiles, std::nullopt, {}};
    recipe.channels = test::rgb_channels(Imf::UINT);
    test::write_exr(path, recipe, pixels);
    CHECK(reads(path, pixels));
    CHECK(inspect_environment(path).channels[0].type == "uint");
  }
}

}  // namespace welkin
