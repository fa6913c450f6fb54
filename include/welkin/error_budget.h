// The cheapest setting of each pass whose error on this environment is under a budget, judged by this environment.
//
//   auto choice = welkin::choose_irradiance_bands(view, {.relative = 0.01});
//   if (choice.met) project(view, {.bands = choice.setting});
//
// Nothing here is a table of what usually is enough: every estimate compares results of the data at hand with better
// ones of it (a finer size, a finer quadrature, more orders), or sums what a setting leaves out of its spectrum.
// docs/error_budget.md has the maths, how honest the estimates were on random environments, and what fools them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "welkin/atmosphere.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// How errors over a sphere become one number, where a pass gives a function of direction.
enum class ErrorMeasure {
  rms,      ///< root mean square of the difference over that of the truth
  maximum,  ///< largest difference over the root mean square of the truth
};

/// What may be lost. Each pass says what it is relative to. All calls throw `Error` (invalid_argument) unless
/// 1e-6 <= relative <= 1.
struct ErrorBudget {
  double relative = 0.01;                        ///< 0.01 is 1 %
  ErrorMeasure measure = ErrorMeasure::maximum;  ///< which error the budget bounds

  friend bool operator==(const ErrorBudget&, const ErrorBudget&) = default;
};

/// A setting that was looked at.
template <class Setting>
struct EstimatedSetting {
  Setting setting{};                   ///< the setting that was judged
  double error_estimate = 0.0;         ///< meant to be at least the true one
  double predicted_nanoseconds = 0.0;  ///< of the pass at this setting, on one thread of docs/error_budget.md's machine
};

/// What was chosen, and what else was looked at.
template <class Setting>
struct BudgetChoice {
  Setting setting{};            ///< the cheapest under the budget; where none is, the one of the least estimated error
  double error_estimate = 0.0;  ///< relative, of the chosen setting
  double predicted_nanoseconds = 0.0;            ///< on one thread, by the cost model
  bool met = false;                              ///< whether the estimate is under the budget
  std::string relative_to;                       ///< what the errors are shares of
  std::vector<EstimatedSetting<Setting>> tried;  ///< in the order in which they were looked at
};

/// Target size of a cubemap with its mip chain. Error: |c - c*| / |c*| of all radiance coefficients, c* of the full
/// size.
///
/// Reads levels from the smallest up, each projected as `project` does with `exact` quadrature, until the differences
/// between the last ones say that what finer levels would still change is under the budget: four thirds of the texels
/// of the level chosen, and no finer one. Content that all levels read so far average away is not seen: see the docs.
/// `setting` is `options` with the level's size as `target_size` (none: the full size) and exact quadrature.
/// Throws `Error` as `project`.
[[nodiscard]] BudgetChoice<ProjectionOptions> choose_projection(std::span<const CubemapView> mips,
                                                                const ProjectionOptions& options = {},
                                                                const ErrorBudget& budget = {},
                                                                const Control& control = {});

/// The same where there is no chain: how small the environment may be made or rendered, and what the midpoint rule
/// would cost. Target sizes 1, 2, 4 ... and the full size by either rule are projected (those that are reduced by the
/// exact rule) and compared with the full size by the exact rule, so this reads all texels some ten times. The cheapest
/// setting of one projection is the full size, as docs/projection.md says; the targets are in `tried`.
[[nodiscard]] BudgetChoice<ProjectionOptions> choose_projection(const CubemapView& cubemap,
                                                                const ProjectionOptions& options = {},
                                                                const ErrorBudget& budget = {},
                                                                const Control& control = {});
[[nodiscard]] BudgetChoice<ProjectionOptions> choose_projection(const LatLongView& lat_long,
                                                                const ProjectionOptions& options = {},
                                                                const ErrorBudget& budget = {},
                                                                const Control& control = {});

/// What of an environment is not in its first bands: two numbers that bound what any higher band can do.
struct HighBands {
  double energy = 0.0;    ///< Int |L|^2 over the sphere, less the |c|^2 of the coefficients; channels added
  double absolute = 0.0;  ///< Int |L - mean| over the sphere, |.| the length over the channels
};

/// Harmonic bands that irradiance needs: 1, 2, 3, 5, 7 ... (the cosine lobe has no odd band above 1).
///
/// The bands of `radiance` above a setting are summed at some 400 normals; what lies beyond them is bounded by `high`
/// through the cosine lobe's own spectrum, so that only the maximum can be underestimated, by what lies between normals
/// (a tenth is added for that). `radiance` of 16 bands makes the bound small. Throws `Error` (invalid_argument).
[[nodiscard]] BudgetChoice<int> choose_irradiance_bands(const SphericalHarmonics& radiance, const HighBands& high,
                                                        const ErrorBudget& budget = {});

