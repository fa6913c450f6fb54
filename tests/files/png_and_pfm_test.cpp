// PNG and PFM: what is read of them, and what is refused.
#include "files/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: PNG is read in every colour type and depth, interlaced or not, in any pieces; samples become light as the
// file or the caller states; the conversion is reported.

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

PngRecipe recipe_of(const Kind& kind, int width, int height, bool interlaced) {
  PngRecipe recipe{width, height, kind.bits, kind.colour_type, interlaced};
  if (kind.colour_type == SPNG_COLOR_TYPE_INDEXED) {
    for (int i = 0; i < 1 << kind.bits; ++i) {
      recipe.palette.push_back(
          {static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i * i), 0});
    }
  }
  return recipe;
}

// The samples of a texel's channel over their largest value: light, if they are linear.
double encoded_value(const PngRecipe& recipe, const std::vector<std::uint16_t>& samples, std::size_t texel,
                     std::size_t channel) {
  const auto channels = static_cast<std::size_t>(png_channels(recipe));
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
  return std::ranges::any_of(info.notes, [&](const auto& note) { return note.find(words) != std::string::npos; });
}

ReadOptions as_lat_long(Transfer transfer = Transfer::automatic) {
  return {.layout = Layout::lat_long, .transfer = transfer};
}

// One texel of mid-grey, read.
Environment read_grey(const TemporaryDirectory& directory, const PngRecipe& recipe,
                      Transfer transfer = Transfer::automatic) {
  const std::filesystem::path path = directory.file("grey.png");
  write_bytes(path, png_bytes(recipe, {188, 188, 188}));
  return read_environment(path, as_lat_long(transfer));
}

}  // namespace

