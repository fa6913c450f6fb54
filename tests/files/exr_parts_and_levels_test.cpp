// OpenEXR: parts, levels of mips, missing offset tables, and the images of OpenEXR's own tests.
#include <ImfFrameBuffer.h>
#include <ImfTiledInputFile.h>

#include "files/environment.h"
#include "files/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: of a multi-part OpenEXR file the requested part is read, by name or number; by default the first
// with colour, else with luminance; deep ones are skipped.

namespace {

ExrPartRecipe part(const std::string& name, const std::vector<ExrChannel>& channels, unsigned seed) {
  return {name, {.width = 32, .height = 16, .channels = channels}, some_pixels(32, 16, seed)};
}

std::string name_of_read_part(const std::filesystem::path& path, const std::vector<ExrPartRecipe>& parts,
                              const ReadOptions& options = {}) {
  const Environment read = read_environment(path, options);
  for (const ExrPartRecipe& candidate : parts) {
    if (std::equal(candidate.rgb.begin(), candidate.rgb.end(), read.pixels.get())) {
      return candidate.name;
    }
  }
  return "none";
}

ReadOptions with_part(const std::string& name) { return {.part = name}; }

}  // namespace

TEST_CASE("parts are chosen by name, by number and by what they hold", "[codec]") {
  const TemporaryFile path("parts.exr");
  const std::vector<ExrChannel> colour = rgb_channels(Imf::FLOAT);
  std::vector<ExrPartRecipe> parts{part("mask", {{"Y"}}, 1), part("depth", {{"Z", Imf::FLOAT}}, 2),
                                   part("sky", colour, 3), part("0", colour, 4), part("tiles", colour, 5)};
  parts[4].recipe.tiles = Imf::TileDescription(7, 5);
  write_exr_parts(path, parts);
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
  const TemporaryFile path("parts.exr");
  write_exr_parts(path, {part("depth", {{"Z", Imf::FLOAT}}, 1), part("mask", {{"Y", Imf::FLOAT, 1, 1}}, 2)});
  CHECK(read_environment(path).pixels[0] == some_pixels(32, 16, 2)[1]);
}

TEST_CASE("the part that has the layer is read", "[codec]") {
  const TemporaryFile path("parts.exr");
  const std::vector<ExrPartRecipe> parts{
      part("a", rgb_channels(Imf::FLOAT), 1),
      part("b", {{"sun.R", Imf::FLOAT, 1, 0}, {"sun.G", Imf::FLOAT, 1, 1}, {"sun.B", Imf::FLOAT, 1, 2}}, 2)};
  write_exr_parts(path, parts);
  CHECK(name_of_read_part(path, parts, {.layer = "sun"}) == "b");
}

TEST_CASE("deep parts are skipped, and refused if they are asked for", "[codec]") {
  const TemporaryFile path("parts.exr");
  std::vector<ExrPartRecipe> parts{part("smoke", rgb_channels(Imf::FLOAT), 1),
                                   part("sky", rgb_channels(Imf::FLOAT), 2)};
  parts[0].deep = true;
  parts[0].recipe.compression = Imf::ZIPS_COMPRESSION;
  write_exr_parts(path, parts);
  CHECK(name_of_read_part(path, parts) == "sky");
  check_thrown([&] { (void)inspect_environment(path, with_part("smoke")); }, ErrorCode::unsupported_file,
               {path.string() + ": its part \"smoke\" is a deep OpenEXR image; flatten it"});
  parts.pop_back();
  write_exr_parts(path, parts);
  CHECK(thrown_by([&] { (void)inspect_environment(path); }).says("deep OpenEXR image; flatten it"));
}

