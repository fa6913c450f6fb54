// The plan of each mip of a prefiltered cubemap, and of how it will be made: decided before any pixel is read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "reflections/band_choice.h"
#include "reflections/bright_lights.h"
#include "reflections/lobe.h"
#include "reflections/lookups.h"
#include "reflections/near_sums.h"
#include "transform/spectrum.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

inline constexpr double kMinAlpha = 1e-6;  ///< below, a lobe is narrower than any texel by far: a copy

/// No wider lobe has near sums, nor does it decide how others are made.
inline constexpr double kMaxNearAlpha = 0.25;

/// Alpha of the GGX lobe that texels are compared through where a surface is matte: from 25 times the mean on they are
/// lights. A narrow lobe's peak is 1 / alpha^2 times its mean over the sphere, here 100, of which `find_bright_texels`
/// takes a quarter.
inline constexpr double kMatteLightAlpha = 0.1;

struct MipPlan {
  int size = 0;
  double roughness = 0.0;
  double lobe_roughness = 0.0;
  double alpha = 0.0;                  ///< of GGX; 0: a copy, or another lobe
  std::shared_ptr<const Lobe> lobe;    ///< null: a copy
  MipMethod method = MipMethod::copy;  ///< never `stored`
  BandChoice bands;                    ///< spectral
  NearSplit near;                      ///< with a face: harmonics make the far part of the lobe only
  std::optional<MipPair> to_next;      ///< this mip and the next of the whole chain of GGX lobes, if there is one

  /// alpha of a GGX lobe as narrow as what harmonics make of this one: a far part's spectrum falls faster than that.
  [[nodiscard]] double ring_alpha() const noexcept { return near.face > 0 ? std::max(alpha, 0.3 * near.reach) : alpha; }
  /// The rings of a spectral mip's synthesis.
  [[nodiscard]] transforms::GridSize grid() const noexcept;
};

struct PrefilterPlan {
  int size = 0;                ///< of the whole chain
  std::vector<MipPlan> mips;   ///< that are made
  int first_mip = 0;           ///< the first of them, counted in the whole chain
  double reach = 0.0;          ///< of lights, see `reach_for`
  ErrorBounds bounds;          ///< requested
  LookupFormula lookups;       ///< of the whole chain
  bool may_integrate = false;  ///< whether mips that harmonics do not bring within the bounds may be integrated
  int tightenings = 0;         ///< of the bounds that GGX lobes' spectral mips are made for: see `tightened`

  /// Bands of the transform that all spectral mips share; 0: none is made. Those of the whole chain, as which rings
  /// take part and in which groups they are summed follows from them: coefficients of low bands round otherwise in a
  /// transform of fewer.
  int bands = 0;

  // Values of the whole chain's spectral mips, as a mip must not change where others are left out.
  double light_alpha = 1.0;  ///< `Lobe::light_alpha`: decides which texels are extracted
  LightLobes lights;         ///< decide how those are cut into lights

  /// The family of lobes that options name, and of all but GGX what decides each lobe of the whole chain: roughness or
  /// spectrum.
  LobeFamily family = LobeFamily::ggx;
  std::vector<std::vector<double>> family_numbers;

  /// Lobes of the whole chain's spectral mips, as all of them decide how many bands this image takes.
  std::vector<std::shared_ptr<const Lobe>> spectral_lobes;
  std::vector<int> spectral_sizes;  ///< of their mips

  /// Alpha of the GGX lobe that is as narrow as the finest that harmonics make, which decides a cubemap's rings.
  double ring_alpha = 1.0;
  std::vector<MipPlan> near_mips;  ///< of the whole chain's spectral mips, those with near sums

  /// An irradiance cubemap over pi that is made of the same harmonics: a mip of roughness 1, which is the cosine. No
  /// mip's bits depend on it.
  std::optional<MipPlan> irradiance;
  ErrorBounds irradiance_bounds;

  /// Receives the image's energies (`whole_energies`), for callers that keep mips; null: not needed.
  std::shared_ptr<std::vector<float>> energies;

  /// Size of the whole chain's largest narrow mip, whose far part has the most bands; 0: there is none.
  int near_far_size = 0;

  /// Returns the plan without `sharp` and `rough` mips at its ends. The others keep their bits: all that they depend on
  /// stays that of the whole chain. Throws `Error` (invalid_argument) unless one mip at least is left.
  [[nodiscard]] PrefilterPlan without(int sharp, int rough) const;

  /// Returns the bounds that spectral mips of GGX lobes are made for.
  [[nodiscard]] ErrorBounds tight() const noexcept { return bounds.tightened(tightenings); }
  /// Returns the plan for mips that earlier steps do not serve, up to step `kMaxTightenings`: of GGX lobes, for an
  /// image with more energy than most, or with dark parts. On cubemaps near sums serve lobes for which those and fewer
  /// harmonics are cheaper; step 0 makes all narrow mips by them. Other lobes have one step, whose bands the image
  /// decides: step 0 has the bands that it begins with, any later step the most that it may come to.
  [[nodiscard]] PrefilterPlan at_step(int step, const ImageShape& image) const;

  /// Returns whether a mip is made by this method.
  [[nodiscard]] bool uses(MipMethod method) const noexcept;

  /// Rows of the lat-long, twice as wide, that a cubemap goes through on its way to harmonics: `rings_within` the
  /// bounds, or for lobes other than GGX the bands.
  [[nodiscard]] int rows_for_cubemap() const noexcept;
  /// Returns the texels along an edge to which a cubemap's faces of `face` are halved before that.
  [[nodiscard]] int face_for_cubemap(int face) const noexcept;
};

/// Returns the bounds of a chain.
[[nodiscard]] ErrorBounds bounds_of(const PrefilterOptions& options) noexcept;

/// Roughness of each mip of the whole chain. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<double> roughness_of_chain(const PrefilterOptions& options);

/// Throws `Error`: invalid_argument for options out of range, limit_exceeded for error bounds or lobes that are out of
/// reach.
[[nodiscard]] PrefilterPlan plan_prefilter(const PrefilterOptions& options);
[[nodiscard]] PrefilterPlan plan_prefilter(const LobeChainOptions& options);

}  // namespace welkin::reflections
