#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "files/env.h"
#include "files/row_source.h"
#include "image/pixels.h"

namespace welkin::files {
namespace {

using Json = nlohmann::json;  // finds a name directly; the ordered one searches all names
using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view kSignature = "\x86\x16\x87\x96\xF6\xD6\x96\x36";
constexpr int kNewestVersion = 2;
constexpr int kDeepestNesting = 8;                               // valid manifests have 4
constexpr std::uint64_t kLongestText = std::uint64_t{1} << 18U;  // valid manifests have a few kilobytes
constexpr double kLargestExact = 9007199254740992.0;             // 2^53
constexpr double kLargestTerm = std::numeric_limits<float>::max();

struct Term {
  const char* name;
  glm::dvec3 BabylonPolynomial::*rgb;
};

constexpr std::array kTerms{
    Term{"x", &BabylonPolynomial::x},   Term{"y", &BabylonPolynomial::y},   Term{"z", &BabylonPolynomial::z},
    Term{"xx", &BabylonPolynomial::xx}, Term{"yy", &BabylonPolynomial::yy}, Term{"zz", &BabylonPolynomial::zz},
    Term{"yz", &BabylonPolynomial::yz}, Term{"zx", &BabylonPolynomial::zx}, Term{"xy", &BabylonPolynomial::xy}};

/// A defect in a manifest; the file's name is put before it where it is known.
struct Flaw {
  ErrorCode code;
  std::string message;
};

[[noreturn]] void refuse(const std::string& message) { throw Flaw{ErrorCode::corrupt_file, "its manifest " + message}; }

/// Returns null if the key is missing.
const Json* find(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

const Json& require(const Json& object, const char* key) {
  const Json* found = find(object, key);
  if (found == nullptr) refuse(std::string("has no \"") + key + "\", which is required");
  return *found;
}

double number(const Json& value, const char* what) {
  if (!value.is_number()) refuse(std::string("has a \"") + what + "\" that is not a number");
  return value.get<double>();
}

std::uint64_t whole_number(const Json& value, const char* what) {
  const double found = number(value, what);
  if (!(found >= 0.0 && found <= kLargestExact) || found != std::floor(found)) {
    refuse(std::string("has a \"") + what + "\" that is not an integer from 0 up");
  }
  return static_cast<std::uint64_t>(found);
}

glm::dvec3 triple(const Json& value, const char* what) {
  if (!value.is_array() || value.size() != 3) refuse(std::string("has a \"") + what + "\" that is not three numbers");
  const glm::dvec3 found(number(value[0], what), number(value[1], what), number(value[2], what));
  if (!std::isfinite(found.x) || !std::isfinite(found.y) || !std::isfinite(found.z)) {
    refuse(std::string("has a \"") + what + "\" that is not finite");
  }
  return found;
}

/// Reads a cubemap's edge. `power`: must be a power of two.
int edge(const Json& value, const char* what, bool power) {
  const std::uint64_t size = whole_number(value, what);
  if (size < 1 || size > image::kLargestFace || (power && !std::has_single_bit(size))) {
    refuse(std::string("has a \"") + what + "\" of " + std::to_string(size) + "; it must be " +
           (power ? "a power of two " : "") + "from 1 to " + std::to_string(image::kLargestFace));
  }
  return static_cast<int>(size);
}

std::vector<EnvImage> images(const Json& list, std::size_t count, const char* what, const platform::ByteFile& file,
                             std::uint64_t first_byte) {
  if (!list.is_array() || list.size() != count) {
    refuse("has " + std::to_string(list.size()) + " images in \"" + what + "\"; there must be " +
           std::to_string(count));
  }
  const std::uint64_t payload = file.size() - first_byte;
  std::vector<EnvImage> found;
  for (const Json& entry : list) {
    const std::uint64_t position = whole_number(require(entry, "position"), "position");
    const std::uint64_t length = whole_number(require(entry, "length"), "length");
    if (position > payload || length > payload - position) {
      refuse("has an image of " + std::to_string(length) + " bytes at " + std::to_string(position) + " in \"" + what +
             "\", and " + std::to_string(payload) + " bytes follow it; fetch or export the file again");
    }
    found.push_back({first_byte + position, length});
  }
  return found;
}

void take_irradiance(EnvManifest& manifest, const Json& irradiance, const platform::ByteFile& file,
                     std::uint64_t first_byte) {
  if (find(irradiance, "x") != nullptr) {
    BabylonPolynomial polynomial;
    for (const Term& term : kTerms) {
      glm::dvec3& rgb = polynomial.*term.rgb;
      rgb = triple(require(irradiance, term.name), term.name);
      const double largest = std::max({std::abs(rgb.x), std::abs(rgb.y), std::abs(rgb.z)});
      if (largest > kLargestTerm) {
        refuse(std::string("has a polynomial whose \"") + term.name +
               "\" exceeds the range of floats, and its pixels end at 255; export the file again");
      }
    }
    manifest.polynomial = polynomial;
  }
  const Json* texture = find(irradiance, "irradianceTexture");
  if (texture == nullptr) return;
  manifest.irradiance_size = edge(require(*texture, "size"), "size", false);
  manifest.irradiance = images(require(*texture, "faces"), 6, "irradianceTexture", file, first_byte);
  if (const Json* direction = find(*texture, "dominantDirection")) {
    manifest.dominant_direction = triple(*direction, "dominantDirection");
  }
}

EnvManifest read_manifest(const Json& json, const platform::ByteFile& file, std::uint64_t first_byte) {
  EnvManifest manifest;
  const double version = number(require(json, "version"), "version");
  if (version > kNewestVersion) {
    throw Flaw{ErrorCode::unsupported_file,
               "is an .env of version " + require(json, "version").dump() +
                   "; versions up to 2 are supported: export it again, or use a newer Welkin"};
  }
  manifest.version = version == kNewestVersion ? 2 : 1;
  if (const Json* type = find(json, "imageType"); type != nullptr && manifest.version == 2) {
    if (!type->is_string()) refuse("has an \"imageType\" that is not a string");
    manifest.image_type = type->get<std::string>();
  }
  manifest.width = edge(require(json, "width"), "width", true);
  const Json& specular = require(json, "specular");
  const auto levels = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(manifest.width))) + 1;
  manifest.specular = images(require(specular, "mipmaps"), 6 * levels, "mipmaps", file, first_byte);
  if (const Json* scale = find(specular, "lodGenerationScale")) {
    manifest.lod_generation_scale = number(*scale, "lodGenerationScale");
    if (manifest.lod_generation_scale < 0.0) refuse("has a \"lodGenerationScale\" below 0");
  }
  if (const Json* irradiance = find(json, "irradiance")) take_irradiance(manifest, *irradiance, file, first_byte);
  return manifest;
}

/// Reads up to the zero byte.
std::string read_text(platform::ByteFile& file) {
  const auto most = static_cast<std::size_t>(std::min(file.remaining(), kLongestText + 1));
  std::string text(most, ' ');
  file.read(text.data(), text.size());
  const std::size_t end = text.find('\0');
  if (end == std::string::npos) {
    throw Flaw{most > kLongestText ? ErrorCode::limit_exceeded : ErrorCode::corrupt_file,
               "its manifest does not end within " + std::to_string(most) + " bytes; export it again"};
  }
  text.resize(end);
  return text;
}

Json parse(const std::string& text) {
  const auto not_too_deep = [](int depth, Json::parse_event_t /*event*/, Json& /*parsed*/) {
    if (depth > kDeepestNesting) refuse("is nested deeper than " + std::to_string(kDeepestNesting) + " levels");
    return true;
  };
  try {
    return Json::parse(text, not_too_deep);
  } catch (const Json::exception& failure) {
    refuse(std::string("is not JSON: ") + platform::printable(failure.what()));
  }
}

OrderedJson as_json(const glm::dvec3& value) { return OrderedJson::array({value.x, value.y, value.z}); }

OrderedJson as_json(const std::vector<EnvImage>& list) {
  OrderedJson json = OrderedJson::array();
  for (const EnvImage& image : list) json.push_back({{"length", image.length}, {"position", image.position}});
  return json;
}

}  // namespace

