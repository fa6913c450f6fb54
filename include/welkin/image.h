// Pixels: views of the caller's, images that own theirs, targets in the caller's memory, and BC6H blocks.
//
//   welkin::CubemapView cubemap{{px, nx, py, ny, pz, nz}, 1024, 0, welkin::PixelFormat::rgba16f};
//   welkin::LatLongView panorama{pixels, 4096, 2048, 0, welkin::PixelFormat::rgb32f};
//
// A view is read in place and never owns its pixels: they must stay as they are until the call that reads them returns.
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

/// How one texel lies in memory: interleaved channels, no padding inside a texel.
/// Alpha is read past and never used. f16 is IEEE 754 binary16; u8 maps 0..255 to 0..1;
/// srgb8 does so and then applies the sRGB transfer function (IEC 61966-2-1).
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

/// Bytes that one texel takes: 3 to 16.
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
  std::array<const void*, 6> faces{};        ///< first texel of each face; float formats aligned to their channel
  int size = 0;                              ///< texels along an edge, 1 to 16384; need not be even
  std::ptrdiff_t row_stride_bytes = 0;       ///< from a row to the next; 0: rows are packed; negative: bottom-up
  PixelFormat format = PixelFormat::rgb32f;  ///< of all six faces

  /// Whether these are the same pixels in memory, not whether they hold the same values. So for `LatLongView`.
  friend bool operator==(const CubemapView&, const CubemapView&) = default;
};

/// A full sphere as latitude over longitude (equirectangular).
///
/// Texel (column i, row j) covers latitudes from pi/2 - pi j/height down to pi/2 - pi (j+1)/height and
/// longitudes from pi - 2 pi i/width to pi - 2 pi (i+1)/width, and a direction is
/// (sin(lon) cos(lat), sin(lat), cos(lon) cos(lat)): the centre looks along +z, +x lies a quarter in from
/// the left. That is OpenEXR's orientation with texels as areas.
struct LatLongView {
  const void* pixels = nullptr;              ///< first texel of the top row
  int width = 0;                             ///< 1 to 65536; twice the height as a rule, but any ratio is taken
  int height = 0;                            ///< 1 to 32768
  std::ptrdiff_t row_stride_bytes = 0;       ///< from a row to the next; 0: rows are packed; negative: bottom-up
  PixelFormat format = PixelFormat::rgb32f;  ///< of the pixels

  friend bool operator==(const LatLongView&, const LatLongView&) = default;
};

/// How an environment's pixels lie.
enum class EnvironmentKind { lat_long, cubemap };

/// A lat-long or a cubemap, for calls that read either. Both views convert to it.
class EnvironmentView {
 public:
  EnvironmentView(const LatLongView& view) noexcept : view_(view) {}  ///< converts. NOLINT(google-explicit-constructor)
  EnvironmentView(const CubemapView& view) noexcept : view_(view) {}  ///< converts. NOLINT(google-explicit-constructor)

  /// Which of the two it is.
  [[nodiscard]] EnvironmentKind kind() const noexcept {
    return view_.index() == 0 ? EnvironmentKind::lat_long : EnvironmentKind::cubemap;
  }
  /// The view of a lat-long. Throws `Error` (invalid_argument) for a cubemap.
  [[nodiscard]] LatLongView lat_long() const;
  /// The view of a cubemap. Throws `Error` (invalid_argument) for a lat-long.
  [[nodiscard]] CubemapView cubemap() const;

  /// Whether these are the same pixels in memory.
  friend bool operator==(const EnvironmentView&, const EnvironmentView&) = default;

 private:
  std::variant<LatLongView, CubemapView> view_;
};

// ---- Images that own their pixels

/// An RGB float lat-long picture that owns its pixels.
struct LatLongImage {
  int width = 0;              ///< texels; twice the height
  int height = 0;             ///< texels
  std::vector<float> pixels;  ///< width x height x 3, row 0 on top

  /// The pixels as a view. It is valid while `pixels` are.
  [[nodiscard]] LatLongView view() const noexcept { return {pixels.data(), width, height, 0, PixelFormat::rgb32f}; }
};

/// How many levels a whole chain has, from `size` down to 1: 1 + floor(log2(size)). `size` >= 1.
[[nodiscard]] constexpr int full_chain_levels(int size) noexcept {
  int levels = 1;
  while (size > 1) {
    size /= 2;
    ++levels;
  }
  return levels;
}

/// Six faces of RGB floats in the frames of `CubemapView`, with or without smaller levels (mips), in one block of
/// memory: level after level, face after face, row after row, no padding. Level l has max(1, size >> l) texels along an
/// edge, as graphics APIs count.
class Cubemap {
 public:
  /// No levels.
  Cubemap() = default;

  /// The pixels are not initialised; they start on a cache line. `memory` must outlive the cubemap; null: the default
  /// resource, where large cubemaps are `keep_working_memory`'s. Throws `Error` (invalid_argument) unless
  /// 1 <= size <= 16384 and 1 <= levels <= full_chain_levels(size), and what `memory` throws.
  explicit Cubemap(int size, int levels = 1, memory_resource* memory = nullptr);

