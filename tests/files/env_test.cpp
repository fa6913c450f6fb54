// `.env` files: ours come back, and Babylon.js's own are read as it means them.
#include "files/env.h"

#include "places.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/sun_maps.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "support/webp_env.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promises: an .env that we write is the one that we read, up to RGBD's rounding; its images and bytes do not depend
// on the number of threads; what it cannot hold is counted or refused.

namespace {

BabylonPolynomial some_polynomial() {
  BabylonPolynomial polynomial;
  double value = 0.1;
  for (glm::dvec3* term : {&polynomial.x, &polynomial.y, &polynomial.z, &polynomial.xx, &polynomial.yy, &polynomial.zz,
                           &polynomial.yz, &polynomial.zx, &polynomial.xy}) {
    *term = {value, -value / 3.0, value * 7.0};
    value *= 1.7;
  }
  return polynomial;
}

bool same_polynomial(const BabylonPolynomial& a, const BabylonPolynomial& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

BabylonEnvironment some_environment(int size, int octaves = 6) {
  BabylonEnvironment environment;
  environment.specular = noisy_chain(size, full_chain_levels(size), octaves);
  environment.polynomial = some_polynomial();
  return environment;
}

Cubemap some_irradiance(int size) { return noisy_chain(size, 1, 3, 7); }

/// RGBD in double, by libm: readable, for comparison.
std::array<double, 3> through_rgbd(const float* rgb) {
  const double largest =
      std::max({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2]), 1e-7});
  const double d = std::clamp(std::floor(std::max(255.0 / largest, 1.0)) / 255.0, 0.0, 1.0);
  std::array<double, 3> back{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double code = std::round(255.0 * std::min(1.0, std::pow(static_cast<double>(rgb[c]) * d, 1.0 / 2.2)));
    back[c] = std::pow(code / 255.0, 2.2) / d;
  }
  return back;
}

bool is_rgbd_of(const Cubemap& written, const Cubemap& read) {
  if (written.size() != read.size() || written.levels() != read.levels()) return false;
  for (int level = 0; level < written.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      for (std::size_t i = 0; i < face_values(written, level); i += 3) {
        const std::array<double, 3> wanted = through_rgbd(written.face(level, face) + i);
        for (std::size_t c = 0; c < 3; ++c) {
          const auto found = static_cast<double>(read.face(level, face)[i + c]);
          if (!(std::abs(found - wanted[c]) <= 1e-6 * wanted[c])) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace

TEST_CASE("an environment goes to Babylon.js's axes as an image does: x changes its sign", "[codec][env]") {
  const Cubemap chain = noisy_chain(5, 3);
  SphericalHarmonics radiance(3);
  for (int l = 0; l < 3; ++l) {
    for (int m = -l; m <= l; ++m) radiance.at(l, m) = glm::dvec3(1.0 + l * 3 + m, 0.5 * m, l - 0.25 * m);
  }
  const BabylonEnvironment rotated = to_babylon(chain, radiance, some_irradiance(3));
  for (int level = 0; level < 3; ++level) {
    const int size = chain.level_size(level);
    const std::vector<glm::dvec3> centres = texel_centres(size);
    for (std::size_t texel = 0; texel < centres.size(); ++texel) {
      const std::int64_t other =
          nearest_texel(image::TexelGrid::cubemap(size), centres[texel] * glm::dvec3(-1.0, 1.0, 1.0));
      const float* from = chain.face(level, 0) + 3 * texel;
      CHECK(std::equal(from, from + 3, rotated.specular.face(level, 0) + 3 * other));
    }
  }
  CHECK(same_bits(mirrored_x(rotated.specular), chain));
  CHECK(same_bits(mirrored_x(rotated.irradiance), some_irradiance(3)));
  // Twice E / pi of the polynomial's kind in a direction is that of the mirrored direction.
  REQUIRE(rotated.polynomial);
  const BabylonPolynomial straight = babylon_polynomial(radiance);
  for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(0.6, 0.8, 0), glm::dvec3(0.36, 0.48, -0.8)}) {
    const glm::dvec3 mirrored = evaluate(*rotated.polynomial, normal * glm::dvec3(-1, 1, 1));
    CHECK(glm::length(mirrored - evaluate(straight, normal)) < 1e-12);
  }
}

TEST_CASE("RGBD has the byte whose colour is nearest in the encoded scale, over its whole range", "[codec][env]") {
  const files::RgbdEncoder encoder;
  const files::RgbdDecoder decoder;
  for (int i = 0; i < 200000; ++i) {
    const double value = std::pow(2.0, -14.0 + 22.0 * i / 200000.0);
    const std::array<float, 3> rgb{static_cast<float>(value), static_cast<float>(value * 0.37), 0.0F};
    if (rgb[0] > 255.0F) break;
    std::array<std::uint8_t, 4> rgbd{};
    std::array<float, 3> back{};
    REQUIRE(encoder.encode(rgb.data(), 1, rgbd.data()) == 0);
    decoder.decode(rgbd.data(), 1, back.data());
    const std::array<double, 3> wanted = through_rgbd(rgb.data());
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(std::abs(static_cast<double>(back[c]) - wanted[c]) <= 1e-6 * wanted[c])) FAIL(rgb[c] << " " << back[c]);
    }
    // The coding's error: half a step of 255 in the 1/2.2th power of the share of 1 that the divisor leaves.
    if (value > 0.5) CHECK(std::abs(static_cast<double>(back[0]) / value - 1.0) < 0.5 * 2.2 / (255.0 * 0.72));
  }
}

