// Light of any maker against its source. Of a chain: how its faces lie, its scale, the roughness of each mip, and the
// errors; of spherical harmonics: their form, and the factor of each band.
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

/// The place of a face of the chain: a face of the source's cubemap, mirrored in its columns, in its rows or
/// transposed.
struct FaceMapping {
  int face = 0;
  bool columns_mirrored = false;
  bool rows_mirrored = false;
  bool transposed = false;  ///< before the two above

  friend bool operator==(const FaceMapping&, const FaceMapping&) = default;
};

/// How a chain's texels lie: their faces, and their channels.
struct ChainPlacement {
  std::array<FaceMapping, 6> faces{};
  /// Direction d of the chain shows direction matrix * d of the source. Empty if its faces do not fit together.
  std::optional<glm::dmat3> matrix = glm::dmat3(1.0);
  std::array<int, 3> channels = {0, 1, 2};  ///< the source's channel in each of the chain's

  [[nodiscard]] bool is_identity() const;
};

/// A placement, and the sum of squared differences that it leaves.
struct PlacementFit {
  ChainPlacement placement{};
  double difference = 0.0;
};

/// The texel of the source's cubemap that texel (column, row) of a face with this place shows.
[[nodiscard]] CubeTexel shown_by(const FaceMapping& place, int size, int column, int row);

/// Errors of a mip. All are relative: `rms` to the truth's root mean square, `bias` to its mean, and `largest` to the
/// truth at that texel and channel, or to a hundredth of its root mean square where it is darker.
struct MipErrors {
  double rms = 0.0;
  double largest = 0.0;
  double bias = 0.0;
  CubeTexel place{};  ///< of the largest
};

struct MipCheck {
  int size = 0;
  double roughness = 0.0;        ///< as stated, else of the best schedule
  double lobe_roughness = 0.0;   ///< that the truth of `errors` has: the same, or what is fitted to lookups
  std::optional<double> fitted;  ///< the roughness whose truth is nearest, free of scale
  glm::dvec3 scale{1.0};         ///< means over the truth's
  MipErrors errors{};
  double rest = 0.0;  ///< the rms error that roughness and scale do not explain
  /// Pairs of faces at whose edges the rest is more than three times that a few texels inside: "+X/+Y"
  std::vector<std::string> seams{};
  std::optional<double> clipped_at{};  ///< its largest value, if what remains comes from cutting the truth there
  std::uint64_t odd_values = 0;        ///< NaN and infinities, counted as 0
};

struct ChainCheck {
  ChainPlacement placement{};
  LobeFamily lobe = LobeFamily::ggx;  ///< or `lambert`
  double unit = 1.0;      ///< what a uniform environment of 1 gives: pi for irradiance that is not divided by it
  glm::dvec3 scale{1.0};  ///< the median of the mips'
  std::vector<MipCheck> mips{};
  std::optional<RoughnessSchedule> schedule{};  ///< the one that is nearest to the fitted roughness, if one is near
  double schedule_distance = 0.0;               ///< the root mean square distance in roughness
  bool fits_lookups = false;  ///< the lobes are those of `fitted_mip_roughness` for the schedule that is stated
  std::vector<std::string> findings{};  ///< what is wrong, in words

  /// The largest rms error of a mip.
  [[nodiscard]] double rms() const;
};

/// All schedules that a chain may follow.
inline constexpr std::array kRoughnessSchedules = {RoughnessSchedule::linear, RoughnessSchedule::filament,
                                                   RoughnessSchedule::babylon, RoughnessSchedule::unity,
                                                   RoughnessSchedule::unreal};

/// A chain, mip by mip: the sizes need not halve.
using ChainMips = std::vector<Cubemap>;

/// Checks a chain. `stated`: the roughness of each mip, or empty. Truths are Welkin's own, within 1e-4. Throws `Error`.
[[nodiscard]] ChainCheck check_chain(const ChainMips& chain, const EnvironmentView& source,
                                     const std::vector<double>& stated, const PixelPolicy& pixels,
                                     const Control& control);

/// Returns the truth of a mip as the chain's maker would have stored it: by its size, lobe and placement, in its unit.
[[nodiscard]] Cubemap truth_of(const ChainCheck& check, const MipCheck& mip, const EnvironmentView& source,
                               const PixelPolicy& pixels, const Control& control);

/// Finds how `image` shows `truth`, of the same size: by what differs least with radiance compressed, so that a sun
/// counts as much as a cloud. Of equal ones the simplest: as it is, one of a cube's 48 symmetries, each face for
/// itself.
[[nodiscard]] PlacementFit placement_of(const Cubemap& image, const Cubemap& truth);

/// "mirrored in x", "rotated by 90 degrees about y"; for other placements what each axis or face shows.
[[nodiscard]] std::string words_of(const ChainPlacement& placement);

/// "pi times", "1/2 of" the source's, or nothing if no such factor is near.
[[nodiscard]] std::string scale_words(double scale);

/// Three bands as a file states them: the function that they stand for, by direction.
struct HarmonicsFile {
  std::string words;  ///< "sh.json", "cmgen's text", "polynomial of Babylon.js"
  Cubemap values;     ///< the function at the centres of texels
};

/// Reads `welkin sh`'s JSON (sh.json too), and the nine lines of text that cmgen writes. Nothing for other files.
/// Throws `Error`: file_access, corrupt_file.
[[nodiscard]] std::optional<HarmonicsFile> read_harmonics(const std::filesystem::path& file);

/// Returns the polynomial of an .env file in Welkin's axes, if it has one.
[[nodiscard]] std::optional<HarmonicsFile> harmonics_of(const BabylonEnvironment& environment);

struct HarmonicsCheck {
  ChainPlacement placement{};
  std::string form;               ///< "radiance", "irradiance", ...
  std::vector<double> factors{};  ///< of bands 0 to 2, relative to that form of the source
  double rms = 0.0;               ///< error of the function over the root mean square of that form
  std::vector<std::string> findings{};
};

/// The root mean square of the difference over that of `expected`, which has as many bands; 0 where that is 0.
[[nodiscard]] double relative_difference(const SphericalHarmonics& found, const SphericalHarmonics& expected);

/// Throws `Error`.
[[nodiscard]] HarmonicsCheck check_harmonics(const HarmonicsFile& file, const EnvironmentView& source,
                                             const PixelPolicy& pixels, const Control& control);

}  // namespace welkin::tool
