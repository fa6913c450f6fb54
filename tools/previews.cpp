// Draws the images for people: the surroundings, the mips, spheres in the baked light.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "tools/preview_light.h"
#include "tools/text.h"
#include "welkin/reflections.h"

namespace welkin::tool {
namespace {

constexpr glm::vec3 kGround(0.018F, 0.018F,
                            0.02F);  // linear: a dark grey that neither light nor dark spheres vanish in

/// Calls `draw(row)` for all rows, several concurrently on the available threads.
void for_rows(int rows, int width, const Control& control, const std::function<void(int)>& draw) {
  const jobs::Placement where = jobs::placement_for(std::int64_t{16} * rows * width);
  jobs::run_tiles(static_cast<std::size_t>(rows), where, jobs::worker_count(where), {control.stop, {}},
                  [&](std::size_t row, std::size_t) { draw(static_cast<int>(row)); });
}

/// A lat-long of `height` with its upper left corner at (left, top).
struct Panorama {
  int left, top, height;

  [[nodiscard]] double pixel_radians() const { return std::numbers::pi / height; }
};

/// Returns the level whose texels are nearest in size to pixels.
int nearest_level(const CubeLookup& cube, const Panorama& panorama) {
  return static_cast<int>(cube.level_for(panorama.pixel_radians()) + 0.5);
}

void draw_panorama(PreviewImage& image, const CubeLookup& cube, int level, const ToneMap& tone_map,
                   const Panorama& panorama, const Control& control) {
  const int width = 2 * panorama.height;
  std::vector<glm::dvec3> around;  // level directions: along a row only the azimuth changes
  around.reserve(static_cast<std::size_t>(width));
  for (int column = 0; column < width; ++column) {
    around.push_back(image::lat_long_direction(width, 1, column + 0.5, 0.5));
  }
  for_rows(panorama.height, width, control, [&](int row) {
    const glm::dvec3 up = image::lat_long_direction(1, panorama.height, 0.5, row + 0.5);
    const double across = std::sqrt(std::max(0.0, 1.0 - up.y * up.y));
    for (int column = 0; column < width; ++column) {
      const glm::dvec3& towards = around[static_cast<std::size_t>(column)];
      const glm::vec3 radiance = cube.at(glm::vec3(across * towards.x, up.y, across * towards.z), level);
      image.set(panorama.left + column, panorama.top + row, tone_map(radiance));
    }
  });
}

/// Returns the surroundings as a lat-long, twice as wide as high, as seen from inside: +z in the middle, +x to the left
/// of it. (A cubemap's own faces look mirrored: docs/explanation/orientation.md says why.) The axes are written at the
/// bottom.
PreviewImage preview_environment(const CubeLookup& environment, const ToneMap& tone_map, int height,
                                 const Control& control) {
  PreviewImage image(2 * height, height, kGround);
  const Panorama whole{0, 0, height};
  draw_panorama(image, environment, nearest_level(environment, whole), tone_map, whole, control);
  const double letters = std::max(8.0, height / 40.0);
  for (const auto& [axis, share] : {std::pair{"+X", 0.25}, std::pair{"+Z", 0.5}, std::pair{"-X", 0.75}}) {
    image.write(axis, share * image.width(), height - 1.4 * letters, letters);
  }
  image.write("-Z", 1.8 * letters, height - 1.4 * letters, letters);
  return image;
}

/// Returns each mip as a lat-long, all of one size, in rows from the sharpest to the roughest, labelled with its
/// roughness. Texels are magnified to many pixels as a GPU does it, so that seams would show. `light` must have its
/// specular chain; `height` is that of each.
PreviewImage preview_mips(const BakeResult& light, const ToneMap& tone_map, int height, const Control& control) {
  constexpr int kInARow = 3;
  const std::vector<MipRecord>& mips = light.specular->mips;
  const CubeLookup cube(light.specular->cubemap);
  const int gap = height / 16;
  const int columns = std::min(cube.levels(), kInARow);
  const int rows = (cube.levels() + kInARow - 1) / kInARow;
  PreviewImage image(columns * (2 * height + gap) + gap, rows * (height + gap) + gap, kGround);
  const double letters = std::max(6.0, height / 16.0);
  for (int level = 0; level < cube.levels(); ++level) {
    const Panorama panorama{gap + level % kInARow * (2 * height + gap), gap + level / kInARow * (height + gap), height};
    const double roughness = mips[static_cast<std::size_t>(level)].roughness;
    if (roughness == 0.0 && light.background) {  // finer than the image
      const CubeLookup sharp(*light.background);
      draw_panorama(image, sharp, nearest_level(sharp, panorama), tone_map, panorama, control);
    } else {
      draw_panorama(image, cube, level, tone_map, panorama, control);
    }
    const std::string label = "MIP " + std::to_string(level) + "  ROUGHNESS " + significant(roughness, 2);
    image.write(label, panorama.left + letters + 0.5 * label_width(label, letters),
                panorama.top + panorama.height - 1.2 * letters, letters);
  }
  return image;
}

/// The material of a row of spheres.
struct PreviewMaterial {
  const char* name;           ///< in capitals
  glm::dvec3 f0;              ///< reflectance at normal incidence, linear Rec. 709
  glm::dvec3 diffuse_albedo;  ///< 0 for a metal

