#include "perf/report/process.h"

#include <algorithm>
#include <chrono>

#include "welkin/core.h"

namespace welkin::report {

std::optional<double> process_seconds(const std::vector<std::string>& arguments, const Stopwatch& stopwatch) {
  using Steady = std::chrono::steady_clock;
  const Steady::time_point begin = Steady::now();
  double fastest = 0.0;
  for (int run = 0; run < stopwatch.most_runs; ++run) {
    const ProcessResult result = run_process(arguments, stopwatch.threads, stopwatch.clock());
    if (result.exit_code != 0) return std::nullopt;
    fastest = run == 0 ? result.seconds : std::min(fastest, result.seconds);
    if (std::chrono::duration<double>(Steady::now() - begin).count() >= stopwatch.budget_seconds) break;
  }
  return fastest;
}

namespace {

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#elif defined(__GNUC__)
  return "GCC " __VERSION__;
#else
  return "a compiler of no name";
#endif
}

/// Now, in UTC: "2026-11-25T03:00:00Z".
std::string date() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto day = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(now - day);
  const auto two = [](auto number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  return std::to_string(static_cast<int>(date.year())) + '-' + two(static_cast<unsigned>(date.month())) + '-' +
         two(static_cast<unsigned>(date.day())) + 'T' + two(time.hours().count()) + ':' + two(time.minutes().count()) +
         ':' + two(time.seconds().count()) + 'Z';
}

}  // namespace

Machine this_machine(const Stopwatch& stopwatch) {
  return {processor_name(),
          compiler(),
          welkin::name(active_instruction_set()),
          WELKIN_VERSION_STRING,
          name(stopwatch.clock()),
          date(),
          stopwatch.threads};
}

}  // namespace welkin::report
