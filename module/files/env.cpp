// Babylon.js's .env files: their images, read and written.
#include "files/env.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/layout.h"
#include "files/write_environment.h"
#include "harmonics/babylon.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::files {

void EnvImageBytes::refuse(ErrorCode code, const std::string& message) const {
  throw platform::file_error(code, path, what + " " + message);
}

void EnvImageBytes::require_size(std::uint64_t width, std::uint64_t height) const {
  const auto wanted = static_cast<std::uint64_t>(size);
  if (width == wanted && height == wanted) return;
  refuse(ErrorCode::corrupt_file, "is " + std::to_string(width) + " x " + std::to_string(height) +
                                      " texels; its level has " + std::to_string(size) + " x " + std::to_string(size));
}

void decode_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop) {
  const std::vector<std::uint8_t>& bytes = image.bytes;
  if (bytes.size() >= 8 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0) {
    decode_png_rgba(image, rgba, stop);
  } else if (bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
             std::memcmp(bytes.data() + 8, "WEBP", 4) == 0) {
    decode_webp_rgba(image, rgba);
  } else {
    image.refuse(ErrorCode::unsupported_file, "is neither a PNG nor a WebP by its first bytes; fetch the file again");
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

/// Returns an upper bound on a reader's memory for images of that size, the libraries' included.
std::uint64_t env_reader_bytes(int size, std::uint64_t image_bytes) noexcept {
  // The bytes, the texels, and the texels once more inside libwebp (libspng holds rows), with its tables.
  constexpr std::uint64_t of_libraries = std::uint64_t{1} << 20U;
  return image_bytes + 12 * texels_of(size) + of_libraries;
}

/// Returns "level 2, face -Y".
std::string name_of_image(std::size_t index) {
  return "level " + std::to_string(index / 6) + ", face " + kFaceNames[index % 6] + ",";
}

std::uint64_t longest(const std::vector<EnvImage>& images) {
  std::uint64_t most = 0;
  for (const EnvImage& image : images) most = std::max(most, image.length);
  return most;
}

int level_size(const EnvManifest& manifest, std::size_t image) {
  return std::max(1, manifest.width >> static_cast<int>(image / 6));
}

void check_memory(const std::filesystem::path& path, const EnvManifest& manifest, std::size_t workers,
                  std::uint64_t limit) {
  std::uint64_t wanted = 18 * sizeof(float) * texels_of(manifest.irradiance_size);
  for (int level = 0; level < manifest.levels(); ++level) {
    wanted += 18 * sizeof(float) * texels_of(manifest.width >> level);
  }
  const int largest = std::max(manifest.width, manifest.irradiance_size);
  const std::uint64_t image = std::max(longest(manifest.specular), longest(manifest.irradiance));
  wanted += workers * env_reader_bytes(largest, image);
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

/// Reads faces of an .env file. Each thread has its own.
class EnvReader {
 public:
  /// `stop` is checked while an image is decoded.
  explicit EnvReader(const FileInput& input, stop_token stop = {}) : file_(open_file(input)), stop_(std::move(stop)) {}

  /// Decodes an image of `size` x `size` texels to packed RGB floats, row 0 on top (the bottom row is stored first).
  /// `what` names it in messages. Throws `Error`: corrupt_file, unsupported_file, file_access, cancelled.
  void read(const EnvImage& image, int size, const std::string& what, float* rgb) {
    bytes_.resize(image.length);
    file_.seek(image.position);
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

// From Welkin's axes to Babylon.js's left-handed ones and back: x changes its sign.

/// On the faces +X and -X columns run along or against z, on the others along or against x: so +X and -X are swapped,
/// and the columns of all six are reversed.
void mirror_face(const float* from, int size, float* to) {
  const std::ptrdiff_t row_floats = std::ptrdiff_t{3} * size;
  for (std::ptrdiff_t row = 0; row < size; ++row) {
    copy_segment(from + row * row_floats, to + row * row_floats, size, true);
  }
}

int mirrored_side(int side) { return side < 2 ? 1 - side : side; }

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
    const auto index = static_cast<std::size_t>(6 * level_ + mirrored_side(face));
    face_ = -1;
    face_pixels_.resize(rgb_bytes(size_, size_) / sizeof(float));
    reader_.read(manifest_.specular[index], size_, name_of_image(index), face_pixels_.data());
    face_ = face;
  }

  EnvReader reader_;
  const EnvManifest& manifest_;
  int level_;
  int size_;
  int face_ = -1;
  std::vector<float> face_pixels_;
};

/// `size`: texels along an edge of the level's faces.
RowTraits env_traits(const EnvManifest& manifest, int level, int size) {
  RowTraits traits{.natural_rows = size, .sections = 6, .prefiltered_levels = true};
  traits.reader_bytes = rgb_bytes(size, size) + env_reader_bytes(size, longest(manifest.specular));
  traits.smaller_reader = "export it again with smaller faces";
  if (manifest.polynomial && level == 0) {
    traits.stored_radiance = rotate(harmonics::radiance_of(*manifest.polynomial), kMirrorX);
  }
  return traits;
}

// Writing files: version 2, with PNG images.

/// A face to be encoded, and its outcome.
struct Image {
  CubemapView view;
  int face = 0;
  std::vector<std::uint8_t> png{};
  std::uint64_t clamped = 0;
};

void encode(Image& image, const RgbdEncoder& encoder, const stop_token& stop) {
  const auto size = static_cast<std::size_t>(image.view.size);
  std::vector<std::uint8_t> rgba(4 * size * size);
  for (std::size_t row = 0; row < size; ++row) {  // bottom row first
    jobs::throw_if_cancelled(stop);
    const auto* rgb =
        static_cast<const float*>(image::row_of(image.view, image.face, image.view.size - 1 - static_cast<int>(row)));
    image.clamped += encoder.encode(rgb, size, rgba.data() + 4 * size * row);
  }
  image.png = encode_png_rgba(rgba, image.view.size, stop);
}

void require_finite(const glm::dvec3& value, const char* what) {
  if (std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z)) return;
  throw Error(ErrorCode::invalid_argument, std::string("the .env's ") + what + " is not finite; pass finite values");
}

void check_polynomial(const BabylonPolynomial& polynomial) {
  for (const glm::dvec3& term : {polynomial.x, polynomial.y, polynomial.z, polynomial.xx, polynomial.yy, polynomial.zz,
                                 polynomial.yz, polynomial.zx, polynomial.xy}) {
    require_finite(term, "polynomial");
  }
}

void check_irradiance(const BabylonEnvironment& environment) {
  const bool has_texture = environment.irradiance.levels() != 0 || environment.dominant_direction;
  if (has_texture && !environment.polynomial) {
    throw Error(ErrorCode::invalid_argument,
                "the .env has an irradiance texture and no polynomial, which Babylon.js reads first; pass one "
                "(babylon_polynomial)");
  }
  if (environment.dominant_direction && environment.irradiance.levels() == 0) {
    throw Error(ErrorCode::invalid_argument,
                "the .env has a dominant direction and no irradiance texture; pass both, or neither");
  }
}

void check(const BabylonEnvironment& environment) {
  const Cubemap& chain = environment.specular;
  const int size = chain.size();
  if (size < 1 || !std::has_single_bit(static_cast<unsigned>(size)) || chain.levels() != full_chain_levels(size)) {
    throw Error(ErrorCode::invalid_argument, "the chain has " + std::to_string(chain.levels()) + " levels from size " +
                                                 std::to_string(size) +
                                                 "; an .env needs a power of two with all levels down to 1 texel");
  }
  if (environment.polynomial) check_polynomial(*environment.polynomial);
  if (environment.dominant_direction) require_finite(*environment.dominant_direction, "dominant direction");
  if (!std::isfinite(environment.lod_generation_scale) || environment.lod_generation_scale < 0.0) {
    throw Error(ErrorCode::invalid_argument, "the .env's lodGenerationScale is " +
                                                 platform::number_text(environment.lod_generation_scale) +
                                                 "; pass a finite value from 0 up (Babylon.js uses 0.8)");
  }
  check_irradiance(environment);
}

/// Returns the six faces of each level, encoded in parallel, in that order.
std::vector<Image> encoded(const std::vector<CubemapView>& levels, const Control& control) {
  std::vector<Image> images;
  std::int64_t texels = 0;
  for (const CubemapView& view : levels) {
    for (int face = 0; face < 6; ++face) images.push_back({view, face});
    texels = std::max(texels, std::int64_t{6} * view.size * view.size);
  }
  const RgbdEncoder encoder;
  constexpr std::int64_t as_texels = 16;  // packing one costs as much as other work on this many
  const jobs::Placement placement = jobs::placement_for(as_texels * texels);
  jobs::run_tiles(images.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) { encode(images[tile], encoder, control.stop); });
  return images;
}

std::vector<CubemapView> levels_of(const BabylonEnvironment& environment) {
  std::vector<CubemapView> levels = environment.specular.views();
  if (environment.irradiance.levels() != 0) levels.push_back(environment.irradiance.view());
  return levels;
}

EnvManifest manifest_for(const BabylonEnvironment& environment, const std::vector<Image>& images) {
  EnvManifest manifest;
  manifest.width = environment.specular.size();
  manifest.polynomial = environment.polynomial;
  manifest.lod_generation_scale = environment.lod_generation_scale;
  manifest.irradiance_size = environment.irradiance.size();
  manifest.dominant_direction = environment.dominant_direction;
  const std::size_t specular = std::size_t{6} * static_cast<std::size_t>(environment.specular.levels());
  std::uint64_t position = 0;
  for (std::size_t index = 0; index < images.size(); ++index) {
    auto& list = index < specular ? manifest.specular : manifest.irradiance;
    list.push_back({position, images[index].png.size()});
    position += images[index].png.size();
  }
  return manifest;
}

}  // namespace

