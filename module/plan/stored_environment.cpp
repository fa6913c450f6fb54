#include "welkin/stored_environment.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "codec/byte_file.h"
#include "codec/env_manifest.h"
#include "codec/roughness_key.h"
#include "codec/texture_layout.h"
#include "welkin/roughness.h"

namespace welkin {
namespace {

/// Mip k of an .env is for alpha = 2^(k / scale) / size, at most 1; 0 at mip 0.
std::vector<double> babylon_roughness(int levels, int size, double scale) {
  std::vector<double> roughness{0.0};
  for (int level = 1; level < levels; ++level)
    roughness.push_back(std::sqrt(std::min(1.0, std::exp2(level / scale) / size)));
  return roughness;
}

void look_into_env(StoredEnvironment& stored) {
  codec::ByteFile file(stored.path);
  const codec::EnvManifest manifest = codec::read_env_manifest(file);
  stored.has_polynomial = manifest.polynomial.has_value();
  stored.levels = manifest.levels();
  if (!(manifest.lod_generation_scale > 0.0)) {
    stored.content = LevelContent::radiance;  // what Babylon.js stores of a cubemap that was not prefiltered
    return;
  }
  stored.content = LevelContent::reflections;
  stored.roughness = babylon_roughness(stored.levels, manifest.width, manifest.lod_generation_scale);
}

/// Numbers with spaces between them, as many as there are levels, each from 0 to 1 and none below the one before.
std::vector<double> roughness_in(const std::string& text, int levels) {
  std::istringstream stream(text);
  std::vector<double> roughness;
  for (double value = 0.0; stream >> value;) roughness.push_back(value);
  const bool sound = static_cast<int>(roughness.size()) == levels && std::ranges::is_sorted(roughness) &&
                     roughness.front() >= 0.0 && roughness.back() <= 1.0;
  if (!sound) roughness.clear();
  return roughness;
}

void look_into_texture(StoredEnvironment& stored) {
  codec::ByteFile file(stored.path);
  const codec::TextureLayout layout = codec::read_texture_layout(file);
  stored.levels = static_cast<int>(layout.levels.size());
  stored.compressed = layout.supercompression != Supercompression::none;
  if (!layout.has_metadata) return;  // DDS: it cannot be told
  stored.content = LevelContent::radiance;
  for (const auto& [key, value] : layout.metadata) {
    if (!codec::speaks_of_roughness(key)) continue;
    stored.content = LevelContent::reflections;
    stored.roughness = roughness_in(value, stored.levels);
  }
}

}  // namespace

std::string StoredEnvironment::words() const {
  std::string text = path.filename().string() + ": " + info.format + ", " + shape.words();
  if (levels > 1) {
    text += ", " + std::to_string(levels) +
            (content == LevelContent::reflections ? " prefiltered mips"
             : content == LevelContent::radiance  ? " mips"
                                                  : " levels of which it does not say what they are");
  }
  return has_polynomial ? text + ", polynomial" : text;
}

StoredEnvironment probe_environment(const std::filesystem::path& path, const ReadOptions& read, LevelContent content) {
  StoredEnvironment stored;
  stored.path = path;
  stored.read = read;
  stored.info = inspect_environment(path, read);
  const EnvironmentInfo& info = stored.info;
  Environment shapes;
  shapes.info = info;
  const int face = shapes.face_size();
  stored.shape = face > 0 ? SourceShape{true, face, 6 * face, PixelFormat::rgb_f32}
                          : SourceShape{false, info.width, info.height, PixelFormat::rgb_f32};
  stored.compressed = info.format != "PFM" && info.compression != "none";
  if (info.format == "Babylon.js .env") look_into_env(stored);
  if (info.format == "KTX2" || info.format == "DDS") look_into_texture(stored);
  if (content != LevelContent::automatic && stored.levels > 1) stored.content = content;
  if (read.level != 0) {  // one of the levels alone
    stored.levels = 1;
    stored.content = LevelContent::automatic;
    stored.has_polynomial = false;
  }
  if (stored.content != LevelContent::reflections) {
    stored.roughness.clear();
  } else if (stored.roughness.empty()) {
    stored.roughness = roughness_of_mips(RoughnessSchedule::linear, stored.levels, face);
  }
  return stored;
}

}  // namespace welkin