TEST_CASE("a part that is not there is an error that names those that are", "[codec]") {
  const TemporaryFile path("parts.exr");
  const auto message = [&](const ReadOptions& options) {
    const ThrownError error = thrown_by([&] { (void)inspect_environment(path, options); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  const std::vector<ExrPartRecipe> parts{part("depth", {{"Z"}}, 1), part("alpha", {{"A"}}, 2)};
  write_exr_parts(path, parts);
  CHECK(message(with_part("sky")) == path.string() + ": has no part \"sky\"; its parts are 0 \"depth\", 1 \"alpha\": " +
                                         "pass one's name or number with --part");
  CHECK(message(with_part("2")).find("has no part \"2\"") != std::string::npos);
  CHECK(message(with_part("-1")).find("has no part \"-1\"") != std::string::npos);
  CHECK(message({}).find("none of its parts (0 \"depth\", 1 \"alpha\") is a flat image with R, G and B or Y; "
                         "pass the part with --part") != std::string::npos);
  write_exr(path, parts[0].recipe, parts[0].rgb);
  CHECK(message(with_part("sky")).find("has a single part, and part \"sky\" was requested; leave --part out") !=
        std::string::npos);
}

// Promises: the levels of a mip or rip map are listed as in OpenEXR's library, and the requested level is read.

namespace {

ReadOptions at_level(int level) { return {.layout = Layout::lat_long, .level = level}; }

ExrRecipe recipe_of(int width, int height, const Imf::TileDescription& tiles) {
  return {.width = width,
          .height = height,
          .first_column = -3,
          .first_row = 11,
          .tiles = tiles,
          .channels = rgb_channels(Imf::FLOAT)};
}

std::vector<float> level_by_library(Imf::TiledInputFile& file, int level) {
  const Imath::Box2i window = file.dataWindowForLevel(level, level);
  const std::int64_t columns = file.levelWidth(level);
  const std::int64_t rows = file.levelHeight(level);
  std::vector<float> rgb(static_cast<std::size_t>(3 * columns * rows));
  Imf::FrameBuffer buffer;
  std::size_t component = 0;
  for (const char* name : {"R", "G", "B"}) {
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, static_cast<const void*>(rgb.data() + component++), window.min,
                                         columns, rows, 3 * sizeof(float)));
  }
  file.setFrameBuffer(buffer);
  file.readTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  return rgb;
}

}  // namespace

TEST_CASE("every level is read as the library reads it", "[codec]") {
  const TemporaryFile path("levels.exr");
  for (const auto& [width, height] : {std::pair{64, 32}, {77, 35}, {3, 50}, {1, 1}}) {
    for (const Imf::LevelMode mode : {Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
      for (const Imf::LevelRoundingMode rounding : {Imf::ROUND_DOWN, Imf::ROUND_UP}) {
        CAPTURE(width, height, mode, rounding);
        const Imf::TileDescription tiles(13, 8, mode, rounding);
        write_exr(path, recipe_of(width, height, tiles), some_pixels(width, height));
        Imf::TiledInputFile file(path.string().c_str(), 0);
        const int count = std::min(file.numXLevels(), file.numYLevels());
        const EnvironmentInfo info = inspect_environment(path, at_level(0));
        REQUIRE(info.levels.size() == static_cast<std::size_t>(count));
        CHECK(info.storage == (mode == Imf::MIPMAP_LEVELS ? "mip-mapped tiles 13 x 8" : "rip-mapped tiles 13 x 8"));
        for (int level = 0; level < count; ++level) {
          const Environment read = read_environment(path, at_level(level));
          REQUIRE(info.levels[static_cast<std::size_t>(level)].width == file.levelWidth(level));
          REQUIRE(info.levels[static_cast<std::size_t>(level)].height == file.levelHeight(level));
          REQUIRE(read.info.width == file.levelWidth(level));
          REQUIRE(read.info.height == file.levelHeight(level));
          const std::vector<float> wanted = level_by_library(file, level);
          REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
          REQUIRE((wanted[0] == -99.0F) == (level > 0));
        }
      }
    }
  }
}

TEST_CASE("a level that is not there is an error that says how many there are", "[codec]") {
  const TemporaryFile path("levels.exr");
  const auto message = [&](int level) {
    const ThrownError error = thrown_by([&] { (void)inspect_environment(path, at_level(level)); });
    CHECK(error.code == ErrorCode::unsupported_file);
    return error.message;
  };
  write_exr(path, recipe_of(64, 32, Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS)), some_pixels(64, 32));
  CHECK(message(7) == path.string() + ": has no level 7; it has 7: pass --level 0 to 6");
  CHECK(message(-1) == path.string() + ": has no level -1; it has 7: pass --level 0 to 6");
  write_exr(path, recipe_of(64, 32, Imf::TileDescription(8, 8)), some_pixels(64, 32));
  CHECK(message(1) == path.string() + ": has no level 1; it has one, level 0: leave --level out");
}

TEST_CASE("the levels of a cube are cubes, down to faces of one texel", "[codec]") {
  const TemporaryFile path("levels.exr");
  ExrRecipe recipe = recipe_of(8, 48, Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
  recipe.envmap = Imf::ENVMAP_CUBE;
  write_exr(path, recipe, some_pixels(8, 48));
  ReadOptions options;
  for (options.level = 0; options.level < 4; ++options.level) {
    const Environment cube = read_environment(path, options);
    CHECK(cube.info.width == 8 >> options.level);
    CHECK(cube.info.layout_reason == "the header's envmap attribute says cube");
    CHECK(files::open_row_source(path, options)->traits().openexr_cube_frames);
  }
  CHECK(thrown_by([&] { (void)inspect_environment(path, options); }).says("1 x 3 is not a 1:6 vertical strip"));
}

// Promises: with a target size, the level of a file's mip chain that is nearest to it in log2 is chosen, by the rule
// that holds for chains in memory; a level that has lost its layout's shape is not among them.

namespace {

EnvironmentInfo chain(Layout layout, int width, int height, int count) {
  EnvironmentInfo info;
  info.layout = layout;
  info.width = width;
  info.height = height;
  for (int level = 0; level < count; ++level) {
    info.levels.push_back({std::max(1, width >> level), std::max(1, height >> level)});
  }
  return info;
}

ProjectionOptions target(std::optional<int> size, Quadrature quadrature = Quadrature::exact) {
  return {.quadrature = quadrature, .target_size = size};
}

}  // namespace

TEST_CASE("the level nearest to the target is chosen for cubes", "[codec][levels]") {
  const EnvironmentInfo strip = chain(Layout::vertical_strip, 256, 6 * 256, 9);
  CHECK(files::level_for_target(strip, target(64)) == 2);
  CHECK(files::level_for_target(strip, target(1)) == 8);
  CHECK(files::level_for_target(strip, target(90)) == 2);  // 64 sqrt 2 = 90.5
  CHECK(files::level_for_target(strip, target(91)) == 1);
  CHECK(files::level_for_target(strip, target(255)) == 0);
  CHECK(files::level_for_target(strip, target(91, Quadrature::midpoint)) == 2);  // rounded down to a power of two
  CHECK(!files::level_for_target(strip, target(std::nullopt)));
  CHECK(!files::level_for_target(strip, target(256)));
  CHECK(!files::level_for_target(strip, target(1000)));
  CHECK(!files::level_for_target(chain(Layout::vertical_strip, 256, 6 * 256, 1), target(64)));
  CHECK(!files::level_for_target(chain(Layout::vertical_strip, 256, 6 * 256, 0), target(64)));
  const EnvironmentInfo cross = chain(Layout::horizontal_cross, 256, 192, 7);
  CHECK(files::level_for_target(cross, target(16)) == 2);
}

TEST_CASE("the level nearest to four times the target is chosen for lat-longs", "[codec][levels]") {
  const EnvironmentInfo sky = chain(Layout::lat_long, 1024, 512, 11);
  CHECK(files::level_for_target(sky, target(64)) == 2);
  CHECK(files::level_for_target(sky, target(91)) == 1);
  CHECK(files::level_for_target(sky, target(91, Quadrature::midpoint)) == 1);
  CHECK(files::level_for_target(sky, target(1)) == 8);
  CHECK(files::level_for_target(sky, target(255)) == 0);
  CHECK(!files::level_for_target(sky, target(256)));
  CHECK(!files::level_for_target(sky, target(std::nullopt)));
}

TEST_CASE("levels that are no longer six squares are not chosen", "[codec][levels]") {
  const EnvironmentInfo odd = chain(Layout::vertical_strip, 12, 72, 7);  // 12 x 72, 6 x 36, 3 x 18, 1 x 9
  CHECK(files::level_for_target(odd, target(3)) == 2);
  CHECK(files::level_for_target(odd, target(1)) == 2);
  CHECK(!files::level_for_target(chain(Layout::vertical_strip, 3, 18, 5), target(1)));
}

TEST_CASE("files choose as chains in memory do", "[codec][levels]") {
  std::vector<TestCubemap> levels;
  std::vector<CubemapView> views;
  EnvironmentInfo info;
  info.layout = Layout::vertical_strip;
  for (int size = 32; size >= 1; size /= 2) {
    levels.push_back(make_cubemap(Content::random, size, 3, static_cast<std::uint32_t>(size)));
    info.levels.push_back({size, 6 * size});
  }
  for (const TestCubemap& level : levels) views.push_back(level.view());
  for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
    for (int size = 1; size < 32; ++size) {
      const Projection projection = project(views, target(size, quadrature));
      const std::optional<int> level = files::level_for_target(info, target(size, quadrature));
      REQUIRE(level);
      const int chosen = info.levels[static_cast<std::size_t>(*level)].width;
      CHECK(projection.diagnostics.texels == std::uint64_t{6} * static_cast<std::uint64_t>(chosen * chosen));
    }
  }
}

// Promise: an OpenEXR file whose tables of offsets are all zero is read: some programs write such files
// (OpenImageIO 2.4 does with "textureformat"), and where the blocks are can be found without them.

TEST_CASE("an OpenEXR file without its tables of offsets is read", "[codec]") {
  const TemporaryFile path("no-table.exr");
  const std::vector<float> pixels = some_pixels(64, 32);
  const ExrRecipe sky{
      .width = 64, .height = 32, .compression = Imf::ZIPS_COMPRESSION, .channels = rgb_channels(Imf::FLOAT)};
  ExrRecipe tiles = sky;
  const auto check = [&](std::size_t entries, const ReadOptions& options) {
    std::vector<char> bytes = read_bytes(path);
    // Tables lie before the first block, of which the lowest offset tells.
    std::size_t table = 0;
    for (std::size_t index = 8; index + 8 * entries <= bytes.size() && table == 0; ++index) {
      table = number_at<std::uint64_t>(bytes, index) == index + 8 * entries ? index : 0;
    }
    REQUIRE(table != 0);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table), 8 * entries, '\0');
    write_bytes(path, bytes);
    const Environment read = read_environment(path, options);
    CHECK(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
  };
  write_exr(path, sky, pixels);
  check(32, {});
  tiles.tiles = Imf::TileDescription(16, 16);
  write_exr(path, tiles, pixels);
  check(8, {});
  tiles.tiles = Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS);
  write_exr(path, tiles, pixels);
  check(8 + 2 + 1 + 1 + 1 + 1 + 1, {});
  write_exr_parts(path, {{"sky", sky, pixels}, {"tiles", tiles, pixels}});
  const std::vector<char> sound = read_bytes(path);
  for (const char* part : {"sky", "tiles"}) {
    write_bytes(path, sound);
    check(32 + 15, {.part = part});
  }
}

