// `welkin info` tells what is in a file, as it is there.
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.h"
#include "tools/command.h"
#include "tools/pfm_file.h"
#include "tools/temporary_folder.h"

using namespace welkin::test;

namespace {

nlohmann::json info_json(const std::filesystem::path& file) {
  const CommandResult result = run_welkin("info --json " + quoted(file));
  INFO("standard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return nlohmann::json::parse(result.output);
}

/// 16 x 8, grey 0.5, with a NaN, an infinity, a negative and a bright texel (column 4, row 3).
std::filesystem::path odd_file(const TemporaryFolder& folder) {
  std::vector<float> rgb = grey_picture(16, 8, 0.5F);
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
  const TemporaryFolder folder;
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

TEST_CASE("info --json: flux is 4 pi times the mean", "[tools]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "strip.pfm";
  write_pfm(file, 5, 30, grey_picture(5, 30, 3.0F));
  const nlohmann::json document = info_json(file);
  CHECK(document.at("source").at("layout") == "vertical-strip");
  CHECK(std::abs(document.at("pixels").at("mean").at(0).get<double>() - 3.0) < 1e-9);
  CHECK(std::abs(document.at("pixels").at("flux").at(0).get<double>() - 12.0 * std::numbers::pi) < 1e-8);
}

TEST_CASE("info: a table for a person", "[tools]") {
  const TemporaryFolder folder;
  const CommandResult result = run_welkin("info " + quoted(odd_file(folder)));
  CHECK(result.exit_code == 0);
  CHECK(result.errors.empty());
  for (const char* part : {"16 x 8", "lat-long", "PFM", "1 NaN", "1 infinite value", "1 negative value",
                           "column 4, row 3", "degrees up", "integral over the sphere"}) {
    INFO(part);
    CHECK(contains(result.output, part));
  }
}
