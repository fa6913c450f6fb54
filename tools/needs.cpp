#include <vector>

#include "platform/text.h"
#include "tools/bake_options.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

void read_range(const Json& value, const std::string& where, std::optional<RoughnessRange>& target) {
  if (value.is_null()) {
    target.reset();
    return;
  }
  RoughnessRange range;
  read_object(value, where, {number("minimum", range.minimum), number("maximum", range.maximum)});
  if (!(range.minimum >= 0.0 && range.minimum <= range.maximum && range.maximum <= 1.0)) {
    throw Flaw{where + " goes from " + platform::number_text(range.minimum) + " to " +
               platform::number_text(range.maximum) + "; pass 0 <= minimum <= maximum <= 1"};
  }
  target = range;
}

Json range_json(const std::optional<RoughnessRange>& range) {
  if (!range) return nullptr;
  return {{"minimum", range->minimum}, {"maximum", range->maximum}};
}

std::vector<Member> members_of(SceneNeeds& needs) {
  return {whole_number("diffuse_bands", needs.diffuse_bands),
          flag("irradiance_cubemap", needs.irradiance_cubemap),
          {"glossy", [&needs](const Json& value, const std::string& where) { read_range(value, where, needs.glossy); },
           [&needs] { return range_json(needs.glossy); }},
          flag("background", needs.background),
          flag("background_mips", needs.background_mips),
          flag("brdf_table", needs.brdf_table),
          flag("stored_results", needs.stored_results),
          flag("sun_moves", needs.sun_moves)};
}

SceneNeeds needs_of(const Json& json) {
  SceneNeeds needs;
  read_object(json, "needs", members_of(needs));
  if (needs.diffuse_bands < 0 || needs.diffuse_bands > kMaximumBands) {
    throw Flaw{"needs.diffuse_bands is " + std::to_string(needs.diffuse_bands) + "; it must be from 0 to " +
               std::to_string(kMaximumBands)};
  }
  return needs;
}

}  // namespace

SceneNeeds NeedsChoice::needs() const {
  SceneNeeds needs;
  needs.diffuse_bands = kMaximumBands;  // limited by --bands
  if (needs_in_file) needs = *needs_in_file;
  if (glossy) needs.glossy = glossy;
  if (no_glossy) needs.glossy.reset();
  if (no_background) needs.background = false;
  if (no_diffuse) needs.diffuse_bands = 0;
  if (!any()) needs.stored_results = false;
  return needs;
}

void add_needs_options(Options& table, NeedsChoice& choice) {
  const auto set_range = [&choice](const std::vector<double>& range) {
    if (range[0] > range[1]) throw BadValue{"--glossy", "is decreasing; pass the lower roughness first"};
    choice.glossy = RoughnessRange{range[0], range[1]};
  };
  add_option(
      table, "--needs", On<std::string>([&choice](const std::string& file) {
        choice.needs_in_file =
            read_needs(choice.folder / platform::path_of(file), choice.folder.empty() ? Pipes::read : Pipes::refused);
        choice.file = file;
      }),
      "FILE", "A JSON file that lists what the scene uses (docs/guides/scene_needs.md); other parts are not baked");
  add_option(table, "--no-glossy", &choice.no_glossy, "", "No material reflects: no specular cubemap");
  add_option(table, "--glossy", On<std::vector<double>>(set_range), "MINIMUM,MAXIMUM",
             "The minimum and the maximum roughness of the materials; mips outside this range are not made (all are "
             "for an engine, which counts "
             "them)",
             {.bounds = number_between(0.0, 1.0), .list = List::commas, .count = 2, .excludes = {"--no-glossy"}});
  add_option(table, "--no-background", &choice.no_background, "", "The scene does not show the environment itself");
  add_option(table, "--no-diffuse", &choice.no_diffuse, "", "No diffuse light is used", {.excludes = {"--irradiance"}});
  add_option(table, "--explain", &choice.explain, "",
             "Print which passes run, are reused or skipped, and why; after the bake, print their "
             "times");
  add_option(table, "--plan-only", &choice.plan_only, "", "Print the plan and bake nothing");
}

Json needs_json(SceneNeeds needs) { return json_object(members_of(needs)); }

SceneNeeds read_needs(const std::filesystem::path& path, Pipes pipes) {
  try {
    return needs_of(read_json_file(path, "docs/guides/scene_needs.md describes its contents", kMaxJsonBytes, pipes));
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, platform::utf8(path) + ": " + flaw.message + "; correct the file");
  }
}

Json plan_json(const Plan& plan) {
  const Json passes = json_list(plan.passes, [](const PlannedPass& pass) -> Json {
    return {{"name", pass.name}, {"action", name(pass.action)}, {"reason", pass.reason}, {"bytes", pass.bytes}};
  });
  return {{"source", plan.source},
          {"passes", passes},
          {"result_bytes", plan.result_bytes},
          {"working_bytes", plan.working_bytes}};
}

}  // namespace welkin::tool