TEST_CASE("every byte of RGBD decodes to its power, and a divisor of 0 is taken as 1", "[codec][env]") {
  const files::RgbdDecoder decoder;
  for (int code = 0; code < 256; ++code) {
    for (const int d : {0, 1, 2, 127, 255}) {
      const auto byte = static_cast<std::uint8_t>(code);
      const std::array<std::uint8_t, 4> rgbd{byte, byte, byte, static_cast<std::uint8_t>(d)};
      std::array<float, 3> rgb{};
      decoder.decode(rgbd.data(), 1, rgb.data());
      const double wanted = std::pow(code / 255.0, 2.2) / (std::max(d, 1) / 255.0);
      CHECK(std::abs(static_cast<double>(rgb[1]) - wanted) <= 1e-7 * wanted);
    }
  }
}

TEST_CASE("an .env comes back as RGBD has it, whatever its size", "[codec][env][slow]") {
  for (const int size : {1, 2, 4, 64, 256}) {
    CAPTURE(size);
    BabylonEnvironment environment = some_environment(size);
    environment.lod_generation_scale = 0.75;
    const TemporaryFile path("sky.env");
    const WriteReport report = write_babylon_environment(path, environment);
    CHECK(report.values_clamped == 0);
    CHECK(report.files == std::vector<std::filesystem::path>{path});
    const BabylonEnvironment read = read_babylon_environment(path);
    CHECK(read.version == 2);
    CHECK(read.lod_generation_scale == 0.75);
    CHECK(read.irradiance.size() == 0);
    CHECK(!read.dominant_direction);
    REQUIRE(read.polynomial);
    CHECK(same_polynomial(*read.polynomial, *environment.polynomial));
    CHECK(is_rgbd_of(environment.specular, read.specular));
  }
}

TEST_CASE("an .env's irradiance texture and dominant direction come back", "[codec][env]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 31, 64}) {
    BabylonEnvironment environment = some_environment(8);
    environment.irradiance = some_irradiance(size);
    environment.dominant_direction = glm::dvec3(0.1, -0.7, 0.3);
    write_babylon_environment(directory.file("sky.env"), environment);
    const BabylonEnvironment read = read_babylon_environment(directory.file("sky.env"));
    REQUIRE(read.irradiance.size() == size);
    REQUIRE(read.dominant_direction);
    CHECK(same_bits(*read.dominant_direction, *environment.dominant_direction));
    CHECK(is_rgbd_of(environment.irradiance, read.irradiance));
  }
}

TEST_CASE("images in WebP without loss are the same light as in PNG, to the bit", "[codec][env]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 4, 64}) {
    BabylonEnvironment environment = some_environment(size);
    environment.irradiance = some_irradiance(5);
    write_babylon_environment(directory.file("png.env"), environment);
    write_bytes(directory.file("webp.env"), with_webp_images(read_bytes(directory.file("png.env"))));
    const BabylonEnvironment png = read_babylon_environment(directory.file("png.env"));
    const BabylonEnvironment webp = read_babylon_environment(directory.file("webp.env"));
    CHECK(same_bits(png.specular, webp.specular));
    CHECK(same_bits(png.irradiance, webp.irradiance));
  }
}

