// Pixels on their way out: texels as graphics APIs hold them, in memory of the caller's.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "welkin/core.h"

namespace welkin::image {
namespace {

template <typename Pack>
std::uint64_t encode_packed(const float* rgb, std::size_t count, std::uint8_t* texels,
                            const std::array<float, 3>& largest, const Pack& pack) noexcept {
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 4) {
    std::array<float, 3> texel{};
    for (std::size_t c = 0; c < 3; ++c) texel[c] = bounded(rgb[c] + 0.0F, largest[c], clamped);  // -0 is 0
    const std::uint32_t packed = pack(texel);
    std::memcpy(texels, &packed, sizeof packed);
  }
  return clamped;
}

}  // namespace

std::uint64_t encode_texels(TexelFormat format, const float* rgb, std::size_t count, std::uint8_t* texels) noexcept {
  switch (format) {
    case TexelFormat::rgba16f: return encode_texels(rgb, 3, count, {.channels = 4, .halves = true}, texels);
    case TexelFormat::rgba32f: return encode_texels(rgb, 3, count, {.channels = 4}, texels);
    case TexelFormat::b10g11r11:
      return encode_packed(rgb, count, texels, {kLargestFloat11, kLargestFloat11, kLargestFloat10}, pack_b10g11r11);
    case TexelFormat::e5b9g9r9:
      return encode_packed(rgb, count, texels, {kLargestSharedFloat, kLargestSharedFloat, kLargestSharedFloat},
                           pack_e5b9g9r9);
    case TexelFormat::bc6h_ufloat:
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr:
    case TexelFormat::uastc_hdr_4x4: break;  // texels that lie in no row
  }
  return 0;
}

namespace {

constexpr int kFloatMantissaBits = 23;
constexpr int kFloatBias = 127;
constexpr int kSmallestExponent = -14;  // of a normal number with five bits of exponent
constexpr int kHalfMantissaBits = 10;

/// A non-negative finite value as five bits of exponent (bias 15) and `mantissa_bits` below them. Ties to even. In
/// integers, so that no rounding happens twice.
std::uint32_t small_float(float value, int mantissa_bits) noexcept {
  const auto bits = platform::bit_cast<std::uint32_t>(value);
  const int exponent = static_cast<int>(bits >> kFloatMantissaBits) - kFloatBias;
  if (exponent < kSmallestExponent - mantissa_bits - 1) return 0;  // less than half of the least number
  const std::uint32_t significand = (bits & 0x7FFFFFU) | 0x800000U;
  const bool denormal = exponent < kSmallestExponent;
  const int shift = kFloatMantissaBits - mantissa_bits + (denormal ? kSmallestExponent - exponent : 0);
  const std::uint32_t below_half = (1U << (shift - 1)) - 1U;
  const std::uint32_t rounded = (significand + below_half + (significand >> shift & 1U)) >> shift;
  // A normal number's leading one adds 1 to the exponent, and so does a mantissa that was rounded over its end.
  return denormal ? rounded : rounded + (static_cast<std::uint32_t>(exponent - kSmallestExponent) << mantissa_bits);
}

float from_small_float(std::uint32_t bits, int mantissa_bits) noexcept {
  return float_from_half(static_cast<std::uint16_t>(bits << (kHalfMantissaBits - mantissa_bits)));
}

/// 2^exponent, -126 to 127.
float power_of_two(int exponent) noexcept {
  return platform::bit_cast<float>(static_cast<std::uint32_t>(exponent + kFloatBias) << kFloatMantissaBits);
}

}  // namespace

std::uint16_t half_from_float(float value) noexcept {
  const std::uint32_t sign = platform::bit_cast<std::uint32_t>(value) >> 16U & 0x8000U;
  return static_cast<std::uint16_t>(sign | small_float(std::min(std::abs(value), kLargestHalf), kHalfMantissaBits));
}

std::uint32_t pack_b10g11r11(const std::array<float, 3>& rgb) noexcept {
  return small_float(rgb[0], 6) | small_float(rgb[1], 6) << 11U | small_float(rgb[2], 5) << 22U;
}

std::array<float, 3> unpack_b10g11r11(std::uint32_t texel) noexcept {
  return {from_small_float(texel & 0x7FFU, 6), from_small_float(texel >> 11U & 0x7FFU, 6),
          from_small_float(texel >> 22U, 5)};
}

