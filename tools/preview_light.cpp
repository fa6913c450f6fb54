#include "tools/preview_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <numbers>

#include "files/png.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/file.h"
#include "tools/lettering.h"

namespace welkin::tool {
namespace {

double curve(double x) {
  const double light = std::min(x > 0.0 ? x : 0.0, 1e6);  // NaN becomes 0
  return std::min(1.0, light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14));
}

}  // namespace

glm::dvec3 ToneMap::operator()(const glm::dvec3& radiance) const noexcept {
  return {curve(exposure * radiance.x), curve(exposure * radiance.y), curve(exposure * radiance.z)};
}

double ToneMap::stops() const noexcept { return math::logarithm(exposure) / std::numbers::ln2; }

namespace {

/// The point where a direction meets the cube.
struct FacePoint {
  std::size_t face;
  float u, v;  ///< in [-1, 1]
};

/// Returns the point of a direction in the frames of `CubemapView`, as `image::face_frame` has them.
FacePoint face_point(const glm::vec3& d) {
  const glm::vec3 size = glm::abs(d);
  if (size.x >= size.y && size.x >= size.z) {
    return d.x > 0.0F ? FacePoint{0, -d.z / size.x, -d.y / size.x} : FacePoint{1, d.z / size.x, -d.y / size.x};
  }
  if (size.y >= size.z) {
    return d.y > 0.0F ? FacePoint{2, d.x / size.y, d.z / size.y} : FacePoint{3, d.x / size.y, -d.z / size.y};
  }
  return d.z > 0.0F ? FacePoint{4, d.x / size.z, -d.y / size.z} : FacePoint{5, -d.x / size.z, -d.y / size.z};
}

const float* texel(const CubemapView& level, std::size_t face, int column, int row) {
  return static_cast<const float*>(level.faces[face]) + (std::ptrdiff_t{row} * level.size + column) * 3;
}

glm::vec3 colour(const float* rgb) { return {rgb[0], rgb[1], rgb[2]}; }

/// Returns a texel that may be one beyond the face's edge: it is then the neighbour's, and at a corner, where three
/// faces meet and there is no fourth texel, the mean of the three.
glm::vec3 texel_or_neighbour(const CubemapView& level, std::size_t face, int column, int row) {
  const int size = level.size;
  const int inner_column = std::clamp(column, 0, size - 1);
  const int inner_row = std::clamp(row, 0, size - 1);
  if (column == inner_column && row == inner_row) return colour(texel(level, face, column, row));
  if (column != inner_column && row != inner_row) {
    return (colour(texel(level, face, inner_column, inner_row)) + texel_or_neighbour(level, face, column, inner_row) +
            texel_or_neighbour(level, face, inner_column, row)) /
           3.0F;
  }
  const image::CubeTexel beyond = image::across_edge(size, {static_cast<int>(face), column, row});
  return colour(texel(level, static_cast<std::size_t>(beyond.face), beyond.column, beyond.row));
}

glm::vec3 mixed(const glm::vec3& from, const glm::vec3& to, float share) { return from + (to - from) * share; }

glm::vec3 bilinear(const CubemapView& level, const FacePoint& point) {
  const float half = 0.5F * static_cast<float>(level.size);
  const float x = (point.u + 1.0F) * half + 0.5F;  // one more than the column, so that it is above 0
  const float y = (point.v + 1.0F) * half + 0.5F;
  const int column = static_cast<int>(x) - 1;
  const int row = static_cast<int>(y) - 1;
  const float right = x - static_cast<float>(column + 1);
  const float below = y - static_cast<float>(row + 1);
  if (column >= 0 && row >= 0 && column + 1 < level.size && row + 1 < level.size) {
    const float* const upper = texel(level, point.face, column, row);
    const float* const lower = upper + std::ptrdiff_t{3} * level.size;
    return mixed(mixed(colour(upper), colour(upper + 3), right), mixed(colour(lower), colour(lower + 3), right), below);
  }
  const auto get = [&](int i, int j) { return texel_or_neighbour(level, point.face, column + i, row + j); };
  return mixed(mixed(get(0, 0), get(1, 0), right), mixed(get(0, 1), get(1, 1), right), below);
}

}  // namespace

glm::vec3 CubeLookup::at(const glm::vec3& direction, int level) const {
  return bilinear(levels_[static_cast<std::size_t>(std::clamp(level, 0, levels() - 1))], face_point(direction));
}

