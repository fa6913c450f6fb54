// Prefiltered specular light: an environment convolved with GGX lobes, one roughness per mip (split sum, N = V = R), or
// with lobes of another family; roughness schedules; the BRDF lookup table.
//
//   P(n) = Int L(l) k(n.l) dl / Int k(n.l) dl,   k(c) = c D(sqrt((1 + c) / 2)) for c > 0, else 0,
//   D(h) = a^2 / (pi (h^2 (a^2 - 1) + 1)^2),     a = roughness^2
//
// This is the limit of Karis' sum of half-vector samples weighted by n.l (Real Shading in Unreal Engine 4, 2013).
// Roughness is perceptual throughout: GGX's alpha is its square.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

enum class PrefilterMethod {
  automatic,  ///< per mip, the faster one of `spectral` and `MipMethod::near_far` that meets both bounds
  spectral,   ///< product with the kernel's spectrum in harmonics; the brightest texels are convolved one by one
  reference,  ///< the integral, texel by texel in double; slow. The other methods are measured against it.
};

/// Returns "automatic", "spectral" or "reference".
[[nodiscard]] const char* name(PrefilterMethod method) noexcept;

/// Families of lobes, each a function of the mip's roughness r with alpha = r^2. Lobes other than GGX are
/// `ZonalLobe`s; `prefilter_by_lobes` also takes lobes of your own.
enum class LobeFamily {
  ggx,      ///< the kernel above
  charlie,  ///< `charlie(r)`: sheen. Roughness is clamped to `kMinCharlieRoughness` (0.05) or more.
  lambert,  ///< `lambert()`: irradiance over pi, at any roughness
  phong,    ///< `phong(max(1, 2 / alpha^2 - 2))`. Roughness is clamped to 0.12 or more.
  blinn,    ///< `blinn(2 / alpha^2 - 2)`. Roughness is clamped to 0.12 or more.
  spectra,  ///< `from_spectrum` of the mip's list in `PrefilterOptions::spectra`
};

/// Returns "ggx", "charlie", "lambert", "phong", "blinn" or "spectra".
[[nodiscard]] const char* name(LobeFamily lobe) noexcept;

/// Presets for the accuracy of reflections and irradiance; see `PrefilterOptions::at` and `BakeOptions::at`.
enum class Quality {
  normal,     ///< `rms_error` 1e-3: the default
  fast,       ///< `rms_error` 1e-2: for probes that are captured in each frame
  reference,  ///< the integrals in double, against which the others are measured; takes minutes
};

/// Returns "normal", "fast" or "reference".
[[nodiscard]] const char* name(Quality quality) noexcept;

/// Mappings from mips to roughness, with t = mip / (mips - 1) in [0, 1].
enum class RoughnessSchedule {
  linear,    ///< t (glTF-IBL-Sampler)
  filament,  ///< 1 - sqrt(1 - t) (Filament, three.js)
  babylon,   ///< 0 at mip 0, else alpha = 2^(mip / 0.8) / size, at most 1 (Babylon.js, lodGenerationScale 0.8)
  unity,     ///< mip = 6 r (1.7 - 0.7 r) for any number of mips; 1 beyond mip 6 (Unity_GlossyEnvironment)
  /// 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1 (ComputeReflectionCaptureRoughnessFromMip)
  unreal,
};

/// Returns "linear", "filament", "babylon", "unity" or "unreal".
[[nodiscard]] const char* name(RoughnessSchedule schedule) noexcept;

/// Size, lobes and error bounds of a specular chain.
struct PrefilterOptions {
  int size = 256;  ///< texels per edge of mip 0: 1 to 8192
  /// Number of mips, at least 1. If empty: the length of `roughness`, else of `spectra`, else 1 for `lambert`,
  /// `default_mip_count(linear, size)` for `charlie` and `default_mip_count(filament, size)` for other lobes.
  std::optional<int> mips = std::nullopt;

