// Spherical harmonics and irradiance from the pixels of an environment.
//
//   welkin::CubemapView view{{px, nx, py, ny, pz, nz}, 1024, 0, welkin::PixelFormat::rgba16f};
//   welkin::Projection light = welkin::project(view);          // three bands, exact quadrature
//   auto irradiance = welkin::irradiance_from_radiance(light.radiance);
//
// Pixels are read once and in place. Calls that take a `PixelPolicy` throw `Error` (rejected_pixel) for pixels that it
// rejects; the message names the first one in the order of faces, rows and columns. Views and options out of range
// throw `Error` (invalid_argument).
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

/// The way in which a basis function is integrated over a texel.
enum class Quadrature {
  exact,     ///< exactly over the texel's area; no discretization error at any size
  midpoint,  ///< value at the texel's centre times its solid angle, as in Babylon.js; error O(1/size^2)
};

/// Treatment of a NaN or an infinity.
enum class NonFinitePolicy {
  replace,  ///< replaced by the value that `PixelPolicy` states, and counted
  reject,   ///< the call throws `Error` (rejected_pixel)
};

/// Treatment of a finite value below zero.
enum class NegativePolicy {
  keep,     ///< used unchanged
  replace,  ///< replaced by 0, and counted
  reject,   ///< the call throws `Error` (rejected_pixel)
};

/// An upper bound on radiance.
struct RadianceClamp {
  float maximum = 4096.0F;  ///< above 0; 4096 is Babylon.js's default
  /// true: if a channel exceeds `maximum`, scales all three by one factor; false: clamps each to [0, maximum]
  bool preserve_colour = false;

  friend bool operator==(const RadianceClamp&, const RadianceClamp&) = default;
};

/// Treatment of pixel values before they are used as radiance. Calls that project, prefilter, bake or integrate pixels
/// take one. Resampling leaves values unchanged; all other calls use the default policy.
struct PixelPolicy {
  /// Clamps radiance; no clamp by default. The diagnostics report how much energy it removed.
  std::optional<RadianceClamp> clamp{};

  /// Decodes gamma-encoded pixels: each channel is clamped to [0, 1] and raised to the power of 2.2 (Babylon.js's
  /// gammaSpace). Not for the sRGB formats, which are always decoded. Values clamped here are not reported.
  bool gamma = false;

  /// NaN is replaced by 0, +infinity by the clamp's maximum (65504 without a clamp), and -infinity by 0.
  NonFinitePolicy nan = NonFinitePolicy::replace;
  NonFinitePolicy infinity = NonFinitePolicy::replace;  ///< treatment of infinities

  /// Finite negative values are kept by default, because real files contain small ones; `replace` makes them 0.
  NegativePolicy negative = NegativePolicy::keep;

  friend bool operator==(const PixelPolicy&, const PixelPolicy&) = default;
};

/// Options of `project`.
struct ProjectionOptions {
  int bands = 3;                              ///< 1 (ambient only) to kMaximumBands
  Quadrature quadrature = Quadrature::exact;  ///< integration over texels

  /// Texels per edge of the cubemap to which the environment is reduced before projection, at least 1; `std::nullopt`
  /// projects the source itself. A lat-long is reduced to 4 x target by 2 x target texels. From a mip chain, the mip
  /// whose size is nearest to the target in log2 is read instead. Sources no larger than the target are not reduced.
  /// - Exact quadrature averages by solid angle, after gamma, clamp and policies.
  /// - Midpoint quadrature averages a cubemap as Babylon.js does: the target is rounded down to a power of two, and raw
  ///   values are box-filtered. Gamma, clamp and replacements then act on the reduced texels, and the diagnostics count
  ///   those. `reject` policies still check every source texel.
  /// - Midpoint quadrature averages a lat-long by pixel area, after gamma, clamp and policies, without rounding the
  ///   target.
  std::optional<int> target_size{};

  PixelPolicy pixels{};  ///< treatment of pixel values

  friend bool operator==(const ProjectionOptions&, const ProjectionOptions&) = default;
};

// ---- Results

/// The action taken for a step of a call.
enum class PassAction {
  run,    ///< it is computed
  reuse,  ///< its result exists already: in the file, in another pass's result, or from an earlier call
  skip,   ///< no requested result needs it
};

/// Returns "run", "reuse" or "skip".
[[nodiscard]] const char* name(PassAction action) noexcept;

/// One step of a call, with what was done or why it was not.
struct PassRecord {
  std::string name;                     ///< "read", "reduce", "project", "cubemap", ...
  PassAction action = PassAction::run;  ///< action taken
  std::string reason;                   ///< why, for people
  double milliseconds = 0.0;            ///< wall time; 0 if it was skipped
};

