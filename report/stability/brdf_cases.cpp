// The BRDF table at its ends: views that graze, roughness near 0 and 1.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "report/brdf_truth.h"
#include "report/stability/cases.h"
#include "report/stability/measures.h"
#include "welkin/brdf_table.h"

namespace welkin::report::stability {
namespace {

constexpr double kTableError = 1e-5;  ///< brdf_table.h

/// Worst errors of one column of a table (0: the most grazing view): of scale and bias, and of sheen.
struct ColumnError {
  double ggx = 0.0;
  double sheen = 0.0;
};

ColumnError column_error(int width, int height, int column) {
  const auto table = brdf_table({.width = width, .height = height});
  const double normal_view = (column + 0.5) / width;
  ColumnError worst;
  for (int row = 0; row < height; ++row) {
    const double roughness = (row + 0.5) / height;
    const float* const entry = table->values.data() + static_cast<std::ptrdiff_t>(3) * (row * width + column);
    const BrdfTruth truth = ggx_truth(normal_view, roughness * roughness);
    const double sheen = sheen_truth(normal_view, roughness * roughness);
    worst.ggx = worse(worst.ggx, worse(std::abs(entry[0] - truth.scale), std::abs(entry[1] - truth.bias)));
    worst.sheen = worse(worst.sheen, std::abs(entry[2] - sheen) / std::max(1.0, sheen));
  }
  return worst;
}

/// The smoothest row of a table: a mirror, nearly, for which scale + bias is 1 and bias is (1 - n.v)^5.
double mirror_error() {
  const auto table = brdf_table({.width = 64, .height = 4096, .sheen = false});
  double worst = 0.0;
  for (int column = 4; column < 64; ++column) {
    const double normal_view = (column + 0.5) / 64;
    const auto at = static_cast<std::size_t>(2 * column);
    const double bias = std::pow(1.0 - normal_view, 5.0);
    worst = worse(worst, std::abs(table->values[at] + table->values[at + 1] - 1.0));
    worst = worse(worst, std::abs(table->values[at + 1] - bias));
  }
  return worst;
}

/// What a table has beyond 0 and 1.
double energy_excess() {
  double worst = 0.0;
  const auto table = brdf_table({.width = 4096, .height = 4, .sheen = false});
  for (std::size_t k = 0; k < table->values.size(); k += 2) {
    const double scale = table->values[k];
    const double bias = table->values[k + 1];
    worst = worse(worst, worse(scale + bias - 1.0, worse(-scale, -bias)));
  }
  return std::max(0.0, worst);
}

/// Of sheen far above the halves: none becomes infinite.
double half_values_wrong() {
  const auto table = brdf_table({.width = 1024, .height = 64});
  double wrong = unsound(table->values);
  for (const std::uint16_t half : table->half_values()) wrong += wrong_if((half & 0x7C00U) == 0x7C00U);
  return wrong;
}

}  // namespace

void add_brdf_cases(StabilityCases& cases) {
  for (const auto& [width, height, column] : {std::tuple{64, 8, 0}, {1024, 8, 0}, {4096, 8, 0}, {4096, 8, 4095}}) {
    const std::string at = std::to_string(column) + "-of-" + std::to_string(width);
    const std::string view = "n.v = " + std::string(column > 0 ? "1 - 0.5 / " : "0.5 / ") + std::to_string(width);
    cases.push_back({"brdf/ggx-column-" + at, "scale and bias at " + view + ", 8 roughnesses, absolute",
                     "integral over the light's hemisphere in double", StabilityUnit::relative, kTableError,
                     [=, w = width, h = height, c = column](const Control&) { return column_error(w, h, c).ggx; }});
    cases.push_back({"brdf/sheen-column-" + at, "sheen at " + view + ", absolute, of its value where above 1",
                     "integral over the light's hemisphere in double", StabilityUnit::relative, kTableError,
                     [=, w = width, h = height, c = column](const Control&) { return column_error(w, h, c).sheen; }});
  }
  cases.push_back({"brdf/mirror", "at roughness 1.2e-4 scale + bias is 1 and bias (1 - n.v)^5 (n.v above 0.07)",
                   "closed form of a mirror", StabilityUnit::relative, kTableError,
                   [](const Control&) { return mirror_error(); }});
  cases.push_back({"brdf/energy", "scale and bias are not negative and their sum not above 1, n.v from 1.2e-4",
                   "energy", StabilityUnit::relative, kTableError, [](const Control&) { return energy_excess(); }});
  cases.push_back({"brdf/half-values", "sheen of hundreds at grazing angles is finite, as halves too", "65504 at most",
                   StabilityUnit::count, 0.0, [](const Control&) { return half_values_wrong(); }});
}

}  // namespace welkin::report::stability