  /// Perceptual roughness of each mip, in [0, 1]. If empty: `mip_roughness(linear, mips, size)` for `charlie`, as
  /// glTF's sample renderer looks sheen up, and `mip_roughness(filament, mips, size)` for other lobes. With `ggx`,
  /// roughness 0 means no convolution; `charlie` has at least `kMinCharlieRoughness`.
  std::vector<double> roughness{};

  /// Perceptual roughness of each mip's lobe, if it differs from the roughness at which shaders look the mip up (see
  /// `fitted_mip_roughness`). If empty: `roughness`. `lambert` and `spectra` ignore it.
  std::vector<double> lobe_roughness{};

  LobeFamily lobe = LobeFamily::ggx;  ///< lobes of all mips

  /// For `spectra`, one list per mip: the factors of the environment's degrees 0, 1, ..., relative to the first.
  std::vector<std::vector<double>> spectra{};

  /// Method for all mips. For lobes other than `ggx`, `automatic` is `spectral`.
  PrefilterMethod method = PrefilterMethod::automatic;

  double rms_error = 1e-3;  ///< bound on a mip's relative root mean square error, weighted by solid angle
  /// Bound on |result - reference| / reference at any texel. If empty: ten times `rms_error`, at most 1. Channels
  /// darker than 1e-6 / `maximum_error` of the mip's root mean square (computed without very bright lights) may exceed
  /// it; the pass "mip N: dark channels" then reports them. For lobes other than `ggx` this bound is not checked: next
  /// to lamps, single texels may exceed it.
  std::optional<double> maximum_error = std::nullopt;

  PixelPolicy pixels{};  ///< treatment of source values, as in `project`

  /// Returns the bound at any texel: `maximum_error` or its default.
  [[nodiscard]] double texel_bound() const noexcept;

  /// Returns the default options with the method and the bounds of a preset. They may be changed afterwards.
  [[nodiscard]] static PrefilterOptions at(Quality quality);

  /// Sets `roughness` for an engine whose shaders look mips up by `schedule`, and `mips` to the schedule's number if it
  /// is empty; with `fit_lookups` also `lobe_roughness`. Call it after `size` and `mips` are set. Throws the same
  /// errors as `mip_roughness`.
  void use_schedule(RoughnessSchedule schedule, bool fit_lookups = false);

  friend bool operator==(const PrefilterOptions&, const PrefilterOptions&) = default;
};

/// The way in which a mip was made.
enum class MipMethod {
  copy,       ///< the source resampled by area: roughness 0
  spectral,   ///< by `PrefilterMethod::spectral`
  reference,  ///< by `PrefilterMethod::reference`
  stored,     ///< read from the file that was baked
  near_far,   ///< nearby texels as areas, the lobe's tail by harmonics; below roughness 0.055 at default bounds
};

/// Returns "copy", "spectral", "reference", "stored" or "near_far".
[[nodiscard]] const char* name(MipMethod method) noexcept;

/// Roughness, method, estimated errors and time of one mip.
struct MipRecord {
  int size = 0;                        ///< texels per edge
  double roughness = 0.0;              ///< perceptual roughness at which a shader looks the mip up
  double lobe_roughness = 0.0;         ///< perceptual roughness of the mip's lobe: `roughness`, unless fitted
  MipMethod method = MipMethod::copy;  ///< how it was made
  int bands = 0;                       ///< harmonic bands that were used (spectral, near_far)
  int bright_texels = 0;               ///< texels whose lobes were added one by one (spectral, near_far)
  /// Predicted rms error divided by the mip's rms; 0 for copies, empty for stored mips.
  std::optional<double> error_estimate = std::nullopt;
  /// Predicted relative rms error of trilinear lookups between this mip and the next, over all roughnesses between
  /// theirs. The fractional mip follows from the formula of the chain's `RoughnessSchedule`, or is linear in roughness
  /// for other tables. Empty for the last mip, for lobes other than GGX, and where the source's spectrum is unknown
  /// (stored mips, and chains without a spectral mip).
  std::optional<double> error_between = std::nullopt;
  /// Mean of the texels, weighted by solid angle. Convolution preserves energy, so the mean is nearly the same on every
  /// mip. It differs where a lamp and its lobe are narrower than a texel, which holds the value at its centre: for a
  /// cubemap of 64 with a lamp of one texel, by up to 180 % on mip 1 of a chain of 32. A clamp of `pixels` limits that.
  dvec3 mean{};
  double milliseconds = 0.0;  ///< wall time
};

