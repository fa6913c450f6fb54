// Pixels: views of the caller's memory, images that own theirs, targets to write to, and BC6H blocks.
//
//   welkin::CubemapView cubemap{{px, nx, py, ny, pz, nz}, 1024, 0, welkin::PixelFormat::rgba16f};
//   welkin::LatLongView panorama{pixels, 4096, 2048, 0, welkin::PixelFormat::rgb32f};
//
// A view is read in place and never owns its pixels, which must not change until the call that reads them returns.
// Calls that read either kind take an `EnvironmentView`, to which both convert: project(cubemap), bake(panorama).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "welkin/core.h"

namespace WELKIN_EXPORT welkin {

// ---- Views of the caller's pixels

/// The layout of one texel in source pixels: interleaved channels without padding. Alpha is ignored. "16f" is IEEE 754
/// binary16. 8-bit values map 0..255 to 0..1; the srgb formats are then decoded by the sRGB transfer function (IEC
/// 61966-2-1). Formats for writing are `TexelFormat`.
enum class PixelFormat {
  rgb32f,
  rgba32f,
  rgb16f,
  rgba16f,
  rgb8,
  rgba8,
  srgb8,
  srgba8,
};

/// Returns the number of bytes per texel: 3 to 16.
[[nodiscard]] constexpr std::size_t bytes_per_texel(PixelFormat format) noexcept {
  switch (format) {
    case PixelFormat::rgb32f: return 12;
    case PixelFormat::rgba32f: return 16;
    case PixelFormat::rgb16f: return 6;
    case PixelFormat::rgba16f: return 8;
    case PixelFormat::rgb8:
    case PixelFormat::srgb8: return 3;
    case PixelFormat::rgba8:
    case PixelFormat::srgba8: return 4;
  }
  return 0;
}

/// Six square faces in the order +X -X +Y -Y +Z -Z, row 0 on top.
///
/// | face | normal | u (column) runs along | v (row) runs along |
/// |---|---|---|---|
/// | +X | +x | -z | -y |
/// | -X | -x | +z | -y |
/// | +Y | +y | +x | +z |
/// | -Y | -y | +x | -z |
/// | +Z | +z | +x | -y |
/// | -Z | -z | -x | -y |
///
/// Texel (column i, row j) is a square whose centre is (u, v) = ((2i+1)/size - 1, (2j+1)/size - 1).
struct CubemapView {
  std::array<const void*, 6> faces{};   ///< first texel of each face, aligned to its channel type
  int size = 0;                         ///< texels per edge, 1 to 16384; may be odd
  std::ptrdiff_t row_stride_bytes = 0;  ///< distance between rows; 0 for packed rows; negative for bottom-up images
  PixelFormat format = PixelFormat::rgb32f;  ///< format of all six faces

  /// Compares addresses and layout, not pixel values.
  friend bool operator==(const CubemapView&, const CubemapView&) = default;
};

/// A full sphere as an equirectangular (lat-long) image.
///
/// Texel (column i, row j) covers latitudes from pi/2 - pi j/height down to pi/2 - pi (j+1)/height and longitudes from
/// pi - 2 pi i/width to pi - 2 pi (i+1)/width. A direction is (sin(lon) cos(lat), sin(lat), cos(lon) cos(lat)): the
/// centre of the image looks along +z, and +x lies a quarter of the width from the left edge. This is OpenEXR's
/// orientation, with texels as areas.
struct LatLongView {
  const void* pixels = nullptr;         ///< first texel of the top row
  int width = 0;                        ///< 1 to 65536; usually twice the height, but any ratio is accepted
  int height = 0;                       ///< 1 to 32768
  std::ptrdiff_t row_stride_bytes = 0;  ///< distance between rows; 0 for packed rows; negative for bottom-up images
  PixelFormat format = PixelFormat::rgb32f;  ///< format of all texels

  friend bool operator==(const LatLongView&, const LatLongView&) = default;
};

/// The two layouts of an environment's pixels.
enum class EnvironmentKind { lat_long, cubemap };

/// A lat-long or a cubemap, for calls that read either. Both kinds of view convert to it.
class EnvironmentView {
 public:
  /// Wraps a lat-long.
  EnvironmentView(const LatLongView& view) noexcept : view_(view) {}  // NOLINT(google-explicit-constructor)
  /// Wraps a cubemap.
  EnvironmentView(const CubemapView& view) noexcept : view_(view) {}  // NOLINT(google-explicit-constructor)

