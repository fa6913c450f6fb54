// A file of spherical harmonics against the light that it was made from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/chain_check.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::tool {

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

/// Throws `Error`.
[[nodiscard]] HarmonicsCheck check_harmonics(const HarmonicsFile& file, const EnvironmentView& source,
                                             const PixelPolicy& pixels, const Control& control);

}  // namespace welkin::tool
