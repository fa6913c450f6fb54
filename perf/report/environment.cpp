#include <glm/gtc/packing.hpp>

#include "perf/report/measuring.h"
#include "platform/text.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::report {
namespace {

constexpr double kSunRadius = 0.6;  // degrees
constexpr double kSunRadiance = 2e4;
constexpr double kWindowRadiance = 12.0;
constexpr int kGrain = 64;  // patches along the equator

const glm::dvec3 kSun = glm::normalize(glm::dvec3(0.55, 0.6, 0.58));

/// Returns 1 inside, 0 outside, and a ramp of one texel between. `inside`: degrees from the edge inwards.
double coverage(double inside, double texel) { return std::clamp(inside / texel + 0.5, 0.0, 1.0); }

/// A rectangle of longitudes and latitudes, degrees.
struct Window {
  double left, right, bottom, top;

  [[nodiscard]] double covers(double longitude, double latitude, double texel) const {
    return coverage(std::min(longitude - left, right - longitude), texel) *
           coverage(std::min(latitude - bottom, top - latitude), texel);
  }
};

constexpr Window kWindows[] = {{-120.0, -95.0, 5.0, 50.0}, {150.0, 158.0, -30.0, 35.0}};

/// Grain of the ground: a value in [0, 1) for each patch, the same at every resolution.
class Grain {
 public:
  Grain() {
    std::mt19937 random(17);
    for (double& value : values_) value = static_cast<double>(random()) * 0x1p-32;
  }
  [[nodiscard]] double at(double longitude, double latitude) const {
    const int column = static_cast<int>((longitude + 180.0) / 360.0 * kGrain) % kGrain;
    const int row = std::clamp(static_cast<int>((latitude + 90.0) / 180.0 * kGrain), 0, kGrain - 1);
    return values_[static_cast<std::size_t>(row * kGrain + column)];
  }

 private:
  double values_[kGrain * kGrain] = {};
};

glm::dvec3 light(const glm::dvec3& direction, double longitude, double latitude, double texel, const Grain& grain) {
  const double y = direction.y;
  const glm::dvec3 sky = glm::mix(glm::dvec3(0.75, 0.8, 0.85), glm::dvec3(0.15, 0.3, 0.7), std::sqrt(std::max(y, 0.0)));
  const glm::dvec3 ground = glm::dvec3(0.12, 0.1, 0.07) * (0.3 + grain.at(longitude, latitude));
  glm::dvec3 sum = glm::mix(ground, sky, coverage(latitude, texel));
  for (const Window& window : kWindows) {
    sum = glm::mix(sum, kWindowRadiance * glm::dvec3(1.0, 0.95, 0.85), window.covers(longitude, latitude, texel));
  }
  // Twice the arcsine of half the chord is exact for small angles too.
  const double from_sun = 2.0 * std::asin(0.5 * glm::length(direction - kSun)) * 180.0 / std::numbers::pi;
  return sum + kSunRadiance * coverage(kSunRadius - from_sun, texel) * glm::dvec3(1.0, 0.9, 0.75);
}

}  // namespace

ReportEnvironment built_in_environment(int width) {
  const int height = width / 2;
  const Grain grain;
  const double texel = 360.0 / width;
  ReportEnvironment result{"the built-in test light, " + std::to_string(width) + " x " + std::to_string(height),
                           {width, height, {}}};
  result.image.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int row = 0; row < height; ++row) {
    const double latitude = 90.0 - (row + 0.5) * texel;
    const double y = std::sin(latitude * std::numbers::pi / 180.0);
    const double level = std::cos(latitude * std::numbers::pi / 180.0);
    for (int column = 0; column < width; ++column) {
      const double longitude = 180.0 - (column + 0.5) * texel;
      const double turn = longitude * std::numbers::pi / 180.0;
      const glm::dvec3 rgb =
          light({level * std::sin(turn), y, level * std::cos(turn)}, longitude, latitude, texel, grain);
      for (int c = 0; c < 3; ++c) result.image.pixels.push_back(static_cast<float>(rgb[c]));
    }
  }
  return result;
}

ReportEnvironment environment_from(const std::filesystem::path& path, int width) {
  const Environment environment = read_environment(path);
  const int height = width / 2;
  LatLongImage image = to_lat_long(environment.view(), width, height, glm::dmat3(1.0), ResampleFilter::area);
  return {path.filename().string() + ", " + std::to_string(width) + " x " + std::to_string(height), std::move(image)};
}

namespace {

/// The sRGB curve of IEC 61966-2-1.
float encode_srgb(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

/// Appends a channel as `Stored`.
template <typename Stored>
void append(std::vector<std::byte>& bytes, Stored value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void append(std::vector<std::byte>& bytes, float value, PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb32f:
    case PixelFormat::rgba32f: append(bytes, value); return;
    case PixelFormat::rgb16f:
    case PixelFormat::rgba16f: append<std::uint16_t>(bytes, glm::packHalf1x16(std::min(value, 65504.0F))); return;
    case PixelFormat::rgb8:
    case PixelFormat::rgba8: break;
    case PixelFormat::srgb8:
    case PixelFormat::srgba8: value = encode_srgb(std::clamp(value, 0.0F, 1.0F)); break;
  }
  append(bytes, static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))));
}

bool has_alpha(PixelFormat format) {
  return format == PixelFormat::rgba32f || format == PixelFormat::rgba16f || format == PixelFormat::rgba8 ||
         format == PixelFormat::srgba8;
}

}  // namespace

std::string name(PixelFormat format) {
  constexpr std::array kNames{"rgb32f", "rgba32f", "rgb16f", "rgba16f", "rgb8", "rgba8", "rgb8srgb", "rgba8srgb"};
  return platform::name_in<PixelFormat::srgba8>(kNames, format, "unknown");
}

FormattedCubemap::FormattedCubemap(const Cubemap& image, PixelFormat format) : size_(image.size()), format_(format) {
  const std::span<const float> pixels = image.pixels();
  bytes_.reserve(pixels.size() / 3 * bytes_per_texel(format));
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    append(bytes_, pixels[k], format);
    if (k % 3 == 2 && has_alpha(format)) append(bytes_, 1.0F, format);
  }
}

CubemapView FormattedCubemap::view() const noexcept {
  CubemapView view{{}, size_, 0, format_};
  const std::size_t face = bytes_.size() / 6;
  for (std::size_t k = 0; k < 6; ++k) view.faces[k] = bytes_.data() + k * face;
  return view;
}

}  // namespace welkin::report