/// Counts, energy, error estimate and timings of a result.
struct ProjectionDiagnostics {
  std::uint64_t texels = 0;               ///< texels that were read
  std::uint64_t nans_replaced = 0;        ///< channel values
  std::uint64_t infinities_replaced = 0;  ///< channel values
  std::uint64_t negatives_replaced = 0;   ///< channel values
  std::uint64_t texels_clamped = 0;       ///< texels that the clamp changed
  /// integral of radiance over the sphere, after replacements and before the clamp
  dvec3 total_radiance_before_clamp{};
  dvec3 total_radiance{};  ///< integral of radiance over the sphere as projected

  /// Estimated relative error |c - c*| / |c*| of the radiance coefficients, where c* is the exact integral over the
  /// source's texels as areas. It is an upper bound, except for a level of a mip chain, where it is a guess.
  double error_estimate = 0.0;

  std::vector<PassRecord> passes;  ///< wall time of each step
};

/// Result of `project`.
struct Projection {
  SphericalHarmonics radiance;        ///< coefficients of the environment's radiance
  ProjectionDiagnostics diagnostics;  ///< counts, energy, error estimate and timings
};

// ---- Projection

/// Projects an environment onto spherical harmonics. A lat-long is projected directly, not by way of a cubemap.
///
/// With exact quadrature, the relative error of the coefficient vector is below 5e-7. Cost: 0.3 ns per texel on one
/// thread with AVX-512, limited by memory bandwidth. Sources below 100 000 texels use the calling thread only.
[[nodiscard]] Projection project(const EnvironmentView& environment, const ProjectionOptions& options = {},
                                 const Control& control = {});

/// Projects a cubemap that comes with its mips: `mips[0]` is the full size, each further one half the size of the one
/// before (rounded down, at least 1), all in one format. Only `target_size` uses the smaller mips. Throws `Error`
/// (invalid_argument) for an empty or inconsistent chain.
[[nodiscard]] Projection project(std::span<const CubemapView> mips, const ProjectionOptions& options = {},
                                 const Control& control = {});

// ---- Many cubemaps at once, such as the probes of a level
//
//   std::vector<welkin::dvec3> light(9 * probes.size());
//   welkin::project_many(probes, light);      // light[9 * k] and the next eight are of project(probes[k])

/// Projects many cubemaps of any sizes and formats. Writes bands^2 coefficients per probe, in the order of
/// `SphericalHarmonics::coefficients`: those of `probes[k]` start at `coefficients[bands^2 k]`. Same bits as `project`.
///
/// Cubemaps up to 129 texels per edge are projected by one thread each, concurrently and without allocating (unless
/// they are reduced to a target size); larger ones are projected one after the other on all threads. The diagnostics
/// cover all probes: counts and total radiance are sums, the error estimate is the maximum.
///
/// Throws the same errors as `project`; messages start with the index of the first offending probe. Throws `Error`
/// (invalid_argument) if `coefficients` is too short, before anything is written. After any other error the contents of
/// `coefficients` are unspecified.
ProjectionDiagnostics project_many(std::span<const CubemapView> probes, std::span<dvec3> coefficients,
                                   const ProjectionOptions& options = {}, const Control& control = {});

// ---- Face by face: when one face changes, only that face is projected again
//
//   welkin::FaceHarmonics kept = welkin::project_faces(cubemap);
//   cubemap.faces[2] = new_sky;
//   welkin::update_faces(kept, cubemap, {{2}});
//   welkin::Projection light = welkin::combine(kept);             // the same bits as project(cubemap)

namespace projection {
struct FaceSums;
}

/// The contribution of each face to a projection: partial sums per tile, in double. Copies share the sums, which take
/// 0.15 % of the memory of the pixels (RGB floats, three bands).
class FaceHarmonics {
 public:
  [[nodiscard]] int size() const noexcept { return size_; }  ///< texels per edge; 0 without sums
  /// Returns the options with which the sums were computed.
  [[nodiscard]] const ProjectionOptions& options() const noexcept { return options_; }
  /// Returns the memory of the sums in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Returns the sums of a face, 0 to 5. Equal pixels give equal sums on every face. For caches.
  [[nodiscard]] const std::shared_ptr<const projection::FaceSums>& face(int face) const {
    return faces_[static_cast<std::size_t>(face)];
  }

  /// Creates an object without sums.
  FaceHarmonics() = default;
  /// Creates an object without sums, for `project_faces`.
  FaceHarmonics(int size, const ProjectionOptions& options) : size_(size), options_(options) {}
  /// Replaces the sums of a face, for `update_faces`.
  void set_face(int face, std::shared_ptr<const projection::FaceSums> sums) {
    faces_[static_cast<std::size_t>(face)] = std::move(sums);
  }

 private:
  int size_ = 0;
  ProjectionOptions options_{};
  std::array<std::shared_ptr<const projection::FaceSums>, 6> faces_{};
};