std::uint32_t pack_e5b9g9r9(const std::array<float, 3>& rgb) noexcept {
  constexpr int bits = 9;
  constexpr int bias = 15;
  const float largest = std::max({rgb[0], rgb[1], rgb[2]});
  const int logarithm = static_cast<int>(platform::bit_cast<std::uint32_t>(largest) >> kFloatMantissaBits) - kFloatBias;
  int exponent = std::max(-bias - 1, logarithm) + 1 + bias;
  const auto mantissa = [&exponent](float value) {
    // Scaling by a power of two is exact in double; so is adding a half.
    const double scaled = static_cast<double>(value) * static_cast<double>(power_of_two(bias + bits - exponent));
    return static_cast<std::uint32_t>(scaled + 0.5);
  };
  if (mantissa(largest) == 1U << bits) ++exponent;
  return mantissa(rgb[0]) | mantissa(rgb[1]) << 9U | mantissa(rgb[2]) << 18U |
         static_cast<std::uint32_t>(exponent) << 27U;
}

std::array<float, 3> unpack_e5b9g9r9(std::uint32_t texel) noexcept {
  const float scale = power_of_two(static_cast<int>(texel >> 27U) - 24);
  return {static_cast<float>(texel & 0x1FFU) * scale, static_cast<float>(texel >> 9U & 0x1FFU) * scale,
          static_cast<float>(texel >> 18U & 0x1FFU) * scale};
}

}  // namespace welkin::image

