// Irradiance texel by texel: no harmonics, many normals at a time.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "image/formats.h"
#include "jobs/tiles.h"
#include "sh/check_arguments.h"
#include "sh/cosine_texels.h"
#include "sh/pixel_policy.h"
#include "welkin/error.h"
#include "welkin/irradiance.h"

namespace welkin {
namespace {

constexpr std::size_t kMostNormals = 100'000;
constexpr std::size_t kBatch = 512;  ///< normals that are worked on at a time: bounds the memory, 12 MiB of slots
constexpr std::size_t kMostTiles = 1024;
constexpr std::size_t kLanes = 8;  ///< sums that run side by side, so that the processor need not wait for each

/// A picture row by row, cleaned, whatever its layout.
struct Source {
  const sh::CosineTexels& texels;
  bool cubemap;
  std::function<void(int row, float* rgb)> decode;
};

/// One worker's room: a row's moments, and its channels in double.
struct Scratch {
  explicit Scratch(std::size_t columns) : rgb(3 * columns), cosine(columns) {
    for (auto* list : {&moments.x, &moments.y, &moments.z, &moments.horizon, &red, &green, &blue})
      list->resize(columns);
  }
  std::vector<float> rgb;
  sh::MomentRow moments;
  std::vector<double> red, green, blue;
  std::vector<double> cosine;  ///< of each texel with the normal at hand: its clipped integral
};

void read_row(const Source& source, const sh::PixelPolicy& policy, int row, Scratch& scratch,
              sh::CleaningRecord& record) {
  const int columns = source.texels.columns();
  source.decode(row, scratch.rgb.data());
  const float no_weight = 0.0F;
  const int face = source.cubemap ? row / columns : 0;
  policy.clean({.rgb = scratch.rgb.data(),
                .count = columns,
                .face = face,
                .row = source.cubemap ? row % columns : row,
                .first_column = 0,
                .weights = &no_weight,
                .weight_step = 0,
                .weight_scale = 0.0},
               record);
  for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
    scratch.red[i] = static_cast<double>(scratch.rgb[3 * i]);
    scratch.green[i] = static_cast<double>(scratch.rgb[3 * i + 1]);
    scratch.blue[i] = static_cast<double>(scratch.rgb[3 * i + 2]);
  }
  source.texels.fill(row, scratch.moments);
}

/// The clipped cosine integrals of a row's texels. False if all are zero.
bool fill_cosines(const sh::CosineTexels& texels, int row, const glm::dvec3& normal, Scratch& scratch) {
  const sh::MomentRow& m = scratch.moments;
  double* const cosine = scratch.cosine.data();
  const std::size_t count = scratch.cosine.size();
  for (std::size_t i = 0; i < count; ++i) cosine[i] = normal.x * m.x[i] + normal.y * m.y[i] + normal.z * m.z[i];
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(cosine[i]) <= m.horizon[i]) cosine[i] = texels.clipped(row, static_cast<int>(i), normal);
    cosine[i] = cosine[i] > 0.0 ? cosine[i] : 0.0;
    largest = cosine[i] > largest ? cosine[i] : largest;
  }
  return largest > 0.0;
}

/// Sum of a[i] b[i] in kLanes running sums, which are added in order.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double lanes[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= a.size(); i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) lanes[k] += a[i + k] * b[i + k];
  }
  for (std::size_t k = 0; i < a.size(); ++i, ++k) lanes[k] += a[i] * b[i];
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

std::vector<glm::dvec3> unit_normals(std::span<const glm::dvec3> normals) {
  if (normals.empty() || normals.size() > kMostNormals) {
    throw Error(ErrorCode::invalid_argument,
                std::to_string(normals.size()) + " normals; 1 to " + std::to_string(kMostNormals) + " are possible");
  }
  std::vector<glm::dvec3> units;
  for (const glm::dvec3& normal : normals) {
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw Error(ErrorCode::invalid_argument,
                  "normal " + std::to_string(units.size()) + " has no length that could be made 1");
    }
    units.push_back(normal / length);
  }
  return units;
}

