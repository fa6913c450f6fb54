// Turned harmonics, the one light nearest to them, and the harmonics of a sun.
#include <glm/gtc/matrix_transform.hpp>

#include "math/quadrature.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/random_harmonics.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "transform/frame_transform.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: rotated coefficients are those of the rotated function; rotations compose and invert. (10 000 of them, and
// quaternions of any length: tests/stability.)

namespace {

/// Largest difference between `rotate` at map * d and `original` at d.
double worst_difference(const SphericalHarmonics& rotated, const SphericalHarmonics& original, const glm::dmat3& map) {
  RandomLight light(7);
  double worst = 0.0;
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 d = light.direction();
    const glm::dvec3 off = evaluate(rotated, glm::normalize(map * d)) - evaluate(original, d);
    worst = std::max(worst, glm::length(off));
  }
  return worst;
}

}  // namespace

TEST_CASE("Turned coefficients are those of the turned function, in every number of bands", "[sh][turn]") {
  RandomLight light(1);
  for (int bands = 1; bands <= kMaximumBands; ++bands) {
    for (int k = 0; k < 10; ++k) {
      const SphericalHarmonics original = light.harmonics(bands);
      const glm::dquat rotation = light.rotation();
      CAPTURE(bands, k);
      CHECK(worst_difference(rotate(original, rotation), original, glm::mat3_cast(rotation)) < 1e-12 * norm(original));
    }
  }
}

TEST_CASE("A light is where it was turned to, to 1e-13", "[sh][turn]") {
  RandomLight light(2);
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 direction = light.direction();
    const glm::dquat rotation = light.rotation();
    const SphericalHarmonics found = rotate(point_light(direction, {1, 2, 3}, kMaximumBands), rotation);
    CHECK(relative_error(found, point_light(glm::normalize(rotation * direction), {1, 2, 3}, kMaximumBands)) < 1e-13);
  }
}

TEST_CASE("One turn after another is their product, and the inverse undoes", "[sh][turn]") {
  RandomLight light(3);
  for (const int bands : {1, 2, 3, 5, 9, 16}) {
    const SphericalHarmonics original = light.harmonics(bands);
    const glm::dquat first = light.rotation();
    const glm::dquat second = light.rotation();
    CHECK(relative_error(rotate(rotate(original, first), second), rotate(original, second * first)) < 1e-13);
    CHECK(relative_error(rotate(rotate(original, first), glm::conjugate(first)), original) < 1e-13);
    CHECK(relative_error(rotate(original, -first), rotate(original, first)) < 1e-15);
    CHECK(same_bits(rotate(original, glm::dquat(1, 0, 0, 0)), rotate(original, glm::dquat(-3, 0, 0, 0))));
    CHECK(relative_error(rotate(original, glm::dquat(1, 0, 0, 0)), original) < 1e-15);
  }
}

TEST_CASE("The 48 symmetries of the cube permute bands 0 and 1 with signs", "[sh][turn]") {
  RandomLight light(6);
  const SphericalHarmonics original = light.harmonics(kMaximumBands);
  for (const glm::dmat3& map : cube_symmetries()) {
    const SphericalHarmonics found = rotate(original, map);
    CHECK(found.at(0, 0) == original.at(0, 0));
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 before(original.at(1, 1)[c], original.at(1, -1)[c], original.at(1, 0)[c]);
      const glm::dvec3 after(found.at(1, 1)[c], found.at(1, -1)[c], found.at(1, 0)[c]);
      CHECK(after == map * before);
    }
    CHECK(worst_difference(found, original, map) < 1e-12 * norm(original));
  }
}