  [[nodiscard]] bool is_metal() const noexcept { return diffuse_albedo == glm::dvec3(0.0); }
};

/// Rows of the image of spheres, from top to bottom. f0 of the metal: Lagarde, "Feeding a physically based shading
/// model" (2011).
constexpr std::array<PreviewMaterial, 2> kMaterials = {
    {{"METAL", {0.972, 0.960, 0.915}, {0.0, 0.0, 0.0}}, {"DIELECTRIC", {0.04, 0.04, 0.04}, {0.30, 0.30, 0.30}}}};

/// Roughness of the spheres of each row, from left to right.
constexpr std::array kRoughness = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0};

/// The fraction of uniform light that the specular lobe of one roughness reflects, by N.V.
class SpecularAlbedo {
 public:
  /// Without a table the result is f0.
  SpecularAlbedo(const PreviewMaterial& material, double roughness, const BrdfTable* table) {
    if (table == nullptr) {
      columns_.emplace_back(material.f0);
      return;
    }
    const int height = table->options.height;
    const double y = std::clamp(roughness * height - 0.5, 0.0, height - 1.0);
    const int row = static_cast<int>(y);
    const double below = y - row;
    for (int column = 0; column < table->options.width; ++column) {
      const glm::dvec2 terms = (1.0 - below) * terms_at(*table, column, row) +
                               below * terms_at(*table, column, std::min(row + 1, height - 1));
      const bool split_sum = table->options.model == BrdfModel::split_sum;
      columns_.emplace_back(split_sum ? material.f0 * terms.x + terms.y
                                      : (1.0 - material.f0) * terms.x + material.f0 * terms.y);
    }
  }

  /// Interpolates linearly between the centres of the table's columns.
  [[nodiscard]] glm::vec3 at(float cosine) const {
    const auto width = static_cast<float>(columns_.size());
    const float x = std::clamp(cosine * width - 0.5F, 0.0F, width - 1.0F);
    const auto column = static_cast<std::size_t>(x);
    const float right = x - static_cast<float>(column);
    return (1.0F - right) * columns_[column] + right * columns_[std::min(column + 1, columns_.size() - 1)];
  }

 private:
  static glm::dvec2 terms_at(const BrdfTable& table, int column, int row) {
    const auto texel = static_cast<std::size_t>(row) * static_cast<std::size_t>(table.options.width) +
                       static_cast<std::size_t>(column);
    const float* const values = table.values.data() + texel * static_cast<std::size_t>(table.channels);
    return {values[0], values[1]};
  }

  std::vector<glm::vec3> columns_;
};

/// The light on the spheres.
class Light {
 public:
  Light(const BakeResult& light, int sphere) : light_(light), specular_(light.specular->cubemap), sphere_(sphere) {
    for (const MipRecord& mip : light.specular->mips) {
      if (!table_.empty() && mip.roughness <= table_.back()) break;  // the first of several with one roughness suffices
      table_.push_back(mip.roughness);
    }
    if (light.irradiance) irradiance_.emplace(std::vector<CubemapView>{light.irradiance->view()});
    if (light.background && table_.front() == 0.0) sharp_.emplace(*light.background);
  }

  [[nodiscard]] bool has_irradiance() const noexcept { return irradiance_.has_value(); }
  [[nodiscard]] double mip_of(double roughness) const {
    return table_.size() > 1 ? mip_for_roughness(table_, roughness) : 0.0;
  }

  [[nodiscard]] const BrdfTable* brdf() const noexcept { return light_.brdf.get(); }

