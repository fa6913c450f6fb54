// OpenEXR: channels, windows, orders of lines, compressions, and sizes that overflow.
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include "files/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: R, G and B are found by name among any other channels in the requested layer; Y alone is grey; integers
// are the numbers that they state.

namespace {

// Writes 32 x 16 texels in the channels and gives them back.
std::vector<float> write_channels(const std::filesystem::path& path, const std::vector<ExrChannel>& channels) {
  std::vector<float> pixels = some_pixels(32, 16);
  write_exr(path, {.width = 32, .height = 16, .channels = channels}, pixels);
  return pixels;
}

std::vector<ExrChannel> layer(const std::string& prefix, const std::vector<std::string>& names) {
  std::vector<ExrChannel> channels;
  for (std::size_t i = 0; i < names.size(); ++i) {
    channels.push_back({prefix + names[i], Imf::FLOAT, 1, static_cast<int>(i)});
  }
  return channels;
}

std::vector<ExrChannel> together(std::vector<ExrChannel> channels, const std::vector<ExrChannel>& others) {
  channels.insert(channels.end(), others.begin(), others.end());
  return channels;
}

ReadOptions with_layer(const std::string& name) { return {.layer = name}; }

bool reads(const std::filesystem::path& path, const std::vector<float>& pixels, const ReadOptions& options = {}) {
  return std::equal(pixels.begin(), pixels.end(), read_environment(path, options).pixels.get());
}

std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
  const ThrownError error = thrown_by([&] { (void)inspect_environment(path, options); });
  CHECK(error.code == ErrorCode::unsupported_file);
  return error.message.substr(path.string().size());
}

}  // namespace

TEST_CASE("R, G and B are found among other channels, whatever those are", "[codec]") {
  const TemporaryFile path("channels.exr");
  const std::vector<float> pixels = write_channels(path, {{"R", Imf::FLOAT, 1, 0},
                                                          {"G", Imf::HALF, 1, 1},
                                                          {"B", Imf::FLOAT, 1, 2},
                                                          {"A", Imf::HALF, 1, 0},
                                                          {"Z", Imf::FLOAT, 1, 1},
                                                          {"id", Imf::UINT, 1, 2},
                                                          {"sky.R", Imf::HALF, 1, 2},
                                                          {"half.size", Imf::HALF, 2, 0}});
  const Environment read = read_environment(path);
  REQUIRE(read.info.channels.size() == 8);
  CHECK(read.info.channels[0].name == "A");
  CHECK(read.info.channels[0].type == ChannelType::half);
  CHECK(read.info.channels[5].name == "half.size");
  CHECK(read.info.channels[6].name == "id");
  CHECK(read.info.channels[6].type == ChannelType::uint32);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    REQUIRE(read.pixels[i] == (i % 3 == 1 ? as_half(pixels[i]) : pixels[i]));
  }
}

TEST_CASE("Y alone becomes grey, scanline and tiled", "[codec]") {
  const TemporaryFile path("grey.exr");
  const std::vector<float> pixels = some_pixels(32, 16);
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(8, 8)}}) {
    write_exr(path, {32, 16, 5, -3, Imf::PIZ_COMPRESSION, Imf::INCREASING_Y, tiles, {}, {{"Y", Imf::FLOAT, 1, 1}}},
              pixels);
    const Environment read = read_environment(path);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      REQUIRE(read.pixels[i] == pixels[i / 3 * 3 + 1]);
    }
  }
}

TEST_CASE("colours are found in any spelling, alone and in layers", "[codec]") {
  const TemporaryFile path("layers.exr");
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
  const TemporaryFile path("layers.exr");
  const std::vector<std::string> rgb{"R", "G", "B"};
  const std::vector<std::string> bgr{"B", "G", "R"};
  std::vector<float> pixels = write_channels(path, together(together(layer("", rgb), layer("env.", bgr)), {{"a.b.Y"}}));
  CHECK(inspect_environment(path).layers == std::vector<std::string>{"a.b", "env"});
  CHECK(reads(path, pixels));
  CHECK(read_environment(path, with_layer("env")).pixels[0] == pixels[2]);
  CHECK(read_environment(path, with_layer("a.b")).pixels[0] == as_half(pixels[0]));
  CHECK(reads(path, write_channels(path, together(layer("env.", rgb), {{"ao.Y"}, {"mask.Y"}}))));
  CHECK(reads(path, write_channels(path, together(layer("env.", rgb), layer("N.", {"X", "Y", "Z"})))));
  CHECK(inspect_environment(path).layers == std::vector<std::string>{"env"});
}

