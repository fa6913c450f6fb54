// From any pixel format to RGB floats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "jobs/tiles.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::image {

/// Whether channels are bytes, whose values lie between 0 and 1.
[[nodiscard]] constexpr bool is_eight_bit(PixelFormat format) noexcept {
  return format == PixelFormat::rgb8 || format == PixelFormat::rgba8 || format == PixelFormat::srgb8 ||
         format == PixelFormat::srgba8;
}

/// Decodes `count` texels at `texels` to packed RGB floats. Exact for float and half formats; 8-bit ones
/// are value / 255, through the sRGB transfer function where the format says so, rounded once to float.
void decode_texels(PixelFormat format, const void* texels, int count, float* rgb) noexcept;

/// A binary16 as a float, exactly; infinities and NaNs stay what they are.
[[nodiscard]] float float_from_half(std::uint16_t half) noexcept;

/// The nearest binary16, ties to even; what is beyond the largest half becomes that, with its sign. Not for NaN.
[[nodiscard]] std::uint16_t half_from_float(float value) noexcept;

/// How texels are written: interleaved floats or halves.
struct TexelLayout {
  int channels = 4;  ///< 2 to 4
  bool halves = false;

  [[nodiscard]] std::size_t channel_bytes() const noexcept { return halves ? 2 : 4; }
  [[nodiscard]] std::size_t texel_bytes() const noexcept {
    return static_cast<std::size_t>(channels) * channel_bytes();
  }
};

/// Writes `count` texels of `channels` (2 or 3) packed floats. A fourth channel is 1, a third that is not given 0.
/// Floats stay what they are. A half beyond the largest becomes that, NaN becomes 0; returned is how many values were
/// so changed. `texels` may lie anywhere.
std::uint64_t encode_texels(const float* values, int channels, std::size_t count, TexelLayout layout,
                            void* texels) noexcept;

/// Texels from packed RGB floats, alpha 1. Returns how many channel values the format could not hold: what is above its
/// largest value becomes that, NaN becomes 0, and negatives 0 in the unsigned formats. Floats are kept as they are.
std::uint64_t encode_texels(TexelFormat format, const float* rgb, std::size_t count, std::uint8_t* texels) noexcept;

/// Throws `Error` (invalid_argument) unless there is a target that fits for each of the `levels` of a chain whose level
/// 0 has `size` texels along an edge. `what`: the chain, for the message.
void check_chain_targets(const char* what, int size, int levels, std::span<const CubemapTarget> targets);

// Floats of few bits, as graphics APIs define them, each rounded to the nearest value that there is.

inline constexpr float kLargestHalf = 65504.0F;
inline constexpr float kLargestFloat11 = 65024.0F;      ///< 6 bits of mantissa
inline constexpr float kLargestFloat10 = 64512.0F;      ///< 5 bits of mantissa
inline constexpr float kLargestSharedFloat = 65408.0F;  ///< 511/512 x 2^16

/// `value` if it is from 0 to `largest`; else the nearer of these, and 0 for NaN, and one more is counted.
[[nodiscard]] inline float bounded(float value, float largest, std::uint64_t& clamped) noexcept {
  if (value >= 0.0F && value <= largest) return value;
  ++clamped;
  return value > largest ? largest : 0.0F;
}

/// VK_FORMAT_B10G11R11_UFLOAT_PACK32: red in bits 0 to 10, green 11 to 21, blue 22 to 31, ties to even.
/// Finite values from 0 to the largest of each.
[[nodiscard]] std::uint32_t pack_b10g11r11(const std::array<float, 3>& rgb) noexcept;
[[nodiscard]] std::array<float, 3> unpack_b10g11r11(std::uint32_t texel) noexcept;

/// VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: mantissas of red in bits 0 to 8, green 9 to 17, blue 18 to 26, one exponent in 27
/// to 31; a value is mantissa x 2^(exponent - 24). By the formulas of the Vulkan specification ("RGB to shared exponent
/// conversion"): halves are rounded up. Finite values from 0 to `kLargestSharedFloat`.
[[nodiscard]] std::uint32_t pack_e5b9g9r9(const std::array<float, 3>& rgb) noexcept;
[[nodiscard]] std::array<float, 3> unpack_e5b9g9r9(std::uint32_t texel) noexcept;

