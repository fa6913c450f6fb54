// Promises: real files, where they are at hand, decode to the pixels that other programs found in them, and those that
// are not read are refused by name.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "support/catch.h"
#include "support/close.h"
#include "support/exr_files.h"
#include "support/npy.h"
#include "support/shared_pictures.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

using test::kPictures;
using test::kVariants;
using test::shared_pictures_are_here;

// Of what a file decodes to against the truth, at `place` of the truth and times `gain`.
double worst_relative_error(const Environment& read, const std::vector<float>& truth, int column, int row, float gain) {
  double worst = 0.0;
  for (int y = 0; y < read.info.height; ++y) {
    for (int x = 0; x < 3 * read.info.width; ++x) {
      const float wanted = gain * truth[static_cast<std::size_t>((y + row) * 256 * 3 + x + 3 * column)];
      const float found = read.pixels[static_cast<std::size_t>(y * 3 * read.info.width + x)];
      worst = std::max(worst, static_cast<double>(std::abs(found - wanted) / wanted));
    }
  }
  return worst;
}

struct Variant {
  const char* name;
  const char* compression;
  double tolerance;  // 0: the same bits
};

}  // namespace

TEST_CASE("one picture in every OpenEXR form is the same picture", "[codec][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const std::vector<float> truth = test::read_npy(kVariants / "truth_256x128.npy");
  REQUIRE(truth.size() == 256 * 128 * 3);
  for (const Variant& variant : {
           Variant{"none_half", "none", 0.0},
           {"rle_half", "rle", 0.0},
           {"zips_half", "zips", 0.0},
           {"zip_half", "zip", 0.0},
           {"piz_half", "piz", 0.0},
           {"pxr24_half", "pxr24", 0.0},
           {"b44_half", "b44", 0.1},
           {"b44a_half", "b44a", 0.1},
           {"dwaa_half", "dwaa", 0.35},
           {"dwab_half", "dwab", 0.35},
           {"none_float", "none", 0.0},
           {"zip_float", "zip", 0.0},
           {"piz_float", "piz", 0.0},
           {"pxr24_float", "pxr24", 0.0},
           {"dwaa_float", "dwaa", 0.35},
           {"tiled32_zip_half", "zip", 0.0},
           {"tiled48x40_piz_float", "piz", 0.0},
           {"mipmap_t16_zip_half", "zip", 0.0},
           {"ripmap_t16_zip_half", "zip", 0.0},
           {"decreasingY_zip_half", "zip", 0.0},
           {"decreasingY_none_float", "none", 0.0},
           {"envattr_latlong", "zip", 0.0},
           {"dataoffset", "zip", 0.0},
           {"rgb_plus_Z", "zip", 0.0},
           {"overscan_data", "zip", 0.0},
           {"layered_names", "zip", 0.0},
           {"multipart", "zip", 0.0},
       }) {
    CAPTURE(variant.name);
    const Environment read = read_environment(kVariants / (std::string(variant.name) + "_256x128.exr"));
    CHECK(read.info.compression == variant.compression);
    CHECK(read.info.layout == Layout::lat_long);
    REQUIRE(read.info.width == 256);
    REQUIRE(read.info.height == 128);
    CHECK(worst_relative_error(read, truth, 0, 0, 1.0F) <= variant.tolerance);
  }
}

TEST_CASE("windows, alpha and grey of the shared pictures", "[codec][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const std::vector<float> truth = test::read_npy(kVariants / "truth_256x128.npy");
  Environment cropped = read_environment(kVariants / "cropped_data_256x128.exr");
  REQUIRE(cropped.info.width == 256);
  for (int texel = 0; texel < 256 * 128; ++texel) {
    const int column = texel % 256;
    const int row = texel / 256;
    const bool stored = column >= 20 && column < 220 && row >= 10 && row < 110;
    for (int i = 3 * texel; i < 3 * texel + 3; ++i) {
      REQUIRE(cropped.pixels[static_cast<std::size_t>(i)] == (stored ? truth[static_cast<std::size_t>(i)] : 0.0F));
    }
  }
  const Environment premultiplied = read_environment(kVariants / "rgba_premult_half_alpha_256x128.exr");
  CHECK(worst_relative_error(premultiplied, truth, 0, 0, 0.5F) == 0.0);

  const Environment grey = read_environment(kVariants / "y_only_256x128.exr");
  const EnvironmentStatistics statistics = measure_environment(kVariants / "y_only_256x128.exr");
  CHECK(grey.pixels[0] == grey.pixels[2]);
  CHECK(statistics.maximum == glm::dvec3(12.375));
}

TEST_CASE("what is odd in a picture's values is counted", "[codec][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const EnvironmentStatistics odd = measure_environment(kVariants / "naninfneg_float_256x128.exr");
  CHECK(odd.nans == 4);
  CHECK(odd.infinities == 6);
  CHECK(odd.negatives == 3);
  CHECK(odd.minimum == glm::dvec3(-1.5));
  CHECK(odd.maximum == glm::dvec3(10.6875, 12.375, 18.25));
}

TEST_CASE("OpenEXR's cubes show the same scene as its lat-longs", "[codec][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const auto compare = [](const std::filesystem::path& cube, const std::filesystem::path& lat_long, double tolerance) {
    CAPTURE(cube.string());
    const EnvironmentInfo info = inspect_environment(cube);
    CHECK(info.layout == Layout::vertical_strip);
    CHECK(info.layout_reason == "the header's envmap attribute says cube");
    const EnvironmentStatistics of_cube = measure_environment(cube);
    const EnvironmentStatistics of_lat_long = measure_environment(lat_long);
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(test::close(of_cube.mean[channel], of_lat_long.mean[channel], tolerance));
    }
    return glm::dot(of_cube.brightest_direction, of_lat_long.brightest_direction);
  };
  const std::filesystem::path env = kPictures / "env";
  CHECK(compare(env / "openexr_KernerEnvCube.exr", env / "openexr_KernerEnvLatLong.exr", 0.03) > 0.999);
  compare(env / "openexr_WavyLinesCube.exr", env / "openexr_WavyLinesLatLong.exr", 0.03);
  const std::filesystem::path truth = kVariants / "zip_half_256x128.exr";
  CHECK(compare(kVariants / "cube64_exrenvmap.exr", truth, 0.03) > 0.99);
  CHECK(compare(kVariants / "cubemip64_exrenvmap.exr", truth, 0.03) > 0.99);
}

TEST_CASE("the shared pictures that are not read are refused by what they are", "[codec][shared]") {
  if (!shared_pictures_are_here()) {
    return;
  }
  const auto check = [](const std::filesystem::path& path, const std::string& found) {
    const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
    INFO(error.message);
    CHECK(error.code == ErrorCode::unsupported_file);
    CHECK(error.says(path.string() + ": "));
    CHECK(error.says(found));
  };
  check(kPictures / "cube" / "open3d_park_ibl.ktx", "is a KTX texture");
}

}  // namespace welkin
