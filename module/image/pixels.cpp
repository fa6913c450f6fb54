#include "image/pixels.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "image/image_kernels.h"
#include "jobs/tiles.h"
#include "platform/compiler.h"
#include "platform/file.h"
#include "platform/standard_library.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {
namespace {

/// x^(1/5) for x in (0, 1], by Newton from a guess that divides the exponent by five. libm's pow would give
/// other last bits on other machines.
constexpr double fifth_root(double x) noexcept {
  // The bits of a double are close to its logarithm; 4/5 of the bits of 1.0 puts the exponent's bias back.
  constexpr auto bits_of_one = platform::bit_cast<std::uint64_t>(1.0);
  auto root = platform::bit_cast<double>(platform::bit_cast<std::uint64_t>(x) / 5 + bits_of_one / 5 * 4);
  for (int step = 0; step < 5; ++step) {  // from 6 % off, quadratically: 1e-2, 2e-4, 1e-7, 1e-14, rounding
    const double squared = root * root;
    root -= 0.2 * (root - x / (squared * squared));
  }
  return root;
}

constexpr double decoded_srgb(double encoded) noexcept {
  if (encoded <= 0.04045) return encoded / 12.92;
  const double t = (encoded + 0.055) / 1.055;  // t^2.4 = t^2 (t^(1/5))^2
  const double root = fifth_root(t);
  return t * t * (root * root);
}

constexpr ByteValues decoded_bytes() {
  ByteValues values{};
  for (int i = 0; i < 256; ++i) values.of[i] = static_cast<float>(decoded_srgb(static_cast<double>(i) / 255.0));
  return values;
}
ByteValues decoded_bytes_at_start() { return decoded_bytes(); }

// One load for several bytes: with one for each rgb takes 1.2 times, rgba 1.6 times as long (Zen 3).
void decode_srgb(const void* texels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint8_t*>(texels);
  const std::ptrdiff_t numbers = std::ptrdiff_t{3} * count;
  std::ptrdiff_t k = 0;
  for (; k + 8 <= numbers; k += 8) {
    auto word = platform::read_little_endian<std::uint64_t>(from + k);
    for (int i = 0; i < 8; ++i, word >>= 8U) rgb[k + i] = kLinearFromSrgb.of[word & 0xFFU];
  }
  for (; k < numbers; ++k) rgb[k] = kLinearFromSrgb.of[from[k]];
}

void decode_srgba(const void* texels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint8_t*>(texels);
  for (int i = 0; i < count; ++i, from += 4, rgb += 3) {
    const auto word = platform::read_little_endian<std::uint32_t>(from);
    for (unsigned c = 0; c < 3; ++c) rgb[c] = kLinearFromSrgb.of[(word >> (8U * c)) & 0xFFU];
  }
}

// value / 255, rounded once. 1 / 255 = 2^-8 + 2^-16 + 2^-24 + ...: eight bits times the first two terms are exact, and
// the rest is too small for its own rounding to be seen. Two products and a sum vectorize where a division is slow.
constexpr float unit_from_byte(std::uint8_t byte) noexcept {
  constexpr float kFirstTerms = 0x1.01p-8F;
  constexpr auto kRest = static_cast<float>(1.0 / 255.0 - 0x1.01p-8);
  const auto value = static_cast<float>(byte);
  return value * kFirstTerms + value * kRest;
}

constexpr bool all_bytes_round_once() {
  for (int i = 0; i < 256; ++i) {
    if (unit_from_byte(static_cast<std::uint8_t>(i)) != static_cast<float>(i / 255.0)) return false;
  }
  return true;
}
static_assert(all_bytes_round_once());

void decode_rgb(const void* texels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint8_t*>(texels);
  for (int k = 0; k < 3 * count; ++k) rgb[k] = unit_from_byte(from[k]);
}

void decode_rgba(const void* texels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint8_t*>(texels);
  for (int i = 0; i < count; ++i, from += 4, rgb += 3) {
    for (int c = 0; c < 3; ++c) rgb[c] = unit_from_byte(from[c]);
  }
}

constexpr int kHalvesBlock = 64;  ///< texels that are converted at a time

void decode_half(const void* texels, int channels, int count, float* rgb) noexcept {
  const auto* from = static_cast<const std::uint16_t*>(texels);
  constexpr int few = 4;
  for (; count <= few && count > 0; --count, from += channels)
    rgb = std::transform(from, from + 3, rgb, float_from_half);
  if (channels == 3) return half_kernels().floats_of_halves(from, 3 * count, rgb);
  std::array<float, 4 * kHalvesBlock> block;
  for (int first = 0; first < count; first += kHalvesBlock, from += 4 * kHalvesBlock) {
    const int here = std::min(kHalvesBlock, count - first);
    half_kernels().floats_of_halves(from, 4 * here, block.data());
    for (const float* texel = block.data(); texel != block.data() + 4 * here; texel += 4)
      rgb = std::copy_n(texel, 3, rgb);
  }
}

}  // namespace

