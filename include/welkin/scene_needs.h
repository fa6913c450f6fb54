// What a scene uses of its environment: what it does not use need not be baked.
//
//   welkin::SceneNeeds mobile{.diffuse_bands = 1, .glossy = std::nullopt, .background = false};
//   welkin::Plan plan = welkin::plan(panorama, mobile);
#pragma once

#include <optional>

#include "welkin/export.h"

namespace WELKIN_EXPORT welkin {

/// Perceptual roughness, as artists set it.
struct RoughnessRange {
  double minimum = 0.0;  ///< of the smoothest material
  double maximum = 1.0;  ///< of the roughest material

  friend bool operator==(const RoughnessRange&, const RoughnessRange&) = default;
};

/// The default uses everything, of diffuse light what three bands hold.
struct SceneNeeds {
  int diffuse_bands = 3;  ///< of diffuse light: 0 none is used, 1 ambient only, 3 as a rule; up to kMaximumBands
  bool irradiance_cubemap = true;  ///< shaders look diffuse light up in a cubemap; else coefficients are all they read

  /// Of all materials that reflect their surroundings; none: there are no glossy materials.
  std::optional<RoughnessRange> glossy = RoughnessRange{};

  bool background = true;       ///< something shows the environment itself
  bool background_mips = true;  ///< and shows it from afar, or blurred
  bool brdf_table = true;       ///< glossy materials read it; else the engine has one

  /// What an input file carries is taken as it is: the polynomial and the prefiltered chain of an .env, the levels of
  /// a KTX2. Off: it is computed from the pixels.
  bool stored_results = true;

  /// What is left is the very bits of a bake of everything (an irradiance cubemap from harmonics: of a bake with so
  /// many bands, `diffuse_bands` being all that it is evaluated from). Off: a chain of mips is planned for the
  /// roughness that there is alone, within the same bounds of error; of a cubemap that may be several times faster.
  bool same_bits = true;

  /// What each pass may lose, relative: 0.01 is 1 %, 1e-6 to 1. Each picks its cheapest setting whose estimated error
  /// on this environment is under it (rms over the sphere over the rms of the result; error_budget.h), or stays as it
  /// is where no estimate is. `same_bits` does not hold then, and nothing stored is taken: its error is unknown. Only
  /// plans of pixels can tell. None: nothing is lost beyond the bounds of the options.
  std::optional<double> error_budget = std::nullopt;

  bool sun_moves = true;  ///< of a computed sky: a curve over the sun's elevation; else the light of one sun

  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

/// Throws `Error` (invalid_argument) that names the member unless 0 <= diffuse_bands <= kMaximumBands, 0 <= minimum <=
/// maximum <= 1, and 1e-6 <= error_budget <= 1.
void check(const SceneNeeds& needs);

}  // namespace welkin
