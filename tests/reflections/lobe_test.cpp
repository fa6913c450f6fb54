// The GGX lobe: closed forms, roughness of mips, and the double-precision reference for prefiltered mips.
#include "reflections/lobe.h"

#include "math/elementary.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/reflections.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: the lobe's closed forms and its spectrum are those of k(c) = c D, to 1e-10.

namespace {

constexpr double kPi = std::numbers::pi;

/// The lobe as reflections.h writes it.
double textbook_lobe(double c, double a) {
  if (c <= 0.0) return 0.0;
  const double h2 = (1.0 + c) / 2.0;
  const double root = h2 * (a * a - 1.0) + 1.0;
  return c * a * a / (kPi * root * root);
}

/// Simpson's rule in t, c = 1 - t^4: dense where the lobe is sharp.
template <class Function>
double integral(const Function& function) {
  constexpr int steps = 200'000;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double weight = i == 0 || i == steps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * function(1.0 - t * t * t * t) * 4.0 * t * t * t;
  }
  return 2.0 * kPi * sum / (3.0 * steps);
}

/// Returns Sum (2l + 1) / (4 pi) k_l / k_0 P_l(c): the lobe over its integral, if there are enough bands.
double legendre_sum(const std::vector<double>& spectrum, double c) {
  double before = 0.0;
  double here = 1.0;
  double sum = 0.0;
  for (std::size_t l = 0; l < spectrum.size(); ++l) {
    const auto n = static_cast<double>(l);
    sum += (2.0 * n + 1.0) / (4.0 * kPi) * spectrum[l] * here;
    const double next = ((2.0 * n + 1.0) * c * here - n * before) / (n + 1.0);
    before = here;
    here = next;
  }
  return sum;
}

}  // namespace

TEST_CASE("The lobe is c times GGX's distribution", "[specular][lobe]") {
  for (const double alpha : {1.0, 0.5, 0.1, 0.0123, 1e-3}) {
    for (const double c : {1.0, 0.9999, 0.9, 0.5, 0.01, 0.0, -0.3}) {
      CAPTURE(alpha, c);
      CHECK(reflections::lobe(c, alpha) == Approx(textbook_lobe(c, alpha)).epsilon(1e-9));
    }
  }
}

TEST_CASE("The lobe's integral has a closed form", "[specular][lobe]") {
  CHECK(reflections::lobe_integral(1.0) == Approx(1.0).epsilon(1e-14));  // a cosine over pi
  for (const double alpha : {0.999, 0.96, 0.95, 0.9, 0.5, 0.1, 0.0123}) {
    CAPTURE(alpha);
    const double expected = integral([&](double c) { return textbook_lobe(c, alpha); });
    CHECK(reflections::lobe_integral(alpha) == Approx(expected).epsilon(1e-9));
  }
}

TEST_CASE("The spectrum of alpha 1 is the cosine lobe's", "[specular][lobe]") {
  const std::vector<double> spectrum = reflections::lobe_spectrum(1.0, 32);
  for (int l = 0; l < 32; ++l) {
    CAPTURE(l);
    CHECK(std::abs(spectrum[static_cast<std::size_t>(l)] - cosine_lobe(l) / kPi) < 1e-10);
  }
}

TEST_CASE("The spectrum is that of dense integration, l = 0 being 1", "[specular][lobe][truth]") {
  for (const double alpha : {0.7, 0.1, 0.0123, 2e-3}) {
    const std::vector<double> spectrum = reflections::lobe_spectrum(alpha, 61);
    CHECK(spectrum[0] == 1.0);
    for (const unsigned l : {1U, 17U, 60U}) {
      CAPTURE(alpha, l);
      const double expected = integral([&](double c) { return textbook_lobe(c, alpha) * std::legendre(l, c); });
      CHECK(std::abs(spectrum[l] - expected / reflections::lobe_integral(alpha)) < 1e-9);
    }
  }
}

TEST_CASE("Legendre sums of the spectrum give the lobe back at every angle", "[specular][lobe]") {
  for (const double alpha : {0.2, 0.05, 0.0123}) {
    const int bands = static_cast<int>(14.0 / alpha) + 200;
    const std::vector<double> spectrum = reflections::lobe_spectrum(alpha, bands);
    const double peak = reflections::lobe(1.0, alpha) / reflections::lobe_integral(alpha);
    for (const double c : {1.0, 0.9999, 0.99, 0.7, 0.2, -0.5, -1.0}) {
      CAPTURE(alpha, c);
      const double expected = reflections::lobe(c, alpha) / reflections::lobe_integral(alpha);
      // The kink at the horizon leaves a remainder that falls like l^-3/2.
      CHECK(std::abs(legendre_sum(spectrum, c) - expected) < 1e-9 * peak + 1e-3 * alpha * alpha);
    }
  }
}