/// A prefiltered specular chain.
struct PrefilteredSpecular {
  Cubemap cubemap;               ///< the chain, one level per mip
  std::vector<MipRecord> mips;   ///< one record per mip
  ProjectionDiagnostics pixels;  ///< what was read, replaced and clamped; `passes` are those of the prefilter
  std::uint64_t peak_bytes = 0;  ///< working memory, without source and result
};

/// Prefilters an environment. A mip of roughness 0 is the source resampled by area (`to_cubemap`), or copied from a
/// cubemap of the same size.
///
/// A source without negative values gives a result without negative values. A uniform environment stays uniform to
/// within 1e-6 (2e-4 for cubemaps in mips of roughness below 0.2). Values exceed the source's minimum and maximum by at
/// most the fraction `maximum_error`. Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded (error bounds
/// that no method meets).
[[nodiscard]] PrefilteredSpecular prefilter_specular(const EnvironmentView& source,
                                                     const PrefilterOptions& options = {}, const Control& control = {});

/// Computes the reference at chosen directions, in double over all source texels as areas; one entry per direction.
/// Cost: 10 ns per source texel and direction. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<dvec3> reference_specular(const EnvironmentView& source, double roughness,
                                                    const std::vector<dvec3>& directions, const Control& control = {});

// Roughness schedules: the roughness of each mip of a specular cubemap, and the mip that a shader samples for a
// roughness.

/// Returns the roughness of each mip of a chain whose mip 0 has `size` texels per edge: increasing, in [0, 1], 0 at mip
/// 0. Throws `Error` (invalid_argument) unless 1 <= mips <= 16 and size >= 1.
[[nodiscard]] std::vector<double> mip_roughness(RoughnessSchedule schedule, int mips, int size);

/// Returns the roughness of each mip's lobe that minimizes the error of trilinear lookups over all roughnesses. Shaders
/// still select mips by `mip_roughness`. Mip 0 stays a mirror. The fit assumes an image with a typical power
/// spectrum and depends on the arguments alone. Cost: 1 to 3 ms; recent fits are cached. Throws the same errors as
/// `mip_roughness`.
[[nodiscard]] std::vector<double> fitted_mip_roughness(RoughnessSchedule schedule, int mips, int size);

/// Returns the default number of mips for a schedule. `linear` and `filament` end at 4 texels but have at least five
/// mips where `size` allows, because interpolation between few mips is less accurate. `unity` has seven, or as many
/// as `size` allows. `babylon` and `unreal` end at 1 texel. Throws `Error` (invalid_argument) unless 1 <= size <=
/// 8192.
[[nodiscard]] int default_mip_count(RoughnessSchedule schedule, int size);

/// Returns the number of mips of a chain with these options. Throws `Error` (invalid_argument) for a number out of
/// range.
[[nodiscard]] int default_mip_count(const PrefilterOptions& options);

/// Returns the fractional mip at which a shader that interpolates between mips finds `roughness`, by linear
/// interpolation in `table`, clamped to its ends. Throws `Error` (invalid_argument) for an empty or decreasing table.
[[nodiscard]] double mip_for_roughness(const std::vector<double>& table, double roughness);

// The BRDF lookup table, the other half of the split sum: the reflectance of a GGX or sheen surface by viewing angle
// and roughness.
//
//   auto table = welkin::brdf_table();                               // 64 x 64, split sum, sheen in the third channel
//   auto dfg = welkin::brdf_table({128, 128, welkin::BrdfModel::multiple_scattering});

