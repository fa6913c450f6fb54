// What happens where numbers are extreme: a named suite that measures every promise on its hardest cases. Errors are
// deterministic (the library gives the same bits everywhere), so a result can be compared with a recorded one.
#pragma once

#include "standard_headers.h"
#include "welkin/core.h"

namespace welkin::test {

/// What a number of a result counts.
enum class StabilityUnit {
  relative,  ///< error over the truth, or over what the promise names
  ulps,      ///< error in units of the last place of the float nearest to the truth
  count,     ///< answers that are wrong: 0 or it does not hold
  ratio,     ///< how many times an error grew
};

/// One case, measured.
struct StabilityResult {
  std::string name;       ///< subject/case, unique
  std::string subject;    ///< one of `stability_subjects()`
  std::string promise;    ///< what is promised there
  std::string truth;      ///< what it is measured against
  double measured = 0.0;  ///< infinity: an answer was not finite, or none came (`failure` says why)
  StabilityUnit unit = StabilityUnit::relative;
  double bound = 0.0;
  bool holds = false;   ///< measured <= bound
  std::string advice;   ///< where the promise cannot hold in float: what to do instead; else empty
  std::string failure;  ///< what was thrown, if the case did not end
};

/// Runs a subject's cases in their order; `quick`: without those that take long or much memory (faces of 2048 to 8192).
/// An exception in a case is its result (`failure`), not the end.
[[nodiscard]] std::vector<StabilityResult> run_stability(const std::string& subject, bool quick);

/// A group of cases.
struct StabilitySubject {
  const char* name;
  const char* sentence;  ///< for the page
};

/// The subjects in order, "range" to "sky-planet".
[[nodiscard]] std::vector<StabilitySubject> stability_subjects();

/// Where and when something was measured, for people.
struct StabilityOrigin {
  std::string date;       ///< 2026-11-22
  std::string machine;    ///< processor, instruction set, compiler
  std::string command{};  ///< that made the page
};

/// docs/notes/stability_table.md: a table a subject, then what does not hold and what to do. Paragraphs are wrapped at
/// 120 columns.
[[nodiscard]] std::string stability_markdown(const std::vector<StabilityResult>& results,
                                             const StabilityOrigin& origin);

}  // namespace welkin::test
