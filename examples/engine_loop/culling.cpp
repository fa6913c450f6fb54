#include "culling.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace engine_loop {
namespace {

constexpr float kSceneRadius_m = 500.0F;

glm::vec4 plane(const glm::vec3& normal, float w) { return {glm::normalize(normal), w}; }

}  // namespace

Frustum frustum_towards(float angle) {
  const glm::vec3 ahead(std::sin(angle), 0.0F, std::cos(angle));
  const glm::vec3 right(ahead.z, 0.0F, -ahead.x);
  const glm::vec3 up(0.0F, 1.0F, 0.0F);
  // Ninety degrees wide, some sixty high, from 0.1 m to 400 m.
  return {plane(ahead + right, 0.0F),     plane(ahead - right, 0.0F), plane(0.5F * ahead + up, 0.0F),
          plane(0.5F * ahead - up, 0.0F), plane(ahead, -0.1F),        plane(-ahead, 400.0F)};
}

Scene::Scene(std::size_t objects) : spheres_(objects), visible_(objects) {
  std::minstd_rand random(1);
  std::uniform_real_distribution<float> place(-kSceneRadius_m, kSceneRadius_m);
  std::uniform_real_distribution<float> radius(0.2F, 5.0F);
  for (glm::vec4& sphere : spheres_) sphere = {place(random), 0.1F * place(random), place(random), radius(random)};
}

void Scene::cull(const Frustum& frustum, std::size_t begin, std::size_t end) noexcept {
  for (std::size_t object = begin; object < end; ++object) {
    const glm::vec4 sphere = spheres_[object];
    visible_[object] = std::all_of(frustum.begin(), frustum.end(), [&](const glm::vec4& side) {
      return glm::dot(glm::vec3(side), glm::vec3(sphere)) + side.w >= -sphere.w;
    });
  }
}

}  // namespace engine_loop
