// Prefiltered specular light: an environment blurred by GGX lobes, a mip for each roughness (split sum, N = V = R), or
// by lobes of another family.
//
//   P(n) = Int L(l) k(n.l) dl / Int k(n.l) dl,   k(c) = c D(sqrt((1 + c) / 2)) for c > 0, else 0,
//   D(h) = a^2 / (pi (h^2 (a^2 - 1) + 1)^2),     a = roughness^2
//
// That is the limit of Karis' sum of half-vector samples weighted by n.l (Real Shading in Unreal Engine 4, 2013).
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
  automatic,  ///< for each mip the fastest within both bounds: spectral or narrow
  spectral,   ///< product with the kernel's spectrum in harmonics; the brightest texels each by its own lobe
  reference,  ///< the integral, texel by texel in double: the truth that the others are measured against. Slow.
};

/// "automatic", "spectral", "reference"
[[nodiscard]] const char* name(PrefilterMethod method) noexcept;

/// Lobes that the mips of a chain are blurred by, each a function of the mip's roughness r, alpha = r^2. Those other
/// than GGX are `ZonalKernel`s, which also takes functions of the caller's.
enum class LobeFamily {
  ggx,      ///< the kernel above
  charlie,  ///< `charlie(r)`: sheen. A roughness below `kLeastCharlieRoughness` (0.05) is raised to it.
  lambert,  ///< `lambert()`: irradiance over pi, at any roughness
  phong,    ///< `phong(max(1, 2 / alpha^2 - 2))`. A roughness below 0.12 is raised to it.
  blinn,    ///< `blinn(2 / alpha^2 - 2)`. A roughness below 0.12 is raised to it.
  spectra,  ///< `from_spectrum` of the numbers that `PrefilterOptions::spectra` has for the mip
};

/// "ggx", "charlie", "lambert", "phong", "blinn", "spectra"
[[nodiscard]] const char* name(LobeFamily lobe) noexcept;

/// Presets of how exact reflections and irradiance are: see `PrefilterOptions::at` and `BakeOptions::at`.
enum class Quality {
  normal,     ///< `rms_error` 1e-3: the default
  fast,       ///< `rms_error` 1e-2: for probes that are captured in each frame
  reference,  ///< the integrals themselves, in double: what the others are measured against. Takes minutes.
};

/// "normal", "fast", "reference"
[[nodiscard]] const char* name(Quality quality) noexcept;

/// Sizes, lobes and bounds of a chain.
struct PrefilterOptions {
  int size = 256;  ///< texels along an edge of mip 0: 1 to 8192
  /// At least 1. None: as many as `roughness` names, else as `spectra` has, else 1 of `lambert` and
  /// `mips_of_chain(filament, size)` (`linear` of `charlie`) of other lobes.
  std::optional<int> mips = std::nullopt;

  /// Perceptual roughness in [0, 1] of each mip; empty: `roughness_of_mips(filament, mips, size)`, of `charlie`
  /// `charlie_roughness_of_mips(mips, size)`. 0 of `ggx`: no blur.
  std::vector<double> roughness{};

  /// Perceptual roughness of the lobe that each mip is blurred by, where that is not the roughness at which shaders
  /// find the mip (`fitted_roughness_of_mips`); empty: `roughness`. `lambert` and `spectra` ignore it.
  std::vector<double> lobe_roughness{};

  LobeFamily lobe = LobeFamily::ggx;  ///< of all mips

  /// Of each mip what degree 0, 1, ... of the environment is multiplied by, over the first; only of `spectra`.
  std::vector<std::vector<double>> spectra{};

  /// How each mip is computed. Of lobes other than `ggx`, `automatic` is `spectral`.
  PrefilterMethod method = PrefilterMethod::automatic;

  double rms_error = 1e-3;  ///< bound on a mip's relative root mean square error, by solid angle
  /// Bound on |result - truth| / truth at any texel; none: ten times `rms_error`, at most 1. A channel that is darker
  /// than 1e-6 / `maximum_error` of the root mean square of its mip (without very bright lights) may exceed it: the
  /// pass "mip N: dark channels" reports it.
  std::optional<double> maximum_error = std::nullopt;

