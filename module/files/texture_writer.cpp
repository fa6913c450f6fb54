#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string>
#include <system_error>

#include "files/astc.h"
#include "files/codecs.h"
#include "files/textures.h"
#include "files/write_environment.h"
#include "image/bc6h_encoder.h"
#include "image/pixels.h"
#include "image/uastc_hdr_encoder.h"
#include "jobs/control.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/image.h"

namespace welkin {
namespace files {
namespace {

constexpr std::size_t kBlockTexels = std::size_t{64} << 10U;

std::size_t texels_of(const CubemapView& view) {
  return static_cast<std::size_t>(view.size) * static_cast<std::size_t>(view.size);
}

struct Container {
  const char* extension;
  std::uint64_t (*write)(const TextureJob&);
  std::uint64_t (*write_picture)(const PictureJob&);  ///< none: cubemaps alone
  bool packed_formats;                                ///< b10g11r11 and e5b9g9r9
  bool supercompression;
  bool bc6h;
  bool astc;
};

constexpr std::array kContainers{Container{".ktx2", write_ktx2, write_ktx2, true, true, true, true},
                                 Container{".ktx", write_ktx1, nullptr, true, false, true, false},
                                 Container{".dds", write_dds, write_dds, true, false, true, false},
                                 Container{".exr", write_exr_cube, nullptr, false, false, false, false}};

const Container& container_of(const std::filesystem::path& path) {
  std::string extension = platform::utf8(path.extension());
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Container& container : kContainers) {
    if (extension != container.extension) continue;
    if (container.write == write_exr_cube) require_codec(Codec::exr, path, "write .ktx2 or .dds");
    return container;
  }
  throw platform::file_error(
      ErrorCode::unsupported_file, path,
      (extension.empty() ? std::string("has no extension that names a format")
                         : "\"" + platform::printable(extension) + "\" is not written as a texture") +
          "; use .ktx2, .ktx, .dds or .exr");
}

void check_options(const std::filesystem::path& path, const Container& container, const TextureOptions& options) {
  const auto refuse = [&path](const std::string& message) {
    throw platform::file_error(ErrorCode::invalid_argument, path, message);
  };
  // A number from elsewhere that was cast.
  if (options.format < TexelFormat::rgba16f || options.format > TexelFormat::uastc_hdr_4x4 ||
      options.supercompression < Supercompression::none || options.supercompression > Supercompression::zstd) {
    refuse("cannot be written in an unknown format or supercompression; pass one of the enumerators");
  }
  const TexelKind kind = kind_of(options.format);
  if ((is_astc(kind) || kind == TexelKind::uastc_hdr_4x4) && !container.astc) {
    refuse("cannot hold blocks of ASTC; pass rgba16f or rgba32f, or write .ktx2");
  }
  if (is_compressed(kind) && !container.bc6h) {
    refuse("cannot hold blocks of BC6H; pass rgba16f or rgba32f, or write .ktx2, .ktx or .dds");
  }
  if (is_astc(kind)) require_codec(Codec::astc, path, "pass bc6h_ufloat or another format");
  const bool packed = options.format == TexelFormat::b10g11r11 || options.format == TexelFormat::e5b9g9r9;
  if (packed && !container.packed_formats) {
    refuse(std::string("cannot hold ") + name(kind) + "; pass rgba16f or rgba32f, or write .ktx2");
  }
  if (options.supercompression != Supercompression::none && !container.supercompression) {
    refuse("cannot be supercompressed; pass none, or write .ktx2");
  }
  if (options.supercompression != Supercompression::none) {
    require_codec(codec_of(options.supercompression), path, "leave the supercompression out");
  }
  for (const auto& [key, value] : options.metadata) {
    const bool reserved = key.starts_with("KTX") || key.starts_with("ktx");
    if (key.empty() || reserved || key.find('\0') != std::string::npos || value.find('\0') != std::string::npos) {
      refuse("its metadata has the key \"" + platform::printable(key) +
             "\"; keys and values are text without a zero byte, and a key is not empty and does not start with KTX");
    }
  }
}

}  // namespace

void check_texture_options(const std::filesystem::path& path, const TextureOptions& options) {
  check_options(path, container_of(path), options);
}

namespace {

BlockLevels in_blocks(std::span<const std::vector<LatLongView>> levels, const TextureOptions& options,
                      const Control& whole) {
  const Control control = jobs::part_of(whole, 0.0, 0.9);
  const TexelKind kind = kind_of(options.format);
  if (is_astc(kind)) return encode_astc(levels, kind, options.astc_effort, control);
  if (kind == TexelKind::uastc_hdr_4x4) {
    image::EncodedLevels encoded = image::encode_uastc_hdr_pictures(levels, options.bc6h_effort, control);
    BlockLevels blocks{{}, encoded.values_clamped};
    for (image::EncodedLevels::Level& level : encoded.levels) blocks.levels.push_back(std::move(level.blocks));
    return blocks;
  }
  image::Bc6hPictureLevels encoded =
      image::encode_bc6h_pictures(levels, {options.bc6h_effort, kind == TexelKind::bc6h_sfloat}, control);
  BlockLevels blocks{{}, encoded.values_clamped};
  blocks.levels.reserve(encoded.levels.size());
  for (image::Bc6hPictures& level : encoded.levels) blocks.levels.push_back(std::move(level.blocks));
  return blocks;
}

}  // namespace

std::optional<BlockLevels> compressed(const TextureJob& job) {
  if (!is_compressed(kind_of(job.options.format))) return std::nullopt;
  std::vector<std::vector<LatLongView>> levels;
  levels.reserve(job.mips.size());
  for (const CubemapView& view : job.mips) levels.push_back(image::pictures_of(view));
  return in_blocks(levels, job.options, job.control);
}

std::optional<BlockLevels> compressed(const PictureJob& job) {
  if (!is_compressed(kind_of(job.options.format))) return std::nullopt;
  std::vector<std::vector<LatLongView>> levels{{job.picture}};
  for (const LatLongView& level : job.smaller) levels.push_back({level});
  return in_blocks(levels, job.options, job.control);
}

void report_share(const Control& control, double done) {
  jobs::throw_if_cancelled(control);
  if (control.progress && done > 0.0) control.progress(std::min(done, 1.0));
}

void TexelEncoder::encode_row(PixelFormat format, const void* row, int width, std::uint8_t* texels) {
  const auto count = static_cast<std::size_t>(width);
  rgb_.resize(3 * count);
  image::decode_texels(format, row, width, rgb_.data());
  clamped_ += image::encode_texels(format_, rgb_.data(), count, texels);
}

void TexelEncoder::encode(const CubemapView& view, int face, int first_row, int rows, std::uint8_t* texels) {
  const std::size_t row_bytes = static_cast<std::size_t>(view.size) * texel_bytes(kind_of(format_));
  for (int row = 0; row < rows; ++row, texels += row_bytes) {
    encode_row(view.format, image::row_of(view, face, first_row + row), view.size, texels);
  }
}

void TexelEncoder::encode(const LatLongView& picture, int first_row, int rows, std::uint8_t* texels) {
  const std::size_t row_bytes = static_cast<std::size_t>(picture.width) * texel_bytes(kind_of(format_));
  for (int row = 0; row < rows; ++row, texels += row_bytes) {
    encode_row(picture.format, image::row_of(picture, first_row + row), picture.width, texels);
  }
}

TexelProgress::TexelProgress(std::span<const CubemapView> mips, const Control& control) : control_(control) {
  for (const CubemapView& view : mips) total_ += 6.0 * static_cast<double>(texels_of(view));
}

void TexelProgress::next(std::uint64_t texels) {
  report_share(control_, done_ / total_);
  done_ += static_cast<double>(texels);
}

void write_face(platform::WholeFile& file, const CubemapView& view, int face, TexelFormat format, TexelEncoder& encoder,
                TexelProgress& progress) {
  const auto size = static_cast<std::size_t>(view.size);
  const int block_rows = static_cast<int>(std::clamp<std::size_t>(kBlockTexels / size, 1, size));
  std::vector<std::uint8_t> texels(size * static_cast<std::size_t>(block_rows) * texel_bytes(kind_of(format)));
  for (int row = 0; row < view.size; row += block_rows) {
    const int rows = std::min(block_rows, view.size - row);
    const std::size_t count = size * static_cast<std::size_t>(rows);
    progress.next(count);
    encoder.encode(view, face, row, rows, texels.data());
    file.write(texels.data(), count * texel_bytes(kind_of(format)));
  }
}

void write_picture(const PictureJob& job, TexelEncoder& encoder) {
  const LatLongView& picture = job.picture;
  std::vector<std::uint8_t> texels(static_cast<std::size_t>(picture.width) * texel_bytes(kind_of(job.options.format)));
  for (int row = 0; row < picture.height; ++row) {
    report_share(job.control, static_cast<double>(row) / picture.height);
    encoder.encode(picture, row, 1, texels.data());
    job.file.write(texels.data(), texels.size());
  }
}

}  // namespace files

