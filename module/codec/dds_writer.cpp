// DDS: see dds_format.h.
#include <array>

#include "codec/dds_format.h"
#include "codec/little_endian.h"
#include "codec/texture_writer.h"

namespace welkin::codec {
namespace {

struct Shape {
  int width;
  int height;
  std::size_t levels;
  bool cube;
};

std::vector<std::uint8_t> header_bytes(const Shape& shape, TexelKind kind) {
  const auto width = static_cast<std::uint32_t>(shape.width);
  const auto height = static_cast<std::uint32_t>(shape.height);
  const auto levels = static_cast<std::uint32_t>(shape.levels);
  const auto row_bytes = static_cast<std::uint32_t>(width * texel_bytes(kind));
  constexpr std::uint32_t flags = kDdsCaps | kDdsHeight | kDdsWidth | kDdsPitch | kDdsPixelFormat | kDdsMipMapCount;
  constexpr std::uint32_t one_texture = 1, alpha_unknown = 0;
  const std::uint32_t several = shape.cube ? kDdsComplex : 0;
  std::vector<std::uint8_t> bytes;
  const auto append = [&bytes](std::initializer_list<std::uint32_t> fields) {
    for (const std::uint32_t field : fields) append_little_endian(bytes, field);
  };
  append({kDdsMagic, kDdsHeaderBytes, flags, height, width, row_bytes, 0, levels});
  append({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});                                  // reserved
  append({kDdsPixelFormatBytes, kDdsHasFourCc, kFourCcDx10, 0, 0, 0, 0, 0});  // the pixel format is below
  append({kDdsTexture | several | (levels > 1 ? kDdsMipMap : 0), shape.cube ? kDdsCubemap | kDdsAllFaces : 0, 0, 0, 0});
  append({dxgi_format(kind), kDdsTexture2d, shape.cube ? kDdsTextureCube : 0, one_texture, alpha_unknown});
  return bytes;
}

}  // namespace

std::uint64_t write_dds(const TextureJob& job) {
  const int size = job.mips.front().size;
  const auto header = header_bytes({size, size, job.mips.size(), true}, kind_of(job.options.format));
  job.file.write(header.data(), header.size());
  TexelEncoder encoder(job.options.format);
  TexelProgress progress(job.mips, job.control);
  for (int face = 0; face < 6; ++face) {
    for (const CubemapView& view : job.mips) {
      write_face(job.file, view, face, job.options.format, encoder, progress);
    }
  }
  return encoder.clamped();
}

std::uint64_t write_dds(const PictureJob& job) {
  const auto header = header_bytes({job.picture.width, job.picture.height, 1, false}, kind_of(job.options.format));
  job.file.write(header.data(), header.size());
  TexelEncoder encoder(job.options.format);
  write_picture(job, encoder);
  return encoder.clamped();
}

}  // namespace welkin::codec