  PixelPolicy pixels{};  ///< what becomes of the source's values first, as in `project`

  /// Returns the default options with the method and the bounds of a preset, which may be changed afterwards.
  [[nodiscard]] static PrefilterOptions at(Quality quality);

  friend bool operator==(const PrefilterOptions&, const PrefilterOptions&) = default;
};

/// How one mip came about.
enum class MipMethod {
  copy,       ///< the source resampled by area: roughness 0
  spectral,   ///< as `PrefilterMethod::spectral`
  reference,  ///< as `PrefilterMethod::reference`
  stored,     ///< it was in the file that was baked
  narrow,     ///< texels near by as areas, the lobe's far part by harmonics: below roughness 0.055 at default bounds
};

/// "copy", "spectral", "reference", "stored", "narrow"
[[nodiscard]] const char* name(MipMethod method) noexcept;

/// How one mip was made, and how good it is.
struct MipRecord {
  int size = 0;                        ///< texels along an edge
  double roughness = 0.0;              ///< perceptual, at which a shader finds the mip
  double lobe_roughness = 0.0;         ///< of the mip's lobe: `roughness`, unless it is fitted to lookups
  MipMethod method = MipMethod::copy;  ///< how it was made
  int bands = 0;                       ///< spectral and narrow: harmonic bands that were used
  int bright_texels = 0;               ///< spectral, narrow: texels whose lobes were added beside the rest
  /// Predicted rms error over the mip's rms; 0 of copies. None where nothing is known: of stored mips.
  std::optional<double> error_estimate = std::nullopt;
  /// Predicted relative rms error of a shader that reads this mip and the next bilinearly and interpolates linearly
  /// between them, over all roughnesses from this mip's to the next one's, by the formula of the chain's
  /// `RoughnessSchedule` (of other tables linear in roughness). None of the last mip, of lobes other than GGX, and
  /// where the picture's spectrum is not known: of stored mips, and of chains without a spectral mip.
  std::optional<double> error_between = std::nullopt;
  /// Mean of the texels, by solid angle. The kernel keeps energy, so the blurred light has the same mean on every mip.
  /// A texel holds the value at its centre: where a lamp's blurred light is narrower than the texels, centres meet or
  /// miss it, and this mean differs (by up to 180 % on mip 1 of a chain of 32, cubemap of 64 with a lamp of one texel).
  dvec3 mean{};
  double milliseconds = 0.0;  ///< wall time
};

/// A chain of reflections.
struct PrefilteredSpecular {
  Cubemap cubemap;               ///< a level for each mip
  std::vector<MipRecord> mips;   ///< one record for each mip
  ProjectionDiagnostics pixels;  ///< what was read, replaced and clamped; its passes are the prefilter's
  std::uint64_t peak_bytes = 0;  ///< of working memory, beside source and result
};

/// Prefilters. Mip 0 of roughness 0 is the source resampled by area (`to_cubemap`; the very texels of a cubemap of the
/// same size). Not negative where the source is not; uniform ones stay so to 1e-6 (of cubemaps, in mips of roughness
/// below 0.2, to 2e-4), ranges to `maximum_error` of an end.
/// The same bits on any number of threads and instruction set.
/// Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded (error bounds that no method reaches), cancelled.
[[nodiscard]] PrefilteredSpecular prefilter_specular(const EnvironmentView& source,
                                                     const PrefilterOptions& options = {}, const Control& control = {});

/// The truth at chosen directions, in double over all of the source's texels as areas: one entry per direction.
/// Cost: 10 ns per source texel and direction. Throws `Error` (invalid_argument, cancelled).
[[nodiscard]] std::vector<dvec3> reference_specular(const EnvironmentView& source, double roughness,
                                                    const std::vector<dvec3>& directions, const Control& control = {});

// Which roughness each mip of a specular cubemap has, and where a shader looks for a roughness.
//
// Roughness is perceptual (what artists set) everywhere here; GGX's alpha is its square.

