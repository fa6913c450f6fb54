#include "support/test_environments.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace welkin::test {
namespace {

using Vector = std::array<double, 3>;

struct Frame {
  Vector normal, along, down;
};

constexpr std::array<Frame, 6> kFrames{{
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
    {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}},
}};

constexpr std::array<std::pair<Content, std::string_view>, 11> kNames{{
    {Content::random, "random"},
    {Content::smooth, "smooth"},
    {Content::high_range, "high_range"},
    {Content::clamped, "clamped"},
    {Content::sun_disc, "sun_disc"},
    {Content::gamma_encoded, "gamma_encoded"},
    {Content::special_values, "special_values"},
    {Content::nan_bearing, "nan_bearing"},
    {Content::blocks, "blocks"},
    {Content::uniform, "uniform"},
    {Content::one_texel_sun, "one_texel_sun"},
}};

/// A bijection of 32 bits in which every input bit affects every output bit.
std::uint32_t mixed(std::uint32_t z) {
  z = (z ^ (z >> 16)) * 0x21f0aaadU;
  z = (z ^ (z >> 15)) * 0x735a2d97U;
  return z ^ (z >> 15);
}

/// Uniform in [0, 1), a function of seed and counter alone.
double noise(std::uint32_t seed, std::uint32_t counter) {
  return static_cast<double>(mixed(mixed(seed) + counter)) / 4294967296.0;
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A third of the way up, unit length to within rounding: (3, 2, -6) / 7.
constexpr Vector kSun{3.0 / 7.0, 2.0 / 7.0, -6.0 / 7.0};
constexpr Vector kSunColour{1.0, 0.92, 0.8};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<double, 11> kSpecial{kNan, kInfinity, -kInfinity, -1,    -0.0, 1e-42,
                                          4096, 4096.5,    1e30,       -1e30, 3e38};
constexpr std::array<double, 5> kNanBearing{kNan, -1, -0.0, 1e-42, 5};

Vector smooth(std::uint32_t seed, const Vector& direction) {
  const double up = 0.5 + 0.5 * direction[1];
  Vector colour{0.3 + 0.5 * (up * up), 0.2 + 0.8 * (up * up), 0.1 + 1.2 * (up * up)};
  for (std::uint32_t k = 0; k < 3; ++k) {
    Vector axis{};
    for (std::uint32_t i = 0; i < 3; ++i) axis[i] = noise(seed, 0x80000000U + 3 * k + i) - 0.5;
    const double along = dot(direction, axis);
    colour[k] += 0.6 * (along * along);
  }
  return colour;
}

/// Adds a lobe of radiance `peak` that falls to zero where 1 - cos(angle to the sun) reaches `width`.
Vector with_sun(Vector colour, const Vector& direction, double peak, double width) {
  const double height = 1.0 - (1.0 - dot(direction, kSun)) / width;
  if (height > 0.0) {
    for (std::size_t k = 0; k < 3; ++k) colour[k] += kSunColour[k] * peak * (height * height);
  }
  return colour;
}

/// Returns the fraction of odd values: large enough that six texels have some, and small enough on larger environments
/// that a reduction to 8 x 8 does not find a NaN in every block.
double odd_share(std::uint32_t texels) { return texels < 2000 ? 0.15 : 0.005; }

/// Returns noise in which a fraction of the values is drawn from `list`.
template <std::size_t Count>
double sprinkled(std::uint32_t seed, std::uint32_t counter, double share, const std::array<double, Count>& list) {
  const double value = noise(seed, counter);
  if (value >= share) return value;
  return list[static_cast<std::size_t>(noise(seed, counter + 0x40000000U) * static_cast<double>(Count))];
}

/// A texel's position, as far as content depends on it.
struct FacePoint {
  Vector direction;
  std::uint32_t texel;   ///< its index in the environment
  std::uint32_t texels;  ///< the number of texels
  std::uint32_t cell;    ///< the index of its constant square
};

Vector radiance(Content content, std::uint32_t seed, const FacePoint& at) {
  const auto per_channel = [&at](auto&& value) {
    return Vector{value(4 * at.texel), value(4 * at.texel + 1), value(4 * at.texel + 2)};
  };
  const auto random = [seed](std::uint32_t i) { return noise(seed, i); };
  switch (content) {
    case Content::random: return per_channel(random);
    case Content::smooth: return smooth(seed, at.direction);
    case Content::high_range: {
      const Vector tail = per_channel([&](std::uint32_t i) { return 0.02 / (1.0001 - random(i)); });
      const Vector sky = smooth(seed, at.direction);
      return with_sun({sky[0] + tail[0], sky[1] + tail[1], sky[2] + tail[2]}, at.direction, 3000.0, 0.02);
    }
    case Content::clamped:
      return per_channel([&](std::uint32_t i) {
        const double r = random(i);
        return 20000.0 * (r * r * r);
      });
    case Content::sun_disc: return with_sun(smooth(seed, at.direction), at.direction, 60000.0, 0.002);
    case Content::gamma_encoded: return per_channel([&](std::uint32_t i) { return 1.5 * random(i) - 0.2; });
    case Content::special_values:
      return per_channel([&](std::uint32_t i) { return sprinkled(seed, i, odd_share(at.texels), kSpecial); });
    case Content::nan_bearing:
      return per_channel([&](std::uint32_t i) { return sprinkled(seed, i, odd_share(at.texels), kNanBearing); });
    case Content::blocks: {
      const auto level = [&](std::uint32_t k) {
        const double r = noise(seed, 4 * at.cell + k);
        return r < 0.5 ? 0.01 : 20.0 * (r - 0.5);
      };
      return {level(0), level(1), level(2)};
    }
    case Content::uniform: return {0.5, 1.0, 2.0};
    case Content::one_texel_sun: {
      const auto sun = static_cast<std::uint32_t>(noise(seed, 0x80000000U) * static_cast<double>(at.texels));
      return at.texel == sun ? Vector{1e6, 9e5, 8e5} : per_channel(random);
    }
  }
  throw std::invalid_argument("no such content");
}

double alpha(Content content, std::uint32_t seed, std::uint32_t texel) {
  if (content == Content::special_values || content == Content::nan_bearing) return kNan;
  return 1000.0 + noise(seed, 4 * texel + 3);
}

template <class Channel>
Channel channel_value(double value) {
  if constexpr (std::is_same_v<Channel, std::uint8_t>) {
    if (value >= 1.0) return 255;
    return value > 0.0 ? static_cast<std::uint8_t>(value * 256.0) : std::uint8_t{0};
  } else {
    return Channel(static_cast<float>(value));
  }
}

template <class Channel>
void append(std::vector<Channel>& pixels, int channels, Content content, std::uint32_t seed, const FacePoint& at) {
  for (const double value : radiance(content, seed, at)) pixels.push_back(channel_value<Channel>(value));
  if (channels == 4) pixels.push_back(channel_value<Channel>(alpha(content, seed, at.texel)));
}

std::uint32_t number(int value) { return static_cast<std::uint32_t>(value); }

template <class Channel>
BasicTestCubemap<Channel> cubemap(Content content, int size, int channels, std::uint32_t seed) {
  BasicTestCubemap<Channel> map{size, channels, {}};
  const std::uint32_t texels = 6 * number(size) * number(size);
  map.pixels.reserve(static_cast<std::size_t>(texels) * number(channels));
  std::uint32_t texel = 0;
  for (std::uint32_t face = 0; face < 6; ++face) {
    const Frame& frame = kFrames[face];
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++texel) {
        const double u = (2.0 * column + 1.0) / size - 1.0;
        const double v = (2.0 * row + 1.0) / size - 1.0;
        Vector direction{};
        for (std::size_t i = 0; i < 3; ++i) direction[i] = frame.normal[i] + u * frame.along[i] + v * frame.down[i];
        const double length = std::sqrt(dot(direction, direction));
        for (double& component : direction) component /= length;
        const std::uint32_t cell = 16 * face + 4 * (4 * number(row) / number(size)) + 4 * number(column) / number(size);
        append(map.pixels, channels, content, seed, {direction, texel, texels, cell});
      }
    }
  }
  return map;
}

