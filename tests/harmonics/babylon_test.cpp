// Babylon.js's polynomial: its formulas, what the real package answered to `record.mjs`, and what it answered to
// others.
#include <nlohmann/json.hpp>

#include "places.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/engines.h"
#include "welkin/projection.h"

namespace welkin::test {

// Promises: from the same harmonics, the same polynomial as Babylon.js 9.34, to the last bit; its terms mean what
// the header says.

namespace {

using nlohmann::json;

// Results of the real package for the seeded test cubemaps: tests/data/babylon.json.

/// A BabylonPolynomial as a list: x, y, z, xx, yy, zz, yz, zx, xy.
using PolynomialTerms = std::array<glm::dvec3, 9>;

PolynomialTerms terms(const BabylonPolynomial& p) { return {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}; }

/// Largest |found - expected| over all 27 entries, over the largest |expected|: infinite where nothing is
/// expected but something found, NaN if anything is.
double relative_deviation(const PolynomialTerms& found, const PolynomialTerms& expected) {
  double largest = 0.0;
  double deviation = 0.0;
  for (std::size_t term = 0; term < expected.size(); ++term) {
    for (int channel = 0; channel < 3; ++channel) {
      const double difference = std::abs(found[term][channel] - expected[term][channel]);
      if (std::isnan(difference)) return difference;
      deviation = std::max(deviation, difference);
      largest = std::max(largest, std::abs(expected[term][channel]));
    }
  }
  return deviation == 0.0 ? 0.0 : deviation / largest;
}

/// Recorded switches of Babylon.js as Welkin's midpoint options; `maximum_name` is what the clamp's maximum is called
/// in the record. Of a clamp at infinity only Babylon.js's lower bound is left, which Welkin has as a policy for
/// negatives.
ProjectionOptions babylon_options(const json& recorded, const char* maximum_name) {
  float maximum = RadianceClamp{}.maximum;
  if (const auto given = recorded.find(maximum_name); given != recorded.end()) {
    maximum = given->is_string() ? std::numeric_limits<float>::infinity() : given->get<float>();
  }
  ProjectionOptions options{.quadrature = Quadrature::midpoint};
  if (const int target = recorded.value("target", 0); target != 0) options.target_size = target;
  options.pixels.gamma = recorded.value("gamma", false);
  if (std::isinf(maximum)) {
    options.pixels.negative = NegativePolicy::replace;
  } else {
    options.pixels.clamp = RadianceClamp{maximum, recorded.value("preserve", false)};
  }
  return options;
}

struct RecordedCase {
  std::string group;
  Content content{};
  bool bytes = false;  ///< 8-bit channels, else float
  int size = 0;
  int channels = 0;
  std::uint32_t seed = 0;
  std::uint32_t checksum = 0;  ///< of the pixels that Babylon.js was given
  ProjectionOptions options;   ///< Welkin's equivalent
  PolynomialTerms polynomial{};
  std::optional<std::array<glm::dvec3, 9>> radiance;  ///< Babylon.js's own, odd orders negated; recorded for a few