/// Appends the irradiance of one batch of normals.
void integrate_batch(const Source& source, std::span<const glm::dvec3> normals, const ProjectionOptions& options,
                     const Control& control, std::vector<glm::dvec3>& irradiance) {
  const sh::PixelPolicy policy(options);
  const auto rows = static_cast<std::size_t>(source.texels.rows());
  const auto columns = static_cast<std::size_t>(source.texels.columns());
  const std::size_t rows_per_tile = (rows + kMostTiles - 1) / kMostTiles;
  const std::size_t tiles = (rows + rows_per_tile - 1) / rows_per_tile;
  const jobs::Placement placement = jobs::placement_for(static_cast<std::int64_t>(rows * columns * normals.size()));
  const std::size_t workers = jobs::worker_count(placement);
  std::vector<Scratch> scratch(workers, Scratch(columns));
  std::vector<glm::dvec3> slots(tiles * normals.size(), glm::dvec3(0.0));
  std::vector<sh::CleaningRecord> records(tiles);

  jobs::run_tiles(tiles, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    Scratch& room = scratch[worker];
    glm::dvec3* const slot = slots.data() + tile * normals.size();
    for (std::size_t row = tile * rows_per_tile; row < std::min(rows, (tile + 1) * rows_per_tile); ++row) {
      read_row(source, policy, static_cast<int>(row), room, records[tile]);
      for (std::size_t n = 0; n < normals.size(); ++n) {
        if (!fill_cosines(source.texels, static_cast<int>(row), normals[n], room)) continue;
        slot[n] += glm::dvec3(dot(room.cosine, room.red), dot(room.cosine, room.green), dot(room.cosine, room.blue));
      }
    }
  });

  sh::CleaningRecord record;
  for (const sh::CleaningRecord& one : records) record.add(one);
  sh::throw_if_rejected(record, source.cubemap);
  const std::size_t first = irradiance.size();
  irradiance.resize(first + normals.size(), glm::dvec3(0.0));
  for (std::size_t k = 0; k < slots.size(); ++k) irradiance[first + k % normals.size()] += slots[k];
}

std::vector<glm::dvec3> integrate(const Source& source, std::span<const glm::dvec3> normals,
                                  const ProjectionOptions& options, const Control& control) {
  const auto share_done = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(normals.size());
  };
  std::vector<glm::dvec3> irradiance;
  while (irradiance.size() < normals.size()) {
    const std::size_t first = irradiance.size();
    const std::size_t count = std::min(kBatch, normals.size() - first);
    const Control part = jobs::part_of(control, share_done(first), share_done(first + count));
    integrate_batch(source, normals.subspan(first, count), options, part, irradiance);
  }
  return irradiance;
}

/// A view's row: `row_stride_bytes` may be 0 (packed) or negative.
const std::byte* row_of(const void* pixels, std::ptrdiff_t stride, PixelFormat format, int width, int row) {
  const std::ptrdiff_t bytes = stride != 0 ? stride : static_cast<std::ptrdiff_t>(bytes_per_texel(format)) * width;
  return static_cast<const std::byte*>(pixels) + row * bytes;
}

}  // namespace

std::vector<glm::dvec3> direct_irradiance(const CubemapView& cubemap, std::span<const glm::dvec3> normals,
                                          const ProjectionOptions& options, const Control& control) {
  sh::check_view(cubemap);
  sh::check_options(options);
  const auto texels = sh::cosine_texels_of_cubemap(cubemap.size);
  const auto decode = [&](int row, float* rgb) {
    const void* const face = cubemap.faces[static_cast<std::size_t>(row / cubemap.size)];
    image::decode_texels(cubemap.format,
                         row_of(face, cubemap.row_stride_bytes, cubemap.format, cubemap.size, row % cubemap.size),
                         cubemap.size, rgb);
  };
  return integrate({*texels, true, decode}, unit_normals(normals), options, control);
}

std::vector<glm::dvec3> direct_irradiance(const LatLongView& lat_long, std::span<const glm::dvec3> normals,
                                          const ProjectionOptions& options, const Control& control) {
  sh::check_view(lat_long);
  sh::check_options(options);
  const auto texels = sh::cosine_texels_of_lat_long(lat_long.width, lat_long.height);
  const auto decode = [&](int row, float* rgb) {
    image::decode_texels(lat_long.format,
                         row_of(lat_long.pixels, lat_long.row_stride_bytes, lat_long.format, lat_long.width, row),
                         lat_long.width, rgb);
  };
  return integrate({*texels, false, decode}, unit_normals(normals), options, control);
}

glm::dvec3 reference_irradiance(const CubemapView& cubemap, const glm::dvec3& normal) {
  return direct_irradiance(cubemap, {&normal, 1}).front();
}

glm::dvec3 reference_irradiance(const LatLongView& lat_long, const glm::dvec3& normal) {
  return direct_irradiance(lat_long, {&normal, 1}).front();
}

}  // namespace welkin
