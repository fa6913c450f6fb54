
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "tools/command.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

using namespace welkin;
using namespace welkin::test;

// `welkin convert` and `welkin testmap`: the files and messages that they write, and the files that they leave alone.

TEST_CASE("command: convert leaves every texel as it is where nothing asks for more", "[tools][convert]") {
  const TemporaryDirectory directory;
  const auto in = directory.file("in.pfm");
  write_pfm(in, 32, 16, some_pixels(32, 16));
  for (const std::string out : {"a.exr --type float", "b.pfm", "c.exr --type float --layout lat-long --size 32"}) {
    const auto path = directory.file(out.substr(0, 5));
    const std::string said = printed_by("convert " + quoted(in) + " " + quoted(path) + out.substr(5));
    CHECK(said == path.string() + ": lat-long, 32 x 16\n");
    CHECK(pixels_in(path) == some_pixels(32, 16));
  }
}

TEST_CASE("command: convert goes through every layout of a cube and back", "[tools][convert]") {
  const TemporaryDirectory directory;
  const auto first = directory.file("first.pfm");
  printed_by("testmap -o " + quoted(first) + " --size 8 --layout vertical-strip");
  const std::vector<float> wanted = pixels_in(first);
  for (const std::string layout :
       {"vertical-strip", "horizontal-strip", "horizontal-cross", "vertical-cross", "six-files"}) {
    CAPTURE(layout);
    const auto there = directory.file("there.exr");
    const std::string said =
        printed_by("convert " + quoted(first) + " " + quoted(there) + " --type float --layout " + layout);
    const auto from = layout == "six-files" ? directory.file("there_px.exr") : there;
    CHECK(contains(said, from.string() + ": "));
    printed_by("convert " + quoted(from) + " " + quoted(directory.file("back.pfm")) + " --in-layout " + layout);
    CHECK(pixels_in(directory.file("back.pfm")) == wanted);
  }
}

TEST_CASE("command: convert turns, mirrors and resizes as the library does", "[tools][convert][slow]") {
  const TemporaryDirectory directory;
  const auto in = directory.file("in.pfm");
  const auto out = directory.file("out.pfm");
  printed_by("testmap -o " + quoted(in) + " --size 64");
  const Environment source = read_environment(in);
  const auto converted = [&](const std::string& options) {
    printed_by("convert " + quoted(in) + " " + quoted(out) + " " + options);
    return pixels_in(out);
  };
  glm::dmat3 mirror(1.0);
  mirror[0][0] = -1.0;
  CHECK(converted("--yaw -90") == to_lat_long(source.lat_long(), 64, 32, rotation_about_y(-90.0)).pixels);
  CHECK(converted("--mirror --yaw 33") ==
        to_lat_long(source.lat_long(), 64, 32, rotation_about_y(33.0) * mirror).pixels);
  CHECK(converted("--rotation 0,1,0,1") == to_lat_long(source.lat_long(), 64, 32, rotation_about_y(90.0)).pixels);
  CHECK(converted("--size 20") == to_lat_long(source.lat_long(), 20, 10).pixels);
  CHECK(std::ranges::equal(converted("--layout vertical-strip"), to_cubemap(source.lat_long(), 16).pixels()));
  CHECK(std::ranges::equal(converted("--layout vertical-strip --size 5 --threads 2"),
                           to_cubemap(source.lat_long(), 5).pixels()));
}

TEST_CASE("command: convert --tone-map makes a PNG exposed and tone mapped as the previews are", "[tools][convert]") {
  const TemporaryDirectory directory;
  const auto in = directory.file("in.pfm");
  const auto out = directory.file("out.png");
  std::vector<float> pixels = grey_image(64, 32, 20.0F);
  std::fill_n(pixels.begin(), 3 * 64 * 8, 400.0F);  // a quarter of the rows, less of the sphere
  write_pfm(in, 64, 32, pixels);
  const std::string plain = printed_by("convert " + quoted(in) + " " + quoted(out));
  CHECK(contains(plain, "range, clamped; --tone-map makes an image for viewing"));
  const auto shown = [&](double exposure, double radiance) {
    const double x = exposure * radiance;
    return std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
  };
  const auto check = [&](const std::string& options, double exposure, double first = 400.0) {
    INFO(options);
    CHECK_FALSE(contains(printed_by("convert " + quoted(in) + " " + quoted(out) + " --tone-map" + options), "clamped"));
    const std::vector<float> seen = pixels_in(out);
    CHECK(static_cast<double>(seen.front()) == Approx(shown(exposure, first)).epsilon(0.02));
    CHECK(static_cast<double>(seen.back()) == Approx(shown(exposure, 20.0)).epsilon(0.02));
  };
  check("", 0.36 / 20.0);  // the 75th percentile of what is lit: the larger part
  check(" --exposure -7", 1.0 / 128.0);
  check(" --exposure -7 --size 32", 1.0 / 128.0);
  check(" --layout vertical-strip", 0.36 / 20.0, 20.0);  // which begins below the bright rows
  const std::string previews = quoted(in) + " --size 32 --irradiance 0 --no-brdf --preview-size 16";
  CHECK(bake_into(directory.file("baked"), previews).at("previews").at("exposure").get<double>() ==
        Approx(0.36 / 20.0).epsilon(1e-3));
  CHECK(contains(failure("convert " + quoted(in) + " x.exr --tone-map", 2), "--tone-map is for .png"));
  failure("convert " + quoted(in) + " x.png --exposure 1", 2);
}