  /// One level with a copy of these pixels, face after face: 6 x size x size x 3 floats. Throws `Error`
  /// (invalid_argument) for another number of floats, and as above.
  Cubemap(int size, std::span<const float> pixels);

  /// Copies the pixels into memory of the default resource.
  Cubemap(const Cubemap& other);
  /// Takes the pixels and leaves `other` without levels.
  Cubemap(Cubemap&& other) noexcept { swap(other); }
  /// Copies or takes the pixels of another cubemap.
  Cubemap& operator=(Cubemap other) noexcept {
    swap(other);
    return *this;
  }
  ~Cubemap() = default;

  /// Texels along an edge of level 0; 0 if there are no levels.
  [[nodiscard]] int size() const noexcept { return size_; }
  /// How many levels there are; 0 for an empty cubemap.
  [[nodiscard]] int levels() const noexcept { return static_cast<int>(offsets_.size()); }
  /// Texels along an edge of a level, 0 <= level < levels().
  [[nodiscard]] int level_size(int level) const noexcept { return size_ >> level > 1 ? size_ >> level : 1; }
  /// Memory of all levels.
  [[nodiscard]] std::size_t bytes() const noexcept { return values_ * sizeof(float); }

  /// Every float of all levels.
  [[nodiscard]] std::span<float> pixels() noexcept { return {pixels_.get(), values_}; }
  /// Every float of all levels.
  [[nodiscard]] std::span<const float> pixels() const noexcept { return {pixels_.get(), values_}; }

  /// First channel of a face's first texel: level_size^2 x 3 floats. 0 <= level < levels(), 0 <= face < 6.
  [[nodiscard]] float* face(int level, int face) noexcept { return pixels_.get() + face_offset(level, face); }
  /// First float of a face: level_size x level_size texels of RGB, packed, row 0 on top.
  [[nodiscard]] const float* face(int level, int face) const noexcept {
    return pixels_.get() + face_offset(level, face);
  }
  /// First float of a face of level 0.
  [[nodiscard]] float* face(int face) noexcept { return this->face(0, face); }
  /// First float of a face of level 0.
  [[nodiscard]] const float* face(int face) const noexcept { return this->face(0, face); }

  /// A level as a view; of an empty cubemap, a view of size 0. It is valid while the cubemap lives and is not assigned
  /// to.
  [[nodiscard]] CubemapView view(int level = 0) const noexcept;
  /// All levels, as `project` and the writers take them.
  [[nodiscard]] std::vector<CubemapView> views() const;

 private:
  /// Gives the pixels back to where they came from.
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
  std::vector<std::size_t> offsets_;  ///< of each level's first value
  std::unique_ptr<float[], Free> pixels_;
};

// ---- Cubemaps in the caller's memory, as Vulkan and D3D12 take them: a mapped upload buffer for instance
//
//   const welkin::UploadLayout layout{.format = welkin::TexelFormat::rgba16f, .size = 256, .levels = 9};
//   std::span<std::byte> memory = map(upload_bytes(layout));
//   welkin::store_texels(light.specular->cubemap, upload_targets(layout, memory));

/// How a texel is stored. Each value is rounded to the nearest that the format has. What a format cannot hold is
/// clamped and counted: a value above the largest becomes the largest, NaN becomes 0, and negatives become 0 in formats
/// without a sign. Alpha is written as 1.
enum class TexelFormat {
  rgba16f,    ///< halves, -65504 to 65504
  rgba32f,    ///< floats, as they are: NaN and infinities too
  b10g11r11,  ///< unsigned floats of 11, 11 and 10 bits, up to 65024 and 64512: 1 part in 64 and 32
  e5b9g9r9,   ///< mantissas of 9 bits, one exponent, up to 65408: 1 part in 512 of the largest channel
  /// BC6H in blocks of 4 x 4, up to 65504. Files of cubemaps are written with it; memory is filled by
  /// `encode_bc6h`.
  bc6h_ufloat,
  bc6h_sfloat,  ///< the same with negatives
  /// ASTC with high dynamic range in blocks of 4 x 4 (1 byte a texel) or 6 x 6 (4/9 of one), up to 65504. KTX2 files
  /// hold it (bake_file.h).
  astc_4x4_hdr,
  astc_6x6_hdr,  ///< the same in larger blocks
};

/// One level of a cubemap in memory that is written to. Rows of a face lie `row_stride_bytes` apart, row 0 first; what
/// lies between them is not touched. Faces are those of `CubemapView`, and need not lie one after the other.
struct CubemapTarget {
  std::array<void*, 6> faces{};               ///< where the first texel of the top row of each face is written
  int size = 0;                               ///< texels along an edge
  std::ptrdiff_t row_stride_bytes = 0;        ///< from a row to the next; 0: rows are packed; negative: bottom-up
  TexelFormat format = TexelFormat::rgba16f;  ///< how texels are written, in all six faces
};

/// Writes a cubemap of the same size. Returns how many channel values the format could not hold. The same bytes on any
/// number of threads. Throws `Error`: invalid_argument (a null face, another size, rows that overlap), cancelled.
std::uint64_t store_texels(const CubemapView& from, const CubemapTarget& to, const Control& control = {});

