// Windows that are hard to find: hardly negative light, light that is nearly all direction, many bands.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/windowing.h"

namespace welkin::report::stability {
namespace {

constexpr double kPi = std::numbers::pi;

/// Radiance of two bands whose irradiance has the least value (1 - ratio) times its mean: a linear gradient.
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

SphericalHarmonics point_light(int bands) {
  SphericalHarmonics light(bands);
  std::vector<double> basis(light.coefficients().size());
  evaluate_basis(glm::normalize(glm::dvec3(0.3, -0.8, 0.5)), bands, basis);
  for (std::size_t k = 0; k < basis.size(); ++k) light.coefficients()[k] = glm::dvec3(basis[k]);
  return light;
}

/// The gradient's lambda in closed form: 1 / (1 + 4 lambda) = (1 + 1e-9) / ratio (the tolerance that is promised).
double gradient_lambda_error(double ratio) {
  const double truth = 0.25 * (ratio / (1.0 + 1e-9) - 1.0);
  return relative_error(apply_window(gradient(ratio, {0.48, 0.6, 0.64}), Window::least).parameter, truth);
}

/// How far below zero the irradiance still goes, over its mean, by looking in many directions.
double left_below_zero(const SphericalHarmonics& light) {
  const SphericalHarmonics irradiance = irradiance_from_radiance(apply_window(light, Window::least).radiance);
  const double mean = average_radiance(irradiance).x;
  double least = 0.0;
  for (const glm::dvec3& d : spread_directions(2000)) least = std::min(least, evaluate(irradiance, d).x);
  return -least / mean;
}

/// The least value of a lone band-limited light is on a ring: against a search along the ring's polar angle.
double ring_minimum_error(int bands) {
  const SphericalHarmonics light = point_light(bands);
  double truth = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 200000; ++k) {
    const double x = std::cos(kPi * k / 200000.0);
    double before = 1.0;
    double here = x;
    double sum = 1.0 / (4.0 * kPi) + (bands > 1 ? 3.0 * x / (4.0 * kPi) : 0.0);
    for (int l = 2; l < bands; ++l) {
      const double next = ((2.0 * l - 1.0) * x * here - (l - 1.0) * before) / l;
      before = here;
      here = next;
      sum += (2.0 * l + 1.0) * next / (4.0 * kPi);
    }
    truth = std::min(truth, sum);
  }
  return relative_error(minimum(light).value.x, truth);
}

double constant_minimum() {
  double worst = 0.0;
  for (const double value : {1e-300, 1.0, 1e300}) {
    worst = worse(worst, relative_error(minimum(constant_radiance(glm::dvec3(value), 16)).value.x, value));
  }
  return worst;
}

double refusals() {
  SphericalHarmonics dark = gradient(2.0, {0, 1, 0});
  dark.at(0, 0) = glm::dvec3(0.0);
  SphericalHarmonics broken = gradient(2.0, {0, 1, 0});
  broken.at(1, 0).y = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const SphericalHarmonics& light, Window window, double width) {
    return wrong_unless_thrown(ErrorCode::invalid_argument, [&] { (void)apply_window(light, window, width); });
  };
  const SphericalHarmonics light = gradient(2.0, {0, 1, 0});
  return refused(dark, Window::least, 0.0) + refused(broken, Window::least, 0.0) +
         refused(light, Window::hanning, -1.0) +
         refused(light, Window::lanczos, std::numeric_limits<double>::infinity());
}

/// Widths that are tiny leave band 0 alone; huge ones change nothing.
double width_error() {
  const SphericalHarmonics light = point_light(6);
  double worst = 0.0;
  for (const Window window : {Window::hanning, Window::lanczos}) {
    worst = worse(worst, norm(apply_window(light, window, 1e-300).radiance, 1));
    worst = worse(worst, relative_error(apply_window(light, window, 1e12).radiance, light));
  }
  return worst;
}

/// The same light, turned, asks for the same window.
double turned_lambda_error(int bands) {
  const SphericalHarmonics light = point_light(bands);
  const double lambda = apply_window(light, Window::least).parameter;
  const glm::dquat turn(0.3, 0.4, -0.2, 0.7);
  return relative_error(apply_window(rotate(light, turn), Window::least).parameter, lambda);
}

/// Factors 2^-300 to 2^300 on the light change nothing but its size.
double scaled_lambda_error() {
  const SphericalHarmonics light = point_light(3);
  const double lambda = apply_window(light, Window::least).parameter;
  double worst = 0.0;
  for (const double factor : {0x1p-300, 0x1p300}) {
    worst =
        worse(worst, relative_error(apply_window(scale(light, glm::dvec3(factor)), Window::least).parameter, lambda));
  }
  return worst;
}

}  // namespace

void add_window_cases(StabilityCases& cases) {
  const auto add = [&](const std::string& name, const std::string& promise, const std::string& truth, double bound,
                       std::function<double()> measure, StabilityUnit unit = StabilityUnit::relative,
                       Effort effort = Effort::quick) {
    cases.push_back(
        {"windows/" + name, promise, truth, unit, bound, [measure](const Control&) { return measure(); }, {}, effort});
  };
  for (const auto& [text, ratio, bound] : {std::tuple{"1+1e-6", 1.0 + 1e-6, 1e-2},
                                           {"1.001", 1.001, 1e-5},
                                           {"2", 2.0, 1e-8},
                                           {"1e6", 1e6, 1e-8},
                                           {"1e12", 1e12, 1e-8}}) {
    add(std::string("lambda-gradient-") + text,
        "least window of a gradient whose least irradiance is 1 - (" + std::string(text) + ") of its mean",
        "closed form of lambda", bound, [ratio = ratio] { return gradient_lambda_error(ratio); });
    add(std::string("least-gradient-") + text, "no irradiance below -1e-9 of its mean after it", "2000 directions",
        1.0000001e-9, [ratio = ratio] {
          return left_below_zero(gradient(ratio, {0.48, 0.6, 0.64}));
        });
  }
  for (const int bands : {3, 5, 16}) {
    const Effort effort = bands > 5 ? Effort::full : Effort::quick;
    add(
        "least-lone-light-" + std::to_string(bands),
        "a lone light of " + std::to_string(bands) + " bands: no irradiance below -1e-9 of its mean", "2000 directions",
        1.0000001e-9, [bands] { return left_below_zero(point_light(bands)); }, StabilityUnit::relative, effort);
    add(
        "turned-lone-light-" + std::to_string(bands), "lambda does not depend on how the light is turned",
        "that of the light before", 1e-6, [bands] { return turned_lambda_error(bands); }, StabilityUnit::relative,
        effort);
    add(
        "ring-minimum-" + std::to_string(bands), "the least value of a lone light lies on a ring, and is found",
        "200 001 points across the ring", 1e-8, [bands] { return ring_minimum_error(bands); }, StabilityUnit::relative,
        effort);
  }
  add("constant-minimum", "the least value of a constant from 1e-300 to 1e300", "closed form", 1e-14, constant_minimum);
  add("scaled-lambda", "lambda of light times 2^-300 and 2^300", "that of the light itself", 1e-12,
      scaled_lambda_error);
  add("widths", "widths of 1e-300 leave band 0 alone, widths of 1e12 change nothing", "closed form", 1e-15,
      width_error);
  add("refusals", "no light in band 0, NaN, widths that are none: refused", "the error's code", 0.0, refusals,
      StabilityUnit::count);
}

}  // namespace welkin::report::stability
