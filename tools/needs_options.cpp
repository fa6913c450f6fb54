#include "tools/needs_options.h"

#include <vector>

#include "tools/needs_file.h"
#include "tools/options.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

SceneNeeds NeedsChoice::needs() const {
  SceneNeeds needs;
  needs.diffuse_bands = kMaximumBands;  // as many as --bands asks for
  if (file) needs = read_needs(*file);
  if (glossy) needs.glossy = glossy;
  if (no_glossy) needs.glossy.reset();
  if (no_background) needs.background = false;
  if (no_diffuse) needs.diffuse_bands = 0;
  if (error_budget) needs.error_budget = error_budget;
  if (!any()) needs.stored_results = false;
  return needs;
}

CostModel NeedsChoice::costs() const { return costs_file ? read_costs(*costs_file) : CostModel(); }

void add_needs_options(CLI::App& command, NeedsChoice& choice) {
  command
      .add_option("--needs", choice.file,
                  "A JSON file that says what the scene uses (docs/plans.md); what it does not is not baked")
      ->type_name("FILE");
  CLI::Option* none = command.add_flag("--no-glossy", choice.no_glossy, "No material reflects: no specular cubemap");
  command
      .add_option_function<std::vector<double>>(
          "--glossy",
          [&choice](const std::vector<double>& range) {
            if (range[0] > range[1]) throw CLI::ValidationError("--glossy", "falls; give the least roughness first");
            choice.glossy = RoughnessRange{range[0], range[1]};
          },
          "The least and the greatest roughness of materials: mips beyond are not made")
      ->delimiter(',')
      ->expected(2)
      ->allow_extra_args(false)
      ->check(finite_between(0.0, 1.0))
      ->type_name("LEAST,GREATEST")
      ->excludes(none);
  command.add_flag("--no-background", choice.no_background, "Nothing shows the environment itself");
  command.add_flag("--no-diffuse", choice.no_diffuse, "No diffuse light is used");
  command
      .add_option(
          "--error-budget", choice.error_budget,
          "What each pass may lose, relative: 0.01 is 1 %. Each takes its cheapest setting whose error, estimated "
          "on this input, is under it; --explain says which. What the input carries is not taken")
      ->check(finite_between(1e-6, 1.0))
      ->type_name("SHARE");
  command.add_flag("--explain", choice.explain,
                   "Say which passes run, are reused or left out, and why; then predicted against measured times");
  command.add_flag("--plan-only", choice.plan_only, "The same, and bake nothing");
  command
      .add_option(
          "--costs", choice.costs_file,
          "A JSON file of what work costs on this machine, of 'welkin report --calibrate'; default stored ratios")
      ->type_name("FILE");
}

}  // namespace welkin::tool
