// From an environment's pixels to spherical harmonics.
//
//   welkin::CubemapView view{{px, nx, py, ny, pz, nz}, 1024, 0, welkin::PixelFormat::rgba16f};
//   welkin::Projection light = welkin::project(view);          // three bands, exact quadrature
//   auto irradiance = welkin::irradiance_from_radiance(light.radiance);
//
// Every call works in the caller's TBB arena, reads the pixels once and in place, and gives the same bits
// for any number of threads and on every instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Options

/// What a texel stands for while it is integrated.
enum class Quadrature {
  exact,     ///< its area: each basis function is integrated over the texel; no error at any size
  midpoint,  ///< its centre: basis function there times the solid angle, as Babylon.js does; error O(1/size^2)
};

/// What becomes of a NaN or an infinity.
enum class NonFinitePolicy {
  replace,  ///< it is replaced as `PixelPolicy` says, and counted
  reject,   ///< the call throws `Error` (rejected_pixel)
};

/// What becomes of a finite value below zero.
enum class NegativePolicy {
  keep,     ///< it counts as it is
  replace,  ///< it becomes 0, and is counted
  reject,   ///< the call throws `Error` (rejected_pixel)
};

/// An upper bound on radiance.
struct RadianceClamp {
  float maximum = 4096.0F;       ///< above 0; 4096 is Babylon.js's default
  bool preserve_colour = false;  ///< scale r, g and b together (no lower bound) instead of each to [0, maximum]

  friend bool operator==(const RadianceClamp&, const RadianceClamp&) = default;
};

/// What becomes of pixel values before they count as radiance. Calls that project, prefilter, bake or integrate pixels
/// take one. What takes none uses the values as they are, or the default policy.
struct PixelPolicy {
  /// None by default. What a clamp takes away is reported in the diagnostics.
  std::optional<RadianceClamp> clamp{};

  /// The pixels are gamma encoded: each channel is clamped to [0, 1] and raised to 2.2 (Babylon.js's
  /// gammaSpace). Not for the sRGB formats, which say so themselves. What that range cuts off is part of the
  /// decoding and is not reported as clamped.
  bool gamma = false;

  /// A replaced NaN becomes 0; a replaced +infinity the clamp's maximum or else 65504 (the largest half);
  /// a replaced -infinity 0.
  NonFinitePolicy nan = NonFinitePolicy::replace;
  NonFinitePolicy infinity = NonFinitePolicy::replace;  ///< what happens to infinities

  /// A replaced negative becomes 0. Real files contain small negatives, so they are kept by default.
  NegativePolicy negative = NegativePolicy::keep;

  friend bool operator==(const PixelPolicy&, const PixelPolicy&) = default;
};

/// How pixels become coefficients.
struct ProjectionOptions {
  int bands = 3;                              ///< 1 (ambient only) to kMaximumBands
  Quadrature quadrature = Quadrature::exact;  ///< how texels are integrated

  /// Edge of the cubemap face to which the environment is reduced first, at least 1; none: it is taken whole. A
  /// lat-long is reduced to 4 x target by 2 x target. With a mip chain, the level nearest to the target in log2 is
  /// read instead. A source that is no larger than the target is taken whole. Else
  /// - exact quadrature averages by solid angle, after gamma, clamp and policies;
  /// - midpoint averages a cubemap as Babylon.js does: target rounded down to a power of two, a plain box of
  ///   the raw values, before gamma, clamp and replacements. These then act on cells, and the counts in the
  ///   diagnostics are of cells; only `reject` looks at the texels;
  /// - midpoint averages a lat-long by plain area of pixels, target as it is, after gamma, clamp and policies.
  std::optional<int> target_size{};

  PixelPolicy pixels{};  ///< what becomes of their values first

  friend bool operator==(const ProjectionOptions&, const ProjectionOptions&) = default;
};

// ---- Results

/// What becomes of a step.
enum class PassAction {
  run,    ///< it is computed
  reuse,  ///< it is there already: in the file, in another pass's result, from before
  skip,   ///< nothing that is wanted needs it
};

/// "run", "reuse", "skip"
[[nodiscard]] const char* name(PassAction action) noexcept;

/// One step of a call: what was done, or why it was not.
struct PassRecord {
  std::string name;                     ///< "read", "reduce", "project", "cubemap", ...
  PassAction action = PassAction::run;  ///< what became of it
  std::string reason;                   ///< why that action
  double milliseconds = 0.0;            ///< wall time; 0 for what was skipped
};

