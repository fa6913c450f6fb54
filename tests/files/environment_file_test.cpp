// Environment files of any format: their known pixels, statistics, refusals.
#include "welkin/environment_file.h"

#include <ImfTileDescription.h>

#include "files/row_source.h"
#include "image/geometry.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/pfm_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"

namespace welkin::test {

// Promises: real files, where they are at hand, decode to the pixels that other programs found in them, and those that
// are not read are refused by name.

namespace {

double worst_relative_error(const Environment& read, const std::vector<float>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst = std::max(worst, static_cast<double>(std::abs(read.pixels[i] - truth[i]) / truth[i]));
  }
  return worst;
}

/// Files by their compression.
const std::map<std::string, std::vector<std::string>> kExrVariants{
    {"none", {"none_half", "none_float", "decreasingY_none_float"}},
    {"rle", {"rle_half"}},
    {"zips", {"zips_half"}},
    {"zip",
     {"zip_half", "zip_float", "tiled32_zip_half", "mipmap_t16_zip_half", "ripmap_t16_zip_half", "decreasingY_zip_half",
      "envattr_latlong", "dataoffset", "rgb_plus_Z", "overscan_data", "layered_names", "multipart"}},
    {"piz", {"piz_half", "piz_float", "tiled48x40_piz_float"}},
    {"pxr24", {"pxr24_half", "pxr24_float"}},
    {"b44", {"b44_half"}},
    {"b44a", {"b44a_half"}},
    {"dwaa", {"dwaa_half", "dwaa_float"}},
    {"dwab", {"dwab_half"}}};

/// Returns the largest error of a compression's texels; 0 stands for equal bits.
double tolerance_of(const std::string& compression) {
  return compression.starts_with("b44") ? 0.1 : compression.starts_with("dwa") ? 0.35 : 0.0;
}

}  // namespace

TEST_CASE("one image in every OpenEXR form is the same image", "[codec][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  const std::vector<float> truth = npy_values<float>(kVariants / "truth_256x128.npy", "'<f4'", "(128, 256, 3)");
  REQUIRE(truth.size() == 256 * 128 * 3);
  for (const auto& [compression, names] : kExrVariants) {
    for (const std::string& name : names) {
      CAPTURE(name);
      const Environment read = read_environment(kVariants / (name + "_256x128.exr"));
      CHECK(read.info.compression == compression);
      CHECK(read.info.layout == Layout::lat_long);
      REQUIRE(read.info.width == 256);
      REQUIRE(read.info.height == 128);
      CHECK(worst_relative_error(read, truth) <= tolerance_of(compression));
    }
  }
}

TEST_CASE("OpenEXR's cubes show the same scene as its lat-longs", "[codec][shared][slow]") {
  if (!shared_images_are_here()) {
    return;
  }
  const auto compare = [](const std::filesystem::path& cube, const std::filesystem::path& lat_long, double tolerance) {
    CAPTURE(cube.string());
    const EnvironmentInfo info = inspect_environment(cube);
    CHECK(info.layout == Layout::vertical_strip);
    CHECK(info.layout_reason == "the header's envmap attribute says cube");
    const EnvironmentStatistics of_cube = measure_environment(cube);
    const EnvironmentStatistics of_lat_long = measure_environment(lat_long);
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(close(of_cube.mean[channel], of_lat_long.mean[channel], tolerance));
    }
    return glm::dot(of_cube.brightest_direction, of_lat_long.brightest_direction);
  };
  const std::filesystem::path env = kImages / "env";
  CHECK(compare(env / "openexr_KernerEnvCube.exr", env / "openexr_KernerEnvLatLong.exr", 0.03) > 0.999);
  compare(env / "openexr_WavyLinesCube.exr", env / "openexr_WavyLinesLatLong.exr", 0.03);
  const std::filesystem::path truth = kVariants / "zip_half_256x128.exr";
  CHECK(compare(kVariants / "cube64_exrenvmap.exr", truth, 0.03) > 0.99);
  CHECK(compare(kVariants / "cubemip64_exrenvmap.exr", truth, 0.03) > 0.99);
}

