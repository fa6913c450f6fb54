// `welkin convert` and `welkin testmap` refuse what they cannot write before they begin.
#include <fstream>
#include <string>

#include "support/catch.h"
#include "tools/command.h"
#include "tools/temporary_folder.h"
#include "welkin/environment_writer.h"
#include "welkin/error.h"
#include "welkin/image.h"

using namespace welkin::test;

TEST_CASE("command: convert refuses an OUT that cannot be written before it decodes IN", "[tools][convert]") {
  const TemporaryFolder folder;
  // A sound header and first scanline (its form is looked at when the file is opened), and no sound one after that:
  // whoever decodes it says so instead.
  const auto in = folder.path() / "in.hdr";
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10 +X 20\n";
  bytes += {'\2', '\2', '\0', '\24'};
  for (int component = 0; component < 4; ++component) bytes += {static_cast<char>(128 + 20), '\x80'};
  std::ofstream(in, std::ios::binary) << bytes << std::string(800, '\2');
  const auto refusal = [&](const std::string& out, int code) {
    const CommandResult result = run_welkin("convert " + quoted(in) + " " + out);
    CHECK(result.exit_code == code);
    return result.errors;
  };
  CHECK(contains(refusal(quoted(folder.path() / "out.exr"), 1), "in.hdr"));
  CHECK(contains(refusal("x.jpg", 1), "\".jpg\" is not written"));
  CHECK(contains(refusal("x.png --type half", 2), "PNG is written with 8 or 16 bits"));
  CHECK(contains(refusal(quoted(folder.path() / "nowhere" / "x.exr"), 1), "its folder is not there"));
}

TEST_CASE("command: testmap keeps to a memory limit", "[tools][convert]") {
  const TemporaryFolder folder;
  const std::string out = "testmap -o " + quoted(folder.path() / "map.exr");
  const CommandResult result = run_welkin(out + " --size 65536");
  CHECK(result.exit_code == 1);
  CHECK(contains(result.errors, "above the limit of 8589934592; ask for a smaller --size or raise --memory-limit"));
  CHECK(run_welkin(out + " --size 256 --memory-limit 100KiB").exit_code == 1);
  CHECK(run_welkin(out + " --size 64 --memory-limit 100KiB").exit_code == 0);
}

TEST_CASE("a horizontal strip that nobody could read is not written", "[writers]") {
  const TemporaryFolder folder;
  std::vector<float> row(3 * 16384, 0.5F);
  // Refused before any pixel is looked at.
  welkin::CubemapView view{{}, 10923, 0, welkin::PixelFormat::rgb_f32};
  view.faces.fill(row.data());
  welkin::WriteOptions options;
  options.layout = welkin::Layout::horizontal_strip;
  try {
    welkin::write_environment(folder.path() / "strip.pfm", view, options);
    FAIL("it was written");
  } catch (const welkin::Error& error) {
    CHECK(error.code() == welkin::ErrorCode::invalid_argument);
    CHECK(contains(error.what(), "65538 texels wide, above the 65536 that are read"));
  }
}
