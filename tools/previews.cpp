#include "tools/previews.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "welkin/reflections.h"

namespace welkin::tool {
namespace {

constexpr double kMiddleGrey = 0.18;
constexpr double kBright = 4.0;

double curve(double x) {
  const double light = std::max(x, 0.0);  // false for NaN, which so becomes 0
  if (light > 1e6) return 1.0;
  return std::min(1.0, light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14));
}

/// The mean over all texels whose luminance is at most `limit`, weighted by 1 / (1 + u^2 + v^2)^1.5: solid angle but
/// for a factor. 0 if there are none.
double mean_luminance(const CubemapView& level, double limit) {
  double sum = 0.0;
  double weights = 0.0;
  for (const void* const face : level.faces) {
    const auto* rgb = static_cast<const float*>(face);
    for (int row = 0; row < level.size; ++row) {
      const double v = (2.0 * row + 1.0) / level.size - 1.0;
      for (int column = 0; column < level.size; ++column, rgb += 3) {
        const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        if (!(luminance <= limit)) continue;
        const double u = (2.0 * column + 1.0) / level.size - 1.0;
        const double squared = 1.0 + u * u + v * v;
        const double weight = 1.0 / (squared * std::sqrt(squared));
        sum += weight * std::max(luminance, 0.0);
        weights += weight;
      }
    }
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace

glm::dvec3 ToneMap::operator()(const glm::dvec3& radiance) const noexcept {
  return {curve(exposure * radiance.x), curve(exposure * radiance.y), curve(exposure * radiance.z)};
}

ToneMap tone_map_of(const CubemapView& level) {
  double mean = mean_luminance(level, std::numeric_limits<double>::max());
  for (int step = 0; step < 6 && mean > 0.0; ++step) {  // each leaves out what was too bright for the one before
    const double rest = mean_luminance(level, kBright * mean);
    if (!(rest < mean)) break;
    mean = rest;
  }
  return mean > 0.0 && std::isfinite(kMiddleGrey / mean) ? ToneMap{kMiddleGrey / mean} : ToneMap{};
}

namespace {

/// A face's frame, as `CubemapView` has them: a direction on it is normal + u right + v down.
struct Frame {
  glm::dvec3 normal, right, down;
};

const std::array<Frame, 6> kFrames = {{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                       {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                       {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                       {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                       {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                       {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

/// Where a direction meets the cube.
struct Place {
  std::size_t face;
  double u, v;  ///< in [-1, 1]
};

double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Place place_of(const glm::dvec3& direction) {
  const double x = std::abs(direction.x);
  const double y = std::abs(direction.y);
  const double z = std::abs(direction.z);
  std::size_t face = 0;
  double along = x;
  if (x >= y && x >= z) {
    face = direction.x > 0.0 ? 0 : 1;
  } else if (y >= z) {
    face = direction.y > 0.0 ? 2 : 3;
    along = y;
  } else {
    face = direction.z > 0.0 ? 4 : 5;
    along = z;
  }
  return {face, dot(direction, kFrames[face].right) / along, dot(direction, kFrames[face].down) / along};
}

glm::dvec3 texel(const CubemapView& level, std::size_t face, int column, int row) {
  const auto* const values = static_cast<const float*>(level.faces[face]);
  const float* const rgb = values + (std::ptrdiff_t{row} * level.size + column) * 3;
  return {rgb[0], rgb[1], rgb[2]};
}

int nearest(double u, int size) { return std::clamp(static_cast<int>((u + 1.0) * 0.5 * size), 0, size - 1); }

/// A texel that may lie one beyond the face's edge: it is then the neighbour's, and at a corner, where three faces
/// meet and there is no fourth texel, the mean of the three.
glm::dvec3 texel_or_neighbour(const CubemapView& level, std::size_t face, int column, int row) {
  const int size = level.size;
  const int inner_column = std::clamp(column, 0, size - 1);
  const int inner_row = std::clamp(row, 0, size - 1);
  if (column == inner_column && row == inner_row) return texel(level, face, column, row);
  if (column != inner_column && row != inner_row) {
    return (texel(level, face, inner_column, inner_row) + texel_or_neighbour(level, face, column, inner_row) +
            texel_or_neighbour(level, face, inner_column, row)) /
           3.0;
  }
  const Frame& frame = kFrames[face];
  const double u = (2.0 * column + 1.0) / size - 1.0;
  const double v = (2.0 * row + 1.0) / size - 1.0;
  const Place place = place_of(frame.normal + u * frame.right + v * frame.down);
  return texel(level, place.face, nearest(place.u, size), nearest(place.v, size));
}

}  // namespace

glm::dvec3 CubeLookup::at(const glm::dvec3& direction, int level) const {
  const CubemapView& view = levels_[static_cast<std::size_t>(std::clamp(level, 0, levels() - 1))];
  const Place place = place_of(direction);
  const double x = (place.u + 1.0) * 0.5 * view.size - 0.5;
  const double y = (place.v + 1.0) * 0.5 * view.size - 0.5;
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const double right = x - column;
  const double below = y - row;
  const auto get = [&](int i, int j) { return texel_or_neighbour(view, place.face, column + i, row + j); };
  return (1.0 - below) * ((1.0 - right) * get(0, 0) + right * get(1, 0)) +
         below * ((1.0 - right) * get(0, 1) + right * get(1, 1));
}

glm::dvec3 CubeLookup::at(const glm::dvec3& direction, double level) const {
  const double clamped = std::clamp(level, 0.0, static_cast<double>(levels() - 1));
  const int sharper = static_cast<int>(clamped);
  const double share = clamped - sharper;
  if (share == 0.0) return at(direction, sharper);
  return (1.0 - share) * at(direction, sharper) + share * at(direction, sharper + 1);
}

PreviewPicture::PreviewPicture(int width, int height, const glm::dvec3& background)
    : image_{width, height,
             std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)} {
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) set(column, row, background);
  }
}

void PreviewPicture::set(int column, int row, const glm::dvec3& rgb) {
  float* const pixel =
      image_.pixels.data() +
      (static_cast<std::size_t>(row) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(column)) * 3;
  for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(rgb[c]);
}

namespace {

constexpr glm::dvec3 kAround(0.01, 0.01, 0.012);
constexpr int kLargestSampling = 16;

/// A cell of the cross: where it stands, and what its middle, its right and its upper edge look along.
struct Cell {
  int column, row;
  glm::dvec3 middle, right, up;
};

const std::array<Cell, 6> kCells = {{{1, 0, {0, 1, 0}, {-1, 0, 0}, {0, 0, -1}},
                                     {0, 1, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                     {1, 1, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
                                     {2, 1, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                     {3, 1, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
                                     {1, 2, {0, -1, 0}, {-1, 0, 0}, {0, 0, 1}}}};

/// Draws the cross of one level with its upper left corner at (left, top).
void draw_cross(PreviewPicture& picture, const CubeLookup& cube, int level, const ToneMap& tone_map, int cell, int left,
                int top) {
  const int sampling = std::clamp((cube.size(level) + cell - 1) / cell, 1, kLargestSampling);
  for (const Cell& each : kCells) {
    const int x = left + each.column * cell;
    const int y = top + each.row * cell;
    const auto shade = [&](double column, double row) {
      const double right = 2.0 * (column - x) / cell - 1.0;
      const double up = 1.0 - 2.0 * (row - y) / cell;
      return tone_map(cube.at(each.middle + right * each.right + up * each.up, level));
    };
    for (int row = y; row < y + cell; ++row) {
      for (int column = x; column < x + cell; ++column) {
        picture.set(column, row, supersampled(column, row, sampling, shade));
      }
    }
  }
}

/// The smallest level that has as many texels as a cell has pixels.
int level_for(const CubeLookup& cube, int cell) {
  int level = 0;
  while (level + 1 < cube.levels() && cube.size(level + 1) >= cell) ++level;
  return level;
}

}  // namespace

PreviewPicture preview_cross(const CubeLookup& environment, const ToneMap& tone_map, int cell) {
  PreviewPicture picture(4 * cell, 3 * cell, kAround);
  draw_cross(picture, environment, level_for(environment, cell), tone_map, cell, 0, 0);
  return picture;
}

PreviewPicture preview_mips(const CubeLookup& specular, const ToneMap& tone_map, int cell) {
  constexpr int kInARow = 4;
  const int gap = cell / 8;
  const int columns = std::min(specular.levels(), kInARow);
  const int rows = (specular.levels() + kInARow - 1) / kInARow;
  PreviewPicture picture(columns * (4 * cell + gap) - gap, rows * (3 * cell + gap) - gap, kAround);
  for (int level = 0; level < specular.levels(); ++level) {
    draw_cross(picture, specular, level, tone_map, cell, level % kInARow * (4 * cell + gap),
               level / kInARow * (3 * cell + gap));
  }
  return picture;
}

namespace {

constexpr double kBackgroundRoughness = 0.25;  // out of focus
constexpr double kBackgroundSlope = 1.0;       // half the picture's width over the distance to it
constexpr double kSharp = 0.05;                // roughness below which a ball shows single texels
constexpr double kSoft = 0.3;                  // and above which light hardly changes within a pixel

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

/// The share of even light that the surface reflects without the light entering it.
glm::dvec3 specular_albedo(const glm::dvec3& f0, const BrdfTable* table, double cosine, double roughness) {
  if (table == nullptr) return f0;
  const glm::dvec2 terms = brdf_at(*table, cosine, roughness);
  if (table->options.model == BrdfModel::split_sum) return f0 * terms.x + terms.y;
  return (1.0 - f0) * terms.x + f0 * terms.y;
}

/// All that a pixel needs to be shaded. Lengths are pixels.
class Scene {
 public:
  Scene(const BakeResult& light, int ball) : light_(light), specular_(light.specular->cubemap), ball_(ball) {
    for (const MipRecord& mip : light.specular->mips) {
      if (!table_.empty() && mip.roughness <= table_.back()) break;  // several mips of one roughness: the first will do
      table_.push_back(mip.roughness);
    }
    if (light.irradiance) irradiance_.emplace(std::vector<CubemapView>{light.irradiance->view()});
    for (const PreviewMaterial& material : preview_materials()) {
      if (material.is_metal() || irradiance_) rows_.push_back(&material);
    }
  }

  [[nodiscard]] int width() const { return static_cast<int>(preview_roughness().size()) * pitch(); }
  [[nodiscard]] int height() const { return static_cast<int>(rows_.size()) * pitch(); }

  /// Samples along each side of a pixel: many at rims and in mirror images, few where light hardly changes.
  [[nodiscard]] int sampling(int column, int row) const {
    const BallPoint point = ball_point(column + 0.5, row + 0.5);
    const double radius = std::sqrt(point.u * point.u + point.v * point.v);
    if (std::abs(radius - 1.0) * 0.5 * ball_ < 1.5) return 4;
    if (radius > 1.0 || point.roughness > kSoft) return 1;
    return point.roughness < kSharp || radius > 0.95 ? 4 : 2;
  }

  /// Radiance at a point of the picture.
  [[nodiscard]] glm::dvec3 radiance(double x, double y) const {
    const BallPoint point = ball_point(x, y);
    const double squared = point.u * point.u + point.v * point.v;
    if (squared > 1.0) return background(x, y);
    return ball(*point.material, point.roughness, {point.u, point.v, std::sqrt(1.0 - squared)});
  }

 private:
  /// The ball that a point is nearest to, and where the point lies in units of its radius.
  struct BallPoint {
    const PreviewMaterial* material;
    double roughness;
    double u, v;
  };

  /// From one ball to the next.
  [[nodiscard]] int pitch() const noexcept { return ball_ + ball_ / 8; }

  [[nodiscard]] BallPoint ball_point(double x, double y) const {
    const int column = static_cast<int>(x / pitch());
    const int row = static_cast<int>(y / pitch());
    return {rows_[static_cast<std::size_t>(row)], preview_roughness()[static_cast<std::size_t>(column)],
            (x - (column + 0.5) * pitch()) / (0.5 * ball_), ((row + 0.5) * pitch() - y) / (0.5 * ball_)};
  }

  [[nodiscard]] double mip_of(double roughness) const {
    return table_.size() > 1 ? mip_of_roughness(table_, roughness) : 0.0;
  }

  [[nodiscard]] glm::dvec3 background(double x, double y) const {
    const double unit = kBackgroundSlope / (0.5 * width());
    return specular_.at({(x - 0.5 * width()) * unit, (0.5 * height() - y) * unit, -1.0}, mip_of(kBackgroundRoughness));
  }

  /// The viewer is towards +z, so that N.V is the normal's z.
  [[nodiscard]] glm::dvec3 ball(const PreviewMaterial& material, double roughness, const glm::dvec3& normal) const {
    const glm::dvec3 reflected = 2.0 * normal.z * normal - glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 share = specular_albedo(material.f0, light_.brdf.get(), normal.z, roughness);
    const glm::dvec3 mirrored = specular_.at(reflected, mip_of(roughness)) * share;
    if (material.is_metal()) return mirrored;
    return mirrored + (1.0 - share) * material.diffuse_albedo * irradiance_->at(normal, 0) / std::numbers::pi;
  }

  const BakeResult& light_;
  CubeLookup specular_;
  std::optional<CubeLookup> irradiance_;
  std::vector<const PreviewMaterial*> rows_;
  std::vector<double> table_;
  int ball_;
};

}  // namespace

const std::vector<double>& preview_roughness() {
  static const std::vector<double> roughness = {0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0};
  return roughness;
}

std::span<const PreviewMaterial> preview_materials() noexcept {
  static constexpr std::array<PreviewMaterial, 4> materials = {
      {{"silver", {0.972, 0.960, 0.915}, {0.0, 0.0, 0.0}},
       {"gold", {1.000, 0.766, 0.336}, {0.0, 0.0, 0.0}},
       {"red plastic", {0.04, 0.04, 0.04}, {0.50, 0.03, 0.02}},
       {"white plastic", {0.04, 0.04, 0.04}, {0.80, 0.80, 0.80}}}};
  return materials;
}

PreviewPicture preview_spheres(const BakeResult& light, const ToneMap& tone_map, int ball) {
  const Scene scene(light, ball);
  PreviewPicture picture(scene.width(), scene.height(), glm::dvec3(0.0));
  const auto shade = [&](double x, double y) { return tone_map(scene.radiance(x, y)); };
  for (int row = 0; row < picture.height(); ++row) {
    for (int column = 0; column < picture.width(); ++column) {
      picture.set(column, row, supersampled(column, row, scene.sampling(column, row), shade));
    }
  }
  return picture;
}

}  // namespace welkin::tool