  /// Group, content, size and options in a line.
  [[nodiscard]] std::string description() const;
};

std::string RecordedCase::description() const {
  std::ostringstream text;
  text << group << ": " << name(content) << (bytes ? " u8 " : " f32 ") << size << " x " << channels;
  if (options.pixels.gamma) text << ", gamma";
  if (!options.pixels.clamp) text << ", no clamp";
  if (options.pixels.clamp) text << ", maximum " << options.pixels.clamp->maximum;
  if (options.pixels.clamp && options.pixels.clamp->preserve_colour) text << " preserving colour";
  if (options.target_size) text << ", target " << *options.target_size;
  return text.str();
}

std::array<glm::dvec3, 9> triples_from(const json& recorded) {
  std::array<glm::dvec3, 9> triples{};
  for (std::size_t i = 0; i < triples.size(); ++i) {
    const json& triple = recorded.at(i);
    triples[i] = {triple.at(0).get<double>(), triple.at(1).get<double>(), triple.at(2).get<double>()};
  }
  return triples;
}

RecordedCase case_from(const json& recorded) {
  RecordedCase result;
  result.group = recorded.at("group").get<std::string>();
  result.content = content_named(recorded.at("content").get<std::string>());
  result.bytes = recorded.at("type") == "u8";
  result.size = recorded.at("size").get<int>();
  result.channels = recorded.at("channels").get<int>();
  result.seed = recorded.at("seed").get<std::uint32_t>();
  result.checksum = recorded.at("checksum").get<std::uint32_t>();
  result.options = babylon_options(recorded.at("options"), "maximum");
  result.polynomial = triples_from(recorded.at("polynomial"));
  if (recorded.contains("radiance")) result.radiance = triples_from(recorded.at("radiance"));
  return result;
}

std::vector<RecordedCase> read_cases() {
  std::ifstream file(WELKIN_TEST_DATA "/babylon.json");
  const json recorded = json::parse(file);
  std::vector<RecordedCase> cases;
  for (const json& entry : recorded.at("cases")) cases.push_back(case_from(entry));
  return cases;
}

/// All of them, read once.
const std::vector<RecordedCase>& recorded_cases() {
  static const std::vector<RecordedCase> cases = read_cases();
  return cases;
}

constexpr double kPi = std::numbers::pi;

/// Babylon.js's coefficients are Welkin's with the odd orders negated.
SphericalHarmonics from_babylon_signs(const std::array<glm::dvec3, 9>& theirs) {
  SphericalHarmonics ours(3);
  for (int l = 0; l < 3; ++l) {
    for (int m = -l; m <= l; ++m) {
      ours.at(l, m) = theirs[SphericalHarmonics::index(l, m)] * (m % 2 == 0 ? 1.0 : -1.0);
    }
  }
  return ours;
}

/// Nine coefficients without any symmetry, each channel its own.
SphericalHarmonics any_radiance(int bands) {
  SphericalHarmonics radiance(bands);
  double i = 0.0;
  for (glm::dvec3& coefficient : radiance.coefficients()) {
    i += 1.0;
    coefficient = {std::sin(i), std::cos(2.3 * i), 1.0 / i};
  }
  return radiance;
}

/// Band 1 and 2 monomials as radiance of 1: (l, m), basis constant.
SphericalHarmonics single(int l, int m, double value) {
  SphericalHarmonics radiance(3);
  radiance.at(l, m) = glm::dvec3(value);
  return radiance;
}

}  // namespace

TEST_CASE("from Babylon.js's own harmonics comes its own polynomial, to the last bit", "[babylon][sh]") {
  int compared = 0;
  for (const RecordedCase& recorded : recorded_cases()) {
    if (!recorded.radiance) continue;
    ++compared;
    INFO(recorded.description());
    CHECK(terms(babylon_polynomial(from_babylon_signs(*recorded.radiance))) == recorded.polynomial);
  }
  CHECK(compared >= 20);
}

TEST_CASE("each term of the polynomial answers to its own monomial of radiance", "[babylon][sh]") {
  // The lobe is carried twice: (2/3)^2 for band 1, (1/4)^2 for band 2. Constants are truncated to six digits.
  const double one_over_k1 = std::sqrt(4.0 * kPi / 3.0);
  const double one_over_k2 = std::sqrt(4.0 * kPi / 15.0);
  struct Expectation {
    int l, m;
    double value;  ///< the coefficient of the monomial
    PolynomialTerms polynomial;
  };
  const auto only = [](std::size_t term, double value) {
    PolynomialTerms list{};
    list[term] = glm::dvec3(value);
    return list;
  };
  PolynomialTerms difference{};  // of x^2 - y^2
  difference[3] = glm::dvec3(1.0 / 16.0);
  difference[4] = glm::dvec3(-1.0 / 16.0);
  PolynomialTerms zonal{};  // of 3 z^2 - 1 = 2 z^2 - x^2 - y^2
  zonal[3] = zonal[4] = glm::dvec3(-1.0 / 16.0);
  zonal[5] = glm::dvec3(2.0 / 16.0);
  const std::array<Expectation, 8> expectations{{
      {1, 1, one_over_k1, only(0, 4.0 / 9.0)},
      {1, -1, one_over_k1, only(1, 4.0 / 9.0)},
      {1, 0, one_over_k1, only(2, 4.0 / 9.0)},
      {2, -1, one_over_k2, only(6, 1.0 / 16.0)},
      {2, 1, one_over_k2, only(7, 1.0 / 16.0)},
      {2, -2, one_over_k2, only(8, 1.0 / 16.0)},
      {2, 2, 2.0 * one_over_k2, difference},
      {2, 0, std::sqrt(16.0 * kPi / 5.0), zonal},
  }};
  for (const Expectation& expected : expectations) {
    INFO("l = " << expected.l << ", m = " << expected.m);
    const PolynomialTerms found = terms(babylon_polynomial(single(expected.l, expected.m, expected.value)));
    CHECK(relative_deviation(found, expected.polynomial) <= 5e-6);
  }
}

TEST_CASE("a unit normal's value is the radiance with the cosine lobe carried twice", "[babylon][sh]") {
  const SphericalHarmonics radiance = any_radiance(3);
  const auto reflect = [](const SphericalHarmonics& light) {
    return lambertian_from_irradiance(irradiance_from_radiance(light));
  };
  const SphericalHarmonics twice = reflect(reflect(radiance));
  const BabylonPolynomial polynomial = babylon_polynomial(radiance);
  for (int i = 0; i < 50; ++i) {
    const double z = 1.0 - (2 * i + 1) / 50.0;
    const double ring = std::sqrt(1.0 - z * z);
    const glm::dvec3 normal{ring * std::cos(2.4 * i), ring * std::sin(2.4 * i), z};
    const glm::dvec3 found = evaluate(polynomial, normal);
    const glm::dvec3 expected = evaluate(twice, normal);
    for (int channel = 0; channel < 3; ++channel) CHECK(std::abs(found[channel] - expected[channel]) <= 1e-4);
  }
}

// Promise: in midpoint mode Welkin's polynomial is Babylon.js 9.34's, every entry within 1e-6 of the largest.
// The expected values come from the real package (tests/babylon/record.mjs); the ctest babylon_live asks it again.

namespace {

/// The promise for one case, on a cubemap of either channel type.
template <class Cubemap>
void check_case(const RecordedCase& recorded, const Cubemap& cubemap) {
  INFO(recorded.description());
  REQUIRE(checksum(cubemap.pixels) == recorded.checksum);
  const Projection projection = project(cubemap.view(), recorded.options);
  const double deviation = relative_deviation(terms(babylon_polynomial(projection.radiance)), recorded.polynomial);
  CHECK(deviation <= 1e-6);
}

void check_group(const std::string& group) {
  int checked = 0;
  for (const RecordedCase& recorded : recorded_cases()) {
    if (recorded.group != group) continue;
    ++checked;
    if (recorded.bytes) {
      check_case(recorded, make_cubemap_bytes(recorded.content, recorded.size, recorded.channels, recorded.seed));
    } else {
      check_case(recorded, make_cubemap(recorded.content, recorded.size, recorded.channels, recorded.seed));
    }
  }
  CHECK(checked >= 7);
}

}  // namespace

TEST_CASE("Babylon.js's polynomial of cubemaps of every kind, sizes 1 to 257", "[babylon]") {
  // Plain ones are uniform or blocky; the clamp cuts each channel or preserves colour; 8-bit ones are linear or
  // gamma-encoded; among NaN are infinities, negatives and denormals.
  for (const char* const group : {"random", "smooth", "plain", "high_range", "clamped", "gamma", "u8", "nan_bearing"}) {
    check_group(group);
  }
}

TEST_CASE("Babylon.js's polynomial with a target size: sizes 64, 100, 256 to 8, 16, 32, 48, 64", "[babylon][truth]") {
  check_group("target_size");
}

// This promise is also held against independently recorded results for independently chosen content: the 18 cubemaps of
// ../shared/oracles/web, remade here by the formulas of its gen_cases.mjs. That folder is not part of the repository;
// where it is missing, there is nothing to compare and the test says so.

namespace {

using Vector = std::array<double, 3>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// cubes.mjs's generator: [0, 1) in 32 bits.
class Generator {
 public:
  explicit Generator(std::uint32_t seed) : state_(seed) {}
  double operator()() {
    state_ += 0x9e3779b9U;
    std::uint32_t z = state_;
    z = (z ^ (z >> 16)) * 0x21f0aaadU;
    z = (z ^ (z >> 15)) * 0x735a2d97U;
    return static_cast<double>(z ^ (z >> 15)) / 4294967296.0;
  }

