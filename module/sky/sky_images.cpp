// A view as images.
#include "sky/sky_images.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <span>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sky_slice.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr int kLargestSize = 16384;
constexpr int kChunk = 64;                // directions
constexpr int kTileTexels = 1024;         // some 50 microseconds
constexpr std::int64_t kTexelCost = 100;  // in texels that are only read: `jobs::placement_for` counts those

/// A slice reduced to one sun, for many rows of an image.
class SunnySlice {
 public:
  SunnySlice(const SkyView& view, const glm::dvec3& sun)
      : kernels_(sky::view_kernels()), run_(SkyViewAccess::slice(view).run(sky::sun_unit(sun))) {
    if (run_.outside) return;
    const platform::FloatingPointScope floating_point;
    rows_.resize(std::size_t{2} * sky::kSkyRow * static_cast<std::size_t>(run_.half) *
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
  const sky::ViewKernels& kernels_;
  sky::SkyRun run_;
  std::vector<float> rows_;
};

/// Calls row(j) once for each of `rows` rows of `columns` texels.
template <class Row>
void for_rows(int rows, int columns, const Control& control, const Row& row) {
  const jobs::Placement placement = jobs::placement_for(kTexelCost * rows * columns);
  jobs::run_rows(rows, std::clamp(kTileTexels / columns, 1, rows), placement, jobs::worker_count(placement), control,
                 [&](int j, std::size_t) { row(j); });
}

/// Adds the sun's disc: each texel gets the fraction of the directional light's irradiance that the texel covers.
void add_disc(const SkyView& view, const glm::dvec3& towards, const image::TexelGrid& grid, std::span<float> pixels) {
  const platform::FloatingPointScope floating_point;
  const Sun sun = view.sun_light(towards);
  if (!(std::max({sun.irradiance.r, sun.irradiance.g, sun.irradiance.b}) > 0.0)) return;
  const math::SineCosine radius = math::sine_cosine_of_turns(sun.angular_radius_degrees / 360.0);
  const double horizon = sky::horizon_cosine(view.tables()->atmosphere.bottom_radius_m, view.altitude_m());
  const std::vector<sky::CoveredTexel> texels =
      sky::covered_texels({sun.direction, radius.sine, radius.cosine, horizon}, grid);
  std::vector<std::int64_t> numbers;
  double whole = 0.0;
  for (const sky::CoveredTexel& texel : texels) {
    numbers.push_back(static_cast<std::int64_t>(texel.texel));
    whole += texel.steradians;
  }
  // A texel's radiance is irradiance x (its part of the disc / all parts) / its solid angle. Dividing by the sum of all
  // parts makes Sum radiance x solid angle the irradiance to rounding, whatever error the areas have.
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

Cubemap sky_cubemap(const SkyView& view, const glm::dvec3& sun, int size, const SkyImageOptions& options,
                    const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::require_range("the sky's cubemap size", size, 1, kLargestSize);
  const auto edge = static_cast<std::size_t>(size);
  Cubemap image(size, 1, control.memory);
  const SunnySlice slice(view, sun);
  for_rows(6 * size, size, control, [&](int j) {
    const image::Frame& frame = image::face_frame(j / size);
    const glm::dvec3 row = frame.normal + ((2.0 * (j % size) + 1.0) / size - 1.0) * frame.v;
    slice.fill(
        size, [&](int i) { return row + ((2.0 * i + 1.0) / size - 1.0) * frame.u; },
        image.face(0) + 3 * edge * static_cast<std::size_t>(j));
  });
  if (options.sun_disc) add_disc(view, sun, image::TexelGrid::cubemap(size), image.pixels());
  return image;
}

LatLongImage sky_lat_long(const SkyView& view, const glm::dvec3& sun, int height, const SkyImageOptions& options,
                          const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::require_range("the sky's lat-long height", height, 1, kLargestSize);
  const int width = 2 * height;
  const auto columns = static_cast<std::size_t>(width);
  LatLongImage image{width, height, std::vector<float>(3 * columns * static_cast<std::size_t>(height))};
  std::vector<math::SineCosine> longitudes;
  longitudes.reserve(columns);
  for (int i = 0; i < width; ++i) longitudes.push_back(math::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
  const SunnySlice slice(view, sun);
  for_rows(height, width, control, [&](int j) {
    const math::SineCosine latitude = math::sine_cosine_of_turns(0.25 - (j + 0.5) / (2.0 * height));
    slice.fill(
        width,
        [&](int i) {
          const math::SineCosine& longitude = longitudes[static_cast<std::size_t>(i)];
          return glm::dvec3(longitude.sine * latitude.cosine, latitude.sine, longitude.cosine * latitude.cosine);
        },
        image.pixels.data() + 3 * columns * static_cast<std::size_t>(j));
  });
  if (options.sun_disc) add_disc(view, sun, image::TexelGrid::lat_long(width, height), image.pixels);
  return image;
}

}  // namespace welkin

namespace welkin::sky {
namespace {

// Cells at the rim count by a straight rim (`covered`): on a plane, discs of 48 such cells per radius have their area
// to 6e-5.
constexpr double kFinest = 1.0 / 48.0;  // of the disc's radius: cells are cut down to that size
constexpr int kMinCuts = 3;             // of a texel that the rim goes through
constexpr double kLargestTurns = 1.0 / 32.0;

double length(const glm::dvec3& v) { return std::sqrt(glm::dot(v, v)); }

/// A rectangle of an image, in texels.
struct Cell {
  double left, right, top, bottom;
};

/// Cuts a lat-long, or a face of a cubemap, into cells until each is inside of the disc, outside, or small.
class Coverage {
 public:
  Coverage(const VisibleDisc& disc, const image::TexelGrid& grid, int face, std::vector<CoveredTexel>& found)
      : disc_(disc),
        lat_long_(grid.kind() == image::TexelGrid::Kind::lat_long),
        columns_(grid.columns()),
        rows_(lat_long_ ? grid.rows() : columns_),
        face_(face),
        found_(found),
        // chord from the centre to the rim: 2 sin(a / 2)
        // 2 sin(a / 2) = sin(a) / cos(a / 2), cos(a / 2) = sqrt((1 + cos a) / 2). Chords are distances in space and
        // obey the triangle's inequality: a cell whose corners lie within `radius` of its middle is outside if the
        // middle is farther from the rim than that.
        chord_(disc.radius_sine * std::sqrt(2.0 / (1.0 + disc.radius_cosine))),
        horizon_sine_(std::sqrt(std::max(0.0, (1.0 - disc.horizon_cosine) * (1.0 + disc.horizon_cosine)))) {}

  void visit() { visit({0.0, static_cast<double>(columns_), 0.0, static_cast<double>(rows_)}); }

 private:
  /// Visits cells of whole texels.
  void visit(const Cell& cell) {
    const Bound bound = bound_of(cell);
    if (bound.outside) return;
    const double columns = cell.right - cell.left;
    const double rows = cell.bottom - cell.top;
    if (columns <= 1.0 && rows <= 1.0) {
      const double steradians = covered(cell, bound, 0);
      const auto row = static_cast<std::size_t>(face_ * rows_) + static_cast<std::size_t>(cell.top);
      const auto texel = row * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(cell.left);
      if (steradians > 0.0) found_.push_back({texel, steradians});
    } else if (columns > rows) {
      const double middle = std::floor(0.5 * (cell.left + cell.right));
      visit({cell.left, middle, cell.top, cell.bottom});
      visit({middle, cell.right, cell.top, cell.bottom});
    } else {
      const double middle = std::floor(0.5 * (cell.top + cell.bottom));
      visit({cell.left, cell.right, cell.top, middle});
      visit({cell.left, cell.right, middle, cell.bottom});
    }
  }

  [[nodiscard]] glm::dvec3 direction(double column, double row) const {
    return lat_long_ ? image::lat_long_direction(columns_, rows_, column, row)
                     : image::face_direction(columns_, face_, column, row);
  }

  /// Cells of a face are not: they are convex, and their corners are what is farthest out.
  [[nodiscard]] bool large(const Cell& cell) const {
    return lat_long_ &&
           (cell.right - cell.left > kLargestTurns * columns_ || cell.bottom - cell.top > 2.0 * kLargestTurns * rows_);
  }

  struct Bound {
    bool outside = false;
    bool inside = false;
    double radius = 0.0;       ///< chord from the middle to the farthest corner
    double within_disc = 0.0;  ///< of the middle: how far inside of the rim
    double above_horizon = 0.0;
    double disc_extent = 0.0;  ///< over how much of either the corners spread
    double horizon_extent = 0.0;
    double steradians = 0.0;
  };

  Bound bound_of(const Cell& cell) const {
    Bound bound;
    const glm::dvec3 middle = direction(0.5 * (cell.left + cell.right), 0.5 * (cell.top + cell.bottom));
    const glm::dvec3 a = direction(cell.left, cell.top);
    const glm::dvec3 b = direction(cell.right, cell.top);
    const glm::dvec3 c = direction(cell.left, cell.bottom);
    const glm::dvec3 d = direction(cell.right, cell.bottom);
    constexpr double rounder = 1.1;  // parallels bulge
    bound.radius = rounder * std::max({length(a - middle), length(b - middle), length(c - middle), length(d - middle)});
    bound.within_disc = chord_ - length(middle - disc_.centre);
    // Elevation over the horizon to first order, in radians: y - cos_h over the sine of the horizon's zenith angle.
    bound.above_horizon = disc_.horizon_cosine > -1.0
                              ? (middle.y - disc_.horizon_cosine) / std::max(horizon_sine_, 1e-3)
                              : 2.0 + 2.0 * bound.radius;
    const auto spread = [](double p, double q, double r, double t) {
      return std::max({p, q, r, t, 1e-300}) - std::min({p, q, r, t});
    };
    const glm::dvec3& centre = disc_.centre;
    bound.disc_extent = spread(length(a - centre), length(b - centre), length(c - centre), length(d - centre));
    bound.horizon_extent = spread(a.y, b.y, c.y, d.y) / std::max(horizon_sine_, 1e-3);
    // Exact on a lat-long: Int Int cos(latitude) = the difference of longitudes times that of the sines of latitude, y.
    // On a face half the product of the diagonals: the plane quadrilateral through the corners, for cells that are
    // small against the sphere.
    bound.steradians = lat_long_ ? 2.0 * std::numbers::pi * (cell.right - cell.left) / columns_ * (a.y - c.y)
                                 : 0.5 * length(glm::cross(d - a, c - b));
    if (large(cell)) return bound;
    // The horizon's measure is an elevation to first order, and `radius` a chord: a tenth more covers the difference.
    bound.outside = bound.within_disc < -bound.radius || bound.above_horizon < -1.1 * bound.radius;
    bound.inside = bound.within_disc > bound.radius && bound.above_horizon > 1.1 * bound.radius;
    return bound;
  }

  double covered(const Cell& cell, const Bound& bound, int cuts) const {
    if (bound.outside) return 0.0;
    if (bound.inside && cuts > 0) return bound.steradians;
    const bool small = bound.radius < kFinest * chord_ && cuts >= kMinCuts;
    if (small && !large(cell)) {
      // A straight rim cuts a small cell: of distances from the rim that range over `extent`, evenly about the
      // middle's, the part above 0 is 1/2 + inside / extent.
      const auto share = [](double inside, double extent) {
        return extent > 0.0 ? std::clamp(0.5 + inside / extent, 0.0, 1.0) : inside > 0.0 ? 1.0 : 0.0;
      };
      const double within = share(bound.within_disc, bound.disc_extent);
      const double above = share(bound.above_horizon, bound.horizon_extent);
      return bound.steradians * within * above;
    }
    const double column = 0.5 * (cell.left + cell.right);
    const double row = 0.5 * (cell.top + cell.bottom);
    double sum = 0.0;
    for (const Cell& part : {Cell{cell.left, column, cell.top, row}, Cell{column, cell.right, cell.top, row},
                             Cell{cell.left, column, row, cell.bottom}, Cell{column, cell.right, row, cell.bottom}}) {
      sum += covered(part, bound_of(part), cuts + 1);
    }
    return sum;
  }

  const VisibleDisc& disc_;
  bool lat_long_;
  int columns_;
  int rows_;
  int face_;
  std::vector<CoveredTexel>& found_;
  double chord_ = 0.0;
  double horizon_sine_ = 0.0;
};

/// Returns the disc's centre or, if it is below the horizon, the point above it on the horizon, which has y = cos_h,
/// and x and z scaled to the horizon's sine.
glm::dvec3 highest(const VisibleDisc& disc) {
  if (disc.centre.y >= disc.horizon_cosine) return disc.centre;
  const double level = std::sqrt(disc.centre.x * disc.centre.x + disc.centre.z * disc.centre.z);
  const double sine = std::sqrt(std::max(0.0, 1.0 - disc.horizon_cosine * disc.horizon_cosine));
  if (!(level > 0.0)) return disc.centre;
  return {disc.centre.x / level * sine, disc.horizon_cosine, disc.centre.z / level * sine};
}

/// Returns the texel in which a direction lies.
std::size_t texel_of(const image::TexelGrid& grid, const glm::dvec3& direction) {
  const auto inside = [](double position, int count) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(std::floor(position)), 0, count - 1));
  };
  const int columns = grid.columns();
  const auto width = static_cast<std::size_t>(columns);
  if (grid.kind() == image::TexelGrid::Kind::lat_long) {
    const double level = std::sqrt(direction.x * direction.x + direction.z * direction.z);
    // Rows are even in latitude from 1/4 turn down to -1/4, columns in longitude from +1/2 turn down to -1/2.
    const std::size_t row = inside((0.25 - math::turns_of(direction.y, level)) * 2.0 * grid.rows(), grid.rows());
    return row * width + inside((0.5 - math::turns_of(direction.x, direction.z)) * columns, columns);
  }
  const int face = image::face_of(direction);
  const image::Frame& frame = image::face_frame(face);
  // A direction p meets the face's plane at p / (p . normal), where u and v run from -1 to 1 over `columns` texels.
  const double scale = 0.5 * columns / glm::dot(direction, frame.normal);
  const std::size_t row = inside(0.5 * columns + scale * glm::dot(direction, frame.v), columns);
  return (static_cast<std::size_t>(face) * width + row) * width +
         inside(0.5 * columns + scale * glm::dot(direction, frame.u), columns);
}

}  // namespace

std::vector<CoveredTexel> covered_texels(const VisibleDisc& disc, const image::TexelGrid& grid) {
  std::vector<CoveredTexel> found;
  const int faces = grid.kind() == image::TexelGrid::Kind::lat_long ? 1 : 6;
  for (int face = 0; disc.radius_sine > 0.0 && face < faces; ++face) Coverage(disc, grid, face, found).visit();
  if (found.empty()) found.push_back({texel_of(grid, highest(disc)), 1.0});
  std::sort(found.begin(), found.end(), [](const CoveredTexel& a, const CoveredTexel& b) { return a.texel < b.texel; });
  return found;
}

}  // namespace welkin::sky