/// Named ways to spread roughness over a chain, t = mip / (mips - 1) in [0, 1].
enum class RoughnessSchedule {
  linear,    ///< t (glTF-IBL-Sampler)
  filament,  ///< 1 - sqrt(1 - t) (Filament, three.js)
  babylon,   ///< 0 at mip 0, else alpha = 2^(mip / 0.8) / size, at most 1 (Babylon.js, lodGenerationScale 0.8)
  unity,     ///< mip = 6 r (1.7 - 0.7 r), whatever the number of mips; 1 beyond mip 6 (Unity_GlossyEnvironment)
  /// 0 at mip 0, else 2^((mip - (mips - 1) + 2) / 1.2), at most 1 (ComputeReflectionCaptureRoughnessFromMip)
  unreal,
};

/// "linear", "filament", "babylon", "unity", "unreal"
[[nodiscard]] const char* name(RoughnessSchedule schedule) noexcept;

/// Roughness of each of `mips` mips of a chain whose mip 0 has `size` texels along an edge: rising, in [0, 1], 0 at mip
/// 0. Throws `Error` (invalid_argument) unless 1 <= mips <= 16 and size >= 1.
[[nodiscard]] std::vector<double> roughness_of_mips(RoughnessSchedule schedule, int mips, int size);

/// Returns the roughness of lobes for a chain that a shader reads by the schedule's formula, bilinearly in a mip and
/// linearly between two. Read so, the chain is nearer to the blurred picture over all roughnesses than one whose mips
/// have the lobes of `roughness_of_mips`, which is where the shader still looks them up. Mip 0 stays a mirror. The fit
/// is to a picture of typical power per degree and depends on the arguments alone. Cost: 1 to 3 ms; fits that were used
/// last are kept. Throws `Error` as `roughness_of_mips`.
[[nodiscard]] std::vector<double> fitted_roughness_of_mips(RoughnessSchedule schedule, int mips, int size);

/// Returns the default number of mips for a schedule. `linear` and `filament`: down to 4 texels, because what lies
/// between two mips errs more than few texels do, but five where `size` has five. `unity`: seven, or as many as there
/// are. `babylon` and `unreal`: down to 1 texel. Throws `Error` (invalid_argument) unless 1 <= size <= 8192.
[[nodiscard]] int mips_of_chain(RoughnessSchedule schedule, int size);

/// Returns how many mips a chain of these options has. Throws `Error` (invalid_argument) for a number out of range.
[[nodiscard]] int mips_of_chain(const PrefilterOptions& options);

/// The mip, fractions too, at which a shader that interpolates between mips finds `roughness`: by linear interpolation
/// in `table`, which must not fall. Clamped to the table's ends. Throws `Error` (invalid_argument) for an empty table
/// or one that falls.
[[nodiscard]] double mip_of_roughness(const std::vector<double>& table, double roughness);

// The other half of the split sum: how much of the light a GGX surface (or sheen) sends back, by angle and roughness.
//
//   auto table = welkin::brdf_table();                               // 64 x 64, split sum, sheen in the third channel
//   auto dfg = welkin::brdf_table({128, 128, welkin::BrdfModel::multiple_scattering});

/// What the first two channels hold. With V the height-correlated Smith visibility (Heitz 2014, equation 99), F
/// Schlick's Fresnel and alpha = roughness squared, E = Int D V F (n.l) dl over the lights' hemisphere is
///
///   E = f0 Int D V (n.l) (1 - (1 - v.h)^5) dl + Int D V (n.l) (1 - v.h)^5 dl = f0 scale + bias.
enum class BrdfModel {
  split_sum,            ///< (scale, bias) (Karis 2013, Real Shading in Unreal Engine 4): E = f0 scale + bias
  multiple_scattering,  ///< (bias, scale + bias): E = (1 - f0) x + f0 y, as Filament's DFG has them. y is the whole
                        ///< albedo, which its energy compensation 1 + f0 (1 / y - 1) needs
};

