// Promises: PNG is read in every colour type and depth, interlaced or not, in any pieces; samples become light as the
// file or the caller says; what was done is told.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

struct Kind {
  int colour_type;
  int bits;
};

constexpr Kind kKinds[] = {
    {SPNG_COLOR_TYPE_GRAYSCALE, 1},        {SPNG_COLOR_TYPE_GRAYSCALE, 2},        {SPNG_COLOR_TYPE_GRAYSCALE, 4},
    {SPNG_COLOR_TYPE_GRAYSCALE, 8},        {SPNG_COLOR_TYPE_GRAYSCALE, 16},       {SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, 8},
    {SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, 16}, {SPNG_COLOR_TYPE_TRUECOLOR, 8},        {SPNG_COLOR_TYPE_TRUECOLOR, 16},
    {SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 8},  {SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 16}, {SPNG_COLOR_TYPE_INDEXED, 1},
    {SPNG_COLOR_TYPE_INDEXED, 2},          {SPNG_COLOR_TYPE_INDEXED, 4},          {SPNG_COLOR_TYPE_INDEXED, 8}};

test::PngRecipe recipe_of(const Kind& kind, int width, int height, bool interlaced) {
  test::PngRecipe recipe{width, height, kind.bits, kind.colour_type, interlaced};
  if (kind.colour_type == SPNG_COLOR_TYPE_INDEXED) {
    for (int i = 0; i < 1 << kind.bits; ++i) {
      recipe.palette.push_back(
          {static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i * i), 0});
    }
  }
  return recipe;
}

// The samples of a texel's channel over their largest value: light, if they are linear.
double encoded_value(const test::PngRecipe& recipe, const std::vector<std::uint16_t>& samples, std::size_t texel,
                     std::size_t channel) {
  const auto channels = static_cast<std::size_t>(test::png_channels(recipe));
  if (!recipe.palette.empty()) {
    const spng_plte_entry& entry = recipe.palette[samples[texel]];
    return (channel == 0 ? entry.red : channel == 1 ? entry.green : entry.blue) / 255.0;
  }
  return samples[texel * channels + (channels < 3 ? 0 : channel)] / static_cast<double>((1 << recipe.bits) - 1);
}

