#include "tools/preview_spheres.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>

#include "tools/cube_lookup.h"
#include "welkin/roughness.h"

namespace welkin::tool {
namespace {

constexpr glm::dvec3 kReflectance(0.955, 0.945, 0.93);  // f0 of a silvery metal
constexpr double kBackgroundRoughness = 0.25;           // out of focus
constexpr double kBackgroundSlope = 0.35;               // half the picture's height over the distance to it
constexpr int kSampling = 2;
constexpr int kFineSampling = 5;  // of rims, and of what mirrors sharply

/// Bilinear in the table, clamped at its edges.
glm::dvec2 brdf_at(const BrdfTable& table, double cosine, double roughness) {
  const int width = table.options.width;
  const int height = table.options.height;
  const double x = std::clamp(cosine * width - 0.5, 0.0, width - 1.0);
  const double y = std::clamp(roughness * height - 0.5, 0.0, height - 1.0);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const auto texel = [&](int i, int j) {
    const auto at = static_cast<std::size_t>(std::min(row + j, height - 1)) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(std::min(column + i, width - 1));
    const float* const values = table.values.data() + at * static_cast<std::size_t>(table.channels);
    return glm::dvec2(values[0], values[1]);
  };
  const double right = x - column;
  const double below = y - row;
  return (1.0 - below) * ((1.0 - right) * texel(0, 0) + right * texel(1, 0)) +
         below * ((1.0 - right) * texel(0, 1) + right * texel(1, 1));
}

glm::dvec3 albedo(const BrdfTable* table, double cosine, double roughness) {
  if (table == nullptr) return kReflectance;
  const glm::dvec2 terms = brdf_at(*table, cosine, roughness);
  if (table->options.model == BrdfModel::split_sum) return kReflectance * terms.x + terms.y;
  return (1.0 - kReflectance) * terms.x + kReflectance * terms.y;
}

/// All that a pixel needs to be shaded.
class Scene {
 public:
  Scene(const BakeResult& light, int ball) : light_(light), specular_(light.specular->cubemap), ball_(ball) {
    for (const MipRecord& mip : light.specular->mips) {
      if (!table_.empty() && mip.roughness <= table_.back()) break;  // several mips of one roughness: the first will do
      table_.push_back(mip.roughness);
    }
    if (light.irradiance.size > 0) irradiance_.emplace(std::vector<CubemapView>{light.irradiance.view()});
  }

  [[nodiscard]] int balls() const {
    return static_cast<int>(preview_roughness().size()) + (irradiance_.has_value() ? 1 : 0);
  }
  /// Pixels from one ball to the next.
  [[nodiscard]] int pitch() const noexcept { return ball_ + ball_ / 8; }

  /// Samples along each side of a pixel: light changes little within one but at a ball's rim and in its mirror image.
  [[nodiscard]] int sampling(int column, int row) const {
    const int index = column / pitch();
    const double x = column + 0.5 - (index + 0.5) * pitch();
    const double y = row + 0.5 - 0.5 * pitch();
    const double radius = std::sqrt(x * x + y * y);
    const bool sharp = index < static_cast<int>(preview_roughness().size()) &&
                       preview_roughness()[static_cast<std::size_t>(index)] < 0.1;
    const bool inside = radius < 0.5 * ball_;
    return std::abs(radius - 0.5 * ball_) < 1.5 || (inside && (sharp || radius > 0.45 * ball_)) ? kFineSampling
                                                                                                : kSampling;
  }

  /// Radiance at a point of the picture, in pixels.
  [[nodiscard]] glm::dvec3 radiance(double x, double y) const {
    const int index = static_cast<int>(x / pitch());
    const double u = (x - (index + 0.5) * pitch()) / (0.5 * ball_);
    const double v = (0.5 * pitch() - y) / (0.5 * ball_);
    const double squared = u * u + v * v;
    if (squared > 1.0) return background(x, y);
    const glm::dvec3 normal(u, v, std::sqrt(1.0 - squared));
    if (index < static_cast<int>(preview_roughness().size())) {
      return metal(normal, preview_roughness()[static_cast<std::size_t>(index)]);
    }
    return irradiance_->at(normal, 0) / std::numbers::pi;
  }

 private:
  [[nodiscard]] double mip_of(double roughness) const {
    return table_.size() > 1 ? mip_of_roughness(table_, roughness) : 0.0;
  }

  [[nodiscard]] glm::dvec3 background(double x, double y) const {
    const double half = 0.5 * pitch();
    const glm::dvec3 direction((x - half * balls()) / half * kBackgroundSlope, (half - y) / half * kBackgroundSlope,
                               -1.0);
    return specular_.at(direction, mip_of(kBackgroundRoughness));
  }

  /// The viewer is towards +z, so that N.V is the normal's z.
  [[nodiscard]] glm::dvec3 metal(const glm::dvec3& normal, double roughness) const {
    const glm::dvec3 reflected = 2.0 * normal.z * normal - glm::dvec3(0.0, 0.0, 1.0);
    return specular_.at(reflected, mip_of(roughness)) * albedo(light_.brdf.get(), normal.z, roughness);
  }

  const BakeResult& light_;
  CubeLookup specular_;
  std::optional<CubeLookup> irradiance_;
  std::vector<double> table_;
  int ball_;
};

}  // namespace

const std::vector<double>& preview_roughness() {
  static const std::vector<double> roughness = {0.0, 0.15, 0.3, 0.5, 0.75, 1.0};
  return roughness;
}

PreviewPicture preview_spheres(const BakeResult& light, const ToneMap& tone_map, int ball) {
  const Scene scene(light, ball);
  PreviewPicture picture(scene.balls() * scene.pitch(), scene.pitch(), glm::dvec3(0.0));
  const auto shade = [&](double x, double y) { return tone_map(scene.radiance(x, y)); };
  for (int row = 0; row < picture.height(); ++row) {
    for (int column = 0; column < picture.width(); ++column) {
      picture.set(column, row, supersampled(column, row, scene.sampling(column, row), shade));
    }
  }
  return picture;
}

}  // namespace welkin::tool
