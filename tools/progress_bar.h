// A progress bar for work that makes a person wait.
#pragma once

#include <chrono>

#include "welkin/control.h"

namespace welkin::tool {

/// The part [from, to] of a control's progress, and its stop token. `control` must outlive what is returned.
[[nodiscard]] Control part_of(const Control& control, double from, double to);

/// Draws to standard error, and only if that is a terminal and the work has taken longer than a moment.
/// Its destructor wipes it away, so that neither results nor error messages share a line with it.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For the call whose progress is to be shown; must not outlive the bar.
  [[nodiscard]] Control control();

 private:
  using Clock = std::chrono::steady_clock;

  void report(double share);

  bool terminal_;
  Clock::time_point next_drawing_;
  bool drawn_ = false;
};

}  // namespace welkin::tool
