// Prefiltering by lobes other than GGX: Charlie sheen, Lambert, Phong, Blinn, or one of the caller's own.
//
//   welkin::KernelChainOptions sheen{.size = 256};
//   for (const double roughness : welkin::charlie_roughness_of_mips(5, 256))
//     sheen.kernels.push_back(welkin::ZonalKernel::charlie(roughness));
//   const welkin::PrefilteredSpecular chain = welkin::prefilter_by_kernels(panorama, sheen);
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace WELKIN_EXPORT welkin {

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
[[nodiscard]] PrefilteredSpecular prefilter_by_kernels(const LatLongView& source, const KernelChainOptions& options,
                                                       const Control& control = {});
[[nodiscard]] PrefilteredSpecular prefilter_by_kernels(const CubemapView& source, const KernelChainOptions& options,
                                                       const Control& control = {});

/// The truth at chosen directions, in double over all of the source's texels as areas: one entry per direction. Slow.
/// Throws `Error` (invalid_argument, cancelled).
[[nodiscard]] std::vector<dvec3> reference_by_kernel(const LatLongView& source, const ZonalKernel& kernel,
                                                     const std::vector<dvec3>& directions, const Control& control = {});
[[nodiscard]] std::vector<dvec3> reference_by_kernel(const CubemapView& source, const ZonalKernel& kernel,
                                                     const std::vector<dvec3>& directions, const Control& control = {});

}  // namespace welkin
