// RGBD: radiance in four bytes, as Babylon.js's .env files keep it.
//
// With m = max(r, g, b): d = floor(255 / m) from 1 to 255, and a byte is the 1/2.2th power of channel x d / 255. So
// numbers up to 1 have d = 255 and are gamma-encoded colours; above, d falls, and at 255 it ends.
// (Babylon.js, ShadersInclude/helperFunctions: toRGBD, fromRGBD.)
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

/// The same bytes on every machine: the power is a table of the places where one byte gives way to the next.
class RgbdEncoder {
 public:
  RgbdEncoder();

  /// Texels of four bytes from packed RGB. Returns how many channel values were clamped to 0 .. 255 (NaN becomes 0).
  std::uint64_t encode(const float* rgb, std::size_t count, std::uint8_t* rgbd) const noexcept;

 private:
  [[nodiscard]] std::uint8_t gamma(double value) const noexcept;

  std::array<double, 255> thresholds_{};
};

/// Each rounded once to float. A d of 0, which no writer makes, is taken as 1.
class RgbdDecoder {
 public:
  RgbdDecoder();
  void decode(const std::uint8_t* rgbd, std::size_t count, float* rgb) const noexcept;

 private:
  std::array<double, 256> linear_{};
};

// The text at the beginning of a Babylon.js .env file, and where its images lie.
//
//   signature, JSON, a zero byte, images. Positions count from the byte after the zero.
//   (@babylonjs/core 9.34, Misc/environmentTextureTools.)

/// Bytes of one image.
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

/// Reads the signature and the text and checks all of it: every image lies inside the file. Throws `Error`:
/// corrupt_file, unsupported_file (another kind of file, a newer version), file_access.
[[nodiscard]] EnvManifest read_env_manifest(platform::ByteFile& file);

/// Signature, JSON and zero byte; positions as they are in `manifest`.
[[nodiscard]] std::string env_manifest_bytes(const EnvManifest& manifest);

[[nodiscard]] bool is_env(platform::ByteFile& file);

// Babylon.js .env files as rows.

/// A file that `is_env`. Faces come in Welkin's axes (x mirrored: Babylon.js's are left-handed) as a vertical strip;
/// each decodes whole. Throws as `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_env(platform::ByteFile& file, const ReadOptions& options);

// The small images inside an .env file: RGBA of 8 bits, in memory.

/// An image as it stands in a file, of which messages speak as `what`. It must be `size` x `size` texels.
struct EnvImageBytes {
  const std::vector<std::uint8_t>& bytes;
  int size;
  const std::filesystem::path& path;
  const std::string& what;

  /// Throws `Error` naming the file and the image.
  [[noreturn]] void refuse(ErrorCode code, const std::string& message) const;
  /// Throws `Error` (corrupt_file) if an image of these edges is another one than the level's.
  void require_size(std::uint64_t width, std::uint64_t height) const;
};

/// A PNG of `size` x `size` texels, rows as they are given, without any word on colours: they are numbers, and no
/// viewer is to turn them. `stop` is looked at before each row. Throws `Error` (cancelled), `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& rgba, int size,
                                                        const stop_token& stop = {});

/// Decodes a PNG or a WebP, told by its first bytes, to 4 x size x size bytes. `stop` is looked at before each row of a
/// PNG. Throws `Error`: corrupt_file, unsupported_file, cancelled.
void decode_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop = {});

// One function a library; a build can leave out either (codecs.h).
void decode_png_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop);
void decode_webp_rgba(const EnvImageBytes& image, std::uint8_t* rgba);

}  // namespace welkin::files
