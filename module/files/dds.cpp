// The header of a DDS file.
#include <algorithm>
#include <array>

#include "files/textures.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

[[noreturn]] void refuse(const platform::ByteFile& file, ErrorCode code, const std::string& message) {
  throw platform::file_error(code, file.path(), message);
}

/// Header fields by their number from the magic number on.
class Fields {
 public:
  explicit Fields(platform::ByteFile& file) { file.read(bytes_.data(), bytes_.size()); }
  [[nodiscard]] std::uint32_t operator[](std::size_t index) const {
    return platform::read_little_endian<std::uint32_t>(bytes_.data() + 4 * index);
  }

 private:
  std::array<std::uint8_t, kDdsFirstTexel> bytes_{};
};

constexpr std::size_t kHeaderSize = 1, kHeight = 3, kWidth = 4, kLevels = 7, kPixelFormatSize = 19,
                      kPixelFormatFlags = 20, kFourCc = 21, kFormat = 32, kDimension = 33, kMiscellaneous = 34,
                      kArraySize = 35;

void check_kind(const platform::ByteFile& file, const Fields& fields) {
  if (fields[kHeaderSize] != kDdsHeaderBytes || fields[kPixelFormatSize] != kDdsPixelFormatBytes) {
    refuse(file, ErrorCode::corrupt_file, "its DDS header states wrong sizes");
  }
  if ((fields[kPixelFormatFlags] & kDdsHasFourCc) == 0 || fields[kFourCc] != kFourCcDx10) {
    refuse(file, ErrorCode::unsupported_file, "has no DX10 header; save it with one (texconv -dx10)");
  }
  if (!kind_with(&KindTraits::dxgi, fields[kFormat])) {
    refuse(file, ErrorCode::unsupported_file,
           "its DXGI_FORMAT " + std::to_string(fields[kFormat]) +
               " is not read; R16G16B16A16_FLOAT, R32G32B32A32_FLOAT, R11G11B10_FLOAT, R9G9B9E5_SHAREDEXP, BC6H_UF16, "
               "BC6H_SF16 and R8G8B8A8_UNORM (and _SRGB) are");
  }
  if (fields[kDimension] != kDdsTexture2d) {
    refuse(file, ErrorCode::unsupported_file, "is a 1D or 3D texture; pass a cubemap or a 2D texture");
  }
}

}  // namespace

TextureLayout read_dds_layout(platform::ByteFile& file, int element) {
  const Fields fields(file);
  check_kind(file, fields);
  const std::uint32_t levels = std::max(fields[kLevels], 1U);  // some writers forget the flag that says it is counted
  const bool cube = (fields[kMiscellaneous] & kDdsTextureCube) != 0;
  TextureLayout layout;
  layout.container = FileFormat::dds;
  layout.kind = *kind_with(&KindTraits::dxgi, fields[kFormat]);
  settle_texture(file, layout, fields[kWidth], fields[kHeight], levels, cube ? 6 : 1, fields[kArraySize], element);
  layout.levels.resize(levels);
  std::uint64_t chain = 0;  // of a face
  for (std::uint32_t level = 0; level < levels; ++level) chain += layout.face_bytes(static_cast<int>(level));
  const auto faces = static_cast<std::size_t>(layout.faces());
  std::uint64_t slot = kDdsFirstTexel + chain * faces * static_cast<std::uint64_t>(element);
  for (std::size_t face = 0; face < faces; ++face) {
    for (std::uint32_t level = 0; level < levels; ++level) {
      layout.levels[level].faces[face] = slot;
      slot += layout.face_bytes(static_cast<int>(level));
    }
  }
  slot += chain * faces * static_cast<std::uint64_t>(layout.elements - 1 - element);
  if (slot > file.size()) {
    refuse(file, ErrorCode::corrupt_file,
           "ends too early: its levels end at " + std::to_string(slot) + ", the file has " +
               std::to_string(file.size()) + " bytes; fetch or export it again");
  }
  return layout;
}

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
  const bool blocks = is_compressed(kind);
  // Of a row; of blocks those of a whole face of level 0.
  const auto row_bytes =
      static_cast<std::uint32_t>(row_byte_range(kind, shape.width, 0, blocks ? shape.height : 1).bytes);
  const std::uint32_t flags =
      kDdsCaps | kDdsHeight | kDdsWidth | (blocks ? kDdsLinearSize : kDdsPitch) | kDdsPixelFormat | kDdsMipMapCount;
  constexpr std::uint32_t one_texture = 1, alpha_unknown = 0;
  const std::uint32_t several = shape.cube ? kDdsComplex : 0;
  std::vector<std::uint8_t> bytes;
  const auto append = [&bytes](std::initializer_list<std::uint32_t> fields) {
    for (const std::uint32_t field : fields) platform::append_little_endian(bytes, field);
  };
  append({kDdsMagic, kDdsHeaderBytes, flags, height, width, row_bytes, 0, levels});
  append({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});                                  // reserved
  append({kDdsPixelFormatBytes, kDdsHasFourCc, kFourCcDx10, 0, 0, 0, 0, 0});  // the pixel format is below
  append({kDdsTexture | several | (levels > 1 ? kDdsMipMap : 0), shape.cube ? kDdsCubemap | kDdsAllFaces : 0, 0, 0, 0});
  append({traits(kind).dxgi, kDdsTexture2d, shape.cube ? kDdsTextureCube : 0, one_texture, alpha_unknown});
  return bytes;
}

}  // namespace

std::uint64_t write_dds(const TextureJob& job) {
  const int size = job.mips.front().size;
  const auto header = header_bytes({size, size, job.mips.size(), true}, kind_of(job.options.format));
  job.file.write(header.data(), header.size());
  if (const std::optional<BlockLevels> blocks = compressed(job)) {
    for (std::size_t face = 0; face < 6; ++face) {
      for (const std::vector<std::uint8_t>& level : blocks->levels) {
        const std::size_t bytes = level.size() / 6;
        job.file.write(level.data() + face * bytes, bytes);
      }
    }
    return blocks->values_clamped;
  }
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
  if (const std::optional<BlockLevels> blocks = compressed(job)) {
    job.file.write(blocks->levels.front().data(), blocks->levels.front().size());
    return blocks->values_clamped;
  }
  TexelEncoder encoder(job.options.format);
  write_picture(job, encoder);
  return encoder.clamped();
}

}  // namespace welkin::files
