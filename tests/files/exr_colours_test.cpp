// OpenEXR: luminance and chroma, primaries, cubes in its own frames.
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

#include "files/primaries.h"
#include "files/row_source.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: luminance and chroma give exactly the values of OpenEXR's RgbaInputFile, for any requested rows and any
// line order, window, compression, part and layer.

namespace {

const Imf::Chromaticities kWide({0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F});

ReadOptions as_stored_lat_long() { return {.layout = Layout::lat_long, .primaries = Primaries::as_stored}; }

ExrRecipe recipe_of(int width, int height, Imf::Compression compression = Imf::PIZ_COMPRESSION) {
  return {.width = width, .height = height, .compression = compression};
}

void check_equal_to_library(const std::filesystem::path& path) {
  const std::vector<float> wanted = read_rgba_with_library(path);
  const Environment read = read_environment(path, as_stored_lat_long());
  REQUIRE(files::rgb_bytes(read.info.width, read.info.height) == wanted.size() * sizeof(float));
  REQUIRE(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
}

}  // namespace

TEST_CASE("luminance and chroma become what OpenEXR makes of them", "[codec]") {
  const TemporaryFile path("yc.exr");
  for (const auto& [width, height] : {std::pair{2, 2}, {4, 2}, {2, 40}, {64, 32}, {258, 130}}) {
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::DWAB_COMPRESSION}) {
      ExrRecipe recipe = recipe_of(width, height, compression);
      recipe.first_column = -6;
      recipe.first_row = height == 40 ? 1000 : -34;
      recipe.line_order = width == 64 ? Imf::DECREASING_Y : Imf::INCREASING_Y;
      if (width == 258) {
        recipe.adjust = [](Imf::Header& header) { Imf::addChromaticities(header, kWide); };
      }
      CAPTURE(width, height, compression);
      write_luminance_chroma_exr(path, recipe, some_pixels(width, height));
      check_equal_to_library(path);
    }
  }
}

TEST_CASE("any rows of luminance and chroma are those of the whole", "[codec]") {
  const TemporaryFile path("yc.exr");
  write_luminance_chroma_exr(path, recipe_of(32, 200), some_pixels(32, 200));
  const std::vector<float> wanted = read_rgba_with_library(path);
  const auto source = files::open_row_source(path, as_stored_lat_long());
  const auto reader = source->open_reader();
  std::mt19937 random(3);
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::size_t first = random() % 200;
    const std::size_t count = 1 + random() % std::min<std::size_t>(200 - first, attempt % 2 == 0 ? 5 : 200);
    std::vector<float> rows(count * 96 + 1, -7.0F);
    reader->read(static_cast<int>(first), static_cast<int>(count), rows.data());
    REQUIRE(rows.back() == -7.0F);
    REQUIRE(std::equal(rows.begin(), rows.end() - 1, wanted.begin() + static_cast<std::ptrdiff_t>(first * 96)));
  }
}

// Promises: an OpenEXR file that states its primaries is handed out in Rec. 709, unless it is wanted as it is, and says
// so.

namespace {

const Imf::Chromaticities kRec2020InFile({0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F});
const std::vector<float> kPixels = some_pixels(32, 16);

void write_with(const std::filesystem::path& path, const std::function<void(Imf::Header&)>& adjust,
                const std::vector<ExrChannel>& channels = rgb_channels(Imf::FLOAT)) {
  write_exr(path, {.width = 32, .height = 16, .channels = channels, .adjust = adjust}, kPixels);
}

ReadOptions as_stored() { return {.primaries = Primaries::as_stored}; }

bool reads(const std::filesystem::path& path, const std::vector<float>& pixels, const ReadOptions& options = {}) {
  return std::equal(pixels.begin(), pixels.end(), read_environment(path, options).pixels.get());
}

std::string only_note(const std::filesystem::path& path, const ReadOptions& options = {}) {
  const EnvironmentInfo info = inspect_environment(path, options);
  REQUIRE(info.notes.size() == 1);
  return info.notes[0];
}

}  // namespace

TEST_CASE("luminance and chroma are read in layers and parts", "[codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path plain = directory.file("plain.exr");
  const std::filesystem::path path = directory.file("parts.exr");
  const std::vector<float> pixels = some_pixels(64, 32);
  ExrRecipe recipe = recipe_of(64, 32);
  const auto channels = [](const std::string& prefix) {
    return std::vector<ExrChannel>{
        {prefix + "Y", Imf::HALF, 1, 1}, {prefix + "RY", Imf::HALF, 2, 0}, {prefix + "BY", Imf::HALF, 2, 2}};
  };
  recipe.channels = channels("");
  write_exr(plain, recipe, pixels);
  const std::vector<float> wanted = read_rgba_with_library(plain);
  ExrRecipe layered = recipe;
  layered.channels = channels("env.");
  ExrRecipe mask = recipe;
  mask.channels = {{"Y"}};
  write_exr_parts(path, {{"mask", mask, pixels}, {"light", layered, pixels}});
  const Environment read = read_environment(path);
  CHECK(read.info.layers == std::vector<std::string>{"env"});
  CHECK(std::equal(wanted.begin(), wanted.end(), read.pixels.get()));
}