TEST_CASE("command: convert refuses with the right exit code", "[tools][convert]") {
  const TemporaryDirectory directory;
  const auto in = directory.file("in.pfm");
  write_pfm(in, 4, 2, grey_image(4, 2, 0.5F));
  const std::string start = "convert " + quoted(in) + " " + quoted(directory.file("out"));
  failure(start + ".gif", 1);
  failure(start + ".hdr --type float", 2);
  failure(start + ".pfm --size 60000 --memory-limit 1MB", 1);
  failure(start + ".pfm --rotation 1,2,3", 2);
  failure(start + ".pfm --rotation 0,0,0,0", 2);
  failure(start + ".pfm --size 0", 2);
  failure(start + ".pfm --yaw nan", 2);
  failure("convert " + quoted(in), 2);
  failure("convert nowhere.exr " + quoted(directory.file("out.exr")), 1);
  failure("testmap -o " + quoted(directory.file("none/out.png")), 1);
}

// `welkin convert` and `welkin testmap` refuse what they cannot write before they begin.

TEST_CASE("command: convert refuses an OUT that cannot be written before it decodes IN", "[tools][convert]") {
  const TemporaryDirectory folder;
  // The header and the first scanline are valid (its form is read when the file is opened), and no later scanline is:
  // decoding would report that error instead.
  const auto in = folder.path() / "in.hdr";
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10 +X 20\n";
  bytes += {'\2', '\2', '\0', '\24'};
  for (int component = 0; component < 4; ++component) bytes += {static_cast<char>(128 + 20), '\x80'};
  std::ofstream(in, std::ios::binary) << bytes << std::string(800, '\2');
  const auto refusal = [&](const std::string& out, int code) {
    return failure("convert " + quoted(in) + " " + out, code);
  };
  CHECK(contains(refusal(quoted(folder.path() / "out.exr"), 1), "in.hdr"));
  CHECK(contains(refusal("x.jpg", 1), "\".jpg\" is not written"));
  CHECK(contains(refusal("x.png --type half", 2), "PNG is written with 8 or 16 bits"));
  CHECK(contains(refusal(quoted(folder.path() / "nowhere" / "x.exr"), 1), "its folder is not there"));
}

// `welkin sample` makes an environment like a photograph's in range, out of nothing, the same everywhere.

namespace {

/// Values of the image that `welkin sample` makes.
std::vector<float> sample(int width) {
  const TemporaryDirectory directory;
  const auto path = directory.file("sample.pfm");
  CHECK(printed_by("sample --size " + std::to_string(width) + " -o " + quoted(path)) ==
        path.string() + ": lat-long, " + std::to_string(width) + " x " + std::to_string(width / 2) + "\n");
  return pixels_in(path);
}

}  // namespace

TEST_CASE("sample: a room with a sun, lamps and dark corners, within what half floats hold", "[tools][sample][slow]") {
  std::vector<float> values = sample(128);
  std::sort(values.begin(), values.end());
  CHECK(values.front() >= 0.0F);
  const float dark = values[values.size() / 100];
  CHECK(dark > 0.0F);
  CHECK(values.back() > 1e4F * dark);
  CHECK(values.back() < 65504.0F);
  const float median = values[values.size() / 2];
  CHECK(median > 0.05F);
  CHECK(median < 2.0F);
}

TEST_CASE("sample: refuses what it cannot write, before it computes", "[tools][sample]") {
  CHECK(run_welkin("sample").exit_code == 2);
  CHECK(run_welkin("sample -o sample.jpg").exit_code == 1);
  CHECK(run_welkin("sample --size 0 -o sample.exr").exit_code == 2);
  CHECK(contains(failure("sample --size 65536 --memory-limit 1MiB -o sample.exr", 1), "--memory-limit"));
}