TEST_CASE("layers that are not there, and too many of them, are errors that name them", "[codec]") {
  const TemporaryFile path("layers.exr");
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
  const TemporaryFile path("views.exr");
  const std::vector<float> pixels = some_pixels(32, 16);
  const ExrRecipe recipe{.width = 32,
                         .height = 16,
                         .channels = together(layer("", {"R", "G", "B"}), layer("left.", {"B", "G", "R"})),
                         .adjust = [](Imf::Header& header) {
                           Imf::addMultiView(header, {"right", "left"});
                         }};
  write_exr(path, recipe, pixels);
  CHECK(reads(path, pixels));
  CHECK(read_environment(path, with_layer("left")).pixels[2] == pixels[0]);
}

TEST_CASE("integers are the numbers that they state", "[codec]") {
  const TemporaryFile path("integers.exr");
  std::vector<float> pixels;
  for (int i = 0; i < 32 * 16 * 3; ++i) {
    pixels.push_back(i < 3 ? 4294967040.0F : static_cast<float>(i * 131));  // the first: the largest float below 2^32
  }
  for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(8, 8)}}) {
    write_exr(path, {.width = 32, .height = 16, .tiles = tiles, .channels = rgb_channels(Imf::UINT)}, pixels);
    CHECK(reads(path, pixels));
    CHECK(inspect_environment(path).channels[0].type == ChannelType::uint32);
  }
}

// Promises: the position of the data window, the order of lines and tiles, and the selection of rows change no
// pixel.

namespace {

ExrRecipe random_recipe(std::mt19937& random, int round) {
  const Imf::Compression compressions[] = {Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                                           Imf::PIZ_COMPRESSION};
  ExrRecipe recipe{.height = 1 + static_cast<int>(random() % 90)};
  recipe.width = 2 * recipe.height;
  recipe.first_column = static_cast<int>(random() % 4000) - 2000;
  recipe.first_row = static_cast<int>(random() % 4000) - 2000;
  if (round % 5 == 4) {  // nearly as far out as the format allows
    recipe.first_column = 1000000000;
    recipe.first_row = -1000000000;
  }
  recipe.compression = compressions[random() % 4];
  recipe.channels = rgb_channels(Imf::FLOAT);
  if (round % 2 == 0) {
    recipe.line_order = random() % 2 == 0 ? Imf::INCREASING_Y : Imf::DECREASING_Y;
  } else {
    recipe.tiles =
        Imf::TileDescription(1 + static_cast<unsigned>(random() % 60), 1 + static_cast<unsigned>(random() % 60));
    recipe.line_order = static_cast<Imf::LineOrder>(random() % 3);
  }
  return recipe;
}

void check_any_rows(const files::RowSource& source, const std::vector<float>& pixels, std::mt19937& random) {
  const auto reader = source.open_reader();
  const auto height = static_cast<unsigned>(source.info().height);
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(source.info().width);
  for (int attempt = 0; attempt < 8; ++attempt) {
    const auto first = random() % height;
    const auto count = 1 + random() % (height - first);
    std::vector<float> rows(count * row_floats + 1, -7.0F);
    reader->read(static_cast<int>(first), static_cast<int>(count), rows.data());
    REQUIRE(rows.back() == -7.0F);
    REQUIRE(std::equal(rows.begin(), rows.end() - 1, pixels.begin() + static_cast<std::ptrdiff_t>(first * row_floats)));
  }
}

}  // namespace

TEST_CASE("data windows, line orders and the rows that are asked for change no pixel", "[codec][slow]") {
  const TemporaryFile path("window.exr");
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    const ExrRecipe recipe = random_recipe(random, round);
    CAPTURE(round, recipe.width, recipe.first_column, recipe.first_row, recipe.line_order, recipe.compression);
    const std::vector<float> pixels = some_pixels(recipe.width, recipe.height, static_cast<unsigned>(round));
    write_exr(path, recipe, pixels);
    const Environment read = read_environment(path);
    REQUIRE(read.info.width == recipe.width);
    REQUIRE(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
    check_any_rows(*files::open_row_source(path, {}), pixels, random);
  }
}

// Promises: overscan is cut off and a crop is put back in its place where the display window has a layout's shape;
// otherwise the data window is the image.

