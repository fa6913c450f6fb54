// Rotations of coefficients, and windows that are hard to find.
#include <glm/gtc/quaternion.hpp>

#include "stability/cases.h"
#include "stability/measures.h"
#include "standard_headers.h"
#include "support/random_harmonics.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test::stability {

// Rotations: tiny ones, those by nearly 180 degrees, ten thousand in a row.
namespace {

constexpr double kPi = std::numbers::pi;
constexpr glm::dvec3 kWhite(1.0);

double number(std::uint32_t index) { return 2.0 * static_cast<double>(noise(77, index)) - 1.0; }

glm::dvec3 direction(std::uint32_t index) {
  return glm::normalize(glm::dvec3(number(3 * index), number(3 * index + 1), number(3 * index + 2)));
}

SphericalHarmonics random_light(int bands) {
  SphericalHarmonics light(bands);
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(bands * bands); ++k) {
    light.coefficients()[k] = {number(1000 + 3 * k), number(1001 + 3 * k), number(1002 + 3 * k)};
  }
  return light;
}

/// Rotates by Rodrigues' formula, in which a tiny angle's rotation is not rounded away.
glm::dvec3 rotate(const glm::dvec3& d, const glm::dvec3& axis, double angle) {
  const double half = std::sin(0.5 * angle);
  return d + std::sin(angle) * glm::cross(axis, d) + 2.0 * half * half * glm::cross(axis, glm::cross(axis, d));
}

glm::dquat rotate(const glm::dvec3& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

/// Rotates lights from several directions about several axes.
double rotated_light_error(double angle, int bands) {
  double worst = 0.0;
  for (std::uint32_t k = 0; k < 6; ++k) {
    const glm::dvec3 from = direction(k);
    const glm::dvec3 axis = k == 0 ? glm::dvec3(0, 1, 0) : direction(k + 50);
    worst = worse(worst, relative_error(rotate(point_light(from, kWhite, bands), rotate(axis, angle)),
                                        point_light(rotate(from, axis, angle), kWhite, bands)));
  }
  return worst;
}

/// Compares the change by a tiny rotation with its derivative: the rotated light's difference from itself per angle.
double tiny_change_error(double angle) {
  const glm::dvec3 from = direction(3);
  const glm::dvec3 axis = direction(60);
  const SphericalHarmonics light = point_light(from, kWhite, 2);
  const SphericalHarmonics after = rotate(light, rotate(axis, angle));
  const double scale = std::sqrt(3.0 / (4.0 * kPi));
  const glm::dvec3 velocity = glm::cross(axis, from);
  const glm::dvec3 found = glm::dvec3(after.at(1, 1).x - light.at(1, 1).x, after.at(1, -1).x - light.at(1, -1).x,
                                      after.at(1, 0).x - light.at(1, 0).x) /
                           (scale * angle);
  return relative_error(found, velocity);
}

struct Walk {
  double end;    ///< error against a single rotation
  double power;  ///< the worst band's drift
};

double band_power(const SphericalHarmonics& c, int l) {
  double sum = 0.0;
  for (int m = -l; m <= l; ++m) sum += glm::dot(c.at(l, m), c.at(l, m));
  return sum;
}

/// Rotates by `steps` small angles in succession.
Walk walk(int bands, int steps, const std::function<glm::dquat(std::uint32_t)>& step) {
  const SphericalHarmonics light = random_light(bands);
  SphericalHarmonics walked = light;
  glm::dquat total(1, 0, 0, 0);
  for (int k = 0; k < steps; ++k) {
    const glm::dquat small = step(static_cast<std::uint32_t>(k));
    walked = rotate(walked, small);
    total = glm::normalize(small * total);
  }
  Walk result{relative_error(walked, rotate(light, total)), 0.0};
  for (int l = 0; l < bands; ++l) {
    result.power = worse(result.power, relative_error(band_power(walked, l), band_power(light, l)));
  }
  return result;
}

glm::dquat random_step(std::uint32_t k) { return rotate(direction(1000 + k), 0.01 * (1.5 + number(90000 + k))); }
glm::dquat same_step(std::uint32_t) { return rotate(direction(5), 2.0 * kPi / 10000.0); }

double stretched_error(double length) {
  const glm::dquat q = rotate(direction(9), 1.1);
  const glm::dquat stretched(q.w * length, q.x * length, q.y * length, q.z * length);
  return relative_error(rotate(random_light(4), stretched), rotate(random_light(4), q));
}

double there_and_back(double angle) {
  const SphericalHarmonics light = random_light(16);
  const glm::dquat q = rotate(direction(11), angle);
  return relative_error(rotate(rotate(light, q), glm::conjugate(q)), light);
}

void add_angles(StabilityCases& cases) {
  const auto add = [&](const std::string& text, double angle) {
    for (const int bands : {3, 16}) {
      cases.add("by-" + text + "-bands-" + std::to_string(bands),
                "lights turned by " + text + " are where they were turned to, " + std::to_string(bands) + " bands",
                "harmonics of the turned direction (Rodrigues, double)", {1e-13},
                [=] { return rotated_light_error(angle, bands); });
    }
    cases.add("back-from-" + text, "a turn by " + text + " and back, 16 bands", "the light itself", {1e-13},
              [=] { return there_and_back(angle); });
  };
  for (const char* const text : {"1e-3", "1e-8", "1e-15", "1e-300"}) add(text, std::stod(text));
  add("pi-1e-3", kPi - 1e-3);
  add("pi-1e-8", kPi - 1e-8);
  add("pi-1e-15", kPi - 1e-15);
  add("pi", kPi);
}

void add_walks(StabilityCases& cases) {
  const auto add = [&](const std::string& kind, glm::dquat (*step)(std::uint32_t), int bands, Effort effort) {
    const std::string name = "10000-" + kind + "-steps-bands-" + std::to_string(bands);
    cases.add(name, "10 000 " + kind + " small steps end where one turn does", "one turn",
              {.bound = 1e-11, .effort = effort}, [=] { return walk(bands, 10000, step).end; });
    cases.add(name + "-power", "10 000 " + kind + " small steps keep each band's power", "power before",
              {.bound = 1e-11, .effort = effort}, [=] { return walk(bands, 10000, step).power; });
  };
  add("random", random_step, 3, Effort::quick);
  add("equal", same_step, 3, Effort::quick);
  add("random", random_step, 16, Effort::full);
  add("equal", same_step, 16, Effort::full);
}

}  // namespace

