// KTX2's levels, packed by zlib or Zstandard.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/row_source.h"
#include "platform/file.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::files {

/// Packs bytes; not for `none`. `stop` is checked before each megabyte. Throws `Error` (cancelled), `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> pack(Supercompression supercompression, const std::vector<std::uint8_t>& bytes,
                                             const stop_token& stop = {});

/// Fills `bytes`, whose size is the expected one; nothing is written or allocated beyond it. `path` is for messages.
/// `stop` is checked before each megabyte that zlib unpacks, and once before Zstandard, which is about ten times as
/// fast. Throws `Error` (corrupt_file, cancelled).
void unpack(Supercompression supercompression, const std::vector<std::uint8_t>& packed,
            const std::filesystem::path& path, std::vector<std::uint8_t>& bytes, const stop_token& stop = {});

/// The bytes that `require_unpacks` reads: more than the first block of either library takes.
inline constexpr std::size_t kFirstPackedBytes = std::size_t{1} << 18U;

/// Unpacks the first block of a packed level, to refuse a damaged one before memory for the whole is allocated.
/// `first`: the level's first `kFirstPackedBytes`, or all of it where it is shorter; `unpacked_bytes`: of the whole.
/// Throws `Error` (corrupt_file).
void require_unpacks(Supercompression supercompression, const std::vector<std::uint8_t>& first,
                     std::uint64_t unpacked_bytes, const std::filesystem::path& path);

// One function per library and direction; a build can leave out either library (codecs.h).

[[nodiscard]] std::vector<std::uint8_t> pack_zlib(const std::vector<std::uint8_t>& bytes, const stop_token& stop);
[[nodiscard]] std::vector<std::uint8_t> pack_zstd(const std::vector<std::uint8_t>& bytes, const stop_token& stop);
/// Returns the number of bytes that the zlib stream unpacks to, up to `most`. Empty without zlib, and for an invalid
/// stream, which unpacking will report.
[[nodiscard]] std::optional<std::uint64_t> unpacked_zlib_bytes(std::span<const char> packed, std::uint64_t most);
void unpack_zlib(const std::vector<std::uint8_t>& packed, const std::filesystem::path& path,
                 std::vector<std::uint8_t>& bytes, const stop_token& stop);
void unpack_zstd(const std::vector<std::uint8_t>& packed, const std::filesystem::path& path,
                 std::vector<std::uint8_t>& bytes);

void require_zlib(const std::vector<std::uint8_t>& first, const std::filesystem::path& path);
void require_zstd(const std::vector<std::uint8_t>& first, std::uint64_t unpacked_bytes,
                  const std::filesystem::path& path);

inline constexpr std::size_t kPackedAtOnce = std::size_t{1} << 20U;  ///< bytes between two checks of the stop token

/// Throws a library's message about a level that it cannot unpack.
[[noreturn]] void refuse_packed_level(const std::filesystem::path& path, const char* library,
                                      const std::string& reason);

/// Returns an upper bound on the bytes that `packed_bytes` unpack to.
[[nodiscard]] std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept;

// The layout of texels in KTX2 and DDS files, and conversion from floats and back.

/// The kinds that are read: all that are written (`TexelFormat`, with the same numbers), and more.
enum class TexelKind {
  rgba16f,
  rgba32f,
  b10g11r11,
  e5b9g9r9,
  bc6h_ufloat,
  bc6h_sfloat,
  astc_4x4_hdr,
  astc_6x6_hdr,
  uastc_hdr_4x4,  ///< read as astc_4x4_hdr, whose format it shares
  rgba8,
  rgba8_srgb,
  rgb16f,
  rgb32f,
  rgb8,
  rgb8_srgb,
};
static_assert(static_cast<int>(TexelKind::rgba16f) == static_cast<int>(TexelFormat::rgba16f));
static_assert(static_cast<int>(TexelKind::bc6h_ufloat) == static_cast<int>(TexelFormat::bc6h_ufloat));
static_assert(static_cast<int>(TexelKind::uastc_hdr_4x4) == static_cast<int>(TexelFormat::uastc_hdr_4x4));

[[nodiscard]] constexpr TexelKind kind_of(TexelFormat format) noexcept { return static_cast<TexelKind>(format); }