double srgb_curve(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

bool notes_say(const EnvironmentInfo& info, const std::string& words) {
  return std::any_of(info.notes.begin(), info.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

ReadOptions as_lat_long(Transfer transfer = Transfer::automatic) {
  ReadOptions options;
  options.layout = Layout::lat_long;
  options.transfer = transfer;
  return options;
}

// One texel of mid-grey, read.
Environment read_grey(const test::TemporaryDirectory& directory, const test::PngRecipe& recipe,
                      Transfer transfer = Transfer::automatic) {
  const std::filesystem::path path = directory.file("grey.png");
  test::write_bytes(path, test::png_bytes(recipe, {188, 188, 188}));
  return read_environment(path, as_lat_long(transfer));
}

}  // namespace

TEST_CASE("every colour type and depth of PNG is read", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  for (const Kind& kind : kKinds) {
    for (const bool interlaced : {false, true}) {
      for (const auto& [width, height] : {std::tuple{1, 1}, {2, 1}, {3, 5}, {7, 2}, {64, 32}, {257, 3}}) {
        CAPTURE(kind.colour_type, kind.bits, interlaced, width, height);
        const test::PngRecipe recipe = recipe_of(kind, width, height, interlaced);
        const std::vector<std::uint16_t> samples = test::some_samples(recipe);
        test::write_bytes(path, test::png_bytes(recipe, samples));
        const Environment linear = read_environment(path, as_lat_long(Transfer::linear));
        const Environment curved = read_environment(path, as_lat_long(Transfer::srgb));
        for (std::size_t i = 0; i < static_cast<std::size_t>(3 * width * height); ++i) {
          const double encoded = encoded_value(recipe, samples, i / 3, i % 3);
          REQUIRE(linear.pixels[i] == static_cast<float>(encoded));
          REQUIRE(std::abs(static_cast<double>(curved.pixels[i]) - srgb_curve(encoded)) <=
                  6.1e-8 * srgb_curve(encoded));
        }
      }
    }
  }
}

TEST_CASE("colours that a PNG's palette does not have are black", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  test::PngRecipe recipe{4, 2, 2, SPNG_COLOR_TYPE_INDEXED};
  recipe.palette = {{255, 255, 255, 0}, {255, 255, 255, 0}};
  test::write_bytes(path, test::png_bytes(recipe, {0, 1, 2, 3, 3, 2, 1, 0}));
  const Environment read = read_environment(path);
  const float wanted[] = {1, 1, 0, 0, 0, 0, 1, 1};
  for (std::size_t i = 0; i < 24; ++i) {
    CHECK(read.pixels[i] == wanted[i / 3]);
  }
}

TEST_CASE("what is in a PNG is told", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  const auto info_of = [&](const Kind& kind, bool interlaced) {
    const test::PngRecipe recipe = recipe_of(kind, 4, 2, interlaced);
    test::write_bytes(path, test::png_bytes(recipe, test::some_samples(recipe)));
    return inspect_environment(path);
  };
  const EnvironmentInfo colour = info_of({SPNG_COLOR_TYPE_TRUECOLOR, 16}, false);
  CHECK(colour.format == "PNG");
  CHECK(colour.compression == "deflate");
  CHECK(colour.storage == "scanline");
  CHECK(colour.layout == Layout::lat_long);
  REQUIRE(colour.channels.size() == 3);
  CHECK(colour.channels[0].name == "R");
  CHECK(colour.channels[0].type == "uint16");
  const EnvironmentInfo grey = info_of({SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, 8}, true);
  CHECK(grey.storage == "interlaced");
  REQUIRE(grey.channels.size() == 2);
  CHECK(grey.channels[0].name == "Y");
  CHECK(grey.channels[1].name == "A");
  CHECK(grey.channels[1].type == "uint8");
  CHECK(notes_say(grey, "alpha is ignored: colours are taken as they are"));
  CHECK(info_of({SPNG_COLOR_TYPE_GRAYSCALE, 4}, false).channels[0].type == "uint4");
  CHECK(info_of({SPNG_COLOR_TYPE_INDEXED, 2}, false).channels.size() == 3);
  CHECK(info_of({SPNG_COLOR_TYPE_INDEXED, 2}, false).channels[0].type == "uint8");
}

TEST_CASE("a PNG's rows come in any pieces, and again from the top", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  for (const bool interlaced : {false, true}) {
    const test::PngRecipe recipe = recipe_of({SPNG_COLOR_TYPE_TRUECOLOR, 16}, 46, 23, interlaced);
    test::write_bytes(path, test::png_bytes(recipe, test::some_samples(recipe)));
    const Environment whole = read_environment(path);
    const auto source = codec::open_row_source(path, {});
    CHECK(source->sequential());
    for (const int rows : {1, 2, 3, 7, 22, 23}) {
      const auto reader = source->open_reader();
      const auto check_piece = [&](int first, int count) {
        std::vector<float> piece(static_cast<std::size_t>(count) * 3 * 46);
        reader->read(first, count, piece.data());
        REQUIRE(std::equal(piece.begin(), piece.end(), whole.pixels.get() + first * 3 * 46));
      };
      for (int first = 0; first < 23; first += rows) {
        check_piece(first, std::min(rows, 23 - first));
      }
      check_piece(11, 2);
      check_piece(20, 3);
      check_piece(0, 5);
    }
  }
}

TEST_CASE("a PNG has the same bits on any number of threads", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  const test::PngRecipe recipe = recipe_of({SPNG_COLOR_TYPE_TRUECOLOR, 8}, 128, 64, false);
  test::write_bytes(path, test::png_bytes(recipe, test::some_samples(recipe)));
  const Environment whole = read_environment(path);
  for (const int threads : {1, 4}) {
    run_with_threads(threads, [&] {
      const Environment again = read_environment(path);
      CHECK(std::equal(whole.pixels.get(), whole.pixels.get() + 128 * 64 * 3, again.pixels.get()));
    });
  }
}

TEST_CASE("samples are sRGB unless the file's gamma is 1 or the caller knows better", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const test::PngRecipe plain{1, 1};
  const auto is_srgb = [](const Environment& read) { return std::abs(read.pixels[0] - 0.502886F) < 1e-5F; };
  const auto is_linear = [](const Environment& read) { return read.pixels[0] == static_cast<float>(188 / 255.0); };

  const Environment silent = read_grey(directory, plain);
  CHECK(is_srgb(silent));
  CHECK(notes_say(silent.info, "taken as sRGB: nothing in the file says otherwise"));
  const Environment told = read_grey(directory, plain, Transfer::linear);
  CHECK(is_linear(told));
  CHECK(notes_say(told.info, "taken as linear, as was asked for"));

  test::PngRecipe recipe = plain;
  recipe.gamma = 100000;
  const Environment linear = read_grey(directory, recipe);
  CHECK(is_linear(linear));
  CHECK(notes_say(linear.info, "taken as linear: the gAMA chunk says 1"));
  CHECK(is_srgb(read_grey(directory, recipe, Transfer::srgb)));
  recipe.srgb = true;
  const Environment both = read_grey(directory, recipe);
  CHECK(is_srgb(both));
  CHECK(notes_say(both.info, "taken as sRGB: the sRGB chunk says so"));

  recipe.srgb = false;
  recipe.gamma = 45455;
  CHECK(notes_say(read_grey(directory, recipe).info, "taken as sRGB: the gAMA chunk says nearly so"));
  recipe.gamma = 55556;
  const Environment odd = read_grey(directory, recipe);
  CHECK(is_srgb(odd));
  CHECK(notes_say(odd.info, "its gAMA of 0.55556 is not applied"));
}

TEST_CASE("a PNG's primaries become Rec. 709, or stay as stored", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  const spng_chrm_int rec2020{31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600};
  const spng_chrm_int rec709{31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
  test::PngRecipe recipe{2, 1};
  const auto read = [&](Primaries wanted) {
    test::write_bytes(path, test::png_bytes(recipe, {255, 0, 0, 255, 255, 255}));
    ReadOptions options;
    options.primaries = wanted;
    return read_environment(path, options);
  };
  recipe.primaries = rec2020;
  const Environment converted = read(Primaries::rec709);
  const double wanted[] = {1.6605, -0.1246, -0.0182, 1.0, 1.0, 1.0};
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(static_cast<double>(converted.pixels[i]) - wanted[i]) < 1e-4);
  }
  CHECK(notes_say(converted.info, "cHRM"));
  CHECK(read(Primaries::as_stored).pixels[1] == 0.0F);
  recipe.srgb = true;  // says the primaries too, and is the one to believe
  CHECK(read(Primaries::rec709).pixels[1] == 0.0F);
  recipe.srgb = false;
  recipe.primaries = rec709;
  const Environment plain = read(Primaries::rec709);
  CHECK(plain.pixels[0] == 1.0F);
  CHECK(plain.pixels[1] == 0.0F);
  CHECK(!notes_say(plain.info, "cHRM"));
}

TEST_CASE("chunks that are not wanted cost nothing and spoil nothing", "[codec][png]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.png");
  const test::PngRecipe recipe{4, 2};
  const std::vector<std::uint16_t> samples = test::some_samples(recipe);
  const std::vector<char> sound = test::png_bytes(recipe, samples);
  test::write_bytes(path, sound);
  const Environment wanted = read_environment(path);
  const auto check = [&](const std::vector<char>& file, const std::string& note) {
    test::write_bytes(path, file);
    const Environment read = read_environment(path);
    CHECK(std::equal(wanted.pixels.get(), wanted.pixels.get() + 24, read.pixels.get()));
    CHECK(notes_say(read.info, note));
  };
  check(test::with_png_chunk(sound, "tEXt", "no keyword ends here"), "");
  check(test::with_png_chunk(sound, "iTXt", std::string(3000000, 'x')), "");
  check(test::with_png_chunk(sound, "iCCP", "not a profile"), "its ICC profile is not applied");
  check(test::with_png_chunk(sound, "cICP", "\x09\x10\x01\x01"), "its cICP chunk (video colour) is not applied");
  check(test::with_png_chunk(sound, "tRNS", "nonsense"), "alpha is ignored");
  std::vector<char> many = sound;
  for (int i = 0; i < 2000; ++i) {
    many = test::with_png_chunk(many, "tEXt", "");
  }
  check(many, "");
}

}  // namespace welkin