TEST_CASE("A cube face's transform is the turn from its frame, for all bands", "[sh][turn]") {
  RandomLight light(8);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    const SphericalHarmonics local = light.harmonics(kMaximumBands);
    const std::size_t count = local.coefficients().size();
    std::vector<double> planes(3 * count);
    std::vector<double> canonical(3 * count);
    std::vector<int> rows(count);
    for (std::size_t k = 0; k < count; ++k) {
      rows[k] = static_cast<int>(k);
      for (std::size_t c = 0; c < 3; ++c) planes[c * count + k] = local.coefficients()[k][static_cast<int>(c)];
    }
    transforms::face_transform(face, kMaximumBands).add(planes.data(), rows.data(), canonical.data());
    SphericalHarmonics expected(kMaximumBands);
    for (std::size_t k = 0; k < count; ++k) {
      expected.coefficients()[k] = {canonical[k], canonical[count + k], canonical[2 * count + k]};
    }
    CHECK(relative_error(rotate(local, glm::dmat3(frame.u, frame.v, frame.normal)), expected) < 1e-12);
  }
}

TEST_CASE("A matrix slightly off is taken for the nearest turn; one far off is refused", "[sh][turn]") {
  RandomLight light(13);
  const SphericalHarmonics original = light.harmonics(kMaximumBands);
  const glm::dmat3 map = glm::mat3_cast(light.rotation());
  glm::dmat3 off = map;
  for (int k = 0; k < 3; ++k) off[k] += 2e-7 * light.colour();
  const SphericalHarmonics found = rotate(original, off);
  CHECK(norm(found) == Approx(norm(original)).epsilon(1e-12));
  CHECK(relative_error(found, rotate(original, map)) < 2e-5);

  for (const glm::dmat3& bad : {glm::dmat3(0.0), 1.001 * map, glm::dmat3(std::numeric_limits<double>::quiet_NaN()),
                                glm::dmat3({1, 0, 0}, {0.01, 1, 0}, {0, 0, 1})}) {
    const ThrownError error = thrown_by([&] { (void)rotate(original, bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("not orthogonal"));
    CHECK(error.says("1e-6"));
  }
}

TEST_CASE("A quaternion without length is refused", "[sh][turn]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const glm::dquat& bad : {glm::dquat(0, 0, 0, 0), glm::dquat(nan, 0, 0, 1), glm::dquat(1, 0, nan, 0),
                                glm::dquat(infinity, 0, 0, 0), glm::dquat(1, 0, 0, -infinity)}) {
    const ThrownError error = thrown_by([&] { (void)rotate(SphericalHarmonics(3), bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("quaternion"));
    CHECK(error.says("(1 0 0 0) is the identity"));
  }
}

// Promise: of a constant and a directional light the dominant light is the directional one; it rotates with the light.

TEST_CASE("A directional light over a constant comes back", "[sh][dominant]") {
  RandomLight light(61);
  for (const int bands : {2, 3, 4, 16}) {
    for (const double strength : {1e-30, 1e-3, 1.0, 222208.0, 1e30}) {
      const glm::dvec3 direction = light.direction();
      const glm::dvec3 irradiance = strength * glm::dvec3(1.0, 0.7, 0.2);
      // Ambient light ten times as strong is no hindrance: band 0 is not looked at.
      const SphericalHarmonics radiance =
          add(constant_radiance(strength * glm::dvec3(10, 20, 30), bands), point_light(direction, irradiance, bands));
      const auto found = dominant_light(radiance);
      CAPTURE(bands, strength);
      REQUIRE(found);
      CHECK(glm::length(found->direction - direction) < 1e-14);
      CHECK(glm::length(found->irradiance - irradiance) < 1e-13 * glm::length(irradiance));
    }
  }
}

TEST_CASE("No directional light comes closer to bands 1 and 2", "[sh][dominant]") {
  RandomLight light(62);
  const SphericalHarmonics radiance =
      add(point_light(light.direction(), {3, 2, 1}, 3), scale(light.harmonics(3), glm::dvec3(0.2)));
  const auto found = dominant_light(radiance);
  REQUIRE(found);
  const auto distance = [&](const glm::dvec3& irradiance) {
    SphericalHarmonics rest = add(radiance, scale(point_light(found->direction, irradiance, 3), glm::dvec3(-1.0)));
    rest.at(0, 0) = glm::dvec3(0.0);
    return norm(rest);
  };
  const double smallest = distance(found->irradiance);
  for (int c = 0; c < 3; ++c) {
    for (const double step : {-1e-3, 1e-3}) {
      glm::dvec3 other = found->irradiance;
      other[c] += step;
      CHECK(distance(other) > smallest);
    }
  }
}

TEST_CASE("The dominant light turns with its environment", "[sh][dominant]") {
  RandomLight light(63);
  for (int k = 0; k < 20; ++k) {
    const SphericalHarmonics radiance = add(light.harmonics(4), constant_radiance({5, 5, 5}, 4));
    const glm::dquat rotation = light.rotation();
    const auto before = dominant_light(radiance);
    const auto after = dominant_light(rotate(radiance, rotation));
    REQUIRE(before);
    REQUIRE(after);
    CHECK(glm::length(after->direction - rotation * before->direction) < 1e-13);
    CHECK(glm::length(after->irradiance - before->irradiance) < 1e-13);
    for (int c = 0; c < 3; ++c) CHECK(before->irradiance[c] >= 0.0);
  }
}

TEST_CASE("Light without a direction has no dominant light", "[sh][dominant]") {
  CHECK_FALSE(dominant_light(SphericalHarmonics(3)));
  CHECK_FALSE(dominant_light(constant_radiance({1, 2, 3}, 3)));
  CHECK_FALSE(dominant_light(constant_radiance({1, 2, 3}, 1)));
  // A uniform sky with the rounding error of a projection.
  CHECK_FALSE(dominant_light(add(constant_radiance({1, 1, 1}, 3), point_light({0, 1, 0}, glm::dvec3(1e-7), 3))));
  SphericalHarmonics broken = point_light({0, 1, 0}, {1, 1, 1}, 3);
  broken.at(1, 0).r = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(dominant_light(broken));
  // Two equal lights face to face cancel in the linear band.
  CHECK_FALSE(dominant_light(add(point_light({0, 1, 0}, {1, 1, 1}, 3), point_light({0, -1, 0}, {1, 1, 1}, 3))));
}

// Promise: a sun's coefficients are those of a uniform disc of its solid angle, from a point to the whole sphere.

namespace {

constexpr double kPi = std::numbers::pi;

Sun sun_of(const glm::dvec3& direction, double solid_angle) {
  Sun sun;
  sun.direction = direction;
  sun.radiance = {3.0, 2.0, 1.0};
  sun.solid_angle = solid_angle;
  sun.irradiance = solid_angle * sun.radiance;
  return sun;
}

/// Coefficients of a cap around z: Gauss' rule over its height, exact for the Legendre polynomials.
SphericalHarmonics integrated_cap(double solid_angle, int bands) {
  SphericalHarmonics sum(bands);
  const math::GaussRule rule = math::gauss_legendre(bands);
  std::vector<double> basis(sum.coefficients().size());
  for (int i = 0; i < rule.order; ++i) {
    const double away = solid_angle / (2.0 * kPi) * 0.5 * (1.0 + rule.nodes[i]);  // 1 - z
    evaluate_basis({std::sqrt(away * (2.0 - away)), 0.0, 1.0 - away}, bands, basis);
    for (int l = 0; l < bands; ++l) {
      sum.at(l, 0) +=
          glm::dvec3(3, 2, 1) * (basis[SphericalHarmonics::index(l, 0)] * rule.weights[i] * 0.5 * solid_angle);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("A colour that comes from behind is not taken below zero", "[sh][dominant]") {
  const auto found = dominant_light(add(point_light({0, 1, 0}, {0, 5, 0}, 3), point_light({0, -1, 0}, {0, 0, 1}, 2)));
  REQUIRE(found);
  CHECK(found->irradiance.b == 0.0);
  CHECK(found->irradiance.g > 0.0);
}

TEST_CASE("A disc's coefficients are its integral, from tiny to all around", "[sh][sun]") {
  for (const double solid_angle : {1e-12, 6.8e-5, 0.01, 1.0, 2.0 * kPi, 9.0, 4.0 * kPi}) {
    const SphericalHarmonics found = sun_harmonics(sun_of({0, 0, 1}, solid_angle), kMaximumBands);
    CAPTURE(solid_angle);
    CHECK(relative_error(found, integrated_cap(solid_angle, kMaximumBands)) < 1e-13);
    RandomLight light(71);
    const glm::dvec3 direction = light.direction();
    const glm::dvec3 half = glm::normalize(glm::dvec3(0, 0, 1) + direction);  // 180 degrees about it take z there
    const glm::dquat rotation(0.0, half.x, half.y, half.z);
    CHECK(relative_error(sun_harmonics(sun_of(direction, solid_angle), kMaximumBands), rotate(found, rotation)) <
          1e-13);
  }
}

TEST_CASE("A sun's total radiance is its irradiance, and what it gives to a surface facing it has a closed form",
          "[sh][sun]") {
  for (const double solid_angle : {6.8e-5, 0.5, 3.0}) {
    const Sun sun = sun_of({0, 1, 0}, solid_angle);
    const SphericalHarmonics radiance = sun_harmonics(sun, 16);
    CHECK(glm::length(4.0 * kPi * mean_radiance(radiance) - sun.irradiance) < 1e-13 * glm::length(sun.irradiance));
    // Int of cos over a disc: pi sin^2 a L = irradiance (1 + cos a) / 2; 16 bands give it to one percent.
    const double c = 1.0 - solid_angle / (2.0 * kPi);
    const glm::dvec3 facing = evaluate(irradiance_from_radiance(radiance), sun.direction);
    CHECK(facing.x == Approx(sun.irradiance.x * 0.5 * (1.0 + c)).epsilon(0.01));
  }
}

TEST_CASE("Suns that cannot be are refused", "[sh][sun]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double solid_angle : {-1e-9, 12.6, nan}) {
    CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 1, 0}, solid_angle), 3); }).says("solid angle"));
  }
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 0, 0}, 0.1), 3); }).says("direction"));
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, nan, 0}, 0.1), 3); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)sun_harmonics(sun_of({0, 1, 0}, 0.1), 17); }).says("1 to 16"));
}

