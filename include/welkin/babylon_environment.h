// Babylon.js's .env file: a prefiltered cubemap as RGBD pictures, with the polynomial that its shaders use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>

#include "welkin/babylon.h"
#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/environment_writer.h"
#include "welkin/export.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// What an .env file holds, all of it in Babylon.js's axes, which are left-handed: x is Welkin's -x. Faces and rows are
/// in the order of `CubemapView`, row 0 on top (the file has them bottom row first).
struct BabylonEnvironment {
  int version = 2;                              ///< 1 or 2 when read; 2 is written
  CubemapChain specular;                        ///< mip k for alpha = 2^(k / lod_generation_scale) / size, 0 at mip 0
  std::optional<BabylonPolynomial> polynomial;  ///< as stored: it is used, not computed again
  double lod_generation_scale = 0.8;            ///< Babylon.js stores 0 for what was not prefiltered
  CubemapImage irradiance;  ///< irradiance / pi (1 in a uniform environment of 1); size 0: no irradiance texture
  std::optional<glm::dvec3> dominant_direction;  ///< of the light; kept with an irradiance texture alone
};

/// An environment from Welkin's axes to Babylon.js's: faces mirrored texel by texel, and the polynomial of the turned
/// coefficients. What Babylon.js shows is then what it shows of the same picture by itself, neither turned nor
/// mirrored. `specular`: empty or a chain; `irradiance_over_pi`: of any size, 0 for none. Throws `Error`: never of its
/// own.
[[nodiscard]] BabylonEnvironment to_babylon(const CubemapChain& specular, const SphericalHarmonics& radiance,
                                            const CubemapImage& irradiance_over_pi = {});

/// The same cubemap with x turned round: +X and -X change places, and columns run the other way. Both ways between
/// Welkin's axes and those of Babylon.js; no texel changes.
[[nodiscard]] CubemapChain mirrored_x(const CubemapChain& chain);
[[nodiscard]] CubemapImage mirrored_x(const CubemapImage& cubemap);

/// Reads one: versions 1 and 2 (older ones are read as 1), PNG and WebP pictures, told by their first bytes. Faces in
/// parallel; the same bits on any number of threads. The manifest may have 256 KiB; what the file's sizes take above
/// the memory limit is refused before a picture is read. Throws `Error`: file_access, corrupt_file, unsupported_file,
/// limit_exceeded, cancelled.
[[nodiscard]] BabylonEnvironment read_babylon_environment(const std::filesystem::path& path,
                                                          std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U,
                                                          const Control& control = {});

/// Writes version 2 with PNG pictures, packed in parallel: the same bytes on any number of threads. The chain's size
/// must be a power of two and the chain whole (down to 1 texel); a file is complete or not there. RGBD ends at 255 and
/// has no negatives: the report counts the values that were clamped, so the polynomial must come from the source and
/// not from mip 0. Throws `Error`: invalid_argument (also for an irradiance texture without a polynomial, and numbers
/// that are not finite), file_access, cancelled.
WriteReport write_babylon_environment(const std::filesystem::path& path, const BabylonEnvironment& environment,
                                      const Control& control = {});

}  // namespace welkin