TEST_CASE("every colour type and depth of PNG is read", "[codec][png]") {
  const TemporaryFile path("sky.png");
  for (const Kind& kind : kKinds) {
    for (const bool interlaced : {false, true}) {
      for (const auto& [width, height] : {std::tuple{1, 1}, {2, 1}, {3, 5}, {7, 2}, {64, 32}, {257, 3}}) {
        CAPTURE(kind.colour_type, kind.bits, interlaced, width, height);
        const PngRecipe recipe = recipe_of(kind, width, height, interlaced);
        const std::vector<std::uint16_t> samples = some_samples(recipe);
        write_bytes(path, png_bytes(recipe, samples));
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
  const TemporaryFile path("sky.png");
  PngRecipe recipe{4, 2, 2, SPNG_COLOR_TYPE_INDEXED};
  recipe.palette = {{255, 255, 255, 0}, {255, 255, 255, 0}};
  write_bytes(path, png_bytes(recipe, {0, 1, 2, 3, 3, 2, 1, 0}));
  const Environment read = read_environment(path);
  const float wanted[] = {1, 1, 0, 0, 0, 0, 1, 1};
  for (std::size_t i = 0; i < 24; ++i) {
    CHECK(read.pixels[i] == wanted[i / 3]);
  }
}

TEST_CASE("a PNG's rows come in any pieces, and again from the top", "[codec][png]") {
  const TemporaryFile path("sky.png");
  for (const bool interlaced : {false, true}) {
    const PngRecipe recipe = recipe_of({SPNG_COLOR_TYPE_TRUECOLOR, 16}, 46, 23, interlaced);
    write_bytes(path, png_bytes(recipe, some_samples(recipe)));
    const Environment whole = read_environment(path);
    const auto source = files::open_row_source(path, {});
    CHECK(source->traits().sequential);
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

TEST_CASE("samples are sRGB unless the file's gamma is 1 or the caller knows better", "[codec][png]") {
  const TemporaryDirectory directory;
  const PngRecipe plain{1, 1};
  const auto is_srgb = [](const Environment& read) { return std::abs(read.pixels[0] - 0.502886F) < 1e-5F; };
  const auto is_linear = [](const Environment& read) { return read.pixels[0] == static_cast<float>(188 / 255.0); };

  const Environment silent = read_grey(directory, plain);
  CHECK(is_srgb(silent));
  CHECK(notes_say(silent.info, "read as sRGB, the default"));
  const Environment told = read_grey(directory, plain, Transfer::linear);
  CHECK(is_linear(told));
  CHECK(notes_say(told.info, "read as linear, as requested"));

  PngRecipe recipe = plain;
  recipe.gamma = 100000;
  const Environment linear = read_grey(directory, recipe);
  CHECK(is_linear(linear));
  CHECK(notes_say(linear.info, "read as linear, because the gAMA chunk is 1"));
  CHECK(is_srgb(read_grey(directory, recipe, Transfer::srgb)));
  recipe.srgb = true;
  const Environment both = read_grey(directory, recipe);
  CHECK(is_srgb(both));
  CHECK(notes_say(both.info, "read as sRGB, as the sRGB chunk states"));

  recipe.srgb = false;
  recipe.gamma = 45455;
  CHECK(notes_say(read_grey(directory, recipe).info, "read as sRGB, as the gAMA chunk nearly states"));
  recipe.gamma = 55556;
  const Environment odd = read_grey(directory, recipe);
  CHECK(is_srgb(odd));
  CHECK(notes_say(odd.info, "its gAMA of 0.55556 is not applied"));
}

TEST_CASE("a PNG's primaries become Rec. 709, or stay as stored", "[codec][png]") {
  const TemporaryFile path("sky.png");
  const spng_chrm_int rec2020{31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600};
  const spng_chrm_int rec709{31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
  PngRecipe recipe{2, 1};
  const auto read = [&](Primaries wanted) {
    write_bytes(path, png_bytes(recipe, {255, 0, 0, 255, 255, 255}));
    return read_environment(path, {.primaries = wanted});
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
  const TemporaryFile path("sky.png");
  const PngRecipe recipe{4, 2};
  const std::vector<std::uint16_t> samples = some_samples(recipe);
  const std::vector<char> sound = png_bytes(recipe, samples);
  write_bytes(path, sound);
  const Environment wanted = read_environment(path);
  const auto check = [&](const std::vector<char>& file, const std::string& note) {
    write_bytes(path, file);
    const Environment read = read_environment(path);
    CHECK(std::equal(wanted.pixels.get(), wanted.pixels.get() + 24, read.pixels.get()));
    CHECK(notes_say(read.info, note));
  };
  check(with_png_chunk(sound, "tEXt", "no keyword ends here"), "");
  check(with_png_chunk(sound, "iTXt", std::string(3000000, 'x')), "");
  check(with_png_chunk(sound, "iCCP", "not a profile"), "its ICC profile is not applied");
  check(with_png_chunk(sound, "cICP", "\x09\x10\x01\x01"), "its cICP chunk (video colour) is not applied");
  check(with_png_chunk(sound, "tRNS", "nonsense"), "alpha is ignored");
  std::vector<char> many = sound;
  for (int i = 0; i < 2000; ++i) {
    many = with_png_chunk(many, "tEXt", "");
  }
  check(many, "");
}

// Promises: a PNG that is not read is refused by a code and a message with the file's name, what was found, and what
// would do.

namespace {

constexpr std::size_t kBitsOffset = 24;  // in the file

std::vector<char> sound_png(int width = 8, int height = 4, bool interlaced = false) {
  const PngRecipe recipe{width, height, 8, SPNG_COLOR_TYPE_TRUECOLOR, interlaced};
  return png_bytes(recipe, some_samples(recipe));
}

void check_refusal(const std::vector<char>& file, ErrorCode code, const std::string& found, const std::string& remedy) {
  const TemporaryFile path("sky.png");
  write_bytes(path, file);
  check_thrown([&] { (void)read_environment(path, as_lat_long()); }, code, {path.string() + ": ", found, remedy});
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
  damaged[kBitsOffset] = 7;
  check_refusal(damaged, corrupt, "bit depth", "fetch or export it again");
  check_refusal(with_png_size(sound, 0, 4), corrupt, "libspng says \"", "");
  check_refusal(with_png_size(sound, 8, 0xffffffff), corrupt, "libspng says \"", "");
  check_refusal(with_png_size(sound, 8, 5), corrupt, "near row 3 of 5", "fetch or export it again");
  check_refusal(with_png_chunk(sound, "WHAT", "is this"), corrupt, "libspng says \"", "");
}

TEST_CASE("what a PNG's header claims costs no memory", "[codec][png]") {
  for (const bool interlaced : {false, true}) {
    check_refusal(with_png_size(sound_png(8, 4, interlaced), 65536, 32768), ErrorCode::corrupt_file,
                  "ends too early: 65536 x 32768 texels of a PNG take at least 6242685 bytes",
                  "fetch or export it again");
  }
}

TEST_CASE("an interlaced PNG is refused where decoding it whole takes too much", "[codec][png]") {
  const TemporaryFile path("sky.png");
  ReadOptions options{.memory_limit_bytes = std::uint64_t{512} << 10U};
  write_bytes(path, sound_png(640, 320, true));
  CHECK(inspect_environment(path, options).width == 640);
  check_thrown([&] { (void)measure_environment(path, options); }, ErrorCode::limit_exceeded,
               {path.string() + ": decoding ", "save it without interlacing: as it is, it must be decoded whole"});
  write_bytes(path, sound_png(640, 320, false));
  CHECK(files::open_row_source(path, options)->traits().reader_bytes < options.memory_limit_bytes);
  (void)files::open_row_source(path, options)->open_reader();
}

// Promises: PFM is read in colour and grey, in both byte orders, in any pieces.

TEST_CASE("a colour PFM is read in both byte orders, whatever its scale's size", "[codec]") {
  const TemporaryFile path("sky.pfm");
  std::vector<float> pixels = some_pixels(34, 17);
  pixels[5] = -1.5F;
  pixels[7] = std::numeric_limits<float>::infinity();
  for (const std::string scale : {"-1.0", "1.0", "-1", "+2.5e3", "-0.001", "-1.000000"}) {
    CAPTURE(scale);
    write_bytes(path, pfm_bytes(34, 17, false, scale, pixels));
    const Environment read = read_environment(path);
    CHECK(read.info.format == FileFormat::pfm);
    CHECK(read.info.compression == "none");
    CHECK(read.info.storage == "scanline");
    CHECK(read.info.layout == Layout::lat_long);
    REQUIRE(read.info.channels.size() == 3);
    CHECK(read.info.channels[2].name == "B");
    CHECK(read.info.channels[2].type == ChannelType::float32);
    REQUIRE(read.info.width == 34);
    REQUIRE(read.info.height == 17);
    REQUIRE(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
  }
}

TEST_CASE("a grey PFM gives three equal channels", "[codec]") {
  const TemporaryFile path("grey.pfm");
  for (const int height : {1, 2, 9}) {
    const std::vector<float> colours = some_pixels(2 * height, height);
    const std::vector<float> values(colours.begin(), colours.begin() + 2 * height * height);
    write_bytes(path, pfm_bytes(2 * height, height, true, height == 2 ? "1" : "-1", values));
    const Environment read = read_environment(path);
    REQUIRE(read.info.channels.size() == 1);
    for (std::size_t i = 0; i < 3 * values.size(); ++i) {
      REQUIRE(read.pixels[i] == values[i / 3]);
    }
  }
}

TEST_CASE("a PFM's header may end with two bytes, as lines do on Windows", "[codec]") {
  const TemporaryFile path("sky.pfm");
  std::vector<float> pixels = some_pixels(4, 2);
  std::vector<char> bytes = pfm_bytes(4, 2, false, "-1\r", pixels);
  write_bytes(path, bytes);
  const Environment read = read_environment(path);
  CHECK(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));

  // If the file is too short for it, that byte belongs to the first pixel.
  bytes.pop_back();
  write_bytes(path, bytes);
  CHECK(read_environment(path).pixels[12] != pixels[12]);
}

}  // namespace welkin::test