TEST_CASE("More bands change none of the first", "[specular][lobe]") {
  for (const double alpha : {1.0, 0.1, 1e-3}) {
    const std::vector<double> few = reflections::lobe_spectrum(alpha, 64);
    const std::vector<double> many = reflections::lobe_spectrum(alpha, 1024);
    for (std::size_t l = 0; l < few.size(); ++l) CHECK(std::abs(few[l] - many[l]) < 1e-11);
  }
}

TEST_CASE("Our logarithm is the logarithm", "[tables]") {
  for (const double x : {1e-300, 1e-9, 0.3, 0.70710678, 0.7071068, 0.999999, 1.0, 1.000001, 1.4142135, 2.0, 3e5, 1e300})
    CHECK(std::abs(math::logarithm(x) - std::log(x)) < 5e-16 + 3e-16 * std::abs(std::log(x)));
  CHECK(math::logarithm(1.0) == 0.0);
}

// Promise: roughness of mips as the named engines have it, and the inverse.

TEST_CASE("Schedules are those of their engines", "[specular][roughness]") {
  const auto linear = mip_roughness(RoughnessSchedule::linear, 10, 512);
  const auto filament = mip_roughness(RoughnessSchedule::filament, 10, 512);
  const auto babylon = mip_roughness(RoughnessSchedule::babylon, 10, 512);
  for (int mip = 0; mip < 10; ++mip) {
    CAPTURE(mip);
    const auto i = static_cast<std::size_t>(mip);
    CHECK(linear[i] == Approx(mip / 9.0));
    CHECK(filament[i] == Approx(1.0 - std::sqrt(1.0 - mip / 9.0)));
    // CONVENTIONS: alpha = 2^(lod / 0.8) / width, 0 at mip 0
    const double alpha = mip == 0 ? 0.0 : std::min(1.0, std::pow(2.0, mip / 0.8) / 512.0);
    CHECK(babylon[i] == Approx(std::sqrt(alpha)));
  }
}

// Each shader looks up the roughness that we assign to a mip at that mip.

TEST_CASE("Unity's shader finds each mip's roughness at that mip", "[specular][roughness]") {
  const auto unity = mip_roughness(RoughnessSchedule::unity, 9, 256);
  for (int mip = 0; mip <= 6; ++mip) {
    const double r = unity[static_cast<std::size_t>(mip)];
    CHECK(6.0 * r * (1.7 - 0.7 * r) == Approx(mip).margin(1e-12));
  }
  CHECK(unity[6] == 1.0);
  CHECK(unity[8] == 1.0);
}

TEST_CASE("Unreal's shader finds each mip's roughness at that mip", "[specular][roughness]") {
  constexpr int kLast = 8;
  const auto unreal = mip_roughness(RoughnessSchedule::unreal, kLast + 1, 256);
  for (int mip = 1; mip <= kLast - 2; ++mip) {
    const double level_from_1x1 = 1.0 - 1.2 * std::log2(unreal[static_cast<std::size_t>(mip)]);
    CHECK(kLast - 1 - level_from_1x1 == Approx(mip));
  }
  CHECK(unreal[kLast - 1] == 1.0);
  CHECK(unreal[kLast] == 1.0);
}

TEST_CASE("A chain has as many mips as its schedule wants", "[specular][roughness]") {
  const auto mips = [](RoughnessSchedule schedule, int size) { return default_mip_count(schedule, size); };
  CHECK(mips(RoughnessSchedule::filament, 256) == 7);   // to 4 texels
  CHECK(mips(RoughnessSchedule::filament, 1024) == 9);  // to 4 texels
  CHECK(mips(RoughnessSchedule::linear, 32) == 5);      // to 2: five at least,
  CHECK(mips(RoughnessSchedule::linear, 4) == 3);       // where there are five
  CHECK(mips(RoughnessSchedule::filament, 1) == 1);
  CHECK(mips(RoughnessSchedule::unity, 256) == 7);
  CHECK(mips(RoughnessSchedule::unity, 16) == 5);
  CHECK(mips(RoughnessSchedule::unreal, 256) == 9);
  CHECK(mips(RoughnessSchedule::babylon, 256) == 9);
  CHECK(thrown_by([] { (void)default_mip_count(RoughnessSchedule::unity, 0); }).says("size"));
  CHECK(std::string(name(RoughnessSchedule::unreal)) == "unreal");
}