/// Writes all levels of a cubemap, each to its target. Returns how many channel values the format could not hold.
/// Throws as above, and invalid_argument unless there are as many targets as levels; nothing is written if one is
/// refused.
std::uint64_t store_texels(const Cubemap& from, std::span<const CubemapTarget> to, const Control& control = {});

/// Which of the images of six faces and several levels come one after the other.
enum class UploadOrder {
  level_by_level,  ///< six faces of level 0, six of level 1, ...: KTX2, and one copy a level in Vulkan
  face_by_face,    ///< all levels of +X, then of -X, ...: D3D12's subresources, DDS
};

/// How a chain lies in one block of memory.
struct UploadLayout {
  TexelFormat format = TexelFormat::rgba16f;        ///< of all texels
  int size = 0;                                     ///< texels along an edge of level 0: 1 to 16384
  int levels = 1;                                   ///< 1 to `full_chain_levels(size)`
  UploadOrder order = UploadOrder::level_by_level;  ///< whether levels or faces follow each other
  std::uint64_t row_alignment_bytes = 1;            ///< of the distance between rows; D3D12 wants 256
  std::uint64_t level_alignment_bytes = 1;  ///< of each face of each level, from the start of the memory; D3D12: 512
};

/// Bytes of such a block. Throws `Error` (invalid_argument) for members out of range.
[[nodiscard]] std::uint64_t upload_bytes(const UploadLayout& layout);

/// The targets of such a block, one a level. Throws `Error` (invalid_argument) as above, and if the memory is too
/// small.
[[nodiscard]] std::vector<CubemapTarget> upload_targets(const UploadLayout& layout, std::span<std::byte> memory);

// ---- Cubemaps as BC6H: blocks of 4 x 4 texels in 16 bytes, which graphics cards read (BC6H_UF16, BC6H_SF16)
//
//   welkin::Bc6hCubemap blocks = welkin::encode_bc6h(light.specular->cubemap.views());
//   upload(blocks.levels[0].blocks);
//
// For radiance. Irradiance must not be compressed: where it nears 0 errors of a block are large beside it.

/// How long is searched for a block's best numbers. Errors: rms of a channel's relative error (below 2^-14 relative to
/// that), over chains of 256 from seven pictures; docs/notes/textures.md has the table.
enum class Bc6hEffort {
  fast,    ///< one line of colours a block: 3.4 %
  normal,  ///< and two lines, with the partition that promises most, where one is not enough: 2.3 %
  slow,    ///< with the best of four partitions
};

/// What and how to encode.
struct Bc6hOptions {
  Bc6hEffort effort = Bc6hEffort::normal;  ///< what an error may cost
  bool is_signed = false;                  ///< BC6H_SFLOAT, which has negatives and half the precision
};

/// One level of a cubemap in blocks.
struct Bc6hLevel {
  int size = 0;  ///< texels along an edge; blocks at the right and at the bottom may reach beyond
  /// Face after face in the order of `CubemapView`, rows of blocks from the top: 6 x ceil(size / 4)^2 x 16 bytes.
  std::vector<std::uint8_t> blocks;
  /// Rms of the relative error of a channel, as the encoder sees it while it works. It is within a tenth of
  /// `bc6h_errors` from 16 texels on.
  double estimated_error = 0.0;
};

/// A chain of levels, largest first.
struct Bc6hCubemap {
  std::vector<Bc6hLevel> levels;     ///< largest first
  bool is_signed = false;            ///< BC6H_SFLOAT instead of BC6H_UFLOAT
  std::uint64_t values_clamped = 0;  ///< channel values that halves could not hold: above 65504, NaN, or negative
};

/// Encodes a cubemap with its mips, largest first, each half the one before (rounded down). Values that the format
/// cannot hold are clamped and counted, NaN becomes 0. The same bytes on every instruction set and any number of
/// threads. Throws `Error`: invalid_argument (an uneven chain), cancelled.
/// Error halves where the size of the faces doubles. A level of fewer than 32 texels has little in a block that is
/// alike: of 256 texels' chains with `normal`, 2.6 % at 16 texels, 4 to 5 % below. The ends of a level's brightest
/// blocks are chosen so that from 16 texels on the mean of each channel is within 0.5 % (signed: 0.8 %).
[[nodiscard]] Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options = {},
                                      const Control& control = {});

/// Decodes all levels, exactly as the format is defined. Throws `Error`: invalid_argument (sizes and bytes that do not
/// fit), cancelled.
[[nodiscard]] Cubemap decode_bc6h(const Bc6hCubemap& cubemap, const Control& control = {});

/// Of each level, the rms over all channels of (decoded - given) / max(|given|, 2^-14), with given as clamped to what
/// the format holds. Decodes all. Throws `Error`: invalid_argument, cancelled.
[[nodiscard]] std::vector<double> bc6h_errors(const Bc6hCubemap& cubemap, std::span<const CubemapView> mips,
                                              const Control& control = {});

}  // namespace welkin
