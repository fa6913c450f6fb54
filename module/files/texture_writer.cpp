#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/textures.h"
#include "files/write_environment.h"
#include "image/block_images.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin {
namespace files {
namespace {

constexpr std::size_t kBlockTexels = std::size_t{64} << 10U;

struct Container {
  const char* extension;
  std::uint64_t (*write)(const TextureJob&);
  bool flat;            ///< supports images as well as cubemaps
  bool packed_formats;  ///< supports b10g11r11 and e5b9g9r9
  bool supercompression;
  bool bc6h;
  bool astc;
};

constexpr std::array kContainers{Container{".ktx2", write_ktx2, true, true, true, true, true},
                                 Container{".ktx", write_ktx1, false, true, false, true, false},
                                 Container{".dds", write_dds, true, true, false, true, false},
                                 Container{".exr", write_exr_cube, false, false, false, false, false}};

const Container& container_of(const std::filesystem::path& path) {
  const Container& container =
      format_named_by(path, kContainers, " is not written as a texture", "; use .ktx2, .ktx, .dds or .exr");
  if (container.write == write_exr_cube) require_codec(Codec::exr, path, "write .ktx2 or .dds");
  return container;
}

void check_options(const std::filesystem::path& path, const Container& container, const TextureOptions& options) {
  const auto refuse = [&path](const std::string& message) {
    throw platform::file_error(ErrorCode::invalid_argument, path, message);
  };
  // A cast number may be out of range.
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

std::uint64_t TextureJob::level_bytes(std::size_t level) const noexcept {
  const LatLongView& first = levels[level].front();
  return levels[level].size() * row_byte_range(kind(), first.width, 0, first.height).bytes;
}

std::optional<BlockLevels> compressed(const TextureJob& job) {
  const TexelKind kind = job.kind();
  if (!is_compressed(kind)) return std::nullopt;
  const Control control = jobs::part_of(job.control, 0.0, 0.9);
  if (is_astc(kind)) return encode_astc(job.levels, kind, job.options.astc_effort, control);
  const auto with_blocks_of = [](auto encoded) {
    BlockLevels blocks{{}, encoded.values_clamped};
    for (auto& level : encoded.levels) blocks.levels.push_back(std::move(level.blocks));
    return blocks;
  };
  const Bc6hEffort effort = job.options.bc6h_effort;
  if (kind == TexelKind::uastc_hdr_4x4) {
    return with_blocks_of(image::encode_uastc_hdr_images(job.levels, effort, control));
  }
  return with_blocks_of(image::encode_bc6h_images(job.levels, {effort, kind == TexelKind::bc6h_sfloat}, control));
}

void TexelEncoder::encode(const LatLongView& image, int first_row, int rows, std::uint8_t* texels) {
  const auto count = static_cast<std::size_t>(image.width);
  rgb_.resize(3 * count);
  for (int row = first_row; row < first_row + rows; ++row, texels += count * texel_bytes(kind_of(format_))) {
    image::decode_texels(image.format, image::row_of(image, row), image.width, rgb_.data());
    clamped_ += image::encode_texels(format_, rgb_.data(), count, texels);
  }
}

TexelProgress::TexelProgress(const TextureJob& job) : control_(job.control) {
  for (const std::vector<LatLongView>& images : job.levels) total_ += static_cast<double>(image::texels_of(images));
}

void TexelProgress::next(std::uint64_t texels) {
  jobs::throw_if_cancelled(control_);
  if (control_.progress && done_ > 0.0) control_.progress(std::min(done_ / total_, 1.0));
  done_ += static_cast<double>(texels);
}

void write_image(const TextureJob& job, const LatLongView& image, TexelEncoder& encoder, TexelProgress& progress) {
  const auto width = static_cast<std::size_t>(image.width);
  const int block_rows = std::clamp(static_cast<int>(kBlockTexels / width), 1, image.height);
  std::vector<std::uint8_t> texels(width * static_cast<std::size_t>(block_rows) * texel_bytes(job.kind()));
  for (int row = 0; row < image.height; row += block_rows) {
    const int rows = std::min(block_rows, image.height - row);
    const std::size_t count = width * static_cast<std::size_t>(rows);
    progress.next(count);
    encoder.encode(image, row, rows, texels.data());
    job.file.write(texels.data(), count * texel_bytes(job.kind()));
  }
}

}  // namespace files

WriteReport write_texture(const FileOutput& output, std::span<const CubemapView> mips, const TextureOptions& options,
                          const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  const files::Container& container = files::container_of(output.path());
  files::check_options(output.path(), container, options);
  std::vector<std::vector<LatLongView>> levels;
  levels.reserve(mips.size());
  for (const CubemapView& view : mips) levels.push_back(image::images_of(view));
  files::OutputFiles written;
  const std::uint64_t values_clamped =
      container.write({written.add(output), std::move(levels), options, control, mips});
  return written.commit(values_clamped, control);
}

WriteReport write_texture_2d(const FileOutput& output, int width, int height, const float* rgb,
                             const TextureOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const LatLongView image{rgb, width, height, 0, PixelFormat::rgb32f};
  constexpr int largest = 16384;
  if (rgb == nullptr || width < 1 || height < 1 || width > largest || height > largest) {
    throw Error(ErrorCode::invalid_argument, "a texture of " + std::to_string(width) + " x " + std::to_string(height) +
                                                 " texels" + (rgb == nullptr ? " and no pixels" : "") +
                                                 " cannot be written; pass 1 to " + std::to_string(largest));
  }
  const files::Container& container = files::container_of(output.path());
  if (!container.flat) {
    throw platform::file_error(ErrorCode::unsupported_file, output.path(),
                               "is written as a cubemap alone; use .ktx2 or .dds, or write_environment");
  }
  files::check_options(output.path(), container, options);
  files::OutputFiles written;
  const std::uint64_t values_clamped = container.write({written.add(output), {{image}}, options, control});
  return written.commit(values_clamped, control);
}

namespace {

void check_map(const std::filesystem::path& path, const OctahedralMap& map) {
  const auto refuse = [&path](const std::string& what) {
    throw platform::file_error(ErrorCode::invalid_argument, path, what);
  };
  if (map.levels.empty()) refuse("cannot be written: the octahedral map has no levels; pass a map of to_octahedral");
  for (int level = 0; level < static_cast<int>(map.levels.size()); ++level) {
    const auto edge = static_cast<std::size_t>(std::max(0, map.level_size(level)));
    if (edge == 0 || map.levels[static_cast<std::size_t>(level)].size() != 3 * edge * edge)
      refuse("cannot be written: level " + std::to_string(level) + " of the octahedral map has " +
             std::to_string(map.levels[static_cast<std::size_t>(level)].size()) + " values instead of " +
             std::to_string(3 * edge * edge) + "; pass a map of to_octahedral");
  }
}

/// Writes "map.exr", or for several levels "map_m2.exr" and so on.
WriteReport write_images(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options,
                         const Control& control) {
  const std::filesystem::path& path = output.path();
  if (output.bytes() != nullptr && map.levels.size() > 1) {
    throw platform::file_error(
        ErrorCode::invalid_argument, path,
        "has one image, and the map has " + std::to_string(map.levels.size()) + " levels; write .ktx2, or to a path");
  }
  const SampleType type = options.format == TexelFormat::rgba32f ? SampleType::float32 : SampleType::half;
  std::uint64_t values_clamped = 0;
  files::OutputFiles written;
  for (int level = 0; level < static_cast<int>(map.levels.size()); ++level) {
    platform::WholeFile& file = written.add(
        map.levels.size() == 1 ? output : files::beside(path, "_m" + std::to_string(level), path.extension()));
    const files::OutputImage image(map.view(level));
    values_clamped += files::write_exr(image, {file, type, files::Envmap::none, {control.stop, {}}});
  }
  return written.commit(values_clamped, control);
}

}  // namespace

WriteReport write_octahedral(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options,
                             const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_map(output.path(), map);
  const files::Container& container = files::container_of(output.path());
  files::check_options(output.path(), container, options);
  if (container.write == files::write_exr_cube) return write_images(output, map, options, control);
  if (container.write != files::write_ktx2) {
    throw platform::file_error(ErrorCode::invalid_argument, output.path(),
                               "is not written as an octahedral map; use .ktx2 or .exr");
  }
  std::vector<std::vector<LatLongView>> levels(map.levels.size());
  for (std::size_t level = 0; level < levels.size(); ++level) levels[level] = {map.view(static_cast<int>(level))};
  TextureOptions with_border = options;
  with_border.metadata["welkin.octahedral_border"] = std::to_string(map.border);
  files::OutputFiles written;
  const std::uint64_t values_clamped =
      files::write_ktx2({written.add(output), std::move(levels), with_border, control});
  return written.commit(values_clamped, control);
}

}  // namespace welkin