TEST_CASE("stated primaries are converted, and left on request", "[codec]") {
  const TemporaryFile path("wide.exr");
  for (const bool framed : {false, true}) {
    write_with(path, [&](Imf::Header& header) {
      Imf::addChromaticities(header, kRec2020InFile);
      if (framed) {
        header.displayWindow().max.x += 16;
        header.displayWindow().max.y += 8;
      }
    });
    const Environment read = read_environment(path);
    std::vector<float> wanted = kPixels;
    files::apply(*files::to_rec709({{0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F}}),
                 wanted.data(), wanted.size() / 3);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const std::size_t row = i / 96;
      REQUIRE(read.pixels[row * (framed ? 144 : 96) + i % 96] == wanted[i]);
    }
  }
  write_with(path, [](Imf::Header& header) { Imf::addChromaticities(header, kRec2020InFile); });
  CHECK(only_note(path) == "primaries converted from Rec. 2020 to Rec. 709");
  CHECK(reads(path, kPixels, as_stored()));
  CHECK(only_note(path, as_stored()) == "colours left in the primaries of the file: Rec. 2020");
}

TEST_CASE("Rec. 709 is left as it is, stated or not, and so is grey", "[codec]") {
  const TemporaryFile path("plain.exr");
  write_with(path, [](Imf::Header& header) { Imf::addChromaticities(header, Imf::Chromaticities()); });
  CHECK(reads(path, kPixels));
  CHECK(inspect_environment(path).notes.empty());
  write_with(path, [](Imf::Header& header) { Imf::addAdoptedNeutral(header, {0.33F, 0.34F}); });
  CHECK(reads(path, kPixels));
  // Rec. 709 adapted to D50 and rounded, as Photoshop writes it.
  write_with(path, [](Imf::Header& header) {
    Imf::addChromaticities(
        header, {{0.648447F, 0.330877F}, {0.321187F, 0.597894F}, {0.155901F, 0.0660563F}, {0.345708F, 0.358541F}});
  });
  CHECK(reads(path, kPixels));
  CHECK(only_note(path).find("those of Rec. 709 seen under another white") != std::string::npos);
  write_with(path, [](Imf::Header& header) { Imf::addChromaticities(header, kRec2020InFile); },
             {{"Y", Imf::FLOAT, 1, 1}});
  CHECK(read_environment(path).pixels[0] == kPixels[1]);
  CHECK(inspect_environment(path).notes.empty());
}

TEST_CASE("the adopted neutral becomes grey", "[codec]") {
  const TemporaryFile path("neutral.exr");
  const Imath::V2f neutral(0.35F, 0.36F);
  write_with(path, [&](Imf::Header& header) {
    Imf::addChromaticities(header, kRec2020InFile);
    Imf::addAdoptedNeutral(header, neutral);
  });
  std::vector<float> wanted = kPixels;
  files::apply(*files::to_rec709({{0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F}},
                                 glm::dvec2(neutral.x, neutral.y)),
               wanted.data(), wanted.size() / 3);
  CHECK(reads(path, wanted));
}

TEST_CASE("primaries that make no colours are an error that names the attribute", "[codec]") {
  const TemporaryFile path("bad.exr");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto message = [&](const ReadOptions& options = {}) {
    const ThrownError error = thrown_by([&] { (void)inspect_environment(path, options); });
    CHECK(error.code == ErrorCode::corrupt_file);
    CHECK(error.says(path.string() + ": "));
    return error.message;
  };
  const Imf::Chromaticities none({0, 0}, {0, 0}, {0, 0}, {0, 0});
  for (const Imf::Chromaticities& bad :
       {none, Imf::Chromaticities({nan, nan}, {0.3F, 0.6F}, {0.15F, 0.06F}, {0.3F, 0.3F}),
        Imf::Chromaticities({3e38F, 1}, {0.3F, 0.6F}, {0.15F, 0.06F}, {0.3F, 0.3F}),
        Imf::Chromaticities({0.64F, 0.33F}, {0.3F, 0.6F}, {0.15F, 0.06F}, {0.3F, 0})}) {
    write_with(path, [&](Imf::Header& header) { Imf::addChromaticities(header, bad); });
    CHECK(message().find("its attribute \"chromaticities\" makes no colours") != std::string::npos);
    CHECK(message().find("pass --primaries as-stored") != std::string::npos);
    CHECK(reads(path, kPixels, as_stored()));
  }
  write_with(path, [&](Imf::Header& header) {
    Imf::addChromaticities(header, kRec2020InFile);
    Imf::addAdoptedNeutral(header, {nan, 0});
  });
  CHECK(message().find("its attribute \"adoptedNeutral\" makes no colours") != std::string::npos);
  write_with(path, [&](Imf::Header& header) { Imf::addChromaticities(header, none); },
             {{"Y"}, {"RY", Imf::HALF, 2, 0}, {"BY", Imf::HALF, 2, 2}});
  CHECK(message(as_stored()).find("luminance and chroma cannot be taken apart") != std::string::npos);
}

