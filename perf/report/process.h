// What the operating system is asked: clocks, the machine, other programs run and timed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "perf/report/measurement.h"
#include "perf/report/stopwatch.h"

namespace welkin::report {

/// Time that the calling thread has spent on processors.
[[nodiscard]] double processor_seconds();

/// A new folder of its own for temporary files. Throws `Error` (file_access).
[[nodiscard]] std::filesystem::path make_temporary_folder();

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

/// How many processors of what name.
[[nodiscard]] std::string processor_name();

/// Processor, compiler, instruction set in use, Welkin's version, clock, date, threads.
[[nodiscard]] Machine this_machine(const Stopwatch& stopwatch);

}  // namespace welkin::report