std::unique_ptr<RowSource> open_env(platform::ByteFile& file, const ReadOptions& options) {
  const EnvManifest manifest = read_env_manifest(file);
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
  const auto open = [input = input_of(file), manifest, level = options.level, size = info.width] {
    return std::make_unique<EnvRowReader>(input, manifest, level, size);
  };
  RowTraits traits = env_traits(manifest, options.level, info.width);
  return std::make_unique<RowSource>(std::move(info), std::move(traits), open);
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
          reader->read(manifest.specular[tile], files::level_size(manifest, tile), files::name_of_image(tile),
                       environment.specular.face(static_cast<int>(tile / 6), static_cast<int>(tile % 6)));
        } else {
          const std::size_t face = tile - specular;
          reader->read(manifest.irradiance[face], manifest.irradiance_size, "its irradiance texture",
                       environment.irradiance.face(static_cast<int>(face)));
        }
      });
  return environment;
}

Cubemap mirrored_x(const Cubemap& cubemap) {
  if (cubemap.levels() == 0) return {};
  Cubemap mirrored(cubemap.size(), cubemap.levels(), new_delete_resource());
  for (int level = 0; level < cubemap.levels(); ++level) {
    for (int side = 0; side < 6; ++side) {
      files::mirror_face(cubemap.face(level, side), cubemap.level_size(level),
                         mirrored.face(level, files::mirrored_side(side)));
    }
  }
  return mirrored;
}

