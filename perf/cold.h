// First calls: what a command, a level load or a web page waits for, which benchmarks of warm calls do not show.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// Runs each operation in processes of its own and returns a Markdown table per number of threads: times of the first,
/// second and last call, the fastest one after the first, page faults, and resident memory; then whole processes of
/// `welkin bake`, if that program lies beside `program`, which is this one. Arguments: `--threads=1,2` (default 1),
/// `--runs=N` processes per row (default 3; each number is its least), `--only=WORD` for names that contain it,
/// `--processor` for processor time of the calling thread where other programs use the machine, and a lat-long file in
/// place of the built-in environment.
[[nodiscard]] std::string cold_tables(const std::filesystem::path& program,
                                      const std::vector<std::filesystem::path>& arguments);

/// The child process of a row. Arguments: operation, folder of pixels, threads, clock. Returns what it measured as one
/// line.
[[nodiscard]] std::string cold_calls(const std::vector<std::filesystem::path>& arguments);

}  // namespace welkin::perf
