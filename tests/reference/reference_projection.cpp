#include "reference/reference_projection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "math/quadrature.h"
#include "projection/box_reduction.h"
#include "projection/sanitizer.h"
#include "transform/frame_transform.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;

/// A rectangle of an image's domain: (u, v) of a cubemap face, or longitude and latitude.
struct Rectangle {
  double x0, x1, y0, y1;
};

/// A point of the domain as a direction, and the solid angle per area there.
struct DomainPoint {
  glm::dvec3 direction;
  double density;
};

using Domain = std::function<DomainPoint(double x, double y)>;

/// Sanitized pixels in double, width x height with row 0 at the top, and their extent in the domain.
struct Image {
  int width;
  int height;
  std::vector<glm::dvec3> radiance;
  Rectangle extent;  ///< from the first texel's outer corner to the last one's

  [[nodiscard]] Rectangle texels(double column0, double column1, double row0, double row1) const {
    const double dx = (extent.x1 - extent.x0) / width;
    const double dy = (extent.y1 - extent.y0) / height;
    return {extent.x0 + column0 * dx, extent.x0 + column1 * dx, extent.y0 + row0 * dy, extent.y0 + row1 * dy};
  }
};

/// Integration rule along each edge of a texel: equal panels, with a Gauss rule on each.
struct TexelRule {
  int order;
  int panels;
};

/// Returns a rule that integrates a harmonic over a texel to double precision, with `texels` along a face's edge or
/// around the sphere. A lone texel spans all 15 waves of the highest band, more than one Gauss rule follows.
TexelRule texel_rule(int texels) {
  if (texels < 2) return {28, 2};
  return {texels < 4 ? 28 : texels < 16 ? 12 : texels < 64 ? 6 : 4, 1};
}

using AddPoint = std::function<void(const glm::dvec3& direction, double solid_angle)>;

/// Calls `f`, which accumulates, with the points of a rule over the rectangle and their solid angles.
void integrate_panel(const Domain& domain, const Rectangle& r, int order, const AddPoint& f) {
  const math::GaussRule rule = math::gauss_legendre(order);
  const double half_x = 0.5 * (r.x1 - r.x0);
  const double half_y = 0.5 * (r.y1 - r.y0);
  for (int j = 0; j < order; ++j) {
    for (int i = 0; i < order; ++i) {
      const DomainPoint p = domain(r.x0 + half_x * (1.0 + rule.nodes[i]), r.y0 + half_y * (1.0 + rule.nodes[j]));
      f(p.direction, rule.weights[i] * rule.weights[j] * std::abs(half_x * half_y) * p.density);
    }
  }
}

void integrate(const Domain& domain, const Rectangle& r, const TexelRule& rule, const AddPoint& f) {
  const double dx = (r.x1 - r.x0) / rule.panels;
  const double dy = (r.y1 - r.y0) / rule.panels;
  for (int j = 0; j < rule.panels; ++j) {
    for (int i = 0; i < rule.panels; ++i) {
      const double x = r.x0 + i * dx;
      const double y = r.y0 + j * dy;
      integrate_panel(domain, {x, x + dx, y, y + dy}, rule.order, f);
    }
  }
}

double solid_angle(const Domain& domain, const Rectangle& r, const TexelRule& rule) {
  double sum = 0.0;
  integrate(domain, r, rule, [&](const glm::dvec3&, double weight) { sum += weight; });
  return sum;
}

/// Calls `use(cell, begin, end)` for each of `cells` equal cells that texel [index, index + 1) overlaps.
void for_each_cell(int index, int count, int cells, const std::function<void(int, double, double)>& use) {
  for (int cell = 0; cell < cells; ++cell) {
    const double begin = std::max(static_cast<double>(index), static_cast<double>(cell) * count / cells);
    const double end = std::min(index + 1.0, (cell + 1.0) * count / cells);
    if (end > begin) use(cell, begin, end);
  }
}

/// Averages an image to `width` x `height` texels, by solid angle or by plain area of pixels.
Image reduce(const Domain& domain, const Image& image, int width, int height, bool by_solid_angle) {
  Image reduced{width, height, {}, image.extent};
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<double> areas(count);
  reduced.radiance.resize(count);
  const TexelRule rule = texel_rule(std::min(image.width, image.height));
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const glm::dvec3 radiance = image.radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                                 static_cast<std::size_t>(column)];
      for_each_cell(row, image.height, height, [&](int cell_row, double row0, double row1) {
        for_each_cell(column, image.width, width, [&](int cell_column, double column0, double column1) {
          const double area = by_solid_angle ? solid_angle(domain, image.texels(column0, column1, row0, row1), rule)
                                             : (column1 - column0) * (row1 - row0);
          const auto cell = static_cast<std::size_t>(cell_row) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(cell_column);
          reduced.radiance[cell] += area * radiance;
          areas[cell] += area;
        });
      });
    }
  }
  for (std::size_t cell = 0; cell < count; ++cell) reduced.radiance[cell] /= areas[cell];
  return reduced;
}

