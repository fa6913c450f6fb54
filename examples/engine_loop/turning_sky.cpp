#include "turning_sky.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace engine_loop {
namespace {

/// The axes of CubemapView's table: normal, along u, along v.
struct Face {
  glm::vec3 normal, along_u, along_v;
};

constexpr std::array<Face, 6> kFaces{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                      {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                      {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                      {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                      {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                      {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

constexpr glm::vec3 kZenith(0.2F, 0.4F, 1.0F), kHorizon(0.8F, 0.9F, 1.0F), kGround(0.1F, 0.09F, 0.08F);
constexpr glm::vec3 kSun(900.0F, 800.0F, 600.0F);

/// x^512: a lobe some three degrees wide.
float lobe(float x) {
  x = std::max(x, 0.0F);
  for (int i = 0; i < 9; ++i) x *= x;
  return x;
}

glm::vec3 radiance(const glm::vec3& direction, const glm::vec3& sun) {
  if (direction.y < 0.0F) return kGround;
  return kHorizon + direction.y * (kZenith - kHorizon) + lobe(glm::dot(direction, sun)) * kSun;
}

/// Row `row` of the strip that all six faces make.
void fill_row(welkin::Cubemap& image, int row, const glm::vec3& sun) {
  const Face& face = kFaces[static_cast<std::size_t>(row / image.size())];
  const float step = 2.0F / static_cast<float>(image.size());
  const float v = (static_cast<float>(row % image.size()) + 0.5F) * step - 1.0F;
  float* texel = image.face(0) + std::ptrdiff_t{3} * image.size() * row;
  for (int column = 0; column < image.size(); ++column, texel += 3) {
    const float u = (static_cast<float>(column) + 0.5F) * step - 1.0F;
    const glm::vec3 colour = radiance(glm::normalize(face.normal + u * face.along_u + v * face.along_v), sun);
    texel[0] = colour.r;
    texel[1] = colour.g;
    texel[2] = colour.b;
  }
}

}  // namespace

welkin::Cubemap sky_cubemap(int size, double sun_angle) {
  constexpr double kHalfRoot = 0.70710678118654752;
  const glm::vec3 sun(kHalfRoot * std::sin(sun_angle), kHalfRoot, kHalfRoot * std::cos(sun_angle));
  welkin::Cubemap image(size);
  tbb::parallel_for(tbb::blocked_range<int>(0, 6 * size, 16), [&](const tbb::blocked_range<int>& rows) {
    for (int row = rows.begin(); row != rows.end(); ++row) fill_row(image, row, sun);
  });
  return image;
}

welkin::Projection TurningSky::operator()(const welkin::Control& control) const {
  const welkin::Cubemap sky = sky_cubemap(size, sun_angle);
  return welkin::project(sky.view(), {}, control);
}

}  // namespace engine_loop