/// What the table holds.
struct BrdfTableOptions {
  int width = 64;                          ///< along N.V, 1 to 4096: column i is at N.V = (i + 0.5) / width
  int height = 64;                         ///< along perceptual roughness, 1 to 4096: row j is at (j + 0.5) / height
  BrdfModel model = BrdfModel::split_sum;  ///< what red and green are

  /// A third channel: directional albedo of Charlie sheen, D of Estevez and Kulla 2017 (Production Friendly Microfacet
  /// Sheen BRDF) with alpha = roughness squared, with the visibility 1 / (4 (n.l + n.v - n.l n.v)) of Neubelt and
  /// Pettineo 2013: that is what Filament and three.js shade with, and the table must fit the shader. (Charlie's own
  /// lambda is for path tracers.) That visibility does not keep energy: below a roughness of 0.4 or so the albedo
  /// exceeds 1 at grazing angles (8 at 0.05, hundreds below), for which renderers bound roughness from below.
  bool sheen = true;

  friend bool operator==(const BrdfTableOptions&, const BrdfTableOptions&) = default;
};

/// The table: reflectance of a surface in even light, by the cosine to the viewer and by roughness.
struct BrdfTable {
  BrdfTableOptions options;   ///< those that it was made with
  int channels = 2;           ///< 3 with sheen
  std::vector<float> values;  ///< height x width x channels, row 0 at the lowest roughness

  /// The same as IEEE half floats, rounded to nearest, ties to even; beyond 65504: 65504.
  [[nodiscard]] std::vector<std::uint16_t> half_values() const;
  /// Memory of `values`.
  [[nodiscard]] std::size_t bytes() const noexcept { return values.size() * sizeof(float); }
};

/// The table, by deterministic quadrature: absolute error below 1e-5 in every texel, sheen above 1 by 1e-5 of its
/// value. Tables depend on no scene: those that were used last are kept, up to 32 MiB of them, and shared; larger ones
/// are made at every call. Cost: some 0.6 microseconds a texel and thread with AVX-512, and as much again for sheen.
/// The same bits on any number of threads and instruction set. Throws `Error`: invalid_argument, cancelled.
[[nodiscard]] std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options = {},
                                                          const Control& control = {});

// ---- Lobes other than GGX: Charlie sheen, Lambert, Phong, Blinn, or one of the caller's own
//
//   welkin::KernelChainOptions sheen{.size = 256};
//   for (const double roughness : welkin::charlie_roughness_of_mips(5, 256))
//     sheen.kernels.push_back(welkin::ZonalKernel::charlie(roughness));
//   const welkin::PrefilteredSpecular chain = welkin::prefilter_by_kernels(panorama, sheen);

namespace reflections {
class Lobe;
}

/// A lobe that is the same all about its axis: how much light counts, by the cosine c between it and the axis. All of
/// them are scaled so that their integral over the sphere is 1: even light stays as it is.
class ZonalKernel {
 public:
  /// Charlie sheen (Estevez and Kulla 2017) with N = V = R: c (1 - c)^p for c > 0, p = 1 / (2 alpha), alpha = roughness
  /// squared. It looks along the horizon, at c = 1 / (1 + p). Roughness in [0.01, 1]; below `kLeastCharlieRoughness`
  /// a picture may need more harmonic bands than there are.
  [[nodiscard]] static ZonalKernel charlie(double roughness);
  /// c for c > 0: irradiance over pi.
  [[nodiscard]] static ZonalKernel lambert();
  /// c^power for c > 0; power in [0.5, 1e6].
  [[nodiscard]] static ZonalKernel phong(double power);
  /// c h^power for c > 0, h = sqrt((1 + c) / 2) the cosine of the half vector; power in [0, 1e6].
  [[nodiscard]] static ZonalKernel blinn(double power);

  /// Any function of the cosine. `breaks`: cosines between -1 and 1 at which it or a derivative jumps; between them it
  /// must be smooth. It is called here and nowhere else, for cosines from -1 to 1, some hundred to some ten thousand
  /// times. It may be negative in places. Throws `Error` (invalid_argument): a value that is not finite, an integral
  /// that is not above 0, a function that no 2000 polynomials follow; and whatever `value` throws.
  [[nodiscard]] static ZonalKernel from_function(const std::function<double(double cosine)>& value,
                                                 const std::vector<double>& breaks = {0.0});

