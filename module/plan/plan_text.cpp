// Plans for people.
#include <algorithm>
#include <cstdio>
#include <string>

#include "welkin/plan.h"

namespace welkin {
namespace {

std::string padded_left(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string padded_right(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string milliseconds_text(double milliseconds) {
  char text[32];
  std::snprintf(text, sizeof text, milliseconds < 10.0 ? "%.2f" : "%.0f", milliseconds);
  return text;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  if (bytes == 0) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", static_cast<double>(bytes) / kMebibyte);
  return text;
}

/// Of passes of that name together: the sky's tables have one for every three wavelengths.
const PassRecord* record_of(const std::vector<PassRecord>& measured, const std::string& name, double& milliseconds) {
  const PassRecord* found = nullptr;
  milliseconds = 0.0;
  for (const PassRecord& record : measured) {
    if (record.name != name) continue;
    found = &record;
    milliseconds += record.milliseconds;
  }
  return found;
}

constexpr std::size_t kNumber = 14;

std::string line_of(const PlannedPass& pass, const std::vector<PassRecord>& measured, std::size_t width) {
  const bool skipped = pass.action == PassAction::skip;
  std::string text = "  " + padded_right(pass.name, width + 2) + padded_right(name(pass.action), 6) +
                     padded_left(skipped ? "-" : milliseconds_text(pass.predicted_milliseconds), kNumber);
  std::string reason = pass.reason;
  if (!measured.empty()) {
    double milliseconds = 0.0;
    const PassRecord* const record = record_of(measured, pass.name, milliseconds);
    text += padded_left(record == nullptr || skipped ? "-" : milliseconds_text(milliseconds), kNumber);
    if (record != nullptr && record->action != name(pass.action)) reason = record->action + ": " + record->reason;
  }
  return text + padded_left(bytes_text(pass.bytes), kNumber) + "  " + reason + '\n';
}

}  // namespace

std::string passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured) {
  std::size_t width = 5;
  for (const PlannedPass& pass : passes) width = std::max(width, pass.name.size());
  std::string text =
      "  " + padded_right("pass", width + 2) + padded_right("", 6) + padded_left("predicted ms", kNumber);
  if (!measured.empty()) text += padded_left("measured ms", kNumber);
  text += padded_left("MiB", kNumber) + "  why\n";
  double predicted = 0.0;
  double took = 0.0;
  for (const PlannedPass& pass : passes) {
    text += line_of(pass, measured, width);
    predicted += pass.predicted_milliseconds;
    double milliseconds = 0.0;
    record_of(measured, pass.name, milliseconds);
    took += milliseconds;
  }
  text += "  " + padded_right("sum", width + 8) + padded_left(milliseconds_text(predicted), kNumber);
  if (!measured.empty()) text += padded_left(milliseconds_text(took), kNumber);
  return text + '\n';
}

std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured) {
  return "Plan for " + plan.source + '\n' + passes_text(plan.passes, measured) + "  at most " +
         bytes_text(plan.result_bytes) + " MiB of results and " + bytes_text(plan.working_bytes) +
         " MiB of working memory; predicted on one thread\n";
}

}  // namespace welkin