void add_rotation_cases(StabilityCases& cases) {
  add_angles(cases);
  add_walks(cases);
  for (const std::string length : {"1e-300", "1e-5", "1e300"}) {
    cases.add("quaternion-length-" + length, "a quaternion's length does not matter: " + length, "that of length 1",
              {1e-14}, [value = std::stod(length)] { return stretched_error(value); });
  }
  const std::string advice =
      "Coefficients are doubles near 1: a change below 1e-16 of them is not there, and one of 1e-10 has six digits "
      "left. "
      "Do not add up tiny turns' differences; keep the angle and turn the original light by it.";
  for (const std::string angle : {"1e-5", "1e-8", "1e-13"}) {
    cases.add("change-by-" + angle, "the change that a turn by " + angle + " makes is right to 1e-4 of itself",
              "its derivative, axis x direction", {.bound = 1e-4, .advice = angle == "1e-13" ? advice : ""},
              [value = std::stod(angle)] { return tiny_change_error(value); });
  }
}

// Windows that are hard to find: hardly negative light, light that is nearly all direction, many bands.
namespace {

/// Returns a linear gradient: radiance of two bands whose irradiance has the minimum (1 - ratio) times its mean.
SphericalHarmonics gradient(double ratio, const glm::dvec3& towards) {
  SphericalHarmonics light(2);
  const double y0 = 0.5 / std::sqrt(kPi);
  const double y1 = std::sqrt(3.0 / (4.0 * kPi));
  light.at(0, 0) = glm::dvec3(1.0);
  const double linear = ratio * cosine_lobe(0) * y0 / (cosine_lobe(1) * y1);
  const glm::dvec3 d = glm::normalize(towards);
  light.at(1, -1) = glm::dvec3(linear * d.y);
  light.at(1, 0) = glm::dvec3(linear * d.z);
  light.at(1, 1) = glm::dvec3(linear * d.x);
  return light;
}

/// Returns light from one direction that no axis favours.
SphericalHarmonics one_sided_light(int bands) {
  return point_light(glm::normalize(glm::dvec3(0.3, -0.8, 0.5)), kWhite, bands);
}

/// The gradient's lambda in closed form: 1 / (1 + 4 lambda) = (1 + 1e-9) / ratio (the tolerance that is promised).
double gradient_lambda_error(double ratio) {
  const double truth = 0.25 * (ratio / (1.0 + 1e-9) - 1.0);
  return relative_error(apply_window(gradient(ratio, {0.48, 0.6, 0.64}), Window::min_laplacian).parameter, truth);
}

/// Returns how far below zero the irradiance still goes in 2000 directions, over its mean.
double left_below_zero(const SphericalHarmonics& light) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(apply_window(light, Window::min_laplacian).radiance);
  const double mean = mean_radiance(irradiance).x;
  double lowest = 0.0;
  for (const glm::dvec3& d : spread_directions(2000)) lowest = std::min(lowest, evaluate(irradiance, d).x);
  return -lowest / mean;
}