float float_from_half(std::uint16_t half) noexcept {
  // Exponent and mantissa in a float's places are the value times 2^-112, denormals too; multiplying by a
  // power of two is exact.
  const std::uint32_t magnitude = half & 0x7FFFU;
  const std::uint32_t sign = (half & 0x8000U) << 16U;
  if (magnitude >= 0x7C00U) return platform::bit_cast<float>(sign | 0x7F800000U | (magnitude << 13U));
  const float scaled = platform::bit_cast<float>(magnitude << 13U) * 0x1p112F;
  return platform::bit_cast<float>(sign | platform::bit_cast<std::uint32_t>(scaled));
}

namespace {

template <int Channels, int Targets, class Channel>
void write_texels(const Channel* values, std::size_t count, Channel one, std::byte* to) noexcept {
  constexpr std::size_t copied = std::min(Channels, Targets) * sizeof(Channel);
  constexpr std::size_t whole = Targets * sizeof(Channel);
  constexpr std::size_t first = std::min(Channels, Targets);
  const std::array<Channel, 5> rest{Channel{}, Channel{}, Channel{}, one};
  for (std::size_t i = 0; i < count; ++i, values += Channels, to += whole) {
    std::memcpy(to, values, copied);
    std::memcpy(to + copied, rest.data() + first, whole - copied);
  }
}

/// Copies of a length that is not known take several times as long.
template <class Channel>
void write_texels(const Channel* values, int channels, std::size_t count, int targets, Channel one,
                  std::byte* to) noexcept {
  if (channels == targets) {
    std::memcpy(to, values, count * static_cast<std::size_t>(channels) * sizeof(Channel));
  } else if (channels == 3) {
    targets == 4 ? write_texels<3, 4>(values, count, one, to) : write_texels<3, 2>(values, count, one, to);
  } else {
    targets == 4 ? write_texels<2, 4>(values, count, one, to) : write_texels<2, 3>(values, count, one, to);
  }
}

std::uint64_t write_halves(const float* values, int channels, std::size_t count, TexelLayout layout,
                           std::byte* to) noexcept {
  constexpr std::uint16_t one = 0x3C00;
  const int kept = std::min(channels, layout.channels);
  std::array<float, 4 * kHalvesBlock> block;
  std::array<std::uint16_t, 4 * kHalvesBlock> halves;
  std::uint64_t changed = 0;
  for (std::size_t first = 0; first < count; first += kHalvesBlock) {
    const std::size_t here = std::min<std::size_t>(kHalvesBlock, count - first);
    const int numbers = kept * static_cast<int>(here);
    const float* from = values;
    if (kept < channels) {  // what is not written is not counted
      for (std::size_t i = 0; i < here; ++i)
        std::copy_n(values + i * static_cast<std::size_t>(channels), kept,
                    block.data() + i * static_cast<std::size_t>(kept));
      from = block.data();
    }
    changed += static_cast<std::uint64_t>(half_kernels().halves_of_floats(from, numbers, halves.data()));
    write_texels(halves.data(), kept, here, layout.channels, one, to);
    values += here * static_cast<std::size_t>(channels);
    to += here * layout.texel_bytes();
  }
  return changed;
}

}  // namespace