/// The properties of a kind.
struct KindTraits {
  const char* name;
  std::size_t bytes;                  ///< per texel or block
  int edge;                           ///< texels along the edge of a block; 1: not in blocks
  std::uint32_t unit;                 ///< bytes of what is swapped for the other byte order: a channel, a packed texel
  std::uint32_t vulkan;               ///< VkFormat
  std::uint32_t dxgi;                 ///< DXGI_FORMAT; 0: not read from DDS
  std::optional<PixelFormat> pixels;  ///< with the same layout
  ChannelType channel;                ///< of the first one
  std::size_t channels;
};
[[nodiscard]] const KindTraits& traits(TexelKind kind) noexcept;

/// Returns the kind to which a container gives that number.
[[nodiscard]] std::optional<TexelKind> kind_with(std::uint32_t KindTraits::*member, std::uint32_t number) noexcept;

[[nodiscard]] inline const char* name(TexelKind kind) noexcept { return traits(kind).name; }
[[nodiscard]] inline int block_edge(TexelKind kind) noexcept { return traits(kind).edge; }
[[nodiscard]] inline bool is_compressed(TexelKind kind) noexcept { return block_edge(kind) > 1; }
[[nodiscard]] constexpr bool is_astc(TexelKind kind) noexcept {
  return kind == TexelKind::astc_4x4_hdr || kind == TexelKind::astc_6x6_hdr;
}
[[nodiscard]] inline std::size_t texel_bytes(TexelKind kind) noexcept { return traits(kind).bytes; }

/// The bytes of some rows of a face or image, in whole blocks; `size`: texels in a row.
struct ByteRange {
  std::uint64_t first_byte;  ///< from the face's first one
  std::uint64_t bytes;
};
[[nodiscard]] ByteRange row_byte_range(TexelKind kind, int size, int first_row, int rows) noexcept;

/// Decodes `count` texels, at an address that is a multiple of 4, to packed RGB floats; ignores alpha. Not for blocks.
void decode_texels(TexelKind kind, const std::uint8_t* texels, std::size_t count, float* rgb) noexcept;

// Microsoft's DDS with the DX10 header (Windows documentation, "DDS file layout"): the constants.
//
//   "DDS ", header, DX10 header, then face after face, each with its levels from the largest to the smallest

inline constexpr std::uint32_t kDdsMagic = 0x20534444;    // "DDS "
inline constexpr std::uint32_t kFourCcDx10 = 0x30315844;  // "DX10"
inline constexpr std::uint32_t kDdsHeaderBytes = 124;
inline constexpr std::uint32_t kDdsPixelFormatBytes = 32;
inline constexpr std::uint64_t kDdsFirstTexel = 4 + kDdsHeaderBytes + 20;

// dwFlags, ddspf.dwFlags, dwCaps, dwCaps2.
inline constexpr std::uint32_t kDdsCaps = 0x1, kDdsHeight = 0x2, kDdsWidth = 0x4, kDdsPitch = 0x8;
inline constexpr std::uint32_t kDdsPixelFormat = 0x1000, kDdsMipMapCount = 0x20000, kDdsLinearSize = 0x80000;
inline constexpr std::uint32_t kDdsHasFourCc = 0x4;
inline constexpr std::uint32_t kDdsComplex = 0x8, kDdsTexture = 0x1000, kDdsMipMap = 0x400000;
inline constexpr std::uint32_t kDdsCubemap = 0x200, kDdsAllFaces = 0xFC00;

// resourceDimension, miscFlag.
inline constexpr std::uint32_t kDdsTexture2d = 3, kDdsTextureCube = 0x4;

// KTX 2.0 (Khronos, "KTX File Format Specification", version 2.0): the constants of its header, and the data format
// descriptors (Khronos Data Format Specification 1.3, basic descriptor block).
//
//   identifier, header, level index, descriptor, key/value data, levels from the smallest to the largest

