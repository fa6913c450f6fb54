// Gain maps: what makes a JPEG's ordinary picture one of high dynamic range.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace welkin::files {

/// How the samples of a gain map change those of the base picture, by channel. (ISO 21496-1:2025, 5.2; Android's Ultra
/// HDR image format 1.1, whose XMP has the same numbers.)
///
///   gain = minimum + (maximum - minimum) sample^(1 / gamma)
///   result = (base + base_offset) 2^gain - alternate_offset
///
/// with samples from 0 to 1 and linear colours, of which 1 is the white of ordinary pictures.
struct GainMap {
  bool by_iso = false;                         ///< else by XMP
  bool from_base = true;                       ///< the base is the ordinary picture
  std::array<double, 3> minimum{}, maximum{};  ///< base-2 logarithms
  std::array<double, 3> gamma{1.0, 1.0, 1.0};
  std::array<double, 3> base_offset{1.0 / 64, 1.0 / 64, 1.0 / 64};
  std::array<double, 3> alternate_offset{1.0 / 64, 1.0 / 64, 1.0 / 64};
};

/// From the XMP packet of a gain map's own JPEG. Nothing if the packet is about other things.
/// Throws `Error` (corrupt_file) for numbers that are missing, no numbers, or out of range.
[[nodiscard]] std::optional<GainMap> gain_map_from_xmp(std::string_view packet, const std::filesystem::path& path);

/// From the bytes of ISO 21496-1's segment, after its name. Nothing if they hold a version alone, as in the base
/// picture. Throws `Error`: corrupt_file as above, unsupported_file for a later
/// version.
[[nodiscard]] std::optional<GainMap> gain_map_from_iso(std::span<const std::uint8_t> bytes,
                                                       const std::filesystem::path& path);

/// Factors 2^gain of samples of 8 bits, or of values between them.
class GainCurve {
 public:
  explicit GainCurve(const GainMap& map);

  /// The factor of a sample, 0 to 255, of a channel: the same bits everywhere.
  [[nodiscard]] double factor(std::size_t channel, double sample) const noexcept;

 private:
  std::array<double, 3> minimum_{}, range_{}, exponent_{};  // in natural logarithms
};

}  // namespace welkin::files
