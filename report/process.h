// Another program, run and timed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/stopwatch.h"

namespace welkin::report {

struct ProcessResult {
  int exit_code = -1;    ///< -1: it could not be started or was ended by a signal
  double seconds = 0.0;  ///< from start to end, by the clock: of processor time all of its threads'
};

/// Runs `arguments[0]`, found on the PATH, bound to at most `threads` of the processors that this thread may use (0:
/// all of them), its output thrown away or written to `output`; its standard error is thrown away.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& arguments, int threads, Clock clock,
                                        const std::optional<std::filesystem::path>& output = std::nullopt);

/// The least time of several runs within the stopwatch's budget, once at least; none if one of them fails.
[[nodiscard]] std::optional<double> process_seconds(const std::vector<std::string>& arguments,
                                                    const Stopwatch& stopwatch);

/// Whether a program is on the PATH.
[[nodiscard]] bool on_path(const std::string& program);

}  // namespace welkin::report