TEST_CASE("values above 255, negatives and NaN are clamped and counted in an .env", "[codec][env]") {
  const TemporaryDirectory directory;
  BabylonEnvironment environment = some_environment(2);
  float* texel = environment.specular.face(0, 3);
  const std::array<float, 12> odd{
      255.0F, 300.0F, 1e30F, -1.0F, -0.0F, 2.0F, NAN, 1.0F, 4.0F, std::numeric_limits<float>::infinity(), 0.0F, 3.0F};
  std::copy(odd.begin(), odd.end(), texel);
  CHECK(write_babylon_environment(directory.file("sky.env"), environment).values_clamped == 5);
  const BabylonEnvironment read = read_babylon_environment(directory.file("sky.env"));
  const float* back = read.specular.face(0, 3);
  CHECK(back[0] == 255.0F);
  CHECK(back[1] == 255.0F);
  CHECK(back[2] == 255.0F);
  CHECK(back[3] == 0.0F);
  CHECK(back[4] == 0.0F);
  CHECK(back[6] == 0.0F);
  CHECK(back[9] == 255.0F);
}

TEST_CASE("what an .env cannot hold is refused before anything is written", "[codec][env]") {
  const TemporaryDirectory directory;
  const auto refusal = [&directory](const BabylonEnvironment& environment) {
    const ThrownError error = thrown_by([&] { write_babylon_environment(directory.file("sky.env"), environment); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(!std::filesystem::exists(directory.file("sky.env")));
    return error;
  };
  BabylonEnvironment environment = some_environment(4);
  environment.specular = noisy_chain(6, 3);
  CHECK(refusal(environment).says("power of two"));
  environment.specular = noisy_chain(8, 3);
  CHECK(refusal(environment).says("down to 1 texel"));
  environment.specular = Cubemap();
  CHECK(refusal(environment).says("0 levels"));
  environment = some_environment(4);
  environment.polynomial->zz.y = NAN;
  CHECK(refusal(environment).says("polynomial is not finite"));
  environment = some_environment(4);
  environment.lod_generation_scale = -0.5;
  CHECK(refusal(environment).says("lodGenerationScale"));
  environment = some_environment(4);
  environment.irradiance = some_irradiance(4);
  environment.polynomial.reset();
  CHECK(refusal(environment).says("no polynomial"));
  environment = some_environment(4);
  environment.dominant_direction = glm::dvec3(0.0, 1.0, 0.0);
  CHECK(refusal(environment).says("dominant direction"));
}

// Promises: the .env files that the real Babylon.js wrote are read as it means them: faces, rows, RGBD, polynomial,
// irradiance texture; PNG and WebP.

namespace {

const std::filesystem::path kOracle = std::filesystem::path(WELKIN_SHARED) / "oracles" / "web" / "env";

bool is_here(const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) return true;
  WARN("left out: " << path << " is not there");
  return false;
}

/// Returns the input of Babylon.js: 6 x 16 x 16 RGBA floats, row 0 on top.
std::vector<float> source_of(const char* name) {
  const std::vector<char> bytes = read_bytes(kOracle / (std::string(name) + ".f32"));
  std::vector<float> rgba(bytes.size() / sizeof(float));
  std::memcpy(rgba.data(), bytes.data(), rgba.size() * sizeof(float));
  return rgba;
}

/// Mean over all texels of |log2 of green / green|.
double log_difference(const Cubemap& a, const Cubemap& b) {
  const auto green = [](const Cubemap& image, std::size_t i) {
    return std::log2(std::max(1e-3, static_cast<double>(image.pixels()[i])));
  };
  double sum = 0.0;
  for (std::size_t i = 1; i < a.pixels().size(); i += 3) sum += std::abs(green(a, i) - green(b, i));
  return 3.0 * sum / static_cast<double>(a.pixels().size());
}

}  // namespace

TEST_CASE("Babylon.js's own RGBD of known texels is read where they were", "[codec][env][shared]") {
  if (!is_here(kOracle / "code_16.env")) return;
  for (const char* name : {"code_16", "range_16"}) {
    const BabylonEnvironment read = read_babylon_environment(kOracle / (std::string(name) + ".env"));
    const std::vector<float> source = source_of(name);
    REQUIRE(read.specular.size() == 16);
    REQUIRE(read.specular.levels() == 5);
    const files::RgbdEncoder encoder;
    const files::RgbdDecoder decoder;
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

TEST_CASE("real .env files are read whole, with the polynomial that they hold", "[codec][env][shared]") {
  const std::filesystem::path folder = kImages / "cube";
  if (!is_here(folder / "babylon_venice_sunset_128.env")) return;
  const std::pair<const char*, int> files[] = {
      {"babylon_dikhololo_night_64.env", 64},   {"babylon_lebombo_64_webp.env", 64},
      {"babylon_potsdamer_platz_256.env", 256}, {"babylon_spruit_sunrise_128.env", 128},
      {"babylon_studio_small_03_128.env", 128}, {"babylon_venice_sunset_128.env", 128}};
  const auto stored = recorded_harmonics("env polynomial (as stored)");
  for (const auto& [file, size] : files) {
    CAPTURE(file);
    const std::map<std::string, glm::dvec3> terms(stored.at(file).begin(), stored.at(file).end());
    const BabylonEnvironment read = read_babylon_environment(folder / file);
    CHECK(read.specular.size() == size);
    CHECK(read.specular.levels() == full_chain_levels(size));
    REQUIRE(read.polynomial);
    CHECK(glm::length(read.polynomial->zx - terms.at("zx")) < 1e-7);
    CHECK(glm::length(read.polynomial->yy - terms.at("yy")) < 1e-7);
  }
}

TEST_CASE("real .env files show their photographs, right way up and not mirrored", "[codec][env][shared]") {
  const std::pair<const char*, const char*> pairs[] = {{"babylon_dikhololo_night_64.env", "dikhololo_night_1k.hdr"},
                                                       {"babylon_lebombo_64_webp.env", "lebombo_1k.hdr"},
                                                       {"babylon_spruit_sunrise_128.env", "spruit_sunrise_1k.hdr"},
                                                       {"babylon_venice_sunset_128.env", "venice_sunset_1k.hdr"}};
  for (const auto& [file, photograph] : pairs) {
    if (!is_here(kImages / "cube" / file)) return;
    CAPTURE(file);
    const Cubemap chain = mirrored_x(read_babylon_environment(kImages / "cube" / file).specular);
    const Environment image = read_environment(kImages / "env" / photograph);
    const int size = chain.level_size(1);  // nearly sharp
    const Cubemap wanted = to_cubemap(image.lat_long(), size);
    const auto difference = [&](const glm::dmat3& rotation) {
      return log_difference(to_cubemap(chain.view(1), size, rotation), wanted);
    };
    const double as_it_is = difference(glm::dmat3(1.0));
    const glm::dmat3 mirrored(-1, 0, 0, 0, 1, 0, 0, 0, 1);
    const glm::dmat3 upside_down(1, 0, 0, 0, -1, 0, 0, 0, 1);
    for (const glm::dmat3& wrong : {mirrored, upside_down, rotation_about_y(180.0)}) {
      CHECK(as_it_is < 0.6 * difference(wrong));
    }
  }
}

TEST_CASE("Babylon.js's irradiance texture and dominant direction are read", "[codec][env][shared]") {
  if (!is_here(kOracle / "sky_64_irradiance_cdf.env")) return;
  const BabylonEnvironment plain = read_babylon_environment(kOracle / "sky_64_irradiance.env");
  const BabylonEnvironment cdf = read_babylon_environment(kOracle / "sky_64_irradiance_cdf.env");
  CHECK(plain.irradiance.size() == 32);
  CHECK(cdf.irradiance.size() == 32);
  CHECK(cdf.dominant_direction);
  REQUIRE(plain.polynomial);
  // Irradiance over pi has the mean of the radiance (here unweighted, and by the samples of Babylon.js).
  double mean = 0.0;
  double radiance = 0.0;
  for (const float value : plain.irradiance.pixels()) mean += static_cast<double>(value);
  for (std::size_t i = 0; i < 6 * face_values(plain.specular, 1); ++i) {
    radiance += static_cast<double>(plain.specular.face(1, 0)[i]);
  }
  mean /= static_cast<double>(plain.irradiance.pixels().size());
  radiance /= static_cast<double>(6 * face_values(plain.specular, 1));
  CHECK(mean > 0.6 * radiance);
  CHECK(mean < 1.4 * radiance);
  // The light that a white surface reflects along +y agrees within a factor of 2 in the texture and the polynomial.
  double sum = 0.0;
  for (std::size_t i = 0; i < 32 * 32; ++i)
    sum += static_cast<double>(plain.irradiance.pixels()[(2 * 1024 + i) * 3 + 1]);
  const double up = evaluate(*plain.polynomial, {0.0, 1.0, 0.0}).g;
  CHECK(sum / 1024.0 > 0.5 * up);
  CHECK(sum / 1024.0 < 2.0 * up);
}

}  // namespace welkin::test
