// Radiance images: forms of scanlines, headers, refusals.
#include "files/hdr_kernels.h"
#include "files/row_source.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/hdr_files.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: a Radiance image is the same image in every form of its scanlines, from every corner, at every width,
// in any pieces, on any number of threads.

namespace {

const ReadOptions kLatLong{Layout::lat_long};

void check_whole(const std::filesystem::path& path, const HdrRecipe& recipe, const std::vector<Rgbe>& texels) {
  CAPTURE(recipe.width, recipe.height, static_cast<int>(recipe.form), recipe.columns, recipe.bottom_first,
          recipe.right_first);
  write_bytes(path, hdr_bytes(recipe, texels));
  const Environment read = read_environment(path, kLatLong);
  REQUIRE(read.info.width == recipe.width);
  REQUIRE(read.info.height == recipe.height);
  CHECK(same_bits(decoded(texels), read.pixels.get()));
}

}  // namespace

TEST_CASE("all forms and orientations of a Radiance image are the same image", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  const std::vector<Rgbe> texels = some_rgbe(38, 19);
  for (const HdrForm form : {HdrForm::flat, HdrForm::old_rle, HdrForm::new_rle, HdrForm::mixed}) {
    for (int orientation = 0; orientation < 8; ++orientation) {
      const HdrRecipe recipe{38, 19, form, orientation >= 4, orientation % 4 >= 2, orientation % 2 == 1};
      check_whole(path, recipe, texels);
    }
  }
}

TEST_CASE("Radiance images of any width are read", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  for (const auto& [width, height] : {std::tuple{1, 1},
                                      {1, 9},
                                      {2, 1},
                                      {3, 2},
                                      {7, 3},
                                      {8, 3},
                                      {9, 2},
                                      {127, 3},
                                      {128, 3},
                                      {129, 3},
                                      {257, 5},
                                      {32767, 2},
                                      {32768, 2},
                                      {65536, 1}}) {
    const std::vector<Rgbe> texels = some_rgbe(width, height, static_cast<unsigned>(width));
    for (const HdrForm form : {HdrForm::flat, HdrForm::old_rle, HdrForm::new_rle, HdrForm::mixed}) {
      check_whole(path, {width, height, form}, texels);
      if (width <= 257) {
        check_whole(path, {width, height, form, true, false, true}, texels);
      }
    }
  }
}

TEST_CASE("long repeats of the old form shift their counts", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  for (const int width : {256, 257, 258, 513, 65536}) {  // after a first texel: counts of 255, 256, 257, 512, 65535
    const std::vector<Rgbe> texels(static_cast<std::size_t>(width), Rgbe{200, 100, 50, 130});
    check_whole(path, {width, 1, HdrForm::old_rle}, texels);
  }
  // A repeat, a texel, a repeat: the texel in between restarts the count.
  const HdrRecipe recipe{10, 1};
  std::string file = hdr_header(recipe);
  file += std::string("\x80\x40\x20\x81\x01\x01\x01\x03", 8) + std::string("\x90\x40\x20\x81\x01\x01\x01\x05", 8);
  write_bytes(path, {file.begin(), file.end()});
  std::vector<Rgbe> texels(4, {0x80, 0x40, 0x20, 0x81});
  texels.resize(10, {0x90, 0x40, 0x20, 0x81});
  CHECK(same_bits(decoded(texels), read_environment(path, kLatLong).pixels.get()));
}

TEST_CASE("what may look like the new form is read as Radiance reads it", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  // Third byte 128 or more: an old texel. Below 8 texels and above 32767: never the new form.
  std::vector<Rgbe> texels = some_rgbe(8, 4);
  texels[0] = texels[8] = {2, 2, 128, 8};
  check_whole(path, {8, 4, HdrForm::flat}, texels);
  check_whole(path, {8, 4, HdrForm::old_rle}, texels);
  texels.resize(14);
  texels[0] = texels[7] = {2, 2, 0, 7};
  check_whole(path, {7, 2, HdrForm::flat}, texels);
  texels = some_rgbe(32768, 1);
  texels[0] = {2, 2, 127, 255};
  check_whole(path, {32768, 1, HdrForm::flat}, texels);
}

