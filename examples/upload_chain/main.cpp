// Reflections written directly to an upload buffer. The engine makes a panorama, lends its threads to a worker, and
// posts a bake that writes the prefiltered chain as half floats to the engine's memory, with the row pitch and
// alignment that D3D12 requires for copies from buffers to textures.
#include <own_executor/pool_executor.h>
#include <own_executor/thread_pool.h>
#include <probes/cube_frames.h>
#include <welkin/bake.h>
#include <welkin/core.h>
#include <welkin/image.h>
#include <welkin/reflections.h>
#include <welkin/requests.h>
#include <welkin/worker.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace {

constexpr double kPi = 3.14159265358979323846;

// ---- The environment

/// Radiance from a direction of unit length: other colours on each side, and a soft sun.
welkin::dvec3 radiance(const welkin::dvec3& direction) {
  const welkin::dvec3 sun(0.48, 0.6, 0.64);
  const double glow = 4.0 * std::exp(8.0 * (glm::dot(direction, sun) - 1.0));
  return welkin::dvec3(0.6, 0.6, 0.8) + 0.4 * direction + glow * welkin::dvec3(1.0, 0.9, 0.7);
}

/// The same as a lat-long, in the orientation of `welkin::LatLongView`.
welkin::LatLongImage panorama(int height) {
  welkin::LatLongImage image{.width = 2 * height, .height = height, .pixels = {}};
  image.pixels.reserve(std::size_t{6} * static_cast<std::size_t>(height) * static_cast<std::size_t>(height));
  for (int row = 0; row < image.height; ++row) {
    const double latitude = kPi / 2.0 - kPi * (row + 0.5) / image.height;
    for (int column = 0; column < image.width; ++column) {
      const double longitude = kPi - 2.0 * kPi * (column + 0.5) / image.width;
      const welkin::dvec3 colour = radiance(
          {std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)});
      for (int channel = 0; channel < 3; ++channel) image.pixels.push_back(static_cast<float>(colour[channel]));
    }
  }
  return image;
}

// ---- What lies in the buffer afterwards

constexpr std::byte kUntouched{0xCD};  // what the buffer is filled with before the bake

using Texel = std::array<std::uint16_t, 4>;  // red, green, blue, alpha as half floats

const std::byte* texel_at(const welkin::CubemapTarget& target, int face, int column, int row) {
  return static_cast<const std::byte*>(target.faces[static_cast<std::size_t>(face)]) + row * target.row_stride_bytes +
         column * static_cast<std::ptrdiff_t>(sizeof(Texel));
}

Texel read_texel(const welkin::CubemapTarget& target, int face, int column, int row) {
  Texel texel{};
  std::memcpy(texel.data(), texel_at(target, face, column, row), sizeof texel);
  return texel;
}

/// The largest relative difference of mip 0, whose roughness is 0, to the environment itself.
double error_of_mip_0(const welkin::CubemapTarget& target) {
  double largest = 0.0;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < target.size; ++row) {
      for (int column = 0; column < target.size; ++column) {
        const welkin::dvec3 expected = radiance(cube_frames::direction_of(face, column, row, target.size));
        const Texel texel = read_texel(target, face, column, row);
        for (int channel = 0; channel < 3; ++channel) {
          const double stored = glm::unpackHalf1x16(texel[static_cast<std::size_t>(channel)]);
          largest = std::max(largest, std::abs(stored / expected[channel] - 1.0));
        }
      }
    }
  }
  return largest;
}

/// Returns whether all texels of all mips were written (alpha is 1), and no byte between them.
bool written_exactly(const std::vector<welkin::CubemapTarget>& targets, std::vector<std::byte> memory,
                     const std::byte* start) {
  constexpr std::uint16_t kOne = 0x3C00;
  for (const welkin::CubemapTarget& target : targets) {
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < target.size; ++row) {
        for (int column = 0; column < target.size; ++column) {
          if (read_texel(target, face, column, row)[3] != kOne) return false;
        }
        const auto first = memory.begin() + (texel_at(target, face, 0, row) - start);
        std::fill(first, first + target.size * static_cast<std::ptrdiff_t>(sizeof(Texel)), kUntouched);
      }
    }
  }
  return std::all_of(memory.begin(), memory.end(), [](std::byte byte) { return byte == kUntouched; });
}

/// The roughness that a shader finds at a mip, fractions too, if it interpolates between mips.
double roughness_at(const std::vector<double>& mip_roughness, double mip) {
  const double below = std::floor(mip);
  const auto index = static_cast<std::size_t>(below);
  const double here = mip_roughness[index];
  return index + 1 < mip_roughness.size() ? std::lerp(here, mip_roughness[index + 1], mip - below) : here;
}

int run() {
  // Seven mips from 128 texels to 2. This engine has many smooth materials, so most of its mips are for low roughness.
  const std::vector<double> roughness{0.0, 0.08, 0.17, 0.28, 0.42, 0.65, 1.0};
  const welkin::UploadLayout layout{.format = welkin::TexelFormat::rgba16f,
                                    .size = 128,
                                    .levels = static_cast<int>(roughness.size()),
                                    .order = welkin::UploadOrder::face_by_face,
                                    .row_alignment_bytes = 256,
                                    .level_alignment_bytes = 512};
  std::vector<std::byte> memory(welkin::upload_bytes(layout), kUntouched);  // stands for a mapped upload buffer
  const std::vector<welkin::CubemapTarget> targets = welkin::upload_targets(layout, memory);

  // The job shares the panorama. The buffer must stay until the job is ready.
  const welkin::BakeOptions options{.background = std::nullopt,
                                    .specular = welkin::PrefilterOptions{.size = layout.size, .roughness = roughness},
                                    .irradiance = std::nullopt,
                                    .brdf = std::nullopt};
  const auto environment = std::make_shared<const welkin::LatLongImage>(panorama(256));
  own_executor::ThreadPool pool(2);
  welkin::Worker worker({.executor = std::make_shared<own_executor::PoolExecutor>(pool)});
  auto job = worker.post(welkin::BakeTo{welkin::EnvironmentSource(environment), {.specular = targets}, options});

  int frames = 0;
  while (!job.ready()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // stands for a frame of the engine
    ++frames;
  }
  if (const auto error = job.error()) throw std::runtime_error(error->message);
  const auto baked = job.try_take();
  if (!baked) throw std::runtime_error("the job has no result");

  bool good = (*baked)->values_clamped == 0;
  std::printf("%zu bytes in %d mips, baked within %d frames\n", memory.size(), layout.levels, frames);

  const double error = error_of_mip_0(targets.front());
  good = good && error < 0.005;
  std::printf("mip 0 differs from the environment by at most %.2f %%\n", 100.0 * error);

  const bool exact = written_exactly(targets, memory, memory.data());
  good = good && exact;
  std::printf("bytes between rows and between mips are %s\n", exact ? "untouched" : "NOT untouched");

  for (const double material : {0.0, 0.05, 0.3, 0.5, 1.0}) {
    const double mip = welkin::mip_for_roughness(roughness, material);
    good = good && std::abs(roughness_at(roughness, mip) - material) < 1e-12;
    std::printf("a material of roughness %.2f reads mip %.3f\n", material, mip);
  }
  return good ? 0 : 1;
}

}  // namespace

int main() {
  try {
    return run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "upload_chain: %s\n", error.what());
    return 1;
  }
}
