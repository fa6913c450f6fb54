// Promises: an .env that we write is the one that we read, up to RGBD's rounding; its pictures and bytes do not depend
// on the number of threads; what it cannot hold is counted or refused.
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>

#include "codec/rgbd.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "support/webp_env.h"
#include "welkin/babylon_environment.h"
#include "welkin/control.h"

namespace welkin::test {
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

bool same_bits(const BabylonPolynomial& a, const BabylonPolynomial& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

BabylonEnvironment some_environment(int size, int octaves = 6) {
  BabylonEnvironment environment;
  environment.specular = noisy_chain(size, full_chain_levels(size), octaves);
  environment.polynomial = some_polynomial();
  return environment;
}

CubemapImage some_irradiance(int size) {
  const CubemapChain chain = noisy_chain(size, 1, 3, 7);
  return {size, {chain.face(0, 0), chain.face(0, 0) + 6 * face_values(chain, 0)}};
}

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

/// The frames of CubemapView, face by face: normal, where columns and where rows run along.
constexpr std::array<std::array<glm::dvec3, 3>, 6> kFrames{{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}},
                                                            {{{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}},
                                                            {{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}},
                                                            {{{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}},
                                                            {{{0, 0, 1}, {1, 0, 0}, {0, -1, 0}}},
                                                            {{{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}}};

glm::dvec3 texel_direction(int size, int face, int column, int row) {
  const auto& frame = kFrames[static_cast<std::size_t>(face)];
  return frame[0] + frame[1] * ((2.0 * column + 1.0) / size - 1.0) + frame[2] * ((2.0 * row + 1.0) / size - 1.0);
}

/// Face, column and row of the texel that a direction of length 1 along its largest axis meets.
std::tuple<int, int, int> texel_at(int size, const glm::dvec3& direction) {
  for (int face = 0; face < 6; ++face) {
    const auto& frame = kFrames[static_cast<std::size_t>(face)];
    if (glm::dot(direction, frame[0]) < 1.0 - 1e-12) continue;
    const auto index = [&](const glm::dvec3& axis) {
      return static_cast<int>((glm::dot(direction, axis) + 1.0) / 2.0 * size);
    };
    return {face, index(frame[1]), index(frame[2])};
  }
  return {0, 0, 0};
}

bool is_rgbd_of(const CubemapChain& written, const CubemapChain& read) {
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

TEST_CASE("an environment goes to Babylon.js's axes as a picture does: x changes its sign", "[codec][env]") {
  const CubemapChain chain = noisy_chain(5, 3);
  SphericalHarmonics radiance(3);
  for (int l = 0; l < 3; ++l) {
    for (int m = -l; m <= l; ++m) radiance.at(l, m) = glm::dvec3(1.0 + l * 3 + m, 0.5 * m, l - 0.25 * m);
  }
  const BabylonEnvironment turned = to_babylon(chain, radiance, some_irradiance(3));
  for (int level = 0; level < 3; ++level) {
    const int size = chain.level_size(level);
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          glm::dvec3 direction = texel_direction(size, face, column, row);
          direction.x = -direction.x;
          const auto [other_face, other_column, other_row] = texel_at(size, direction);
          const float* from = chain.face(level, face) + 3 * (row * size + column);
          const float* to = turned.specular.face(level, other_face) + 3 * (other_row * size + other_column);
          CHECK(std::equal(from, from + 3, to));
        }
      }
    }
  }
  CHECK(same_bits(mirrored_x(turned.specular), chain));
  CHECK(test::same_bits(mirrored_x(turned.irradiance), some_irradiance(3)));
  // Twice E / pi of the polynomial's kind in a direction is that of the mirrored direction.
  REQUIRE(turned.polynomial);
  const BabylonPolynomial straight = babylon_polynomial(radiance);
  for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(0.6, 0.8, 0), glm::dvec3(0.36, 0.48, -0.8)}) {
    const glm::dvec3 mirrored = evaluate(*turned.polynomial, normal * glm::dvec3(-1, 1, 1));
    CHECK(glm::length(mirrored - evaluate(straight, normal)) < 1e-12);
  }
}

TEST_CASE("RGBD has the byte whose colour is nearest in the encoded scale, over its whole range", "[codec][env]") {
  const codec::RgbdEncoder encoder;
  const codec::RgbdDecoder decoder;
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
    // What the coding costs: half a step of 255 in the 1/2.2th power of the share of 1 that the divisor leaves.
    if (value > 0.5) CHECK(std::abs(static_cast<double>(back[0]) / value - 1.0) < 0.5 * 2.2 / (255.0 * 0.72));
  }
}

