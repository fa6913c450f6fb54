// Promises: PFM is read in colour and grey, in both byte orders, in any pieces.
#include <algorithm>
#include <limits>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"

namespace welkin {

TEST_CASE("a colour PFM is read in both byte orders, whatever its scale's size", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.pfm");
  std::vector<float> pixels = test::some_pixels(34, 17);
  pixels[5] = -1.5F;
  pixels[7] = std::numeric_limits<float>::infinity();
  for (const std::string scale : {"-1.0", "1.0", "-1", "+2.5e3", "-0.001", "-1.000000"}) {
    CAPTURE(scale);
    test::write_bytes(path, test::pfm_bytes(34, 17, false, scale, pixels));
    const Environment read = read_environment(path);
    CHECK(read.info.format == "PFM");
    CHECK(read.info.compression == "none");
    CHECK(read.info.storage == "scanline");
    CHECK(read.info.layout == Layout::lat_long);
    REQUIRE(read.info.channels.size() == 3);
    CHECK(read.info.channels[2].name == "B");
    CHECK(read.info.channels[2].type == "float");
    REQUIRE(read.info.width == 34);
    REQUIRE(read.info.height == 17);
    REQUIRE(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));
  }
}

TEST_CASE("a grey PFM gives three equal channels", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("grey.pfm");
  for (const int height : {1, 2, 9}) {
    const std::vector<float> colours = test::some_pixels(2 * height, height);
    const std::vector<float> values(colours.begin(), colours.begin() + 2 * height * height);
    test::write_bytes(path, test::pfm_bytes(2 * height, height, true, height == 2 ? "1" : "-1", values));
    const Environment read = read_environment(path);
    REQUIRE(read.info.channels.size() == 1);
    for (std::size_t i = 0; i < 3 * values.size(); ++i) {
      REQUIRE(read.pixels[i] == values[i / 3]);
    }
  }
}

TEST_CASE("a PFM's header may end with two bytes, as lines do on Windows", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.pfm");
  std::vector<float> pixels = test::some_pixels(4, 2);
  std::vector<char> bytes = test::pfm_bytes(4, 2, false, "-1\r", pixels);
  test::write_bytes(path, bytes);
  const Environment read = read_environment(path);
  CHECK(std::equal(pixels.begin(), pixels.end(), read.pixels.get()));

  // Where the file has no room for it, that byte is the first pixel's.
  bytes.pop_back();
  test::write_bytes(path, bytes);
  CHECK(read_environment(path).pixels[12] != pixels[12]);
}

TEST_CASE("a PFM's rows can be read in any pieces", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("strip.pfm");
  const std::vector<float> pixels = test::some_pixels(4, 24);
  test::write_bytes(path, test::pfm_bytes(4, 24, false, "-1", pixels));
  const auto source = codec::open_row_source(path, {});
  CHECK(source->info().layout == Layout::vertical_strip);
  const auto reader = source->open_reader();
  for (int first = 0; first < 24; ++first) {
    for (int count = 1; first + count <= 24; ++count) {
      std::vector<float> rows(static_cast<std::size_t>(count) * 12);
      reader->read(first, count, rows.data());
      REQUIRE(std::equal(rows.begin(), rows.end(), pixels.begin() + first * 12));
    }
  }
}

}  // namespace welkin