namespace {

struct Window {
  int left, top, width, height;
};

ExrRecipe recipe_of(const Window& data, const Window& display) {
  ExrRecipe recipe{data.width, data.height, data.left, data.top};
  recipe.channels = rgb_channels(Imf::FLOAT);
  recipe.adjust = [display](Imf::Header& header) {
    header.displayWindow() = Imath::Box2i(
        {display.left, display.top},
        {static_cast<int>(std::int64_t{display.left} + display.width - 1), display.top + display.height - 1});
  };
  return recipe;
}

// Returns the pixels that lie inside both windows, on black.
std::vector<float> framed(const std::vector<float>& stored, const Window& data, const Window& display) {
  std::vector<float> image;
  for (int y = display.top; y < display.top + display.height; ++y) {
    for (int x = display.left; x < display.left + display.width; ++x) {
      const bool inside = x >= data.left && x < data.left + data.width && y >= data.top && y < data.top + data.height;
      for (int i = 0; i < 3; ++i) {
        image.push_back(inside ? stored[static_cast<std::size_t>(3 * ((y - data.top) * data.width + x - data.left) + i)]
                               : 0.0F);
      }
    }
  }
  return image;
}

bool says(const EnvironmentInfo& info, const std::string& words) {
  return std::ranges::any_of(info.notes, [&](const auto& note) { return note.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("overscan is cut off and crops are put back, in any rows", "[codec]") {
  const TemporaryFile path("window.exr");
  std::mt19937 random(5);
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low));
  };
  for (int round = 0; round < 60; ++round) {
    const Window display{between(-50, 50), between(-50, 50), 80, 40};
    const Window data{display.left + between(-30, 70), display.top + between(-25, 35), between(25, 120),
                      between(25, 70)};
    if ((data.width == 80 && data.height == 40) || data.left + data.width <= display.left ||
        data.top + data.height <= display.top || 3 * data.width == 4 * data.height ||
        4 * data.width == 3 * data.height) {
      continue;
    }
    CAPTURE(round, display.left, display.top, data.left, data.top, data.width, data.height);
    ExrRecipe recipe = recipe_of(data, display);
    if (round % 2 == 0) {
      recipe.tiles = Imf::TileDescription(16, 9);
    }
    const std::vector<float> stored = some_pixels(data.width, data.height);
    write_exr(path, recipe, stored);
    const std::vector<float> wanted = framed(stored, data, display);
    const Environment read = read_environment(path);
    REQUIRE(read.info.width == 80);
    REQUIRE(read.info.height == 40);
    REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
    const bool cut = data.left < display.left || data.top < display.top || data.left + data.width > display.left + 80 ||
                     data.top + data.height > display.top + 40;
    const bool lacking = data.left > display.left || data.top > display.top ||
                         data.left + data.width < display.left + 80 || data.top + data.height < display.top + 40;
    REQUIRE(says(read.info, "overscan cropped") == cut);
    REQUIRE(says(read.info, "padded with black") == lacking);
    const int first = between(0, 40);
    const int count = between(1, 41 - first);
    std::vector<float> rows(static_cast<std::size_t>(count) * 240);
    const auto source = files::open_row_source(path, {});
    source->open_reader()->read(first, count, rows.data());
    REQUIRE(std::equal(rows.begin(), rows.end(), wanted.begin() + first * 240));
  }
}

TEST_CASE("the data window is the image where the display window is no frame", "[codec]") {
  const TemporaryFile path("window.exr");
  const auto size_read = [&](const ExrRecipe& recipe, const ReadOptions& options = {}) {
    write_exr(path, recipe, some_pixels(recipe.width, recipe.height));
    const EnvironmentInfo info = inspect_environment(path, options);
    return std::pair{info.width, info.height};
  };
  using Size = std::pair<int, int>;
  const Window data{0, 0, 64, 32};
  CHECK(size_read(recipe_of(data, {0, 0, 100, 70})) == Size{64, 32});   // of no layout's shape
  CHECK(size_read(recipe_of(data, {100, 0, 80, 40})) == Size{64, 32});  // elsewhere
  CHECK(size_read(recipe_of(data, {20, 5, 64, 32})) == Size{64, 32});   // moved, but of the same size
  CHECK(size_read(recipe_of(data, {0, 0, 80, 60})) == Size{64, 32});    // of another layout than the data has
  CHECK(size_read(recipe_of({0, 0, 8, 48}, {0, 0, 80, 40})) == Size{8, 48});
  CHECK(size_read(recipe_of(data, {0, 0, 80, 40})) == Size{80, 40});
  ExrRecipe stated = recipe_of(data, {0, 0, 80, 40});
  stated.envmap = Imf::ENVMAP_LATLONG;
  CHECK(size_read(stated) == Size{64, 32});
  ExrRecipe mipped = recipe_of(data, {0, 0, 80, 40});
  mipped.tiles = Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS);
  CHECK(size_read(mipped) == Size{64, 32});
  CHECK(says(inspect_environment(path), "") == false);
  ReadOptions as_lat_long{.layout = Layout::lat_long};
  CHECK(size_read(recipe_of({-5, 0, 60, 45}, {0, 0, 80, 40}), as_lat_long) == Size{80, 40});
  CHECK(size_read(recipe_of({-5, 0, 61, 45}, {0, 0, 80, 60}), as_lat_long) == Size{61, 45});
  CHECK(says(inspect_environment(path, as_lat_long), "the data window of 61 x 45 is the image"));
}