  /// Returns the radiance that a sphere reflects at `normal`, before its material scales it. The viewer is towards +z,
  /// so that N.V is the normal's z. `mip`: of the roughness. Mips are looked up by roughness, as a shader does it. Mip
  /// 0 is not blurred, and near a sphere's rim a pixel reflects many of its texels; their mean comes from the
  /// background's plain mips. Reflected directions rotate twice as fast as normals, which along the radius rotate 1 /
  /// cosine times as fast as the radius changes.
  [[nodiscard]] glm::vec3 reflection(const glm::vec3& normal, double mip) const {
    const glm::vec3 direction = 2.0F * normal.z * normal - glm::vec3(0.0F, 0.0F, 1.0F);
    if (mip >= 1.0 || !sharp_) return specular_.at(direction, mip);
    const float pixel =
        4.0F / (static_cast<float>(sphere_) * std::sqrt(std::max(normal.z, 0.02F)));  // geometric mean of both axes
    const glm::vec3 sharp = sharp_->at(direction, sharp_->level_for(pixel));
    if (mip == 0.0) return sharp;
    const auto blurred = static_cast<float>(mip);
    return (1.0F - blurred) * sharp + blurred * specular_.at(direction, 1);
  }

  /// Returns the radiance of a sphere's point. `reflected`: `reflection` there.
  [[nodiscard]] glm::vec3 sphere(const PreviewMaterial& material, const SpecularAlbedo& albedo, const glm::vec3& normal,
                                 const glm::vec3& reflected) const {
    const glm::vec3 share = albedo.at(normal.z);
    const glm::vec3 mirrored = reflected * share;
    if (material.is_metal()) return mirrored;
    constexpr auto kShown = static_cast<float>(1.0 / std::numbers::pi);
    return mirrored + (1.0F - share) * glm::vec3(material.diffuse_albedo) * irradiance_->at(normal, 0) * kShown;
  }

 private:
  const BakeResult& light_;
  CubeLookup specular_;
  std::optional<CubeLookup> sharp_;
  std::optional<CubeLookup> irradiance_;
  std::vector<double> table_;
  int sphere_;
};

/// The positions of spheres and labels, in pixels.
struct Grid {
  int sphere;