std::uint64_t encode_texels(const float* values, int channels, std::size_t count, TexelLayout layout,
                            void* texels) noexcept {
  auto* const to = static_cast<std::byte*>(texels);
  if (layout.halves) return write_halves(values, channels, count, layout, to);
  write_texels(values, channels, count, layout.channels, 1.0F, to);
  return 0;
}

// Where code is sent, the loop is shorter than its 1024 bytes, which do not pack.
const ByteValues kLinearFromSrgb = platform::kCodeIsSent ? decoded_bytes_at_start() : decoded_bytes();

double linear_from_srgb(double encoded) noexcept { return decoded_srgb(encoded); }

double power_2_2(double value) noexcept {
  if (value <= 0.0) return 0.0;
  return value * value * fifth_root(value);
}

void decode_texels(PixelFormat format, const void* texels, int count, float* rgb) noexcept {
  switch (format) {
    case PixelFormat::rgb32f: std::memcpy(rgb, texels, static_cast<std::size_t>(count) * 3 * sizeof(float)); return;
    case PixelFormat::rgba32f: {
      const auto* from = static_cast<const float*>(texels);
      for (int i = 0; i < count; ++i, from += 4, rgb += 3) std::memcpy(rgb, from, 3 * sizeof(float));
      return;
    }
    case PixelFormat::rgb16f: return decode_half(texels, 3, count, rgb);
    case PixelFormat::rgba16f: return decode_half(texels, 4, count, rgb);
    case PixelFormat::rgb8: return decode_rgb(texels, count, rgb);
    case PixelFormat::rgba8: return decode_rgba(texels, count, rgb);
    case PixelFormat::srgb8: return decode_srgb(texels, count, rgb);
    case PixelFormat::srgba8: return decode_srgba(texels, count, rgb);
  }
}

namespace {

const void* row_at(const void* pixels, std::ptrdiff_t stride, PixelFormat format, int width, int row) noexcept {
  const std::ptrdiff_t packed = static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  return static_cast<const std::byte*>(pixels) + (stride != 0 ? stride : packed) * row;
}

}  // namespace

const void* row_of(const LatLongView& view, int row) noexcept {
  return row_at(view.pixels, view.row_stride_bytes, view.format, view.width, row);
}

const void* row_of(const CubemapView& view, int face, int row) noexcept {
  return row_at(view.faces[static_cast<std::size_t>(face)], view.row_stride_bytes, view.format, view.size, row);
}

template <typename RowOf>
FloatPlane::FloatPlane(PixelFormat format, int width, int height, const RowOf& address_of_row,
                       jobs::Placement placement, const Control& control)
    : row_floats_(std::ptrdiff_t{3} * width) {
  if (format == PixelFormat::rgb32f) {
    first_ = static_cast<const float*>(address_of_row(0));
    if (height > 1) row_floats_ = static_cast<const float*>(address_of_row(1)) - first_;
    return;
  }
  constexpr int kTileTexels = 32768;
  decoded_ = platform::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(row_floats_ * height));
  const int tile_rows = std::max(1, kTileTexels / width);
  jobs::run_rows(height, tile_rows, placement, jobs::worker_count(placement), control, [&](int row, std::size_t) {
    decode_texels(format, address_of_row(row), width, decoded_.get() + row * row_floats_);
  });
  first_ = decoded_.get();
}

FloatPlane::FloatPlane(const LatLongView& view, const Control& control)
    : FloatPlane(
          view.format, view.width, view.height, [&](int row) { return row_of(view, row); },
          jobs::placement_for(std::int64_t{view.width} * view.height), control) {}

FloatPlane::FloatPlane(const CubemapView& view, int face)
    : FloatPlane(
          view.format, view.size, view.size, [&](int row) { return row_of(view, face, row); },
          jobs::Placement::calling_thread, Control{}) {}

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

std::size_t channel_bytes(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb32f:
    case PixelFormat::rgba32f: return 4;
    case PixelFormat::rgb16f:
    case PixelFormat::rgba16f: return 2;
    default: return 1;
  }
}

