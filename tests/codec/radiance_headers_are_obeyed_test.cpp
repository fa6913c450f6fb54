// Promises: what a Radiance header says about the numbers is done to them, and said; what says nothing changes nothing.
#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "support/close.h"
#include "support/hdr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

const std::string kRgbe = "FORMAT=32-bit_rle_rgbe";

class Picture {
 public:
  Environment read(const std::vector<std::string>& lines, Primaries primaries = Primaries::rec709) const {
    test::HdrRecipe recipe{16, 8};
    recipe.lines = lines;
    test::write_bytes(path_, test::hdr_bytes(recipe, texels_));
    ReadOptions options;
    options.primaries = primaries;
    return read_environment(path_, options);
  }

  [[nodiscard]] const std::vector<test::Rgbe>& texels() const { return texels_; }
  [[nodiscard]] std::vector<float> values() const { return test::decoded(texels_); }
  [[nodiscard]] std::filesystem::path path() const { return path_; }

 private:
  test::TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.file("sky.hdr");
  std::vector<test::Rgbe> texels_ = test::some_rgbe(16, 8);
};

bool unchanged(const Picture& picture, const Environment& read) {
  const std::vector<float> wanted = picture.values();
  return std::equal(wanted.begin(), wanted.end(), read.pixels.get());
}

bool notes_say(const Environment& read, const std::string& words) {
  return std::any_of(read.info.notes.begin(), read.info.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("what is in a Radiance file is told", "[codec][hdr]") {
  const Picture picture;
  const Environment read = picture.read({kRgbe});
  CHECK(unchanged(picture, read));
  CHECK(read.info.format == "Radiance");
  CHECK(read.info.compression == "rle");
  CHECK(read.info.storage == "scanline");
  CHECK(read.info.layout == Layout::lat_long);
  CHECK(read.info.notes.empty());
  REQUIRE(read.info.channels.size() == 3);
  CHECK(read.info.channels[0].name == "R");
  CHECK(read.info.channels[0].type == "rgbe");

  const auto compression = [&](test::HdrForm form, bool columns) {
    test::write_bytes(picture.path(), test::hdr_bytes({16, 8, form, columns}, picture.texels()));
    return inspect_environment(picture.path());
  };
  CHECK(compression(test::HdrForm::flat, false).compression == "none");
  CHECK(compression(test::HdrForm::old_rle, false).compression == "old rle");
  CHECK(compression(test::HdrForm::new_rle, true).storage == "columns");
}

TEST_CASE("any magic word, comments and unknown lines are passed over", "[codec][hdr]") {
  const Picture picture;
  CHECK(unchanged(picture, picture.read({})));  // no FORMAT is RGBE
  CHECK(unchanged(picture, picture.read({"#?RADIANCE", "# made by hand", "GAMMA=1", "VIEW= -vtv -vp 0 0 0",
                                         "PIXASPECT=2.5", "SOFTWARE=none EXPOSURE=9", "rpict -vf x", "=", "EXPOSURE",
                                         kRgbe, "PRIMARIES=0 0 0 0 0 0 0 0", "\tEXPOSURE=3", " COLORCORR=1"})));
  for (const std::string magic : {"#?RGBE", "#?RADIANCE ", "#?", "#?rpict of 1991"}) {
    test::HdrRecipe recipe{16, 8};
    recipe.magic = magic;
    test::write_bytes(picture.path(), test::hdr_bytes(recipe, picture.texels()));
    CHECK(unchanged(picture, read_environment(picture.path())));
  }
}

TEST_CASE("lines may end as on Windows, and the resolution line may have spaces", "[codec][hdr]") {
  const Picture picture;
  for (const std::string header :
       {"#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 8 +X 16\r\n", "#?RADIANCE\n\n-Y8+X16\n",
        "#?RADIANCE\nFORMAT= 32-bit_rle_rgbe \n\n  -Y   8\t+X 16  \n"}) {
    CAPTURE(header);
    const std::vector<char> sound = test::hdr_bytes({16, 8}, picture.texels());
    std::vector<char> bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), sound.begin() + static_cast<std::ptrdiff_t>(test::hdr_header({16, 8}).size()),
                 sound.end());
    test::write_bytes(picture.path(), bytes);
    CHECK(unchanged(picture, read_environment(picture.path())));
  }
}

