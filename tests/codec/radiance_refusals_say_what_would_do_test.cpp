// Promises: a Radiance picture that is not read is refused by a code and a message with the file's name, the place in
// it, what was found, and what would do.
#include "codec/row_source.h"
#include "support/catch.h"
#include "support/hdr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

using namespace std::string_literals;

const ReadOptions kLatLong{Layout::lat_long};

void check_refusal(const std::string& content, ErrorCode code, const std::string& found, const std::string& remedy) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  test::write_bytes(path, {content.begin(), content.end()});
  const test::ThrownError error = test::thrown_by([&] { (void)read_environment(path, kLatLong); });
  INFO(error.message);
  CHECK(error.code == code);
  CHECK(error.says(path.string() + ": "));
  CHECK(error.says(found));
  CHECK(error.says(remedy));
}

// A whole sound header but for one line.
std::string with_line(const std::string& line) { return "#?RADIANCE\n" + line + "\n\n-Y 1 +X 2\n12341234"; }

std::string with_resolution(const std::string& line) { return "#?RADIANCE\n\n" + line + "\n12341234"; }

}  // namespace

TEST_CASE("damaged Radiance headers are refused by what is wrong with them", "[codec][hdr]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  check_refusal("#?RADIANCE", corrupt, "ends within its Radiance header", "fetch or export it again");
  check_refusal("#?RADIANCE\n\n", corrupt, "ends within its Radiance header", "fetch or export it again");
  check_refusal("#?" + std::string(70000, 'x'), corrupt, "no end within 65536 bytes", "is it a Radiance picture?");
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
  for (const std::string value : {"0", "-1", "1e-31", "1e31", "-0"}) {
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
  check_refusal(with_resolution("-Y 0 +X 2"), corrupt, "height is no positive number", "\"-Y 0 +X 2\"");
  check_refusal(with_resolution("-Y 1 +X -2"), corrupt, "width is no positive number", "");
  check_refusal(with_resolution("-Y 1 +X"), corrupt, "width is no positive number", "");
  check_refusal(with_resolution("-Y 1.5 +X 2"), corrupt, "resolution line", "");
  check_refusal(with_resolution("-Y 1 +X 65537"), unsupported, "width is above 65536", "reduce the picture first");
  check_refusal(with_resolution("-Y 98305 +X 1"), unsupported, "height is above 98304", "reduce the picture first");
  check_refusal(with_resolution("-Y 1 +X 99999999999999999999"), unsupported, "width is above 65536", "reduce");
  check_refusal(with_resolution("-Y 4294967297 +X 4294967296"), unsupported, "height is above 98304", "reduce");
  check_refusal(with_resolution("-Y 32768 +X 65536"), corrupt,
                "32768 scanlines of 65536 texels take at least 262144 bytes, 8 follow", "fetch or export it again");
}

TEST_CASE("damaged Radiance scanlines are refused by where and how", "[codec][hdr]") {
  const ErrorCode corrupt = ErrorCode::corrupt_file;
  const std::string header = test::hdr_header({10, 2});
  const std::string place = std::to_string(header.size() + 4);
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

TEST_CASE("a picture of columns is refused where decoding it whole takes too much", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  test::write_bytes(path, test::hdr_bytes({512, 256, test::HdrForm::new_rle, true}, test::some_rgbe(512, 256)));
  ReadOptions options;
  options.memory_limit_bytes = 512 * 256 * 4;
  CHECK(inspect_environment(path, options).width == 512);
  CHECK(test::thrown_by([&] { (void)measure_environment(path, options); }).code == ErrorCode::limit_exceeded);
  const test::ThrownError error = test::thrown_by([&] { (void)codec::open_row_source(path, options)->open_reader(); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says(path.string() + ": its scanlines are columns, so that it must be decoded whole"));
  CHECK(error.says("save it as -Y +X"));
  options.memory_limit_bytes = 1U << 20U;
  CHECK(measure_environment(path, options).texels == 512 * 256);
}

TEST_CASE("what a Radiance reader holds does not depend on what the header claims", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  // The smallest file that may be 65536 x 32768: its rows are damaged, and nothing is allocated to find that out.
  std::string content = test::hdr_header({65536, 32768});
  content += std::string(262144, '\x01');
  test::write_bytes(path, {content.begin(), content.end()});
  CHECK(test::thrown_by([&] { (void)codec::open_row_source(path, {}); }).says("starts with a repeat"));
  content = test::hdr_header({65536, 32768});
  for (int i = 0; i < 4096; ++i) {
    content += "\x80\x40\x20\x81\x01\x01\x01\xff\x01\x01\x01\xff"s;
  }
  content += std::string(262144, '\x01');
  test::write_bytes(path, {content.begin(), content.end()});
  const auto source = codec::open_row_source(path, {});
  CHECK(source->reader_bytes() < std::uint64_t{1} << 20U);
  const test::ThrownError error = test::thrown_by([&] {
    std::vector<float> row(std::size_t{3} * 65536);
    source->open_reader()->read(32767, 1, row.data());
  });
  CHECK(error.says("scanline 4096 of 32768"));
}

}  // namespace welkin
