// The header of a DDS file.
#include <algorithm>
#include <array>

#include "files/textures.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

/// Header fields, indexed from the magic number on.
using Fields = std::array<std::uint32_t, kDdsFirstTexel / 4>;

constexpr std::size_t kHeaderSize = 1, kHeight = 3, kWidth = 4, kLevels = 7, kPixelFormatSize = 19,
                      kPixelFormatFlags = 20, kFourCc = 21, kFormat = 32, kDimension = 33, kMiscellaneous = 34,
                      kArraySize = 35;

void check_kind(const platform::ByteFile& file, const Fields& fields) {
  if (fields[kHeaderSize] != kDdsHeaderBytes || fields[kPixelFormatSize] != kDdsPixelFormatBytes) {
    refuse_texture(file, ErrorCode::corrupt_file, "its DDS header states wrong sizes");
  }
  if ((fields[kPixelFormatFlags] & kDdsHasFourCc) == 0 || fields[kFourCc] != kFourCcDx10) {
    refuse_texture(file, ErrorCode::unsupported_file, "has no DX10 header; save it with one (texconv -dx10)");
  }
  if (!kind_with(&KindTraits::dxgi, fields[kFormat])) {
    refuse_texture(
        file, ErrorCode::unsupported_file,
        "its DXGI_FORMAT " + std::to_string(fields[kFormat]) +
            " is not read; R16G16B16A16_FLOAT, R32G32B32A32_FLOAT, R11G11B10_FLOAT, R9G9B9E5_SHAREDEXP, BC6H_UF16, "
            "BC6H_SF16 and R8G8B8A8_UNORM (and _SRGB) are");
  }
  if (fields[kDimension] != kDdsTexture2d) {
    refuse_texture(file, ErrorCode::unsupported_file, "is a 1D or 3D texture; pass a cubemap or a 2D texture");
  }
}

}  // namespace

TextureLayout read_dds_layout(platform::ByteFile& file, int element) {
  Fields fields{};
  file.read(fields.data(), kDdsFirstTexel);
  check_kind(file, fields);
  const std::uint32_t levels = std::max(fields[kLevels], 1U);  // some writers forget the flag for a mip count
  const bool cube = (fields[kMiscellaneous] & kDdsTextureCube) != 0;
  TextureLayout layout;
  layout.container = FileFormat::dds;
  layout.kind = *kind_with(&KindTraits::dxgi, fields[kFormat]);
  settle_texture(file, layout, fields[kWidth], fields[kHeight], levels, cube ? 6 : 1, fields[kArraySize], element);
  std::uint64_t chain = 0;  // bytes per face
  for (std::uint32_t level = 0; level < levels; ++level) chain += layout.face_bytes(static_cast<int>(level));
  const std::uint64_t element_bytes = chain * static_cast<std::uint64_t>(layout.faces());
  std::uint64_t slot = kDdsFirstTexel + element_bytes * static_cast<std::uint64_t>(element);
  for (std::uint32_t level = 0; level < levels; ++level) {
    layout.levels.push_back({slot, chain});
    slot += layout.face_bytes(static_cast<int>(level));
  }
  const std::uint64_t end = kDdsFirstTexel + element_bytes * static_cast<std::uint64_t>(layout.elements);
  if (end > file.size()) {
    refuse_texture(file, ErrorCode::corrupt_file,
                   "ends too early: its levels end at " + std::to_string(end) + ", the file has " +
                       std::to_string(file.size()) + " bytes; fetch or export it again");
  }
  return layout;
}

namespace {

std::vector<std::uint32_t> header_of(const TextureJob& job) {
  const TexelKind kind = job.kind();
  const LatLongView& first = job.levels.front().front();
  const auto width = static_cast<std::uint32_t>(first.width);
  const auto height = static_cast<std::uint32_t>(first.height);
  const auto levels = static_cast<std::uint32_t>(job.levels.size());
  const bool cube = job.faces() == 6;
  const bool blocks = is_compressed(kind);
  // For texels the bytes of a row; for blocks those of a whole face of level 0.
  const auto row_bytes =
      static_cast<std::uint32_t>(row_byte_range(kind, first.width, 0, blocks ? first.height : 1).bytes);
  const std::uint32_t flags =
      kDdsCaps | kDdsHeight | kDdsWidth | (blocks ? kDdsLinearSize : kDdsPitch) | kDdsPixelFormat | kDdsMipMapCount;
  constexpr std::uint32_t one_texture = 1, alpha_unknown = 0;
  const std::uint32_t several = cube ? kDdsComplex : 0;
  std::vector<std::uint32_t> fields{kDdsMagic, kDdsHeaderBytes, flags, height, width, row_bytes, 0, levels};
  fields.insert(fields.end(), 11, 0);  // reserved
  for (const std::uint32_t field :
       {kDdsPixelFormatBytes, kDdsHasFourCc, kFourCcDx10, 0U, 0U, 0U, 0U, 0U,  // the pixel format follows
        kDdsTexture | several | (levels > 1 ? kDdsMipMap : 0U), cube ? kDdsCubemap | kDdsAllFaces : 0U, 0U, 0U, 0U,
        traits(kind).dxgi, kDdsTexture2d, cube ? kDdsTextureCube : 0U, one_texture, alpha_unknown}) {
    fields.push_back(field);
  }
  return fields;
}

}  // namespace

std::uint64_t write_dds(const TextureJob& job) {
  const std::vector<std::uint32_t> header = header_of(job);
  job.file.write(header.data(), header.size() * sizeof(std::uint32_t));
  const std::optional<BlockLevels> blocks = compressed(job);
  TexelEncoder encoder(job.options.format);
  TexelProgress progress(job);
  for (std::size_t face = 0; face < job.faces(); ++face) {
    for (std::size_t level = 0; level < job.levels.size(); ++level) {
      if (blocks) {
        const std::size_t bytes = blocks->levels[level].size() / job.faces();
        job.file.write(blocks->levels[level].data() + face * bytes, bytes);
      } else {
        write_image(job, job.levels[level][face], encoder, progress);
      }
    }
  }
  return (blocks ? blocks->values_clamped : 0) + encoder.clamped();
}

}  // namespace welkin::files