TEST_CASE("codes of no texels are passed over", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  std::string file = hdr_header({8, 1}) + std::string("\x02\x02\x00\x08", 4);
  for (const char value : {'\x11', '\x22', '\x33', '\x7f'}) {
    file += std::string("\x00\x00\x83", 3) + value + std::string("\x00\x80\x00\x85", 4) + value;
  }
  // A code of 128 takes 128 values, as Radiance has it: a run of none would be 0.
  write_bytes(path, {file.begin(), file.end()});
  CHECK_THROWS_AS(read_environment(path, kLatLong), Error);
  file = hdr_header({8, 1}) + std::string("\x02\x02\x00\x08", 4);
  for (const char value : {'\x11', '\x22', '\x33', '\x7f'}) {
    file += std::string("\x00\x00\x83", 3) + value + std::string("\x00\x85", 2) + value;
  }
  write_bytes(path, {file.begin(), file.end()});
  const std::vector<Rgbe> texels(8, {0x11, 0x22, 0x33, 0x7f});
  CHECK(same_bits(decoded(texels), read_environment(path, kLatLong).pixels.get()));
}

// Promises: what a Radiance header says about the numbers is done to them, and said; what says nothing changes nothing.

namespace {

const std::string kRgbe = "FORMAT=32-bit_rle_rgbe";

class Image {
 public:
  Environment read(const std::vector<std::string>& lines, Primaries primaries = Primaries::rec709) const {
    HdrRecipe recipe{16, 8};
    recipe.lines = lines;
    write_bytes(path_, hdr_bytes(recipe, texels_));
    return read_environment(path_, {.primaries = primaries});
  }

  [[nodiscard]] const std::vector<Rgbe>& texels() const { return texels_; }
  [[nodiscard]] std::vector<float> values() const { return decoded(texels_); }
  [[nodiscard]] std::filesystem::path path() const { return path_; }

