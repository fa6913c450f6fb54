
#include "places.h"
#include "support/catch.h"
#include "support/damaged_files.h"
#include "support/exr_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/trials.h"
#include "tools/command.h"
#include "welkin/image.h"

using namespace welkin::test;

// `welkin info` reports the content of a file unchanged.

namespace {

nlohmann::json info_json(const std::filesystem::path& file) { return json_printed_by("info --json " + quoted(file)); }

/// 16 x 8, grey 0.5, with a NaN, an infinity, a negative and a bright texel (column 4, row 3).
std::filesystem::path odd_file(const TemporaryDirectory& folder) {
  std::vector<float> rgb = grey_image(16, 8, 0.5F);
  rgb[0] = std::numeric_limits<float>::quiet_NaN();
  rgb[4] = -std::numeric_limits<float>::infinity();
  rgb[8] = -0.25F;
  rgb[(3 * 16 + 4) * 3 + 1] = 100.0F;
  auto path = folder.path() / "odd.pfm";
  write_pfm(path, 16, 8, rgb);
  return path;
}

}  // namespace

TEST_CASE("info --json: counts, extremes and the brightest texel", "[tools]") {
  const TemporaryDirectory folder;
  const nlohmann::json document = info_json(odd_file(folder));
  CHECK(document.at("source").at("width") == 16);
  CHECK(document.at("source").at("height") == 8);
  CHECK(document.at("source").at("format") == "PFM");
  CHECK(!document.at("channels").empty());
  const auto& pixels = document.at("pixels");
  CHECK(pixels.at("texels") == 128);
  CHECK(pixels.at("nans") == 1);
  CHECK(pixels.at("infinities") == 1);
  CHECK(pixels.at("negatives") == 1);
  CHECK(pixels.at("minimum").at(2) == -0.25);
  CHECK(pixels.at("maximum").at(1) == 100.0);
  const auto& brightest = document.at("brightest");
  CHECK(brightest.at("column") == 4);
  CHECK(brightest.at("row") == 3);
  // Column 4.5 of 16 lies at longitude pi - 2 pi 4.5/16, row 3.5 of 8 at latitude pi/2 - pi 3.5/8.
  const double longitude = std::numbers::pi * (1.0 - 9.0 / 16.0);
  const double latitude = std::numbers::pi / 16.0;
  CHECK(std::abs(brightest.at("direction").at(0).get<double>() - std::sin(longitude) * std::cos(latitude)) < 1e-12);
  CHECK(std::abs(brightest.at("direction").at(1).get<double>() - std::sin(latitude)) < 1e-12);
}

TEST_CASE("info --json: total radiance is 4 pi times the mean", "[tools]") {
  const TemporaryFile file("strip.pfm");
  write_pfm(file, 5, 30, grey_image(5, 30, 3.0F));
  const nlohmann::json document = info_json(file);
  CHECK(document.at("source").at("layout") == "vertical-strip");
  CHECK(std::abs(document.at("pixels").at("mean").at(0).get<double>() - 3.0) < 1e-9);
  CHECK(std::abs(document.at("pixels").at("total_radiance").at(0).get<double>() - 12.0 * std::numbers::pi) < 1e-8);
}

// The command meets damaged files: it reads them or says in one line why not, within 512 MB and ten seconds.

#if defined(__SANITIZE_ADDRESS__)
#define WELKIN_LIMIT "0"  // address space is not theirs to save: the sanitizer itself counts what is resident
#define WELKIN_SANITIZER_LIMIT "ASAN_OPTIONS=hard_rss_limit_mb=512:allocator_may_return_null=0 "
#elif defined(__SANITIZE_THREAD__)
#define WELKIN_LIMIT "0"
#define WELKIN_SANITIZER_LIMIT ""
#else
#define WELKIN_LIMIT "524288"
#define WELKIN_SANITIZER_LIMIT ""
#endif

namespace {

/// Writes all sound files and evenly chosen damaged copies, a few of each kind unless a full run is requested:
/// tests/files/hostile_files_test.cpp reads the same files in its own process with each cut, byte and field damaged.
int write_corpus(const std::filesystem::path& folder, const std::filesystem::path& scratch) {
  const auto files_of_a_kind = static_cast<std::size_t>(24 / stride(6));
  int written = 0;
  for (const SoundFile& sound : sound_files(scratch)) {
    std::vector<std::vector<char>> all;
    for_each_damage(sound, [&](const std::vector<char>& bytes) { all.push_back(bytes); });
    write_bytes(folder / ("sound-" + sound.name), sound.bytes);
    ++written;
    for (std::size_t i = 0; i < files_of_a_kind; ++i, ++written) {
      const std::size_t which = (2 * i + 1) * all.size() / (2 * files_of_a_kind);
      write_bytes(folder / (std::to_string(which) + "-" + sound.name), all[which]);
    }
  }
  return written;
}

}  // namespace

TEST_CASE("command: damaged files within 512 MB", "[tools][damage][posix][slow]") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("corpus"));
  const int files = write_corpus(directory.file("corpus"), directory.file(""));
  const CommandResult result = run_script(
      "cd " + quoted(directory.file("corpus")) + " && ls | " WELKIN_SANITIZER_LIMIT "xargs -P 2 -I{} " +
      quoted(WELKIN_TEST_DATA "/../tools/run_limited.sh") + " " + quoted(WELKIN_COMMAND) + " " WELKIN_LIMIT " {}");
  CHECK(result.exit_code == 0);
  std::istringstream results(result.output);
  int runs = 0;
  for (std::string line; std::getline(results, line); ++runs) {
    INFO("file, command, exit code, lines on standard error, their first word: " << line);
    std::istringstream words(line);
    std::string file;
    std::string command;
    std::string first;
    int code = -1;
    int lines = -1;
    words >> file >> command >> code >> lines >> first;
    CHECK((code == 0 || code == 1 || code == 2));
    CHECK(lines == (code == 0 ? 0 : 1));
    CHECK((code == 0 || first == "welkin:"));
    if (file.rfind("sound-", 0) == 0) CHECK(code == 0);
  }
  CHECK(runs == 2 * files);
}
