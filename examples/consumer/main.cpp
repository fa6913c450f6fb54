// The light of a small cubemap: a blue sky above grey walls and a dark floor.
#include <welkin/bake.h>
#include <welkin/spherical_harmonics.h>

#include <cstdio>
#include <vector>

namespace {

// Where a renderer would upload a face of RGB floats to the GPU.
void upload(int /*face*/, int /*mip*/, const float* /*rgb*/) {}

}  // namespace

int main() {
  constexpr int kSize = 16;
  const auto face_of = [](float r, float g, float b) {
    std::vector<float> pixels;
    for (int i = 0; i < kSize * kSize; ++i) pixels.insert(pixels.end(), {r, g, b});
    return pixels;
  };
  const auto wall = face_of(0.5F, 0.5F, 0.5F);
  const auto sky = face_of(0.4F, 0.7F, 1.5F);
  const auto floor = face_of(0.1F, 0.1F, 0.1F);

  // Six faces of packed rows, wherever they lie in memory: +X -X +Y -Y +Z -Z.
  const welkin::CubemapView view{{wall.data(), wall.data(), sky.data(), floor.data(), wall.data(), wall.data()},
                                 kSize,
                                 0,
                                 welkin::PixelFormat::rgb32f};
  const welkin::BakeResult light = welkin::bake(view, {.specular = welkin::PrefilterOptions{.size = 32}});
  for (int mip = 0; mip < light.specular->cubemap.levels(); ++mip) {
    for (int face = 0; face < 6; ++face) upload(face, mip, light.specular->cubemap.face(mip, face));
  }
  const welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(*light.radiance);
  const glm::dvec3 up = welkin::evaluate(irradiance, {0.0, 1.0, 0.0});
  std::printf("irradiance on the ground: %.4f %.4f %.4f (estimated error %.1e)\n", up.x, up.y, up.z,
              light.diagnostics.error_estimate);
}
