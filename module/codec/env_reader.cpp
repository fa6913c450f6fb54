#include "codec/env_reader.h"

#include <algorithm>
#include <array>
#include <memory>

#include "codec/env_pictures.h"
#include "jobs/tiles.h"
#include "welkin/babylon_environment.h"

namespace welkin {
namespace codec {
namespace {

constexpr std::array kFaceNames{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

std::uint64_t texels_of(int size) { return static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size); }

std::uint64_t longest(const std::vector<EnvPicture>& pictures) {
  std::uint64_t most = 0;
  for (const EnvPicture& picture : pictures) most = std::max(most, picture.length);
  return most;
}

int level_size(const EnvManifest& manifest, std::size_t picture) {
  return std::max(1, manifest.width >> static_cast<int>(picture / 6));
}

void check_memory(const std::filesystem::path& path, const EnvManifest& manifest, std::size_t workers,
                  std::uint64_t limit) {
  std::uint64_t wanted = 18 * sizeof(float) * texels_of(manifest.irradiance_size);
  for (int level = 0; level < manifest.levels(); ++level) {
    wanted += 18 * sizeof(float) * texels_of(manifest.width >> level);
  }
  const int largest = std::max(manifest.width, manifest.irradiance_size);
  const std::uint64_t picture = std::max(longest(manifest.specular), longest(manifest.irradiance));
  wanted += workers * env_reader_bytes(largest, picture);
  if (wanted <= limit) return;
  throw file_error(ErrorCode::limit_exceeded, path,
                   "its levels from " + std::to_string(manifest.width) + " texels take " + std::to_string(wanted) +
                       " bytes, above the limit of " + std::to_string(limit) + "; raise the limit");
}

void turn_rows(float* rgb, int size) {
  const std::size_t row = std::size_t{3} * static_cast<std::size_t>(size);
  for (std::size_t top = 0, bottom = static_cast<std::size_t>(size) - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(rgb + top * row, rgb + (top + 1) * row, rgb + bottom * row);
  }
}

}  // namespace

void EnvReader::read(const EnvPicture& picture, int size, const std::string& what, float* rgb) {
  bytes_.resize(picture.length);
  file_.seek(picture.position);
  file_.read(bytes_.data(), bytes_.size());
  rgba_.resize(4 * texels_of(size));
  decode_rgba(bytes_, size, file_.path(), what, rgba_.data(), stop_);
  decoder_.decode(rgba_.data(), texels_of(size), rgb);
  turn_rows(rgb, size);
}

std::uint64_t env_reader_bytes(int size, std::uint64_t picture_bytes) noexcept {
  // The bytes, the texels, and the texels once more inside libwebp (libspng holds rows), with its tables.
  constexpr std::uint64_t of_libraries = std::uint64_t{1} << 20U;
  return picture_bytes + 12 * texels_of(size) + of_libraries;
}

std::string name_of_env_picture(std::size_t index) {
  return "level " + std::to_string(index / 6) + ", face " + kFaceNames[index % 6] + ",";
}

}  // namespace codec

BabylonEnvironment read_babylon_environment(const std::filesystem::path& path, std::uint64_t memory_limit_bytes,
                                            const Control& control) {
  codec::ByteFile file(path);
  const codec::EnvManifest manifest = codec::read_env_manifest(file);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{6} * manifest.width * manifest.width);
  const std::size_t workers = jobs::worker_count(placement);
  codec::check_memory(path, manifest, workers, memory_limit_bytes);

  BabylonEnvironment environment;
  environment.version = manifest.version;
  environment.polynomial = manifest.polynomial;
  environment.lod_generation_scale = manifest.lod_generation_scale;
  environment.dominant_direction = manifest.dominant_direction;
  environment.specular = CubemapChain(manifest.width, manifest.levels());
  environment.irradiance.size = manifest.irradiance_size;
  const std::size_t face_values = 3 * codec::texels_of(manifest.irradiance_size);
  environment.irradiance.pixels.resize(6 * face_values);

  std::vector<std::unique_ptr<codec::EnvReader>> readers(workers);
  const std::size_t specular = manifest.specular.size();
  jobs::run_tiles(
      specular + manifest.irradiance.size(), placement, workers, control, [&](std::size_t tile, std::size_t worker) {
        auto& reader = readers[worker];
        if (!reader) reader = std::make_unique<codec::EnvReader>(path, control.stop);
        if (tile < specular) {
          reader->read(manifest.specular[tile], codec::level_size(manifest, tile), codec::name_of_env_picture(tile),
                       environment.specular.face(static_cast<int>(tile / 6), static_cast<int>(tile % 6)));
        } else {
          const std::size_t face = tile - specular;
          reader->read(manifest.irradiance[face], manifest.irradiance_size, "its irradiance texture",
                       environment.irradiance.pixels.data() + face * face_values);
        }
      });
  return environment;
}

}  // namespace welkin