/// Tiny widths leave nothing but band 0; huge ones change nothing.
double width_error() {
  const SphericalHarmonics light = one_sided_light(6);
  double worst = 0.0;
  for (const Window window : {Window::hanning, Window::lanczos}) {
    worst = worse(worst, norm(apply_window(light, window, 1e-300).radiance, 1));
    worst = worse(worst, relative_error(apply_window(light, window, 1e12).radiance, light));
  }
  return worst;
}

/// Rotated light has the same window.
double rotated_lambda_error(int bands) {
  const SphericalHarmonics light = one_sided_light(bands);
  const double lambda = apply_window(light, Window::min_laplacian).parameter;
  const glm::dquat rotation(0.3, 0.4, -0.2, 0.7);
  return relative_error(apply_window(rotate(light, rotation), Window::min_laplacian).parameter, lambda);
}

/// Factors 2^-300 to 2^300 on the light change nothing but its size.
double scaled_lambda_error() {
  const SphericalHarmonics light = one_sided_light(3);
  const double lambda = apply_window(light, Window::min_laplacian).parameter;
  double worst = 0.0;
  for (const double factor : {0x1p-300, 0x1p300}) {
    worst = worse(
        worst, relative_error(apply_window(scale(light, glm::dvec3(factor)), Window::min_laplacian).parameter, lambda));
  }
  return worst;
}

}  // namespace

void add_window_cases(StabilityCases& cases) {
  struct Gradient {
    std::string text;
    double ratio, bound;
  };
  for (const Gradient& g : {Gradient{"1+1e-6", 1.0 + 1e-6, 1e-2},
                            {"1.001", 1.001, 1e-5},
                            {"2", 2.0, 1e-8},
                            {"1e6", 1e6, 1e-8},
                            {"1e12", 1e12, 1e-8}}) {
    cases.add("lambda-gradient-" + g.text,
              "minimum-Laplacian window of a gradient whose smallest irradiance is 1 - (" + g.text + ") of its mean",
              "closed form of lambda", {g.bound}, [ratio = g.ratio] { return gradient_lambda_error(ratio); });
    cases.add("least-gradient-" + g.text, "no irradiance below -1e-9 of its mean after it", "2000 directions",
              {1.0000001e-9}, [ratio = g.ratio] {
                return left_below_zero(gradient(ratio, {0.48, 0.6, 0.64}));
              });
  }
  for (const int bands : {3, 5, 16}) {
    const std::string text = std::to_string(bands);
    const Effort effort = bands > 5 ? Effort::full : Effort::quick;
    cases.add("least-lone-light-" + text, "a lone light of " + text + " bands: no irradiance below -1e-9 of its mean",
              "2000 directions", {.bound = 1.0000001e-9, .effort = effort},
              [bands] { return left_below_zero(one_sided_light(bands)); });
    cases.add("turned-lone-light-" + text, "lambda does not depend on how the light is turned",
              "that of the light before", {.bound = 1e-6, .effort = effort},
              [bands] { return rotated_lambda_error(bands); });
  }
  cases.add("scaled-lambda", "lambda of light times 2^-300 and 2^300", "that of the light itself", {1e-12},
            scaled_lambda_error);
  cases.add("widths", "widths of 1e-300 leave band 0 alone, widths of 1e12 change nothing", "closed form", {1e-15},
            width_error);
}

}  // namespace welkin::test::stability