/// How good a result is, and what was done to get it.
struct ProjectionDiagnostics {
  std::uint64_t texels = 0;               ///< read and projected
  std::uint64_t nans_replaced = 0;        ///< channel values
  std::uint64_t infinities_replaced = 0;  ///< channel values
  std::uint64_t negatives_replaced = 0;   ///< channel values
  std::uint64_t texels_clamped = 0;       ///< texels that the clamp changed
  dvec3 total_radiance_before_clamp{};  ///< integral of radiance over the sphere, before the clamp, after replacements
  dvec3 total_radiance{};               ///< the same as it was projected

  /// Estimated relative error |c - c*| / |c*| of the radiance coefficients, c* being the exact integral of
  /// the source's texels as areas. Not below the true error, except for a level of a mip chain, where it is a guess.
  double error_estimate = 0.0;

  std::vector<PassRecord> passes;  ///< wall time of each step
};

/// A projection's result.
struct Projection {
  SphericalHarmonics radiance;        ///< coefficients of the environment's radiance
  ProjectionDiagnostics diagnostics;  ///< what was read, replaced and clamped, and how exact the result is
};

// ---- Projection

/// Projects a cubemap, or a lat-long directly, without a cubemap in between.
///
/// Reads every texel once (or the levels that `target_size` picks), about 0.3 ns a texel and thread on a
/// machine with AVX-512, bounded by memory. Exact quadrature: relative error of the coefficient vector
/// below 5e-7 against double precision. Work under some 100 000 texels runs in the calling thread.
///
/// Throws `Error`: invalid_argument for a view or options out of range, rejected_pixel naming the first
/// offending texel (by face, then row, then column) under a `reject` policy, cancelled.
[[nodiscard]] Projection project(const EnvironmentView& environment, const ProjectionOptions& options = {},
                                 const Control& control = {});

/// Projects a cubemap that brings its mip chain: `mips[0]` is the full size, every further level half the
/// one before (rounded down, at least 1), all of one format. Only `target_size` makes use of the chain.
/// Throws as above, and invalid_argument for an empty or uneven chain.
[[nodiscard]] Projection project(std::span<const CubemapView> mips, const ProjectionOptions& options = {},
                                 const Control& control = {});

// ---- Many at once: the probes of a level
//
//   std::vector<welkin::dvec3> light(9 * probes.size());
//   welkin::project_many(probes, light);                        // the very bits of project(probes[k]) from 9 k on

/// Projects many cubemaps, of any sizes and formats: bands^2 coefficients of `probes[k]` are written from
/// `coefficients[bands^2 k]` on, in the order of `SphericalHarmonics::coefficients`.
///
/// Small ones (to 129 texels an edge) are projected whole by one thread each, side by side, and take no memory of
/// their own (except where they are reduced to a target size); larger ones one after the other by all
/// threads. The diagnostics are of all probes together: counts and total radiance are sums, the error estimate is the
/// largest. The same bits on any number of threads.
///
/// Throws as `project`, the message beginning with the number of the first probe that is refused or rejected, and
/// invalid_argument unless there is room for bands^2 coefficients of each probe. Arguments are looked at before
/// anything is written; after other errors the coefficients are any.
ProjectionDiagnostics project_many(std::span<const CubemapView> probes, std::span<dvec3> coefficients,
                                   const ProjectionOptions& options = {}, const Control& control = {});

// ---- Face by face: when one face changes, one face is projected again
//
//   welkin::FaceHarmonics kept = welkin::project_faces(cubemap);
//   cubemap.faces[2] = new_sky;
//   welkin::update_faces(kept, cubemap, {{2}});
//   welkin::Projection light = welkin::total(kept);             // the very bits of project(cubemap)

namespace projection {
struct FaceSums;
}

/// What each face adds to a projection, before the faces are added up: sums in double of every tile. Copies share them.
/// Some 0.15 % of the pixels as RGB floats with three bands.
class FaceHarmonics {
 public:
  [[nodiscard]] int size() const noexcept { return size_; }  ///< texels along an edge; 0: nothing is kept
  /// Those that the sums were made with.
  [[nodiscard]] const ProjectionOptions& options() const noexcept { return options_; }
  /// Memory of the sums.
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// The sums of a face, 0 to 5: which face it is does not matter to them. For caches.
  [[nodiscard]] const std::shared_ptr<const projection::FaceSums>& face(int face) const {
    return faces_[static_cast<std::size_t>(face)];
  }

  /// No sums yet.
  FaceHarmonics() = default;
  /// Without any sums yet. For `project_faces`.
  FaceHarmonics(int size, const ProjectionOptions& options) : size_(size), options_(options) {}
  /// Replaces the sums of a face. For `update_faces`.
  void set_face(int face, std::shared_ptr<const projection::FaceSums> sums) {
    faces_[static_cast<std::size_t>(face)] = std::move(sums);
  }

 private:
  int size_ = 0;
  ProjectionOptions options_{};
  std::array<std::shared_ptr<const projection::FaceSums>, 6> faces_{};
};