inline constexpr std::array<std::uint8_t, 12> kKtx2Identifier{0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32,
                                                              0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::size_t kKtx2HeaderBytes = 80;      ///< with the identifier, up to the level index
inline constexpr std::size_t kKtx2LevelIndexBytes = 24;  ///< per level: offset, bytes, unpacked bytes

// The offsets of a cubemap's texels in a KTX2 or DDS file.

/// The contents of a header: of a cubemap, or of an image (as a lat-long is). For an array it has the offsets of one
/// element. Every offset lies inside the file, and every level has the bytes that its size takes.
struct TextureLayout {
  struct Level {
    std::uint64_t first_byte = 0;    ///< in the file: of its first face, or of a supercompressed level
    std::uint64_t face_stride = 0;   ///< bytes from one face to the next
    std::uint64_t packed_bytes = 0;  ///< of a supercompressed level, all of which unpacks together
  };

  FileFormat container = FileFormat::ktx2;  ///< or dds
  TexelKind kind = TexelKind::rgba16f;
  Supercompression supercompression = Supercompression::none;
  int size = 0;               ///< texels along an edge of level 0; of an image in a row
  int height = 0;             ///< rows of an image's level 0; 0: this is a cubemap
  int elements = 1;           ///< of an array
  int element = 0;            ///< the element whose offsets these are
  std::vector<Level> levels;  ///< largest first
  bool has_metadata = false;  ///< whether the container can store it
  std::map<std::string, std::string> metadata;

  [[nodiscard]] int level_size(int level) const noexcept { return size >> level > 1 ? size >> level : 1; }
  [[nodiscard]] int faces() const noexcept { return height > 0 ? 1 : 6; }
  /// Returns the rows of a face, or of the image.
  [[nodiscard]] int level_rows(int level) const noexcept {
    if (height == 0) return level_size(level);
    return height >> level > 1 ? height >> level : 1;
  }
  /// Returns the bytes of a face, or of the image.
  [[nodiscard]] std::uint64_t face_bytes(int level) const noexcept {
    return row_byte_range(kind, level_size(level), 0, level_rows(level)).bytes;
  }
  /// Returns the bytes of all elements' faces.
  [[nodiscard]] std::uint64_t whole_bytes(int level) const noexcept {
    return face_bytes(level) * static_cast<std::uint64_t>(faces()) * static_cast<std::uint64_t>(elements);
  }
  /// Returns the offset in a level of a face of the element.
  [[nodiscard]] std::uint64_t first_byte_of(int level, int face) const noexcept {
    return face_bytes(level) * static_cast<std::uint64_t>(element * faces() + face);
  }
};

/// "none", "zlib", "zstd"
[[nodiscard]] const char* name(Supercompression supercompression) noexcept;

/// Reads and checks a whole header, without texels. The file is at its beginning. Throws `Error`: corrupt_file,
/// unsupported_file, file_access.
[[nodiscard]] TextureLayout read_ktx2_layout(platform::ByteFile& file, int element = 0);
[[nodiscard]] TextureLayout read_ktx1_layout(platform::ByteFile& file, int element = 0);
[[nodiscard]] TextureLayout read_dds_layout(platform::ByteFile& file, int element = 0);

/// Reads the layout of any of these, by the first bytes; unsupported_file for another file.
[[nodiscard]] TextureLayout read_texture_layout(platform::ByteFile& file, int element = 0);
/// Returns whether a file that starts with these `first_bytes` is a texture.
[[nodiscard]] bool is_texture(std::string_view start);

/// Reads KTX's key/value data, of both versions: keys with their values, without a text's closing zero. An invalid
/// entry is an error. Throws `Error` (corrupt_file, limit_exceeded, file_access).
[[nodiscard]] std::map<std::string, std::string> read_key_values(platform::ByteFile& file, std::uint64_t offset,
                                                                 std::uint64_t bytes);

/// Returns key/value data as bytes, sorted by key. Throws `Error` (invalid_argument) above 1 MiB.
[[nodiscard]] std::vector<std::uint8_t> key_value_bytes(const platform::WholeFile& file,
                                                        const std::map<std::string, std::string>& metadata);

/// Throws `Error` naming the file.
[[noreturn]] void refuse_texture(const platform::ByteFile& file, ErrorCode code, const std::string& message);

/// Throws `Error` (corrupt_file) unless the file has these bytes, which `what` names.
void require_inside(const platform::ByteFile& file, const std::string& what, std::uint64_t offset, std::uint64_t bytes);

/// Sets the layout's sizes, elements and element. `faces`: 6 or 1; `elements`: 0 counts as one. Throws `Error`
/// (corrupt_file, unsupported_file) for impossible values, or a missing element.
void settle_texture(const platform::ByteFile& file, TextureLayout& layout, std::uint64_t width, std::uint64_t height,
                    std::uint64_t levels, std::uint32_t faces, std::uint32_t elements, int element);

// KTX2 and DDS cubemaps as rows.

/// Opens a file for which `is_texture` holds. Six faces are those of `CubemapView`, as a vertical strip; an image holds
/// the sphere as its shape or the options say. Packed levels are unpacked whole. 8-bit texels are linear or sRGB by the
/// format, or by ReadOptions.transfer. Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_texture(platform::ByteFile& file, const ReadOptions& options);

// Whether a file's levels are plain mips.

/// Returns whether a metadata key is about roughness ("welkin.roughness"): then the smaller levels are blurred for
/// reflections, and none of them stands for the image.
[[nodiscard]] inline bool speaks_of_roughness(const std::string& key) {
  return lower_case(key).find("roughness") != std::string::npos;
}

// The code that the writers of textures share.

/// A checked texture that is about to be written, a cubemap or flat.
struct TextureJob {
  platform::WholeFile& file;
  std::vector<std::vector<LatLongView>> levels;  ///< six faces per level, or one image: rows, not directions
  const TextureOptions& options;
  const Control& control;
  std::span<const CubemapView> mips{};  ///< the same levels, if this is a cubemap

  [[nodiscard]] std::size_t faces() const noexcept { return levels.front().size(); }
  [[nodiscard]] TexelKind kind() const noexcept { return kind_of(options.format); }
  /// Returns the bytes of all faces of a level, unpacked.
  [[nodiscard]] std::uint64_t level_bytes(std::size_t level) const noexcept;
};

/// Levels in blocks.
struct BlockLevels {
  std::vector<std::vector<std::uint8_t>> levels;  ///< per level the blocks of its faces or image
  std::uint64_t values_clamped = 0;
};

/// Returns the job's levels in blocks, if its format has blocks: nine tenths of the work, reported to the job's
/// control. Throws `Error`: invalid_argument (the effort), cancelled.
[[nodiscard]] std::optional<BlockLevels> compressed(const TextureJob& job);

// Blocks of ASTC with high dynamic range (Khronos Data Format Specification 1.3, "ASTC Compressed Texture Image
// Formats"), by the library astcenc.

/// A function that decodes the blocks at `row_byte_range` to packed RGB floats, for the kind that it was made for. A
/// block that the specification does not define gives NaN. Each thread has its own: it keeps astcenc's tables (3 MB,
/// made in about 4 ms). Throws `std::bad_alloc`.
using AstcDecoder = std::function<void(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb)>;

/// `path` is for messages. Throws `Error` (unsupported_file) in a build without astcenc, `std::bad_alloc`.
[[nodiscard]] AstcDecoder make_astc_decoder(TexelKind kind, const std::filesystem::path& path);

/// Encodes the faces of each level, or its one image. Values beyond the range of half floats, and negatives, are
/// clamped and counted. The bytes are the same on any number of threads: blocks are encoded independently. Throws
/// `Error`: invalid_argument (the effort), cancelled; `std::bad_alloc`.
[[nodiscard]] BlockLevels encode_astc(std::span<const std::vector<LatLongView>> levels, TexelKind kind,
                                      AstcEffort effort, const Control& control);

// The writers.

/// Each writes the texture to the job's file and returns how many values were clamped. Throws the errors of
/// `write_texture`. KTX and OpenEXR are for cubemaps only, and a flat DDS has one level.
std::uint64_t write_ktx2(const TextureJob& job);
std::uint64_t write_ktx1(const TextureJob& job);
std::uint64_t write_dds(const TextureJob& job);
std::uint64_t write_exr_cube(const TextureJob& job);

/// A three-dimensional texture of half floats, four per texel, x first, then y, then z; or an array indexed by z.
struct Volume {
  std::array<int, 3> size;
  std::span<const std::uint16_t> halves;
  bool is_array = false;
};

/// Writes a volume unchanged.
void write_ktx2_volume(platform::WholeFile& file, const Volume& volume,
                       const std::map<std::string, std::string>& metadata);

/// Encodes a face or image to texels, in blocks of rows.
class TexelEncoder {
 public:
  explicit TexelEncoder(TexelFormat format) : format_(format) {}

  /// Encodes rows to `texels`: rows x width texels.
  void encode(const LatLongView& image, int first_row, int rows, std::uint8_t* texels);

  [[nodiscard]] std::uint64_t clamped() const noexcept { return clamped_; }

 private:
  TexelFormat format_;
  std::vector<float> rgb_;  // a row
  std::uint64_t clamped_ = 0;
};

/// The progress of writing texels of a whole chain.
class TexelProgress {
 public:
  explicit TexelProgress(const TextureJob& job);
  /// Called before `texels` more are written: throws `Error` (cancelled), and reports the fraction done.
  void next(std::uint64_t texels);

 private:
  const Control& control_;
  double total_ = 0.0;
  double done_ = 0.0;
};

/// Writes a face or image as stored in the file, unpacked.
void write_image(const TextureJob& job, const LatLongView& image, TexelEncoder& encoder, TexelProgress& progress);

}  // namespace welkin::files
