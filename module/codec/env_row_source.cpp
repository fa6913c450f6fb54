#include "codec/env_row_source.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "codec/cube_levels.h"
#include "codec/env_reader.h"
#include "codec/face_placement.h"
#include "sh/babylon_radiance.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::codec {
namespace {

const glm::dmat3 kMirrorX(-1, 0, 0, 0, 1, 0, 0, 0, 1);

class EnvRowReader final : public RowReader {
 public:
  EnvRowReader(const std::filesystem::path& path, const EnvManifest& manifest, int level, int size)
      : reader_(path), manifest_(manifest), level_(level), size_(size) {}

  void read(int first_row, int row_count, float* rgb) override {
    const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(size_);
    for (int row = first_row; row < first_row + row_count; ++row, rgb += row_floats) {
      if (row / size_ != face_) decode(row / size_);
      copy_segment(face_pixels_.data() + row_floats * static_cast<std::size_t>(row % size_), rgb, size_, true);
    }
  }

 private:
  void decode(int face) {
    const int stored = face < 2 ? 1 - face : face;  // +X and -X change places
    const auto index = static_cast<std::size_t>(6 * level_ + stored);
    face_ = -1;
    face_pixels_.resize(rgb_bytes(size_, size_) / sizeof(float));
    reader_.read(manifest_.specular[index], size_, name_of_env_picture(index), face_pixels_.data());
    face_ = face;
  }

  EnvReader reader_;
  const EnvManifest& manifest_;
  int level_;
  int size_;
  int face_ = -1;
  std::vector<float> face_pixels_;
};

class EnvSource final : public RowSource {
 public:
  EnvSource(EnvironmentInfo info, EnvManifest manifest, int level)
      : RowSource(std::move(info)), manifest_(std::move(manifest)), level_(level) {}

  [[nodiscard]] int natural_rows() const override { return info().width; }
  [[nodiscard]] int section_rows() const override { return info().width; }
  [[nodiscard]] bool has_prefiltered_levels() const override { return true; }
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    std::uint64_t longest = 0;
    for (const EnvPicture& picture : manifest_.specular) longest = std::max(longest, picture.length);
    return rgb_bytes(info().width, info().width) + env_reader_bytes(info().width, longest);
  }
  [[nodiscard]] const char* smaller_reader() const override { return "make it anew with smaller faces"; }
  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return std::make_unique<EnvRowReader>(info().path, manifest_, level_, info().width);
  }
  [[nodiscard]] std::optional<SphericalHarmonics> stored_radiance() const override {
    if (!manifest_.polynomial || level_ != 0) return std::nullopt;
    return transform(sh::radiance_of(*manifest_.polynomial), kMirrorX);
  }

 private:
  EnvManifest manifest_;
  int level_;
};

}  // namespace

std::unique_ptr<RowSource> open_env(ByteFile& file, const ReadOptions& options) {
  EnvManifest manifest = read_env_manifest(file);
  EnvironmentInfo info;
  info.path = file.path();
  info.format = "Babylon.js .env";
  info.compression = manifest.image_type == "image/webp" ? "webp" : "deflate";
  info.storage = "version " + std::to_string(manifest.version);
  for (const char* channel : {"R", "G", "B"}) info.channels.push_back({channel, "rgbd"});
  settle_cube(info, manifest.width, manifest.levels(), options);
  info.notes.emplace_back("x is mirrored on the way in: Babylon.js's axes are left-handed");
  info.notes.emplace_back("RGBD ends at 255: what was brighter was clipped when the file was made");
  if (manifest.polynomial) info.notes.emplace_back("it stores a polynomial of its diffuse light");
  info.notes.emplace_back("its levels are prefiltered for reflections: level 0 is the sharp one");
  return std::make_unique<EnvSource>(std::move(info), std::move(manifest), options.level);
}

}  // namespace welkin::codec