 private:
  std::uint32_t state_;
};

struct Texel {
  Vector direction;
  int face, column, row;
};

using Formula = std::function<Vector(const Texel&)>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Formula noise(
    std::uint32_t seed, std::function<double(double)> shape = [](double r) { return r; }) {
  return [generator = Generator(seed), shape = std::move(shape)](const Texel&) mutable {
    const double r = shape(generator());
    const double g = shape(generator());
    return Vector{r, g, shape(generator())};
  };
}

Formula sky(double sun, double width) {
  const Vector towards{0.4, 0.7, -0.6};
  const double length = std::sqrt(dot(towards, towards));
  return [=](const Texel& at) {
    const double up = std::max(at.direction[1], 0.0);
    const double t = 1.0 - up;
    const double glow = t * t * t * t;
    const double below = at.direction[1];
    Vector colour = below > 0.0 ? Vector{0.25 + 0.9 * glow, 0.45 + 0.7 * glow, 0.95 + 0.3 * glow}
                                : Vector{0.22 + 0.1 * below, 0.18 + 0.09 * below, 0.12 + 0.06 * below};
    const double cosine = dot(at.direction, {towards[0] / length, towards[1] / length, towards[2] / length});
    const double k = std::max(0.0, 1.0 - (1.0 - cosine) / width);
    return Vector{colour[0] + sun * k, colour[1] + 0.92 * sun * k, colour[2] + 0.8 * sun * k};
  };
}

Formula special(std::uint32_t seed, std::vector<double> list) {
  return [generator = Generator(seed), list = std::move(list)](const Texel&) mutable {
    const auto pick = [&] {
      const double value = generator();
      if (value >= 0.15) return value;
      return list[static_cast<std::size_t>(generator() * static_cast<double>(list.size()))];
    };
    const double r = pick();
    const double g = pick();
    return Vector{r, g, pick()};
  };
}

/// One face one colour, and a little of column and row in units of `step`.
Formula faces(int size, double step) {
  static constexpr std::array<Vector, 6> kColours{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}}};
  return [=](const Texel& at) {
    Vector colour{};
    for (int k = 0; k < 3; ++k) {
      const auto channel = static_cast<std::size_t>(k);
      colour[channel] = kColours[static_cast<std::size_t>(at.face)][channel] * (at.face + 1) +
                        (at.row * size + at.column) * (k + 1) * step;
    }
    return colour;
  };
}