/// Meaning of the first two channels. With V the height-correlated Smith visibility (Heitz 2014, equation 99), F
/// Schlick's Fresnel and alpha = roughness squared, E = Int D V F (n.l) dl over the hemisphere of light directions is
///
///   E = f0 Int D V (n.l) (1 - (1 - v.h)^5) dl + Int D V (n.l) (1 - v.h)^5 dl = f0 scale + bias.
enum class BrdfModel {
  split_sum,  ///< (scale, bias) (Karis 2013, Real Shading in Unreal Engine 4): E = f0 scale + bias
  /// (bias, scale + bias): E = (1 - f0) x + f0 y, as in Filament's DFG. y is the full albedo, which the energy
  /// compensation 1 + f0 (1 / y - 1) needs
  multiple_scattering,
};

/// Options of `brdf_table`.
struct BrdfTableOptions {
  int width = 64;   ///< texels along N.V, 1 to 4096: column i is at N.V = (i + 0.5) / width
  int height = 64;  ///< texels along perceptual roughness, 1 to 4096: row j is at (j + 0.5) / height
  BrdfModel model = BrdfModel::split_sum;  ///< meaning of red and green

  /// Adds a third channel with the directional albedo of Charlie sheen: D of Estevez and Kulla 2017 (Production
  /// Friendly Microfacet Sheen BRDF) with alpha = roughness squared, and the visibility 1 / (4 (n.l + n.v - n.l n.v))
  /// of Neubelt and Pettineo 2013, as Filament and three.js shade. This visibility does not conserve energy: at
  /// roughness below 0.4 the albedo exceeds 1 at grazing angles (8 at 0.05, hundreds below), so renderers bound
  /// roughness from below.
  bool sheen = true;

  friend bool operator==(const BrdfTableOptions&, const BrdfTableOptions&) = default;
};

/// Reflectance of a surface in a uniform environment, by the cosine to the viewer and by roughness.
struct BrdfTable {
  BrdfTableOptions options;   ///< options of the table
  int channels = 2;           ///< 2, or 3 with sheen
  std::vector<float> values;  ///< height x width x channels values; row 0 has the lowest roughness

  /// Returns the size of `values` in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept { return values.size() * sizeof(float); }
};

/// Computes a BRDF table by deterministic quadrature. The absolute error of every texel is below 1e-5; for sheen
/// above 1, it is relative. Recent tables are cached and shared, up to 32 MiB in total; larger tables are computed at
/// every call. Cost: 0.6 us per texel on one thread with AVX-512, twice that with sheen. Throws `Error`
/// (invalid_argument).
[[nodiscard]] std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options = {},
                                                          const Control& control = {});

// ---- Lobes other than GGX: Charlie sheen, Lambert, Phong, Blinn, or your own
//
//   welkin::LobeChainOptions sheen{.size = 256};
//   for (const double roughness : {0.1, 0.3, 1.0}) sheen.lobes.push_back(welkin::ZonalLobe::charlie(roughness));
//   const welkin::PrefilteredSpecular chain = welkin::prefilter_by_lobes(panorama, sheen);

namespace reflections {
class Lobe;
}

/// A radially symmetric filter kernel: a weight per cosine c of the angle to its axis. Kernels are normalized: their
/// integral over the sphere is 1.
class ZonalLobe {
 public:
  /// Returns Charlie sheen (Estevez and Kulla 2017) with N = V = R: c (1 - c)^p for c > 0, p = 1 / (2 alpha), alpha =
  /// roughness squared. Its maximum is near the horizon, at c = 1 / (1 + p). `roughness` lies in [0.01, 1]; below
  /// `kMinCharlieRoughness` an image may need more harmonic bands than Welkin has.
  [[nodiscard]] static ZonalLobe charlie(double roughness);
  /// Returns c for c > 0: irradiance divided by pi.
  [[nodiscard]] static ZonalLobe lambert();
  /// Returns c^power for c > 0. `power` lies in [0.5, 1e6].
  [[nodiscard]] static ZonalLobe phong(double power);
  /// Returns c h^power for c > 0, where h = sqrt((1 + c) / 2) is the cosine of the half vector. `power` lies in [0,
  /// 1e6].
  [[nodiscard]] static ZonalLobe blinn(double power);

