// The header of a DDS file.
#include <algorithm>
#include <array>

#include "codec/dds_format.h"
#include "codec/little_endian.h"
#include "codec/texture_layout.h"

namespace welkin::codec {
namespace {

struct DxgiFormat {
  TexelKind kind;
  std::uint32_t number;
};

constexpr std::array kDxgiFormats{
    DxgiFormat{TexelKind::rgba32f, 2},      // DXGI_FORMAT_R32G32B32A32_FLOAT
    DxgiFormat{TexelKind::rgba16f, 10},     // DXGI_FORMAT_R16G16B16A16_FLOAT
    DxgiFormat{TexelKind::b10g11r11, 26},   // DXGI_FORMAT_R11G11B10_FLOAT
    DxgiFormat{TexelKind::rgba8, 28},       // DXGI_FORMAT_R8G8B8A8_UNORM
    DxgiFormat{TexelKind::rgba8_srgb, 29},  // DXGI_FORMAT_R8G8B8A8_UNORM_SRGB
    DxgiFormat{TexelKind::e5b9g9r9, 67},    // DXGI_FORMAT_R9G9B9E5_SHAREDEXP
};

[[noreturn]] void refuse(const ByteFile& file, ErrorCode code, const std::string& message) {
  throw file_error(code, file.path(), message);
}

/// Header fields by their number from the magic number on.
class Fields {
 public:
  explicit Fields(ByteFile& file) { file.read(bytes_.data(), bytes_.size()); }
  [[nodiscard]] std::uint32_t operator[](std::size_t index) const {
    return read_little_endian<std::uint32_t>(bytes_.data() + 4 * index);
  }

 private:
  std::array<std::uint8_t, kDdsFirstTexel> bytes_{};
};

constexpr std::size_t kHeaderSize = 1, kHeight = 3, kWidth = 4, kLevels = 7, kPixelFormatSize = 19,
                      kPixelFormatFlags = 20, kFourCc = 21, kFormat = 32, kDimension = 33, kMiscellaneous = 34,
                      kArraySize = 35;

void check_kind(const ByteFile& file, const Fields& fields) {
  if (fields[kHeaderSize] != kDdsHeaderBytes || fields[kPixelFormatSize] != kDdsPixelFormatBytes) {
    refuse(file, ErrorCode::corrupt_file, "its DDS header has not the sizes that it must have");
  }
  if ((fields[kPixelFormatFlags] & kDdsHasFourCc) == 0 || fields[kFourCc] != kFourCcDx10) {
    refuse(file, ErrorCode::unsupported_file, "has no DX10 header; save it with one (texconv -dx10)");
  }
  if (!kind_of_dxgi_format(fields[kFormat])) {
    refuse(file, ErrorCode::unsupported_file,
           "its DXGI_FORMAT " + std::to_string(fields[kFormat]) +
               " is not read; R16G16B16A16_FLOAT, R32G32B32A32_FLOAT, R11G11B10_FLOAT, R9G9B9E5_SHAREDEXP and "
               "R8G8B8A8_UNORM (and _SRGB) are");
  }
  if (fields[kDimension] != kDdsTexture2d || (fields[kMiscellaneous] & kDdsTextureCube) == 0) {
    refuse(file, ErrorCode::unsupported_file, "is no cubemap; cubemaps, with six faces, are read");
  }
  if (fields[kArraySize] != 1) {
    refuse(file, ErrorCode::unsupported_file,
           "is an array of " + std::to_string(fields[kArraySize]) + " cubemaps; save one alone");
  }
}

}  // namespace

std::uint32_t dxgi_format(TexelKind kind) noexcept {
  const auto* found =
      std::find_if(kDxgiFormats.begin(), kDxgiFormats.end(), [kind](const auto& f) { return f.kind == kind; });
  return found->number;
}

std::optional<TexelKind> kind_of_dxgi_format(std::uint32_t format) noexcept {
  for (const DxgiFormat& known : kDxgiFormats) {
    if (known.number == format) return known.kind;
  }
  return std::nullopt;
}

TextureLayout read_dds_layout(ByteFile& file) {
  const Fields fields(file);
  check_kind(file, fields);
  const std::uint32_t levels = std::max(fields[kLevels], 1U);  // some writers forget the flag that says it is counted
  check_cubemap_sizes(file, fields[kWidth], fields[kHeight], levels);

  TextureLayout layout;
  layout.container = "DDS";
  layout.kind = *kind_of_dxgi_format(fields[kFormat]);
  layout.size = static_cast<int>(fields[kWidth]);
  layout.levels.resize(levels);
  std::uint64_t place = kDdsFirstTexel;
  for (std::size_t face = 0; face < 6; ++face) {
    for (std::uint32_t level = 0; level < levels; ++level) {
      layout.levels[level].faces[face] = place;
      place += level_bytes(layout.kind, layout.level_size(static_cast<int>(level))) / 6;
    }
  }
  if (place > file.size()) {
    refuse(file, ErrorCode::corrupt_file,
           "ends too early: its levels end at " + std::to_string(place) + ", the file has " +
               std::to_string(file.size()) + " bytes; fetch or export it again");
  }
  return layout;
}

}  // namespace welkin::codec
