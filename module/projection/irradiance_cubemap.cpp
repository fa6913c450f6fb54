#include "welkin/irradiance_cubemap.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/basis.h"
#include "projection/projection_kernels.h"
#include "welkin/irradiance.h"

namespace welkin {
namespace {

constexpr int kLargestSize = 4096;
constexpr double kTileProducts = 1e6;    ///< texels times coefficients: some 0.2 ms
constexpr double kInlineProducts = 1e5;  ///< less is done by the caller's thread alone
constexpr std::size_t kNormalsAtATime = 65536;

CubemapImage empty_cubemap(int size) {
  image::require_range("the irradiance cubemap's size", size, 1, kLargestSize);
  const auto edge = static_cast<std::size_t>(size);
  return {size, std::vector<float>(18 * edge * edge)};
}

/// Channel after channel, as the kernel wants them.
std::vector<double> channels_of(const SphericalHarmonics& harmonics) {
  std::vector<double> channels;
  for (int c = 0; c < 3; ++c) {
    for (const glm::dvec3& coefficient : harmonics.coefficients()) channels.push_back(coefficient[c]);
  }
  return channels;
}

std::vector<double> texel_centres(int size) {
  std::vector<double> centres;
  centres.reserve(static_cast<std::size_t>(size));
  for (int column = 0; column < size; ++column) centres.push_back(static_cast<double>(2 * column + 1 - size) / size);
  return centres;
}

template <class View>
CubemapImage directly(const View& source, int size, const Control& control) {
  CubemapImage result = empty_cubemap(size);
  const std::size_t texels = result.pixels.size() / 3;
  const auto edge = static_cast<std::size_t>(size);
  std::vector<glm::dvec3> normals;
  for (std::size_t first = 0; first < texels; first += normals.size()) {
    const std::size_t end = std::min(texels, first + kNormalsAtATime);
    normals.clear();
    for (std::size_t texel = first; texel < end; ++texel) {
      const auto row = static_cast<int>(texel / edge);
      normals.push_back(
          image::face_direction(size, row / size, static_cast<double>(texel % edge) + 0.5, row % size + 0.5));
    }
    const auto share = [&](std::size_t done) { return static_cast<double>(done) / static_cast<double>(texels); };
    const Control part = jobs::part_of(control, share(first), share(end));
    const std::vector<glm::dvec3> irradiance = direct_irradiance(source, normals, {}, part);
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        result.pixels[3 * (first + i) + c] = static_cast<float>(irradiance[i][static_cast<glm::length_t>(c)]);
      }
    }
  }
  return result;
}

}  // namespace

CubemapImage irradiance_cubemap(const SphericalHarmonics& irradiance, int size, const Control& control) {
  CubemapImage result = empty_cubemap(size);
  const projection::ProjectionKernels& kernels = projection::projection_kernels();
  const std::vector<double> channels = channels_of(irradiance);
  const std::vector<double> centres = texel_centres(size);
  const int bands = irradiance.bands();
  const double row_products = 1.0 * size * bands * bands;
  const int rows = 6 * size;
  const int tile_rows = static_cast<int>(std::clamp(kTileProducts / row_products, 1.0, 1.0 * rows));
  const bool small = row_products * rows < kInlineProducts;
  const auto placement = small ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_tiles(static_cast<std::size_t>((rows + tile_rows - 1) / tile_rows), placement,
                  jobs::worker_count(placement), control, [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * tile_rows;
                    for (int row = first; row < std::min(rows, first + tile_rows); ++row) {
                      const image::Frame& frame = image::face_frame(row / size);
                      const double v = centres[static_cast<std::size_t>(row % size)];
                      projection::DirectionRun run{};
                      for (int axis = 0; axis < 3; ++axis) {
                        run.start[axis] = frame.normal[axis] + v * frame.v[axis];
                        run.step[axis] = frame.u[axis];
                      }
                      run.u = centres.data();
                      run.count = size;
                      kernels.evaluate_harmonics(run, math::basis_constants(), channels.data(), bands,
                                                 result.pixels.data() + std::size_t{3} * static_cast<std::size_t>(row) *
                                                                            static_cast<std::size_t>(size));
                    }
                  });
  return result;
}

CubemapImage direct_irradiance_cubemap(const CubemapView& source, int size, const Control& control) {
  return directly(source, size, control);
}

CubemapImage direct_irradiance_cubemap(const LatLongView& source, int size, const Control& control) {
  return directly(source, size, control);
}

}  // namespace welkin
