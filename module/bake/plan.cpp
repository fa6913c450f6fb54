// Plans for people: a bake of everything, minus what a scene does not need, as tables of passes.
#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "image/pixels.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "reflections/prefilter_plan.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::baking {
namespace {

constexpr const char* kNotGlossy = "the scene has no glossy materials";

void need_diffuse(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (needs.diffuse_bands == 0 && options.bands > 0) {
    options.total_radiance = false;
    needed.left_out[BakePass::project] = "the scene uses no diffuse light";
  }
  options.bands = std::min(options.bands, needs.diffuse_bands);
  if (!options.irradiance || (needs.irradiance_cubemap && needs.diffuse_bands > 1)) return;
  options.irradiance.reset();
  needed.left_out[BakePass::irradiance] = needs.diffuse_bands == 0   ? "the scene uses no diffuse light"
                                          : needs.diffuse_bands == 1 ? "the scene uses ambient light only"
                                                                     : "the scene evaluates coefficients instead";
}

void need_reflections(const SceneNeeds& needs, NeededOptions& needed) {
  BakeOptions& options = needed.options;
  if (!needs.glossy) {
    if (options.specular) needed.left_out[BakePass::specular] = kNotGlossy;
    if (options.brdf) needed.left_out[BakePass::brdf] = kNotGlossy;
    options.specular.reset();
    options.octahedral.reset();
    options.brdf.reset();
    return;
  }
  if (options.specular) {
    needed.unused_mips = keep_used_mips(*needs.glossy, *options.specular);
    if (options.octahedral && !needed.unused_mips.empty())
      options.octahedral->levels = std::min(options.octahedral->levels, *options.specular->mips);
  }
  if (!needs.brdf_table && options.brdf) {
    needed.left_out[BakePass::brdf] = "the engine has its own table";
    options.brdf.reset();
  }
}

/// Runs first: the background's size must not follow the specular cubemap's if that is made smaller or not at all.
void need_background(const SourceShape& source, const SceneNeeds& needs, NeededOptions& needed) {
  std::optional<BackgroundOptions>& background = needed.options.background;
  if (!background) return;
  if (!needs.background) {
    background.reset();
    needed.left_out[BakePass::background] = "the scene does not show it";
    return;
  }
  background->size = background_size(source, needed.options);
  if (needs.background_mips || !background->mips) return;
  background->mips = false;
  needed.left_out[BakePass::background_mips] = "the scene shows it at full size only";
}

}  // namespace

UsedMips used_mips(const std::vector<double>& roughness, const RoughnessRange& range) {
  const auto mips = static_cast<int>(roughness.size());
  if (!platform::ranges::is_sorted(roughness)) return {0, mips};  // unknown which mips shaders read
  const auto at = [&](int mip) { return roughness[static_cast<std::size_t>(mip)]; };
  int first = 0;
  while (first + 1 < mips && at(first + 1) <= range.minimum) ++first;
  while (first > 0 && at(first - 1) == at(first)) --first;  // a lookup may find either
  int last = mips - 1;
  while (last > first && at(last - 1) >= range.maximum) --last;
  while (last + 1 < mips && at(last + 1) == at(last)) ++last;
  return {first, last + 1 - first};
}

std::string keep_used_mips(const RoughnessRange& range, PrefilterOptions& options) {
  const std::vector<double> whole = reflections::roughness_of_chain(options);
  const UsedMips used = used_mips(whole, range);
  const int rougher = static_cast<int>(whole.size()) - used.first - used.count;
  if (used.first + rougher == 0) return {};
  const auto keep = [used](auto& of_mips) {
    const int given = static_cast<int>(of_mips.size());
    of_mips.erase(of_mips.begin() + std::min(given, used.first + used.count), of_mips.end());
    of_mips.erase(of_mips.begin(), of_mips.begin() + std::min(given, used.first));
  };
  options.size = std::max(1, options.size >> used.first);
  options.mips = used.count;
  options.roughness = whole;
  keep(options.roughness);
  keep(options.lobe_roughness);
  keep(options.spectra);
  return "; omitted: " + std::to_string(used.first) + " sharper, " + std::to_string(rougher) + " rougher";
}

NeededOptions needed_options(const SourceShape& source, const SceneNeeds& needs, const BakeOptions& full_options) {
  NeededOptions needed{full_options};
  need_background(source, needs, needed);
  need_diffuse(needs, needed);
  need_reflections(needs, needed);
  return needed;
}

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

const PlannedPass& pass_of(const std::vector<PlannedPass>& passes, const std::string& name) {
  const auto found = platform::ranges::find(passes, name, &PlannedPass::name);
  if (found == passes.end())
    throw Error(ErrorCode::invalid_argument, "the plan has no pass \"" + name + "\"; `passes` lists them");
  return *found;
}

}  // namespace welkin::baking

namespace welkin {

const PlannedPass& Plan::pass(const std::string& name) const { return baking::pass_of(passes, name); }

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

/// Returns the last record of that name, and adds up their times: the sky's tables have one per three wavelengths.
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

void check(const SceneNeeds& needs) {
  const platform::FloatingPointScope floating_point;
  image::require_range("diffuse_bands", needs.diffuse_bands, 0, kMaximumBands);
  if (!needs.glossy) return;
  const RoughnessRange& range = *needs.glossy;
  if (range.minimum >= 0.0 && range.minimum <= range.maximum && range.maximum <= 1.0) return;
  throw Error(ErrorCode::invalid_argument,
              "glossy materials' roughness is from " + platform::number_text(range.minimum) + " to " +
                  platform::number_text(range.maximum) + "; pass 0 <= minimum <= maximum <= 1");
}

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
