// A view as pictures.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "image/texel_geometry.h"
#include "image/texel_grid.h"
#include "jobs/floating_point_scope.h"
#include "jobs/tiles.h"
#include "simd/kernels.h"
#include "sky/direction.h"
#include "sky/sky_geometry.h"
#include "sky/sky_slice.h"
#include "sky/sun_disc.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"
#include "welkin/sky_view.h"

namespace welkin {
namespace {

constexpr int kLargestSize = 16384;
constexpr int kChunk = 64;                // directions
constexpr int kTileTexels = 1024;         // some 50 microseconds
constexpr std::int64_t kTexelCost = 100;  // in texels that are only read: `jobs::placement_for` counts those

void check_size(const char* what, int size) {
  if (size >= 1 && size <= kLargestSize) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is " + std::to_string(size) +
                                               "; it must be from 1 to " + std::to_string(kLargestSize));
}

/// A slice reduced to one sun, for many rows of a picture.
class SunnySlice {
 public:
  SunnySlice(const SkyView& view, const glm::dvec3& sun)
      : kernels_(simd::active_kernels().sky_view), run_(SkyViewAccess::slice(view).run(sky::sun_unit(sun))) {
    if (run_.outside) return;
    const jobs::FloatingPointScope scope;
    rows_.resize(std::size_t{2} * simd::kSkyRow * static_cast<std::size_t>(run_.half) *
                 static_cast<std::size_t>(run_.azimuths));
    kernels_.reduce(run_, rows_.data());
    run_.of_sun = rows_.data();
  }
  SunnySlice(const SunnySlice&) = delete;
  SunnySlice& operator=(const SunnySlice&) = delete;

  /// Radiance from `count` directions, the i-th being direction(i).
  template <class Direction>
  void fill(int count, const Direction& direction, float* rgb) const {
    double xyz[3 * kChunk];
    for (int first = 0; first < count; first += kChunk) {
      const int part = std::min(kChunk, count - first);
      for (int i = 0; i < part; ++i) {
        const glm::dvec3 towards = direction(first + i);
        xyz[3 * i] = towards.x;
        xyz[3 * i + 1] = towards.y;
        xyz[3 * i + 2] = towards.z;
      }
      kernels_.radiance(run_, xyz, part, rgb + std::ptrdiff_t{3} * first);
    }
  }

 private:
  const simd::SkyViewKernels& kernels_;
  simd::SkyRun run_;
  std::vector<float> rows_;
};

/// row(j) once for each of `rows` rows of `columns` texels.
template <class Row>
void for_rows(int rows, int columns, const Control& control, const Row& row) {
  const int together = std::clamp(kTileTexels / columns, 1, rows);
  const int tiles = (rows + together - 1) / together;
  const jobs::Placement placement = jobs::placement_for(kTexelCost * rows * columns);
  jobs::run_tiles(static_cast<std::size_t>(tiles), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * together;
                    for (int j = first; j < std::min(rows, first + together); ++j) row(j);
                  });
}

/// Adds the sun's disc: each texel gets the share of the directional light's flux that it covers of the disc.
template <class Covered>
void add_disc(const SkyView& view, const glm::dvec3& towards, const image::TexelGrid& grid, const Covered& covered,
              std::vector<float>& pixels) {
  const jobs::FloatingPointScope scope;
  const Sun sun = view.sun(towards);
  if (!(std::max({sun.irradiance.r, sun.irradiance.g, sun.irradiance.b}) > 0.0)) return;
  const tables::SineCosine radius = tables::sine_cosine_of_turns(sun.angular_radius_degrees / 360.0);
  const double horizon = sky::horizon_cosine(view.tables()->atmosphere.bottom_radius_m, view.altitude_m());
  const std::vector<sky::CoveredTexel> texels = covered({sun.direction, radius.sine, radius.cosine, horizon});
  std::vector<std::int64_t> numbers;
  double whole = 0.0;
  for (const sky::CoveredTexel& texel : texels) {
    numbers.push_back(static_cast<std::int64_t>(texel.texel));
    whole += texel.steradians;
  }
  const std::vector<double> areas = image::solid_angles_of(grid, numbers);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const glm::dvec3 radiance = sun.irradiance * (texels[i].steradians / whole / areas[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = pixels[3 * texels[i].texel + c];
      value = static_cast<float>(static_cast<double>(value) + radiance[static_cast<int>(c)]);
    }
  }
}

}  // namespace

CubemapImage sky_cubemap(const SkyView& view, const glm::dvec3& sun, int size, const SkyPictureOptions& options,
                         const Control& control) {
  check_size("the sky's cubemap size", size);
  const auto edge = static_cast<std::size_t>(size);
  CubemapImage picture{size, std::vector<float>(18 * edge * edge)};
  const SunnySlice slice(view, sun);
  for_rows(6 * size, size, control, [&](int j) {
    const image::Frame& frame = image::face_frame(j / size);
    const glm::dvec3 row = frame.normal + ((2.0 * (j % size) + 1.0) / size - 1.0) * frame.v;
    slice.fill(
        size, [&](int i) { return row + ((2.0 * i + 1.0) / size - 1.0) * frame.u; },
        picture.pixels.data() + 3 * edge * static_cast<std::size_t>(j));
  });
  if (options.sun_disc) {
    add_disc(
        view, sun, image::TexelGrid::cubemap(size),
        [&](const sky::VisibleDisc& disc) { return sky::covered_cubemap_texels(disc, size); }, picture.pixels);
  }
  return picture;
}

LatLongImage sky_lat_long(const SkyView& view, const glm::dvec3& sun, int height, const SkyPictureOptions& options,
                          const Control& control) {
  check_size("the sky's lat-long height", height);
  const int width = 2 * height;
  const auto columns = static_cast<std::size_t>(width);
  LatLongImage picture{width, height, std::vector<float>(3 * columns * static_cast<std::size_t>(height))};
  std::vector<tables::SineCosine> longitudes;
  longitudes.reserve(columns);
  for (int i = 0; i < width; ++i) longitudes.push_back(tables::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
  const SunnySlice slice(view, sun);
  for_rows(height, width, control, [&](int j) {
    const tables::SineCosine latitude = tables::sine_cosine_of_turns(0.25 - (j + 0.5) / (2.0 * height));
    slice.fill(
        width,
        [&](int i) {
          const tables::SineCosine& longitude = longitudes[static_cast<std::size_t>(i)];
          return glm::dvec3(longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine);
        },
        picture.pixels.data() + 3 * columns * static_cast<std::size_t>(j));
  });
  if (options.sun_disc) {
    add_disc(
        view, sun, image::TexelGrid::lat_long(width, height),
        [&](const sky::VisibleDisc& disc) { return sky::covered_lat_long_texels(disc, width, height); },
        picture.pixels);
  }
  return picture;
}

}  // namespace welkin