/// The sRGB transfer function's inverse (IEC 61966-2-1) for an encoded value in [0, 1]; error below 1e-15.
[[nodiscard]] double linear_from_srgb(double encoded) noexcept;

/// `value` raised to 2.2, for values in [0, 1]; relative error below 1e-15, the same bits everywhere.
[[nodiscard]] double power_2_2(double value) noexcept;

// An image's rows, and the same as RGB floats that can be looked up at random.

/// First texel of a row, whichever way the rows run.
[[nodiscard]] const void* row_of(const LatLongView& view, int row) noexcept;
[[nodiscard]] const void* row_of(const CubemapView& view, int face, int row) noexcept;

/// RGB floats: the caller's own where they are that already, else a decoded copy.
class FloatPlane {
 public:
  /// Decodes in the caller's arena. Throws `Error` (cancelled).
  explicit FloatPlane(const LatLongView& view, const Control& control = {});
  FloatPlane(const CubemapView& view, int face);

  /// Three values.
  [[nodiscard]] const float* texel(int column, int row) const noexcept {
    return first_ + row * row_floats_ + std::ptrdiff_t{3} * column;
  }
  /// Floats from a row to the next.
  [[nodiscard]] std::ptrdiff_t row_floats() const noexcept { return row_floats_; }

 private:
  template <typename RowOf>
  FloatPlane(PixelFormat format, int width, int height, const RowOf& address_of_row, jobs::Placement placement,
             const Control& control);

  std::unique_ptr<float[]> decoded_;
  const float* first_ = nullptr;
  std::ptrdiff_t row_floats_ = 0;
};

// Refuses views that no call can work on, before any work.

inline constexpr int kLargestFace = 16384;
inline constexpr int kLargestLatLongWidth = 65536;
inline constexpr int kLargestLatLongHeight = 32768;

/// Throws `Error` (invalid_argument), with the argument's name, unless it is from `low` to `high`.
void require_range(const char* what, std::int64_t value, std::int64_t low, std::int64_t high);

/// All throw `Error` (invalid_argument) with a message that says what was found and what is allowed.
void check_face_size(int size);
void check_lat_long_size(int width, int height);
void check_view(const CubemapView& cubemap);
/// Largest first, each half the one before (rounded down); one at least.
void check_chain(std::span<const CubemapView> mips);
void check_view(const LatLongView& lat_long);
void check_view(const EnvironmentView& environment);

/// Returns `work` of the view that `environment` holds.
template <class Work>
decltype(auto) with_view(const EnvironmentView& environment, const Work& work) {
  return environment.kind() == EnvironmentKind::cubemap ? work(environment.cubemap()) : work(environment.lat_long());
}

// Resampling into memory that is there already.

/// Writes what `to_cubemap` without a turn returns to a level. The view is checked already. Throws `Error` (cancelled).
void fill_cubemap(const LatLongView& source, Cubemap& cubemap, int level, ResampleFilter filter,
                  const Control& control);

/// Writes width x height RGB floats, packed: each texel is the mean of the cube's texels, taken as areas of one value
/// each, over its own area (edges in steps as CubeTiling has them). Every texel of the cube keeps its total radiance to
/// rounding, and so does a uniform cube its value to 2e-7: what the prefilter's transform wants, and not smooth where
/// the lat-long is finer than the cube. Takes 24 bytes per texel of the result. The view and the sizes are checked
/// already. The same bits on any number of threads. Throws `Error` (cancelled).
void fill_lat_long_by_area(const CubemapView& source, int width, int height, float* rgb, const Control& control);

/// Six packed faces of RGB floats that lie one after the other.
[[nodiscard]] CubemapView packed_cubemap(const float* pixels, int size) noexcept;

/// Returns `cubemap` if it has `size` and `levels`, else a new one that has, its pixels not initialized.
[[nodiscard]] Cubemap shaped(Cubemap cubemap, int size, int levels, memory_resource* memory);

/// The six faces of a level.
[[nodiscard]] std::array<float*, 6> faces_of(Cubemap& cubemap, int level) noexcept;

}  // namespace welkin::image
