#include "files/env.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/layout.h"
#include "harmonics/babylon.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::files {

void EnvPictureBytes::refuse(ErrorCode code, const std::string& message) const {
  throw platform::file_error(code, path, what + " " + message);
}

void EnvPictureBytes::require_size(std::uint64_t width, std::uint64_t height) const {
  const auto wanted = static_cast<std::uint64_t>(size);
  if (width == wanted && height == wanted) return;
  refuse(ErrorCode::corrupt_file, "is " + std::to_string(width) + " x " + std::to_string(height) +
                                      " texels; its level has " + std::to_string(size) + " x " + std::to_string(size));
}

void decode_rgba(const EnvPictureBytes& picture, std::uint8_t* rgba, const stop_token& stop) {
  const std::vector<std::uint8_t>& bytes = picture.bytes;
  if (bytes.size() >= 8 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0) {
    decode_png_rgba(picture, rgba, stop);
  } else if (bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
             std::memcmp(bytes.data() + 8, "WEBP", 4) == 0) {
    decode_webp_rgba(picture, rgba);
  } else {
    picture.refuse(ErrorCode::unsupported_file, "is neither a PNG nor a WebP by its first bytes; fetch the file again");
  }
}

RgbdEncoder::RgbdEncoder() {
  for (std::size_t code = 0; code < thresholds_.size(); ++code) {
    thresholds_[code] = image::power_2_2((static_cast<double>(code) + 0.5) / 255.0);
  }
}

std::uint8_t RgbdEncoder::gamma(double value) const noexcept {
  return static_cast<std::uint8_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), value) -
                                   thresholds_.begin());
}

std::uint64_t RgbdEncoder::encode(const float* rgb, std::size_t count, std::uint8_t* rgbd) const noexcept {
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i, rgb += 3, rgbd += 4) {
    std::array<double, 3> texel{};
    for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<double>(image::bounded(rgb[c], kLargestRgbd, clamped));
    const double largest = std::max({texel[0], texel[1], texel[2], 1e-7});
    const int divisor = largest <= 1.0 ? 255 : static_cast<int>(255.0 / largest);
    for (std::size_t c = 0; c < 3; ++c) rgbd[c] = gamma(texel[c] * (divisor / 255.0));
    rgbd[3] = static_cast<std::uint8_t>(divisor);
  }
  return clamped;
}

RgbdDecoder::RgbdDecoder() {
  for (std::size_t code = 0; code < linear_.size(); ++code) {
    linear_[code] = image::power_2_2(static_cast<double>(code) / 255.0);
  }
}

void RgbdDecoder::decode(const std::uint8_t* rgbd, std::size_t count, float* rgb) const noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3, rgbd += 4) {
    const double scale = 255.0 / std::max<int>(rgbd[3], 1);
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(linear_[rgbd[c]] * scale);
  }
}

namespace {

constexpr std::array kFaceNames{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

std::uint64_t texels_of(int size) { return static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size); }

/// An upper bound on what a reader holds for pictures of that size, the libraries' memory included.
std::uint64_t env_reader_bytes(int size, std::uint64_t picture_bytes) noexcept {
  // The bytes, the texels, and the texels once more inside libwebp (libspng holds rows), with its tables.
  constexpr std::uint64_t of_libraries = std::uint64_t{1} << 20U;
  return picture_bytes + 12 * texels_of(size) + of_libraries;
}

/// "level 2, face -Y"
std::string name_of_picture(std::size_t index) {
  return "level " + std::to_string(index / 6) + ", face " + kFaceNames[index % 6] + ",";
}

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
  throw platform::file_error(ErrorCode::limit_exceeded, path,
                             "its levels from " + std::to_string(manifest.width) + " texels take " +
                                 std::to_string(wanted) + " bytes, above the limit of " + std::to_string(limit) +
                                 "; raise the limit");
}

void turn_rows(float* rgb, int size) {
  const std::size_t row = std::size_t{3} * static_cast<std::size_t>(size);
  for (std::size_t top = 0, bottom = static_cast<std::size_t>(size) - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(rgb + top * row, rgb + (top + 1) * row, rgb + bottom * row);
  }
}

/// Faces out of an .env file. Each thread has its own.
class EnvReader {
 public:
  /// `stop` is looked at while a picture is decoded.
  explicit EnvReader(const FileInput& input, stop_token stop = {}) : file_(open_file(input)), stop_(std::move(stop)) {}

  /// A picture of `size` x `size` texels to packed RGB floats, row 0 on top (they are stored bottom row first). `what`
  /// names it in messages. Throws `Error`: corrupt_file, unsupported_file, file_access, cancelled.
  void read(const EnvPicture& picture, int size, const std::string& what, float* rgb) {
    bytes_.resize(picture.length);
    file_.seek(picture.position);
    file_.read(bytes_.data(), bytes_.size());
    rgba_.resize(4 * texels_of(size));
    decode_rgba({bytes_, size, file_.path(), what}, rgba_.data(), stop_);
    decoder_.decode(rgba_.data(), texels_of(size), rgb);
    turn_rows(rgb, size);
  }

