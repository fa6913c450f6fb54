#include "perf/report/words.h"

#include <cmath>
#include <cstdio>

namespace welkin::report {
namespace {

std::string formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

std::string percent(double share) {
  if (std::isnan(share)) return "no number";
  const double value = 100.0 * share;
  const double size = std::abs(value);
  if (size == 0.0) return "0 %";
  if (size < 1e-3) return formatted("%.1e %%", value);
  return formatted(size < 9.95 ? "%.2g %%" : "%.0f %%", value);
}

std::string duration(double seconds) {
  if (std::isnan(seconds)) return "no number";
  if (seconds < 0.9995e-6) return formatted("%.3g ns", 1e9 * seconds);
  if (seconds < 0.9995e-3) return formatted("%.3g us", 1e6 * seconds);
  if (seconds < 0.9995) return formatted("%.3g ms", 1e3 * seconds);
  return formatted("%.3g s", seconds);
}

}  // namespace welkin::report
