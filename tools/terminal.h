// The terminal and the process that the command runs in: all that it asks of the operating system by itself.
#pragma once

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "welkin/core.h"

namespace welkin::tool {

/// A token that asks work to stop once somebody wants the program to end: by Ctrl-C, or by the signals SIGTERM and
/// SIGHUP, unless the program was started with them ignored. A second signal ends it at once. From the first call on,
/// writing beyond the limit on a file's size is an error and no signal.
[[nodiscard]] std::stop_token stop_on_signals();

/// The signal that came; 0: none has.
[[nodiscard]] int caught_signal() noexcept;

/// Writes a finished result to standard output in one piece: after an error nothing is there that could be
/// taken for a result. Throws `Error` (file_access) if it cannot be written (a full disk, say).
void print_result(const std::string& text);

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

/// Why files cannot be made in a folder that is there; empty: they can.
[[nodiscard]] std::string reason_not_to_write_in(const std::filesystem::path& folder);

/// Runs another program of Welkin's in the place of this one: the file of that name beside this program's own, or else
/// on the PATH. Returns only by throwing: `Error` (file_access) if there is none or it cannot be run.
[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace welkin::tool
