#include "support/sun_maps.h"

#include "image/geometry.h"
#include "support/catch.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;
/// Returns the solid angle of the face's rectangle from the middle to (u, v).
double corner(double u, double v) { return std::atan2(u * v, std::sqrt(u * u + v * v + 1.0)); }

struct Disc {
  glm::dvec3 direction;
  double radius_degrees;
  glm::dvec3 radiance;
};

struct Coverage {
  double inside = 0.0;
  double all = 0.0;
};

/// Sums the rectangle of a texel from (x, y), `edge` wide and high (a texel being 1), by parts that lie wholly in the
/// disc or wholly outside. A part that the rim still cuts at a width of 1/128 counts by its middle. `place(right,
/// down)` gives a direction, `density(direction)` its share of solid angle.
template <class Place, class Density>
void cover(const Disc& disc, const Place& place, const Density& density, double x, double y, double edge,
           Coverage& sum) {
  const glm::dvec3 middle = place(x + 0.5 * edge, y + 0.5 * edge);
  const double distance = degrees_between(middle, disc.direction);
  const double reach = 0.75 * (degrees_between(place(x, y), place(x + edge, y + edge)) +
                               degrees_between(place(x + edge, y), place(x, y + edge)));
  if (edge > 0x1p-7 && std::abs(distance - disc.radius_degrees) < reach) {
    for (const double dy : {0.0, 0.5 * edge}) {
      for (const double dx : {0.0, 0.5 * edge}) cover(disc, place, density, x + dx, y + dy, 0.5 * edge, sum);
    }
    return;
  }
  const double weight = density(middle) * edge * edge;
  sum.all += weight;
  if (distance <= disc.radius_degrees) sum.inside += weight;
}

template <class Place, class Density>
void blend_texel(float* rgb, const Disc& disc, const Place& place, const Density& density) {
  Coverage sum;
  cover(disc, place, density, 0.0, 0.0, 1.0, sum);
  const double share = sum.inside / sum.all;
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>((1.0 - share) * rgb[c] + share * disc.radiance[c]);
}

/// Calls paint(texel) for all texels that the disc may reach, by their centres. `texel_degrees`: the longest edge.
template <class Paint>
void for_texels_near(const image::TexelGrid& grid, const glm::dvec3& direction, double radius_degrees,
                     double texel_degrees, const Paint& paint) {
  const double least_cosine = std::cos((radius_degrees + texel_degrees) * kPi / 180.0);
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    if (glm::dot(grid.direction(texel), direction) >= least_cosine) paint(texel);
  }
}

glm::dvec3 finite(const float* rgb) {
  const glm::dvec3 value(rgb[0], rgb[1], rgb[2]);
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z) ? value : glm::dvec3{};
}

}  // namespace

LatLongImage grey_lat_long(int width, int height, float value) {
  return {width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height), value)};
}

Cubemap grey_cubemap(int size, float value) {
  return {size, std::vector<float>(static_cast<std::size_t>(18 * size * size), value)};
}

image::TexelGrid grid_of(const LatLongImage& image) { return image::TexelGrid::lat_long(image.width, image.height); }
image::TexelGrid grid_of(const Cubemap& image) { return image::TexelGrid::cubemap(image.size()); }

void paint_disc(LatLongImage& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance) {
  const auto density = [](const glm::dvec3& d) { return std::sqrt(d.x * d.x + d.z * d.z); };
  for_texels_near(grid_of(image), direction, radius_degrees, 360.0 / image.height, [&](std::int64_t texel) {
    const auto place = [&](double right, double down) {
      return image::lat_long_direction(image.width, image.height, static_cast<double>(texel % image.width) + right,
                                       static_cast<double>(texel / image.width) + down);
    };
    blend_texel(image.pixels.data() + 3 * texel, {direction, radius_degrees, radiance}, place, density);
  });
}

void paint_disc(Cubemap& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance) {
  const auto density = [](const glm::dvec3& d) {
    const double along_normal = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return along_normal * along_normal * along_normal;
  };
  for_texels_near(grid_of(image), direction, radius_degrees, 180.0 / image.size(), [&](std::int64_t texel) {
    const auto row = static_cast<int>(texel / image.size());
    const auto place = [&](double right, double down) {
      return image::face_direction(image.size(), row / image.size(), static_cast<double>(texel % image.size()) + right,
                                   row % image.size() + down);
    };
    blend_texel(image.face(0) + 3 * texel, {direction, radius_degrees, radiance}, place, density);
  });
}

double disc_solid_angle(double radius_degrees) { return 2.0 * kPi * (1.0 - std::cos(radius_degrees * kPi / 180.0)); }

std::int64_t nearest_texel(const image::TexelGrid& grid, const glm::dvec3& direction) {
  std::int64_t nearest = 0;
  double best = -2.0;
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    const double cosine = glm::dot(grid.direction(texel), direction);
    if (cosine > best) nearest = texel;
    best = std::max(best, cosine);
  }
  return nearest;
}

glm::dvec3 total_radiance_of(const LatLongImage& image) {
  glm::dvec3 sum{};
  for (int row = 0; row < image.height; ++row) {
    const double top = std::cos(kPi * row / image.height);
    const double bottom = std::cos(kPi * (row + 1) / image.height);
    for (int column = 0; column < image.width; ++column) {
      sum += 2.0 * kPi / image.width * (top - bottom) *
             finite(&image.pixels[static_cast<std::size_t>(3 * (row * image.width + column))]);
    }
  }
  return sum;
}

glm::dvec3 total_radiance_of(const Cubemap& image) {
  const int size = image.size();
  const auto edge = [&](int i) { return 2.0 * i / size - 1.0; };
  glm::dvec3 sum{};
  for (int texel = 0; texel < 6 * size * size; ++texel) {
    const int column = texel % size;
    const int row = texel / size % size;
    const double steradians = corner(edge(column + 1), edge(row + 1)) - corner(edge(column), edge(row + 1)) -
                              corner(edge(column + 1), edge(row)) + corner(edge(column), edge(row));
    sum += steradians * finite(&image.pixels()[static_cast<std::size_t>(3 * texel)]);
  }
  return sum;
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / kPi;
}

}  // namespace welkin::test