/// Reads the environment twice: 16 bands, and what is beyond them. Throws `Error` as `project`.
[[nodiscard]] BudgetChoice<int> choose_irradiance_bands(const CubemapView& cubemap, const ErrorBudget& budget = {},
                                                        const PixelPolicy& pixels = {}, const Control& control = {});
[[nodiscard]] BudgetChoice<int> choose_irradiance_bands(const LatLongView& lat_long, const ErrorBudget& budget = {},
                                                        const PixelPolicy& pixels = {}, const Control& control = {});

/// What one mip needs. Errors are rms over the sphere relative to the mip's own, whatever the budget's measure.
struct MipNeed {
  double roughness = 0.0;       ///< perceptual
  double error_estimate = 0.0;  ///< at the setting chosen
  int source_size = 0;          ///< the smallest face size to which the source may be reduced; 0: none that was tried
  double source_size_error = 0.0;  ///< estimated, of that reduction alone
};

/// A choice of `rms_error` and `maximum_error`, and what each mip can do with.
struct PrefilterChoice : BudgetChoice<PrefilterOptions> {
  std::vector<MipNeed> mips;  ///< one entry for each mip
};

/// How loose the bounds of `prefilter_specular` may be: `rms_error` (`maximum_error` is ten times that) from 1e-4 to
/// 1e-1 with `method` automatic. Errors are rms, of the worst mip that is not a copy.
///
/// One analysis of the environment gives the energy of each band; what a setting's truncation, taper and interpolation
/// do to each is known, so no setting is run. Mips below roughness 0.055 at default bounds are narrow, whose
/// error counts as 1e-3. `source_sizes`: whether to look for `MipNeed::source_size`
/// as well, which takes an analysis for each size tried.
/// Throws `Error` as `prefilter_specular`.
[[nodiscard]] PrefilterChoice choose_prefilter(const LatLongView& source, const PrefilterOptions& options = {},
                                               const ErrorBudget& budget = {}, bool source_sizes = false,
                                               const Control& control = {});
[[nodiscard]] PrefilterChoice choose_prefilter(const CubemapView& source, const PrefilterOptions& options = {},
                                               const ErrorBudget& budget = {}, bool source_sizes = false,
                                               const Control& control = {});

/// Directions of a sky's harmonics, for all of `suns` (towards the sun, at least one). Error: |c - c*| / |c*| of all
/// coefficients, of the worst sun with light, c* the converged quadrature of the same view.
///
/// Each number of directions is compared with one and a half times and twice as many, from the fewest up until the
/// budget is met; then fewer azimuths are tried. Bands and quadrature are those of `options`, its numbers are not
/// looked at. Throws `Error` as `SkyProjector`.
[[nodiscard]] BudgetChoice<SkyHarmonicsOptions> choose_sky_harmonics(const SkyView& view, std::span<const dvec3> suns,
                                                                     const SkyHarmonicsOptions& options = {},
                                                                     const ErrorBudget& budget = {});

/// What sizes and orders of tables are judged by: three bands of harmonics at one height.
struct SkyProbe {
  double altitude_m = 0.0;  ///< the observer's, above the ground
  std::vector<dvec3> suns;  ///< towards the sun, at least one

  friend bool operator==(const SkyProbe&, const SkyProbe&) = default;
};

/// Sizes of a sky's tables: an eighth, a quarter, a half of those of `most`, or all of it. Error as above against
/// tables without end of the same orders.
///
/// Tables are made from the smallest up; each differs from the ones of half its size by no less than its own error, as
/// long as errors halve with the size. So the tables chosen are made here as well (four thirds of their own time and
/// less): ask once for a kind of planet. Throws `Error` as `precompute_sky`.
[[nodiscard]] BudgetChoice<SkyTableOptions> choose_sky_tables(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                              const SkyTableOptions& most = {},
                                                              const ErrorBudget& budget = {},
                                                              const Control& control = {});

/// Orders of scattering, 1 to those of `most`, by small tables (a quarter of the sizes): the light that each order adds
/// falls geometrically, and the last ones' ratio says what all further ones would add. Error as above against all
/// orders. `setting` is `most` with these orders. Throws `Error` as `precompute_sky`.
[[nodiscard]] BudgetChoice<SkyTableOptions> choose_sky_orders(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                              const SkyTableOptions& most = {},
                                                              const ErrorBudget& budget = {},
                                                              const Control& control = {});

}  // namespace welkin