/// Projects all six faces and keeps their sums, at the cost of `project`. Throws the same errors as `project`, and
/// `Error` (invalid_argument) for a target size with midpoint quadrature, whose reduction mixes faces.
[[nodiscard]] FaceHarmonics project_faces(const CubemapView& cubemap, const ProjectionOptions& options = {},
                                          const Control& control = {});

/// Projects `faces` (each 0 to 5, without duplicates) again with the options of `kept`. Pixels of other faces are not
/// read. Throws the same errors as `project`, also for another size; `kept` is then unchanged.
void update_faces(FaceHarmonics& kept, const CubemapView& cubemap, std::span<const int> faces,
                  const Control& control = {});

/// Adds up the faces. The result, with its diagnostics, is bit-identical to that of `project`. Takes microseconds: no
/// pixel is read. Throws `Error` (invalid_argument) if a face has no sums.
[[nodiscard]] Projection combine(const FaceHarmonics& faces);

// ---- Irradiance at surfaces: by direct integration, and as a cubemap
//
//   welkin::dvec3 ground = welkin::direct_irradiance(cubemap, {0.0, 1.0, 0.0});
//   welkin::Cubemap lookup = welkin::irradiance_cubemap(welkin::irradiance_from_radiance(light.radiance), 64);

// -- Direct integration

/// Computes irradiance by direct cosine integration in double: the sum over all texels of radiance times the texel's
/// integral of max(0, normal . direction). The unit is W/m2 where radiance is W/m2/sr.
///
/// Texels are areas. Texels above the horizon are integrated in closed form. Where the horizon cuts a texel, the part
/// above it is integrated by Gauss rules. The relative error is below 1e-8 at every size. Pixels that are not valid RGB
/// floats are copied first.
///
/// Cost per texel and normal on one thread: 6 ns for maps of 1024 x 512, 12 ns for 256 x 128, 60 ns for 64 x 32. In
/// small maps the horizon cuts a larger fraction of the texels. Throws `Error`: invalid_argument (including no normals,
/// or more than 100 000), rejected_pixel.
[[nodiscard]] std::vector<dvec3> direct_irradiance(const EnvironmentView& environment, std::span<const dvec3> normals,
                                                   const PixelPolicy& pixels = {}, const Control& control = {});

/// Computes irradiance for one normal, with the default policy for pixels.
[[nodiscard]] dvec3 direct_irradiance(const EnvironmentView& environment, const dvec3& normal);

/// Error of the irradiance of the first `bands` bands relative to direct integration, over normals that cover the
/// sphere uniformly. Differences are lengths |E_sh - E| over the three channels.
struct IrradianceError {
  int bands = 0;          ///< number of bands of the irradiance
  double rms = 0.0;       ///< root mean square of the difference divided by that of |E|: 0.01 is 1 %
  double maximum = 0.0;   ///< maximum difference divided by the root mean square of |E|
  double relative = 0.0;  ///< maximum of the difference divided by |E| at the same normal, usually on the dark side
  dvec3 worst_normal{};   ///< normal of the maximum difference
};

/// Measures irradiance errors of `radiance`, one entry for each number of bands from 1 to radiance.bands(). `radiance`
/// holds coefficients of the same environment, usually from `project`; windowed ones show the cost of the window.
/// `normals` is the number of directions on a Fibonacci spiral, 1 to 100 000. In an environment without light, errors
/// are 0 if the coefficients are 0 too, and infinite otherwise. Cost and exceptions are those of `direct_irradiance`.
[[nodiscard]] std::vector<IrradianceError> irradiance_errors(const EnvironmentView& environment,
                                                             const SphericalHarmonics& radiance, int normals = 500,
                                                             const PixelPolicy& pixels = {},
                                                             const Control& control = {});

// -- Irradiance as a cubemap, for renderers that look it up instead of evaluating harmonics

/// Evaluates irradiance coefficients (of `irradiance_from_radiance`) at each texel's centre of a cubemap of `size`
/// texels per edge, 1 to 4096. The unit is W/m2 where radiance is W/m2/sr; a uniform environment of radiance L has
/// irradiance pi L. Values beyond the range of floats are clamped to the largest float. Throws `Error`
/// (invalid_argument) for sizes out of range.
[[nodiscard]] Cubemap irradiance_cubemap(const SphericalHarmonics& irradiance, int size, const Control& control = {});

/// Computes an irradiance cubemap by direct cosine integration in double, as `direct_irradiance` does, at each texel's
/// centre: the reference for the function above. Cost: 6 ns on one thread for each pair of a source and a result texel.
[[nodiscard]] Cubemap direct_irradiance_cubemap(const EnvironmentView& source, int size, const Control& control = {});

}  // namespace welkin
