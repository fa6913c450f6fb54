// Seeded environments for tests, bit-identical on every machine and in test_environments.mjs (for the Babylon.js
// recorder): they use only + - * / sqrt, comparisons and 32-bit integers, then one rounding to float.
#pragma once

#include <Imath/half.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "welkin/image.h"

namespace welkin::test {

/// The contents of the texels. Alpha, where present, is a number above 1000, or NaN in the two kinds with NaN: it must
/// never matter. Odd values are about one in seven; on environments of 2000 texels and more, one in 200.
enum class Content {
  random,          ///< noise in [0, 1)
  smooth,          ///< sky over ground, 0.1 to 1.8
  high_range,      ///< smooth, a long tail up to 200, and a wide sun of 3000
  clamped,         ///< noise up to 20000, two values in five above 4096
  sun_disc,        ///< smooth, with a sun of 60000, 3.6 degrees in radius (below 64 texels it may fall between them)
  gamma_encoded,   ///< noise in [-0.2, 1.3)
  special_values,  ///< noise among NaN, both infinities, -1, -0, a denormal, 4096, 1e30, -1e30, 3e38
  nan_bearing,     ///< noise among NaN, -1, -0, a denormal, 5; no infinities
  blocks,          ///< 4 x 4 constant squares per face (8 x 4 on a lat-long), 0.01 or noise up to 10
  uniform,         ///< 0.5, 1, 2 everywhere
  one_texel_sun,   ///< noise in [0, 1), and one texel of 1e6
};

/// Return the enumerator's name, and the inverse (throws std::invalid_argument on an unknown name).
[[nodiscard]] std::string_view name(Content content);
[[nodiscard]] Content content_named(std::string_view name);

/// Six faces one after the other in the order +X -X +Y -Y +Z -Z, interleaved, packed.
template <class Channel>
struct BasicTestCubemap {
  int size = 0;
  int channels = 3;
  std::vector<Channel> pixels;

  /// Returns a view of `pixels`, valid as long as they are not moved. 8-bit pixels are viewed as linear.
  [[nodiscard]] CubemapView view() const;
};

using TestCubemap = BasicTestCubemap<float>;
using TestCubemapHalf = BasicTestCubemap<Imath::half>;
using TestCubemapBytes = BasicTestCubemap<std::uint8_t>;

/// Makes a cubemap: `size` >= 1, `channels` 3 or 4. Directions are in the frames of CubemapView.
[[nodiscard]] TestCubemap make_cubemap(Content content, int size, int channels, std::uint32_t seed);

/// Makes `make_cubemap`'s image rounded to the nearest half float. Values above 65504 become infinite.
[[nodiscard]] TestCubemapHalf make_cubemap_half(Content content, int size, int channels, std::uint32_t seed);

/// Makes `make_cubemap`'s image in bytes: 0..1 in 256 equal steps; values outside, and NaN, are clamped to the ends.
[[nodiscard]] TestCubemapBytes make_cubemap_bytes(Content content, int size, int channels, std::uint32_t seed);

/// Rows from the top, interleaved, packed.
template <class Channel>
struct BasicTestLatLong {
  int width = 0;
  int height = 0;
  int channels = 3;
  std::vector<Channel> pixels;

  [[nodiscard]] LatLongView view() const;
};

using TestLatLong = BasicTestLatLong<float>;
using TestLatLongHalf = BasicTestLatLong<Imath::half>;
using TestLatLongBytes = BasicTestLatLong<std::uint8_t>;

/// Make the same kinds on a lat-long. A kind that depends on direction uses the texel's to within a few degrees: a
/// parabola replaces the sine, on which two machines may differ.
[[nodiscard]] TestLatLong make_lat_long(Content content, int width, int height, std::uint32_t seed, int channels = 3);
[[nodiscard]] TestLatLongHalf make_lat_long_half(Content content, int width, int height, std::uint32_t seed,
                                                 int channels = 3);
[[nodiscard]] TestLatLongBytes make_lat_long_bytes(Content content, int width, int height, std::uint32_t seed,
                                                   int channels = 3);

/// Returns FNV-1a over the channels' bits, every NaN taken as 7fc00000: equal to that of test_environments.mjs.
[[nodiscard]] std::uint32_t checksum(const std::vector<float>& pixels);
[[nodiscard]] std::uint32_t checksum(const std::vector<std::uint8_t>& pixels);

}  // namespace welkin::test