 private:
  TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.file("sky.hdr");
  std::vector<Rgbe> texels_ = some_rgbe(16, 8);
};

bool unchanged(const Image& image, const Environment& read) {
  const std::vector<float> wanted = image.values();
  return std::equal(wanted.begin(), wanted.end(), read.pixels.get());
}

bool notes_say(const Environment& read, const std::string& words) {
  return std::ranges::any_of(read.info.notes, [&](const auto& note) { return note.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("any magic word, comments and unknown lines are passed over", "[codec][hdr]") {
  const Image image;
  CHECK(unchanged(image, image.read({})));  // no FORMAT is RGBE
  CHECK(unchanged(image, image.read({"#?RADIANCE", "# made by hand", "GAMMA=1", "VIEW= -vtv -vp 0 0 0", "PIXASPECT=2.5",
                                     "SOFTWARE=none EXPOSURE=9", "rpict -vf x", "=", "EXPOSURE", kRgbe,
                                     "PRIMARIES=0 0 0 0 0 0 0 0", "\tEXPOSURE=3", " COLORCORR=1"})));
  for (const std::string magic : {"#?RGBE", "#?RADIANCE ", "#?", "#?rpict of 1991"}) {
    HdrRecipe recipe{16, 8};
    recipe.magic = magic;
    write_bytes(image.path(), hdr_bytes(recipe, image.texels()));
    CHECK(unchanged(image, read_environment(image.path())));
  }
}

TEST_CASE("lines may end as on Windows, and the resolution line may have spaces", "[codec][hdr]") {
  const Image image;
  for (const std::string header :
       {"#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 8 +X 16\r\n", "#?RADIANCE\n\n-Y8+X16\n",
        "#?RADIANCE\nFORMAT= 32-bit_rle_rgbe \n\n  -Y   8\t+X 16  \n"}) {
    CAPTURE(header);
    const std::vector<char> sound = hdr_bytes({16, 8}, image.texels());
    std::vector<char> bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), sound.begin() + static_cast<std::ptrdiff_t>(hdr_header({16, 8}).size()), sound.end());
    write_bytes(image.path(), bytes);
    CHECK(unchanged(image, read_environment(image.path())));
  }
}

TEST_CASE("exposures and colour corrections are divided out, all of them", "[codec][hdr]") {
  const Image image;
  const Environment read =
      image.read({"EXPOSURE=2.0", kRgbe, "EXPOSURE= 4", "COLORCORR= 1 0.5 +2e0", "COLORCORR=3 1 1"});
  const std::vector<float> stored = image.values();
  const double divisors[] = {24.0, 4.0, 16.0};
  for (std::size_t i = 0; i < stored.size(); ++i) {
    REQUIRE(read.pixels[i] == static_cast<float>(static_cast<double>(stored[i]) / divisors[i % 3]));
  }
  CHECK(notes_say(read, "divided by 24 4 16, the product of the header's EXPOSURE and COLORCORR lines"));
  CHECK(notes_say(image.read({"EXPOSURE=0.25", "EXPOSURE=0.5"}), "divided by 0.125,"));
  const Environment cancelled = image.read({"EXPOSURE=4", "EXPOSURE=0.25"});
  CHECK(unchanged(image, cancelled));
  CHECK(cancelled.info.notes.empty());
}

TEST_CASE("XYZE becomes Rec. 709, or stays as stored", "[codec][hdr]") {
  const Image image;
  const std::vector<float> stored = image.values();
  const Environment as_stored = image.read({"FORMAT=32-bit_rle_xyze"}, Primaries::as_stored);
  CHECK(unchanged(image, as_stored));
  CHECK(as_stored.info.channels[0].name == "X");
  CHECK(as_stored.info.channels[0].type == ChannelType::xyze);
  const Environment read = image.read({"FORMAT=32-bit_rle_xyze"});
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
  const Image image;
  const std::string rec709 = "PRIMARIES=0.640 0.330 0.300 0.600 0.150 0.060 0.3127 0.3290";
  CHECK(unchanged(image, image.read({rec709})));
  // Rec. 2020, the same white: grey stays grey, and pure red leaves Rec. 709 (ITU-R BT.2087: 1.6605 -0.1246 -0.0182).
  const std::string rec2020 = "PRIMARIES= 0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290";
  CHECK(unchanged(image, image.read({rec2020}, Primaries::as_stored)));
  HdrRecipe recipe{2, 1};
  recipe.lines = {rec2020};
  write_bytes(image.path(), hdr_bytes(recipe, {{128, 128, 128, 129}, {128, 0, 0, 129}}));
  const Environment read = read_environment(image.path());
  const double wanted[] = {1.0, 1.0, 1.0, 1.6605, -0.1246, -0.0182};
  for (int i = 0; i < 6; ++i) {
    CHECK(std::abs(static_cast<double>(read.pixels[static_cast<std::size_t>(i)]) - wanted[i]) < 1e-4);
  }
  REQUIRE(read.info.notes.size() == 1);
  CHECK(read.info.notes[0] == "primaries were converted to Rec. 709 from Rec. 2020 (the header's PRIMARIES line)");
  const Environment pointless = image.read({"PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3"});
  CHECK(unchanged(image, pointless));
  CHECK(notes_say(pointless, "primaries that span no colours are ignored"));
}

// Promises: a Radiance image that is not read is refused by a code and a message with the file's name, the offset in
// it, what was found, and what would do.

namespace {

using namespace std::string_literals;

void check_refusal(const std::string& content, ErrorCode code, const std::string& found, const std::string& remedy) {
  const TemporaryFile path("sky.hdr");
  write_bytes(path, {content.begin(), content.end()});
  check_thrown([&] { (void)read_environment(path, kLatLong); }, code, {path.string() + ": ", found, remedy});
}

// A whole sound header but for one line.
std::string with_line(const std::string& line) { return "#?RADIANCE\n" + line + "\n\n-Y 1 +X 2\n12341234"; }

std::string with_resolution(const std::string& line) { return "#?RADIANCE\n\n" + line + "\n12341234"; }

}  // namespace

TEST_CASE("damaged Radiance headers are refused by what is wrong with them", "[codec][hdr]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  check_refusal("#?RADIANCE", corrupt, "ends within its Radiance header", "fetch or export it again");
  check_refusal("#?RADIANCE\n\n", corrupt, "ends within its Radiance header", "fetch or export it again");
  check_refusal("#?" + std::string(70000, 'x'), corrupt, "no end within 65536 bytes", "is it a Radiance image?");
  check_refusal("#?RADIANCE\n" + std::string(70000, '\n'), corrupt, "resolution line is \"\"",
                "like \"-Y 512 +X 1024\"");
  std::string lines = "#?RADIANCE\n";
  for (int i = 0; i < 20000; ++i) {
    lines += "A=1\n";
  }
  check_refusal(lines + "\n-Y 1 +X 2\n12341234", corrupt, "no end within 65536 bytes", "");

  check_refusal(with_line("FORMAT=Radiance_spectra"), ErrorCode::unsupported_file, "format is \"Radiance_spectra\"",
                "ra_xyze");
  check_refusal(with_line("FORMAT="), ErrorCode::unsupported_file, "format is \"\"", "are read");
  check_refusal(with_line("EXPOSURE=bright"), corrupt, "\"EXPOSURE=bright\" should have 1 number",
                "correct or remove it");
  check_refusal(with_line("EXPOSURE=1 2"), corrupt, "has more than 1 number", "correct or remove it");
  check_refusal(with_line("COLORCORR=1 2"), corrupt, "\"COLORCORR=1 2\" should have 3 numbers", "correct or remove it");
  check_refusal(with_line("PRIMARIES=1 2 3"), corrupt, "should have 8 numbers", "correct or remove it");
  for (const std::string value : {"-1", "1e-31", "1e31"}) {
    check_refusal(with_line("EXPOSURE=" + value), corrupt, "leaves no radiance to find", "from 1e-30 to 1e30");
  }
  check_refusal(with_line("EXPOSURE=1e20\nEXPOSURE=1e20"), corrupt, "leaves no radiance to find", "correct or remove");
  for (const std::string value : {"nan", "inf", "1e999", "0x10", "", "--1", "\x01\xff"}) {
    check_refusal(with_line("EXPOSURE=" + value), corrupt, "1 number", "correct or remove it");
  }
}

TEST_CASE("Radiance resolution lines out of bounds are refused", "[codec][hdr]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  const ErrorCode unsupported = ErrorCode::unsupported_file;
  for (const std::string line : {"512 1024", "-Y 1", "-Y 1 -Y 2", "-X 1 +X 2", "Y 1 X 2", "-Z 1 +X 2", "-y 1 +x 2",
                                 "FORMAT=32-bit_rle_rgbe", "-", "+Y"}) {
    check_refusal(with_resolution(line), corrupt, "resolution line", "");
  }
  check_refusal(with_resolution("-Y 1 +X 2 3"), corrupt, "with something behind the two numbers", "");
  check_refusal(with_resolution("-Y 1 +X 2x"), corrupt, "with something behind the two numbers", "");
  check_refusal(with_resolution("-Y 0 +X 2"), corrupt, "height is not a positive number", "\"-Y 0 +X 2\"");
  check_refusal(with_resolution("-Y 1 +X -2"), corrupt, "width is not a positive number", "");
  check_refusal(with_resolution("-Y 1 +X"), corrupt, "width is not a positive number", "");
  check_refusal(with_resolution("-Y 1.5 +X 2"), corrupt, "resolution line", "");
  check_refusal(with_resolution("-Y 1 +X 65537"), unsupported, "width is above 65536", "reduce the image first");
  check_refusal(with_resolution("-Y 98305 +X 1"), unsupported, "height is above 98304", "reduce the image first");
  check_refusal(with_resolution("-Y 1 +X 99999999999999999999"), unsupported, "width is above 65536", "reduce");
  check_refusal(with_resolution("-Y 4294967297 +X 4294967296"), unsupported, "height is above 98304", "reduce");
  check_refusal(with_resolution("-Y 32768 +X 65536"), corrupt,
                "32768 scanlines of 65536 texels take at least 262144 bytes, 8 follow", "fetch or export it again");
}

TEST_CASE("damaged Radiance scanlines are refused by where and how", "[codec][hdr]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  const std::string header = hdr_header({10, 2});
  const std::string offset = std::to_string(header.size() + 4);
  const std::string remedy = "fetch or export the file again";
  const std::string row = "\x02\x02\x00\x0a\x8a\x11\x8a\x22\x8a\x33\x8a\x80"s;
  check_refusal(header + row + row.substr(0, 11), corrupt,
                "scanline 1 of 2, at byte " + std::to_string(header.size() + 23) + ": the file ends", remedy);
  check_refusal(header + row + "\x02\x02\x00\x0b"s + row, corrupt,
                "scanline 1 of 2, at byte " + std::to_string(header.size() + 12) +
                    ": it says that it has 11 texels, and must have 10",
                remedy);
  check_refusal(
      header + "\x02\x02\x00\x0a\x8b\x11"s + row + row, corrupt,
      "scanline 0 of 2, at byte " + std::to_string(header.size() + 5) + ": a run of 11 values where 10 of 10 are left",
      remedy);
  check_refusal(header + "\x02\x02\x00\x0a\x05\x11\x11\x11\x11\x11\x06"s + row + row, corrupt,
                "a run of 6 values where 5 of 10 are left", remedy);
  check_refusal(header + "\x01\x01\x01\x05"s + row + row, corrupt, "starts with a repeat", remedy);
  check_refusal(header + "\x80\x40\x20\x81\x01\x01\x01\x0a"s + row + row, corrupt,
                "repeated 10 times where 9 of 10 are left", remedy);
  std::string shifted = header + "\x80\x40\x20\x81"s;
  for (int i = 0; i < 50; ++i) {
    shifted += "\x01\x01\x01"s + '\0';
  }
  check_refusal(shifted + "\x01\x01\x01\xff"s + row + row, corrupt, "repeated 4278190080 times where 9 of 10", remedy);
}

TEST_CASE("an image of columns is refused where decoding it whole takes too much", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  write_bytes(path, hdr_bytes({512, 256, HdrForm::new_rle, true}, some_rgbe(512, 256)));
  ReadOptions options{.memory_limit_bytes = 512 * 256 * 4};
  CHECK(inspect_environment(path, options).width == 512);
  check_thrown(
      [&] { (void)measure_environment(path, options); }, ErrorCode::limit_exceeded,
      {path.string() + ": decoding ", "save it as -Y +X: its scanlines are columns, so that it must be decoded whole"});
  options.memory_limit_bytes = 1U << 20U;
  CHECK(measure_environment(path, options).texels == 512 * 256);
}

TEST_CASE("what a Radiance reader holds does not depend on what the header claims", "[codec][hdr]") {
  const TemporaryFile path("sky.hdr");
  // The smallest file that may be 65536 x 32768: its rows are damaged, and nothing is allocated to find that out.
  std::string content = hdr_header({65536, 32768});
  content += std::string(262144, '\x01');
  write_bytes(path, {content.begin(), content.end()});
  CHECK(thrown_by([&] { (void)files::open_row_source(path, {}); }).says("starts with a repeat"));
  content = hdr_header({65536, 32768});
  for (int i = 0; i < 4096; ++i) {
    content += "\x80\x40\x20\x81\x01\x01\x01\xff\x01\x01\x01\xff"s;
  }
  content += std::string(262144, '\x01');
  write_bytes(path, {content.begin(), content.end()});
  const auto source = files::open_row_source(path, {});
  CHECK(source->traits().reader_bytes < std::uint64_t{1} << 20U);
  const ThrownError error = thrown_by([&] {
    std::vector<float> row(std::size_t{3} * 65536);
    source->open_reader()->read(32767, 1, row.data());
  });
  CHECK(error.says("scanline 4096 of 32768"));
}

// The kernel of Radiance images: mantissas and exponents to floats.

// Promises: every mantissa with every exponent becomes the float that its definition says, at any length, on every
// instruction set, and nothing else is written.

namespace {

constexpr int kGuards = 16;
constexpr float kUntouched = -1.0F;

/// Converts the texels, which the kernel gets as four planes.
void check(const std::vector<Rgbe>& texels) {
  std::vector<std::uint8_t> planes;
  for (std::size_t component = 0; component < 4; ++component) {
    for (const Rgbe& texel : texels) planes.push_back(texel[component]);
  }
  std::vector<float> wanted = decoded(texels);
  wanted.insert(wanted.end(), kGuards, kUntouched);
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(texels.size(), static_cast<int>(set));
    std::vector<float> rgb(wanted.size(), kUntouched);
    files::hdr_kernels(set).floats_from_rgbe(planes.data(), static_cast<int>(texels.size()), rgb.data());
    CHECK(same_bits(wanted, rgb.data()));
  }
}

}  // namespace

TEST_CASE("every mantissa with every exponent is the float that it stands for", "[codec][hdr][kernels]") {
  for (int exponent = 0; exponent < 256; ++exponent) {
    std::vector<Rgbe> texels;
    for (int k = 0; k < 256; ++k) {
      texels.push_back({static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(k + 85),
                        static_cast<std::uint8_t>(k + 170), static_cast<std::uint8_t>(exponent)});
    }
    check(texels);
  }
}

TEST_CASE("runs of RGBE of any length are converted, and nothing behind them is written", "[codec][hdr][kernels]") {
  for (const int length : {1, 2, 3, 7, 13, 14, 15, 16, 17, 18, 19, 31, 32, 33, 34, 63, 64, 65, 257}) {
    std::vector<Rgbe> texels(static_cast<std::size_t>(length));
    int k = 0;
    for (Rgbe& texel : texels) {
      for (std::uint8_t& byte : texel) {
        byte = static_cast<std::uint8_t>(37 * k + k / 11);
        ++k;
      }
    }
    check(texels);
  }
}

}  // namespace welkin::test