/// Approximates sin(pi t / 2) for t in [-1, 1]: the parabolas that agree with it at -1, 0 and 1.
double near_sine(double t) { return t * (2.0 - (t < 0.0 ? -t : t)); }

/// Approximates the texel's direction; unit length to within rounding.
Vector lat_long_direction(double column_fraction, double row_fraction) {
  const double y = near_sine(1.0 - 2.0 * row_fraction);
  const double ring = std::sqrt(1.0 - y * y);
  // Longitude pi (1 - 2 column_fraction) in quarter turns; its cosine is the sine a quarter turn on.
  const double turns = 2.0 - 4.0 * column_fraction;
  const double sine = turns > 1.0 ? near_sine(2.0 - turns) : turns < -1.0 ? near_sine(-2.0 - turns) : near_sine(turns);
  const double cosine = near_sine(1.0 - (turns < 0.0 ? -turns : turns));
  const double scale = ring / std::sqrt(sine * sine + cosine * cosine);
  return {sine * scale, y, cosine * scale};
}

template <class Channel>
BasicTestLatLong<Channel> lat_long(Content content, int width, int height, std::uint32_t seed, int channels) {
  BasicTestLatLong<Channel> map{width, height, channels, {}};
  const std::uint32_t texels = number(width) * number(height);
  map.pixels.reserve(static_cast<std::size_t>(texels) * number(channels));
  std::uint32_t texel = 0;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column, ++texel) {
      const std::uint32_t cell = 8 * (4 * number(row) / number(height)) + 8 * number(column) / number(width);
      const Vector direction = lat_long_direction((column + 0.5) / width, (row + 0.5) / height);
      append(map.pixels, channels, content, seed, {direction, texel, texels, cell});
    }
  }
  return map;
}