TEST_CASE("every byte of RGBD decodes to its power, and a divisor of 0 is taken as 1", "[codec][env]") {
  const codec::RgbdDecoder decoder;
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

TEST_CASE("an .env comes back as RGBD has it, whatever its size", "[codec][env]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 2, 4, 64, 256}) {
    CAPTURE(size);
    BabylonEnvironment environment = some_environment(size);
    environment.lod_generation_scale = 0.75;
    const auto path = directory.file("sky.env");
    const WriteReport report = write_babylon_environment(path, environment);
    CHECK(report.values_clamped == 0);
    CHECK(report.files == std::vector<std::filesystem::path>{path});
    const BabylonEnvironment read = read_babylon_environment(path);
    CHECK(read.version == 2);
    CHECK(read.lod_generation_scale == 0.75);
    CHECK(read.irradiance.size == 0);
    CHECK(!read.dominant_direction);
    REQUIRE(read.polynomial);
    CHECK(same_bits(*read.polynomial, *environment.polynomial));
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
    REQUIRE(read.irradiance.size == size);
    REQUIRE(read.dominant_direction);
    CHECK(test::same_bits(*read.dominant_direction, *environment.dominant_direction));
    CubemapChain written(size, 1);
    CubemapChain found(size, 1);
    std::copy(environment.irradiance.pixels.begin(), environment.irradiance.pixels.end(), written.face(0, 0));
    std::copy(read.irradiance.pixels.begin(), read.irradiance.pixels.end(), found.face(0, 0));
    CHECK(is_rgbd_of(written, found));
  }
}

TEST_CASE("pictures in WebP without loss are the same light as in PNG, to the bit", "[codec][env]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 4, 64}) {
    BabylonEnvironment environment = some_environment(size);
    environment.irradiance = some_irradiance(5);
    write_babylon_environment(directory.file("png.env"), environment);
    write_bytes(directory.file("webp.env"), with_webp_pictures(read_bytes(directory.file("png.env"))));
    const BabylonEnvironment png = read_babylon_environment(directory.file("png.env"));
    const BabylonEnvironment webp = read_babylon_environment(directory.file("webp.env"));
    CHECK(test::same_bits(png.specular, webp.specular));
    CHECK(test::same_bits(png.irradiance, webp.irradiance));
  }
}

TEST_CASE("an .env without a polynomial says null", "[codec][env]") {
  const TemporaryDirectory directory;
  BabylonEnvironment environment = some_environment(2);
  environment.polynomial.reset();
  write_babylon_environment(directory.file("sky.env"), environment);
  CHECK(!read_babylon_environment(directory.file("sky.env")).polynomial);
  const std::vector<char> bytes = read_bytes(directory.file("sky.env"));
  CHECK(std::string(bytes.begin(), bytes.end()).find("\"irradiance\":null") != std::string::npos);
}

TEST_CASE("an .env has the same bytes on any number of threads", "[codec][env]") {
  const TemporaryDirectory directory;
  const BabylonEnvironment environment = some_environment(128);
  std::vector<char> first;
  CubemapChain first_read;
  for (const int threads : {1, 2, 5}) {
    CubemapChain read;
    run_with_threads(threads, [&] {
      write_babylon_environment(directory.file("sky.env"), environment);
      read = read_babylon_environment(directory.file("sky.env")).specular;
    });
    const std::vector<char> bytes = read_bytes(directory.file("sky.env"));
    if (threads == 1) {
      first = bytes;
      first_read = std::move(read);
      continue;
    }
    CHECK(bytes == first);
    CHECK(test::same_bits(read, first_read));
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
  environment.specular = CubemapChain();
  CHECK(refusal(environment).says("0 levels"));
  environment = some_environment(4);
  environment.polynomial->zz.y = NAN;
  CHECK(refusal(environment).says("polynomial is not finite"));
  environment = some_environment(4);
  environment.lod_generation_scale = -0.5;
  CHECK(refusal(environment).says("lodGenerationScale"));
  environment = some_environment(4);
  environment.irradiance = some_irradiance(4);
  environment.irradiance.pixels.pop_back();
  CHECK(refusal(environment).says("irradiance cubemap has 287 values"));
  environment.irradiance = some_irradiance(4);
  environment.polynomial.reset();
  CHECK(refusal(environment).says("has a polynomial too"));
  environment = some_environment(4);
  environment.dominant_direction = glm::dvec3(0.0, 1.0, 0.0);
  CHECK(refusal(environment).says("dominant direction"));
}

}  // namespace welkin::test
