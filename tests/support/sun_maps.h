// Maps with suns painted on, for both kinds of image.
#pragma once

#include "image/geometry.h"
#include "standard_headers.h"
#include "welkin/image.h"

namespace welkin::test {

/// The same grey everywhere.
LatLongImage grey_lat_long(int width, int height, float value);
Cubemap grey_cubemap(int size, float value);

image::TexelGrid grid_of(const LatLongImage& image);
image::TexelGrid grid_of(const Cubemap& image);

/// Paints a disc of uniform radiance over what is there: every texel by the share of its area that the disc covers
/// (to 1/128 of its edges). `direction` is a unit vector.
void paint_disc(LatLongImage& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance);
void paint_disc(Cubemap& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance);

/// Steradians of a disc.
double disc_solid_angle(double radius_degrees);

/// The texel whose centre is nearest to a direction.
std::int64_t nearest_texel(const image::TexelGrid& grid, const glm::dvec3& direction);

/// Integral over the sphere, of texels whose three channels are finite, by closed forms of the texels' solid angles.
glm::dvec3 total_radiance_of(const LatLongImage& image);
glm::dvec3 total_radiance_of(const Cubemap& image);

/// Degrees between two unit vectors.
double degrees_between(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace welkin::test
