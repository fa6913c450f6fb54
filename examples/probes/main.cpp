// A light probe in a 60 Hz loop. Each frame the engine renders one of the probe's six faces again and posts all six to
// a worker; when the light is there, it goes to the shader as Unity's seven vectors. No frame waits for light, and no
// pixel is copied: a post shares the memory that the faces were rendered to.
#include <welkin/core.h>
#include <welkin/engines.h>
#include <welkin/image.h>
#include <welkin/projection.h>
#include <welkin/requests.h>
#include <welkin/spherical_harmonics.h>
#include <welkin/worker.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "cube_frames.h"

namespace {

constexpr int kSize = 128;    // texels along an edge of a face
constexpr int kFrames = 120;  // two seconds
constexpr std::chrono::microseconds kFrameTime{16'667};

// ---- What the engine has: faces that its renderer makes

/// The pixels of one face, row 0 on top.
using Face = std::vector<welkin::vec3>;

/// Stands for the engine's renderer: a blue sky over brown ground, and a lamp that goes round in two seconds.
Face render(int face, int frame) {
  const double angle = 2.0 * 3.14159265358979323846 * frame / kFrames;
  const welkin::dvec3 lamp(0.8 * std::cos(angle), 0.6, 0.8 * std::sin(angle));
  Face pixels;
  pixels.reserve(std::size_t{kSize} * kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      const welkin::dvec3 direction = cube_frames::direction_of(face, column, row, kSize);
      const welkin::dvec3 surroundings =
          direction.y > 0.0 ? welkin::dvec3(0.3, 0.5, 0.9) : welkin::dvec3(0.25, 0.2, 0.15);
      const double glow = 20.0 * std::exp(40.0 * (glm::dot(direction, lamp) - 1.0));
      pixels.emplace_back(surroundings + glow * welkin::dvec3(1.0, 0.8, 0.5));
    }
  }
  return pixels;
}

/// The probe's newest faces. A face that is rendered again takes another block of memory, so that jobs which still read
/// the old one are not disturbed. A block is freed when neither the probe nor a job has it any more.
class Probe {
 public:
  Probe() {
    for (int face = 0; face < 6; ++face) render_face(face, 0);
  }

  void render_face(int face, int frame) {
    faces_[static_cast<std::size_t>(face)] = std::make_shared<const Face>(render(face, frame));
  }

  [[nodiscard]] welkin::CubemapView view() const {
    welkin::CubemapView view{.faces = {}, .size = kSize, .format = welkin::PixelFormat::rgb32f};
    for (std::size_t face = 0; face < faces_.size(); ++face) view.faces[face] = faces_[face]->data();
    return view;
  }

  /// The faces as they are now, for a request: six pointers are copied, and no pixel.
  [[nodiscard]] welkin::EnvironmentSource source() const { return {view(), std::make_shared<const Faces>(faces_)}; }

 private:
  using Faces = std::array<std::shared_ptr<const Face>, 6>;

  Faces faces_;
};

// ---- What the shader reads

/// unity_SHAr, unity_SHAg, unity_SHAb, unity_SHBr, unity_SHBg, unity_SHBb and unity_SHC: a block of constants.
using ShaderLight = std::array<std::array<float, 4>, 7>;

/// The faces of this engine are named after its own axes, which are Unity's. So what is projected from them lies in
/// these axes already, and must not be turned from Welkin's: hence `engine_light_unrotated` and not `engine_light`.
ShaderLight shader_light(const welkin::SphericalHarmonics& radiance) {
  const welkin::EngineLight light = welkin::engine_light_unrotated(radiance, welkin::Engine::unity);
  ShaderLight constants{};
  for (std::size_t k = 0; k < constants.size(); ++k) {
    const welkin::dvec4& value = light.vectors.at(k).value;
    for (int component = 0; component < 4; ++component) {
      constants[k][static_cast<std::size_t>(component)] = static_cast<float>(value[component]);
    }
  }
  return constants;
}

/// ShadeSH9 of Unity's UnityCG.cginc, for one channel: what a white matte surface shows.
double shade_sh9(const ShaderLight& light, std::size_t channel, const welkin::dvec3& n) {
  const std::array<float, 4>& a = light[channel];
  const std::array<float, 4>& b = light[3 + channel];
  return a[0] * n.x + a[1] * n.y + a[2] * n.z + a[3] + b[0] * n.x * n.y + b[1] * n.y * n.z + b[2] * n.z * n.z +
         b[3] * n.z * n.x + light[6][channel] * (n.x * n.x - n.y * n.y);
}

// ---- Checks

bool same_bits(const welkin::SphericalHarmonics& a, const welkin::SphericalHarmonics& b) {
  const std::span<const welkin::dvec3> left = a.coefficients();
  const std::span<const welkin::dvec3> right = b.coefficients();
  return left.size() == right.size() && std::memcmp(left.data(), right.data(), left.size_bytes()) == 0;
}

/// The largest difference between what the shader computes and what the harmonics say, relative to the mean radiance.
double shader_error(const ShaderLight& light, const welkin::SphericalHarmonics& radiance) {
  const auto shown = welkin::lambertian_from_irradiance(welkin::irradiance_from_radiance(radiance));
  const welkin::dvec3 mean = welkin::mean_radiance(radiance);
  double largest = 0.0;
  for (int face = 0; face < 6; ++face) {
    const welkin::dvec3 normal = cube_frames::direction_of(face, kSize / 3, kSize / 5, kSize);
    const welkin::dvec3 expected = welkin::evaluate(shown, normal);
    for (int channel = 0; channel < 3; ++channel) {
      const double shaded = shade_sh9(light, static_cast<std::size_t>(channel), normal);
      largest = std::max(largest, std::abs(shaded - expected[channel]) / mean[channel]);
    }
  }
  return largest;
}

// ---- The loop

/// Takes the light of a job if it is there, without waiting. Throws if the job failed.
std::optional<welkin::Projection> poll(welkin::Job<welkin::Projection>& job) {
  if (auto light = job.try_take()) return light;
  if (const auto error = job.error()) throw std::runtime_error(error->message);
  return std::nullopt;
}

int run() {
  Probe probe;
  welkin::Worker worker;
  welkin::Job<welkin::Projection> job;
  std::optional<welkin::Projection> newest;
  ShaderLight constants{};
  int updates = 0;

  for (int frame = 0; frame < kFrames; ++frame) {
    const auto start = std::chrono::steady_clock::now();
    if (auto light = poll(job)) {
      newest = std::move(light);
      constants = shader_light(newest->radiance);
      ++updates;
    }
    probe.render_face(frame % 6, frame);

    // The key cancels the job of the frame before, if that is not ready. If jobs usually took longer than a frame, none
    // would ever complete; an engine would then post only if the last job is ready.
    job = worker.post(welkin::Project{probe.source()}, {.key = "probe"});
    std::this_thread::sleep_until(start + kFrameTime);
  }

  while (!job.ready()) std::this_thread::sleep_for(kFrameTime);
  if (auto light = poll(job)) {
    newest = std::move(light);
    constants = shader_light(newest->radiance);
    ++updates;
  }
  if (!newest) throw std::runtime_error("no light arrived");

  const bool same = same_bits(newest->radiance, welkin::project(probe.view()).radiance);
  const double error = shader_error(constants, newest->radiance);
  std::printf("%d frames, %d times new light; the last has %s direct call's bits; the shader is within %.1e of it\n",
              kFrames, updates, same ? "the" : "NOT the", error);
  return same && error < 1e-5 ? 0 : 1;
}

}  // namespace

int main() {
  try {
    return run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "probes: %s\n", error.what());
    return 1;
  }
}