template <class Channel>
PixelFormat format_of(int channels) {
  const bool with_alpha = channels == 4;
  if constexpr (std::is_same_v<Channel, float>) return with_alpha ? PixelFormat::rgba32f : PixelFormat::rgb32f;
  if constexpr (std::is_same_v<Channel, Imath::half>) return with_alpha ? PixelFormat::rgba16f : PixelFormat::rgb16f;
  if constexpr (std::is_same_v<Channel, std::uint8_t>) return with_alpha ? PixelFormat::rgba8 : PixelFormat::rgb8;
}

constexpr std::uint32_t kHashStart = 0x811c9dc5U;
constexpr std::uint32_t kHashFactor = 0x01000193U;

}  // namespace

std::string_view name(Content content) {
  const auto found = std::find_if(kNames.begin(), kNames.end(), [=](const auto& e) { return e.first == content; });
  return found == kNames.end() ? "unknown" : found->second;
}

Content content_named(std::string_view name) {
  const auto found = std::find_if(kNames.begin(), kNames.end(), [=](const auto& e) { return e.second == name; });
  if (found == kNames.end()) throw std::invalid_argument("no content is named " + std::string(name));
  return found->first;
}

template <class Channel>
CubemapView BasicTestCubemap<Channel>::view() const {
  CubemapView view;
  const std::size_t face_channels = pixels.size() / 6;
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = pixels.data() + face * face_channels;
  view.size = size;
  view.format = format_of<Channel>(channels);
  return view;
}

template <class Channel>
LatLongView BasicTestLatLong<Channel>::view() const {
  return {pixels.data(), width, height, 0, format_of<Channel>(channels)};
}

template struct BasicTestCubemap<float>;
template struct BasicTestCubemap<Imath::half>;
template struct BasicTestCubemap<std::uint8_t>;
template struct BasicTestLatLong<float>;
template struct BasicTestLatLong<Imath::half>;
template struct BasicTestLatLong<std::uint8_t>;

TestCubemap make_cubemap(Content content, int size, int channels, std::uint32_t seed) {
  return cubemap<float>(content, size, channels, seed);
}
TestCubemapHalf make_cubemap_half(Content content, int size, int channels, std::uint32_t seed) {
  return cubemap<Imath::half>(content, size, channels, seed);
}
TestCubemapBytes make_cubemap_bytes(Content content, int size, int channels, std::uint32_t seed) {
  return cubemap<std::uint8_t>(content, size, channels, seed);
}
TestLatLong make_lat_long(Content content, int width, int height, std::uint32_t seed, int channels) {
  return lat_long<float>(content, width, height, seed, channels);
}
TestLatLongHalf make_lat_long_half(Content content, int width, int height, std::uint32_t seed, int channels) {
  return lat_long<Imath::half>(content, width, height, seed, channels);
}
TestLatLongBytes make_lat_long_bytes(Content content, int width, int height, std::uint32_t seed, int channels) {
  return lat_long<std::uint8_t>(content, width, height, seed, channels);
}

std::uint32_t checksum(const std::vector<float>& pixels) {
  std::uint32_t hash = kHashStart;
  for (const float value : pixels) {
    const std::uint32_t bits = std::isnan(value) ? 0x7fc00000U : std::bit_cast<std::uint32_t>(value);
    hash = (hash ^ bits) * kHashFactor;
  }
  return hash;
}

std::uint32_t checksum(const std::vector<std::uint8_t>& pixels) {
  std::uint32_t hash = kHashStart;
  for (const std::uint8_t value : pixels) hash = (hash ^ value) * kHashFactor;
  return hash;
}

}  // namespace welkin::test
