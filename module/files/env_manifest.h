// The text at the beginning of a Babylon.js .env file, and where its pictures lie.
//
//   signature, JSON, a zero byte, pictures. Positions count from the byte after the zero.
//   (@babylonjs/core 9.34, Misc/environmentTextureTools.)
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/file.h"
#include "welkin/engines.h"

namespace welkin::files {

/// Bytes of one picture.
struct EnvPicture {
  std::uint64_t position = 0;  ///< from the beginning of the file, once it is read; from the payload's when written
  std::uint64_t length = 0;
};

struct EnvManifest {
  int version = 2;
  int width = 0;  ///< of level 0, a power of two
  std::string image_type = "image/png";
  std::optional<BabylonPolynomial> polynomial;
  double lod_generation_scale = 0.8;
  std::vector<EnvPicture> specular;  ///< level x 6 + face
  int irradiance_size = 0;           ///< 0: there is no irradiance texture
  std::vector<EnvPicture> irradiance;
  std::optional<glm::dvec3> dominant_direction;

  [[nodiscard]] int levels() const noexcept { return static_cast<int>(specular.size() / 6); }
};

/// Reads the signature and the text and checks all of it: every picture lies inside the file. Throws `Error`:
/// corrupt_file, unsupported_file (another kind of file, a newer version), file_access.
[[nodiscard]] EnvManifest read_env_manifest(platform::ByteFile& file);

/// Signature, JSON and zero byte; positions as they are in `manifest`.
[[nodiscard]] std::string env_manifest_bytes(const EnvManifest& manifest);

[[nodiscard]] bool is_env(platform::ByteFile& file);

}  // namespace welkin::files
