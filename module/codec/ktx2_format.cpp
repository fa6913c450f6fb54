#include "codec/ktx2_format.h"

#include <algorithm>
#include <bit>
#include <string>

#include "codec/little_endian.h"

namespace welkin::codec {
namespace {

struct VulkanFormat {
  TexelKind kind;
  std::uint32_t number;
};

constexpr std::array kVulkanFormats{
    VulkanFormat{TexelKind::rgba16f, 97},     // VK_FORMAT_R16G16B16A16_SFLOAT
    VulkanFormat{TexelKind::rgba32f, 109},    // VK_FORMAT_R32G32B32A32_SFLOAT
    VulkanFormat{TexelKind::b10g11r11, 122},  // VK_FORMAT_B10G11R11_UFLOAT_PACK32
    VulkanFormat{TexelKind::e5b9g9r9, 123},   // VK_FORMAT_E5B9G9R9_UFLOAT_PACK32
    VulkanFormat{TexelKind::rgba8, 37},       // VK_FORMAT_R8G8B8A8_UNORM
    VulkanFormat{TexelKind::rgba8_srgb, 43},  // VK_FORMAT_R8G8B8A8_SRGB
};

// Channel numbers of the RGBSDA colour model, and the qualifiers beside them in the upper four bits of the byte.
constexpr std::uint32_t kRed = 0, kGreen = 1, kBlue = 2, kAlpha = 15;
constexpr std::uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;

/// Some bits of a texel.
struct Sample {
  std::uint32_t first_bit;
  std::uint32_t bits;
  std::uint32_t channel;  ///< with its qualifiers
  std::uint32_t lower;    ///< the number that stands for 0, or for -1 if signed; of an exponent its bias
  std::uint32_t upper;    ///< the number that stands for 1; of an exponent the largest one
};

std::vector<Sample> float_samples(std::uint32_t bits) {
  const auto lower = std::bit_cast<std::uint32_t>(-1.0F);
  const auto upper = std::bit_cast<std::uint32_t>(1.0F);
  std::vector<Sample> samples;
  for (const std::uint32_t channel : {kRed, kGreen, kBlue, kAlpha}) {
    const auto place = static_cast<std::uint32_t>(samples.size()) * bits;
    samples.push_back({place, bits, channel | kFloat | kSigned, lower, upper});
  }
  return samples;
}

std::vector<Sample> packed_float_samples() {
  const auto upper = std::bit_cast<std::uint32_t>(1.0F);
  return {{0, 11, kRed | kFloat, 0, upper}, {11, 11, kGreen | kFloat, 0, upper}, {22, 10, kBlue | kFloat, 0, upper}};
}

std::vector<Sample> shared_exponent_samples() {
  constexpr std::uint32_t one = 16U << 9U | 256U;  // 1 as exponent and mantissa
  std::vector<Sample> samples;
  for (const std::uint32_t channel : {kRed, kGreen, kBlue}) {
    samples.push_back({9 * channel, 9, channel, 0, one});
    samples.push_back({27, 5, channel | kExponent, 15, 31});
  }
  return samples;
}

std::vector<Sample> samples_of(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba16f: return float_samples(16);
    case TexelFormat::rgba32f: return float_samples(32);
    case TexelFormat::b10g11r11: return packed_float_samples();
    case TexelFormat::e5b9g9r9: return shared_exponent_samples();
  }
  return {};
}

}  // namespace

std::uint32_t vulkan_format(TexelKind kind) noexcept {
  const auto* found =
      std::find_if(kVulkanFormats.begin(), kVulkanFormats.end(), [kind](const auto& f) { return f.kind == kind; });
  return found->number;
}

std::optional<TexelKind> kind_of_vulkan_format(std::uint32_t format) noexcept {
  for (const VulkanFormat& known : kVulkanFormats) {
    if (known.number == format) return known.kind;
  }
  return std::nullopt;
}

std::uint32_t ktx2_type_size(TexelKind kind) noexcept {
  switch (kind) {
    case TexelKind::rgba16f: return 2;
    case TexelKind::rgba32f:
    case TexelKind::b10g11r11:
    case TexelKind::e5b9g9r9: return 4;
    case TexelKind::rgba8:
    case TexelKind::rgba8_srgb: return 1;
  }
  return 1;
}

std::uint32_t ktx2_scheme(Supercompression supercompression) noexcept {
  switch (supercompression) {
    case Supercompression::none: return 0;
    case Supercompression::zstd: return 2;
    case Supercompression::zlib: return 3;
  }
  return 0;
}

std::optional<Supercompression> supercompression_of_ktx2(std::uint32_t scheme) noexcept {
  for (const auto known : {Supercompression::none, Supercompression::zlib, Supercompression::zstd}) {
    if (ktx2_scheme(known) == scheme) return known;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> ktx2_descriptor(TexelFormat format, Supercompression supercompression) {
  constexpr std::uint32_t version = 2;         // of Data Format 1.3
  constexpr std::uint32_t model_rgbsda = 1;    // red, green, blue, stencil, depth, alpha
  constexpr std::uint32_t primaries_srgb = 1;  // Rec. 709's
  constexpr std::uint32_t transfer_linear = 1;
  const std::vector<Sample> samples = samples_of(format);
  const auto block_bytes = static_cast<std::uint32_t>(24 + 16 * samples.size());
  // A packed level has no fixed bytes a texel, and KTX 2.0 wants 0 there.
  const auto plane_bytes = supercompression == Supercompression::none ? texel_bytes(kind_of(format)) : 0;

  std::vector<std::uint8_t> bytes;
  append_little_endian(bytes, block_bytes + 4);
  append_little_endian(bytes, std::uint32_t{0});  // Khronos, basic format
  append_little_endian(bytes, version | block_bytes << 16U);
  append_little_endian(bytes, model_rgbsda | primaries_srgb << 8U | transfer_linear << 16U);
  append_little_endian(bytes, std::uint32_t{0});  // blocks of 1 x 1 x 1 x 1 texels, each less one
  append_little_endian(bytes, static_cast<std::uint64_t>(plane_bytes));  // of the first plane of eight
  for (const Sample& sample : samples) {
    append_little_endian(bytes, sample.first_bit | (sample.bits - 1) << 16U | sample.channel << 24U);
    append_little_endian(bytes, std::uint32_t{0});  // its place in the block
    append_little_endian(bytes, sample.lower);
    append_little_endian(bytes, sample.upper);
  }
  return bytes;
}

}  // namespace welkin::codec
