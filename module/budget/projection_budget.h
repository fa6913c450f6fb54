// What all choices share.
#pragma once

#include <utility>

#include "welkin/error_budget.h"

namespace welkin::budget {

/// Throws `Error` (invalid_argument).
void check_budget(const ErrorBudget& budget);

/// |a - b| / |b| over all coefficients and channels; 0 if both are black, infinite if b alone is. The same bands.
[[nodiscard]] double relative_difference(const SphericalHarmonics& a, const SphericalHarmonics& b);

/// Fills in what follows from `choice.tried`: the cheapest under the budget, or else the one of the least error.
template <class Setting>
void settle(BudgetChoice<Setting>& choice, const ErrorBudget& budget) {
  const EstimatedSetting<Setting>* best = nullptr;
  for (const EstimatedSetting<Setting>& entry : choice.tried) {
    const bool under = entry.estimated_error <= budget.relative;
    const bool better = best == nullptr || (under && !choice.met) ||
                        (under == choice.met && (under ? entry.predicted_nanoseconds < best->predicted_nanoseconds
                                                       : entry.estimated_error < best->estimated_error));
    if (!better) continue;
    best = &entry;
    choice.met = under;
  }
  if (best == nullptr) return;
  choice.setting = best->setting;
  choice.estimated_error = best->estimated_error;
  choice.predicted_nanoseconds = best->predicted_nanoseconds;
}

}  // namespace welkin::budget
