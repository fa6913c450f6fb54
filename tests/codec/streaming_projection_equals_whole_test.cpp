// Promises: projecting a file while it is decoded gives the same bits as reading it whole and projecting that, on any
// number of threads and however the file is cut; what was done is on record; cancelling and progress work.
#include <algorithm>
#include <stop_token>
#include <tuple>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"

namespace welkin {
namespace {

test::ExrRecipe lat_long_recipe(int width, int height, Imf::Compression compression,
                                const std::optional<Imf::TileDescription>& tiles) {
  test::ExrRecipe recipe{width, height, 0, 0, compression, Imf::INCREASING_Y, tiles, std::nullopt, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  return recipe;
}

bool same_coefficients(const Projection& a, const Projection& b) {
  const auto left = a.radiance.coefficients();
  const auto right = b.radiance.coefficients();
  return std::equal(left.begin(), left.end(), right.begin(), right.end());
}

const PassRecord* find_pass(const Projection& projection, const std::string& pass) {
  const std::vector<PassRecord>& passes = projection.diagnostics.passes;
  const auto found =
      std::find_if(passes.begin(), passes.end(), [&](const PassRecord& record) { return record.name == pass; });
  return found == passes.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("a streamed lat-long has the bits of one that is read whole", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  for (const auto& [width, height] : {std::pair{640, 320}, {514, 257}, {30, 15}}) {
    const std::vector<float> pixels = test::some_pixels(width, height);
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::DWAB_COMPRESSION}) {
      for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(48, 40)},
                                std::optional{Imf::TileDescription(4096, 4096)}}) {
        CAPTURE(width, height, compression, tiles.has_value());
        test::write_exr(path, lat_long_recipe(width, height, compression, tiles), pixels);
        const Environment whole = read_environment(path);
        const Projection wanted = project(whole.lat_long());
        for (const int threads : {1, 2, 5}) {
          run_with_threads(threads, [&] { CHECK(same_coefficients(project_file(path), wanted)); });
        }
      }
    }
  }
}

TEST_CASE("a strip from a file is projected as its cubemap", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("strip.pfm");
  test::write_bytes(path, test::pfm_bytes(48, 288, false, "-1", test::some_pixels(48, 288)));
  const Environment whole = read_environment(path);
  const Projection found = project_file(path);
  CHECK(same_coefficients(found, project(whole.cubemap())));
  const PassRecord* read = find_pass(found, "read");
  REQUIRE(read != nullptr);
  CHECK(read->action == "run");
  CHECK(read->reason == "PFM, scanline, none; a cubemap is held whole");
}

TEST_CASE("the passes of a streamed projection are on record", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.exr");
  test::write_exr(path, lat_long_recipe(64, 32, Imf::ZIP_COMPRESSION, std::nullopt), test::some_pixels(64, 32));
  const Projection found = project_file(path);
  const PassRecord* read = find_pass(found, "read");
  REQUIRE(read != nullptr);
  CHECK(read->action == "run");
  CHECK(read->reason.find("OpenEXR, scanline, zip") == 0);
  CHECK(read->reason.find("overlapped") != std::string::npos);
  CHECK(read->milliseconds > 0.0);
  const PassRecord* projected = find_pass(found, "project");
  REQUIRE(projected != nullptr);
  CHECK(projected->action == "run");
  const PassRecord* cubemap = find_pass(found, "cubemap");
  REQUIRE(cubemap != nullptr);
  CHECK(cubemap->action == "skip");
  CHECK(cubemap->reason == "a lat-long is projected directly");
}

TEST_CASE("progress rises to 1, and a stop token ends the call", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path sky = directory.file("sky.exr");
  const std::filesystem::path strip = directory.file("strip.pfm");
  test::write_exr(sky, lat_long_recipe(512, 256, Imf::ZIPS_COMPRESSION, std::nullopt), test::some_pixels(512, 256));
  test::write_bytes(strip, test::pfm_bytes(120, 720, false, "-1", test::some_pixels(120, 720)));
  for (const std::filesystem::path& path : {sky, strip}) {
    CAPTURE(path.string());
    std::vector<double> reports;
    Control control;
    control.progress = [&](double done) { reports.push_back(done); };
    (void)project_file(path, {}, {}, control);
    REQUIRE(!reports.empty());
    CHECK(std::is_sorted(reports.begin(), reports.end()));
    CHECK(reports.back() == 1.0);

    std::stop_source source;
    control.stop = source.get_token();
    control.progress = [&](double) { source.request_stop(); };
    const test::ThrownError error = test::thrown_by([&] { (void)project_file(path, {}, {}, control); });
    CHECK(error.code == ErrorCode::cancelled);
    CHECK(test::thrown_by([&] { (void)read_environment(path, {}, control); }).code == ErrorCode::cancelled);
    CHECK(test::thrown_by([&] { (void)measure_environment(path, {}, control); }).code == ErrorCode::cancelled);
    CHECK(read_environment(path).pixels != nullptr);
  }
}

TEST_CASE("a rejected pixel is reported with its file", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("broken.pfm");
  std::vector<float> pixels = test::some_pixels(64, 32);
  pixels[3 * (64 * 20 + 7) + 1] = -1.0F;
  test::write_bytes(path, test::pfm_bytes(64, 32, false, "-1", pixels));
  ProjectionOptions options;
  options.negative = NegativePolicy::reject;
  const test::ThrownError error = test::thrown_by([&] { (void)project_file(path, {}, options); });
  INFO(error.message);
  CHECK(error.code == ErrorCode::rejected_pixel);
  CHECK(error.says(path.string() + ": "));
  CHECK(error.says("7"));
  CHECK(error.says("20"));
}

TEST_CASE("damage in the middle of a file is an error, not a half result", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("damaged.exr");
  test::write_exr(path, lat_long_recipe(640, 320, Imf::ZIP_COMPRESSION, std::nullopt), test::some_pixels(640, 320));
  std::vector<char> bytes = test::read_bytes(path);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 5000, '\x55');
  test::write_bytes(path, bytes);
  for (const int threads : {1, 2}) {
    run_with_threads(threads, [&] {
      const test::ThrownError error = test::thrown_by([&] { (void)project_file(path); });
      CHECK(error.code == ErrorCode::corrupt_file);
      CHECK(error.says(path.string() + ": "));
    });
  }
}

}  // namespace welkin