TEST_CASE("A shader's look-up finds the roughness that a mip has", "[specular][roughness]") {
  for (const auto schedule : {RoughnessSchedule::linear, RoughnessSchedule::filament}) {
    const auto table = mip_roughness(schedule, 9, 256);
    for (std::size_t mip = 0; mip < table.size(); ++mip)
      CHECK(mip_for_roughness(table, table[mip]) == Approx(static_cast<double>(mip)).margin(1e-12));
    CHECK(mip_for_roughness(table, 0.5 * (table[3] + table[4])) == Approx(3.5));
    CHECK(mip_for_roughness(table, -1.0) == 0.0);
    CHECK(mip_for_roughness(table, 2.0) == 8.0);
  }
  CHECK(mip_for_roughness({0.0, 0.5, 1.0, 1.0}, 1.0) == 2.0);  // Babylon's last mips are alike
}

TEST_CASE("What is no schedule is refused", "[specular][roughness]") {
  CHECK(thrown_by([] { (void)mip_roughness(RoughnessSchedule::linear, 0, 4); }).says("mips"));
  CHECK(thrown_by([] { (void)mip_roughness(RoughnessSchedule::linear, 17, 4); }).says("mips"));
  CHECK(thrown_by([] { (void)mip_roughness(RoughnessSchedule::linear, 1, 0); }).says("size"));
  CHECK(thrown_by([] { (void)mip_for_roughness({}, 0.5); }).says("empty"));
  CHECK(thrown_by([] { (void)mip_for_roughness({0.0, 0.6, 0.5}, 0.5); }).says("falls at mip 2"));
  CHECK(std::string(name(RoughnessSchedule::filament)) == "filament");
}

// Promise: the reference is the integral over texels as areas: against closed forms, dense integration, at any size.

namespace {

std::vector<glm::dvec3> some_directions(int count) {
  RandomLight light(3);
  std::vector<glm::dvec3> directions{{0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}};
  while (directions.size() < static_cast<std::size_t>(count)) directions.push_back(light.direction());
  return directions;
}

/// A dense midpoint rule, each texel cut into cells x cells.
glm::dvec3 brute_force(const TestLatLong& image, double alpha, const glm::dvec3& normal, int cells) {
  glm::dvec3 sum(0.0);
  double whole = 0.0;
  const double du = 2.0 * kPi / image.width / cells;
  const double dv = kPi / image.height / cells;
  for (int row = 0; row < image.height * cells; ++row) {
    const double v = kPi / 2.0 - (row + 0.5) * dv;
    for (int column = 0; column < image.width * cells; ++column) {
      const double u = kPi - (column + 0.5) * du;
      const glm::dvec3 d(std::sin(u) * std::cos(v), std::sin(v), std::cos(u) * std::cos(v));
      const float* const rgb = image.pixels.data() + 3 * ((row / cells) * image.width + column / cells);
      const double weight = reflections::lobe(glm::dot(normal, d), alpha) * std::cos(v) * du * dv;
      sum += weight * glm::dvec3(rgb[0], rgb[1], rgb[2]);
      whole += weight;
    }
  }
  return sum / whole;
}

}  // namespace

TEST_CASE("The truth of a uniform environment is its value, however narrow the lobe", "[specular][truth]") {
  const auto directions = some_directions(9);
  for (const double roughness : some_of(2, {0.01, 0.0316, 0.1, 0.3, 1.0, 0.7})) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {5, 3}, {64, 32}, {128, 64}}) {
      CAPTURE(roughness, width, height);
      const TestLatLong image = make_lat_long(Content::uniform, width, height, 0);
      for (const glm::dvec3& value : reference_specular(image.view(), roughness, directions))
        CHECK(glm::length(value - glm::dvec3(0.5, 1.0, 2.0)) < 1e-4);
    }
    for (const int size : {1, 3, 16}) {
      CAPTURE(roughness, size);
      const TestCubemap cube = make_cubemap(Content::uniform, size, 3, 0);
      for (const glm::dvec3& value : reference_specular(cube.view(), roughness, directions))
        CHECK(glm::length(value - glm::dvec3(0.5, 1.0, 2.0)) < 1e-4);
    }
  }
}

TEST_CASE("The truth of noise is dense integration's", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 16, 8, 21);
  const auto directions = some_directions(5);
  for (const double roughness : {0.25, 0.5, 1.0}) {
    const auto values = reference_specular(image.view(), roughness, directions);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      CAPTURE(roughness, k);
      const glm::dvec3 expected = brute_force(image, roughness * roughness, directions[k], 64);
      CHECK(glm::length(values[k] - expected) < 1e-3);
    }
  }
}

