// Checks light of any origin against its source. A chain: the placement of its faces, its scale, the roughness of each
// mip, and the errors. Spherical harmonics: their form, and the factor of each band.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

using image::CubeTexel;

/// The placement of a face of the chain: a face of the source's cubemap, mirrored in its columns, in its rows or
/// transposed.
struct FaceMapping {
  int face = 0;
  bool columns_mirrored = false;
  bool rows_mirrored = false;
  bool transposed = false;  ///< before the two above

  friend bool operator==(const FaceMapping&, const FaceMapping&) = default;
};

/// The placement of a chain's texels: its faces and its channels.
struct ChainPlacement {
  std::array<FaceMapping, 6> faces{};
  /// Direction d of the chain shows direction matrix * d of the source. Empty if the faces do not fit together.
  std::optional<glm::dmat3> matrix = glm::dmat3(1.0);
  std::array<int, 3> channels = {0, 1, 2};  ///< the source's channel in each channel of the chain

  [[nodiscard]] bool is_identity() const;
};

/// A placement, and the sum of squared differences that it leaves.
struct PlacementFit {
  ChainPlacement placement{};
  double difference = 0.0;
};

/// Returns the texel of the source's cubemap that texel (column, row) of a face with this mapping shows.
[[nodiscard]] CubeTexel shown_by(const FaceMapping& mapping, int size, int column, int row);

/// Errors of a mip. All are relative: `rms` to the reference's root mean square, `bias` to its mean, and `largest` to
/// the reference at that texel and channel, or to a hundredth of its root mean square where it is darker.
struct MipErrors {
  double rms = 0.0;
  double largest = 0.0;
  double bias = 0.0;
  CubeTexel place{};  ///< of the largest error
};

struct MipCheck {
  int size = 0;
  double roughness = 0.0;        ///< as stated, else by the best schedule
  double lobe_roughness = 0.0;   ///< of the reference for `errors`: equal, or fitted to lookups
  std::optional<double> fitted;  ///< roughness of the nearest reference at any scale
  glm::dvec3 scale{1.0};         ///< ratio of the means to the reference's
  MipErrors errors{};
  double rest = 0.0;  ///< rms error that roughness and scale do not explain
  /// Pairs of faces at whose edges the rest is more than three times that of texels a few rows inside: "+X/+Y"
  std::vector<std::string> seams{};
  std::optional<double> clipped_at{};  ///< the largest value, if clipping the reference there explains the rest
  std::uint64_t odd_values = 0;        ///< NaN and infinities, counted as 0
};

struct ChainCheck {
  ChainPlacement placement{};
  LobeFamily lobe = LobeFamily::ggx;  ///< or `lambert`
  double unit = 1.0;      ///< value that a uniform environment of 1 gives: pi for irradiance that is not divided by it
  glm::dvec3 scale{1.0};  ///< median of the mips' scales
  std::vector<MipCheck> mips{};
  std::optional<RoughnessSchedule> schedule{};  ///< nearest to the fitted roughness, if one is near
  double schedule_distance = 0.0;               ///< root mean square distance in roughness
  bool fits_lookups = false;            ///< the lobes are those of `fitted_mip_roughness` for the stated schedule
  std::vector<std::string> findings{};  ///< the problems found, in words

  /// Returns the largest rms error of a mip.
  [[nodiscard]] double rms() const;
};

/// All schedules that a chain may follow.
inline constexpr std::array kRoughnessSchedules = {RoughnessSchedule::linear, RoughnessSchedule::filament,
                                                   RoughnessSchedule::babylon, RoughnessSchedule::unity,
                                                   RoughnessSchedule::unreal};

/// A chain, mip by mip: the sizes need not halve.
using ChainMips = std::vector<Cubemap>;

/// Checks a chain. `stated`: roughness per mip, or empty. References are Welkin's own, within 1e-4. Throws `Error`.
[[nodiscard]] ChainCheck check_chain(const ChainMips& chain, const EnvironmentView& source,
                                     const std::vector<double>& stated, const PixelPolicy& pixels,
                                     const Control& control);

/// Returns the reference of a mip as the chain's maker would have stored it: with its size, lobe, placement and unit.
[[nodiscard]] Cubemap truth_of(const ChainCheck& check, const MipCheck& mip, const EnvironmentView& source,
                               const PixelPolicy& pixels, const Control& control);

/// Finds how `image` shows `truth`, of the same size, by the least difference of compressed radiance, so that a sun
/// counts as much as a cloud. Of equal ones the simplest: unchanged, one of a cube's 48 symmetries, each face
/// separately.
[[nodiscard]] PlacementFit placement_of(const Cubemap& image, const Cubemap& truth);

/// Returns "mirrored in x", "rotated by 90 degrees about y"; for other placements what each axis or face shows.
[[nodiscard]] std::string words_of(const ChainPlacement& placement);

/// Returns "pi times", "1/2 of" the source's, or nothing if no such factor is near.
[[nodiscard]] std::string scale_words(double scale);

/// Three bands of a file, as the function of direction that they represent.
struct HarmonicsFile {
  std::string words;  ///< "sh.json", "cmgen's text", "polynomial of Babylon.js"
  Cubemap values;     ///< the function at the texel centres
};

/// Reads `welkin sh`'s JSON (sh.json too), and the nine lines of text that cmgen writes. Returns nothing for other
/// files. Throws `Error`: file_access, corrupt_file.
[[nodiscard]] std::optional<HarmonicsFile> read_harmonics(const std::filesystem::path& file);

/// Returns the polynomial of an .env file in Welkin's axes, if it has one.
[[nodiscard]] std::optional<HarmonicsFile> harmonics_of(const BabylonEnvironment& environment);

struct HarmonicsCheck {
  ChainPlacement placement{};
  std::string form;               ///< "radiance", "irradiance", ...
  std::vector<double> factors{};  ///< of bands 0 to 2, relative to that form of the source
  double rms = 0.0;               ///< error of the function relative to the root mean square of that form
  std::vector<std::string> findings{};
};

/// Returns the rms of the difference relative to that of `expected`, which has as many bands; 0 where that is 0.
[[nodiscard]] double relative_difference(const SphericalHarmonics& found, const SphericalHarmonics& expected);

/// Checks harmonics against the source. Throws `Error`.
[[nodiscard]] HarmonicsCheck check_harmonics(const HarmonicsFile& file, const EnvironmentView& source,
                                             const PixelPolicy& pixels, const Control& control);

}  // namespace welkin::tool