// Promises: the coefficients of a map are those of the map without its sun plus those of a directional light of its
// irradiance, but for what the sun's extent explains.

namespace {

constexpr int kBands = 6;

template <class Image>
void check_coefficients(Image image, const glm::dvec3& direction, double radius) {
  paint_disc(image, glm::normalize(direction), radius, {2e5, 1.5e5, 5e4});
  const ProjectionOptions options{.bands = kBands};
  const SphericalHarmonics before = project(image.view(), options).radiance;
  const auto sun = extract_sun(image);
  REQUIRE(sun);
  const SphericalHarmonics after = project(image.view(), options).radiance;
  std::vector<double> basis(kBands * kBands);
  evaluate_basis(sun->direction, kBands, basis);
  // A uniform disc of radius r has 1 - l(l+1) r^2 / 8 of a directional light's band l; the largest that a vector of
  // one band's functions can be is sqrt((2l + 1) / 4 pi).
  const double r = sun->angular_radius_degrees * std::numbers::pi / 180.0;
  for (int l = 0; l < kBands; ++l) {
    double difference = 0.0;
    for (int m = -l; m <= l; ++m) {
      const std::size_t i = SphericalHarmonics::index(l, m);
      const double missing = after.at(l, m).g + sun->irradiance.g * basis[i] - before.at(l, m).g;
      difference += missing * missing;
    }
    const double light = sun->irradiance.g * std::sqrt((2 * l + 1) / (4.0 * std::numbers::pi));
    CAPTURE(l, radius, std::sqrt(difference) / light);
    CHECK(std::sqrt(difference) < (1.1 * l * (l + 1) * r * r / 8.0 + 1e-6) * light);
    if (l == 2) CHECK(std::sqrt(difference) > 0.3 * l * (l + 1) * r * r / 8.0 * light);
  }
}

}  // namespace

