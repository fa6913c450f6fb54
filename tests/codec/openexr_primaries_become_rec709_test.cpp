// Promises: an OpenEXR file that states its primaries is handed out in Rec. 709, unless it is wanted as it is, and says
// so.
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/primaries.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

const Imf::Chromaticities kRec2020({0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F});
const std::vector<float> kPixels = test::some_pixels(32, 16);

void write_with(const std::filesystem::path& path, const std::function<void(Imf::Header&)>& adjust,
                const std::vector<test::ExrChannel>& channels = test::rgb_channels(Imf::FLOAT)) {
  test::ExrRecipe recipe{32, 16, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, channels};
  recipe.adjust = adjust;
  test::write_exr(path, recipe, kPixels);
}

ReadOptions as_stored() {
  ReadOptions options;
  options.primaries = Primaries::as_stored;
  return options;
}

bool reads(const std::filesystem::path& path, const std::vector<float>& pixels, const ReadOptions& options = {}) {
  return std::equal(pixels.begin(), pixels.end(), read_environment(path, options).pixels.get());
}

std::string only_note(const std::filesystem::path& path, const ReadOptions& options = {}) {
  const EnvironmentInfo info = inspect_environment(path, options);
  REQUIRE(info.notes.size() == 1);
  return info.notes[0];
}

}  // namespace

TEST_CASE("stated primaries are converted, and left on request", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("wide.exr");
  for (const bool framed : {false, true}) {
    write_with(path, [&](Imf::Header& header) {
      Imf::addChromaticities(header, kRec2020);
      if (framed) {
        header.displayWindow().max.x += 16;
        header.displayWindow().max.y += 8;
      }
    });
    const Environment read = read_environment(path);
    std::vector<float> wanted = kPixels;
    codec::apply(*codec::to_rec709({{0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F}}),
                 wanted.data(), wanted.size() / 3);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const std::size_t row = i / 96;
      REQUIRE(read.pixels[row * (framed ? 144 : 96) + i % 96] == wanted[i]);
    }
  }
  write_with(path, [](Imf::Header& header) { Imf::addChromaticities(header, kRec2020); });
  CHECK(only_note(path) == "primaries converted from Rec. 2020 to Rec. 709");
  CHECK(reads(path, kPixels, as_stored()));
  CHECK(only_note(path, as_stored()) == "colours left in the primaries of the file: Rec. 2020");
}

TEST_CASE("Rec. 709 is left as it is, stated or not, and so is grey", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("plain.exr");
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
  write_with(path, [](Imf::Header& header) { Imf::addChromaticities(header, kRec2020); }, {{"Y", Imf::FLOAT, 1, 1}});
  CHECK(read_environment(path).pixels[0] == kPixels[1]);
  CHECK(inspect_environment(path).notes.empty());
}

TEST_CASE("the adopted neutral becomes grey", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("neutral.exr");
  const Imath::V2f neutral(0.35F, 0.36F);
  write_with(path, [&](Imf::Header& header) {
    Imf::addChromaticities(header, kRec2020);
    Imf::addAdoptedNeutral(header, neutral);
  });
  std::vector<float> wanted = kPixels;
  codec::apply(*codec::to_rec709({{0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F}},
                                 glm::dvec2(neutral.x, neutral.y)),
               wanted.data(), wanted.size() / 3);
  CHECK(reads(path, wanted));
}

TEST_CASE("primaries that make no colours are an error that names the attribute", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("bad.exr");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto message = [&](const ReadOptions& options = {}) {
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path, options); });
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
    Imf::addChromaticities(header, kRec2020);
    Imf::addAdoptedNeutral(header, {nan, 0});
  });
  CHECK(message().find("its attribute \"adoptedNeutral\" makes no colours") != std::string::npos);
  write_with(path, [&](Imf::Header& header) { Imf::addChromaticities(header, none); },
             {{"Y"}, {"RY", Imf::HALF, 2, 0}, {"BY", Imf::HALF, 2, 2}});
  CHECK(message(as_stored()).find("luminance and chroma cannot be taken apart") != std::string::npos);
}

}  // namespace welkin