// Promises: every image of OpenEXR's own reader tests that is at hand is read as OpenEXR reads it, or refused with a
// clear word.

namespace {

const std::filesystem::path kConformance = kImages / "exr_conformance";

std::filesystem::path image(const std::string& name) { return kConformance / ("openexr_" + name + ".exr"); }

// None of them is an environment; any ratio can be taken for a lat-long.
Environment read(const std::string& name, Primaries primaries = Primaries::rec709) {
  return read_environment(image(name), {.layout = Layout::lat_long, .primaries = primaries});
}

bool equal(const Environment& found, const std::vector<float>& wanted) {
  return static_cast<std::size_t>(3 * found.info.width * found.info.height) == wanted.size() &&
         std::equal(wanted.begin(), wanted.end(), found.pixels.get(),
                    [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); });
}

// By how many halves' roundings (2^-11 of the texel's brightest channel) two images differ at the worst texel.
double worst_in_halves(const Environment& found, const Environment& wanted) {
  REQUIRE(found.info.width == wanted.info.width);
  REQUIRE(found.info.height == wanted.info.height);
  double worst = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(3 * found.info.width * found.info.height); i += 3) {
    const float* a = found.pixels.get() + i;
    const float* b = wanted.pixels.get() + i;
    const double scale = std::max({std::abs(b[0]), std::abs(b[1]), std::abs(b[2]), 1e-3F}) / 2048.0;
    for (int channel = 0; channel < 3; ++channel) {
      worst = std::max(worst, std::abs(a[channel] - b[channel]) / scale);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("plain images are what the library reads", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  for (const char* name : {"BrightRings", "BrightRingsNanInf", "Rec709", "ColorCodedLevels"}) {
    CAPTURE(name);
    CHECK(equal(read(name), read_exr_with_library(image(name))));
  }
  for (const char* name : {"Rec709_YC", "XYZ_YC", "Garden", "XYZ"}) {
    CAPTURE(name);
    CHECK(equal(read(name, Primaries::as_stored), read_rgba_with_library(image(name))));
  }
}

TEST_CASE("X, Y, Z become the Rec. 709 that they were made from", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  CHECK(worst_in_halves(read("XYZ"), read("Rec709")) < 6.0);
  CHECK(read("XYZ").info.notes == std::vector<std::string>{"primaries converted from CIE XYZ to Rec. 709"});
}

TEST_CASE("all levels of the colour-coded mip map have its colours", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  ReadOptions options{.layout = Layout::lat_long};
  REQUIRE(inspect_environment(image("ColorCodedLevels"), options).levels.size() == 10);
  std::vector<float> firsts;
  for (; options.level < 10; ++options.level) {
    const Environment level = read_environment(image("ColorCodedLevels"), options);
    CHECK(level.info.width == 512 >> options.level);
    firsts.push_back(level.pixels[0] + 10.0F * level.pixels[1] + 100.0F * level.pixels[2]);
  }
  std::sort(firsts.begin(), firsts.end());
  CHECK(std::unique(firsts.begin(), firsts.end()) - firsts.begin() >= 5);
}

TEST_CASE("each view of the stereo image in parts is read", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  ReadOptions options{.layout = Layout::lat_long};
  const EnvironmentInfo info = inspect_environment(image("multipart.0001"), options);
  CHECK(info.parts.size() == 10);
  CHECK(info.width == 877);
  const Environment right = read_environment(image("multipart.0001"), options);
  options.part = "rgba_left";
  const Environment left = read_environment(image("multipart.0001"), options);
  CHECK_FALSE(std::equal(right.pixels.get(), right.pixels.get() + 877 * 876 * 3, left.pixels.get()));
  CHECK(measure_environment(image("multipart.0001"), options).maximum.x > 0.0);
  options.part = "depth_left";
  CHECK(thrown_by([&] {
          (void)inspect_environment(image("multipart.0001"), options);
        }).says("has channels Z; R, G and B, or Y alone or with RY and BY, are read"));
}

TEST_CASE("what is no environment says why", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  CHECK(thrown_by([] {
          (void)inspect_environment(image("WideFloatRange"));
        }).says("has channels G; R, G and B, or Y alone or with RY and BY, are read: rename or convert"));
  for (const char* name : {"Rec709", "Garden", "XYZ_YC", "multipart.0001"}) {
    CHECK(thrown_by([&] { (void)inspect_environment(image(name)); }).says("neither a 2:1 lat-long"));
  }
  CHECK(thrown_by([] { (void)inspect_environment(image("BrightRings")); }).says("is square"));
}

}  // namespace welkin::test
