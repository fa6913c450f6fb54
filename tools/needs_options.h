// What a scene needs, on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "welkin/cost_model.h"
#include "welkin/scene_needs.h"

namespace welkin::tool {

struct NeedsChoice {
  std::optional<std::string> file;
  std::optional<RoughnessRange> glossy;
  bool no_glossy = false;
  bool no_background = false;
  bool no_diffuse = false;
  std::optional<double> error_budget;
  std::optional<std::string> costs_file;
  bool explain = false;
  bool plan_only = false;

  /// Whether anything was said of the scene. Without it a bake does all that its options ask for.
  [[nodiscard]] bool any() const noexcept {
    return file || glossy || no_glossy || no_background || no_diffuse || error_budget;
  }
  [[nodiscard]] bool explains() const noexcept { return explain || plan_only; }

  /// The file's, and what flags say on top; everything where nothing was said. Throws as `read_needs`.
  [[nodiscard]] SceneNeeds needs() const;
  /// Throws as `read_costs`.
  [[nodiscard]] CostModel costs() const;
};

void add_needs_options(CLI::App& command, NeedsChoice& choice);

}  // namespace welkin::tool