TEST_CASE("exposures and colour corrections are divided out, all of them", "[codec][hdr]") {
  const Picture picture;
  const Environment read =
      picture.read({"EXPOSURE=2.0", kRgbe, "EXPOSURE= 4", "COLORCORR= 1 0.5 +2e0", "COLORCORR=3 1 1"});
  const std::vector<float> stored = picture.values();
  const double divisors[] = {24.0, 4.0, 16.0};
  for (std::size_t i = 0; i < stored.size(); ++i) {
    REQUIRE(read.pixels[i] == static_cast<float>(static_cast<double>(stored[i]) / divisors[i % 3]));
  }
  CHECK(notes_say(read, "divided by 24 4 16, the product of the header's EXPOSURE and COLORCORR lines"));
  CHECK(notes_say(picture.read({"EXPOSURE=0.25", "EXPOSURE=0.5"}), "divided by 0.125,"));
  const Environment cancelled = picture.read({"EXPOSURE=4", "EXPOSURE=0.25"});
  CHECK(unchanged(picture, cancelled));
  CHECK(cancelled.info.notes.empty());
}

TEST_CASE("a gamma is ignored, and said to be", "[codec][hdr]") {
  const Picture picture;
  const Environment read = picture.read({"GAMMA=2.2"});
  CHECK(unchanged(picture, read));
  CHECK(notes_say(read, "GAMMA=2.2 is ignored"));
}

TEST_CASE("XYZE becomes Rec. 709, or stays as stored", "[codec][hdr]") {
  const Picture picture;
  const std::vector<float> stored = picture.values();
  const Environment as_stored = picture.read({"FORMAT=32-bit_rle_xyze"}, Primaries::as_stored);
  CHECK(unchanged(picture, as_stored));
  CHECK(as_stored.info.channels[0].name == "X");
  CHECK(as_stored.info.channels[0].type == "xyze");
  const Environment read = picture.read({"FORMAT=32-bit_rle_xyze"});
  CHECK(notes_say(read, "XYZ"));
  // IEC 61966-2-1, with as many digits as it states.
  const double matrix[3][3] = {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
  for (std::size_t i = 0; i < stored.size(); i += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      double wanted = 0.0;
      double size = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        wanted += matrix[c][k] * static_cast<double>(stored[i + k]);
        size += std::abs(matrix[c][k]) * static_cast<double>(stored[i + k]);
      }
      REQUIRE(std::abs(static_cast<double>(read.pixels[i + c]) - wanted) <= 1e-3 * size);
    }
  }
}

TEST_CASE("stated primaries become Rec. 709, or stay as stored", "[codec][hdr]") {
  const Picture picture;
  const std::string rec709 = "PRIMARIES=0.640 0.330 0.300 0.600 0.150 0.060 0.3127 0.3290";
  CHECK(unchanged(picture, picture.read({rec709})));
  // Rec. 2020, the same white: grey stays grey, and pure red leaves Rec. 709 (ITU-R BT.2087: 1.6605 -0.1246 -0.0182).
  const std::string rec2020 = "PRIMARIES= 0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290";
  CHECK(unchanged(picture, picture.read({rec2020}, Primaries::as_stored)));
  test::HdrRecipe recipe{2, 1};
  recipe.lines = {rec2020};
  test::write_bytes(picture.path(), test::hdr_bytes(recipe, {{128, 128, 128, 129}, {128, 0, 0, 129}}));
  const Environment read = read_environment(picture.path());
  const double wanted[] = {1.0, 1.0, 1.0, 1.6605, -0.1246, -0.0182};
  for (int i = 0; i < 6; ++i) {
    CHECK(std::abs(static_cast<double>(read.pixels[static_cast<std::size_t>(i)]) - wanted[i]) < 1e-4);
  }
  REQUIRE(read.info.notes.size() == 1);
  CHECK(read.info.notes[0] == "primaries were converted to Rec. 709 from Rec. 2020 (the header's PRIMARIES line)");
  const Environment pointless = picture.read({"PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3"});
  CHECK(unchanged(picture, pointless));
  CHECK(notes_say(pointless, "primaries that span no colours are ignored"));
}

}  // namespace welkin
