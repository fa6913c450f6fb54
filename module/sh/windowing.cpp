// Bands times a window's factors, and what that does to the least irradiance.
#include "welkin/windowing.h"

#include <cmath>
#include <numbers>
#include <string>

#include "sh/least_window.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"

namespace welkin {
namespace {

double hanning(int l, double width) {
  if (l >= width) return 0.0;
  return 0.5 * (1.0 + tables::sine_cosine_of_turns(l / (2.0 * width)).cosine);
}

double lanczos(int l, double width) {
  if (l == 0) return 1.0;
  if (l >= width) return 0.0;
  return tables::sine_cosine_of_turns(l / (2.0 * width)).sine / (std::numbers::pi * l / width);
}

double factor(Window window, int l, double parameter) {
  switch (window) {
    case Window::hanning: return l == 0 ? 1.0 : hanning(l, parameter);
    case Window::lanczos: return lanczos(l, parameter);
    case Window::least: return sh::least_window_factor(l, parameter);
    default: return 1.0;
  }
}

}  // namespace

const char* name(Window window) noexcept {
  switch (window) {
    case Window::hanning: return "hanning";
    case Window::lanczos: return "lanczos";
    case Window::least: return "least";
    default: return "none";
  }
}

Windowed apply_window(const SphericalHarmonics& radiance, Window window, double width) {
  // 1e12 bands of width leave every factor 1; beyond it l / width could vanish.
  if (!(width >= 0.0 && width <= 1e12)) {
    throw Error(ErrorCode::invalid_argument, "the window's width is " + std::to_string(width) +
                                                 " bands; it must be from 0 (the number of bands) to 1e12");
  }
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  Windowed result;
  if (window == Window::hanning || window == Window::lanczos) result.parameter = width > 0.0 ? width : radiance.bands();
  if (window == Window::least) result.parameter = sh::least_window_lambda(irradiance);
  for (int l = 0; l < radiance.bands(); ++l) result.factors.push_back(factor(window, l, result.parameter));
  result.radiance = sh::with_factors(radiance, result.factors);
  result.minimum_before = minimum(irradiance).value;
  result.minimum_after = minimum(sh::with_factors(irradiance, result.factors)).value;
  return result;
}

}  // namespace welkin