TEST_CASE("A map's coefficients are those without the sun and those of its light", "[image][sun][truth]") {
  for (const glm::dvec3& direction : {glm::dvec3(1, 1, 1), glm::dvec3(0, 1, 0), glm::dvec3(-3, 2, 4)}) {
    for (const double radius : {0.8, 1.6, 2.4}) {
      check_coefficients(grey_lat_long(512, 256, 1.0F), direction, radius);
      check_coefficients(grey_cubemap(128, 1.0F), direction, radius);
    }
  }
}

// Suns in a lat-long's polar rows: their direction is that of their light, not of texels' centres.

namespace {

/// The mean direction of a texel, by a plain sum over its area.
glm::dvec3 centroid_of(int width, int height, int row, int column) {
  constexpr int cells = 64;
  glm::dvec3 sum(0.0);
  for (int j = 0; j < cells; ++j) {
    const double polar = std::numbers::pi * (row + (j + 0.5) / cells) / height;
    for (int i = 0; i < cells; ++i) {
      const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + (i + 0.5) / cells) / width);
      sum += std::sin(polar) *
             glm::dvec3(std::sin(polar) * std::sin(longitude), std::cos(polar), std::sin(polar) * std::cos(longitude));
    }
  }
  return glm::normalize(sum);
}