  /// Returns the kind of the wrapped view.
  [[nodiscard]] EnvironmentKind kind() const noexcept {
    return view_.index() == 0 ? EnvironmentKind::lat_long : EnvironmentKind::cubemap;
  }
  /// Returns the view of a lat-long. Throws `Error` (invalid_argument) for a cubemap.
  [[nodiscard]] LatLongView lat_long() const;
  /// Returns the view of a cubemap. Throws `Error` (invalid_argument) for a lat-long.
  [[nodiscard]] CubemapView cubemap() const;

  /// Compares addresses and layout, not pixel values.
  friend bool operator==(const EnvironmentView&, const EnvironmentView&) = default;

 private:
  std::variant<LatLongView, CubemapView> view_;
};

// ---- Images that own their pixels

/// An RGB float lat-long image that owns its pixels.
struct LatLongImage {
  int width = 0;              ///< texels per row; twice the height
  int height = 0;             ///< number of rows
  std::vector<float> pixels;  ///< width x height x 3 values, top row first

  /// Returns a view of the pixels, valid as long as `pixels` is unchanged.
  [[nodiscard]] LatLongView view() const noexcept { return {pixels.data(), width, height, 0, PixelFormat::rgb32f}; }
};

/// Returns the number of mips of a complete chain from `size` down to 1: 1 + floor(log2(size)). `size` must be at least
/// 1.
[[nodiscard]] constexpr int full_chain_levels(int size) noexcept {
  int levels = 1;
  while (size > 1) {
    size /= 2;
    ++levels;
  }
  return levels;
}

/// An RGB float cubemap that owns its pixels, with or without mips, in one block of memory: mip by mip, face by face,
/// row by row, without padding. Faces have the axes of `CubemapView`. Mip l has max(1, size >> l) texels per edge.
class Cubemap {
 public:
  /// Creates an empty cubemap.
  Cubemap() = default;

  /// Allocates a cubemap with uninitialized pixels, aligned to a cache line. `memory` must outlive the cubemap; null
  /// selects the default resource. Throws `Error` (invalid_argument) unless 1 <= size <= 16384 and 1 <= levels <=
  /// full_chain_levels(size), and whatever `memory` throws.
  explicit Cubemap(int size, int levels = 1, memory_resource* memory = nullptr);

  /// Copies the pixels of a cubemap with one mip: 6 x size x size x 3 floats, face by face. Throws `Error`
  /// (invalid_argument) for any other number of floats or size.
  Cubemap(int size, std::span<const float> pixels);

  /// Copies the pixels into memory of the default resource.
  Cubemap(const Cubemap& other);
  /// Moves the pixels; `other` is empty afterwards.
  Cubemap(Cubemap&& other) noexcept { swap(other); }
  /// Copies or moves the pixels of another cubemap.
  Cubemap& operator=(Cubemap other) noexcept {
    swap(other);
    return *this;
  }
  ~Cubemap() = default;

  /// Returns the texels per edge of mip 0, or 0 for an empty cubemap.
  [[nodiscard]] int size() const noexcept { return size_; }
  /// Returns the number of mips, or 0 for an empty cubemap.
  [[nodiscard]] int levels() const noexcept { return static_cast<int>(offsets_.size()); }
  /// Returns the texels per edge of a mip, 0 <= level < levels().
  [[nodiscard]] int level_size(int level) const noexcept { return size_ >> level > 1 ? size_ >> level : 1; }
  /// Returns the size of all mips in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept { return values_ * sizeof(float); }

  /// Returns all values of all mips.
  [[nodiscard]] std::span<float> pixels() & noexcept { return {pixels_.get(), values_}; }
  /// Returns all values of all mips.
  [[nodiscard]] std::span<const float> pixels() const& noexcept { return {pixels_.get(), values_}; }
  /// Returns a copy of all values: those of a temporary would not outlive the expression.
  [[nodiscard]] std::vector<float> pixels() && { return {pixels_.get(), pixels_.get() + values_}; }

  /// Returns the pixels of a face: level_size^2 packed RGB texels, top row first. 0 <= level < levels(), 0 <= face < 6.
  [[nodiscard]] float* face(int level, int face) noexcept { return pixels_.get() + face_offset(level, face); }
  /// Returns the pixels of a face: level_size^2 packed RGB texels, top row first. 0 <= level < levels(), 0 <= face < 6.
  [[nodiscard]] const float* face(int level, int face) const noexcept {
    return pixels_.get() + face_offset(level, face);
  }
  /// Returns the pixels of a face of mip 0.
  [[nodiscard]] float* face(int face) noexcept { return this->face(0, face); }
  /// Returns the pixels of a face of mip 0.
  [[nodiscard]] const float* face(int face) const noexcept { return this->face(0, face); }

