// What a scene needs: on the command line and as JSON; and plans.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/arguments.h"
#include "tools/json.h"
#include "welkin/bake.h"

namespace welkin::tool {

struct NeedsChoice {
  std::optional<std::string> file;  ///< as it was named; it is read once, when the option is, as it may be a pipe
  std::optional<SceneNeeds> needs_in_file;
  std::optional<RoughnessRange> glossy;
  bool no_glossy = false;
  bool no_background = false;
  bool no_diffuse = false;
  bool explain = false;
  bool plan_only = false;

  /// Whether anything was said of the scene. Without it a bake does all that its options ask for.
  [[nodiscard]] bool any() const noexcept { return file || glossy || no_glossy || no_background || no_diffuse; }
  [[nodiscard]] bool explains() const noexcept { return explain || plan_only; }

  /// The file's, and what flags say on top; everything where nothing was said.
  [[nodiscard]] SceneNeeds needs() const;
};

/// The options throw as `read_needs`.
void add_needs_options(Options& table, NeedsChoice& choice);

/// Every member; "glossy" is {"minimum", "maximum"}, or null where there are no glossy materials.
[[nodiscard]] Json needs_json(const SceneNeeds& needs);
/// What is missing is as in a default `SceneNeeds`. Throws `Error`: file_access, limit_exceeded (more than a megabyte),
/// corrupt_file naming the key, for what is no JSON and for members of another name, kind or range.
[[nodiscard]] SceneNeeds read_needs(const std::filesystem::path& path);

[[nodiscard]] Json plan_json(const Plan& plan);

}  // namespace welkin::tool
