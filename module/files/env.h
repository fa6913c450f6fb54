// RGBD: radiance in four bytes, as stored in Babylon.js's .env files.
//
// With m = max(r, g, b): d = floor(255 / m) from 1 to 255, and a byte is the 1/2.2th power of channel x d / 255. Values
// up to 1 have d = 255 and are gamma-encoded colours; above 1, d falls, and 255 is the maximum. (Babylon.js,
// ShadersInclude/helperFunctions: toRGBD, fromRGBD.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/row_source.h"
#include "platform/file.h"
#include "welkin/core.h"
#include "welkin/engines.h"

namespace welkin::files {

inline constexpr float kLargestRgbd = 255.0F;

/// An encoder with the same bytes on every machine: a table of the thresholds between bytes replaces the power.
class RgbdEncoder {
 public:
  RgbdEncoder();

  /// Encodes packed RGB to texels of four bytes. Returns the number of values clamped to 0 .. 255 (NaN becomes 0).
  std::uint64_t encode(const float* rgb, std::size_t count, std::uint8_t* rgbd) const noexcept;

 private:
  [[nodiscard]] std::uint8_t gamma(double value) const noexcept;

  std::array<double, 255> thresholds_{};
};

/// A decoder, whose values are each rounded once to float. A d of 0, which no writer makes, is taken as 1.
class RgbdDecoder {
 public:
  RgbdDecoder();
  void decode(const std::uint8_t* rgbd, std::size_t count, float* rgb) const noexcept;

 private:
  std::array<double, 256> linear_{};
};

// The text at the beginning of a Babylon.js .env file, and the offsets of its images.
//
//   signature, JSON, a zero byte, images. Positions count from the byte after the zero.
//   (@babylonjs/core 9.34, Misc/environmentTextureTools.)

/// The byte range of one image.
struct EnvImage {
  std::uint64_t position = 0;  ///< from the beginning of the file, once it is read; from the payload's when written
  std::uint64_t length = 0;
};

struct EnvManifest {
  int version = 2;
  int width = 0;  ///< of level 0, a power of two
  std::string image_type = "image/png";
  std::optional<BabylonPolynomial> polynomial;
  double lod_generation_scale = 0.8;
  std::vector<EnvImage> specular;  ///< level x 6 + face
  int irradiance_size = 0;         ///< 0: there is no irradiance texture
  std::vector<EnvImage> irradiance;
  std::optional<glm::dvec3> dominant_direction;

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(specular.size() / 6); }
};

/// Reads and checks the signature and the whole text: every image lies inside the file. Throws `Error`: corrupt_file,
/// unsupported_file (another kind of file, a newer version), file_access.
[[nodiscard]] EnvManifest read_env_manifest(platform::ByteFile& file);

/// Returns signature, JSON and zero byte; offsets are those in `manifest`.
[[nodiscard]] std::string env_manifest_bytes(const EnvManifest& manifest);

[[nodiscard]] bool is_env(platform::ByteFile& file);

// Babylon.js .env files as rows.

/// Opens a file for which `is_env` holds. Faces come in Welkin's axes (x mirrored: Babylon.js's are left-handed) as a
/// vertical strip; each is decoded whole. Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_env(platform::ByteFile& file, const ReadOptions& options);

// The small images inside an .env file: RGBA of 8 bits, in memory.

/// An image as stored in a file, called `what` in messages. It must be `size` x `size` texels.
struct EnvImageBytes {
  const std::vector<std::uint8_t>& bytes;
  int size;
  const std::filesystem::path& path;
  const std::string& what;

  /// Throws `Error` naming the file and the image.
  [[noreturn]] void refuse(ErrorCode code, const std::string& message) const;
  /// Throws `Error` (corrupt_file) if this size is not that of the level.
  void require_size(std::uint64_t width, std::uint64_t height) const;
};

/// Encodes a PNG of `size` x `size` texels, rows unchanged, without colour metadata: the bytes are numbers that no
/// viewer may convert. `stop` is checked before each row. Throws `Error` (cancelled), `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& rgba, int size,
                                                        const stop_token& stop = {});

/// Decodes a PNG or a WebP, identified by its first bytes, to 4 x size x size bytes. `stop` is checked before each row
/// of a PNG. Throws `Error`: corrupt_file, unsupported_file, cancelled.
void decode_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop = {});

// One function per library; a build can leave out either (codecs.h).
void decode_png_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop);
void decode_webp_rgba(const EnvImageBytes& image, std::uint8_t* rgba);

}  // namespace welkin::files
