// The light of a small cubemap: a blue sky above grey walls and a dark floor.
#include <welkin/projection.h>
#include <welkin/spherical_harmonics.h>

#include <cstdio>
#include <vector>

int main() {
  constexpr int kSize = 16;
  const auto face = [](float r, float g, float b) {
    std::vector<float> pixels;
    for (int i = 0; i < kSize * kSize; ++i) pixels.insert(pixels.end(), {r, g, b});
    return pixels;
  };
  const auto wall = face(0.5F, 0.5F, 0.5F);
  const auto sky = face(0.4F, 0.7F, 1.5F);
  const auto floor = face(0.1F, 0.1F, 0.1F);

  // +X -X +Y -Y +Z -Z, rows packed
  const welkin::CubemapView view{{wall.data(), wall.data(), sky.data(), floor.data(), wall.data(), wall.data()},
                                 kSize,
                                 0,
                                 welkin::PixelFormat::rgb_f32};
  const welkin::Projection light = welkin::project(view);
  const auto irradiance = welkin::irradiance_from_radiance(light.radiance);
  const glm::dvec3 up = welkin::evaluate(irradiance, {0.0, 1.0, 0.0});
  std::printf("irradiance on the ground: %.4f %.4f %.4f (estimated error %.1e)\n", up.x, up.y, up.z,
              light.diagnostics.error_estimate);
}