 private:
  platform::ByteFile file_;
  stop_token stop_;
  RgbdDecoder decoder_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> rgba_;
};

const glm::dmat3 kMirrorX(-1, 0, 0, 0, 1, 0, 0, 0, 1);

class EnvRowReader final : public RowReader {
 public:
  EnvRowReader(const FileInput& input, const EnvManifest& manifest, int level, int size)
      : reader_(input), manifest_(manifest), level_(level), size_(size) {}

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
    reader_.read(manifest_.specular[index], size_, name_of_picture(index), face_pixels_.data());
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
  EnvSource(EnvironmentInfo info, FileInput input, EnvManifest manifest, int level)
      : RowSource(std::move(info), std::move(input)), manifest_(std::move(manifest)), level_(level) {}

  [[nodiscard]] int natural_rows() const override { return info().width; }
  [[nodiscard]] int section_rows() const override { return info().width; }
  [[nodiscard]] bool has_prefiltered_levels() const override { return true; }
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    return rgb_bytes(info().width, info().width) + env_reader_bytes(info().width, longest(manifest_.specular));
  }
  [[nodiscard]] const char* smaller_reader() const override { return "export it again with smaller faces"; }
  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return std::make_unique<EnvRowReader>(input(), manifest_, level_, info().width);
  }
  [[nodiscard]] std::optional<SphericalHarmonics> stored_radiance() const override {
    if (!manifest_.polynomial || level_ != 0) return std::nullopt;
    return rotate(harmonics::radiance_of(*manifest_.polynomial), kMirrorX);
  }

 private:
  EnvManifest manifest_;
  int level_;
};

}  // namespace

std::unique_ptr<RowSource> open_env(platform::ByteFile& file, const ReadOptions& options) {
  EnvManifest manifest = read_env_manifest(file);
  EnvironmentInfo info;
  info.path = file.path();
  info.format = FileFormat::babylon;
  info.compression = manifest.image_type == "image/webp" ? "webp" : "deflate";
  info.storage = "version " + std::to_string(manifest.version);
  add_channels(info, "RGB", ChannelType::rgbd);
  settle_cube(info, manifest.width, manifest.levels(), options);
  info.notes.emplace_back("converted from Babylon.js's left-handed axes: x is mirrored");
  info.notes.emplace_back("RGBD ends at 255: brighter values were clamped when the file was written");
  if (manifest.polynomial) info.notes.emplace_back("stores its diffuse light as a polynomial");
  info.notes.emplace_back("levels are prefiltered for reflections; level 0 is the sharpest");
  return std::make_unique<EnvSource>(std::move(info), input_of(file), std::move(manifest), options.level);
}

}  // namespace welkin::files

namespace welkin {

BabylonEnvironment read_babylon_environment(const FileInput& input, std::uint64_t memory_limit_bytes,
                                            const Control& control) {
  const platform::FloatingPointScope floating_point;
  platform::ByteFile file = files::open_file(input);
  const files::EnvManifest manifest = files::read_env_manifest(file);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{6} * manifest.width * manifest.width);
  const std::size_t workers = jobs::worker_count(placement);
  files::check_memory(input.path(), manifest, workers, memory_limit_bytes);

  BabylonEnvironment environment;
  environment.version = manifest.version;
  environment.polynomial = manifest.polynomial;
  environment.lod_generation_scale = manifest.lod_generation_scale;
  environment.dominant_direction = manifest.dominant_direction;
  environment.specular = Cubemap(manifest.width, manifest.levels(), control.memory);
  if (manifest.irradiance_size > 0) environment.irradiance = Cubemap(manifest.irradiance_size, 1, control.memory);

  std::vector<std::unique_ptr<files::EnvReader>> readers(workers);
  const std::size_t specular = manifest.specular.size();
  jobs::run_tiles(
      specular + manifest.irradiance.size(), placement, workers, control, [&](std::size_t tile, std::size_t worker) {
        auto& reader = readers[worker];
        if (!reader) reader = std::make_unique<files::EnvReader>(input, control.stop);
        if (tile < specular) {
          reader->read(manifest.specular[tile], files::level_size(manifest, tile), files::name_of_picture(tile),
                       environment.specular.face(static_cast<int>(tile / 6), static_cast<int>(tile % 6)));
        } else {
          const std::size_t face = tile - specular;
          reader->read(manifest.irradiance[face], manifest.irradiance_size, "its irradiance texture",
                       environment.irradiance.face(static_cast<int>(face)));
        }
      });
  return environment;
}

}  // namespace welkin
