// docs/notes/stability_table.md.
#include "stability/stability.h"
#include "standard_headers.h"

namespace welkin::test {
namespace {

/// Two significant digits, whatever the locale.
std::string number(double value) {
  if (std::isinf(value)) return "infinite";
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 2);
  return {text, end.ptr};
}

/// Lines of at most 120 columns.
std::string wrapped(const std::string& text) {
  constexpr std::size_t width = 120;
  std::string lines;
  std::size_t column = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::size_t length = end - start;
    if (column > 0) lines += column + 1 + length > width ? '\n' : ' ';
    column = column == 0 || column + 1 + length > width ? length : column + 1 + length;
    lines += text.substr(start, length);
    start = end + 1;
  }
  return lines + '\n';
}

std::string amount(double value, StabilityUnit unit) {
  switch (unit) {
    case StabilityUnit::relative: return number(value);
    case StabilityUnit::ulps: return number(value) + " ulp";
    case StabilityUnit::count: return number(value) + " wrong";
    case StabilityUnit::ratio: return number(value) + " x";
  }
  return number(value);
}

std::string row(const StabilityResult& result) {
  const std::string name = result.name.substr(result.subject.size() + 1);
  return "| " + name + " | " + result.promise + " | " + result.truth + " | " + amount(result.measured, result.unit) +
         " | " + amount(result.bound, result.unit) + " | " + (result.holds ? "yes" : "**no**") + " |\n";
}

std::string table(const std::vector<StabilityResult>& results, const StabilitySubject& subject) {
  std::string text;
  for (const StabilityResult& result : results) {
    if (result.subject == subject.name) text += row(result);
  }
  if (text.empty()) return text;
  return std::string("\n## ") + subject.name + "\n\n" + wrapped(subject.sentence) +
         "\n| case | promise | against | measured | bound | holds |\n|---|---|---|---|---|---|\n" + text;
}

/// Each advice once, with all cases that it is about and that do not hold.
std::string advice(const std::vector<StabilityResult>& results) {
  std::vector<std::string> seen;
  std::string text;
  for (const StabilityResult& result : results) {
    if (result.holds || result.advice.empty() || std::find(seen.begin(), seen.end(), result.advice) != seen.end())
      continue;
    seen.push_back(result.advice);
    std::string names;
    for (const StabilityResult& other : results) {
      if (!other.holds && other.advice == result.advice) names += (names.empty() ? "" : ", ") + other.name;
    }
    text += '\n' + wrapped("**" + names + "**: " + result.advice);
  }
  return text.empty() ? text : "\n## What does not hold, and what to do\n" + text;
}

std::string failures(const std::vector<StabilityResult>& results) {
  std::string text;
  for (const StabilityResult& result : results) {
    if (!result.failure.empty()) text += "- " + result.name + ": " + result.failure + "\n";
  }
  return text.empty() ? text : "\n## Cases that did not end\n\n" + text;
}

}  // namespace

std::string stability_markdown(const std::vector<StabilityResult>& results, const StabilityOrigin& origin) {
  const auto held =
      std::count_if(results.begin(), results.end(), [](const StabilityResult& result) { return result.holds; });
  std::string text = "# Stability: the table\n\n" +
                     wrapped(
                         "This page lists what Welkin promises for extreme numbers, the truth that each promise was "
                         "held against, and the error that was measured. A command writes the page. The summary for "
                         "people is [stability.md](../reference/stability.md).") +
                     "\n- Command: `" + origin.command + "`\n- Date: " + origin.date +
                     "\n- Machine: " + origin.machine + "\n- Cases: " + std::to_string(results.size()) + ", of which " +
                     std::to_string(held) + " hold; the end of the page says what to do about the others\n\n" +
                     wrapped(
                         "A number without a unit is a relative error. \"ulp\" is a unit in the last place of a float. "
                         "\"wrong\" counts answers that are wrong. \"x\" says how many times an error grew. The "
                         "library gives the same bits on every machine. The figures therefore depend on the machine "
                         "above only in the last bits of truths that use its mathematical library. `tests/stability` "
                         "holds the quick cases: a test fails if an error doubles, a promise breaks or a case "
                         "disappears.");
  for (const StabilitySubject& subject : stability_subjects()) text += table(results, subject);
  return text + advice(results) + failures(results);
}

}  // namespace welkin::test