Formula formula_of(const std::string& name) {
  if (name == "uniform_8") return [](const Texel&) { return Vector{0.5, 1, 2}; };
  if (name == "linear_64") {
    return [](const Texel& t) { return Vector{1 + t.direction[0], 1 + t.direction[1], 1 + t.direction[2]}; };
  }
  if (name == "quad_off_64") {
    return [](const Texel& t) {
      const auto& [x, y, z] = t.direction;
      return Vector{1 + x * y, 1 + y * z, 1 + z * x};
    };
  }
  if (name == "quad_diag_64") {
    return [](const Texel& t) {
      const auto& [x, y, z] = t.direction;
      return Vector{x * x, y * y, z * z};
    };
  }
  if (name == "faces_1") return faces(1, 0.0);
  if (name == "faces_2") return faces(2, 0.125);
  if (name == "faces_3") return faces(3, 0.0625);
  if (name == "orient_16") {
    return [](const Texel& t) { return Vector{t.face + 1.0, static_cast<double>(t.column), 2.0 * t.row}; };
  }
  if (name == "delta_64") {
    return [](const Texel& t) {
      return t.face == 2 && t.column == 40 && t.row == 11 ? Vector{4000, 3000, 2000} : Vector{0.1, 0.1, 0.1};
    };
  }
  if (name == "noise_64") return noise(1);
  if (name == "hdrnoise_256") return noise(2, [](double r) { return 0.02 / (1.0001 - r); });
  if (name == "sky_256") return sky(2000, 0.002);
  if (name == "sunclamp_256") return sky(60000, 0.0004);
  if (name == "special_8") {
    return special(3, {kNan, kInfinity, -kInfinity, -1, -0.0, 1e-42, 4096, 4096.0005, 1e30, 3.4e38, -1e30, 0.5});
  }
  if (name == "special_finite_8") return special(4, {-1, -0.0, 1e-42, 4096, 4096.0005, 1e30, 3.4e38, -1e30, 0.5});
  if (name == "gammafloat_16") return noise(5, [](double r) { return r * 1.5 - 0.2; });
  if (name == "ldr_64") return noise(6, [](double r) { return std::floor(r * 256); });
  if (name == "npot_100") return sky(50, 0.02);
  return nullptr;
}

