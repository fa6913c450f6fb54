// Promises: the .env files that the real Babylon.js wrote are read as it means them: faces, rows, RGBD, polynomial,
// irradiance texture; PNG and WebP.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>
#include <tuple>

#include "codec/rgbd.h"
#include "places.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/temporary_directory.h"
#include "welkin/babylon_environment.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

const std::filesystem::path kShared = WELKIN_SHARED;
const std::filesystem::path kOracle = kShared / "oracles" / "web" / "env";

bool is_here(const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) return true;
  WARN("left out: " << path << " is not there");
  return false;
}

/// What was handed to Babylon.js: 6 x 16 x 16 RGBA floats, row 0 on top.
std::vector<float> source_of(const char* name) {
  const std::vector<char> bytes = read_bytes(kOracle / (std::string(name) + ".f32"));
  std::vector<float> rgba(bytes.size() / sizeof(float));
  std::memcpy(rgba.data(), bytes.data(), rgba.size() * sizeof(float));
  return rgba;
}

glm::dvec3 stored_term(const std::string& file, const std::string& term) {
  std::ifstream lines(kShared / "hdr" / "REFERENCE_SH.csv");
  for (std::string line; std::getline(lines, line);) {
    if (line.find(file) == std::string::npos || line.find("as stored") == std::string::npos) continue;
    if (line.find("," + term + ",") == std::string::npos) continue;
    std::istringstream numbers(line.substr(line.find("," + term + ",") + term.size() + 2));
    glm::dvec3 rgb{};
    char comma = 0;
    numbers >> rgb.r >> comma >> rgb.g >> comma >> rgb.b;
    return rgb;
  }
  FAIL("no term " << term << " of " << file);
  return {};
}

/// Mean over a level's texels of |log2 of green / green|, once the faces of `chain` went through `turn`: texel (column,
/// row) of a face of the cubemap is compared with the one that `turn` names in the chain.
template <class Turn>
double log_difference(const CubemapImage& cubemap, const CubemapChain& chain, int level, const Turn& turn) {
  const int size = cubemap.size;
  double sum = 0.0;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const auto [other_face, other_column, other_row] = turn(face, column, row);
        const float ours = cubemap.pixels[static_cast<std::size_t>(((face * size + row) * size + column) * 3 + 1)];
        const float theirs = chain.face(level, other_face)[(other_row * size + other_column) * 3 + 1];
        sum += std::abs(
            std::log2(std::max(1e-3, static_cast<double>(theirs)) / std::max(1e-3, static_cast<double>(ours))));
      }
    }
  }
  return sum / (6.0 * size * size);
}

}  // namespace

TEST_CASE("Babylon.js's own RGBD of known texels is read where they were", "[codec][env][shared]") {
  if (!is_here(kOracle / "code_16.env")) return;
  for (const char* name : {"code_16", "range_16"}) {
    const BabylonEnvironment read = read_babylon_environment(kOracle / (std::string(name) + ".env"));
    const std::vector<float> source = source_of(name);
    REQUIRE(read.specular.size() == 16);
    REQUIRE(read.specular.levels() == 5);
    const codec::RgbdEncoder encoder;
    const codec::RgbdDecoder decoder;
    for (int face = 0; face < 6; ++face) {
      for (std::size_t texel = 0; texel < 256; ++texel) {
        const float* from = source.data() + (static_cast<std::size_t>(face) * 256 + texel) * 4;
        const float* found = read.specular.face(0, face) + 3 * texel;
        // Our own coding of the texel; the GPU's powers may have gone to the next byte, its divisor to the next one.
        std::array<std::uint8_t, 4> rgbd{};
        std::array<float, 3> ours{};
        encoder.encode(from, 1, rgbd.data());
        decoder.decode(rgbd.data(), 1, ours.data());
        const float largest = std::max({ours[0], ours[1], ours[2]});
        for (std::size_t c = 0; c < 3; ++c) {
          const double off = std::abs(static_cast<double>(found[c]) - static_cast<double>(ours[c]));
          CAPTURE(name, face, texel, c, found[c], ours[c]);
          if (!(off <= 0.012 * static_cast<double>(largest))) FAIL("not the texel that it was");
        }
      }
    }
  }
}

TEST_CASE("range_16 is Babylon.js's clamp at 255", "[codec][env][shared]") {
  if (!is_here(kOracle / "range_16.env")) return;
  const BabylonEnvironment read = read_babylon_environment(kOracle / "range_16.env");
  const float* values = read.specular.face(0, 0);
  CHECK(*std::max_element(values, values + face_values(read.specular, 0)) == 255.0F);
}