bool is_env(platform::ByteFile& file) { return first_bytes(file) == kSignature; }

EnvManifest read_env_manifest(platform::ByteFile& file) {
  if (!is_env(file)) {
    throw platform::file_error(ErrorCode::unsupported_file, file.path(),
                               "is not a Babylon.js .env (wrong signature); pass one, or read it as an environment");
  }
  file.seek(kSignature.size());
  try {
    const std::string text = read_text(file);
    return read_manifest(parse(text), file, kSignature.size() + text.size() + 1);
  } catch (const Flaw& flaw) {
    throw platform::file_error(flaw.code, file.path(), flaw.message);
  }
}

std::string env_manifest_bytes(const EnvManifest& manifest) {
  OrderedJson json;
  json["version"] = manifest.version;
  json["width"] = manifest.width;
  json["imageType"] = manifest.image_type;
  json["irradiance"] = nullptr;
  if (manifest.polynomial) {
    OrderedJson irradiance;
    for (const Term& term : kTerms) irradiance[term.name] = as_json((*manifest.polynomial).*term.rgb);
    if (manifest.irradiance_size > 0) {
      OrderedJson texture;
      texture["size"] = manifest.irradiance_size;
      texture["faces"] = as_json(manifest.irradiance);
      if (manifest.dominant_direction) texture["dominantDirection"] = as_json(*manifest.dominant_direction);
      irradiance["irradianceTexture"] = std::move(texture);
    }
    json["irradiance"] = std::move(irradiance);
  }
  json["specular"]["mipmaps"] = as_json(manifest.specular);
  json["specular"]["lodGenerationScale"] = manifest.lod_generation_scale;
  std::string text(kSignature);
  text += json.dump();
  text += '\0';
  return text;
}

}  // namespace welkin::files