  /// Returns a view of one mip, valid until the cubemap is assigned to or destroyed. An empty cubemap gives a view of
  /// size 0.
  [[nodiscard]] CubemapView view(int level = 0) const noexcept;
  /// Returns views of all mips, in the form that `project` and the file writers take.
  [[nodiscard]] std::vector<CubemapView> views() const;

 private:
  /// Returns the pixels to the resource that allocated them.
  struct Free {
    memory_resource* memory;
    std::size_t bytes;

    void operator()(float* pixels) const noexcept;
  };

  [[nodiscard]] std::size_t face_offset(int level, int face) const noexcept {
    const auto edge = static_cast<std::size_t>(level_size(level));
    return offsets_[static_cast<std::size_t>(level)] + static_cast<std::size_t>(face) * edge * edge * 3;
  }
  void swap(Cubemap& other) noexcept;

  int size_ = 0;
  std::size_t values_ = 0;
  std::vector<std::size_t> offsets_;  ///< index of each mip's first value
  std::unique_ptr<float[], Free> pixels_;
};

// ---- Cubemaps in the caller's memory, such as a mapped upload buffer of Vulkan or D3D12
//
//   const welkin::UploadLayout layout{.format = welkin::TexelFormat::rgba16f, .size = 256, .levels = 9};
//   std::span<std::byte> memory = map(upload_bytes(layout));
//   welkin::store_texels(light.specular->cubemap, upload_targets(layout, memory));

/// The format of written texels. Values are rounded to the nearest representable one. Values out of range are clamped
/// and counted: values above the maximum become the maximum, NaN becomes 0, and negative values become 0 in unsigned
/// formats. Alpha is written as 1.
enum class TexelFormat {
  rgba16f,  ///< half floats, -65504 to 65504
  rgba32f,  ///< floats, unchanged, including NaN and infinities
  /// unsigned floats of 11, 11 and 10 bits, up to 65024 (red, green; 1 part in 64) and 64512 (blue; 1 part in 32)
  b10g11r11,
  e5b9g9r9,  ///< 9-bit mantissas with a shared exponent, up to 65408; 1 part in 512 of the largest channel
  /// BC6H in blocks of 4 x 4, up to 65504. File writers accept it; for memory use `encode_bc6h`.
  bc6h_ufloat,
  bc6h_sfloat,  ///< BC6H with negative values
  /// HDR ASTC in blocks of 4 x 4, 1 byte per texel, up to 65504. KTX2 files only (bake_file.h).
  astc_4x4_hdr,
  astc_6x6_hdr,  ///< HDR ASTC in blocks of 6 x 6, 4/9 byte per texel. KTX2 files only.
  /// UASTC HDR, 1 byte per texel, up to 65216: HDR ASTC 4 x 4 that web loaders turn into BC6H. KTX2 files only.
  uastc_hdr_4x4,
};

/// One mip of a cubemap in the caller's memory, to be written. Faces have the axes of `CubemapView` and need not be
/// contiguous. Padding between rows is not written.
struct CubemapTarget {
  std::array<void*, 6> faces{};         ///< address of the first texel of each face's top row
  int size = 0;                         ///< texels per edge
  std::ptrdiff_t row_stride_bytes = 0;  ///< distance between rows; 0 for packed rows; negative for bottom-up images
  TexelFormat format = TexelFormat::rgba16f;  ///< format of all six faces
};

/// Writes a cubemap to a target of the same size. Returns the number of channel values that were clamped. Throws
/// `Error` (invalid_argument) for a null face, another size, or overlapping rows.
std::uint64_t store_texels(const CubemapView& from, const CubemapTarget& to, const Control& control = {});

/// Writes each mip of a cubemap to its target. Returns the number of channel values that were clamped. Throws `Error`
/// (invalid_argument) for a null face, another size, overlapping rows, or too few or too many targets.
std::uint64_t store_texels(const Cubemap& from, std::span<const CubemapTarget> to, const Control& control = {});

/// The order of images in a block of memory that holds a mip chain.
enum class UploadOrder {
  level_by_level,  ///< six faces of mip 0, then six of mip 1, and so on: KTX2, and one copy per mip in Vulkan
  face_by_face,    ///< all mips of +X, then of -X, and so on: DDS, and D3D12's subresources
};

/// The layout of a mip chain in one block of memory.
struct UploadLayout {
  TexelFormat format = TexelFormat::rgba16f;        ///< format of all texels
  int size = 0;                                     ///< texels per edge of mip 0, 1 to 16384
  int levels = 1;                                   ///< number of mips, 1 to `full_chain_levels(size)`
  UploadOrder order = UploadOrder::level_by_level;  ///< order of the images
  std::uint64_t row_alignment_bytes = 1;            ///< alignment of the distance between rows; D3D12 needs 256
  /// alignment of each face of each mip, from the start of the memory; D3D12 needs 512
  std::uint64_t level_alignment_bytes = 1;
};

/// Returns the number of bytes that a layout needs. Throws `Error` (invalid_argument) for members out of range.
[[nodiscard]] std::uint64_t upload_bytes(const UploadLayout& layout);

/// Returns the targets of a layout in `memory`, one per mip. Throws `Error` (invalid_argument) for members out of
/// range, and if the memory is too small.
[[nodiscard]] std::vector<CubemapTarget> upload_targets(const UploadLayout& layout, std::span<std::byte> memory);

// ---- Cubemaps as BC6H: blocks of 4 x 4 texels in 16 bytes, which GPUs read directly (BC6H_UF16, BC6H_SF16)
//
//   welkin::Bc6hCubemap blocks = welkin::encode_bc6h(light.specular->cubemap.views());
//   upload(blocks.levels[0].blocks);
//
// Use it for radiance. Do not compress irradiance: block errors are large relative to its dark values.

/// The effort that the encoder spends on each block. The errors below are rms relative errors per channel over chains
/// of 256 texels from seven photographs (docs/notes/textures.md); values below 2^-14 are measured relative to 2^-14.
enum class Bc6hEffort {
  fast,    ///< one pair of endpoints per block: error 3.4 %
  normal,  ///< also tries two pairs, in the most promising partition, where one is not enough: error 2.3 %
  slow,    ///< tries the four most promising partitions
};

/// Options of `encode_bc6h`.
struct Bc6hOptions {
  Bc6hEffort effort = Bc6hEffort::normal;  ///< trades time for error
  bool is_signed = false;                  ///< selects BC6H_SFLOAT, which has negative values and half the precision
};

/// One mip of a cubemap as BC6H blocks.
struct Bc6hLevel {
  int size = 0;  ///< texels per edge; the last blocks of a row or column may extend beyond it
  /// 6 x ceil(size / 4)^2 x 16 bytes: face by face in the order of `CubemapView`, top row of blocks first.
  std::vector<std::uint8_t> blocks;
  /// Estimated rms of the relative error of a channel. From 16 texels per edge on it is within 10 % of `bc6h_errors`.
  double estimated_error = 0.0;
};

/// A BC6H cubemap with its mips.
struct Bc6hCubemap {
  std::vector<Bc6hLevel> levels;     ///< mips, largest first
  bool is_signed = false;            ///< BC6H_SFLOAT instead of BC6H_UFLOAT
  std::uint64_t values_clamped = 0;  ///< channel values outside the range of half floats: above 65504, NaN, or negative
};

/// Encodes a cubemap with its mips, largest first; each must have half the size of the one before, rounded down. Values
/// out of range are clamped and counted; NaN becomes 0. Throws `Error` (invalid_argument) for mips of other sizes.
///
/// The error halves as the face size doubles. Small mips compress worst, because the texels of a block differ: in
/// chains of 256 with `normal`, the error is 2.6 % at 16 texels and 4 to 5 % below. From 16 texels on, the mean of each
/// channel over the mip is within 0.5 % of the source's (signed: 0.8 %).
[[nodiscard]] Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options = {},
                                      const Control& control = {});

/// Decodes all mips exactly as the format defines. Throws `Error` (invalid_argument) if sizes and bytes do not match.
[[nodiscard]] Cubemap decode_bc6h(const Bc6hCubemap& cubemap, const Control& control = {});

/// Decodes all mips and returns, for each, the rms over all channels of (decoded - given) / max(|given|, 2^-14).
/// "given" is clamped to the range of the format. Throws `Error` (invalid_argument) for mips of other sizes.
[[nodiscard]] std::vector<double> bc6h_errors(const Bc6hCubemap& cubemap, std::span<const CubemapView> mips,
                                              const Control& control = {});

}  // namespace welkin