TEST_CASE("real .env files are read whole, with the polynomial that they hold", "[codec][env][shared]") {
  const std::filesystem::path folder = kShared / "hdr" / "cube";
  if (!is_here(folder / "babylon_venice_sunset_128.env")) return;
  const std::pair<const char*, int> files[] = {
      {"babylon_dikhololo_night_64.env", 64},   {"babylon_lebombo_64_webp.env", 64},
      {"babylon_potsdamer_platz_256.env", 256}, {"babylon_spruit_sunrise_128.env", 128},
      {"babylon_studio_small_03_128.env", 128}, {"babylon_venice_sunset_128.env", 128}};
  for (const auto& [file, size] : files) {
    CAPTURE(file);
    const BabylonEnvironment read = read_babylon_environment(folder / file);
    CHECK(read.specular.size() == size);
    CHECK(read.specular.levels() == full_chain_levels(size));
    REQUIRE(read.polynomial);
    CHECK(glm::length(read.polynomial->zx - stored_term(file, "zx")) < 1e-7);
    CHECK(glm::length(read.polynomial->yy - stored_term(file, "yy")) < 1e-7);
  }
}

TEST_CASE("real .env files show their photographs, right way up and not mirrored", "[codec][env][shared]") {
  const std::pair<const char*, const char*> pairs[] = {{"babylon_dikhololo_night_64.env", "dikhololo_night_1k.hdr"},
                                                       {"babylon_lebombo_64_webp.env", "lebombo_1k.hdr"},
                                                       {"babylon_spruit_sunrise_128.env", "spruit_sunrise_1k.hdr"},
                                                       {"babylon_venice_sunset_128.env", "venice_sunset_1k.hdr"}};
  for (const auto& [file, photograph] : pairs) {
    if (!is_here(kShared / "hdr" / "cube" / file)) return;
    CAPTURE(file);
    const CubemapChain chain = mirrored_x(read_babylon_environment(kShared / "hdr" / "cube" / file).specular);
    const Environment picture = read_environment(kShared / "hdr" / "env" / photograph);
    const int size = chain.size() / 2;  // level 1 is nearly sharp
    const CubemapImage cubemap = to_cubemap(picture.lat_long(), size);
    const int end = size - 1;
    const auto difference = [&](const auto& turn) { return log_difference(cubemap, chain, 1, turn); };
    const double as_it_is = difference([](int face, int column, int row) { return std::tuple(face, column, row); });
    const double mirrored =
        difference([end](int face, int column, int row) { return std::tuple(face, end - column, row); });
    const double upside_down =
        difference([end](int face, int column, int row) { return std::tuple(face, column, end - row); });
    const double opposite = difference([](int face, int column, int row) { return std::tuple(face ^ 1, column, row); });
    CHECK(as_it_is < 0.6 * mirrored);
    CHECK(as_it_is < 0.6 * upside_down);
    CHECK(as_it_is < 0.6 * opposite);
  }
}

TEST_CASE("the same environment as PNG and as WebP is the same light", "[codec][env][shared]") {
  if (!is_here(kOracle / "sky_64_webp.env")) return;
  const CubemapChain png = read_babylon_environment(kOracle / "sky_64.env").specular;
  const CubemapChain webp = read_babylon_environment(kOracle / "sky_64_webp.env").specular;
  for (const int level : {0, 2, 4}) {
    double difference = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < 6 * face_values(png, level); ++i) {
      difference += std::abs(static_cast<double>(png.face(level, 0)[i]) - static_cast<double>(webp.face(level, 0)[i]));
      sum += static_cast<double>(png.face(level, 0)[i]);
    }
    CHECK(difference < 0.05 * sum);
  }
}

TEST_CASE("Babylon.js's irradiance texture and dominant direction are read", "[codec][env][shared]") {
  if (!is_here(kOracle / "sky_64_irradiance_cdf.env")) return;
  const BabylonEnvironment plain = read_babylon_environment(kOracle / "sky_64_irradiance.env");
  const BabylonEnvironment cdf = read_babylon_environment(kOracle / "sky_64_irradiance_cdf.env");
  CHECK(plain.irradiance.size == 32);
  CHECK(cdf.irradiance.size == 32);
  CHECK(cdf.dominant_direction);
  REQUIRE(plain.polynomial);
  // Irradiance over pi has the mean of the radiance (here unweighted, and by the samples of Babylon.js).
  double mean = 0.0;
  double radiance = 0.0;
  for (const float value : plain.irradiance.pixels) mean += static_cast<double>(value);
  for (std::size_t i = 0; i < 6 * face_values(plain.specular, 1); ++i) {
    radiance += static_cast<double>(plain.specular.face(1, 0)[i]);
  }
  mean /= static_cast<double>(plain.irradiance.pixels.size());
  radiance /= static_cast<double>(6 * face_values(plain.specular, 1));
  CHECK(mean > 0.6 * radiance);
  CHECK(mean < 1.4 * radiance);
  // What a white surface reflects along +y, in the texture and by the polynomial's way back, is of one size.
  double sum = 0.0;
  for (std::size_t i = 0; i < 32 * 32; ++i) sum += static_cast<double>(plain.irradiance.pixels[(2 * 1024 + i) * 3 + 1]);
  const double up = evaluate(*plain.polynomial, {0.0, 1.0, 0.0}).g;
  CHECK(sum / 1024.0 > 0.5 * up);
  CHECK(sum / 1024.0 < 2.0 * up);
}

}  // namespace welkin::test