// Promises: Radiance images that other programs wrote, where they are at hand, decode to the pixels that are known to
// be in them.

TEST_CASE("one image in every Radiance form is the same image", "[codec][hdr][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  const std::vector<float> truth = npy_values<float>(kVariants / "truth_256x128.npy", "'<f4'", "(128, 256, 3)");
  REQUIRE(truth.size() == 256 * 128 * 3);
  const auto read = [&](const std::string& name) {
    CAPTURE(name);
    Environment environment = read_environment(kVariants / (name + "_256x128.hdr"));
    REQUIRE(environment.info.format == FileFormat::radiance);
    REQUIRE(environment.info.width == 256);
    REQUIRE(environment.info.height == 128);
    return environment;
  };
  for (const std::string name : {"newrle", "oldrle", "flat", "minusX", "plusY", "plusX_minusY", "magic_rgbe"}) {
    CAPTURE(name);
    CHECK(std::memcmp(read(name).pixels.get(), truth.data(), truth.size() * sizeof(float)) == 0);
  }
  CHECK(read("oldrle").info.compression == "old rle");
  CHECK(read("flat").info.compression == "none");

  // EXPOSURE=2 twice, and what is stored is four times the radiance.
  const Environment exposed = read("exposure2x2");
  REQUIRE(exposed.info.notes.size() == 1);
  CHECK(exposed.info.notes[0].find("divided by 4,") != std::string::npos);
  CHECK(std::memcmp(exposed.pixels.get(), truth.data(), truth.size() * sizeof(float)) == 0);

  // XYZ in 8 bits relative to the largest of the three may lose half a step of X, Y, Z, each times its share of R, G, B
  // (at most 3.3 for X in red), and less than 5 % of a texel's largest component.
  const Environment xyz = read("xyze");
  double worst = 0.0;
  double sum_of_errors = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); i += 3) {
    const float largest = std::max({truth[i], truth[i + 1], truth[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = static_cast<double>(xyz.pixels[i + c]) - static_cast<double>(truth[i + c]);
      worst = std::max(worst, std::abs(error) / static_cast<double>(largest));
      sum_of_errors += error;
      sum += static_cast<double>(truth[i + c]);
    }
  }
  CAPTURE(worst, sum_of_errors / sum);
  CHECK(worst < 0.05);
  CHECK(std::abs(sum_of_errors / sum) < 0.01);
}

TEST_CASE("the Radiance environments have the extremes that are on record", "[codec][hdr][shared]") {
  if (!shared_images_are_here()) {
    return;
  }
  // From the shared manifest, which other programs made.
  const EnvironmentStatistics spruit = measure_environment(kImages / "env" / "spruit_sunrise_1k.hdr");
  CHECK(spruit.maximum == glm::dvec3(222208.0, 154624.0, 44032.0));
  const EnvironmentStatistics venice = measure_environment(kImages / "env" / "venice_sunset_1k.hdr");
  CHECK(venice.maximum.r == 6496.0);
  CHECK(venice.maximum.g == 992.0);
  const EnvironmentStatistics night = measure_environment(kImages / "env" / "dikhololo_night_1k.hdr");
  CHECK(night.maximum == glm::dvec3(115.0, 63.5, 43.0));
}

// Promises: an image's statistics are weighted by the solid angles that its texels have, leave out what is no number,
// and are the same bits however the file is cut and on any number of threads.

namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

TEST_CASE("statistics of a known image are what they must be", "[codec]") {
  const TemporaryFile path("known.pfm");
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> pixels(std::size_t{3} * 64 * 32, 0.25F);
  const auto texel = [&](std::size_t column, std::size_t row) { return pixels.data() + 3 * (64 * row + column); };
  std::fill_n(texel(16, 16), 3, 5.0F);
  std::fill_n(texel(3, 4), 3, kInfinity);
  texel(9, 5)[0] = kNaN;
  texel(9, 5)[1] = 1e30F;
  texel(10, 6)[2] = -0.5F;
  texel(11, 6)[2] = -kInfinity;
  write_bytes(path, pfm_bytes(64, 32, false, "-1", pixels));

  const EnvironmentStatistics found = measure_environment(path);
  CHECK(found.texels == 64 * 32);
  CHECK(found.nans == 1);
  CHECK(found.infinities == 4);
  CHECK(found.negatives == 1);
  CHECK(found.minimum == glm::dvec3(0.25, 0.25, -0.5));
  CHECK(found.maximum == glm::dvec3(5.0, static_cast<double>(1e30F), 5.0));
  CHECK(found.brightest == glm::dvec3(5.0));
  CHECK(found.brightest_column == 16);
  CHECK(found.brightest_row == 16);
  // Column 16.5 of 64: a quarter in from the left is +x; row 16.5 of 32 is just below the horizon.
  const double latitude = -kPi * 0.5 / 32.0;
  const double longitude = kPi / 2.0 - 2.0 * kPi * 0.5 / 64.0;
  CHECK(close(found.brightest_direction.x, std::sin(longitude) * std::cos(latitude)));
  CHECK(close(found.brightest_direction.y, std::sin(latitude)));
  CHECK(close(found.brightest_direction.z, std::cos(longitude) * std::cos(latitude)));
  const double bright = image::lat_long_texel_solid_angle(64, 32, 16);
  const double out = image::lat_long_texel_solid_angle(64, 32, 4) + image::lat_long_texel_solid_angle(64, 32, 5);
  const double rest = 4.0 * kPi - out;
  CHECK(close(found.mean.r, (0.25 * (rest - bright) + 5.0 * bright) / rest, 1e-12));
  CHECK(close(found.total_radiance.r, 4.0 * kPi * found.mean.r, 1e-15));
}

TEST_CASE("a uniform sphere has its own value as mean, in either layout", "[codec]") {
  const TemporaryFile path("uniform.pfm");
  for (const auto& [width, height] : {std::pair{20, 10}, {1, 6}, {7, 42}, {40, 240}}) {
    write_bytes(path, pfm_bytes(width, height, true, "-1",
                                std::vector<float>(static_cast<std::size_t>(width * height), 0.75F)));
    const EnvironmentStatistics found = measure_environment(path);
    CHECK(close(found.mean.g, 0.75, 1e-14));
    CHECK(close(found.total_radiance.b, 3.0 * kPi, 1e-14));
    CHECK(found.brightest_column == 0);
    CHECK(found.brightest_row == 0);
  }
}

TEST_CASE("an image of nothing but NaN has zeros as statistics", "[codec]") {
  const TemporaryFile path("nothing.pfm");
  const std::vector<float> pixels(std::size_t{3} * 4 * 2, std::numeric_limits<float>::quiet_NaN());
  write_bytes(path, pfm_bytes(4, 2, false, "-1", pixels));
  const EnvironmentStatistics found = measure_environment(path);
  CHECK(found.nans == 24);
  CHECK(found.minimum == glm::dvec3(0.0));
  CHECK(found.maximum == glm::dvec3(0.0));
  CHECK(found.total_radiance == glm::dvec3(0.0));
}

// Promises: what is not read is refused by a code and a message with the file's name, what was found, what would do.

namespace {

void check_refusal(const std::filesystem::path& path, ErrorCode code, const std::string& found,
                   const std::string& remedy, const ReadOptions& options = {}) {
  check_thrown([&] { (void)inspect_environment(path, options); }, code, {path.string() + ": ", found, remedy});
}

std::vector<char> text(const std::string& words) { return {words.begin(), words.end()}; }

void check_text(const std::filesystem::path& path, const std::string& content, ErrorCode code, const std::string& found,
                const std::string& remedy) {
  write_bytes(path, text(content));
  check_refusal(path, code, found, remedy);
}

ExrRecipe small_recipe(const std::vector<ExrChannel>& channels) {
  return {.width = 8, .height = 4, .channels = channels};
}

}  // namespace

TEST_CASE("what is no readable file is refused", "[codec][posix]") {
  const TemporaryDirectory directory;
  check_refusal(directory.file("none.exr"), ErrorCode::file_access, "no such file", "");
  check_refusal(directory.file("."), ErrorCode::file_access, "is a directory", "name an image in it");
  check_refusal("/dev/null", ErrorCode::file_access, "not a regular file", "copy");
}

TEST_CASE("other formats are refused by their names", "[codec]") {
  const TemporaryFile path("sky.pic");
  const ErrorCode code = ErrorCode::unsupported_file;
  const std::string remedy =
      "OpenEXR (.exr), Radiance (.hdr), PFM (.pfm), PNG, JPEG with a gain map, KTX2, KTX, DDS and .env are read: "
      "convert it";
  check_text(path, "", code, "is empty", remedy);
  check_text(path, "\xff\xd8\xff\xe0 JFIF", ErrorCode::corrupt_file, "is a damaged JPEG: ends too early",
             "export it again");
  check_text(path, "RIFF1234WEBP", code, "a WebP", remedy);
  check_text(path, "\xabKTX 11\xbb\r\n\x1a\n", ErrorCode::corrupt_file, "ends too early", "64 bytes are needed");
  check_text(path, "\xabKTX 13\xbb\r\n\x1a\n", code, "is a KTX texture", "of an unknown version; export it");
  check_text(path, "good morning", code, "is not an image or texture that Welkin reads", remedy);
}

TEST_CASE("channels that make no colour are refused by their names", "[codec]") {
  const TemporaryFile path("sky.exr");
  const ErrorCode code = ErrorCode::unsupported_file;
  const std::vector<float> pixels = some_pixels(8, 4);

  write_exr(path, small_recipe({{"R"}, {"G"}}), pixels);
  check_refusal(path, code, "has channels G, R", "rename or convert the channels");
  write_exr(path, small_recipe({{"R"}, {"G"}, {"B", Imf::HALF, 2}}), pixels);
  check_refusal(path, code, "channel B is sampled at every 2 x 2 texels where 1 x 1 is read",
                "save it as R, G and B at full resolution");
  write_exr(path, small_recipe({{"Y"}, {"RY"}, {"BY"}}), pixels);
  check_refusal(path, code, "channel RY is sampled at every 1 x 1 texels where 2 x 2 (luminance-chroma) is read",
                "save it as R, G and B");
}

TEST_CASE("deep and multi-part files and unknown versions are refused by what they are", "[codec]") {
  const TemporaryFile path("sky.exr");
  const ErrorCode code = ErrorCode::unsupported_file;
  write_exr(path, small_recipe(rgb_channels(Imf::HALF)), some_pixels(8, 4));
  const std::vector<char> sound = read_bytes(path);
  const auto with_version = [&](char version, char flags) {
    std::vector<char> bytes = sound;
    bytes[4] = version;
    bytes[5] = flags;
    write_bytes(path, bytes);
  };
  with_version(2, 0x08);
  check_refusal(path, code, "is a deep OpenEXR image", "flatten");
  with_version(2, 0x10);
  check_refusal(path, ErrorCode::corrupt_file, "part 0 lacks a name", "fetch or export it again");
  with_version(2, 0x12);
  check_refusal(path, ErrorCode::corrupt_file, "single-part tiled and multi-part at once", "fetch or export it again");
  with_version(3, 0);
  check_refusal(path, code, "version 3", "save it as OpenEXR 2");
  with_version(2, 0x20);
  check_refusal(path, code, "flags 32", "save it as OpenEXR 2");
}

TEST_CASE("images too large for any layout are refused before they are read", "[codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("vast.exr");
  const std::vector<float> pixels = some_pixels(65538, 1);
  ExrRecipe recipe{.width = 65538, .height = 1};
  write_exr(path, recipe, pixels);
  check_refusal(path, ErrorCode::unsupported_file, "65538 x 1", "reduce it");
  check_text(directory.file("vast.pfm"), "PF\n70000 1\n-1\n", ErrorCode::unsupported_file, "70000", "reduce");
}

TEST_CASE("damaged PFM headers are refused by what is wrong with them", "[codec]") {
  const TemporaryFile path("sky.pfm");
  const ErrorCode code = ErrorCode::corrupt_file;
  check_text(path, "PF", code, "ends too early", "fetch or export it again");
  check_text(path, "PF\n2", code, "ends too early", "");
  check_text(path, "PF\n2 1\n-1\n12345678", code, "ends too early: 2 x 1 texels take 24 bytes, 8 follow", "");
  check_text(path, "PF\n0 1\n-1\n", code, "width is 0", "");
  check_text(path, "PF\n2 -1\n-1\n", code, "height is -1", "");
  check_text(path, "PF\n2x 1\n-1\n", code, "width is not a number: \"2x\"", "");
  check_text(path, "PF\n99999999999999999999 1\n-1\n", code, "width is not a number", "");
  check_text(path, "PF\n2 1\n0\n", code, "scale is 0", "");
  check_text(path, "PF\n2 1\nnan\n", code, "scale is 0 or not finite", "");
  check_text(path, "PF\n2 1\nbig\n", code, "scale is not a number", "");
  check_text(path, "PF" + std::string(5000, ' '), code, "has no width", "");
  check_text(path, "PF\n" + std::string(5000, '1'), code, "width is not a number", "");
  check_text(path, "PFX\n2 1\n-1\n", ErrorCode::unsupported_file, "starts with \"PFX\"", "PF (colour) or Pf (grey)");
}

TEST_CASE("an image above the memory limit is refused, a streamed one is not", "[codec]") {
  const TemporaryFile path("sky.pfm");
  write_bytes(path, pfm_bytes(512, 256, false, "-1", some_pixels(512, 256)));
  ReadOptions options{.memory_limit_bytes = 512 * 256 * 12 - 1};
  check_thrown([&] { (void)read_environment(path, options); }, ErrorCode::limit_exceeded,
               {path.string() + ": 512 x 256 texels take 1572864 bytes", "raise the limit or reduce the image"});
  CHECK(measure_environment(path, options).texels == 512 * 256);
  options.memory_limit_bytes = 1000;
  CHECK(thrown_by([&] { (void)measure_environment(path, options); }).code == ErrorCode::limit_exceeded);
}

// Promises: readers reopen a file; one that has become another image meanwhile is refused, not read into memory
// that was made for the first.

namespace {

void write_png(const std::filesystem::path& path, const PngRecipe& recipe) {
  write_bytes(path, png_bytes(recipe, some_samples(recipe)));
}

void check_changed(const std::filesystem::path& path, const files::RowSource& source) {
  check_thrown([&] { (void)source.open_reader(); }, ErrorCode::file_access,
               {path.string() + ": has changed while it was read; read it again"});
}

}  // namespace

TEST_CASE("a PNG that has become another one is not read", "[codec][png]") {
  const TemporaryFile path("sky.png");
  const PngRecipe first{8, 4};
  PngRecipe interlaced = first;
  interlaced.interlaced = true;
  const std::vector<PngRecipe> others{{64, 4}, {8, 32}, {8, 4, 16}, interlaced};
  for (const PngRecipe& other : others) {
    CAPTURE(other.width, other.height, other.bits, other.interlaced);
    write_png(path, first);
    const auto source = files::open_row_source(path, {Layout::lat_long});
    write_png(path, other);
    check_changed(path, *source);
    write_png(path, first);
    (void)source->open_reader();
  }
}

TEST_CASE("an OpenEXR file that has got other tiles is not read", "[codec][exr]") {
  const TemporaryFile path("sky.exr");
  const auto write = [&](const Imf::TileDescription& tiles) {
    ExrRecipe recipe{.width = 64, .height = 32, .tiles = tiles, .channels = rgb_channels(Imf::HALF)};
    write_exr(path, recipe, some_pixels(64, 32));
  };
  const Imf::TileDescription first(16, 16, Imf::MIPMAP_LEVELS);
  for (const Imf::TileDescription& other :
       {Imf::TileDescription(16, 32, Imf::MIPMAP_LEVELS), Imf::TileDescription(16, 8, Imf::MIPMAP_LEVELS),
        Imf::TileDescription(16, 16, Imf::ONE_LEVEL)}) {
    CAPTURE(other.ySize, other.mode);
    write(first);
    const auto source = files::open_row_source(path, {});
    write(other);
    check_changed(path, *source);
    write(first);
    (void)source->open_reader();
  }
}

}  // namespace welkin::test