// Promises: cubes with OpenEXR's envmap attribute come out in Welkin's frames and go back, other strips as they are.

namespace {

// Each texel's colour is the direction that OpenEXR itself gives for its centre: it counts places in a face by its own
// axes, and says where in the image they lie. (Its face runs from the centre of its first texel to that of its last
// one, ours over their areas: the place is stretched.)
std::vector<float> directions_by_openexr(int size) {
  const Imath::Box2i window({0, 0}, {size - 1, 6 * size - 1});
  const float scale = static_cast<float>(size - 1) / static_cast<float>(size);
  std::vector<float> rgb(std::size_t{18} * static_cast<std::size_t>(size * size));
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const auto id = static_cast<Imf::CubeMapFace>(face);
        const Imath::V2f position(static_cast<float>(x), static_cast<float>(y));
        const Imath::V3f direction =
            Imf::CubeMap::direction(id, window, (position + Imath::V2f(0.5F)) * scale).normalized();
        const Imath::V2f pixel = Imf::CubeMap::pixelPosition(id, window, position);
        const auto texel = static_cast<std::size_t>(pixel.y * static_cast<float>(size) + pixel.x);
        std::copy_n(&direction.x, 3, rgb.begin() + static_cast<std::ptrdiff_t>(3 * texel));
      }
    }
  }
  return rgb;
}

}  // namespace

TEST_CASE("a strip with the envmap attribute of a cube is turned to Welkin's frames", "[codec]") {
  const TemporaryFile path("cube.exr");
  for (const int size : {4, 7, 40}) {
    for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(16, 16)}}) {
      const std::vector<float> stored = directions_by_openexr(size);
      write_exr(path,
                {.width = size,
                 .height = 6 * size,
                 .tiles = tiles,
                 .envmap = Imf::ENVMAP_CUBE,
                 .channels = rgb_channels(Imf::FLOAT)},
                stored);
      const Environment cube = read_environment(path);
      const float* texel = cube.pixels.get();
      for (const glm::dvec3& wanted : texel_centres(size)) {
        for (int axis = 0; axis < 3; ++axis) REQUIRE(std::abs(*texel++ - wanted[axis]) < 1e-6);
      }
    }
  }
}

TEST_CASE("An OpenEXR cube lies where OpenEXR looks for it", "[writers]") {
  const TemporaryFile path("cube.exr");
  const int size = 5;
  const Cubemap directions = cubemap_of(size, [](const glm::dvec3& direction) { return direction; });
  write_environment(path, directions.view(), {Layout::automatic, SampleType::float32});
  REQUIRE(Imf::envmap(Imf::InputFile(path.string().c_str()).header()) == Imf::ENVMAP_CUBE);
  const std::vector<float> stored = read_exr_with_library(path);
  const std::vector<float> wanted = directions_by_openexr(size);
  REQUIRE(stored.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) REQUIRE(std::abs(stored[i] - wanted[i]) < 1e-6F);
}

TEST_CASE("a cube of OpenEXR's has the same light and statistics as its faces in a plain strip", "[codec][slow]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.exr");
  const int size = 120;
  ExrRecipe recipe{.width = size, .height = 6 * size, .envmap = Imf::ENVMAP_CUBE, .channels = rgb_channels(Imf::FLOAT)};
  write_exr(path, recipe, some_pixels(size, 6 * size));
  const Environment cube = read_environment(path);
  const std::filesystem::path plain = directory.file("plain.exr");
  const auto count = static_cast<std::ptrdiff_t>(18 * size * size);
  recipe.envmap = std::nullopt;
  write_exr(plain, recipe, std::vector<float>(cube.pixels.get(), cube.pixels.get() + count));

  CHECK(same_bits(project_file(path).radiance, project_file(plain).radiance));
  const EnvironmentStatistics found = measure_environment(path);
  const EnvironmentStatistics wanted = measure_environment(plain);
  CHECK(found.brightest == wanted.brightest);
  CHECK(found.brightest_direction == wanted.brightest_direction);
  CHECK(found.mean.g == Approx(wanted.mean.g).epsilon(1e-13));
  for (const int threads : {1, 2, 5}) {
    run_with_threads(threads, [&] {
      const Environment again = read_environment(path);
      CHECK(std::equal(again.pixels.get(), again.pixels.get() + count, cube.pixels.get()));
    });
  }
}

}  // namespace welkin::test
