// Which settings are worth having: none is both faster and more exact than one on the front.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/measurement.h"

namespace welkin::report {

/// Errors that a setting is recommended for.
inline constexpr double kErrorTargets[] = {0.001, 0.005, 0.01, 0.05};

/// Indices of the measurements on the Pareto front of rms error and time, by rising time. Of equal ones the first is on
/// it. Peers are left out: the front is of what can be chosen here. Errors or times that are no numbers are never on
/// it.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Measurement> measurements);

/// Index of the setting to take for an rms error of at most `target`: the fastest, but of those within `tolerance` of
/// the fastest's time, which noise cannot tell apart, the most exact one; it is on the front. None if no setting of
/// Welkin's reaches the target.
[[nodiscard]] std::optional<std::size_t> recommend(std::span<const Measurement> measurements, double target,
                                                   double tolerance = 0.05);

struct Recommendation {
  std::string pass;
  double target = 0.0;  ///< rms error
  std::optional<Measurement> setting;
};

/// For each pass and each of `kErrorTargets`.
[[nodiscard]] std::vector<Recommendation> recommendations(const Report& report);

}  // namespace welkin::report