// Promises: every OpenEXR compression is read, half and float, scanline and tiled, to the values that the OpenEXR
// library itself gives; lossless ones to the very values that were written.

namespace {

struct Compression {
  Imf::Compression id;
  const char* name;
  bool lossless_for_half;
  bool lossless_for_float;
};

const Compression kCompressions[] = {
    {Imf::NO_COMPRESSION, "none", true, true},     {Imf::RLE_COMPRESSION, "rle", true, true},
    {Imf::ZIPS_COMPRESSION, "zips", true, true},   {Imf::ZIP_COMPRESSION, "zip", true, true},
    {Imf::PIZ_COMPRESSION, "piz", true, true},     {Imf::PXR24_COMPRESSION, "pxr24", true, false},
    {Imf::B44_COMPRESSION, "b44", false, true},    {Imf::B44A_COMPRESSION, "b44a", false, true},
    {Imf::DWAA_COMPRESSION, "dwaa", false, false}, {Imf::DWAB_COMPRESSION, "dwab", false, false},
};

const std::optional<Imf::TileDescription> kTilings[] = {
    std::nullopt,
    Imf::TileDescription(16, 16, Imf::ONE_LEVEL),
    Imf::TileDescription(48, 40, Imf::ONE_LEVEL),
    Imf::TileDescription(300, 200, Imf::ONE_LEVEL),
    Imf::TileDescription(16, 32, Imf::MIPMAP_LEVELS, Imf::ROUND_UP),
    Imf::TileDescription(32, 16, Imf::RIPMAP_LEVELS),
};

std::string storage(const std::optional<Imf::TileDescription>& tiles) {
  if (!tiles) {
    return "scanline";
  }
  const std::string kind = tiles->mode == Imf::MIPMAP_LEVELS   ? "mip-mapped tiles "
                           : tiles->mode == Imf::RIPMAP_LEVELS ? "rip-mapped tiles "
                                                               : "tiled ";
  return kind + std::to_string(tiles->xSize) + " x " + std::to_string(tiles->ySize);
}

void check_values(const Environment& read, const std::filesystem::path& path, const ExrRecipe& recipe,
                  const std::vector<float>& written, bool lossless) {
  const std::vector<float> by_library = read_exr_with_library(path);
  REQUIRE(std::equal(by_library.begin(), by_library.end(), read.pixels.get()));
  double worst = 0.0;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const float wanted = recipe.channels[0].type == Imf::HALF ? as_half(written[i]) : written[i];
    if (lossless) {
      REQUIRE(read.pixels[i] == wanted);
    }
    worst = std::max(worst, static_cast<double>(std::abs(read.pixels[i] - wanted) / wanted));
  }
  CHECK(worst < 0.35);
}

}  // namespace

TEST_CASE("a few texels in a vast display window are refused", "[codec]") {
  const TemporaryFile path("window.exr");
  const auto message = [&](const Window& display) {
    write_exr(path, recipe_of({5, 5, 30, 20}, display), some_pixels(30, 20));
    const ThrownError error = thrown_by([&] { (void)inspect_environment(path); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  CHECK(message({0, 0, 65536, 32768}) == path.string() +
                                             ": stores 30 x 20 texels of a display window of 65536 x 32768, less than "
                                             "a 64th; save it with the intended display window");
  CHECK(message({0, 0, 200000, 100000}).find("its display window of 200000 x 100000 is larger than any layout holds") !=
        std::string::npos);
}

TEST_CASE("every OpenEXR compression is read, half and float, scanline and tiled", "[codec][slow]") {
  const TemporaryFile path("sky.exr");
  const int width = 130;
  const int height = 65;
  const std::vector<float> pixels = some_pixels(width, height);
  for (const Compression& compression : kCompressions) {
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
      for (const auto& tiles : kTilings) {
        CAPTURE(compression.name, type, tiles.has_value());
        const ExrRecipe recipe{.width = width,
                               .height = height,
                               .compression = compression.id,
                               .tiles = tiles,
                               .channels = rgb_channels(type)};
        write_exr(path, recipe, pixels);
        const Environment read = read_environment(path);
        CHECK(read.info.compression == compression.name);
        CHECK(read.info.storage == storage(tiles));
        REQUIRE(read.info.width == width);
        REQUIRE(read.info.height == height);
        check_values(read, path, recipe, pixels,
                     type == Imf::HALF ? compression.lossless_for_half : compression.lossless_for_float);
      }
    }
  }
}

}  // namespace welkin::test