WriteReport write_texture(const FileOutput& output, std::span<const CubemapView> mips, const TextureOptions& options,
                          const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  const files::Container& container = files::container_of(output.path());
  files::check_options(output.path(), container, options);
  platform::WholeFile file(output.path(), output.bytes());
  const std::uint64_t values_clamped = container.write({file, mips, options, control});
  file.finish();
  return files::commit_files({&file}, values_clamped, control);
}

WriteReport write_texture_2d(const FileOutput& output, int width, int height, const float* rgb,
                             const TextureOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const LatLongView picture{rgb, width, height, 0, PixelFormat::rgb32f};
  constexpr int largest = 16384;
  if (rgb == nullptr || width < 1 || height < 1 || width > largest || height > largest) {
    throw Error(ErrorCode::invalid_argument, "a texture of " + std::to_string(width) + " x " + std::to_string(height) +
                                                 " texels" + (rgb == nullptr ? " and no pixels" : "") +
                                                 " cannot be written; pass 1 to " + std::to_string(largest));
  }
  const files::Container& container = files::container_of(output.path());
  if (container.write_picture == nullptr) {
    throw platform::file_error(ErrorCode::unsupported_file, output.path(),
                               "is written as a cubemap alone; use .ktx2 or .dds, or write_environment");
  }
  files::check_options(output.path(), container, options);
  platform::WholeFile file(output.path(), output.bytes());
  const std::uint64_t values_clamped = container.write_picture({file, picture, options, control});
  file.finish();
  return files::commit_files({&file}, values_clamped, control);
}

}  // namespace welkin
