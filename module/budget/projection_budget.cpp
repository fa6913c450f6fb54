// How small an environment may be before it is projected.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "budget/budget.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"

namespace welkin {
namespace {

using budget::relative_difference;

/// Of float sums, against double: docs/projection.md, tested at 5e-7 there.
constexpr double kRounding = 5e-7;
/// Nanoseconds a texel and thread, docs/projection.md; a reduction on the fly takes some 2.5 / 1.2 times as long.
constexpr double kTexelNanoseconds = 0.5;
constexpr double kReductionFactor = 2.1;
/// See docs/error_budget.md.
constexpr double kSafety = 2.7;
constexpr double kLeastFall = 0.25;
constexpr double kMostFall = 1.0 / 3.0;
constexpr double kOfBefore = 0.3;
constexpr const char* kRelativeTo = "norm of the radiance coefficients at full size";

/// What finer levels may still change, from the differences between the last ones: they are quartered from level to
/// level where light is smooth and halve where it is a point's, which the factor covers. The series goes on as the last
/// two say, within bounds; the last one may be small by accident.
double still_to_come(const std::vector<double>& differences) {
  const double last = differences[differences.size() - 1];
  const double before = differences[differences.size() - 2];
  const double fall = before > 0.0 ? std::clamp(last / before, kLeastFall, kMostFall) : kMostFall;
  return std::max(kSafety * last * fall / (1.0 - fall), kOfBefore * before);
}

ProjectionOptions whole(ProjectionOptions options) {
  options.quadrature = Quadrature::exact;
  options.target_size.reset();
  return options;
}

double texels_of(const CubemapView& view) { return 6.0 * view.size * view.size; }
double texels_of(const LatLongView& view) { return 1.0 * view.width * view.height; }

/// The least target that leaves the source as it is.
int full_target(const CubemapView& view) { return view.size; }
int full_target(const LatLongView& view) { return std::max((view.width + 3) / 4, (view.height + 1) / 2); }

template <class View>
BudgetChoice<ProjectionOptions> compare_targets(const View& view, const ProjectionOptions& options,
                                                const ErrorBudget& budget, const Control& control) {
  budget::check_budget(budget);
  image::check_view(view);
  projection::check_options(options);
  BudgetChoice<ProjectionOptions> choice;
  choice.relative_to = kRelativeTo;
  const ProjectionOptions full = whole(options);
  const double reading = kTexelNanoseconds * texels_of(view);
  const Control quiet{control.stop, {}};
  const SphericalHarmonics truth = project(view, full, quiet).radiance;
  const auto sizes = static_cast<int>(std::bit_width(static_cast<unsigned>(full_target(view) - 1)));
  const auto look_at = [&](const ProjectionOptions& setting, double nanoseconds) {
    const double error = relative_difference(project(view, setting, quiet).radiance, truth) + kRounding;
    choice.tried.push_back({setting, error, nanoseconds});
    if (control.progress) control.progress(static_cast<double>(choice.tried.size()) / (sizes + 2));
  };
  for (int target = 1; target < full_target(view); target *= 2) {
    ProjectionOptions reduced = full;
    reduced.target_size = target;
    look_at(reduced, kReductionFactor * reading);
  }
  ProjectionOptions midpoint = full;
  midpoint.quadrature = Quadrature::midpoint;
  look_at(midpoint, reading);
  choice.tried.push_back({full, kRounding, reading});
  if (control.progress) control.progress(1.0);
  budget::settle(choice, budget);
  return choice;
}

}  // namespace

BudgetChoice<ProjectionOptions> choose_projection(std::span<const CubemapView> mips, const ProjectionOptions& options,
                                                  const ErrorBudget& budget, const Control& control) {
  const platform::FloatingPointScope floating_point;
  budget::check_budget(budget);
  if (mips.empty()) throw Error(ErrorCode::invalid_argument, "the mip chain has no level");
  BudgetChoice<ProjectionOptions> choice;
  choice.relative_to = kRelativeTo;
  std::vector<double> differences;
  SphericalHarmonics before;
  for (std::size_t level = mips.size(); level-- > 0;) {
    ProjectionOptions setting = whole(options);
    if (level > 0) setting.target_size = mips[level].size;
    // Through the chain's own call, which checks it.
    SphericalHarmonics radiance = project(mips, setting, {control.stop, {}}).radiance;
    if (level + 1 < mips.size()) differences.push_back(relative_difference(before, radiance));
    before = std::move(radiance);
    // Two differences at least, unless this is all there is.
    if (level > 0 && differences.size() < 2) continue;
    const double error = level > 0 ? still_to_come(differences) + kRounding : kRounding;
    choice.tried.push_back({setting, error, kTexelNanoseconds * texels_of(mips[level])});
    if (error <= budget.relative) break;
  }
  if (control.progress) control.progress(1.0);
  budget::settle(choice, budget);
  return choice;
}

BudgetChoice<ProjectionOptions> choose_projection(const CubemapView& cubemap, const ProjectionOptions& options,
                                                  const ErrorBudget& budget, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return compare_targets(cubemap, options, budget, control);
}

BudgetChoice<ProjectionOptions> choose_projection(const LatLongView& lat_long, const ProjectionOptions& options,
                                                  const ErrorBudget& budget, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return compare_targets(lat_long, options, budget, control);
}

}  // namespace welkin

namespace welkin::budget {
namespace {

constexpr double kLeastBudget = 1e-6;  ///< what float arithmetic leaves

}  // namespace

void check_budget(const ErrorBudget& budget) {
  if (budget.relative >= kLeastBudget && budget.relative <= 1.0) return;
  throw Error(ErrorCode::invalid_argument, "the error budget is " + platform::number_text(budget.relative) +
                                               "; it is a share of the result, from 1e-6 to 1 (0.01 is 1 %)");
}

double relative_difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double difference = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < b.coefficients().size(); ++k) {
    const glm::dvec3 off = a.coefficients()[k] - b.coefficients()[k];
    difference += glm::dot(off, off);
    whole += glm::dot(b.coefficients()[k], b.coefficients()[k]);
  }
  if (difference == 0.0) return 0.0;
  return whole > 0.0 ? std::sqrt(difference / whole) : std::numeric_limits<double>::infinity();
}

}  // namespace welkin::budget
