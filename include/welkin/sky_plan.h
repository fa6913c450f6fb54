// Reflections of a computed sky, and plans for skies.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "welkin/atmosphere.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/plan.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"

namespace WELKIN_EXPORT welkin {

/// A sky cubemap of `options.size` prefiltered as `prefilter_specular` does; the sun's disc is left out unless asked
/// for. Throws `Error`: invalid_argument, limit_exceeded, cancelled.
[[nodiscard]] PrefilteredSpecular sky_specular(const SkyView& view, const dvec3& sun, const PrefilterOptions& options,
                                               const SkyPictureOptions& picture = {}, const Control& control = {});

// Plans for computed skies: which tables, and what of the light.
//
//   const welkin::SkyPlan plan = welkin::plan(welkin::earth(), {.glossy = std::nullopt});
//   const welkin::SkyBake sky = welkin::bake(plan, welkin::sun_direction(20.0, 145.0));
//   const auto light = sky.curve->at(sun);    // each frame

/// What is baked of a sky.
struct SkyBakeOptions {
  SkyTableOptions tables{};         ///< sizes and orders of the tables
  double altitude_m = 0.0;          ///< the observer's, above the ground
  int bands = 3;                    ///< 0 to kMaximumBands; those of `curve` and `harmonics` are not read
  SkyCurveOptions curve{};          ///< of a sun that moves
  SkyHarmonicsOptions harmonics{};  ///< of one that does not
  std::optional<PrefilterOptions> specular = PrefilterOptions{.size = 32};  ///< reflections; none: not made
  /// Texels along an edge of a sharp cubemap of the sky, at least 1; none: not made.
  std::optional<int> background_size = 256;
  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< the BRDF table; none: not made

  friend bool operator==(const SkyBakeOptions&, const SkyBakeOptions&) = default;
};

/// What a bake of a sky would do.
struct SkyPlan {
  Atmosphere atmosphere;            ///< as it was given
  std::string source;               ///< for a person
  std::vector<PlannedPass> passes;  ///< of the tables as `SkyTables::passes` names them, and what follows
  SkyBakeOptions options;           ///< what the scene does not need is left out of them
  int specular_source = 0;          ///< texels along an edge of the sky that the reflections are prefiltered from
  bool tables = true;               ///< whether anything looks into them
  bool curve = false;               ///< harmonics over the sun's elevation; or of one sun, if there are bands
  std::uint64_t result_bytes = 0;   ///< memory of the results

  /// By its name. Throws `Error` (invalid_argument) if there is none.
  [[nodiscard]] const PlannedPass& pass(const std::string& name) const;
};

/// Plans a sky. Work for what the planet lacks is left out: without aerosol the second table of scattering, without
/// absorbers their shells, with one order the sources of the others. Throws `Error`
/// (invalid_argument) as `check` and `precompute_sky`.
[[nodiscard]] SkyPlan plan(const Atmosphere& atmosphere, const SceneNeeds& needs, const SkyBakeOptions& whole = {});

/// The results. What was not planned is empty.
struct SkyBake {
  std::shared_ptr<const SkyTables> tables;      ///< null if nothing is needed
  std::optional<SkyCurve> curve;                ///< of a sun that moves
  std::optional<SphericalHarmonics> radiance;   ///< of one that does not: what `SkyProjector` gives
  Sun sun;                                      ///< as a directional light
  std::optional<PrefilteredSpecular> specular;  ///< for this sun; about the vertical it can be turned
  std::optional<CubemapImage> background;       ///< the sky as a sharp cubemap
  std::shared_ptr<const BrdfTable> brdf;        ///< null: not made
  std::vector<PassRecord> passes;  ///< in the plan's order; of tables for more wavelengths than three some come again
};

/// Carries it out, for one sun. The same bits on any number of threads. Throws `Error` as the calls that it makes.
[[nodiscard]] SkyBake bake(const SkyPlan& plan, const dvec3& sun, const Control& control = {});

/// As `plan_text` of plan.h.
[[nodiscard]] std::string plan_text(const SkyPlan& plan, const std::vector<PassRecord>& measured = {});

}  // namespace welkin
