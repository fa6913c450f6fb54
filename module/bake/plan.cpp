// Plans for people.
#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin {
namespace baking {
Plan plan_pixels(const SourceShape& source, const NeededOptions& needed, const StoredKinds& stored) {
  const BakePlan baking = plan_bake(source, needed.options, stored);
  Plan plan;
  plan.source = source.description();
  plan.options = needed.options;
  plan.take_specular = baking.stored_specular;
  plan.take_levels = baking.stored_background;
  plan.take_light = baking.stored_harmonics;
  plan.result_bytes = baking.result_bytes;
  plan.working_bytes = baking.working_bytes;
  for (const BakeStep& step : baking.steps) {
    PlannedPass& pass = plan.passes.emplace_back(step.planned);
    const bool skipped = pass.action == PassAction::skip;
    if (skipped && needed.left_out.contains(step.pass)) pass.reason = needed.left_out.at(step.pass);
    if (step.pass == BakePass::specular && pass.action == PassAction::run) pass.reason += needed.unused_mips;
  }
  return plan;
}

}  // namespace baking

const PlannedPass& Plan::pass(const std::string& name) const {
  const auto found = platform::ranges::find(passes, name, &PlannedPass::name);
  if (found == passes.end())
    throw Error(ErrorCode::invalid_argument, "the plan has no pass \"" + name + "\"; `passes` lists them");
  return *found;
}

Plan plan(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& full_options) {
  const platform::FloatingPointScope floating_point;
  check(needs);
  return baking::plan_pixels(source, baking::needed_options(source, needs, full_options), {});
}

Plan plan(const EnvironmentView& source, const SceneNeeds& needs, const BakeOptions& full_options) {
  return plan(shape_of(source), needs, full_options);
}

BakeResult bake(const EnvironmentView& source, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource pixels(source);
  return baking::run_bake(pixels, plan, nullptr, control);
}

namespace {

std::string padded_left(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string padded_right(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string milliseconds_text(double milliseconds) {
  return platform::number_text(milliseconds, std::chars_format::fixed, milliseconds < 10.0 ? 2 : 0);
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  if (bytes == 0) return "-";
  return platform::number_text(static_cast<double>(bytes) / kMebibyte, std::chars_format::fixed, 2);
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
  std::string text = "  " + padded_right(pass.name, width + 2) + padded_right(name(pass.action), 6);
  std::string reason = pass.reason;
  if (!measured.empty()) {
    double milliseconds = 0.0;
    const PassRecord* const record = record_of(measured, pass.name, milliseconds);
    text += padded_left(record == nullptr || skipped ? "-" : milliseconds_text(milliseconds), kNumber);
    if (record != nullptr && record->action != pass.action) reason = name(record->action) + (": " + record->reason);
  }
  return text + padded_left(bytes_text(pass.bytes), kNumber) + "  " + reason + '\n';
}

}  // namespace

std::string baking::passes_text(const std::vector<PlannedPass>& passes, const std::vector<PassRecord>& measured) {
  std::size_t width = 5;
  for (const PlannedPass& pass : passes) width = std::max(width, pass.name.size());
  std::string text = "  " + padded_right("pass", width + 2) + padded_right("", 6);
  if (!measured.empty()) text += padded_left("measured ms", kNumber);
  text += padded_left("MiB", kNumber) + "  why\n";
  double took = 0.0;
  for (const PlannedPass& pass : passes) {
    text += line_of(pass, measured, width);
    double milliseconds = 0.0;
    record_of(measured, pass.name, milliseconds);
    took += milliseconds;
  }
  if (!measured.empty())
    text += "  " + padded_right("sum", width + 8) + padded_left(milliseconds_text(took), kNumber) + '\n';
  return text;
}

std::string plan_text(const Plan& plan, const std::vector<PassRecord>& measured) {
  const platform::FloatingPointScope floating_point;
  return "Plan for " + plan.source + '\n' + baking::passes_text(plan.passes, measured) + "  at most " +
         bytes_text(plan.result_bytes) + " MiB of results and " + bytes_text(plan.working_bytes) +
         " MiB of working memory\n";
}

}  // namespace welkin