void add_image(const Domain& domain, const Image& image, Quadrature quadrature, SphericalHarmonics& sum) {
  std::vector<double> basis(sum.coefficients().size());
  const auto add = [&](const glm::dvec3& direction, const glm::dvec3& total_radiance) {
    math::evaluate_basis(direction.x, direction.y, direction.z, sum.bands(), basis.data());
    for (std::size_t k = 0; k < basis.size(); ++k) sum.coefficients()[k] += total_radiance * basis[k];
  };
  const TexelRule rule = texel_rule(std::min(image.width, image.height));
  std::size_t index = 0;
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column, ++index) {
      const glm::dvec3& radiance = image.radiance[index];
      const Rectangle texel = image.texels(column, column + 1.0, row, row + 1.0);
      if (quadrature == Quadrature::exact) {
        integrate(domain, texel, rule,
                  [&](const glm::dvec3& direction, double weight) { add(direction, weight * radiance); });
      } else {
        const glm::dvec3 centre = domain(0.5 * (texel.x0 + texel.x1), 0.5 * (texel.y0 + texel.y1)).direction;
        add(centre, solid_angle(domain, texel, rule) * radiance);
      }
    }
  }
}

/// Decodes and sanitizes an image's texels.
Image read_image(const void* pixels, std::ptrdiff_t row_stride_bytes, PixelFormat format, int width, int height,
                 const Rectangle& extent, const projection::Sanitizer& policy) {
  Image image{width, height, {}, extent};
  const auto texel_bytes = static_cast<std::ptrdiff_t>(bytes_per_texel(format));
  const std::ptrdiff_t row_bytes = row_stride_bytes != 0 ? row_stride_bytes : texel_bytes * width;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      float rgb[3];
      image::decode_texels(format, static_cast<const std::byte*>(pixels) + row * row_bytes + column * texel_bytes, 1,
                           rgb);
      const float no_weight = 0.0F;
      projection::SanitizeRecord record;
      policy.sanitize({rgb, 1, 0, row, column, &no_weight, 1, 0.0}, record);
      projection::throw_if_rejected(record, false);
      image.radiance.emplace_back(rgb[0], rgb[1], rgb[2]);
    }
  }
  return image;
}

}  // namespace

SphericalHarmonics reference_projection(const CubemapView& cubemap, const ProjectionOptions& options) {
  image::check_view(cubemap);
  projection::check_options(options);
  if (options.quadrature == Quadrature::midpoint && options.target_size) {
    int target = 1;
    while (target <= *options.target_size / 2) target *= 2;
    ProjectionOptions unreduced = options;
    unreduced.target_size.reset();
    if (target >= cubemap.size) return reference_projection(cubemap, unreduced);
    return reference_projection(projection::reduce_by_box(cubemap, target, options, {}).view(), unreduced);
  }
  const projection::Sanitizer policy(options.pixels);
  SphericalHarmonics sum(options.bands);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    const Domain domain = [&frame](double u, double v) -> DomainPoint {
      const double r = std::sqrt(1.0 + u * u + v * v);
      return {(u * frame.u + v * frame.v + frame.normal) / r, 1.0 / (r * r * r)};
    };
    Image image = read_image(cubemap.faces[static_cast<std::size_t>(face)], cubemap.row_stride_bytes, cubemap.format,
                             cubemap.size, cubemap.size, {-1.0, 1.0, -1.0, 1.0}, policy);
    if (options.target_size && *options.target_size < cubemap.size) {
      image = reduce(domain, image, *options.target_size, *options.target_size, true);
    }
    add_image(domain, image, options.quadrature, sum);
  }
  return sum;
}

SphericalHarmonics reference_projection(const LatLongView& lat_long, const ProjectionOptions& options) {
  image::check_view(lat_long);
  projection::check_options(options);
  const Domain domain = [](double longitude, double latitude) -> DomainPoint {
    const double ring = std::cos(latitude);
    return {{std::sin(longitude) * ring, std::sin(latitude), std::cos(longitude) * ring}, ring};
  };
  Image image = read_image(lat_long.pixels, lat_long.row_stride_bytes, lat_long.format, lat_long.width, lat_long.height,
                           {kPi, -kPi, 0.5 * kPi, -0.5 * kPi}, projection::Sanitizer(options.pixels));
  if (options.target_size) {
    image = reduce(domain, image, std::min(image.width, 4 * *options.target_size),
                   std::min(image.height, 2 * *options.target_size), options.quadrature == Quadrature::exact);
  }
  SphericalHarmonics sum(options.bands);
  add_image(domain, image, options.quadrature, sum);
  return sum;
}

}  // namespace welkin
