// Estimates how far a spectral mip is from the reference, by what its factors leave out of the image's own spectrum.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/prefilter_plan.h"
#include "transform/image_rows.h"
#include "transform/spectrum.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// Squares of a spectrum's coefficients, summed over orders and channels: one for each degree.
[[nodiscard]] std::vector<double> energies_of(const transforms::Spectrum& spectrum);

/// Energy that an image has beyond the degrees that are known, and the degree that it would have in one wave.
struct EnergyBeyond {
  double energy = 0.0;
  double degree = 0.0;
};

/// Sums over an image of at most 2^19 texels: larger ones are not summed.
struct ImageSums {
  /// `rings`: on which the cubemap is read.
  ImageSums(const SourceRows& faces, int rings);
  explicit ImageSums(const transforms::ImageRows& rows);

  /// Returns what the image, whose first degrees have `energies`, has beyond them; nothing of a larger one.
  [[nodiscard]] EnergyBeyond beyond(std::span<const double> energies) const;

  double energy = 0.0;  ///< squares times steradians
  double steps = 0.0;   ///< squares of the gradient times steradians
  double texel = 0.0;   ///< radians of an edge
  double ring = 0.0;    ///< radians of a ring's height; 0: of a lat-long
};

/// The image that spectral mips are made of, as it was read.
struct SpectralSource {
  std::span<const double> energies;  ///< of what was left in the image
  int face_size = 0;                 ///< of a cubemap; 0: the image is a lat-long
  int rings = 0;                     ///< that it was read on
  bool finer = false;                ///< whether its texels are finer than the transform's bands
  double halved = 0.0;               ///< texels of its halved faces at their middle, radians; 0: they were not halved
  double contrast = 0.0;             ///< of a cubemap of few texels, see `contrast_of_faces`
  double steps = 0.0;                ///< see `contrast_of`, where there are narrow mips
  bool negative = false;             ///< whether it has negative values
  EnergyBeyond beyond{};             ///< of the energies
};

/// Root mean square error of a spectral mip over `rms`, its own, all three channels together:
///   sum over l of S_l ((k_l - z_l)^2 + (z_l s_l)^2 + (z_l r_l)^2) / 4 pi
/// and more: S_l the energies, k_l the lobe, z_l the factors, s_l what the spline loses between the synthesis' rings,
/// r_l what a cubemap's rings lose; energy that those scatter; `of_lights`, what the bright texels' lights err
/// (`BrightLights::error`). docs/maths/reflections.md. Degrees beyond the spectrum count with the last quarter's mean
/// energy, and what else the image has there in one wave.
[[nodiscard]] double spectral_rms_error(const MipPlan& mip, const SpectralSource& source, double of_lights, double rms);

/// Chooses the bands of each spectral mip of a plan of lobes other than GGX, of at most `plan.bands`, by the image's
/// energies, which go on as they fall. Returns `plan.bands`, or the number of bands to look at if some lobe of the
/// whole chain needs more. Throws `Error` (limit_exceeded) if there are no more.
[[nodiscard]] int choose_bands_by_energy(PrefilterPlan& plan, SpectralSource source);

/// Returns a mip that has near sums with the factors of its far part, tapered at the end.
[[nodiscard]] MipPlan with_far_part(MipPlan mip);

/// Returns whether the bands of a spectral mip keep `rms_error`. `lights` were extracted: they are part of its root
/// mean square.
[[nodiscard]] bool keeps_rms_error(const MipPlan& mip, double rms_error, const SpectralSource& source,
                                   const std::vector<BrightTexel>& lights);

/// Returns what the end of a GGX mip's bands leaves of such an image far from what is bright, root mean square over
/// the sphere: mostly by the lobe's kink at the horizon, 90 degrees away, where it may be dark.
[[nodiscard]] double truncated_afar(const MipPlan& mip, std::span<const double> energies);

/// Throws `Error` (limit_exceeded): the estimate of `what`, a spectral mip, is above the requested bound.
[[noreturn]] void refuse_rms_error(double estimate, double rms_error, const std::string& what);

/// Returns the root mean square over the sphere of an image of these energies whose degrees are multiplied by `zonal`.
[[nodiscard]] double blurred_rms(std::span<const double> energies, std::span<const double> zonal);

}  // namespace welkin::reflections
