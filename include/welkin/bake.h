// The whole of image-based lighting in one call: all that a physically based renderer loads.
//
//   welkin::BakeResult light = welkin::bake(panorama, {.specular = welkin::PrefilterOptions{.size = 512}});
//   upload(light.specular->cubemap);  upload(light.irradiance);  upload(*light.brdf);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace WELKIN_EXPORT welkin {

enum class IrradianceMethod {
  harmonics,  ///< from the coefficients
  direct,     ///< by direct convolution: the reference, slow
};

/// What a bake makes, and how. The default is all of it.
struct BakeOptions {
  /// Texels along an edge of the background cubemap, up to 16384. 0: the specular cubemap's; without one the source's
  /// own, of a lat-long a quarter of its width.
  int background_size = 0;
  bool background = true;                         ///< a sharp cubemap, for what is seen behind a scene
  bool background_mips = true;                    ///< down to 1 texel; or level 0 alone
  MipFilter mip_filter = MipFilter::solid_angle;  ///< how each level of the background is made from the one before

  /// None: no prefilter. Its `pixels` are not used, but those below.
  std::optional<PrefilterOptions> specular = PrefilterOptions{};

  int irradiance_size = 64;  ///< texels along an edge, up to 4096; 0: no irradiance cubemap
  IrradianceMethod irradiance_method = IrradianceMethod::harmonics;  ///< how the irradiance cubemap is computed
  int bands = 3;  ///< harmonic bands that are returned, and that the irradiance cubemap is made from; 0: none

  /// If above `bands`: so many bands are projected, and the first `bands` of them are returned. They have the same bits
  /// as in a bake of that many bands. A projection of fewer bands differs from them by rounding.
  int projected_bands = 0;
  /// Whether a bake with `bands` = 0 still projects one band, which gives the diagnostics' total radiance. Else it is
  /// 0.
  bool total_radiance = true;

  std::optional<BrdfTableOptions> brdf = BrdfTableOptions{};  ///< none: no table

  PixelPolicy pixels{};  ///< what becomes of the source's values first, for all passes alike

  /// Results and working memory together; a bake that may need more is refused before it begins.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;

  friend bool operator==(const BakeOptions&, const BakeOptions&) = default;
};

/// What a bake made. What was not asked for is empty, as each member says.
struct BakeResult {
  CubemapChain background;                      ///< radiance; no levels if it was not asked for
  std::optional<PrefilteredSpecular> specular;  ///< reflections; none if they were not asked for
  CubemapImage irradiance;                      ///< W/m2 for W/m2/sr; size 0 if it was not asked for
  std::optional<SphericalHarmonics> radiance;   ///< coefficients: the very bits of `project` (of an .env: see below)
  std::shared_ptr<const BrdfTable> brdf;        ///< null if it was not asked for; shared with other bakes

  /// Of an .env file, as it is stored there, in Babylon.js's axes. Up to three bands of `radiance` and the irradiance
  /// cubemap come from it and not from the pixels, which end at 255.
  std::optional<BabylonPolynomial> stored_polynomial;

  /// Pixels read, replaced and clamped; total radiance and error estimate as `project` has them; each pass ("clean",
  /// "background", "background mips", "specular", "project", "irradiance", "brdf", of files "read" before them) with
  /// its wall time: as passes overlap, times add up to more than the bake took.
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes = 0;  ///< bound on results and working memory together: what `bake_bytes` says
};

/// Memory that `bake` needs at most, results included, source not. Throws `Error` (invalid_argument) as `bake`.
[[nodiscard]] std::uint64_t bake_bytes(const LatLongView& source, const BakeOptions& options = {});
[[nodiscard]] std::uint64_t bake_bytes(const CubemapView& source, const BakeOptions& options = {});

/// Bakes. Passes that do not wait for each other run at the same time, in the caller's arena; faces, mips and rows are
/// parallel inside each. The same bits on any number of threads and instruction set. Progress is one number over all
/// passes, weighed by what they are expected to cost. Throws `Error`: invalid_argument, rejected_pixel, limit_exceeded
/// (`bake_bytes` above the limit), cancelled; after any of them there is no result, and no pass still runs.
[[nodiscard]] BakeResult bake(const LatLongView& source, const BakeOptions& options = {}, const Control& control = {});
[[nodiscard]] BakeResult bake(const CubemapView& source, const BakeOptions& options = {}, const Control& control = {});

/// The same into an older result, whose background and specular cubemap keep their memory where sizes are the same:
/// fresh pages cost the system time. After an exception `result` can only be baked into again, or freed.
void bake_into(BakeResult& result, const LatLongView& source, const BakeOptions& options = {},
               const Control& control = {});
void bake_into(BakeResult& result, const CubemapView& source, const BakeOptions& options = {},
               const Control& control = {});

}  // namespace welkin