  /// Returns the kernel of any function of the cosine, which may have negative values. `breaks` lists the cosines
  /// between -1 and 1 at which the function or a derivative jumps; it must be smooth between them. `value` is called
  /// during this call only, for cosines from -1 to 1, a hundred to tens of thousands of times. Throws `Error`
  /// (invalid_argument) for values that are not finite, an integral that is not above 0, and functions that need more
  /// than 2000 polynomial pieces; and whatever `value` throws.
  [[nodiscard]] static ZonalLobe from_function(const std::function<double(double cosine)>& value,
                                               const std::vector<double>& breaks = {0.0});

  /// Returns the kernel that multiplies degree l of the environment by factors[l] / factors[0]. factors[0] must be
  /// above 0. Degrees beyond the list are removed. The list has 1 to 1536 finite numbers. Throws `Error`
  /// (invalid_argument).
  [[nodiscard]] static ZonalLobe from_spectrum(const std::vector<double>& factors);

  /// Returns the kernel's density per steradian at `cosine`, which lies in [-1, 1]. Error: 1e-9 of the maximum.
  [[nodiscard]] double value(double cosine) const;
  /// Returns k_l = 2 pi Int k(c) P_l(c) dc for l < bands, with k_0 = 1: the factor of degree l. Error: 1e-10. Throws
  /// `Error` (invalid_argument) unless 1 <= bands <= 1536.
  [[nodiscard]] std::vector<double> spectrum(int bands) const;
  /// Returns the roughness of a `charlie` kernel, or 0 for others.
  [[nodiscard]] double roughness() const noexcept { return roughness_; }

  /// Returns the internal representation, for the library.
  [[nodiscard]] const std::shared_ptr<const reflections::Lobe>& lobe() const noexcept { return lobe_; }

 private:
  ZonalLobe(std::shared_ptr<const reflections::Lobe> lobe, double roughness)
      : lobe_(std::move(lobe)), roughness_(roughness) {}

  std::shared_ptr<const reflections::Lobe> lobe_;
  double roughness_;
};

/// The lowest roughness of mips for sheen: at 0 the lobe degenerates to the horizon.
inline constexpr double kMinCharlieRoughness = 0.05;

/// Options of `prefilter_by_lobes`.
struct LobeChainOptions {
  int size = 256;                  ///< texels per edge of mip 0: 1 to 8192
  std::vector<ZonalLobe> lobes{};  ///< one per mip: at least one, at most as many as the cubemap has levels

  /// `spectral` multiplies by the kernel's spectrum in harmonics and convolves bright texels one by one. `automatic`
  /// does the same, but where the estimated error exceeds the bound it uses the integral if that takes at most 1 s.
  /// `reference` is the integral, texel by texel in double; slow.
  PrefilterMethod method = PrefilterMethod::automatic;

  double rms_error = 1e-3;  ///< bound on a mip's relative root mean square error, weighted by solid angle

  PixelPolicy pixels{};  ///< treatment of source values, as in `project`
};

/// Prefilters an environment with one lobe per mip. For continuous lobes the default bounds are those of
/// `prefilter_specular`: 0.1 % rms, 1 % at any texel. If source and kernel have no negative values, the result has
/// none. Results of `from_function` are bit-identical only if the function's values are. Cost: that of
/// `prefilter_specular`, plus 10 ns for each pair of a result texel and a bright source texel.
///
/// Throws `Error`: invalid_argument; rejected_pixel; limit_exceeded if the kernel is so narrow or sharp that 1536 bands
/// miss the bound on this image, or if the estimated error exceeds it; the message states by how much.
[[nodiscard]] PrefilteredSpecular prefilter_by_lobes(const EnvironmentView& source, const LobeChainOptions& options,
                                                     const Control& control = {});

/// Computes the reference at chosen directions, in double over all source texels as areas; one entry per direction.
/// Slow. Throws `Error` (invalid_argument).
[[nodiscard]] std::vector<dvec3> reference_by_lobe(const EnvironmentView& source, const ZonalLobe& kernel,
                                                   const std::vector<dvec3>& directions, const Control& control = {});

}  // namespace welkin