void require_pixels(const std::string& what, const void* pixels, PixelFormat format) {
  if (pixels == nullptr) refuse(what + " has no pixels: its pointer is null; pass the address of its first texel");
  if (reinterpret_cast<std::uintptr_t>(pixels) % channel_bytes(format) != 0) {
    refuse(what + " is not aligned to its channels, which take " + std::to_string(channel_bytes(format)) +
           " bytes each");
  }
}

void require_stride(std::ptrdiff_t stride, int width, PixelFormat format) {
  const auto row = static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  if (row == 0)
    refuse("the pixel format " + std::to_string(static_cast<int>(format)) +
           " is unknown; pass an enumerator of PixelFormat");
  if (stride == 0) return;
  if (std::abs(stride) < row) {
    refuse("row_stride_bytes is " + std::to_string(stride) + ", less than a row of " + std::to_string(row) +
           " bytes; pass 0 for packed rows, or at least that");
  }
  if (stride % static_cast<std::ptrdiff_t>(channel_bytes(format)) != 0) {
    refuse("row_stride_bytes is " + std::to_string(stride) + ", which leaves rows unaligned to their channels of " +
           std::to_string(channel_bytes(format)) + " bytes");
  }
}

}  // namespace

void require_range(const char* what, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  refuse(std::string(what) + " is " + std::to_string(value) + "; it must be from " + std::to_string(low) + " to " +
         std::to_string(high));
}

void check_face_size(int size) { require_range("the cubemap's size", size, 1, kLargestFace); }

void check_lat_long_size(int width, int height) {
  require_range("the lat-long's width", width, 1, kLargestLatLongWidth);
  require_range("the lat-long's height", height, 1, kLargestLatLongHeight);
}

void check_view(const CubemapView& cubemap) {
  check_face_size(cubemap.size);
  require_stride(cubemap.row_stride_bytes, cubemap.size, cubemap.format);
  for (std::size_t face = 0; face < cubemap.faces.size(); ++face) {
    require_pixels("face " + std::to_string(face) + " of the cubemap", cubemap.faces[face], cubemap.format);
  }
}

void check_chain(std::span<const CubemapView> mips) {
  if (mips.empty()) throw Error(ErrorCode::invalid_argument, "a texture needs a level at least; none was passed");
  for (const CubemapView& view : mips) check_view(view);
  const int size = mips.front().size;
  const auto most = static_cast<std::size_t>(full_chain_levels(size));
  if (mips.size() > most) {
    throw Error(ErrorCode::invalid_argument, std::to_string(mips.size()) + " levels were passed; from " +
                                                 std::to_string(size) + " texels down there are " +
                                                 std::to_string(most));
  }
  for (std::size_t level = 0; level < mips.size(); ++level) {
    const int wanted = std::max(1, size >> static_cast<int>(level));
    if (mips[level].size != wanted) {
      throw Error(ErrorCode::invalid_argument, "level " + std::to_string(level) + " has " +
                                                   std::to_string(mips[level].size) + " texels along an edge; below " +
                                                   std::to_string(size) + " it must have " + std::to_string(wanted));
    }
  }
}

void check_view(const LatLongView& lat_long) {
  check_lat_long_size(lat_long.width, lat_long.height);
  require_stride(lat_long.row_stride_bytes, lat_long.width, lat_long.format);
  require_pixels("the lat-long", lat_long.pixels, lat_long.format);
}

void check_view(const EnvironmentView& environment) {
  with_view(environment, [](const auto& view) { check_view(view); });
}

}  // namespace welkin::image

namespace welkin {

LatLongView EnvironmentView::lat_long() const {
  if (const LatLongView* const view = std::get_if<LatLongView>(&view_)) return *view;
  throw Error(ErrorCode::invalid_argument, "the environment is a cubemap, not a lat-long; resample it (to_lat_long)");
}

CubemapView EnvironmentView::cubemap() const {
  if (const CubemapView* const view = std::get_if<CubemapView>(&view_)) return *view;
  throw Error(ErrorCode::invalid_argument, "the environment is a lat-long, not a cubemap; resample it (to_cubemap)");
}

}  // namespace welkin
