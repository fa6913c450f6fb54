// A KTX file of the first version (Khronos, "KTX File Format Specification", version 1.0), which Filament loads.
//
//   identifier, header, key/value data, then level after level from the largest: its byte count, and its texels
//   (for a cubemap that is not an array, the count is a face's)
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "files/textures.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

constexpr std::array<std::uint8_t, 12> kIdentifier{0xAB, 0x4B, 0x54, 0x58, 0x20, 0x31,
                                                   0x31, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
constexpr std::size_t kHeaderBytes = 64;
constexpr std::uint32_t kOwnOrder = 0x04030201;

// GL's numbers of types, formats and internal formats.
constexpr std::uint32_t kUnsignedByte = 0x1401, kFloat = 0x1406, kHalf = 0x140B;
constexpr std::uint32_t kPackedFloats = 0x8C3B, kSharedExponent = 0x8C3E;
constexpr std::uint32_t kRgb = 0x1907, kRgba = 0x1908;
constexpr std::uint32_t kRgba16f = 0x881A, kRgba32f = 0x8814;
constexpr std::uint32_t kR11G11B10 = 0x8C3A, kRgb9E5 = 0x8C3D, kSrgb8Alpha8 = 0x8C43;
constexpr std::uint32_t kBc6hSigned = 0x8E8E, kBc6hUnsigned = 0x8E8F;

struct Header {
  std::uint32_t order, type, type_size, format, internal_format, base_format;
  std::uint32_t width, height, depth, elements, faces, levels, metadata_bytes;
};

Header read_header(platform::ByteFile& file) {
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  file.read(bytes.data(), bytes.size());
  if (std::memcmp(bytes.data(), kIdentifier.data(), kIdentifier.size()) != 0)
    refuse_texture(file, ErrorCode::corrupt_file, "has an invalid KTX header; fetch or export it again");
  Header header{};
  std::memcpy(&header, bytes.data() + kIdentifier.size(), sizeof header);
  return header;
}

/// Returns the kind of texels: type and format decide it, for blocks the internal format. (Filament writes the internal
/// format as type, too.)
std::optional<TexelKind> kind_of(const Header& header) {
  switch (header.type) {
    case 0:
      if (header.internal_format == kBc6hUnsigned) return TexelKind::bc6h_ufloat;
      if (header.internal_format == kBc6hSigned) return TexelKind::bc6h_sfloat;
      return std::nullopt;
    case kPackedFloats:
    case kR11G11B10: return TexelKind::b10g11r11;
    case kSharedExponent:
    case kRgb9E5: return TexelKind::e5b9g9r9;
    case kFloat:
      if (header.format == kRgba) return TexelKind::rgba32f;
      if (header.format == kRgb) return TexelKind::rgb32f;
      return std::nullopt;
    case kHalf: return header.format == kRgba ? std::optional(TexelKind::rgba16f) : std::nullopt;
    case kUnsignedByte:
      if (header.format != kRgba) return std::nullopt;
      return header.internal_format == kSrgb8Alpha8 ? TexelKind::rgba8_srgb : TexelKind::rgba8;
    default: return std::nullopt;
  }
}

void check_kind(const platform::ByteFile& file, const Header& header) {
  if (header.order != kOwnOrder)
    refuse_texture(file, ErrorCode::unsupported_file, "is a big-endian KTX file; convert it (ktx2ktx2)");
  if (header.depth > 1)
    refuse_texture(file, ErrorCode::unsupported_file, "is a 3D texture; pass a cubemap or a 2D texture");
  if (!kind_of(header)) {
    refuse_texture(
        file, ErrorCode::unsupported_file,
        "its glType " + std::to_string(header.type) + ", glFormat " + std::to_string(header.format) +
            " and glInternalFormat " + std::to_string(header.internal_format) +
            " are not read; half floats and floats of RGBA, floats of RGB, R11F_G11F_B10F, RGB9_E5, RGBA8 (and "
            "SRGB) and "
            "BC6H are");
  }
}

}  // namespace