namespace welkin {
namespace {

std::uint64_t bytes_of_texel(TexelFormat format) noexcept {
  switch (format) {
    case TexelFormat::rgba16f: return 8;
    case TexelFormat::rgba32f: return 16;
    case TexelFormat::b10g11r11:
    case TexelFormat::e5b9g9r9: return 4;
    case TexelFormat::bc6h_ufloat:
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr:
    case TexelFormat::uastc_hdr_4x4: break;
  }
  return 0;
}

std::uint64_t rounded_up(std::uint64_t value, std::uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

/// `size`: of the cubemap that goes there.
void check(int size, const CubemapTarget& to) {
  const std::uint64_t texel = bytes_of_texel(to.format);
  if (texel == 0) {
    throw Error(ErrorCode::invalid_argument, "the texel format " + std::to_string(static_cast<int>(to.format)) +
                                                 " is unknown; pass an enumerator of TexelFormat");
  }
  if (to.size != size) {
    throw Error(ErrorCode::invalid_argument, "the target's faces have " + std::to_string(to.size) +
                                                 " texels per edge; the cubemap needs " + std::to_string(size));
  }
  for (std::size_t face = 0; face < to.faces.size(); ++face) {
    if (to.faces[face] == nullptr)
      throw Error(ErrorCode::invalid_argument,
                  "face " + std::to_string(face) + " of the target is null; pass its memory");
  }
  const std::uint64_t row = texel * static_cast<std::uint64_t>(to.size);
  const auto stride = static_cast<std::uint64_t>(to.row_stride_bytes);
  const std::uint64_t pitch = to.row_stride_bytes < 0 ? 0 - stride : stride;
  if (pitch != 0 && pitch < row) {
    throw Error(ErrorCode::invalid_argument, "the target's rows are " + std::to_string(pitch) +
                                                 " bytes apart; pass at least " + std::to_string(row));
  }
}

/// Stores a row, counted over all faces; `scratch` for one of floats. Returns how many values were clamped.
std::uint64_t store_row(const CubemapView& from, const CubemapTarget& to, int row, float* scratch) {
  const auto face = static_cast<std::size_t>(row / from.size);
  const std::ptrdiff_t packed = from.size * static_cast<std::ptrdiff_t>(bytes_of_texel(to.format));
  auto* const target = static_cast<std::uint8_t*>(to.faces[face]) +
                       row % from.size * (to.row_stride_bytes != 0 ? to.row_stride_bytes : packed);
  const void* const source = image::row_of(from, row / from.size, row % from.size);
  const float* rgb = scratch;
  if (from.format == PixelFormat::rgb32f) {
    rgb = static_cast<const float*>(source);
  } else {
    image::decode_texels(from.format, source, from.size, scratch);
  }
  return image::encode_texels(to.format, rgb, static_cast<std::size_t>(from.size), target);
}

/// Some 16 000 texels a tile.
std::uint64_t store_level(const CubemapView& from, const CubemapTarget& to, const Control& control) {
  image::check_view(from);
  check(from.size, to);
  constexpr int kTexelsOfTile = 16'384;
  const int rows = 6 * from.size;
  const int tile_rows = std::max(1, kTexelsOfTile / from.size);
  const auto placement = jobs::placement_for(std::int64_t{rows} * from.size);
  const std::size_t workers = jobs::worker_count(placement);
  const std::size_t row_values = 3 * static_cast<std::size_t>(from.size);
  std::vector<float> scratch(workers * row_values);
  std::atomic<std::uint64_t> clamped{0};
  jobs::run_rows(rows, tile_rows, placement, workers, control, [&](int row, std::size_t worker) {
    clamped.fetch_add(store_row(from, to, row, scratch.data() + worker * row_values), std::memory_order_relaxed);
  });
  return clamped.load();
}

void check(const UploadLayout& layout) {
  image::require_range("size", layout.size, 1, image::kLargestFace);
  image::require_range("levels", layout.levels, 1, full_chain_levels(layout.size));
  if (bytes_of_texel(layout.format) == 0 || layout.row_alignment_bytes == 0 || layout.level_alignment_bytes == 0) {
    throw Error(ErrorCode::invalid_argument, "an upload layout needs a known format and alignments of at least 1 byte");
  }
}

/// Where the next image of one face and level goes, and how far its rows are apart.
struct Placement {
  std::uint64_t offset;
  std::uint64_t pitch;
};

/// Calls `place(level, face, placement)` in the layout's order; returns the bytes of all.
template <class Place>
std::uint64_t lay_out(const UploadLayout& layout, const Place& place) {
  std::uint64_t end = 0;
  const auto put = [&](int level, int face) {
    const auto edge = static_cast<std::uint64_t>(std::max(1, layout.size >> level));
    const std::uint64_t pitch = rounded_up(edge * bytes_of_texel(layout.format), layout.row_alignment_bytes);
    const std::uint64_t offset = rounded_up(end, layout.level_alignment_bytes);
    place(level, face, Placement{offset, pitch});
    end = offset + pitch * edge;
  };
  const bool by_level = layout.order == UploadOrder::level_by_level;
  const int outer = by_level ? layout.levels : 6;
  const int inner = by_level ? 6 : layout.levels;
  for (int a = 0; a < outer; ++a) {
    for (int b = 0; b < inner; ++b) put(by_level ? a : b, by_level ? b : a);
  }
  return end;
}

}  // namespace

void image::check_chain_targets(const char* what, int size, int levels, std::span<const CubemapTarget> targets) {
  if (static_cast<std::size_t>(levels) != targets.size()) {
    throw Error(ErrorCode::invalid_argument, "the " + std::string(what) + " has " + std::to_string(levels) +
                                                 (levels == 1 ? " level" : " levels") + ", and there are " +
                                                 std::to_string(targets.size()) + " targets; pass one per level");
  }
  for (std::size_t level = 0; level < targets.size(); ++level) check(std::max(1, size >> level), targets[level]);
}

std::uint64_t store_texels(const CubemapView& from, const CubemapTarget& to, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return store_level(from, to, control);
}

std::uint64_t store_texels(const Cubemap& from, std::span<const CubemapTarget> to, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain_targets("chain", from.size(), from.levels(), to);
  std::uint64_t clamped = 0;
  double done = 0.0;
  const auto whole = static_cast<double>(from.bytes());
  for (int level = 0; level < from.levels(); ++level) {
    const double edge = from.level_size(level);
    const double next = std::min(1.0, done + 18.0 * sizeof(float) * edge * edge / whole);
    const bool last = level + 1 == from.levels();
    clamped += store_level(from.view(level), to[static_cast<std::size_t>(level)],
                           jobs::part_of(control, done, last ? 1.0 : next));
    done = next;
  }
  return clamped;
}

std::uint64_t upload_bytes(const UploadLayout& layout) {
  const platform::FloatingPointScope floating_point;
  check(layout);
  return lay_out(layout, [](int, int, const Placement&) {});
}

std::vector<CubemapTarget> upload_targets(const UploadLayout& layout, std::span<std::byte> memory) {
  const platform::FloatingPointScope floating_point;
  const std::uint64_t bytes = upload_bytes(layout);
  if (memory.size() < bytes) {
    throw Error(ErrorCode::invalid_argument, "the layout takes " + std::to_string(bytes) +
                                                 " bytes, and the memory has " + std::to_string(memory.size()) +
                                                 "; pass upload_bytes(layout)");
  }
  std::vector<CubemapTarget> targets(static_cast<std::size_t>(layout.levels));
  lay_out(layout, [&](int level, int face, const Placement& placement) {
    CubemapTarget& target = targets[static_cast<std::size_t>(level)];
    target.faces[static_cast<std::size_t>(face)] = memory.data() + placement.offset;
    target.size = std::max(1, layout.size >> level);
    target.row_stride_bytes = static_cast<std::ptrdiff_t>(placement.pitch);
    target.format = layout.format;
  });
  return targets;
}

}  // namespace welkin