TEST_CASE("The truth of a tiny map is that of its texels cut into parts, to 1e-6", "[specular][truth]") {
  // A single texel shines: the mip holds only the part that the horizon leaves of it.
  const auto directions = some_directions(40);
  constexpr int parts = 3;
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {5, 4}}) {
    for (int texel = 0; texel < width * height; ++texel) {
      TestLatLong map = make_lat_long(Content::uniform, width, height, 0);
      TestLatLong fine = make_lat_long(Content::uniform, width * parts, height * parts, 0);
      const auto own = [&](int row, int column) { return row * width + column == texel ? 1e6F : 0.0F; };
      for (std::size_t k = 0; k < map.pixels.size(); ++k)
        map.pixels[k] = own(static_cast<int>(k / 3) / width, static_cast<int>(k / 3) % width);
      for (std::size_t k = 0; k < fine.pixels.size(); ++k) {
        const auto place = static_cast<int>(k / 3);
        fine.pixels[k] = own(place / fine.width / parts, place % fine.width / parts);
      }
      const auto values = reference_specular(map.view(), 1.0, directions);
      const auto expected = reference_specular(fine.view(), 1.0, directions);
      for (std::size_t k = 0; k < directions.size(); ++k) {
        CAPTURE(width, height, texel, k);
        CHECK(std::abs(values[k].r - expected[k].r) <= 1e-6 * expected[k].r + 1e-3);
      }
    }
  }
}

TEST_CASE("One small light gives the closed form of the lobe", "[specular][truth]") {
  // The light's size matters by (width of a texel)^2 / 12 times the lobe's curvature: 4e-5 of values near the horizon.
  constexpr int kWidth = 2048, kHeight = 1024;
  TestLatLong image = make_lat_long(Content::uniform, kWidth, kHeight, 0);
  std::fill(image.pixels.begin(), image.pixels.end(), 0.0F);
  const int row = 360;
  const int column = 1200;
  std::fill_n(image.pixels.begin() + 3 * (row * kWidth + column), 3, 1e6F);
  const glm::dvec3 light = image::lat_long_direction(kWidth, kHeight, column + 0.5, row + 0.5);
  const double total_radiance = 1e6 * image::lat_long_texel_solid_angle(kWidth, kHeight, row);
  for (const double roughness : {0.5, 1.0}) {
    const double alpha = roughness * roughness;
    const auto directions = some_directions(40);
    const auto values = reference_specular(image.view(), roughness, directions);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double cosine = glm::dot(light, directions[k]);
      if (std::abs(cosine) < 0.02) continue;  // the horizon cuts the texel
      CAPTURE(roughness, cosine);
      const double expected = total_radiance * reflections::lobe(cosine, alpha) / reflections::lobe_integral(alpha);
      CHECK(values[k].g == Approx(expected).epsilon(2e-4).margin(1e-12));
    }
  }
}

TEST_CASE("A lobe far narrower than texels sees the texel that it points into", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 32, 16, 2);
  const TestCubemap cube = make_cubemap(Content::random, 8, 3, 2);
  const glm::dvec3 d = image::lat_long_direction(32, 16, 11.5, 4.5);
  const auto lat_long = reference_specular(image.view(), 0.01, {d});
  CHECK(lat_long[0].r == Approx(image.pixels[3 * (4 * 32 + 11)]).epsilon(1e-3));
  CHECK(reference_specular(image.view(), 0.0, {d})[0].r == static_cast<double>(image.pixels[3 * (4 * 32 + 11)]));
  for (int face = 0; face < 6; ++face) {
    CAPTURE(face);
    const glm::dvec3 to = image::face_direction(8, face, 2.5, 5.5);
    const float expected = cube.pixels[static_cast<std::size_t>(3 * ((face * 8 + 5) * 8 + 2))];
    CHECK(reference_specular(cube.view(), 0.01, {to})[0].r == Approx(expected).epsilon(1e-3));
    CHECK(reference_specular(cube.view(), 0.0, {to})[0].r == static_cast<double>(expected));
  }
}

TEST_CASE("What the truth cannot be asked is refused", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 8, 4, 2);
  const auto call = [&](double roughness, const std::vector<glm::dvec3>& directions) {
    return thrown_by([&] { (void)reference_specular(image.view(), roughness, directions); });
  };
  CHECK(call(1.5, {{0, 1, 0}}).says("roughness 1.5"));
  CHECK(call(std::nan(""), {{0, 1, 0}}).code == ErrorCode::invalid_argument);
  CHECK(call(0.5, {}).says("0 directions"));
  CHECK(call(0.5, {{0, 1, 0}, {0, 0, 0}}).says("direction 1"));
}

}  // namespace welkin::test