/// The rest and the sun, in harmonics, against the map before: the largest difference over the largest coefficient.
double loss(const LatLongImage& before, const LatLongImage& after, const Sun& sun, int bands) {
  const SphericalHarmonics whole = project(before.view(), {.bands = bands}).radiance;
  const SphericalHarmonics parts = add(project(after.view(), {.bands = bands}).radiance, sun_harmonics(sun, bands));
  double most = 0.0;
  for (std::size_t k = 0; k < whole.coefficients().size(); ++k) {
    most = std::max(most, std::abs(whole.coefficients()[k].g - parts.coefficients()[k].g));
  }
  return most / std::abs(whole.at(0, 0).g);
}

}  // namespace

TEST_CASE("A lamp of one texel beside the pole has the direction of the texel's light", "[image][sun]") {
  for (const int width : {128, 256, 512, 1024}) {
    for (const int row : {0, 1, 5, width / 2 - 1}) {
      CAPTURE(width, row);
      LatLongImage image = grey_lat_long(width, width / 2, 0.01F);
      const int column = width / 3;
      const auto texel = static_cast<std::size_t>(3 * (row * width + column));
      for (std::size_t c = 0; c < 3; ++c) image.pixels[texel + c] = 1e6F;
      LatLongImage rest = image;
      const auto sun = extract_sun(rest);
      REQUIRE(sun);
      CHECK(degrees_between(sun->direction, centroid_of(width, width / 2, row, column)) < 1e-3);
    }
  }
}

TEST_CASE("A sun beside the pole and the rest of its map make the map's harmonics again", "[image][sun][truth]") {
  for (const double off : {0.3, 2.0}) {
    const double angle = off * std::numbers::pi / 180.0;
    const glm::dvec3 direction(std::sin(angle) * 0.6, std::cos(angle), std::sin(angle) * 0.8);
    LatLongImage image = grey_lat_long(512, 256, 1.0F);
    paint_disc(image, direction, 0.265, glm::dvec3(2e5, 1.5e5, 5e4));
    LatLongImage rest = image;
    const auto sun = extract_sun(rest);
    REQUIRE(sun);
    CAPTURE(off);
    CHECK(loss(image, rest, *sun, 3) < 5e-5);
    CHECK(loss(image, rest, *sun, 8) < 1e-3);
  }
}

}  // namespace welkin::test