  [[nodiscard]] int pitch() const noexcept { return sphere + sphere / 8; }
  [[nodiscard]] int left() const noexcept { return sphere / 8; }
  [[nodiscard]] int row_height() const noexcept { return pitch() + sphere / 8; }  // with the labels below the spheres
  [[nodiscard]] glm::dvec2 centre(int column, int row) const noexcept {
    return {left() + (column + 0.5) * pitch(), row * row_height() + 0.5 * pitch()};
  }
  [[nodiscard]] double letters() const noexcept { return sphere / 18.0; }
};

struct Sphere {
  const PreviewMaterial& material;
  SpecularAlbedo albedo;
  int top;  ///< image row of row 0 of the sphere's cell
};

/// A column of spheres of one roughness: all reflect the same radiance, which each material scales.
struct SphereColumn {
  double mip;         ///< of the roughness
  glm::dvec2 centre;  ///< of the first sphere, and of each in its cell
  double radius;
  std::vector<Sphere> spheres;
};

/// Draws the pixels of one row that the spheres of a column cover, some only in part: an edge is as soft as a pixel.
void draw_row(PreviewImage& image, const SphereColumn& column, const Light& light, const ToneMap& tone_map, int row) {
  const double down = row + 0.5 - column.centre.y;
  const double reach = column.radius + 0.5;
  if (std::abs(down) >= reach) return;
  const double half = std::sqrt(reach * reach - down * down);
  const int first = std::max(0, static_cast<int>(std::floor(column.centre.x - half)));
  const int last = std::min(image.width() - 1, static_cast<int>(column.centre.x + half));
  for (int x = first; x <= last; ++x) {
    const double across = x + 0.5 - column.centre.x;
    const double away = std::sqrt(across * across + down * down);
    const double covered = std::clamp(column.radius - away + 0.5, 0.0, 1.0);
    if (covered == 0.0) continue;
    // A pixel that the rim crosses shows the light just inside of it.
    const double inside = std::min(1.0, (column.radius - 0.25) / std::max(away, 1e-9));
    const double u = across * inside / column.radius;
    const double v = -down * inside / column.radius;
    const glm::vec3 normal(u, v, std::sqrt(std::max(0.0, 1.0 - u * u - v * v)));
    const glm::vec3 reflected = light.reflection(normal, column.mip);
    for (const Sphere& sphere : column.spheres) {
      const glm::vec3 seen(tone_map(light.sphere(sphere.material, sphere.albedo, normal, reflected)));
      image.set(x, sphere.top + row, kGround + (seen - kGround) * static_cast<float>(covered));
    }
  }
}

/// Draws spheres on a dark ground: one material per row, one roughness per column, labelled with both. The viewer looks
/// along -z from far away: +x is to the right, and the spheres mirror the space behind the viewer, the lat-long's
/// centre.
///
/// A sphere shows specular(reflection, mip of its roughness) times A = f0 scale + bias from the BRDF table (f0 alone
/// without a table), and if it is no metal also (1 - A) albedo irradiance(normal) / pi. Without an irradiance cubemap
/// there are only metals. `light` must have its specular chain; its background, if there is one, replaces a sharp mip 0
/// that is coarser than the image. `sphere`: diameter in pixels; the pitch is 9/8 of it, and the labels take another
/// 1/8 below.
PreviewImage preview_spheres(const BakeResult& light, const ToneMap& tone_map, int sphere, const Control& control) {
  const Light lit(light, sphere);
  const Grid grid{sphere};
  std::vector<const PreviewMaterial*> rows;
  for (const PreviewMaterial& material : kMaterials) {
    if (material.is_metal() || lit.has_irradiance()) rows.push_back(&material);
  }
  std::vector<SphereColumn> columns;
  for (std::size_t column = 0; column < kRoughness.size(); ++column) {
    columns.push_back({lit.mip_of(kRoughness[column]), grid.centre(static_cast<int>(column), 0), 0.5 * sphere, {}});
    for (std::size_t row = 0; row < rows.size(); ++row) {
      columns.back().spheres.push_back({*rows[row], SpecularAlbedo(*rows[row], kRoughness[column], lit.brdf()),
                                        static_cast<int>(row) * grid.row_height()});
    }
  }
  PreviewImage image(static_cast<int>(columns.size()) * grid.pitch() + 2 * grid.left(),
                     static_cast<int>(rows.size()) * grid.row_height(), kGround);
  for_rows(grid.row_height(), image.width() * static_cast<int>(rows.size()), control, [&](int row) {
    for (const SphereColumn& column : columns) draw_row(image, column, lit, tone_map, row);
  });
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const glm::dvec2 centre = grid.centre(static_cast<int>(column), static_cast<int>(row));
      const std::string label = std::string(rows[row]->name) + ' ' + significant(kRoughness[column], 2);
      image.write(label, centre.x, centre.y + 0.5 * sphere + 1.8 * grid.letters(), grid.letters());
    }
  }
  return image;
}

constexpr int kPanoramaHeight = 512;
constexpr int kMipHeight = 160;

using Drawing = std::function<PreviewImage()>;

WrittenPreview written(const char* name, const char* what, const Drawing& draw, const std::filesystem::path& folder) {
  const PreviewImage image = draw();
  image.save(folder / name);
  return {name, what, image.width(), image.height()};
}

}  // namespace

std::vector<WrittenPreview> write_previews(const BakeResult& light, const PreviewOptions& options,
                                           const std::filesystem::path& folder, const Control& control) {
  std::vector<std::function<WrittenPreview()>> work;
  const auto add = [&](const char* name, const char* what, Drawing draw) {
    work.emplace_back([=, &folder] { return written(name, what, draw, folder); });
  };
  if (light.specular && light.background) {
    add("preview_spheres.png", "metal and dielectric spheres at roughness 0, 0.2, ..., 1, seen along Welkin's -z",
        [&] { return preview_spheres(light, options.tone_map, options.sphere, control); });
  }
  if (light.background) {
    add("preview_environment.png", "the surroundings as seen from inside, Welkin's +z in the middle",
        [&] { return preview_environment(CubeLookup(*light.background), options.tone_map, kPanoramaHeight, control); });
  }
  if (light.specular) {
    add("preview_mips.png", "the specular mips as lat-longs, sharpest first",
        [&] { return preview_mips(light, options.tone_map, kMipHeight, control); });
  }
  // Concurrently: while one is packed, another is drawn.
  std::vector<WrittenPreview> images(work.size());
  const jobs::Placement where = jobs::Placement::arena;
  jobs::run_tiles(work.size(), where, jobs::worker_count(where), {control.stop, {}},
                  [&](std::size_t index, std::size_t) { images[index] = work[index](); });
  return images;
}

}  // namespace welkin::tool
