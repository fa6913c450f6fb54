// Maps with painted suns, for both kinds of image.
#pragma once

#include "image/geometry.h"
#include "standard_headers.h"
#include "welkin/image.h"

namespace welkin::test {

/// Returns an image of uniform grey.
LatLongImage grey_lat_long(int width, int height, float value);
Cubemap grey_cubemap(int size, float value);

image::TexelGrid grid_of(const LatLongImage& image);
image::TexelGrid grid_of(const Cubemap& image);

/// Paints a disc of uniform radiance over the image: every texel by the fraction of its area that the disc covers (to
/// 1/128 of its edges). `direction` is a unit vector.
void paint_disc(LatLongImage& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance);
void paint_disc(Cubemap& image, const glm::dvec3& direction, double radius_degrees, const glm::dvec3& radiance);

/// Returns a disc's solid angle in steradians.
double disc_solid_angle(double radius_degrees);

/// Returns the texel whose centre is nearest to a direction.
std::int64_t nearest_texel(const image::TexelGrid& grid, const glm::dvec3& direction);

/// Returns the integral over the sphere of texels with finite channels, by closed forms of their solid angles.
glm::dvec3 total_radiance_of(const LatLongImage& image);
glm::dvec3 total_radiance_of(const Cubemap& image);

/// Returns the angle in degrees between two unit vectors.
double degrees_between(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace welkin::test