  /// What degree l of the environment is multiplied by, l = 0, 1, ...; over the first one, which must be above 0.
  /// Degrees that are not named are left out. 1 to 1536 of them, finite. Throws `Error` (invalid_argument).
  [[nodiscard]] static ZonalKernel from_spectrum(const std::vector<double>& factors);

  /// A steradian; for cosines from -1 to 1. Error: 1e-9 of the largest value.
  [[nodiscard]] double value(double cosine) const;
  /// k_l = 2 pi Int k(c) P_l(c) dc for l < bands, k_0 = 1: what the prefilter does to degree l. Error: 1e-10. `bands`
  /// from 1 to 1536; throws `Error` (invalid_argument) otherwise.
  [[nodiscard]] std::vector<double> spectrum(int bands) const;
  /// Of `charlie`; 0 of others.
  [[nodiscard]] double roughness() const noexcept { return roughness_; }

  /// From the inside: what the library reads.
  [[nodiscard]] const std::shared_ptr<const reflections::Lobe>& lobe() const noexcept { return lobe_; }

 private:
  ZonalKernel(std::shared_ptr<const reflections::Lobe> lobe, double roughness)
      : lobe_(std::move(lobe)), roughness_(roughness) {}

  std::shared_ptr<const reflections::Lobe> lobe_;
  double roughness_;
};

/// The lowest roughness of `charlie_roughness_of_mips`.
inline constexpr double kLeastCharlieRoughness = 0.05;

/// Roughness of each mip of a sheen chain as the sample renderer of glTF looks it up: t = mip / (floor(log2 size) - 1),
/// but no lower than `kLeastCharlieRoughness` (at 0 the lobe would be the horizon's circle) and no higher than 1.
/// Throws `Error` (invalid_argument) unless 1 <= mips <= 16 and 1 <= size <= 8192.
[[nodiscard]] std::vector<double> charlie_roughness_of_mips(int mips, int size);

/// A chain by kernels.
struct KernelChainOptions {
  int size = 256;                      ///< texels along an edge of mip 0: 1 to 8192
  std::vector<ZonalKernel> kernels{};  ///< one a mip: at least one, no more than the cubemap has levels

  /// `spectral`: a product with the kernel's spectrum in harmonics, bright texels each by the kernel. `automatic`: the
  /// same, and where its estimated error exceeds the bound the integral, if that takes a second at most. `reference`:
  /// the integral texel by texel in double, slow.
  PrefilterMethod method = PrefilterMethod::automatic;

  double rms_error = 1e-3;  ///< bound on a mip's relative root mean square error, by solid angle

  PixelPolicy pixels{};  ///< what becomes of the source's values first, as in `project`
};

/// Prefilters by a kernel a mip. Bounds are those of `prefilter_specular`: 0.1 % rms, 1 % at any texel, for kernels
/// whose values are continuous. Where source and kernel are nowhere negative the result is not. The same bits on any
/// number of threads and instruction set, of the kernels with names and wherever a caller's function has the same bits.
/// Cost: as `prefilter_specular`, and some 10 ns for each texel of the result and each bright one of the source.
/// Throws `Error`: invalid_argument; limit_exceeded (a kernel so narrow, or with so sharp an edge, that 1536 bands miss
/// the bound on this picture, or an estimated error above it: the message says by how much); rejected_pixel; cancelled.
[[nodiscard]] PrefilteredSpecular prefilter_by_kernels(const EnvironmentView& source, const KernelChainOptions& options,
                                                       const Control& control = {});

/// The truth at chosen directions, in double over all of the source's texels as areas: one entry per direction. Slow.
/// Throws `Error` (invalid_argument, cancelled).
[[nodiscard]] std::vector<dvec3> reference_by_kernel(const EnvironmentView& source, const ZonalKernel& kernel,
                                                     const std::vector<dvec3>& directions, const Control& control = {});

}  // namespace welkin
