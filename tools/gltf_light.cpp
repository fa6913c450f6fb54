#include "tools/gltf_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "math/elementary.h"
#include "tools/json.h"
#include "tools/turning.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"

namespace welkin::tool {
namespace {

constexpr const char* kExtension = "EXT_lights_image_based";

// GLB (glTF 2.0, section 4.4): a header of 12 bytes, then chunks of a length, a type, and bytes that end at a multiple
// of four. All numbers are little-endian.
constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

void append_number(std::uint32_t value, std::string& bytes) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>((value >> shift) & 0xFFU));
}

void pad(std::string& bytes, char filling) {
  while (bytes.size() % 4 != 0) bytes.push_back(filling);
}

void append_chunk(std::uint32_t type, const std::string& content, std::string& bytes) {
  append_number(static_cast<std::uint32_t>(content.size()), bytes);
  append_number(type, bytes);
  bytes += content;
}

std::string glb(const Json& document, std::string binary) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  std::string text = document.one_line();
  pad(text, ' ');
  pad(binary, '\0');
  const std::size_t size = kHeader + 2 * kChunkHeader + text.size() + binary.size();
  if (size > ~std::uint32_t{0}) {
    throw Error(ErrorCode::limit_exceeded, "environment.glb would have " + std::to_string(size) +
                                               " bytes, and the limit of a .glb is 4 GiB; pass a smaller --size");
  }
  std::string bytes;
  bytes.reserve(size);
  append_number(kMagic, bytes);
  append_number(kVersion, bytes);
  append_number(static_cast<std::uint32_t>(size), bytes);
  append_chunk(kJsonChunk, text, bytes);
  append_chunk(kBinaryChunk, binary, bytes);
  return bytes;
}

int octaves_of(int size) noexcept {
  int octaves = 0;
  while ((size >> (octaves + 1)) > 0) ++octaves;
  return octaves;
}

/// Numbers of the pictures, six a mip.
Json mips_json(std::size_t pictures) {
  Json mips = Json::array();
  for (std::size_t first = 0; first < pictures; first += 6) {
    Json faces = Json::array();
    for (std::size_t picture = first; picture < first + 6; ++picture) faces.push_back(picture);
    mips.push_back(faces);
  }
  return mips;
}

/// The extension's object at the root of the document.
Json lights_json(int size, std::size_t pictures, const std::array<glm::dvec3, 9>& coefficients) {
  Json nine = Json::array();
  for (const glm::dvec3& rgb : coefficients) nine.push_back(json_triple(rgb));
  Json light = {
      {"name", "environment"},          {"intensity", 1.0},          {"rotation", Json::array({0.0, 0.0, 0.0, 1.0})},
      {"irradianceCoefficients", nine}, {"specularImageSize", size}, {"specularImages", mips_json(pictures)}};
  Json lights = Json::object();
  lights["lights"] = Json::array({light});
  return lights;
}

Json extension(const Json& content) {
  Json extensions = Json::object();
  extensions[kExtension] = content;
  return extensions;
}

}  // namespace

int gltf_light_size(int specular_size) noexcept { return std::max(2, 1 << octaves_of(specular_size)); }

int gltf_light_mips(int size) noexcept {
  constexpr int kLastOctaves = 3;  // 8 texels
  return std::max(2, octaves_of(size) + 1 - kLastOctaves);
}

std::vector<double> gltf_light_roughness(int size, int mips) {
  std::vector<double> table;
  for (int mip = 0; mip < mips; ++mip) {
    const double power = octaves_of(size) * (static_cast<double>(mip) / (mips - 1) - 1.0);  // alpha = 2^power
    table.push_back(mip == 0 ? 0.0 : math::exponential(0.5 * std::numbers::ln2 * power));
  }
  return table;
}

std::array<glm::dvec3, 9> gltf_light_coefficients(const SphericalHarmonics& radiance) {
  std::array<glm::dvec3, 9> coefficients{};
  const EngineLight light = engine_light(radiance, Engine::gltf);
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = light.terms[k].rgb;
  for (const std::size_t odd_in_x : {3U, 4U, 7U}) coefficients[odd_in_x] *= -1.0;
  return coefficients;
}

GltfLight gltf_light(const Cubemap& specular, const SphericalHarmonics& radiance, const Control& control) {
  // The loader looks faces up, too, in Babylon.js's axes, whose x is glTF's -x.
  const Cubemap faces = mirrored_x(turned(specular, faces_of(Engine::gltf), control));
  const RgbdPictures pictures = rgbd_pictures(faces, control);
  std::string binary;
  Json views = Json::array();
  Json images = Json::array();
  for (const std::vector<std::uint8_t>& png : pictures.png) {
    pad(binary, '\0');
    images.push_back({{"bufferView", images.size()}, {"mimeType", "image/png"}});
    views.push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", png.size()}});
    binary.append(png.begin(), png.end());
  }
  pad(binary, '\0');
  Json buffer = Json::object();
  buffer["byteLength"] = binary.size();
  Json scene = Json::object();
  Json reference = Json::object();
  reference["light"] = 0;
  scene["extensions"] = extension(reference);
  const Json document = {
      {"asset", {{"version", "2.0"}, {"generator", std::string("Welkin ") + WELKIN_VERSION_STRING}}},
      {"extensionsUsed", Json::array({kExtension})},
      {"extensions", extension(lights_json(faces.size(), pictures.png.size(), gltf_light_coefficients(radiance)))},
      {"scene", 0},
      {"scenes", Json::array({scene})},
      {"images", images},
      {"bufferViews", views},
      {"buffers", Json::array({buffer})}};
  return {glb(document, std::move(binary)), pictures.values_clamped};
}

}  // namespace welkin::tool