BabylonEnvironment to_babylon(const Cubemap& specular, const SphericalHarmonics& radiance,
                              const Cubemap& irradiance_over_pi) {
  const platform::FloatingPointScope floating_point;
  BabylonEnvironment environment;
  environment.specular = mirrored_x(specular);
  environment.polynomial = babylon_polynomial(rotate(radiance, convention(Engine::babylon).from_welkin));
  environment.irradiance = mirrored_x(irradiance_over_pi);
  return environment;
}

WriteReport write_babylon_environment(const FileOutput& output, const BabylonEnvironment& environment,
                                      const Control& control) {
  const platform::FloatingPointScope floating_point;
  files::check(environment);
  files::require_codec(files::Codec::png, output.path(), "write a texture (.ktx2, .dds)");
  files::OutputFiles written;
  platform::WholeFile& file = written.add(output);
  const std::vector<files::Image> images =
      files::encoded(files::levels_of(environment), jobs::part_of(control, 0.0, 0.95));

  std::uint64_t values_clamped = 0;
  const std::string manifest = files::env_manifest_bytes(files::manifest_for(environment, images));
  file.write(manifest.data(), manifest.size());
  for (const files::Image& image : images) {
    file.write(image.png.data(), image.png.size());
    values_clamped += image.clamped;
  }
  return written.commit(values_clamped, control);
}

RgbdImages rgbd_images(const Cubemap& chain, const Control& control) {
  const platform::FloatingPointScope floating_point;
  files::require_codec(files::Codec::png, "images of RGBD", "write a texture (.ktx2, .dds)");
  RgbdImages result;
  for (files::Image& image : files::encoded(chain.views(), control)) {
    result.png.push_back(std::move(image.png));
    result.values_clamped += image.clamped;
  }
  return result;
}

}  // namespace welkin