glm::vec3 CubeLookup::at(const glm::vec3& direction, double level) const {
  const double clamped = std::clamp(level, 0.0, static_cast<double>(levels() - 1));
  const auto sharper = static_cast<std::size_t>(clamped);
  const auto share = static_cast<float>(clamped - static_cast<double>(sharper));
  const FacePoint point = face_point(direction);
  const glm::vec3 sharp = bilinear(levels_[sharper], point);
  return share > 0.0F ? mixed(sharp, bilinear(levels_[sharper + 1], point), share) : sharp;
}

double CubeLookup::level_for(double radians) const {
  const double texels = radians * levels_.front().size / (0.5 * std::numbers::pi);
  int exponent = 0;
  const double fraction = std::frexp(std::max(1.0, texels), &exponent);  // in [0.5, 1)
  return exponent - 1 + (2.0 * fraction - 1.0);  // logarithm to base 2, linear between powers of two
}

namespace {

/// Codes by light in steps that are fine enough that the code is off by at most one.
constexpr int kSteps = 1 << 14;

struct SrgbTables {
  std::vector<std::uint8_t> codes;  ///< by light, `kSteps` + 1
  std::array<float, 256> light{};   ///< by code

  SrgbTables() {
    for (int code = 0, step = 0; step <= kSteps; ++step) {
      while (code < 255 && image::linear_from_srgb((code + 0.5) / 255.0) <= static_cast<double>(step) / kSteps) ++code;
      codes.push_back(static_cast<std::uint8_t>(code));
    }
    for (std::size_t code = 0; code < light.size(); ++code) {
      light[code] = static_cast<float>(image::linear_from_srgb(static_cast<double>(code) / 255.0));
    }
  }
};

const SrgbTables& srgb() {
  static const SrgbTables tables;
  return tables;
}

}  // namespace

PreviewImage::PreviewImage(int width, int height, const glm::vec3& background)
    : width_(width),
      height_(height),
      bytes_(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      codes_(srgb().codes.data()) {
  set(0, 0, background);
  // Each pixel is copied from the one before.
  for (std::size_t i = 3; i < bytes_.size(); ++i) bytes_[i] = bytes_[i - 3];
}

std::size_t PreviewImage::offset(int column, int row) const noexcept {
  return 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column));
}

void PreviewImage::set(int column, int row, const glm::vec3& rgb) {
  std::uint8_t* const pixel = bytes_.data() + offset(column, row);
  for (int c = 0; c < 3; ++c) {
    pixel[c] = codes_[static_cast<int>(std::clamp(rgb[c], 0.0F, 1.0F) * static_cast<float>(kSteps) + 0.5F)];
  }
}

namespace {

constexpr double kLetter = 6.0;   // a letter's height in units of the pen
constexpr double kPen = 0.42;     // half the pen's width in those units
constexpr double kRim = 0.8;      // width of its dark rim
constexpr glm::vec3 kInk(0.80F);  // linear

}  // namespace

double label_width(std::string_view text, double height) noexcept {
  return 2.0 * label_half_width(text) * height / kLetter;
}

void PreviewImage::write(std::string_view text, double x, double y, double height) {
  const double unit = height / kLetter;  // pixels
  const double across = label_half_width(text) * unit + 2.0 * unit;
  const double down = 0.5 * height + 2.0 * unit;
  const int left = std::max(0, static_cast<int>(x - across));
  const int right = std::min(width(), static_cast<int>(x + across) + 1);
  const int top = std::max(0, static_cast<int>(y - down));
  const int bottom = std::min(this->height(), static_cast<int>(y + down) + 1);
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column) {
      const double away = distance_to_label(text, (column + 0.5 - x) / unit, (y - row - 0.5) / unit);
      const double ink = std::clamp(0.5 + (kPen - away) * unit, 0.0, 1.0);  // the fraction of the pixel under the pen
      const double dark = std::clamp(1.0 - (away - kPen) / kRim, 0.0, 1.0);
      if (ink == 0.0 && dark == 0.0) continue;
      glm::vec3 shaded(0.0F);
      for (int c = 0; c < 3; ++c) shaded[c] = srgb().light[bytes_[offset(column, row) + static_cast<std::size_t>(c)]];
      shaded *= static_cast<float>(1.0 - 0.75 * dark);
      set(column, row, mixed(shaded, kInk, static_cast<float>(ink)));
    }
  }
}

void PreviewImage::save(const std::filesystem::path& path) const {
  platform::WholeFile file(path);
  files::write_png_quickly(file, bytes_, width_);
  file.finish();
  file.commit();
}

}  // namespace welkin::tool
