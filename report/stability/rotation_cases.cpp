// Turns: tiny ones, those by nearly a half turn, ten thousand in a row.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::report::stability {
namespace {

constexpr double kPi = std::numbers::pi;

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

SphericalHarmonics point_light(const glm::dvec3& from, int bands) {
  SphericalHarmonics light(bands);
  std::vector<double> basis(light.coefficients().size());
  evaluate_basis(from, bands, basis);
  for (std::size_t k = 0; k < basis.size(); ++k) light.coefficients()[k] = glm::dvec3(basis[k]);
  return light;
}

/// Rodrigues' formula, in which a tiny angle's turn is not rounded away.
glm::dvec3 turned(const glm::dvec3& d, const glm::dvec3& axis, double angle) {
  const double half = std::sin(0.5 * angle);
  return d + std::sin(angle) * glm::cross(axis, d) + 2.0 * half * half * glm::cross(axis, glm::cross(axis, d));
}

glm::dquat turn(const glm::dvec3& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

/// Lights from several directions turned about several axes.
double turned_light_error(double angle, int bands) {
  double worst = 0.0;
  for (std::uint32_t k = 0; k < 6; ++k) {
    const glm::dvec3 from = direction(k);
    const glm::dvec3 axis = k == 0 ? glm::dvec3(0, 1, 0) : direction(k + 50);
    worst = worse(worst, relative_error(rotate(point_light(from, bands), turn(axis, angle)),
                                        point_light(turned(from, axis, angle), bands)));
  }
  return worst;
}

/// The change that a tiny turn makes against its derivative: the turned light's difference from itself, over the angle.
double tiny_change_error(double angle) {
  const glm::dvec3 from = direction(3);
  const glm::dvec3 axis = direction(60);
  const SphericalHarmonics light = point_light(from, 2);
  const SphericalHarmonics after = rotate(light, turn(axis, angle));
  const double scale = std::sqrt(3.0 / (4.0 * kPi));
  const glm::dvec3 velocity = glm::cross(axis, from);
  const glm::dvec3 found = glm::dvec3(after.at(1, 1).x - light.at(1, 1).x, after.at(1, -1).x - light.at(1, -1).x,
                                      after.at(1, 0).x - light.at(1, 0).x) /
                           (scale * angle);
  return relative_error(found, velocity);
}

struct Walk {
  double end;    ///< against one turn
  double power;  ///< the worst band's drift
};

double band_power(const SphericalHarmonics& c, int l) {
  double sum = 0.0;
  for (int m = -l; m <= l; ++m) sum += glm::dot(c.at(l, m), c.at(l, m));
  return sum;
}

/// `steps` small turns one after another.
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

glm::dquat random_step(std::uint32_t k) { return turn(direction(1000 + k), 0.01 * (1.5 + number(90000 + k))); }
glm::dquat same_step(std::uint32_t) { return turn(direction(5), 2.0 * kPi / 10000.0); }

double stretched_error(double length) {
  const glm::dquat q = turn(direction(9), 1.1);
  const glm::dquat stretched(q.w * length, q.x * length, q.y * length, q.z * length);
  return relative_error(rotate(random_light(4), stretched), rotate(random_light(4), q));
}

double there_and_back(double angle) {
  const SphericalHarmonics light = random_light(16);
  const glm::dquat q = turn(direction(11), angle);
  return relative_error(rotate(rotate(light, q), glm::conjugate(q)), light);
}

void add_angles(StabilityCases& cases) {
  const auto add = [&](const std::string& text, double angle) {
    for (const int bands : {3, 16}) {
      cases.push_back(
          {"rotation/by-" + text + "-bands-" + std::to_string(bands),
           "lights turned by " + text + " are where they were turned to, " + std::to_string(bands) + " bands",
           "harmonics of the turned direction (Rodrigues, double)", StabilityUnit::relative, 1e-13,
           [angle, bands](const Control&) { return turned_light_error(angle, bands); }});
    }
    cases.push_back({"rotation/back-from-" + text, "a turn by " + text + " and back, 16 bands", "the light itself",
                     StabilityUnit::relative, 1e-13, [angle](const Control&) { return there_and_back(angle); }});
  };
  for (const char* const text : {"1e-3", "1e-8", "1e-15", "1e-300"}) add(text, std::stod(text));
  add("pi-1e-3", kPi - 1e-3);
  add("pi-1e-8", kPi - 1e-8);
  add("pi-1e-15", kPi - 1e-15);
  add("pi", kPi);
}

void add_walks(StabilityCases& cases) {
  const auto add = [&](const char* kind, glm::dquat (*step)(std::uint32_t), int bands, Effort effort) {
    const std::string name = std::string("rotation/10000-") + kind + "-steps-bands-" + std::to_string(bands);
    cases.push_back({name,
                     std::string("10 000 ") + kind + " small steps end where one turn does",
                     "one turn",
                     StabilityUnit::relative,
                     1e-11,
                     [=](const Control&) { return walk(bands, 10000, step).end; },
                     {},
                     effort});
    cases.push_back({name + "-power",
                     std::string("10 000 ") + kind + " small steps keep each band's power",
                     "power before",
                     StabilityUnit::relative,
                     1e-11,
                     [=](const Control&) { return walk(bands, 10000, step).power; },
                     {},
                     effort});
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
  for (const char* const length : {"1e-300", "1e-5", "1e300"}) {
    cases.push_back({std::string("rotation/quaternion-length-") + length,
                     "a quaternion's length does not matter: " + std::string(length), "that of length 1",
                     StabilityUnit::relative, 1e-14,
                     [value = std::stod(length)](const Control&) { return stretched_error(value); }});
  }
  const std::string advice =
      "Coefficients are doubles near 1: a change below 1e-16 of them is not there, and one of 1e-10 has six digits "
      "left. "
      "Do not add up tiny turns' differences; keep the angle and turn the original light by it.";
  for (const char* const angle : {"1e-5", "1e-8", "1e-13"}) {
    cases.push_back({std::string("rotation/change-by-") + angle,
                     "the change that a turn by " + std::string(angle) + " makes is right to 1e-4 of itself",
                     "its derivative, axis x direction", StabilityUnit::relative, 1e-4,
                     [value = std::stod(angle)](const Control&) { return tiny_change_error(value); },
                     std::string(angle) == "1e-13" ? advice : ""});
  }
}

}  // namespace welkin::report::stability