/// Six packed RGB faces of `size`, filled in the order of cubes.mjs.
template <class Channel>
BasicTestCubemap<Channel> filled(int size, const Formula& formula) {
  static constexpr std::array<std::array<Vector, 3>, 6> kFrames{{
      {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}},
      {{{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}},
      {{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}},
      {{{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}},
      {{{0, 0, 1}, {1, 0, 0}, {0, -1, 0}}},
      {{{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}},
  }};
  BasicTestCubemap<Channel> map{size, 3, {}};
  for (int face = 0; face < 6; ++face) {
    const auto& [normal, along, down] = kFrames[static_cast<std::size_t>(face)];
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const double u = (column + 0.5) * 2.0 / size - 1.0;
        const double v = (row + 0.5) * 2.0 / size - 1.0;
        Vector direction{};
        for (std::size_t i = 0; i < 3; ++i) direction[i] = normal[i] + u * along[i] + v * down[i];
        const double inverse = 1.0 / std::sqrt(dot(direction, direction));
        for (double& component : direction) component *= inverse;
        for (const double value : formula({direction, face, column, row})) {
          map.pixels.push_back(static_cast<Channel>(value));
        }
      }
    }
  }
  return map;
}

/// The recorded polynomial; nothing where Babylon.js's answer is no number (JSON has it as a string).
std::optional<PolynomialTerms> polynomial_from(const json& recorded) {
  static constexpr std::array<const char*, 9> kKeys{"x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"};
  PolynomialTerms list{};
  for (std::size_t term = 0; term < kKeys.size(); ++term) {
    for (int channel = 0; channel < 3; ++channel) {
      const json& value = recorded.at(kKeys[term]).at(static_cast<std::size_t>(channel));
      if (!value.is_number()) return std::nullopt;
      list[term][channel] = value.get<double>();
    }
  }
  return list;
}

int check_runs(const json& file, const CubemapView& view) {
  int checked = 0;
  for (const auto& [run, recorded] : file.at("runs").items()) {
    const std::optional<PolynomialTerms> expected = polynomial_from(recorded.at("polynomial"));
    if (!expected) continue;
    INFO(file.at("name") << ", run " << run);
    const Projection projection = project(view, babylon_options(recorded.at("options"), "max"));
    const double deviation = relative_deviation(terms(babylon_polynomial(projection.radiance)), *expected);
    CHECK(deviation <= 1e-6);
    ++checked;
  }
  return checked;
}

}  // namespace

TEST_CASE("Babylon.js's polynomials of the shared oracle's cubemaps", "[babylon]") {
  const std::filesystem::path folder = WELKIN_SHARED "/oracles/web/expected";
  if (!std::filesystem::is_directory(folder)) {
    WARN("nothing to compare with: " << folder << " is not there");
    return;
  }
  int checked = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream stream(entry.path());
    const json file = json::parse(stream);
    const Formula formula = formula_of(file.at("name"));
    if (formula == nullptr) continue;
    const int size = file.at("size");
    if (file.at("type") == "u8") {
      checked += check_runs(file, filled<std::uint8_t>(size, formula).view());
    } else {
      checked += check_runs(file, filled<float>(size, formula).view());
    }
  }
  CHECK(checked >= 40);
}

}  // namespace welkin::test