TextureLayout read_ktx1_layout(platform::ByteFile& file, int element) {
  const Header header = read_header(file);
  check_kind(file, header);
  TextureLayout layout;
  layout.container = FileFormat::ktx1;
  layout.kind = *kind_of(header);
  const std::uint32_t levels = std::max(header.levels, 1U);
  settle_texture(file, layout, header.width, header.height, levels, header.faces, header.elements, element);
  layout.has_metadata = true;
  layout.metadata = read_key_values(file, kHeaderBytes, header.metadata_bytes);
  const bool counts_a_face = header.elements == 0 && layout.faces() == 6;
  std::uint64_t slot = kHeaderBytes + header.metadata_bytes;
  for (std::uint32_t number = 0; number < levels; ++number) {
    const auto level = static_cast<int>(number);
    const std::uint64_t whole = layout.whole_bytes(level);
    const std::uint64_t wanted = counts_a_face ? layout.face_bytes(level) : whole;
    require_inside(file, "level " + std::to_string(level), slot + 4, whole);
    std::uint32_t stated = 0;
    file.seek(slot);
    file.read(&stated, sizeof stated);
    if (stated != wanted) {
      refuse_texture(file, ErrorCode::corrupt_file,
                     "its level " + std::to_string(level) + " states " + std::to_string(stated) + " bytes instead of " +
                         std::to_string(wanted));
    }
    slot += 4;
    layout.levels.push_back({slot + layout.first_byte_of(level, 0), layout.face_bytes(level)});
    slot += whole;  // all kinds have rows of a multiple of four bytes: there is no padding
  }
  return layout;
}

namespace {

/// The header's fields about texels.
struct GlFormat {
  std::uint32_t type, type_size, format, internal_format, base_format;
};

/// Returns the format as in OpenGL's tables, except that the type and base format of R11F_G11F_B10F are the internal
/// format: Filament's cmgen writes it so (1.9.25; before 1.8 the format too), and Filament loads no other type.
GlFormat gl_format(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba16f: return {kHalf, 2, kRgba, kRgba16f, kRgba};
    case TexelFormat::rgba32f: return {kFloat, 4, kRgba, kRgba32f, kRgba};
    case TexelFormat::b10g11r11: return {kR11G11B10, 1, kRgb, kR11G11B10, kR11G11B10};
    case TexelFormat::e5b9g9r9: return {kSharedExponent, 4, kRgb, kRgb9E5, kRgb};
    case TexelFormat::bc6h_ufloat: return {0, 1, 0, kBc6hUnsigned, kRgb};
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr:
    case TexelFormat::uastc_hdr_4x4: break;  // refused before
  }
  return {0, 1, 0, kBc6hSigned, kRgb};
}

std::vector<std::uint8_t> header_bytes(const TextureJob& job) {
  const GlFormat gl = gl_format(job.options.format);
  const auto size = static_cast<std::uint32_t>(job.mips.front().size);
  const auto levels = static_cast<std::uint32_t>(job.levels.size());
  constexpr std::uint32_t no_depth = 0, no_array = 0, six_faces = 6;
  const std::vector<std::uint8_t> metadata = key_value_bytes(job.file, job.options.metadata);
  std::vector<std::uint8_t> bytes(kIdentifier.begin(), kIdentifier.end());
  for (const std::uint32_t field :
       {kOwnOrder, gl.type, gl.type_size, gl.format, gl.internal_format, gl.base_format, size, size, no_depth, no_array,
        six_faces, levels, static_cast<std::uint32_t>(metadata.size())}) {
    platform::append_little_endian(bytes, field);
  }
  bytes.insert(bytes.end(), metadata.begin(), metadata.end());
  return bytes;
}

}  // namespace

std::uint64_t write_ktx1(const TextureJob& job) {
  const std::optional<BlockLevels> blocks = compressed(job);
  const std::vector<std::uint8_t> header = header_bytes(job);
  job.file.write(header.data(), header.size());
  TexelEncoder encoder(job.options.format);
  TexelProgress progress(job);
  for (std::size_t level = 0; level < job.levels.size(); ++level) {
    const auto face_bytes = static_cast<std::uint32_t>(job.level_bytes(level) / 6);  // of a face: this is not an array
    job.file.write(&face_bytes, sizeof face_bytes);
    if (blocks) {
      job.file.write(blocks->levels[level].data(), blocks->levels[level].size());
      continue;
    }
    for (const LatLongView& face : job.levels[level]) write_image(job, face, encoder, progress);
  }
  return (blocks ? blocks->values_clamped : 0) + encoder.clamped();
}

}  // namespace welkin::files
