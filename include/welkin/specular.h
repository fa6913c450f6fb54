// Prefiltered specular light: an environment blurred by GGX lobes, a mip for each roughness (split sum, N = V = R).
//
//   P(n) = Int L(l) k(n.l) dl / Int k(n.l) dl,   k(c) = c D(sqrt((1 + c) / 2)) for c > 0, else 0,
//   D(h) = a^2 / (pi (h^2 (a^2 - 1) + 1)^2),     a = roughness^2
//
// That is the limit of Karis' sum of half-vector samples weighted by n.l (Real Shading in Unreal Engine 4, 2013).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/export.h"
#include "welkin/image_view.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

enum class PrefilterMethod {
  automatic,  ///< for each mip the fastest within both bounds; below roughness 0.055 sampled, which is not within
  spectral,   ///< product with the kernel's spectrum in harmonics; the brightest texels each by its own lobe
  sampled,    ///< filtered importance sampling (Krivanek and Colbert 2008; Karis 2013): one list of taps a mip
  reference,  ///< the integral, texel by texel in double: the truth that the others are measured against. Slow.
};

/// "automatic", "spectral", "sampled", "reference"
[[nodiscard]] const char* name(PrefilterMethod method) noexcept;

/// Sizes, roughness and bounds of a chain.
struct PrefilterOptions {
  int size = 256;  ///< texels along an edge of mip 0: 1 to 8192
  int mips = 0;    ///< 0: as many as `roughness` names, else down to 1 texel

  /// Perceptual roughness in [0, 1] of each mip; empty: `roughness_of_mips(linear, mips, size)`. 0: no blur.
  std::vector<double> roughness{};

  /// Mips that are not made: so many at the chain's sharp end, and at its rough end; one at least stays. The others are
  /// the very bits of the whole chain's, and level 0 of the result has size >> leave_out_sharp texels along an edge.
  int leave_out_sharp = 0;
  /// At the rough end, likewise.
  int leave_out_rough = 0;

  PrefilterMethod method = PrefilterMethod::automatic;  ///< how each mip is computed

  double rms_error = 1e-3;      ///< bound on a mip's relative root mean square error, by solid angle
  double maximum_error = 1e-2;  ///< bound on |result - truth| / truth at any texel

  int samples = 1024;  ///< of the sampled method, a texel

  /// Pixels: only clamp, gamma and the policies for NaN, infinities and negatives matter, and act as in `project`.
  ProjectionOptions pixels{};

  friend bool operator==(const PrefilterOptions&, const PrefilterOptions&) = default;
};

/// How one mip was made, and how good it is.
struct MipRecord {
  int size = 0;                 ///< texels along an edge
  double roughness = 0.0;       ///< perceptual
  std::string method;           ///< "copy" or a `PrefilterMethod`'s name
  int bands = 0;                ///< spectral: harmonic bands that were used
  int bright_texels = 0;        ///< spectral: texels whose lobes were added one by one
  int samples = 0;              ///< sampled: taps a texel
  double error_estimate = 0.0;  ///< predicted largest relative error
  glm::dvec3 mean{};            ///< by solid angle: in truth the same on every mip (the kernel keeps energy)
  double milliseconds = 0.0;    ///< wall time
};

/// A chain of reflections.
struct PrefilteredSpecular {
  CubemapChain cubemap;          ///< a level for each mip
  std::vector<MipRecord> mips;   ///< one record for each mip
  ProjectionDiagnostics pixels;  ///< what was read, replaced and clamped; its passes are the prefilter's
  std::uint64_t peak_bytes = 0;  ///< of working memory, beside source and result
};

/// Prefilters. Mip 0 of roughness 0 is the source resampled by area (`to_cubemap`; the very texels of a cubemap of the
/// same size). Not negative where the source is not; uniform ones stay so to 1e-6, ranges to `maximum_error` of an end.
/// The same bits on any number of threads and instruction set.
/// Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded (error bounds that no method reaches), cancelled.
[[nodiscard]] PrefilteredSpecular prefilter_specular(const LatLongView& source, const PrefilterOptions& options = {},
                                                     const Control& control = {});
[[nodiscard]] PrefilteredSpecular prefilter_specular(const CubemapView& source, const PrefilterOptions& options = {},
                                                     const Control& control = {});

/// The truth at chosen directions, in double over all of the source's texels as areas: one entry a direction, which
/// need not be of unit length. Cost: some 10 ns a source texel and direction. Throws `Error` (invalid_argument,
/// cancelled).
[[nodiscard]] std::vector<glm::dvec3> reference_specular(const LatLongView& source, double roughness,
                                                         const std::vector<glm::dvec3>& directions,
                                                         const Control& control = {});
[[nodiscard]] std::vector<glm::dvec3> reference_specular(const CubemapView& source, double roughness,
                                                         const std::vector<glm::dvec3>& directions,
                                                         const Control& control = {});

}  // namespace welkin