/// Projects all six faces and keeps their sums. Costs what `project` costs. Throws as `project`, and invalid_argument
/// for a target size with the midpoint rule: Babylon.js's reduction is a pass of its own.
[[nodiscard]] FaceHarmonics project_faces(const CubemapView& cubemap, const ProjectionOptions& options = {},
                                          const Control& control = {});

/// Projects `faces` (each 0 to 5, at most once) again, with the options of `kept`; pixels of the others are not read.
/// Throws as `project`, and invalid_argument for another size than before; then `kept` is what it was.
void update_faces(FaceHarmonics& kept, const CubemapView& cubemap, std::span<const int> faces,
                  const Control& control = {});

/// The projection: the bits of `project`, diagnostics included. Microseconds: no pixel is read. Throws `Error`
/// (invalid_argument) if a face has no sums.
[[nodiscard]] Projection total(const FaceHarmonics& faces);

// ---- Irradiance at surfaces: by direct integration, and as a cubemap
//
//   welkin::dvec3 ground = welkin::direct_irradiance(cubemap, {0.0, 1.0, 0.0});
//   welkin::Cubemap lookup = welkin::irradiance_cubemap(welkin::irradiance_from_radiance(light.radiance), 64);

// -- Direct integration

/// Irradiance by direct cosine integration, in double: the sum over all texels of radiance times the texel's integral
/// of max(0, normal . direction). W/m2 where radiance is W/m2/sr.
///
/// Texels are areas. One that lies wholly on one side of the horizon is integrated in closed form; of one that the
/// horizon cuts, what lies above it is integrated by Gauss rules. Relative error: below 1e-8 at every size.
///
/// `pixels` acts as in `project`; pixels that are not valid RGB floats already are copied. Cost per texel, normal and
/// thread: 6 ns for maps of 1024 x 512, 12 ns for 256 x 128, where the horizon cuts a larger share of the texels, and
/// 60 ns for 64 x 32. The same bits on any number of threads.
/// Throws `Error`: invalid_argument (view, policy, normals, none or more than 100 000 of them), rejected_pixel,
/// cancelled.
[[nodiscard]] std::vector<dvec3> direct_irradiance(const EnvironmentView& environment, std::span<const dvec3> normals,
                                                   const PixelPolicy& pixels = {}, const Control& control = {});

/// The same for one normal, with the default policy for pixels.
[[nodiscard]] dvec3 direct_irradiance(const EnvironmentView& environment, const dvec3& normal);

/// How far the irradiance of the first `bands` bands is from the direct one, over normals that cover the sphere evenly.
/// Differences are lengths |E_sh - E| over the three channels.
struct IrradianceError {
  int bands = 0;          ///< how many bands the irradiance was taken from
  double rms = 0.0;       ///< root mean square of the difference over that of |E|: 0.01 is 1 %
  double maximum = 0.0;   ///< largest difference over the root mean square of |E|
  double relative = 0.0;  ///< largest difference over |E| at the same normal: on the dark side, as a rule
  dvec3 worst_normal{};   ///< where the largest difference is
};

/// One entry for each number of bands from 1 to radiance.bands(). `radiance`: coefficients of the same environment,
/// from `project` as a rule; windowed ones show what the window costs. `normals`: how many, 1 to 100 000, on a
/// Fibonacci spiral. Where an environment has no light at all, the errors are 0 if the coefficients have none either,
/// else infinite. Cost, bits and errors as of `direct_irradiance`.
[[nodiscard]] std::vector<IrradianceError> irradiance_errors(const EnvironmentView& environment,
                                                             const SphericalHarmonics& radiance, int normals = 500,
                                                             const PixelPolicy& pixels = {},
                                                             const Control& control = {});

// -- Irradiance as a cubemap, for renderers that look it up instead of evaluating harmonics

/// Irradiance (W/m2 where radiance is W/m2/sr; pi times it in a uniform environment) at each texel's centre, by the
/// sum of irradiance coefficients (of `irradiance_from_radiance`): `irradiance_cubemap(e, 64)`. Values beyond the
/// floats (pi times a radiance of 3e38) become the largest float. SIMD; the same bits everywhere. Throws `Error`:
/// invalid_argument (size not in 1 to 4096), cancelled.
[[nodiscard]] Cubemap irradiance_cubemap(const SphericalHarmonics& irradiance, int size, const Control& control = {});

/// The reference: direct cosine integration in double, as `direct_irradiance`, at each texel's centre. Cost: some 6 ns
/// a source texel, result texel and thread.
[[nodiscard]] Cubemap direct_irradiance_cubemap(const EnvironmentView& source, int size, const Control& control = {});

}  // namespace welkin
